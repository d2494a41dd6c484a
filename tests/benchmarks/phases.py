"""Where the time of a load step goes: Hertz' problem in 2D, P2, on a sequence of meshes.

One load step (a tenth of the load, from zero) with and without friction, split into its phases,
and beside it a linear elasticity problem on the same mesh: the same two bodies with the contact
edge of the cylinder held, assembled and solved once by the same kind of direct solver.

    python tests/benchmarks/phases.py --levels 6 --picture phases.png

All times are wall times by `time.perf_counter` around the calls that the solver makes (table
`CALLS`; a call inside another one counts for the inner one only); "rest" is what is left: vectors,
stopping test, scaling. The fastest of the repetitions counts as a whole.
"""

from __future__ import annotations

import argparse
import json
import time
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from unittest.mock import patch

import numpy as np
from _scaling_problems import HERTZ_FORCE, Bulk
from ngsolve import (
    BilinearForm,
    GridFunction,
    TaskManager,
    VectorH1,
)

import ngslac.linear.solver
from ngslac import ContactSolver, LACContact, LACSpace
from ngslac._ngslac import ContactForm
from ngslac.bodies.bodies import Bodies
from ngslac.linear.factor import OneBLASThread
from ngslac.linear.solver import LinearSolver
from ngslac.meshes import HertzMesh, PointForce

CALLS = {
    "pairing": [(ContactForm, "Update")],
    "contact": [
        (ContactForm, name)
        for name in ("AddApply", "AssembleLinearization", "AssembleStep", "Evaluate")
    ],
    "bulk": [(BilinearForm, "AssembleLinearization"), (BilinearForm, "Apply")],
    "merge": [(ngslac.linear.solver, "MergeMatrices")],
    "solve": [(LinearSolver, "Solve")],
    "floating": [(Bodies, "__init__"), (Bodies, "Floating")],  # is a body held by nothing?
}
PHASES = (*CALLS, "rest")
# Edge length in the contact zone and netgen's grading (None: as HertzMesh chooses it).
MESHES = ((1.0, None), (0.5, None), (0.25, None), (0.125, None), (0.0625, 0.06), (0.03125, 0.05))
STEP = 0.1  # part of the load
SOLVERS = ("umfpack", "sparsecholesky")


@dataclass(frozen=True)
class Row:
    """One mesh; times in seconds."""

    h: float
    friction: float
    ndof: int
    macros: int
    iterations: int
    total: float
    phases: dict
    elastic: dict  # solver -> seconds for assembly, factorisation and solution
    force: float  # contact force over load
    residual: dict  # solver -> relative residual of the elastic problem

    def Ratio(self, inverse):
        """Time of the contact step over that of the elastic problem."""
        return self.total / self.elastic[inverse]


# ---------------------------------------------------------------- stop watch


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


# ---------------------------------------------------------------- the two problems


def BulkForm(space, mesh, u, v):
    """The elastic energy's derivative."""
    form = BilinearForm(space)
    form += Bulk(mesh, u, v)
    return form


def ContactStep(mesh, friction, inverse):
    """One load step; returns its Newton iterations, the force over the load, and the phases."""
    V = VectorH1(mesh, order=2, dirichletx="sym", dirichlety="bottom")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    bulk = BulkForm(X, mesh, u, v)
    contact = LACContact(u, lam, master="master", friction=friction or None)
    load = PointForce(X, (0, -STEP * HERTZ_FORCE), component=0)
    gf = GridFunction(X)
    watch = StopWatch()
    with watch.Running():
        contact.Update(gf)
        last = ContactSolver(bulk, gf, contact, rhs=load, inverse=inverse).Solve(printing=False)
    return last.number, float(contact.Force()[1] / (STEP * HERTZ_FORCE)), watch.seconds


def ElasticSolve(mesh, inverse):
    """Assemble and solve linear elasticity; returns the seconds and the relative residual."""
    V = VectorH1(mesh, order=2, dirichletx="sym", dirichlety="bottom|slave")
    u, v = V.TnT()
    load = PointForce(V, (0, -STEP * HERTZ_FORCE))
    gf = GridFunction(V)
    start = time.perf_counter()
    with OneBLASThread():
        form = BulkForm(V, mesh, u, v).Assemble()
        gf.vec.data = form.mat.Inverse(V.FreeDofs(), inverse=inverse) * load
    seconds = time.perf_counter() - start
    residual = load.CreateVector()
    residual.data = load - form.mat * gf.vec
    free = np.fromiter((bool(b) for b in V.FreeDofs()), dtype=bool, count=V.ndof)
    norm = np.linalg.norm(load.FV().NumPy()[free])
    return seconds, float(np.linalg.norm(residual.FV().NumPy()[free]) / norm)


def Measure(h, friction=0.2, *, grading=None, inverse=None, repeat=3):
    """Time both problems on one mesh."""
    mesh = HertzMesh(h, grading=grading)
    with TaskManager():
        steps = [ContactStep(mesh, friction, inverse) for _ in range(repeat)]
        elastic = {s: [ElasticSolve(mesh, s) for _ in range(repeat)] for s in SOLVERS}
    iterations, force, phases = min(steps, key=lambda step: sum(step[2].values()))
    V = VectorH1(mesh, order=2)
    return Row(
        h=h,
        friction=friction,
        ndof=V.ndof,
        macros=LACSpace(V, slave="slave").nmacros,
        iterations=iterations,
        total=sum(phases.values()),
        phases=phases,
        elastic={s: min(t for t, _ in runs) for s, runs in elastic.items()},
        force=force,
        residual={s: max(r for _, r in runs) for s, runs in elastic.items()},
    )


# ---------------------------------------------------------------- output


def Head():
    """The titles of the columns."""
    left = f"{'h':>7} {'ndof':>7} {'macros':>6} {'it':>3} {'total s':>8}"
    middle = " ".join(f"{phase:>8}" for phase in PHASES)
    return f"{left} | {middle} | {'umfpack':>8} {'ratio':>6} | {'cholesky':>8} {'ratio':>6}"


def Line(row):
    """One row; phases in per cent of the total, elastic problem in seconds."""
    left = f"{row.h:7g} {row.ndof:7d} {row.macros:6d} {row.iterations:3d} {row.total:8.3f}"
    middle = " ".join(f"{100 * row.phases[phase] / row.total:7.1f}%" for phase in PHASES)
    right = " | ".join(f"{row.elastic[s]:8.3f} {row.Ratio(s):6.1f}" for s in SOLVERS)
    return f"{left} | {middle} | {right}"


def Picture(rows, file):
    """Bars of the phases for each mesh, the elastic problem as a mark; frictions side by side."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    frictions = sorted({row.friction for row in rows})
    figure, (all_axes,) = plt.subplots(
        1, len(frictions), figsize=(10, 4.5), sharey=True, squeeze=False, layout="constrained"
    )
    for axes, friction in zip(all_axes, frictions, strict=True):
        _Bars(axes, [row for row in rows if row.friction == friction])
        axes.set(xlabel="displacement dofs", title=f"friction {friction:g}")
    all_axes[0].set(ylabel="microseconds per dof")
    all_axes[0].legend(loc="upper left")
    figure.suptitle("One load step of Hertz' problem, and one elastic solve on the same mesh")
    figure.savefig(file, dpi=150)
    plt.close(figure)


def _Bars(axes, rows):
    places, bottom = np.arange(len(rows)), np.zeros(len(rows))
    for phase in PHASES:
        heights = np.array([1e6 * row.phases[phase] / row.ndof for row in rows])
        axes.bar(places, heights, 0.6, bottom, label=phase)
        bottom += heights
    for solver, mark in zip(SOLVERS, "ox", strict=True):
        values = [1e6 * row.elastic[solver] / row.ndof for row in rows]
        axes.plot(places, values, "k" + mark, label=f"elastic, {solver}")
    axes.set_xticks(places, [f"{row.ndof}" for row in rows])


def main(argv=None):
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--levels", type=int, default=4, choices=range(1, len(MESHES) + 1))
    parser.add_argument("--repeat", type=int, default=3, help="runs; the fastest counts")
    parser.add_argument("--inverse", help="solver of the contact step (default as ContactSolver)")
    parser.add_argument("--json", metavar="FILE", help="write the rows to this file")
    parser.add_argument("--picture", metavar="FILE", help="draw the rows")
    options = parser.parse_args(argv)
    rows = []
    for friction in (0.0, 0.2):
        print(
            f"\nfriction {friction:g}: one load step | shares | elastic: seconds, contact/elastic"
        )
        print(Head())
        for h, grading in MESHES[: options.levels]:
            given = {"grading": grading, "inverse": options.inverse, "repeat": options.repeat}
            rows.append(Measure(h, friction, **given))
            print(Line(rows[-1]), flush=True)
    if options.json:
        Path(options.json).write_text(json.dumps([asdict(row) for row in rows], indent=2) + "\n")
    if options.picture:
        Picture(rows, options.picture)


if __name__ == "__main__":
    main()
