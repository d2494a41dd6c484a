"""Calls from within calls, from threads, and of copies."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import ngsolve as ngs
import numpy as np
from fuzz_uses import Uses
from fuzz_world import Elastic, Problem
from ngsolve import CF, H1, FESpace, Grad, GridFunction, ds, dx

import ngslac as lac

__all__ = ["REENTRANT"]


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


Copy, DeepCopy, Pickled = copy.copy, copy.deepcopy, pickle.dumps
USES = """
[callback|gf]
callback that sets NaN | Within(SetNaN)
callback that sets NaN between steps | Within(SetNaN, steps=3)
[callback|refined|mesh]
callback that refines | Within(Refine)
callback that refines between steps | Within(Refine, steps=3)
[callback]
callback that raises | Within(Raise)
[callback|Solve]
callback that solves again | Within(Problem.Solve)
callback that solves by another solver | Within(Other)
[friction]
friction that becomes NaN | Changing("friction", 0.1, np.nan)
friction that becomes negative | Changing("friction", 0.1, -1)
[tresca]
tresca that becomes infinite | Changing("tresca", 0.1, np.inf)
[LACContact|SaveState]
a pickled contact | Pickled(w.contact)
[ContactSolver|SaveState]
a pickled solver | Pickled(w.solver)
[solver]
a stepper on a stepper's solver | Times(w.times)
[copied]
a copy of contact | Copy(w.contact)
a copy of solver | Copy(w.solver)
a copy of form | Copy(w.form)
a copy of loads | Copy(w.loads)
a copy of times | Copy(w.times)
[LACContact|copy]
a deep copy of a contact | DeepCopy(w.contact)
[ContactSolver|copy]
a deep copy of a solver | DeepCopy(w.solver)

[]
callback that steps back | Within(lambda p: p.gf.vec.FV().NumPy().sum())
problems in threads | InThreads(lambda: Problem().Converged())
one contact in threads | InThreads(lambda: (w.contact.Table(), w.contact.Check()))
solvers that take turns | Alternating()
fields before the displacement | Fields(False)
fields in a nested product | Fields(True)
solved twice | Problem().Solve().Solve()
solve in a TaskManager in a TaskManager | InTwo()
a sum in Newton's method | FormSum(w.a, w.contact).AssembleLinearization(w.gf.vec)
"""
REENTRANT = [*Uses(globals(), USES)]
