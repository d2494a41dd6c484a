"""States are put back as they were or refused as a whole, and what fails leaves no trace."""

import continued
import numpy as np
import pytest
from interrupts import Interrupter, same, seen
from netgen.meshing import NgException
from ngsolve import CF
from press import mixed_press, numpy, press
from refused import check_refused

from ngslac import ContactConvergenceError, ContactSolver, LoadStepper
from ngslac.bodies.bodies import Bodies
from ngslac.errors import LinearSolveError


def prescribed():
    problem = press(spring=0, friction=0.4, nonlinear=True, flags={"dirichlet": "bottom|top"})
    problem.load.Set(0)
    motion = {"top": problem.load * CF((0.02, -0.02))}
    return LoadStepper(problem.solver(inverse=continued.INVERSE), problem.load, prescribe=motion)


TOOLS = {
    "small": continued.loading,
    "finite": lambda: continued.loading(finite=True),
    "prescribed": prescribed,
    "self-contact": continued.squeezed,
    "dynamics": lambda: continued.bouncing(nonlinear=True, order=1),
}
KINDS = pytest.mark.parametrize("name", ["small", "finite"])


def half(name):
    return continued.half(TOOLS[name]())


def unchanged(tool, call, error, match=None):
    """It fails, and everything that can be seen is as before."""
    before = seen(tool)
    with pytest.raises(error, match=match):
        call(tool)
    assert same(before, seen(tool)) == set(before)


# --- what fails ----------------------------------------------------------------------------------


def hard(_):
    raise ContactConvergenceError("hard")


def step(tool, prescribe=None, at=None, **flags):
    """One that fails: for other displacements, at an interrupt, or for few iterations."""
    kept = tool.prescribe, tool.maxcuts
    end, steps = (1.0, {"steps": 1}) if hasattr(tool, "load") else (0.54, {})
    tool.prescribe, tool.maxcuts = prescribe or tool.prescribe, 1
    try:
        with Interrupter(at):
            tool.Integrate(end, printing=False, **steps, **flags)
    finally:
        tool.prescribe, tool.maxcuts = kept


@pytest.mark.parametrize("name", TOOLS)
def test_failed_steps_leave_no_trace(name):
    """The computation goes on as if nothing had happened."""
    tool, reference = half(name), half(name)
    unchanged(tool, lambda t: step(t, maxit=1, tol=1e-14), ContactConvergenceError)
    unchanged(tool, lambda t: step(t, prescribe=hard), ContactConvergenceError, "hard")
    unchanged(tool, lambda t: step(t, at=700), KeyboardInterrupt)
    ends = [seen(continued.half(stepper, 2)) for stepper in (tool, reference)]
    # The last digit of velocities depends on where arrays lie.
    rounding = 1e-9 if name == "dynamics" else 0
    for key, value in ends[0].items():
        assert value == pytest.approx(ends[1][key], rel=rounding, abs=rounding, nan_ok=True), key


def put(entry):
    def Put(solver):
        solver.gf.vec[0] = entry(solver.gf.vec[0])

    return Put


CHANGED = "callback has changed gf in the middle of Solve"


@KINDS
@pytest.mark.parametrize(
    ("action", "text"),
    [
        (put(lambda _: np.nan), CHANGED),
        (put(lambda value: value + 1e-9), CHANGED),
        (lambda s: ContactSolver(s.a, s.gf, s.contacts).Solve(printing=False), CHANGED),
        (lambda s: s.Solve(printing=False), "Solve was called in the middle of Solve"),
    ],
)
def test_what_a_callback_of_solve_must_not_do(name, action, text):
    tool = half(name)
    tool.load.Set(0.55)

    def call(solver):
        solver.Solve(printing=False, callback=lambda _: action(solver))

    unchanged(tool.solver, call, ValueError, text)
    tool.solver.Solve(printing=False)  # nothing is left of it


def test_a_failed_solve_leaves_no_trace():
    problem = mixed_press(nonlinear=True)
    solver, contact = problem.solver(), problem.contact
    solver.Solve(printing=False)
    before = numpy(problem.gf)
    problem.load.Set(1.7)
    for look in (contact.Table, lambda: (contact.Commit(problem.gf), contact.Evaluate(problem.gf))):
        look()
        failing = ContactConvergenceError, "no convergence in 1 iterations"
        unchanged(solver, lambda s: s.Solve(maxit=1, printing=False), *failing)
    assert contact.Table()["slip"] == pytest.approx(0, abs=1e-15)
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
    monkeypatch.setattr(Bodies, "Freedom", raising(MemoryError()))
    tool.load.Set(0.7)
    unchanged(tool, lambda t: t.solver.Solve(printing=False), MemoryError)


# --- states that do not fit ----------------------------------------------------------------------

TEXT = "must be what State"
REFUSED = [
    ("contact.SetState(state | {'memory': np.zeros(1)}, gf)", "memory"),
    ("contact.SetState(state | {'c': np.zeros(0)}, gf)", "'c'"),
    ("contact.SetState(state | {'paired': np.ones(3)}, gf)", r"state\['paired'\] has 3 entries"),
    ("contact.SetState(state | {'accepted': None}, gf)", "."),
    ("contact.SetState(state | {'states': 'text'}, gf)", rf"state\['states'\] = 'text' {TEXT}"),
    ("contact.SetState(state | {'scaled': None}, gf)", rf"state\['scaled'\] = None {TEXT}"),
    ("contact.SetState({})", "state"),
    ("contact.SetState({'paired': None})", "state"),
    ("contact.SetState(3)", "state"),
    ("solver.SetState(whole | {'contacts': []})", "state is that of 0 contacts, the solver has 1"),
    ("solver.SetState(whole | {'gf': np.zeros(3)})", "values of gf, .* before the space was refi"),
    # Not even the solution comes, which is first.
    ("solver.SetState(whole | {'gf': gf0, 'contacts': [state | {'memory': gf0}]})", "memory"),
    *(
        (f"solver.SetState(whole | {{'{key}': 'text'}})", rf"state\['{key}'\] = 'text' {TEXT}")
        for key in ("contacts", "history", "residual", "scale")
    ),
]


@KINDS
def test_a_state_that_does_not_fit_changes_nothing(name):
    tool = half(name)
    solver, (contact,), before = tool.solver, tool.solver.contacts, seen(tool)
    names = {"solver": solver, "contact": contact, "gf": solver.gf, "gf0": 2 * numpy(solver.gf)}
    names |= {"whole": solver.State(), "state": contact.State()}
    for row in REFUSED:
        check_refused((*row, (TypeError, ValueError, NgException)), **names)
        assert same(before, seen(tool)) == set(before)


def test_a_contact_as_it_was_before_its_first_solve():
    """It was paired then, but had no scale: the next solve finds one."""
    problem = press()
    problem.contact.Update()
    state = problem.contact.State()
    for _ in range(2):
        problem.gf.vec[:] = 0
        problem.solver().Solve(printing=False)
        assert np.all(problem.contact.form.History()["c"] > 0)
        problem.contact.SetState(state)
    assert not np.any(problem.contact.form.History()["c"])


@KINDS
def test_unpaired_and_strided_states(name):
    """Back before the first pairing, nothing of it is left."""
    tool = half(name)
    (contact,), gf = tool.solver.contacts, tool.solver.gf
    before, state = seen(tool), contact.State()
    contact.SetState({"paired": None, "scaled": False})
    assert not np.any(numpy(contact.pressure))
    with pytest.raises(NgException, match="no pairing yet"):
        contact.Force()
    arrays = {key: value for key, value in state.items() if isinstance(value, np.ndarray)}
    strided = {key: np.repeat(value, 2)[::2] for key, value in arrays.items()}
    contact.SetState(state | strided, gf)
    assert same(before, seen(tool)) == set(before)


@KINDS
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
