"""States are put back as they were or refused as a whole, and what fails leaves no trace."""

import continued
import numpy as np
import pytest
from interrupts import Interrupter, same, seen
from netgen.meshing import NgException
from press import mixed_press, numpy, press

from ngslac import ContactConvergenceError, ContactSolver
from ngslac.bodies.bodies import Bodies
from ngslac.linear.solver import LinearSolveError

TOOLS = {
    "small": continued.loading,
    "finite": lambda: continued.loading(finite=True),
    "self-contact": continued.squeezed,
    "dynamics": lambda: continued.bouncing(nonlinear=True, order=1),
}


def half(name):
    return continued.half(TOOLS[name]())


def unchanged(tool, call, error, match=None):
    """It fails, and everything that can be seen is as before."""
    before = seen(tool)
    with pytest.raises(error, match=match):
        call(tool)
    assert same(before, seen(tool)) == set(before)


# --- what fails ----------------------------------------------------------------------------------


def too_few_iterations(tool):
    cuts, tool.maxcuts = tool.maxcuts, 1
    try:
        tool.Integrate(0.54, maxit=1, tol=1e-14, printing=False)
    finally:
        tool.maxcuts = cuts


def an_error_on_the_way(tool):
    def prescribe(_):
        raise ContactConvergenceError("hard")

    before, tool.prescribe = tool.prescribe, prescribe
    try:
        tool.Integrate(0.54, printing=False)
    finally:
        tool.prescribe = before


def interrupted(tool):
    with Interrupter(700):
        tool.Integrate(0.54, printing=False)


FAILURES = [
    (too_few_iterations, ContactConvergenceError),
    (an_error_on_the_way, ContactConvergenceError),
    (interrupted, KeyboardInterrupt),
]


@pytest.mark.parametrize("name", TOOLS)
def test_failed_steps_leave_no_trace(name):
    """The computation goes on as if nothing had happened."""
    tool, reference = half(name), half(name)
    for call, error in FAILURES:
        unchanged(tool, call, error)
    ends = [seen(continued.half(stepper, 2)) for stepper in (tool, reference)]
    # The last digit of velocities depends on where arrays lie.
    rounding = 1e-9 if name == "dynamics" else 0
    for key, value in ends[0].items():
        assert value == pytest.approx(ends[1][key], rel=rounding, abs=rounding), key


def set_nan(solver):
    solver.gf.vec[0] = np.nan


def move(solver):
    solver.gf.vec[0] += 1e-9


def solve_again(solver):
    solver.Solve(printing=False)


def solve_by_another(solver):
    ContactSolver(solver.a, solver.gf, solver.contacts).Solve(printing=False)


def interrupt(solver):
    raise KeyboardInterrupt


@pytest.mark.parametrize("name", ["small", "finite"])
@pytest.mark.parametrize(
    ("action", "error", "text"),
    [
        (set_nan, ValueError, "callback has changed gf in the middle of Solve"),
        (move, ValueError, "callback has changed gf in the middle of Solve"),
        (solve_by_another, ValueError, "callback has changed gf in the middle of Solve"),
        (solve_again, ValueError, "Solve was called in the middle of Solve"),
        (interrupt, KeyboardInterrupt, None),
    ],
)
def test_what_a_callback_of_solve_must_not_do(name, action, error, text):
    tool = half(name)
    tool.load.Set(0.55)
    solver = tool.solver
    unchanged(solver, lambda s: s.Solve(printing=False, callback=lambda _: action(s)), error, text)
    solver.Solve(printing=False)  # nothing is left of it


def test_a_failed_solve_leaves_no_trace():
    solver = (problem := mixed_press(nonlinear=True)).solver()
    solver.Solve(printing=False)
    before = numpy(problem.gf)
    problem.load.Set(1.7)
    few = "no convergence in 1 iterations"
    unchanged(solver, lambda s: s.Solve(maxit=1, printing=False), ContactConvergenceError, few)
    problem.contact.Commit(problem.gf)
    problem.contact.Evaluate(problem.gf)
    unchanged(solver, lambda s: s.Solve(maxit=1, printing=False), ContactConvergenceError, few)
    assert problem.contact.Table()["slip"] == pytest.approx(0, abs=1e-15)
    solver.Solve(printing=False)  # nothing is broken: more iterations do it
    assert not np.array_equal(numpy(problem.gf), before)


def test_an_error_while_bodies_are_looked_for(monkeypatch):
    """A linear system that cannot be solved, and then a failure of the diagnosis."""

    def raising(error):
        def Raise(*_, **__):
            raise error

        return Raise

    tool = half("small")
    monkeypatch.setattr(tool.solver.linear, "SolveShifted", raising(LinearSolveError("singular")))
    monkeypatch.setattr(Bodies, "Floating", raising(MemoryError()))
    tool.load.Set(0.7)
    unchanged(tool, lambda t: t.solver.Solve(printing=False), MemoryError)


# --- states that do not fit ----------------------------------------------------------------------

TEXT = "must be what State"
EXACT = (TypeError, ValueError, NgException)


def of_contact(**wrong):
    def call(tool):
        (contact,) = tool.solver.contacts
        contact.SetState(contact.State() | wrong, tool.solver.gf)

    return call


def of_solver(**wrong):
    return lambda tool: tool.solver.SetState(tool.solver.State() | wrong)


def of_both(tool):
    """Not even the solution comes, which is first."""
    state = tool.solver.State()
    parts = [state["contacts"][0] | {"memory": np.zeros(1)}]
    tool.solver.SetState(state | {"gf": 2 * state["gf"], "contacts": parts})


def bare(state):
    return lambda tool: tool.solver.contacts[0].SetState(state)


REFUSED = [
    (of_contact(memory=np.zeros(1)), "memory"),
    (of_contact(c=np.zeros(0)), "'c'"),
    (of_contact(paired=np.ones(3)), r"state\['paired'\] has 3 entries"),
    (of_contact(accepted=None), "."),
    (of_contact(states="text"), rf"state\['states'\] = 'text' {TEXT}\(\) returned there"),
    (of_contact(scaled=None), rf"state\['scaled'\] = None {TEXT}"),
    *((bare(state), "state") for state in ({}, {"paired": None}, 3)),
    (of_both, "memory"),
    (of_solver(contacts=[]), "state is that of 0 contacts, the solver has 1"),
    *((of_solver(**{key: "text"}), rf"state\['{key}'\] = 'text' {TEXT}")
      for key in ("contacts", "history", "residual", "scale")),
    (lambda tool: tool.solver.SetState(press().solver().State()),
     r"values of gf, which has .* before the space was refined"),
]  # fmt: skip


@pytest.mark.parametrize("name", ["small", "finite"])
def test_a_state_that_does_not_fit_changes_nothing(name):
    tool = half(name)
    for call, message in REFUSED:
        unchanged(tool, call, EXACT, message)


@pytest.mark.parametrize("name", ["small", "finite"])
def test_an_unpaired_state(name):
    """Back before the first pairing: nothing of it is left."""
    solver = half(name).solver
    (contact,) = solver.contacts
    contact.SetState({"paired": None, "scaled": False})
    assert not contact.form.paired
    assert not np.any(numpy(contact.pressure))
    with pytest.raises(NgException, match="no pairing yet"):
        contact.Force()
    solver.Solve(printing=False)
    assert contact.Force()[1] > 0


@pytest.mark.parametrize("name", ["small", "finite"])
def test_a_strided_state(name):
    tool = half(name)
    (contact,) = tool.solver.contacts
    before = seen(tool)
    strided = {
        name: np.repeat(value, 2)[::2] if isinstance(value, np.ndarray) else value
        for name, value in contact.State().items()
    }
    contact.SetState(strided, tool.solver.gf)
    assert same(before, seen(tool)) == set(before)


@pytest.mark.parametrize("name", ["small", "finite"])
def test_the_step_before_the_space_was_refined(name):
    """The stepper is of no use then, and says so; nothing crashes."""
    tool = half(name)
    space = tool.solver.gf.space
    space.mesh.Refine()
    space.Update()
    tool.solver.gf.Update()
    with pytest.raises((ValueError, NgException), match="refine"):
        tool.Integrate(0.6, printing=False)
    assert tool.load.Get() == 0.5
