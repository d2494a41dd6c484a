"""What contact costs over one linear elastic solve, as the mesh gets finer.

Second-order problems: two blocks ("patch", "patch_hex") and a sphere on a block in 3D, without
friction, with friction 0.3 in one step, and in ten; Hertz' problem in 2D with friction 0.2 in ten
steps. Beside each one a linear elastic problem on the same mesh, both bodies held, assembled and
solved once by the fastest direct solver at hand.

    python tests/benchmarks/scaling.py --sizes 20000 100000 300000 --picture scaling.png
    python tests/benchmarks/scaling.py --sizes 1000000 --problems sphere --solver iterative

Each run has a process of its own, whose peak memory counts. The clock stands still while mesh and
spaces are made.
"""

from __future__ import annotations

import argparse
import json
import math
from dataclasses import asdict
from pathlib import Path

from _scaling_output import Line, Markdown, Picture
from _scaling_problems import SIZES, Problem
from _scaling_runs import KINDS, ContactRun, ElasticRun, Fastest, InProcess, Row

# Beyond, no direct solver has the memory to solve the elastic problem in three dimensions.
LARGEST_DIRECT = 500_000
SMALL = 30_000  # these are run three times
DEFAULT_SIZES = (20_000, 100_000, 300_000)
ALL = ("elastic", *KINDS)


def Kinds(problem, size):
    """The kinds of runs of a problem."""
    if problem == "hertz":
        return ("elastic", "ten_steps")
    return ALL if size <= LARGEST_DIRECT else tuple(KINDS)


def Nearest(problem, ndof):
    """The size of a problem that is nearest to a number of dofs."""
    return min(SIZES[problem], key=lambda size: abs(math.log(size / ndof)))


def Measure(problem, size, kind, *, inverse=None, solver=None, repeat=None):
    """The fastest of some runs, each in a new process.

    Parameters
    ----------
    problem : {"patch", "patch_hex", "sphere", "hertz"}
    size : int
        Number of displacement dofs, of `SIZES`.
    kind : {"elastic", "frictionless", "friction", "ten_steps"}
    inverse, solver : str, optional
        As of `ContactSolver`, by default its own choice. The elastic problem takes the fastest
        variant of `inverse`, or of all that are installed.
    repeat : int, optional
        Number of runs, by default 3 for small sizes and else 1.

    Returns
    -------
    Row or None
        None if the process was killed, most likely for lack of memory.
    """
    repeat = repeat or (3 if size <= SMALL else 1)
    if kind == "elastic":
        return InProcess(ElasticRun, problem, size, inverse=inverse, repeat=repeat)
    options = {"inverse": inverse, "solver": solver}
    return Fastest(InProcess(ContactRun, problem, size, kind, **options) for _ in range(repeat))


def Ratios(ndof=100_000, inverse=None, solver=None, printing=True):
    """Times of the sphere problem as multiples of the elastic solve.

    Parameters
    ----------
    ndof : int
        Displacement dofs; the nearest size of the table is taken.
    inverse, solver : str, optional
        As of `Measure`.
    printing : bool
        One line per run.

    Returns
    -------
    dict
        ``frictionless_over_elastic``, ``friction_step_over_elastic`` and
        ``ten_steps_over_elastic`` (wall times), the same with ``_cpu`` at the end, ``ndof``, and
        ``seconds`` and ``cpu_seconds`` for each kind of run.
    """
    size, runs = Nearest("sphere", ndof), {}
    for kind in ALL:
        row = Measure("sphere", size, kind, inverse=inverse, solver=solver)
        if row is None:
            raise MemoryError(f"the {kind} run of {size} dofs was killed")
        runs[kind] = row
        if printing:
            print(Line(row), flush=True)
    return RatiosOf(runs)


def RatiosOf(runs):
    """The ratios of `Ratios` from the rows of each kind."""
    titles = {"frictionless": "frictionless", "friction": "friction_step", "ten_steps": "ten_steps"}
    elastic = runs["elastic"]
    ratios = {f"{t}_over_elastic": runs[kind].wall / elastic.wall for kind, t in titles.items()}
    ratios |= {f"{t}_over_elastic_cpu": runs[kind].cpu / elastic.cpu for kind, t in titles.items()}
    ratios["ndof"] = elastic.ndof
    ratios["seconds"] = {kind: row.wall for kind, row in runs.items()}
    ratios["cpu_seconds"] = {kind: row.cpu for kind, row in runs.items()}
    return ratios


def Table(problems, sizes, kinds=ALL, **options):
    """Run all; prints each row as it comes."""
    rows = []
    for problem in problems:
        for size in sizes:
            for kind in Kinds(problem, size):
                if kind not in kinds:
                    continue
                row = Measure(problem, size, kind, **options)
                if row is None:
                    print(f"{problem:9} {size:8d}  {kind:12} was killed", flush=True)
                    continue
                rows.append(row)
                print(Line(row), flush=True)
    return rows


def Load(file):
    """The rows of a JSON file."""
    return [Row(**row) for row in json.loads(Path(file).read_text())]


def main(argv=None):
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=DEFAULT_SIZES)
    parser.add_argument(
        "--problems", nargs="+", choices=[*SIZES], default=["patch", "sphere", "hertz"]
    )
    parser.add_argument("--kinds", nargs="+", choices=ALL, default=ALL, help="runs of each problem")
    parser.add_argument("--inverse", help="direct solver of contact and elastic problem")
    parser.add_argument("--solver", help="solver= of ContactSolver")
    parser.add_argument("--repeat", type=int, help="runs; the fastest counts")
    parser.add_argument("--json", metavar="FILE", help="write the rows to this file")
    parser.add_argument("--load", metavar="FILE", nargs="+", help="rows of earlier runs; run none")
    parser.add_argument("--picture", metavar="FILE", help="draw time and memory over dofs")
    parser.add_argument("--markdown", metavar="FILE", help="write the table of the README")
    options = parser.parse_args(argv)
    if options.load:
        rows = [row for file in options.load for row in Load(file)]
    else:
        for name in options.problems:
            for size in options.sizes:
                Problem(name, size).Parameters()  # complain now, not in an hour
        given = {name: getattr(options, name) for name in ("kinds", "inverse", "solver", "repeat")}
        rows = Table(options.problems, options.sizes, **given)
    if options.json:
        Path(options.json).write_text(json.dumps([asdict(row) for row in rows], indent=2) + "\n")
    if options.markdown:
        Path(options.markdown).write_text(Markdown(rows))
    if options.picture:
        Picture(rows, options.picture)
    return rows


if __name__ == "__main__":
    main()
