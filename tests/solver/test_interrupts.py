"""Ctrl-C at any line: what is left is the state before, or the one after, and never a mixture."""

from contextlib import suppress

import continued
import numpy as np
import pytest
from interrupts import Interrupter, same, seen
from motions import two_bars

from ngslac import (
    AugmentedLagrangianSolver,
    ContactConvergenceError,
    LoadState,
    LoadStepper,
    SaveState,
)

SAMPLES = 12


def half(**flags):
    return continued.half(continued.loading(**flags))


def augmented():
    stepper = half(nonlinear=False)
    given = stepper.solver
    solver = AugmentedLagrangianSolver(given.a, given.gf, given.contacts, inverse=continued.INVERSE)
    return LoadStepper(solver, stepper.load)


def starting():
    """The first step, of two bodies with finite sliding."""
    stepper = two_bars(0.5, finite=True, friction=0.3).stepper
    stepper.solver.contacts[0].Update(stepper.gf)
    return stepper


MAKE = {
    "small": half,
    "linear": lambda: half(nonlinear=False),
    "finite": lambda: half(finite=True),
    "self-contact": lambda: continued.half(continued.squeezed()),
    "augmented": augmented,
    "dynamics": lambda: continued.half(continued.bouncing()),
    "first step": starting,
}

# --- what is interrupted: prepared, and then run -------------------------------------------------


def solve(stepper, _):
    stepper.load.Set(0.7)
    return lambda: stepper.solver.Solve(printing=False)


def step(stepper, _):
    return lambda: stepper.Integrate(0.6, steps=1, printing=False)


def time_step(stepper, _):
    return lambda: stepper.Integrate(stepper.time.Get() + stepper.dt, printing=False)


def cut(stepper, _):
    """The interrupt may land while a step that did not converge is undone."""

    def prescribe(_):
        if stepper.load.Get() > 0.55:
            raise ContactConvergenceError("hard")

    def run():
        with pytest.raises(ContactConvergenceError, match="hard"):
            stepper.Integrate(0.6, steps=1, printing=False)

    stepper.maxcuts, stepper.prescribe = 1, prescribe
    return run


def load(stepper, folder):
    SaveState(folder / "state", stepper)
    step(stepper, folder)()
    return lambda: LoadState(folder / "state", stepper)


def pair(stepper, _):
    return lambda: stepper.solver.contacts[0].Update(stepper.solver.gf)


def under_way(stepper, call):
    """What is seen is an equilibrium under way, neither the last commit nor what comes."""
    (contact,) = stepper.solver.contacts
    state = contact.State()
    solve(stepper, None)()
    return lambda: call(contact, state)


def pair_by_hand(stepper, _):
    return under_way(stepper, lambda contact, state: contact.Update())


def put_back(stepper, _):
    return under_way(stepper, lambda contact, state: contact.SetState(state))


def commit(stepper, _):
    return under_way(stepper, lambda contact, state: contact.Commit(stepper.solver.gf))


@pytest.mark.parametrize(
    ("action", "name"),
    [
        (solve, "small"),
        *((step, name) for name in ("small", "finite", "augmented")),
        *((time_step, name) for name in ("dynamics", "first step")),
        (cut, "linear"),
        *((action, name) for action in (load, pair, commit) for name in ("small", "finite")),
        *((pair_by_hand, name) for name in ("finite", "self-contact")),
        (put_back, "finite"),
    ],
)
def test_an_interrupt_at_any_line(action, name, tmp_path):
    tool = MAKE[name]()
    run = action(tool, tmp_path)
    before, old = tool.State(), seen(tool)
    with Interrupter() as whole:
        run()
    new = seen(tool)
    tool.SetState(before)
    assert same(old, seen(tool)) == set(old)
    last = max(whole.lines - 25, 1)  # where it is accepted, in short steps
    sample = {*np.linspace(1, last, SAMPLES).astype(int), *range(last, whole.lines + 1, 4)}
    for at in sorted(sample):
        with suppress(KeyboardInterrupt), Interrupter(at):
            run()  # to its end, if it is shorter this time
        found = seen(tool)
        mixed = (set(old) - same(old, found), set(old) - same(new, found))
        assert not all(mixed), f"line {at} of {whole.lines}: not as before {mixed[0]}"
        tool.SetState(before)


@pytest.mark.parametrize(("name", "flags"), [("small", {"steps": 1}), ("dynamics", {})])
def test_an_interrupt_in_a_callback_leaves_the_step(name, flags):
    """The step had converged: all of it is there."""
    stepper, reference = MAKE[name](), MAKE[name]()
    end = reference.Integrate(0.54, printing=False, **flags)[-1]

    def callback(step):
        if step.number == end.number:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        stepper.Integrate(0.54, printing=False, callback=callback, **flags)
    assert stepper.steps[-1].time == end.time
    assert same(seen(stepper), seen(reference)) == set(seen(stepper))
