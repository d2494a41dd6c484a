"""Measured solutions: one with contact by phases, a linear elastic one."""

from __future__ import annotations

import gc
import re
import resource
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import patch

from benchmark_elastic import SolveForm
from ngsolve import BilinearForm, TaskManager

import ngslac.linear.system
from ngslac import ContactSolver, LoadStepper
from ngslac._ngslac import ContactForm
from ngslac.bodies.bodies import Bodies
from ngslac.linear.solver import LinearSolver

__all__ = ["PHASES", "Meter", "SolveContact", "SolveElastic", "StopWatch"]

FORM = ("AddApply", "AssembleLinearization", "AssembleStep", "Evaluate")
CALLS = {
    "pairing": [(ContactForm, "Update")],
    "contact": [(ContactForm, name) for name in FORM],
    "bulk": [(BilinearForm, name) for name in ("Assemble", "AssembleLinearization", "Apply")],
    "merge": [(ngslac.linear.system, "MergeMatrices")],
    "solve": [(LinearSolver, "Solve")],
    "floating": [(Bodies, "__init__"), (Bodies, "Freedom")],  # is a body held by nothing?
}
PHASES = (*CALLS, "rest")


class StopWatch:
    """Seconds per phase; an inner phase stops the clock of the outer one."""

    def __init__(self):
        self.seconds = dict.fromkeys(PHASES, 0.0)
        self._running = ["rest"]
        self._since = time.perf_counter()

    def _Book(self):
        now = time.perf_counter()
        self.seconds[self._running[-1]] += now - self._since
        self._since = now

    @contextmanager
    def Phase(self, name):
        """The block counts for the phase `name`."""
        self._Book()
        self._running.append(name)
        try:
            yield
        finally:
            self._Book()
            self._running.pop()

    def _Timed(self, phase, call):
        def Call(*args, **options):
            with self.Phase(phase):
                return call(*args, **options)

        return Call

    @contextmanager
    def Running(self):
        """Within the block the calls of `CALLS` are timed, and everything else is "rest"."""
        with ExitStack() as patches:
            for phase, calls in CALLS.items():
                for owner, name in calls:
                    timed = self._Timed(phase, getattr(owner, name))
                    patches.enter_context(patch.object(owner, name, timed))
            self._since = time.perf_counter()
            yield
            self._Book()


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

    def Figures(self):
        return {"wall": self.wall, "cpu": self.cpu, "memory": self.memory}


def ForgetPeak():
    """Begin anew to look for the peak memory of this process, where the system can do that."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return False
    return True


def PeakMemory():
    """Peak of the resident memory of this process in GB."""
    status = Path("/proc/self/status")
    found = re.search(r"VmHWM:\s*(\d+) kB", status.read_text()) if status.exists() else None
    kilobytes = int(found[1]) if found else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return kilobytes * 1024 / 1e9


def SolveContact(problem, mesh, *, steps=1, **options):
    """Solve a contact problem as a user would; its contact, solver, steps, and what it took.

    The clock runs from the first form to the last converged step: assembly of the bulk, pairing and
    all iterations. Mesh and spaces exist before.
    """
    watch = StopWatch()
    with TaskManager():
        fes = problem.Product(mesh)
        with Meter() as meter, watch.Running():
            a, contact, load, gf = problem.Contact(fes)
            solver = ContactSolver(a, gf, contact, **options)
            history = LoadStepper(solver, load).Integrate(1.0, steps=steps, printing=False)
    return SimpleNamespace(
        contact=contact,
        linear=solver.linear,
        ndof=gf.components[0].space.ndof,
        iterations=[step.iterations for step in history],
        error=problem.Imbalance(contact.Force()),
        figures=meter.Figures(),
        phases=dict(watch.seconds),
    )


def SolveElastic(problem, mesh, variant):
    """Assemble and solve linear elasticity once; returns the dofs, and the figures."""
    with TaskManager():
        return SolveForm(*problem.Elastic(mesh), variant, Meter())
