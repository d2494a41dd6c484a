"""Every example in a docstring of a public name runs."""

import doctest

import ngsolve
import pytest
from ngsolve import Grad, InnerProduct, Sym, ds, dx

import ngslac
from ngslac.demos import TwoBlocks

PUBLIC = [name for name in ngslac.__all__ if not name.startswith("_")]


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


def examples(name):
    thing = getattr(ngslac, name)
    return doctest.DocTestParser().get_doctest(thing.__doc__, {}, name, None, 0)


@pytest.mark.parametrize("name", [name for name in PUBLIC if examples(name).examples])
def test_example(name, problem):
    test = examples(name)
    test.globs.update(problem)
    result = doctest.DocTestRunner(verbose=False).run(test)
    assert result.failed == 0


def test_the_main_names_have_examples():
    main = {"LACSpace", "LACContact", "ContactSolver", "LoadStepper", "FormSum", "SplitSlaveFaces"}
    assert main <= {name for name in PUBLIC if examples(name).examples}
