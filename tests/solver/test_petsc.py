"""PETSc as solver of the linear systems: the same solutions in one process."""

import subprocess
import sys
from pathlib import Path

import pytest
from press import press, solved
from test_linear import needs_petsc

from ngslac import FloatingBodyError
from ngslac.linear import chain
from ngslac.petsc import library, numbering


@needs_petsc
@pytest.mark.parametrize("large", [0, 1e9])
def test_floating_bodies_are_found(large, monkeypatch):
    monkeypatch.setitem(chain.LARGE, "petsc", {2: large})
    problem = press(spring=0, push=(0.0, 0.02))
    messages = []
    for name in ("petsc", "direct"):
        with pytest.raises(FloatingBodyError) as error:
            problem.solver(solver=name, initial="none").Solve(printing=False)
        messages.append(str(error.value))
    assert messages[0] == messages[1]


@needs_petsc
@pytest.mark.parametrize("name", ["inverse", "preconditioner"])
def test_other_choices_are_refused(name):
    value = {"inverse": "umfpack", "preconditioner": lambda mat, freedofs: None}[name]
    with pytest.raises(ValueError, match=f"{name}= does not go with solver='petsc'"):
        press().solver(solver="petsc", **{name: value})


@needs_petsc
def test_matrices_that_did_not_change_are_not_factored_again():
    problem = press()
    solver = solved(problem, solver="petsc")
    before = solver.linear.factorisations
    solver.Solve(printing=False)
    assert solver.linear.factorisations <= before + 1


@needs_petsc
def test_states_say_which_method_serves(monkeypatch):
    monkeypatch.setitem(chain.LARGE, "petsc", {2: 0})
    one, other = (press().solver(solver="petsc").linear for _ in range(2))
    one.failures["iterative"] = one.most_failures
    other.SetState(one.State())
    assert other.method == "direct"
    assert "PETSc, factors of MUMPS" in str(other)


def test_what_to_install_is_said_where_petsc_is_missing(monkeypatch):
    def nothing():
        raise ImportError("No module named 'petsc4py'")

    monkeypatch.setattr(library, "Found", nothing)
    monkeypatch.setattr(numbering, "LoadPETSc", library.LoadPETSc.__wrapped__)
    with pytest.raises(ImportError, match="python3-petsc4py"):
        press().solver(solver="petsc")


def test_other_solvers_import_neither_petsc_nor_mpi():
    code = "import press, sys; press.solved(press.press()); "
    code += "assert not {'petsc4py', 'mpi4py'} & set(sys.modules)"
    home = Path(__file__).parents[1] / "problems"
    assert subprocess.run([sys.executable, "-c", code], cwd=home, timeout=120).returncode == 0
