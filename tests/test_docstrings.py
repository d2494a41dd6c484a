"""Every example in a docstring of a public name runs."""

import doctest
import sys
from pathlib import Path

import ngsolve
import pytest
from ngsolve import Grad, InnerProduct, Sym, ds, dx

import ngslac
import ngslac.reference
from ngslac.meshes import TwoBlocks

sys.path.insert(0, str(Path(__file__).parent / "docs"))

from docstrings import PublicNames


def examples(name):
    return doctest.DocTestParser().get_doctest(name.doc, {}, name.name, None, 0)


NAMES = {name.name: name for name in PublicNames() if examples(name).examples}
REFERENCE = {
    key for key, name in NAMES.items() if name.thing.__module__.startswith("ngslac.reference")
}


@pytest.fixture
def problem():
    """The names that the examples use: one block pressed on another."""
    mesh = TwoBlocks(0.25, structured=True)
    V = ngsolve.VectorH1(mesh, order=2, dirichlet="bottom")
    fes = V * ngslac.LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    load = ngsolve.Parameter(1)
    a = ngsolve.BilinearForm(fes)
    a += InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx + 0.01 * load * v[1] * ds("top")
    gf = ngsolve.GridFunction(fes)
    contact = ngslac.LACContact(u, lam, master="master", friction=0.2)
    solver = ngslac.ContactSolver(a, gf, contact)
    return vars(ngsolve) | vars(ngslac) | locals()


def run(name, names):
    test = examples(NAMES[name])
    test.globs.update(names)
    result = doctest.DocTestRunner(verbose=False).run(test)
    assert result.attempted > 0
    assert result.failed == 0


@pytest.mark.parametrize("name", sorted(NAMES.keys() - REFERENCE))
def test_example(name, problem, monkeypatch, tmp_path):
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.chdir(tmp_path)  # for the files that examples write
    run(name, problem)


@pytest.mark.parametrize("name", sorted(REFERENCE))
def test_example_of_reference(name):
    run(name, vars(ngslac.reference))


def test_the_main_names_have_examples():
    main = {"LACSpace", "LACContact", "ContactSolver", "LoadStepper", "FormSum", "SplitSlaveFaces"}
    assert main <= NAMES.keys()
    assert {"HertzLine", "HertzPoint"} <= REFERENCE
