"""Calls from within calls, from threads, and of copies."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from fuzz_strange import P2, Problem
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    FESpace,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Parameter,
    Sym,
    TaskManager,
    Trace,
    ds,
    dx,
)

from ngslac import ContactSolver, FormSum, LACContact, LoadStepper, TimeStepper

__all__ = ["REENTRANT", "REENTRANT_LEGAL"]


def Within(action, **flags):
    """Solve with a callback, or step if `steps` are given, on a problem that takes iterations."""
    problem = Problem(P2)
    steps = flags.pop("steps", 0)
    callback = lambda *given: action(problem, *given)  # noqa: E731
    if not steps:
        problem.solver.Solve(printing=False, callback=callback, **flags)
        return problem
    problem.load.Set(0)
    LoadStepper(problem.solver, problem.load).Integrate(
        steps=steps, printing=False, callback=callback
    )
    return problem


def SetNaN(problem, *given):
    problem.gf.vec[0] = np.nan


def Refine(problem, *given):
    problem.mesh.Refine()
    for space in (problem.V, problem.Q, problem.X):
        space.Update()
    problem.gf.Update()


def Raise(problem, *given):
    raise ValueError("callback said no")


def Again(problem, *given):
    problem.solver.Solve(printing=False)


def Other(problem, *given):
    ContactSolver(problem.a, problem.gf, problem.contact).Solve(printing=False)


def InThreads(work, several=4):
    with ThreadPoolExecutor(several) as pool:
        return [future.result() for future in [pool.submit(work) for _ in range(several)]]


def Alternating():
    """Two solvers of one contact take turns."""
    problem = Problem(P2)
    second = ContactSolver(problem.a, problem.gf, problem.contact)
    for solver in (problem.solver, second, problem.solver, second):
        problem.load.Set(problem.load.Get() * 1.1)
        solver.Solve(printing=False)


def Changing(name, values):
    """A parameter of the law that gets wrong values after the first solve."""
    parameter = Parameter(values[0])
    problem = Problem(P2, **{name: parameter}, **({"friction": None} if name != "friction" else {}))
    for value in values:
        parameter.Set(value)
        problem.solver.Solve(printing=False)


def Fields(nested):
    """Displacement and lam among other fields, in a product of products if `nested`."""
    problem = Problem(P2)
    T, V, Q = H1(problem.mesh, order=1), problem.V, problem.Q
    X = FESpace([T, V, Q]) if not nested else FESpace([FESpace([T, V]), Q])
    trial, test = X.TnT()
    if nested:
        ((t, u), lam), ((s, v), _) = trial, test
    else:
        (t, u, lam), (s, v, _) = trial, test
    a, strain = BilinearForm(X), Sym(Grad(u))
    a += InnerProduct(2 * strain + 3 * Trace(strain) * Id(2), Sym(Grad(v))) * dx
    a += 10 * InnerProduct(u - CF((0.01, -0.02)), v) * ds("top") + 10 * u * v * ds("bottom")
    a += (Grad(t) * Grad(s) + t * s) * dx
    contact = LACContact(u, lam, master="master", friction=0.3)
    ContactSolver(a, GridFunction(X), contact).Solve(printing=False)
    assert abs(contact.Force()[1]) > 1e-6


def Twice(problem):
    """What is solved already."""
    problem.Solve()
    return problem.Solve()


# name: (what is done, words of which the message has to hold one)
REENTRANT = {
    "callback that sets NaN": (lambda w: Within(SetNaN), ("callback", "gf")),
    "callback that sets NaN between steps": (lambda w: Within(SetNaN, steps=3), ("callback", "gf")),
    "callback that refines": (lambda w: Within(Refine), ("callback", "refined", "mesh")),
    "callback that refines between steps": (
        lambda w: Within(Refine, steps=3),
        ("callback", "refined", "mesh"),
    ),
    "callback that raises": (lambda w: Within(Raise), ("callback",)),
    "callback that solves again": (lambda w: Within(Again), ("callback", "Solve")),
    "callback that solves by another solver": (lambda w: Within(Other), ("callback", "Solve")),
    "friction that becomes NaN": (
        lambda w: Changing("friction", (0.1, float("nan"))),
        ("friction",),
    ),
    "friction that becomes negative": (lambda w: Changing("friction", (0.1, -1)), ("friction",)),
    "tresca that becomes infinite": (lambda w: Changing("tresca", (0.1, np.inf)), ("tresca",)),
    "a pickled contact": (lambda w: pickle.dumps(w.contact), ("LACContact", "SaveState")),
    "a pickled solver": (lambda w: pickle.dumps(w.solver), ("ContactSolver", "SaveState")),
    "a stepper on a stepper's solver": (
        lambda w: TimeStepper(w.times.solver, 1.0, dt=0.1).Integrate(0.1, printing=False),
        ("solver",),
    ),
    **{
        f"a copy of {name}": (lambda w, name=name: copy.copy(getattr(w, name)), ("copied",))
        for name in ("contact", "solver", "form", "loads", "times")
    },
    "a deep copy of a contact": (lambda w: copy.deepcopy(w.contact), ("LACContact", "copy")),
    "a deep copy of a solver": (lambda w: copy.deepcopy(w.solver), ("ContactSolver", "copy")),
}

REENTRANT_LEGAL = {
    "callback that steps back": lambda w: Within(lambda p, *g: p.gf.vec.FV().NumPy().sum()),
    "problems in threads": lambda w: InThreads(lambda: Problem(P2).Converged()),
    "one contact in threads": lambda w: InThreads(lambda: (w.contact.Table(), w.contact.Check())),
    "solvers that take turns": lambda w: Alternating(),
    "fields before the displacement": lambda w: Fields(False),
    "fields in a nested product": lambda w: Fields(True),
    "solved twice": lambda w: Twice(Problem(P2)),
    "solve in a TaskManager in a TaskManager": lambda w: InTwo(),
    "a sum in Newton's method": lambda w: FormSum(w.a, w.contact).AssembleLinearization(w.gf.vec),
}


def InTwo():
    with TaskManager(), TaskManager():
        Problem(P2).Converged()
