"""What contact costs in each class of problems, over linear elastic solves of the same mesh.

    python tests/benchmarks/classes.py --json classes.json
    python tests/benchmarks/classes.py --only "sphere*" "slave*"
    python tests/benchmarks/classes.py --quick

Processor seconds of one thread, in a process of its own for each class, with a limit of time.
"over_best" is the ratio to the best elastic solve of any kind, "over_direct" to the fastest direct
one (assembly and solution, see `benchmark_elastic.py`). Where "per" is "step" or "newton", seconds
and ratios are those of a step of time, or of a Newton iteration. "factorisations" are those of full
size: a method that iterates has none unless it was given up. A class that fails is not
"converged", and has a "reason".
"""

from __future__ import annotations

import fnmatch
import json
import math
import resource
import signal
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmark_elastic import ITERATIVE, FastDirect, Fastest, Iterative, SolveForm
from benchmark_frame import Markdown, Parser, WriteJSON
from benchmark_runs import Meter
from class_list import CLASSES
from compare import Execute
from ngsolve import SetNumThreads

__all__ = ["Measure", "Run", "Table", "main"]

LIMIT = 300.0  # processor seconds for a class
PATIENCE = 20  # wall time over processor time on a busy machine
NAMES = (
    "name",
    "dofs",
    "seconds",
    "newton",
    "krylov",
    "over_best",
    "over_direct",
    "memory",
    "method",
)
HEAD = ("class", "dofs", "per", "s", "Newton", "Krylov", "over best", "over direct", "GB", "method")


# ---------------------------------------------------------------- measurement


def Yardsticks(problem, mesh):
    """Figures of each elastic solver that solves linear elasticity on the mesh, by its name."""
    mixed, found = getattr(problem, "mixed", None), {}
    direct = ["umfpack"] if mixed else FastDirect()
    iterative = [] if mixed else Iterative(problem.Elastic(mesh)[0].space)
    for variant in (*direct, *iterative):
        try:
            found[variant] = SolveForm(*problem.Elastic(mesh), variant, Meter())[1]
        except Exception as error:  # solvers raise many kinds: this one does not serve
            print(f"  {variant}: {error}", file=sys.stderr, flush=True)
    return found


def Measure(name, *, quick=False, note=lambda row: None):
    """The row of a class, measured in this process: a dictionary, see above.

    Parameters
    ----------
    name : str
        Of `CLASSES`.
    quick : bool
        The small problem.
    note : callable
        Called with the row as it is before contact is solved, in case that this takes too long.
    """
    SetNumThreads(1)
    case = CLASSES[name]
    problem = (case.quick if quick else case.make)()
    mesh = problem.Mesh()
    row = {"name": name, "per": case.per, "elastic": Yardsticks(problem, mesh)}
    note(Failed(row))
    try:
        with Meter() as meter:
            solver, steps = case.run(case, problem, mesh)
    except Exception as error:  # whatever it is, it belongs into the table
        return Failed(row, f"{type(error).__name__}: {error}")
    return row | Figures(row, case, solver, steps, meter)


def Figures(row, case, solver, steps, meter):
    """What a converged run adds to its row."""
    newton, linear = sum(step.iterations for step in steps), solver.linear
    count = {"run": 1, "step": len(steps), "newton": max(newton, 1)}[case.per]
    seconds = meter.cpu / count
    direct = {name: run for name, run in row["elastic"].items() if name not in ITERATIVE}
    over = {
        key: seconds / runs[Fastest(runs, "cpu")]["cpu"] if runs else None
        for key, runs in (("over_best", row["elastic"]), ("over_direct", direct))
    }
    return over | {
        "dofs": solver.gf.components[0].space.ndof,
        "seconds": seconds,
        "newton": newton,
        "krylov": linear.krylov,
        "memory": meter.memory,
        "method": linear.method,
        "factorisations": linear.factorisations,
        "converged": True,
    }


def Failed(row, reason=None):
    """The row of a class that did not converge."""
    return dict.fromkeys(NAMES) | row | {"converged": False, "reason": reason}


def Run(name, folder, *, quick=False, limit=LIMIT):
    """The row of a class, measured in a process of its own."""
    file = Path(folder) / "row.json"
    file.unlink(missing_ok=True)
    command = [sys.executable, __file__, "--here", "--only", name, "--json", file]
    command += ["--limit", limit, *["--quick"] * quick]
    code, line = Execute(command, PATIENCE * limit, threads=1)
    rows = json.loads(file.read_text())["classes"] if file.exists() else []
    row = rows[0] if rows else Failed({"name": name})
    if code == 0:
        return row
    late = code in (None, -signal.SIGXCPU)
    return row | {"reason": f"stopped after {limit:g} s" if late else f"exit code {code}: {line}"}


def LimitProcessorTime(seconds):
    """The system ends this process after so many of them."""
    most = resource.getrlimit(resource.RLIMIT_CPU)[1]
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(seconds), most))


# ---------------------------------------------------------------- output


def Table(rows):
    """All rows as Markdown; below, why the others failed."""
    done = [row for row in rows if row["converged"]]
    lines = Markdown(HEAD, map(Cells, done)) if done else []
    return "\n".join([*lines, *(Line(row) for row in rows if not row["converged"])])


def Line(row):
    """One row for the terminal."""
    if not row["converged"]:
        return f"- {row['name']} fails: {row['reason']}"
    return "  ".join(Cells(row))


def Cells(row):
    counts = [str(row["newton"]), str(row["krylov"])]
    ratios = [f"{row[k]:.2f}" if row[k] else "-" for k in ("over_best", "over_direct")]
    method = row["method"]
    if method == "iterative" and row["factorisations"]:
        method += f" ({row['factorisations']} factorisations)"
    first = [row["name"], str(row["dofs"]), row["per"], f"{row['seconds']:.2f}"]
    return [*first, *counts, *ratios, f"{row['memory']:.2f}", method]


def Chosen(patterns):
    """Names of the classes that match one of the patterns, all without any."""
    names = [n for n in CLASSES if any(fnmatch.fnmatchcase(n, p) for p in patterns or ["*"])]
    if not names:
        raise SystemExit(f"--only {' '.join(patterns)}: there are {', '.join(CLASSES)}")
    return names


def main(argv=None):
    parser = Parser(__doc__)
    add = parser.add_argument
    add("--only", nargs="+", metavar="GLOB", default=[], help="names of classes")
    add("--quick", action="store_true", help="the smallest problem of each class")
    add("--limit", type=float, help=f"processor seconds for each class, {LIMIT:g} by default")
    add("--here", action="store_true", help="all in this process, which has the limit")
    options = parser.parse_args(argv)
    rows = []
    if options.here and options.limit:
        LimitProcessorTime(options.limit)
    with TemporaryDirectory() as folder:
        for name in Chosen(options.only):
            note = lambda row: WriteJSON(options.json, {"classes": [*rows, row]})  # noqa: E731
            if options.here:
                rows.append(Measure(name, quick=options.quick, note=note))
            else:
                limit = options.limit or LIMIT
                rows.append(Run(name, folder, quick=options.quick, limit=limit))
            print(Line(rows[-1]), flush=True)
            WriteJSON(options.json, {"classes": rows})
    print(Table(rows))


if __name__ == "__main__":
    main()
