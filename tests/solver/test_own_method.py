"""A method for linear systems of one's own: what it has to have, and what comes for free."""

import re

import pytest
from press import press, solved
from test_linear import SciPyLU

from ngslac import ContactSolver, LoadState, SaveState
from ngslac.errors import LinearSolveError
from ngslac.linear import chain


@pytest.fixture
def scipy_lu(monkeypatch):
    monkeypatch.setitem(chain.METHODS, "scipy", lambda parts: SciPyLU())


def test_a_method_in_the_chain(scipy_lu):
    linear = solved(press(), solver="scipy").linear
    assert str(linear) == "linear systems: factors of SciPy (as asked for)"


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
