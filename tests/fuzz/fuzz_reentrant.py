"""Calls from within calls, from threads, and of copies."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import ngsolve as ngs
import numpy as np
from fuzz_strange import Refine
from fuzz_world import Elastic, Problem
from ngsolve import CF, H1, FESpace, Grad, GridFunction, ds, dx

import ngslac as lac

__all__ = ["REENTRANT", "REENTRANT_LEGAL"]


def Within(action, steps=0):
    """Solve with a callback, or step, on a problem that takes iterations."""
    problem = Problem()
    options = {"printing": False, "callback": lambda *given: action(problem)}
    if not steps:
        return problem.solver.Solve(**options)
    problem.load.Set(0)
    return lac.LoadStepper(problem.solver, problem.load).Integrate(steps=steps, **options)


def SetNaN(problem):
    problem.gf.vec[0] = np.nan


def Raise(problem):
    raise ValueError("callback said no")


def Other(problem):
    lac.ContactSolver(problem.a, problem.gf, problem.contact).Solve(printing=False)


def InThreads(work, several=4):
    with ThreadPoolExecutor(several) as pool:
        return [future.result() for future in [pool.submit(work) for _ in range(several)]]


def Alternating():
    """Two solvers of one contact take turns."""
    problem = Problem()
    second = lac.ContactSolver(problem.a, problem.gf, problem.contact)
    for solver in (problem.solver, second, problem.solver, second):
        problem.load.Set(problem.load.Get() * 1.1)
        solver.Solve(printing=False)


def Changing(name, *values):
    """A parameter of the law that gets wrong values after the first solve."""
    parameter = ngs.Parameter(values[0])
    problem = Problem(**({"friction": None} | {name: parameter}))
    for value in values:
        parameter.Set(value)
        problem.Solve()


def Fields(nested):
    """Displacement and lam among other fields, in a product of products if `nested`."""
    problem = Problem()
    T, V, Q = H1(problem.mesh, order=1), problem.V, problem.Q
    X = FESpace([FESpace([T, V]), Q]) if nested else FESpace([T, V, Q])
    trial, test = X.TnT()
    if nested:
        ((t, u), lam), ((s, v), _) = trial, test
    else:
        (t, u, lam), (s, v, _) = trial, test
    a = ngs.BilinearForm(X)
    a += Elastic(u, v) + (Grad(t) * Grad(s) + t * s) * dx
    a += 10 * (u - CF((0.01, -0.02))) * v * ds("top") + 10 * u * v * ds("bottom")
    contact = lac.LACContact(u, lam, master="master", friction=0.3)
    lac.ContactSolver(a, GridFunction(X), contact).Solve(printing=False)
    assert abs(contact.Force()[1]) > 1e-6


def InTwo():
    with ngs.TaskManager(), ngs.TaskManager():
        Problem().Converged()


# Words of which the message has to hold one: name: what is done.
REENTRANT = {
    "callback|gf": {
        "callback that sets NaN": lambda w: Within(SetNaN),
        "callback that sets NaN between steps": lambda w: Within(SetNaN, steps=3),
    },
    "callback|refined|mesh": {
        "callback that refines": lambda w: Within(Refine),
        "callback that refines between steps": lambda w: Within(Refine, steps=3),
    },
    "callback": {"callback that raises": lambda w: Within(Raise)},
    "callback|Solve": {
        "callback that solves again": lambda w: Within(Problem.Solve),
        "callback that solves by another solver": lambda w: Within(Other),
    },
    "friction": {
        "friction that becomes NaN": lambda w: Changing("friction", 0.1, float("nan")),
        "friction that becomes negative": lambda w: Changing("friction", 0.1, -1),
    },
    "tresca": {"tresca that becomes infinite": lambda w: Changing("tresca", 0.1, np.inf)},
    "LACContact|SaveState": {"a pickled contact": lambda w: pickle.dumps(w.contact)},
    "ContactSolver|SaveState": {"a pickled solver": lambda w: pickle.dumps(w.solver)},
    "solver": {
        "a stepper on a stepper's solver": lambda w: lac.TimeStepper(
            w.times.solver, 1.0, dt=0.1
        ).Integrate(0.1, printing=False),
    },
    "copied": {
        f"a copy of {name}": lambda w, name=name: copy.copy(getattr(w, name))
        for name in ("contact", "solver", "form", "loads", "times")
    },
    "LACContact|copy": {"a deep copy of a contact": lambda w: copy.deepcopy(w.contact)},
    "ContactSolver|copy": {"a deep copy of a solver": lambda w: copy.deepcopy(w.solver)},
}

REENTRANT_LEGAL = {
    "callback that steps back": lambda w: Within(lambda p: p.gf.vec.FV().NumPy().sum()),
    "problems in threads": lambda w: InThreads(lambda: Problem().Converged()),
    "one contact in threads": lambda w: InThreads(lambda: (w.contact.Table(), w.contact.Check())),
    "solvers that take turns": lambda w: Alternating(),
    "fields before the displacement": lambda w: Fields(False),
    "fields in a nested product": lambda w: Fields(True),
    "solved twice": lambda w: Problem().Solve().Solve(),
    "solve in a TaskManager in a TaskManager": lambda w: InTwo(),
    "a sum in Newton's method": lambda w: lac.FormSum(w.a, w.contact).AssembleLinearization(
        w.gf.vec
    ),
}
