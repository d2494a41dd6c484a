"""Every problem of the stress set converges without help, and to a right answer."""

import warnings

import numpy as np
import pytest
import stress_check as check
from ngsolve import CF
from run import FIRST, Module, RunProblem, Summary
from stress_problem import PROBLEMS

# A sample of all families that takes a few seconds; the rest runs on request: pytest -m stress, or
# run.py.
SAMPLE = {
    "randomgap-2-0.3", "randomsurface-4-1.5", "badstart-1", "slab", "wedge", "spaces-condense",
    "randomgap3d-2-0.4", "largerandom-33-0.8", "lift-0.4", "largebrick3d-0.6", "brick-3-0.5",
    "stack", "fullslip-0.2", "threeblocks-5-0.3-0", "pushingap-1-0.3-0", "pile-3-0.3-0.005-1",
    "chain-2-0.3-1-0.0", "gasket-0.01-0.6", "hotbar-2-0.15-2", "shrunkon-0.1",
    "discinbowl-1.3-0.5-0", "pressfit-0.02-0.3-100.0", "leafpressed-0.3-1", "units-1.0-1e-06-1",
    "largeunits-1e-06-1000.0", "orders-1-patches-0", "kinds3d-tet-1-0", "tiedandloose-0.3-1",
    "movingfloor-0.4-5-0.05", "halfheld-2-1", "random-004", "random-005", "random-007",
    "hotbar-8-0.05-2", "hotbar-2-0.15-2-True", "random-061", "random-099",
    "leafonsupports-0.0-1", "plate-0.0",
    "nofriction-0.0", "nopull-0.0-0-0.0", "nomeeting-side",
    "atrest-2-0.001-weight", "atrest-3-0.001-traction", "atrestturned-30.0-base",
    "stackatrest-3-0.001", "spininhole-2-0", "freefit-0.4-1.6-0.0-0", "coolsloose3d-0.0",
    "nospin-0.01-0", "noslopeatall-0.01-0", "noslide3d-0.001", "pasttheend--0.01-0.3-4",
    "firstpress-0.3-0.01", "random-125", "fallingfriction-0.1-True", "worn-0.02-True", "worn3d-1.0",
    "softlayer-0.1", "peeled-0.1-5", "discs-0.4-True", "pressedring-0.2",
    "warmblock-0.4-True", "rubbing-0.3-True", "warmdisc-0.4",
}  # fmt: skip


def Marks(name):
    return () if name in SAMPLE else [pytest.mark.stress]


@pytest.mark.parametrize("name", [pytest.param(n, marks=Marks(n)) for n in PROBLEMS])
def test_problem(name):
    result = RunProblem(name)
    if result["unsolvable"]:
        assert not result["converged"]
        assert result["named"], result["error"]
        return
    assert result["error"] == ""
    assert result["converged"]
    assert result["right"]


def test_the_set_is_large_enough():
    assert len(PROBLEMS) == 704
    assert sum(name[:7] == "random-" for name in PROBLEMS) == 160
    assert sum(Module(name) == "stress_unsolvable" for name in PROBLEMS) >= 25
    assert sum(Module(name) in FIRST for name in PROBLEMS) == 110
    assert set(PROBLEMS) >= SAMPLE


def test_a_random_problem_is_the_same_each_time():
    first, again = (PROBLEMS["random-017"]() for _ in range(2))
    assert (first.young, first.laws) == (again.young, again.laws)
    points = [np.array([v.point for v in p.mesh.vertices]) for p in (first, again)]
    assert np.array_equal(*points)


@pytest.mark.parametrize("name", ["largeleaf-0.0-2", "largeleaf-0.3-2"])
def test_a_leaf_that_bends_far_needs_no_smaller_steps(name):
    """Newton's method fails in the first step, and the path finds the contact status."""
    result = RunProblem(name)
    assert result["right"]
    assert (result["steps"], result["cuts"]) == (2, 0)


def test_what_comes_loose_all_around_is_held_where_it_is():
    """Curved elements make false stiffness of a turn, by which nothing rocks."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert RunProblem("coolsloose-0.3-0.15")["iterations"] <= 8
    assert not any("push bodies aside" in str(warning.message) for warning in caught)


# --- the checks find wrong answers -------------------------------------------------------------


@pytest.fixture
def solved():
    problem = PROBLEMS["randomsurface-2-0.2"]()
    problem.Run()
    check.Check(problem)
    return problem


@pytest.mark.parametrize(
    ("what", "macro", "value"),
    [
        ("tension", lambda t: t["status"] > 0, (0, -2)),
        ("pressure across", lambda t: t["gap"] > 1e-3, (0, 0.01)),
        ("friction beyond", lambda t: t["status"] == 2, (-0.01, 0)),
        ("do not match", lambda t: t["status"] == 2, (0.01, 0)),
    ],
)
def test_a_wrong_traction_is_found(solved, what, macro, value):
    """Of one macro-element, by a share of the largest."""
    (contact,), values = solved.contacts, solved.gf.vec.FV().NumPy()
    dofs = contact.form.MultiplierDofs().reshape(-1, 2)
    chosen = np.flatnonzero(macro(contact.Table()))[0]
    values[dofs[chosen]] += np.abs(values[dofs]).max() * np.asarray(value)
    with pytest.raises(check.WrongAnswerError, match=what):
        check.CheckContact(solved, contact)
    with pytest.raises(check.WrongAnswerError, match="equilibrium"):
        check.CheckEquilibrium(solved)


def test_bodies_in_each_other_are_found(solved):
    into = solved.mesh.MaterialCF({"upper": CF((0, -0.05))}, default=CF((0, 0)))
    solved.gf.components[0].Set(into)
    with pytest.raises(check.WrongAnswerError, match="upper_bottom lies inside of lower"):
        check.CheckOutlines(solved)


def test_another_load_or_force_at_the_end_is_found(solved):
    solved.resultant = tuple(1.1 * np.array(solved.contacts[0].Force()))
    with pytest.raises(check.WrongAnswerError, match="resultant"):
        check.CheckEnd(solved)
    solved.load.Set(0.9)
    with pytest.raises(check.WrongAnswerError, match="not reached"):
        check.CheckEnd(solved)


def test_the_summary_counts_wrong_answers():
    good = {"unsolvable": False, "first": True, "converged": True, "right": True, "named": False}
    good |= {"steps": 1, "cuts": 0, "iterations": 3, "seconds": 1}
    failed = good | {"converged": False, "right": None, "first": False}
    named = failed | {"unsolvable": True, "named": True}
    summary = Summary([good, good | {"right": False}, failed, named])
    assert (summary["solvable"], summary["converged"], summary["wrong"]) == (3, 2, 1)
    assert (summary["unsolvable"], summary["named"]) == (1, 1)
    assert (summary["iterations"], summary["iterations_old"]) == (9, 6)
