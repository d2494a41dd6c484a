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
from ngslac.bodies.bodies import Bodies
from ngslac.linear.solver import LinearSolveError
from ngslac.solve.snapshot import Snapshot

SAMPLES = 12


def half(**flags):
    return continued.half(continued.loading(**flags), 1)


def solving():
    stepper = half()
    stepper.load.Set(0.7)
    return stepper.solver, lambda: stepper.solver.Solve(printing=False)


def stepping(**flags):
    stepper = half(**flags)
    return stepper, lambda: stepper.Integrate(0.6, steps=1, printing=False)


def cutting():
    """The interrupt may land while a step that did not converge is undone."""
    stepper = half(nonlinear=False)

    def prescribe(_):
        if stepper.load.Get() > 0.55:
            raise ContactConvergenceError("hard")

    def run():
        stepper.maxcuts = 1
        with pytest.raises(ContactConvergenceError, match="hard"):
            stepper.Integrate(0.6, steps=1, printing=False)

    stepper.prescribe = prescribe
    return stepper, run


def augmented():
    stepper = half(nonlinear=False)
    solver = stepper.solver
    solver = AugmentedLagrangianSolver(
        solver.a, solver.gf, solver.contacts, inverse=continued.INVERSE
    )
    stepper = LoadStepper(solver, stepper.load)
    return stepper, lambda: stepper.Integrate(0.6, steps=1, printing=False)


def moving():
    stepper = continued.half(continued.bouncing(), 1)
    return stepper, lambda: stepper.Integrate(0.54, printing=False)


def loading(folder, **flags):
    stepper = half(**flags)
    SaveState(folder / "state", stepper)
    stepper.Integrate(0.6, steps=1, printing=False)
    return stepper, lambda: LoadState(folder / "state", stepper)


def pairing(**flags):
    stepper = half(**flags)
    (contact,), gf = stepper.solver.contacts, stepper.solver.gf
    return stepper, lambda: contact.Update(gf)


def pairing_by_hand(make=None, *, back=False):
    """While what is seen is an equilibrium under way, neither the last commit nor what comes."""
    stepper = continued.half(make(), 1) if make else half(finite=True)
    (contact,) = stepper.solver.contacts
    state = contact.State()
    stepper.load.Set(0.7)
    stepper.solver.Solve(printing=False)
    return stepper, lambda: contact.SetState(state) if back else contact.Update()


def committing(**flags):
    stepper = half(**flags)
    (contact,), gf = stepper.solver.contacts, stepper.solver.gf
    stepper.load.Set(0.6)
    stepper.solver.Solve(printing=False)
    return stepper, lambda: contact.Commit(gf)


def starting():
    """The first step, of two bodies with finite sliding."""
    stepper = two_bars(0.5, finite=True, friction=0.3).stepper
    stepper.solver.contacts[0].Update(stepper.gf)
    return stepper, lambda: stepper.Integrate(0.02, printing=False)


SCENARIOS = {
    "solve": solving,
    "small steps": stepping,
    "finite steps": lambda: stepping(finite=True),
    "cuts": cutting,
    "augmented": augmented,
    "time steps": moving,
    "first time step": starting,
    "pairing": pairing,
    "finite pairing": lambda: pairing(finite=True),
    "finite pairing by hand": pairing_by_hand,
    "self-contact paired by hand": lambda: pairing_by_hand(continued.squeezed),
    "finite pairing put back by hand": lambda: pairing_by_hand(back=True),
    "commit": committing,
    "finite commit": lambda: committing(finite=True),
}


def check_all_or_nothing(tool, run):
    before, old = Snapshot(tool), seen(tool)
    with Interrupter() as whole:
        run()
    new = seen(tool)
    before.Restore()
    assert same(old, seen(tool)) == set(old)
    last = max(whole.lines - 25, 1)  # where it is accepted, in short steps
    sample = {*np.linspace(1, last, SAMPLES).astype(int), *range(last, whole.lines + 1, 4)}
    for at in sorted(sample):
        with suppress(KeyboardInterrupt), Interrupter(at):
            run()  # to its end, if it is shorter this time
        found = seen(tool)
        mixed = (set(old) - same(old, found), set(old) - same(new, found))
        assert not all(mixed), f"line {at} of {whole.lines}: not as before {mixed[0]}"
        before.Restore()


@pytest.mark.parametrize("name", SCENARIOS)
def test_an_interrupt_at_any_line(name):
    check_all_or_nothing(*SCENARIOS[name]())


@pytest.mark.parametrize("finite", [False, True])
def test_an_interrupt_while_a_state_is_loaded(tmp_path, finite):
    check_all_or_nothing(*loading(tmp_path, finite=finite))


@pytest.mark.parametrize(
    ("make", "flags"),
    [(half, {"steps": 1}), (lambda: continued.half(continued.bouncing(), 1), {})],
)
def test_an_interrupt_in_a_callback_leaves_the_step(make, flags):
    """The step had converged: all of it is there."""
    stepper, reference = make(), make()
    end = reference.Integrate(0.54, printing=False, **flags)[-1]

    def callback(step):
        if step.number == end.number:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        stepper.Integrate(0.54, printing=False, callback=callback, **flags)
    assert stepper.steps[-1].time == end.time
    assert same(seen(stepper), seen(reference)) == set(seen(stepper))


def test_what_a_callback_changes_stays():
    """A step that fails after it goes back to what it left, not to the state before."""
    stepper = continued.half(continued.bouncing(), 1)

    def prescribe(_):
        if stepper.time.Get() > 0.55:
            raise RuntimeError("enough")

    def stop(_):
        stepper.velocity.vec[:] = 0

    stepper.prescribe = prescribe
    with pytest.raises(RuntimeError, match="enough"):
        stepper.Integrate(0.58, printing=False, callback=stop)
    assert stepper.time.Get() == pytest.approx(0.54)
    assert not np.any(stepper.velocity.vec.FV().NumPy())


@pytest.mark.parametrize(
    ("make", "name", "flags"),
    [(half, "load", {"steps": 1}), (lambda: continued.bouncing(), "time", {})],
)
def test_a_callback_that_moves_the_load(make, name, flags):
    """It would never come to an end."""
    stepper = make()
    parameter = getattr(stepper, name)
    with pytest.raises(ValueError, match=f"callback.* {name} "):
        stepper.Integrate(0.6, printing=False, callback=lambda step: parameter.Set(0.01), **flags)


def test_an_error_while_bodies_are_looked_for(monkeypatch):
    """A linear system that cannot be solved, and then a failure of the diagnosis."""
    stepper = half()
    solver, before = stepper.solver, seen(stepper)

    def singular(*_, **__):
        raise LinearSolveError("singular")

    def broken(*_):
        raise MemoryError

    monkeypatch.setattr(solver.linear, "SolveShifted", singular)
    monkeypatch.setattr(Bodies, "Floating", broken)
    stepper.load.Set(0.7)
    with pytest.raises(MemoryError):
        solver.Solve(printing=False)
    stepper.load.Set(0.5)
    assert same(before, seen(stepper)) == set(before)


def test_the_computation_goes_on_after_interrupts():
    """As if nothing had happened."""
    stepper, reference = half(finite=True), half(finite=True)
    for at in (300, 900, 1500):
        with pytest.raises(KeyboardInterrupt), Interrupter(at):
            stepper.Integrate(0.6, steps=1, printing=False)
    for tool in (stepper, reference):
        tool.Integrate(1.0, steps=3, printing=False)
    names = set(seen(stepper))
    assert same(seen(stepper), seen(reference)) == names
