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


def step(stepper, _=None, **flags):
    if hasattr(stepper, "time"):
        end = stepper.time.Get() + stepper.dt
    else:
        end, flags = 0.6, {"steps": 1} | flags
    return lambda: stepper.Integrate(end, printing=False, **flags)


def cut(stepper, _):
    """The interrupt may land while a step that did not converge is undone."""

    def prescribe(_):
        if stepper.load.Get() > 0.55:
            raise ContactConvergenceError("hard")

    def run():
        with pytest.raises(ContactConvergenceError, match="hard"):
            step(stepper)()

    stepper.maxcuts, stepper.prescribe = 1, prescribe
    return run


def load(stepper, folder):
    SaveState(folder / "state", stepper)
    step(stepper)()
    return lambda: LoadState(folder / "state", stepper)


def solve(stepper, _=None):
    stepper.load.Set(0.7)
    return lambda: stepper.solver.Solve(printing=False)


def under_way(call):
    """What is seen is an equilibrium under way, neither the last commit nor what comes."""

    def prepare(stepper, _):
        (contact,) = stepper.solver.contacts
        state = contact.State()
        solve(stepper)()
        return lambda: call(contact, state, stepper.solver.gf)

    return prepare


ACTIONS = {
    "step": (step, ["small", "finite", "augmented", "dynamics", "first step"]),
    "solve": (solve, ["small"]),
    "cut": (cut, ["linear"]),
    "load": (load, ["small", "finite"]),
    "pair": (under_way(lambda contact, _, gf: contact.Update(gf)), ["small", "finite"]),
    "pair by hand": (under_way(lambda contact, *_: contact.Update()), ["finite", "self-contact"]),
    "put back": (under_way(lambda contact, state, _: contact.SetState(state)), ["finite"]),
    "commit": (under_way(lambda contact, _, gf: contact.Commit(gf)), ["small", "finite"]),
}


@pytest.mark.parametrize(
    ("action", "name"), [(key, name) for key in ACTIONS for name in ACTIONS[key][1]]
)
def test_an_interrupt_at_any_line(action, name, tmp_path):
    tool = MAKE[name]()
    run = ACTIONS[action][0](tool, tmp_path)
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


@pytest.mark.parametrize("name", ["small", "dynamics"])
def test_an_interrupt_in_a_callback_leaves_the_step(name):
    """The step had converged: all of it is there."""
    stepper, reference = MAKE[name](), MAKE[name]()
    (end,) = step(reference)()

    def callback(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        step(stepper, callback=callback)()
    assert stepper.steps[-1].time == end.time
    assert same(seen(stepper), seen(reference)) == set(seen(stepper))
