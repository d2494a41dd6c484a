"""Cases that fail, or in which a user's function does: all processes say so, and none waits."""

import signal
import threading

import numpy as np
from ngsolve import CF, BilinearForm, InnerProduct, LinearForm, VectorH1, ds
from parallel_problem import QUIET, problem, results
from parallel_shapes import block_on_block, disc_on_block
from parallel_small import YOUNG, floating_blocks
from parallel_world import case

from ngslac import ContactConvergenceError, ContactSolver, LACContact, LACSpace, LoadStepper


def refused(function, kinds=(Exception,)):
    """The name of the error that a function raises."""
    try:
        function()
    except kinds as error:
        return type(error).__name__
    raise AssertionError("nothing was raised")


def text(function):
    try:
        function()
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    raise AssertionError("nothing was raised")


@case
def too_far(world):
    """A step to a load without equilibrium: friction cannot hold the block."""
    made = floating_blocks(world.comm)
    v = made.X.TestFunction()[0]
    made.a += -(made.load**3) * InnerProduct(CF((0.9, 0)), v) * ds("top")
    stepper = LoadStepper(made.solver(), made.load, maxcuts=2)
    stepper.Integrate(0.25, steps=1, **QUIET)
    before = results(made)
    error = refused(lambda: stepper.Integrate(1.0, steps=1, **QUIET), ContactConvergenceError)
    after = results(made, error=error, load=made.load.Get(), steps=len(stepper.steps))
    return after | {f"before {name}": value for name, value in before.items()}


@case
def torn_off(world):
    """The upper block is pulled away: it floats."""
    made = floating_blocks(world.comm)
    made.load.Set(-1.0)
    error = refused(lambda: made.solver().Solve(**QUIET), ContactConvergenceError)
    return results(made, error=error)


@case
def too_few_iterations(world):
    made = problem(disc_on_block(world.comm), young=YOUNG, friction=0.3)
    made.u.Set(CF((0.02, -0.05)), definedon=made.mesh.Boundaries("top"))
    error = refused(lambda: made.solver().Solve(maxit=1, printing=False), ContactConvergenceError)
    return results(made, error=error)


@case
def unknown_slave(world):
    V = VectorH1(block_on_block(world.comm), order=2)
    return {"error": (text(lambda: LACSpace(V, slave="slav")), None)}


@case
def unknown_master(world):
    V = VectorH1(block_on_block(world.comm), order=2)
    u, lam = (V * LACSpace(V, slave="slave")).TrialFunction()
    return {"error": (text(lambda: LACContact(u, lam, master="mastr")), None)}


@case
def unknown_options(world):
    """The words are those of a single process."""
    made = problem(block_on_block(world.comm, 0.25))
    u, lam = made.X.TrialFunction()
    wrong = (
        lambda: LACContact(u, lam, mastr="master"),
        lambda: ContactSolver(made.a, made.gf, made.contacts, slver="direct"),
        lambda: ContactSolver(made.a, made.gf),
        lambda: LoadStepper(made.solver(), made.load, maxcutz=2),
        lambda: LoadStepper(3, made.load),
    )
    return {"errors": (" ".join(map(text, wrong)), None)}


@case
def negative_friction(world):
    """Which only those see that have slave faces."""
    made = problem(block_on_block(world.comm), friction=CF(-0.1))
    return {"error": (text(lambda: made.solver().Solve(**QUIET)), None)}


@case
def failing_callback(world):
    """In one process only; the step before it stays."""
    made = floating_blocks(world.comm)

    def callback(step):
        if step.number == 2 and world.rank == min(2, world.size - 1):
            raise ValueError("no more")

    stepper = LoadStepper(made.solver(), made.load)
    error = refused(lambda: stepper.Integrate(steps=3, callback=callback, **QUIET))
    return results(made, error=error, load=made.load.Get(), steps=len(stepper.steps))


@case
def failing_prescribe(world):
    """A function of the user that fails in one process."""
    made = problem(block_on_block(world.comm), friction=0.3)

    def values(gf):
        gf.components[0].Set(CF((0, -0.02 * made.load)), definedon=made.mesh.Boundaries("top"))
        if made.load.Get() > 0.6 and world.rank == min(2, world.size - 1):
            raise ValueError("not so far")

    stepper = LoadStepper(made.solver(), made.load, prescribe=values)
    error = refused(lambda: stepper.Integrate(steps=2, **QUIET))
    return results(made, error=error, load=made.load.Get(), steps=len(stepper.steps))


@case
def asking_callback(world):
    """A callback that asks for tables and integrals, of iterations and of steps."""
    made = floating_blocks(world.comm)
    (contact,), seen = made.contacts, []

    def step_done(step):
        seen.append([step.time, contact.Force()[1], contact.Table()["pressure"].max()])

    stepper = LoadStepper(made.solver(), made.load)
    stepper.Integrate(steps=2, callback=step_done, **QUIET)
    return results(made, seen=np.array(seen))


@case
def bad_loads(world):
    """Among them one that cannot be sent."""
    made = problem(block_on_block(world.comm, 0.25), friction=0.3)
    rhs = LinearForm(made.X)
    rhs += InnerProduct(CF((0, -1)), made.X.TestFunction()[0]) * ds("side")
    errors = [
        refused(lambda load=load: made.solver(rhs=lambda: load).Solve(**QUIET))
        for load in (None, made.gf, rhs)
    ]
    return {"errors": (" ".join(errors), None)}


@case
def bad_form(world):
    made = problem(block_on_block(world.comm, 0.25), friction=0.3)
    a = BilinearForm(made.X, symmetric_storage=True)
    return {"error": (text(lambda: ContactSolver(a, made.gf, made.contacts)), None)}


@case
def interrupted(world):
    """One process is, in the middle of its work; then all go on."""
    made = problem(block_on_block(world.comm, 0.25), friction=0.3)
    stepper = LoadStepper(made.solver(), made.load, prescribe={"top": made.load * CF((0, -1e-5))})
    stepper.Integrate(0.1, steps=1, **QUIET)
    before = signal.getsignal(signal.SIGINT)
    errors = []
    for rank in (0, world.size - 1):
        if world.rank == rank:
            threading.Timer(0.1, signal.raise_signal, (signal.SIGINT,)).start()
        endless = lambda: stepper.Integrate(made.load.Get() + 1, steps=10**5, **QUIET)  # noqa: E731
        errors.append(refused(endless, KeyboardInterrupt))
    assert signal.getsignal(signal.SIGINT) is before
    made.u.Set(CF((0, -0.02)), definedon=made.mesh.Boundaries("top"))
    made.solver().Solve(**QUIET)
    return {
        "errors": (" ".join(errors), None),
        "force": (made.contacts[0].Force()[1:], None),
    }


@case
def alone(world):
    """One process calls what the others do not, and all go on."""
    made = problem(block_on_block(world.comm, 0.25), friction=0.3)
    (contact,), errors = made.contacts, []
    for rank in (0, 1) if world.comm is not None and world.size > 1 else ():

        def Alone(rank=rank):
            if world.rank == rank:
                LACContact(*made.X.TrialFunction(), master="master")
            contact.Evaluate(made.gf)

        errors.append(refused(Alone))
    made.u.Set(CF((0.01, -0.02)), definedon=made.mesh.Boundaries("top"))
    made.solver().Solve(**QUIET)
    assert errors == ["OutOfStepError"] * len(errors)
    return results(made)
