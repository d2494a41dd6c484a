"""Where the time of a load step goes: Hertz' problem in 2D, P2, on a sequence of meshes.

One load step (a tenth of the load, from zero) with and without friction, split into its phases,
and beside it a linear elasticity problem on the same mesh, both bodies held, assembled and solved
once by direct solvers.

    python tests/benchmarks/phases.py --levels 6 --picture phases.png

All times are wall times by `time.perf_counter` around the calls that the solver makes (table
`CALLS` in `benchmark_runs.py`; a call inside another one counts for the inner one only); "rest" is
what is left: vectors, stopping test, scaling. The fastest of the repetitions counts as a whole.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from benchmark_frame import Columns, Parser, Picture, WriteJSON
from benchmark_problems import Problem
from benchmark_runs import PHASES, SolveContact, SolveElastic

from ngslac.meshes import HertzMesh

# Edge length in the contact zone and netgen's grading (None: as HertzMesh chooses it).
MESHES = ((1.0, None), (0.5, None), (0.25, None), (0.125, None), (0.0625, 0.06), (0.03125, 0.05))
STEP = 0.1  # part of the load
SOLVERS = ("umfpack", "sparsecholesky")
HEAD = ("h", "ndof", "macros", "it", "total s", *PHASES, "umfpack", "ratio", "cholesky", "ratio")


def Measure(h, friction=0.2, *, grading=None, repeat=3, **options):
    """One row: both problems on one mesh, times in seconds; options of `ContactSolver`."""
    problem, mesh = Problem("hertz", friction=friction), HertzMesh(h, grading=grading)
    runs = [SolveContact(problem, mesh, end=STEP, **options) for _ in range(repeat)]
    elastic = {s: [SolveElastic(problem, mesh, s)[1] for _ in range(repeat)] for s in SOLVERS}
    run = min(runs, key=lambda run: sum(run.phases.values()))
    return SimpleNamespace(
        h=h,
        friction=friction,
        ndof=run.ndof,
        macros=run.contact.space.nmacros,
        iterations=sum(run.iterations),
        total=sum(run.phases.values()),
        phases=run.phases,
        # Assembly, factorisation and solution.
        elastic={s: min(e["wall"] for e in each) for s, each in elastic.items()},
        force=float(-run.contact.Force()[1] / (STEP * problem.Load()[1])),  # over the load
        residual={s: max(e["error"] for e in each) for s, each in elastic.items()},
    )


def Line(row):
    """One row; phases in per cent of the total, elastic problem in seconds."""
    cells = [f"{row.h:g}", row.ndof, row.macros, row.iterations, f"{row.total:.3f}"]
    cells += [f"{100 * row.phases[phase] / row.total:.1f}%" for phase in PHASES]
    for solver in SOLVERS:
        seconds = row.elastic[solver]
        cells += [f"{seconds:.3f}", f"{row.total / seconds:.1f}"]
    return Columns(cells)


def Draw(rows, file):
    """Bars of the phases for each mesh, the elastic problem as a mark; frictions side by side."""
    frictions = sorted({row.friction for row in rows})
    title = "One load step of Hertz' problem, and one elastic solve on the same mesh"
    size = {"figsize": (10, 4.5), "sharey": True}
    with Picture(file, title, 1, len(frictions), **size) as (all_axes,):
        for axes, friction in zip(all_axes, frictions, strict=True):
            Bars(axes, [row for row in rows if row.friction == friction])
            axes.set(xlabel="displacement dofs", title=f"friction {friction:g}")
        all_axes[0].set(ylabel="microseconds per dof")
        all_axes[0].legend(loc="upper left")


def Bars(axes, rows):
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
    parser = Parser(__doc__)
    add = parser.add_argument
    add("--levels", type=int, default=4, choices=range(1, len(MESHES) + 1))
    add("--repeat", type=int, default=3, help="runs; the fastest counts")
    add("--inverse", help="solver of the contact step (default as ContactSolver)")
    add("--picture", metavar="FILE", help="draw the rows")
    options, rows = parser.parse_args(argv), []
    given = {"inverse": options.inverse, "repeat": options.repeat}
    for friction in (0.0, 0.2):
        title = "one load step | shares | elastic: seconds, contact/elastic"
        print(f"\nfriction {friction:g}: {title}\n{Columns(HEAD)}")
        for h, grading in MESHES[: options.levels]:
            rows.append(Measure(h, friction, grading=grading, **given))
            print(Line(rows[-1]), flush=True)
    WriteJSON(options.json, rows)
    if options.picture:
        Draw(rows, options.picture)


if __name__ == "__main__":
    main()
