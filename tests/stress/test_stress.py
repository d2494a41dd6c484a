"""Every problem of the stress set converges without help, and to a right answer."""

import numpy as np
import pytest
import stress_check
from ngsolve import CF
from run import RunProblem, Summary
from stress_problem import PROBLEMS

# Those that take longest run on request: pytest -m stress, or run.py.
LONG = [pytest.mark.slow, pytest.mark.stress]
SLOW = {
    "cyclic3d", "halfring-0.0", "halfring-0.2", "bumps-0.0", "bumps-0.3", "softpunch-0.0",
    "softpunch-0.4", "plate-0.5", "iron-0.0", "iron-0.2", "slide3d-0.0", "slide3d-0.5",
    "turn3d-0.3", "twist3d-0.4", "plate3d", "meshes3d-6-2", "meshes3d-2-6", "rubber3d",
    "toandfro-0.5",
    "overedge-0.0", "overedge-0.4", "beams-0.0", "beams-0.3", "wedgein-0.0", "wedgein-0.3",
    "largebrick3d-0.6", "pressandlift3d", "randomsurface3d-1-0.2", "randomsurface3d-2-0.7",
    "largeslide-0.0", "largeslide-0.3", "largeslide-1.0", "turn-0.0", "turn-0.6", "lift-0.4",
}  # fmt: skip


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=LONG if n in SLOW else ()) for n in PROBLEMS]
)
def test_problem(name):
    result = RunProblem(name)
    assert result["error"] == ""
    assert result["converged"]
    assert result["right"]


def test_the_set_is_large_enough():
    assert len(PROBLEMS) >= 90
    assert set(PROBLEMS) >= SLOW


# --- the checks find wrong answers -------------------------------------------------------------


@pytest.fixture
def solved():
    problem = PROBLEMS["randomsurface-2-0.2"]()
    problem.Run()
    stress_check.Check(problem)
    return problem


def spoil(problem, what, macro, value):
    """Change the traction of a macro-element, as a share of the largest."""
    dofs = problem.contacts[0].form.MultiplierDofs().reshape(-1, 2)
    values = problem.gf.vec.FV().NumPy()
    largest = np.abs(values[dofs]).max()
    table = problem.contacts[0].Table()
    chosen = np.flatnonzero(macro(table))[0]
    values[dofs[chosen]] += largest * np.asarray(value)
    with pytest.raises(stress_check.WrongAnswerError, match=what):
        stress_check.CheckContact(problem, problem.contacts[0])
    with pytest.raises(stress_check.WrongAnswerError, match="equilibrium"):
        stress_check.CheckEquilibrium(problem)


def test_tension_is_found(solved):
    spoil(solved, "tension", lambda t: t["status"] > 0, (0, -2))


def test_pressure_across_a_gap_is_found(solved):
    spoil(solved, "pressure across", lambda t: t["gap"] > 1e-3, (0, 0.01))


def test_too_much_friction_is_found(solved):
    spoil(solved, "friction beyond", lambda t: t["status"] == 2, (-0.01, 0))


def test_too_little_friction_is_found(solved):
    spoil(solved, "do not match", lambda t: t["status"] == 2, (0.01, 0))


def test_bodies_in_each_other_are_found(solved):
    into = solved.mesh.MaterialCF({"upper": CF((0, -0.05))}, default=CF((0, 0)))
    start = solved.gf.components[0]
    start.Set(into)
    with pytest.raises(stress_check.WrongAnswerError, match="upper_bottom lies inside of lower"):
        stress_check.CheckBodies(solved)


def test_elements_turned_inside_out_are_found():
    problem = PROBLEMS["neo-0.4"]()
    problem.gf.components[0].Set(CF((0, 0)))
    stress_check.CheckBodies(problem)
    problem.gf.vec.FV().NumPy()[:] = np.random.default_rng(1).normal(size=len(problem.gf.vec))
    with pytest.raises(stress_check.WrongAnswerError, match="inside out"):
        stress_check.CheckBodies(problem)


def test_a_load_that_was_not_reached_is_found(solved):
    solved.load.Set(0.9)
    with pytest.raises(stress_check.WrongAnswerError, match="not reached"):
        stress_check.CheckEnd(solved)


def test_the_summary_counts_wrong_answers():
    good = {
        "unsolvable": False,
        "first": True,
        "converged": True,
        "right": True,
        "named": False,
        "steps": 1,
        "cuts": 0,
        "iterations": 3,
        "seconds": 1,
    }
    failed = good | {"converged": False, "right": None, "first": False}
    named = failed | {"unsolvable": True, "named": True}
    summary = Summary([good, good | {"right": False}, failed, named])
    assert (summary["solvable"], summary["converged"], summary["wrong"]) == (3, 2, 1)
    assert (summary["unsolvable"], summary["named"]) == (1, 1)
    assert (summary["iterations"], summary["iterations_old"]) == (9, 6)
