"""Contacts that are switched off and on between steps."""

import numpy as np
import pytest
from finitepress import Led, blocks2d
from loaded import loaded
from motions import two_bars
from press import numpy, press, same, solved

from ngslac import (
    AugmentedLagrangianSolver,
    ContactConvergenceError,
    ContactSolver,
    FloatingBodyError,
    LoadState,
    LoadStepper,
    SaveState,
)

LAWS = [{}, {"friction": 0.3}, {"tied": True}, {"bilateral": True}, {"finite": True}]


def is_off(contact, gf):
    """No forces, no multipliers, no status, no partners."""
    table = contact.Table()
    for name in ("area", "status", "pressure", "traction", "slip"):
        assert not np.any(table[name])
    assert np.all(np.isnan(table["gap"]))
    assert not np.any(contact.Force())
    assert not np.any(contact.pressure.vec.FV().NumPy())
    multipliers = numpy(gf.components[1])
    assert np.abs(multipliers).max() <= 1e-12
    return True


@pytest.mark.sample(10)
@pytest.mark.parametrize("solver", [ContactSolver, AugmentedLagrangianSolver])
@pytest.mark.parametrize("law", LAWS, ids=str)
@pytest.mark.parametrize("dim", [2, 3])
def test_without_contact_the_bodies_do_not_feel_each_other(dim, law, solver):
    problem, free = press(dim=dim, **law), press(dim=dim, offset=1.0)
    tool = solver(problem.a, problem.gf, problem.contact)
    tool.Solve(printing=False)
    assert np.any(problem.contact.Table()["status"])
    problem.contact.Commit(problem.gf)
    problem.contact.Deactivate()
    assert not problem.contact.active
    assert not np.any(problem.contact.Force())
    tool.Solve(printing=False)
    assert is_off(problem.contact, problem.gf)
    solved(free)
    u, expected = (numpy(p.gf.components[0]) for p in (problem, free))
    assert u == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_on_again_it_counts_from_there(law):
    """As a contact that is paired in that configuration for the first time."""
    problem, other = press(**law), press(**law)
    for p in (problem, other):
        p.load.Set(-0.3)  # away from each other
        p.contact.Deactivate()
        p.solver().Solve(printing=False)
    assert problem.contact.active is False
    problem.contact.Activate(problem.gf)
    other.contact.SetState(press(**law).contact.State())  # as a new one
    assert other.contact.active
    other.contact.Update(other.gf)
    for p in (problem, other):
        assert not np.any(p.contact.Table()["slip"])
        p.load.Set(1.0)
        p.solver().Solve(printing=False)
    assert np.any(problem.contact.Table()["status"])
    same(problem, other, 1e-8)


@pytest.mark.parametrize("dim", [2, 3])
def test_ties_hold_from_where_they_are_switched_on(dim):
    """No traction comes from what the bodies moved before; then they move together."""
    problem = press(dim=dim, tied=True)
    problem.contact.Deactivate()
    solver = problem.solver()
    solver.Solve(printing=False)
    before = numpy(problem.gf.components[0])
    problem.contact.Activate(problem.gf)
    solver.Solve(printing=False)
    after = numpy(problem.gf.components[0])
    assert after == pytest.approx(before, abs=1e-12)
    assert problem.contact.Table()["traction"] == pytest.approx(0, abs=1e-10)
    problem.load.Set(2.0)
    solver.Solve(printing=False)
    assert np.abs(problem.contact.Force()).max() > 0.01
    assert problem.contact.Table()["slip"] == pytest.approx(0, abs=1e-10)


def test_bodies_that_a_contact_held_float_without_it():
    problem = loaded(0, -1, friction=0.3)
    solver = problem.solver()
    solver.Solve(printing=False)
    problem.contact.Commit(problem.gf)
    before = problem.gf.vec.FV().NumPy().copy()
    problem.contact.Deactivate()
    with pytest.raises(FloatingBodyError, match="'upper' floats") as error:
        solver.Solve(printing=False)
    assert "macro-elements only" not in str(error.value)
    assert np.array_equal(problem.gf.vec.FV().NumPy(), before)
    assert not problem.contact.active
    problem.contact.Activate()
    solver.Solve(printing=False)
    assert problem.contact.Force()[1] == pytest.approx(1, rel=1e-9)


@pytest.mark.parametrize("finite", [False, True])
def test_what_fails_after_switching_leaves_it_switched(finite):
    """And the state of before brings back what was."""
    problem = press(finite=finite, friction=0.3, nonlinear=True)
    stepper = LoadStepper(problem.solver(), problem.load)
    problem.load.Set(0.0)
    stepper.Integrate(1.0, steps=2, printing=False)
    state, table = stepper.State(), problem.contact.Table()
    problem.contact.Deactivate()
    with pytest.raises(ContactConvergenceError):
        stepper.Integrate(2.0, steps=1, maxit=1, printing=False)
    assert not problem.contact.active
    assert not np.any(problem.contact.Table()["status"])
    stepper.SetState(state)
    assert problem.contact.active
    for name, expected in problem.contact.Table().items():
        assert table[name] == pytest.approx(expected, abs=1e-13)
    stepper.Integrate(1.2, steps=1, printing=False)
    assert np.any(problem.contact.Table()["status"])


@pytest.mark.parametrize("finite", [False, True])
def test_steps_with_a_contact_that_is_off_for_a_while_restarted(finite, tmp_path):
    """The state is saved while the contact is off, and taken over by another computation."""

    def begun():
        problem = press(finite=finite, friction=0.3)
        problem.load.Set(0.0)
        return problem, LoadStepper(problem.solver(), problem.load)

    def finish(problem, stepper):
        stepper.Integrate(0.2, steps=2, printing=False)
        problem.contact.Activate(problem.gf)
        stepper.Integrate(1.0, steps=2, printing=False)

    (one, stepper), (two, other) = begun(), begun()
    stepper.Integrate(0.5, steps=2, printing=False)
    one.contact.Deactivate()
    stepper.Integrate(0.4, steps=1, printing=False)
    SaveState(tmp_path / "state", stepper)
    finish(one, stepper)
    LoadState(tmp_path / "state", other)
    assert not two.contact.active
    finish(two, other)
    same(two, one, 1e-9)
    assert np.any(one.contact.Table()["status"])


def test_bodies_pass_through_each_other_while_it_is_off():
    """And need no partner: below the other block there is none."""
    problem = Led(blocks2d(0.25), lambda t: (0.0, -3.0 * t))
    problem.contact.Deactivate()
    problem.run(1.0)
    assert np.array(problem.contact.Check().unpaired).size == problem.contact.space.nmacros
    assert is_off(problem.contact, problem.gf)
    state = problem.stepper.State()
    with pytest.raises(Exception, match="never meet"):
        problem.contact.Activate(problem.gf)
    assert not problem.contact.active
    problem.stepper.SetState(state)
    problem.run(0.01)
    problem.contact.Activate(problem.gf)
    problem.run(0.011)
    assert np.all(problem.contact.Table()["pressure"] > 0)


def test_reports_say_that_it_is_off():
    contact = press().contact
    contact.Deactivate()
    assert "switched off" in repr(contact)
    assert "switched off     no forces until Activate(gf)" in str(contact.Check())
    assert not contact.Check().active
    contact.Activate()
    assert "switched off" not in repr(contact) + str(contact.Check())


def test_a_bar_flies_through_a_contact_that_is_off():
    motion = two_bars(gap=0.0)
    motion.contact.Deactivate()
    motion.run(0.3)
    velocity = motion.mean(motion.stepper.velocity, "upper")
    assert velocity == pytest.approx([0, -1], abs=1e-10)
    assert motion.stepper.balance.impact == pytest.approx(0, abs=1e-14)


def test_a_state_that_does_not_say_is_of_a_contact_that_is_on():
    """Those of earlier versions."""
    problem = press()
    solved(problem)
    problem.contact.Commit(problem.gf)
    state = {name: value for name, value in problem.contact.State().items() if name != "active"}
    problem.contact.Deactivate()
    problem.contact.SetState(state, problem.gf)
    assert problem.contact.active
    assert np.any(problem.contact.Table()["status"])
