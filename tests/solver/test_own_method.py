"""A method for linear systems of one's own: what it has to have, and what comes for free."""

import re

import numpy as np
import pytest
import scipy.sparse.linalg
from press import press, solved

from ngslac import ContactSolver, LoadState, SaveState
from ngslac.arrays import Multiply, ToCSR
from ngslac.errors import LinearSolveError
from ngslac.linear import chain
from ngslac.linear.refine import Refine
from ngslac.linear.system import Method


class SciPyLU(Method):
    """Factors of the whole matrix by SciPy, made anew for each system."""

    def __str__(self):
        return "factors of SciPy"

    def Solve(self, system, b):
        mat, free = system.matrix, system.free
        self.factorisations += 1
        factors = scipy.sparse.linalg.splu(ToCSR(mat)[free][:, free].tocsc())

        def Step(left):
            x = 0 * left
            x[free] = factors.solve(left[free])
            return x

        return Refine(Step, lambda x: (b - Multiply([mat], x)) * free, b)


@pytest.fixture
def scipy_lu(monkeypatch):
    monkeypatch.setitem(chain.METHODS, "scipy", lambda parts: SciPyLU())


@pytest.mark.parametrize("flags", [{}, {"friction": 0.5, "finite": True}, {"condense": True}])
def test_a_method_in_the_chain(flags, scipy_lu):
    problem, other = press(**flags), press(**flags)
    solver = solved(problem, solver="scipy")
    assert solver.linear.method == "scipy"
    assert str(solver.linear) == "linear systems: factors of SciPy (as asked for)"
    assert solver.linear.factorisations >= len(solver.history) - 1
    solved(other, solver="direct")
    u, expected = (p.gf.vec.FV().NumPy() for p in (problem, other))
    assert u == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())


def test_the_next_method_takes_over(scipy_lu, monkeypatch):
    """Also from an iteration, which is given up where it keeps failing; states say so."""

    def Fails(self, system, b):
        raise LinearSolveError("none of mine")

    monkeypatch.setattr(SciPyLU, "Solve", Fails)
    solver = solved(press(friction=0.5), solver="scipy")
    assert solver.linear.method == "scipy"
    assert solver.linear.inverse is not None
    monkeypatch.setattr(SciPyLU, "is_iteration", True)
    solver, other = solved(press(friction=0.5), solver="scipy"), press().solver(solver="scipy")
    assert solver.linear.method == "direct"
    assert other.linear.method == "scipy"
    other.linear.SetState(solver.linear.State())
    assert other.linear.method == "direct"


@pytest.mark.parametrize(
    "known",
    [
        {"failures": {}, "methods": {"direct": {"inverse": "umfpack"}}},
        {"failures": 0, "methods": ["direct"], "inverse": "umfpack", "once": False},
    ],
    ids=["file", "older file"],
)
def test_a_saved_state_that_does_not_know_a_method(known, scipy_lu, tmp_path, monkeypatch):
    solver = solved(press(), solver="direct")
    monkeypatch.setattr(type(solver.linear), "State", lambda self: known)
    SaveState(tmp_path / "state", solver)
    other = press().solver(solver="scipy")
    LoadState(tmp_path / "state", other)
    assert other.linear.method == "scipy"
    assert other.linear.inverse == "umfpack"


def test_methods_that_an_older_file_has_given_up():
    known = {"failures": 2, "methods": ["direct"], "inverse": None, "once": False}
    linear = press().solver(solver="iterative").linear
    linear.SetState(known)
    assert linear.method == "direct"


def test_docstring_and_error_name_all_methods():
    names = [*chain.METHODS, "petsc"]
    told = re.search(r"solver : \{(.*)\}, optional", ContactSolver.__doc__)[1]
    assert told.replace('"', "").split(", ") == names
    with pytest.raises(ValueError, match=", ".join(map(repr, names))):
        press().solver(solver="none")
