"""The runs of `scaling.py`: a contact solution, elastic solves, each in a process of its own."""

from __future__ import annotations

import gc
import multiprocessing
import re
import resource
import time
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from _scaling_problems import Problem
from ngsolve import Projector, TaskManager
from phases import StopWatch

from ngslac import ContactSolver, LoadStepper
from ngslac.linear.factor import HasMKL, OneBLASThread

# Kind of run -> is there friction, number of load steps.
KINDS = {"frictionless": (False, 1), "friction": (True, 1), "ten_steps": (True, 10)}
# Ways to solve a linear elastic problem: solver and flags. Unless told, Pardiso takes a matrix for
# unsymmetric that is not symmetric to the last bit, and refines each solution up to 16 times.
METIS = {"ordering": "metis", "refinement": 0}
VARIANTS = {
    "pardiso": ("pardiso", METIS),
    "pardiso symmetric": ("pardiso", METIS | {"symmetric": True}),
    "pardiso spd": ("pardisospd", METIS | {"symmetric": True}),
    "sparsecholesky": ("sparsecholesky", {}),
    "umfpack": ("umfpack", {}),
}


@dataclass(frozen=True)
class Row:
    """One run; times in seconds, memory in GB. What a kind of run does not have is None."""

    problem: str
    size: int  # as asked for
    kind: str  # of `KINDS`, or "elastic"
    ndof: int  # displacements
    wall: float
    cpu: float
    memory: float  # peak while solving, everything of the process
    inverse: str | None  # name of the elastic variant, method of the contact solver
    error: float  # force balance, or relative residual of the elastic solve
    macros: int | None = None
    iterations: list | None = None  # Newton, per step
    krylov: int | None = None
    factorisations: int | None = None
    phases: dict = field(default_factory=dict)  # seconds, see phases.py
    variants: dict = field(default_factory=dict)  # elastic: name -> wall, cpu, memory, error

    @property
    def share(self):
        """Pairing and contact assembly over the whole."""
        return (self.phases["pairing"] + self.phases["contact"]) / sum(self.phases.values())


# ---------------------------------------------------------------- meters


class Meter:
    """Wall and processor time and peak memory of a block."""

    def __enter__(self):
        gc.collect()
        ForgetPeak()
        self._start = time.perf_counter(), time.process_time()
        return self

    def __exit__(self, *_):
        self.wall = time.perf_counter() - self._start[0]
        self.cpu = time.process_time() - self._start[1]
        self.memory = PeakMemory()


def ForgetPeak():
    """Begin anew to look for the peak memory of this process, where the system can do that."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return False
    return True


def PeakMemory():
    """Peak of the resident memory of this process in GB."""
    try:
        found = re.search(r"VmHWM:\s*(\d+) kB", Path("/proc/self/status").read_text())
    except OSError:
        found = None
    kilobytes = int(found[1]) if found else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return kilobytes * 1024 / 1e9


# ---------------------------------------------------------------- runs


def ContactRun(name, size, kind, *, inverse=None, solver=None, printing=False):
    """Solve a contact problem as a user would; returns a `Row`.

    The clock runs from the first form to the last converged step: assembly of the bulk, pairing and
    all iterations. Mesh and spaces exist before.
    """
    with_friction, steps = KINDS[kind]
    problem = Problem(name, size, with_friction * FrictionOf(name))
    given = {} if solver is None else {"solver": solver}
    mesh, watch = problem.Mesh(), StopWatch()
    with TaskManager():
        model = problem.Model(mesh)
        with Meter() as meter, watch.Running():
            a, contact, load, gf = problem.Contact(model)
            newton = ContactSolver(a, gf, contact, inverse=inverse, **given)
            history = LoadStepper(newton, load).Integrate(steps=steps, printing=printing)
    linear = newton.linear
    return Row(
        problem=name,
        size=size,
        kind=kind,
        ndof=gf.components[0].space.ndof,
        wall=meter.wall,
        cpu=meter.cpu,
        memory=meter.memory,
        inverse=getattr(linear, "method", linear.inverse),
        error=problem.Imbalance(contact.Force()),
        macros=contact.space.nmacros,
        iterations=[step.iterations for step in history],
        krylov=getattr(linear, "krylov", None),
        factorisations=getattr(linear, "factorisations", None),
        phases=dict(watch.seconds),
    )


def FrictionOf(name):
    """Coefficient of friction of a problem."""
    return 0.2 if name == "hertz" else 0.3


def Variants(inverse=None):
    """Names of the elastic variants: those of a solver, or the fast ones of this installation."""
    if inverse is not None:
        named = [name for name, (solver, _) in VARIANTS.items() if solver.startswith(inverse)]
        return named or [inverse]
    return [
        name
        for name, (solver, _) in VARIANTS.items()
        if solver == "sparsecholesky" or (solver.startswith("pardiso") and HasMKL())
    ]


def ElasticRun(name, size, *, inverse=None, repeat=1):
    """Solve linear elasticity on the same mesh in each variant; the fastest makes the `Row`."""
    problem = Problem(name, size)
    mesh, tried = problem.Mesh(), {}
    with TaskManager():
        for variant in Variants(inverse):
            runs = [_ElasticSolve(problem, mesh, variant) for _ in range(repeat)]
            ndof, tried[variant] = min(runs, key=lambda run: run[1]["wall"])
    best = min(tried, key=lambda variant: tried[variant]["wall"])
    return Row(name, size, "elastic", ndof, inverse=best, variants=tried, **tried[best])


def _ElasticSolve(problem, mesh, variant):
    """Assemble, factorise and solve once; returns the dofs, and the figures."""
    solver, flags = VARIANTS.get(variant, (variant, {}))
    a, f = problem.Elastic(mesh)
    free, solution = a.space.FreeDofs(), f.vec.CreateVector()
    with Meter() as meter, OneBLASThread():
        a.Assemble()
        solution.data = a.mat.Inverse(free, inverse=solver, flags=flags) * f.vec
    residual = f.vec.CreateVector()
    residual.data = Projector(free, True) * (f.vec - a.mat * solution).Evaluate()
    error = residual.Norm() / f.vec.Norm()
    if not error < 1e-9:
        raise RuntimeError(f"{variant} left a relative residual of {error:.1e}")
    figures = {"wall": meter.wall, "cpu": meter.cpu, "memory": meter.memory, "error": error}
    return a.space.ndof, figures


def InProcess(function, *args, **options):
    """Call a function in a new process; None if that was killed, as for lack of memory."""
    spawn = multiprocessing.get_context("spawn")
    try:
        with ProcessPoolExecutor(1, mp_context=spawn) as pool:
            return pool.submit(function, *args, **options).result()
    except BrokenProcessPool:
        return None


def Fastest(rows):
    """The run of the shortest wall time, None if all were killed."""
    return min((row for row in rows if row is not None), key=lambda row: row.wall, default=None)


def Growth(dofs, values):
    """Exponent of n in the least squares line through the logarithms; nan for one point."""
    if len(dofs) < 2:
        return float("nan")
    return float(np.polyfit(np.log(dofs), np.log(values), 1)[0])
