"""A benchmark's problem by several processes: iterations, messages, memory, balance.

Contact of second order in one step on each number of ranks, which may be more than there are cores:
times mean something only where they are not. The first rank has no elements (none is for one rank).
Slip is the share of closed macro-elements that slip.

    python tests/benchmarks/parallel.py --size 20000 --ranks 1 2 4 8 --json parallel.json

Each column is of all ranks, or of the rank that has most. Ghosts are displacements that a rank has
besides its own ones. Messages are all bytes that a rank sends while it solves, those of NGSolve and
PETSc included, as Open MPI counts them; what a run that stops before the first form has sent, for
the mesh, does not count. Memory is the largest resident size; --json has that of this run, too.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "parallel"))

import numpy as np
from benchmark_frame import Markdown, Parser, WriteJSON
from benchmark_problems import SIZES, Problem
from ngsolve import GridFunction
from parallel_start import ENVIRONMENT, OPTIONS, missing

from ngslac import ContactSolver, LoadStepper
from ngslac.meshes import Distributed

SENT = re.compile(r"^[EI]\t\d+\t\d+\t(\d+) bytes", re.MULTILINE)  # to another rank
COUNT = ("--mca", "pml_monitoring_enable", "2", "--mca", "pml_monitoring_enable_output", "3")


# ---------------------------------------------------------------- one rank of a run


def Solved(mesh, problem, options):
    """Figures of the solution of a problem that are the same on all ranks."""
    a, contact, load, gf = problem.Contact(problem.Product(mesh))
    solver = ContactSolver(a, gf, contact, **options)
    begin = time.perf_counter()
    steps = LoadStepper(solver, load).Integrate(steps=1, printing=False)
    return {
        "seconds": time.perf_counter() - begin,
        "newton": sum(step.iterations for step in steps),
        "krylov": solver.linear.krylov,
        "factorisations": solver.linear.factorisations,
        "method": str(solver.linear),
        "force": float(contact.Force()[2]),
        "imbalance": problem.Imbalance(contact.Force()),
        "slip": Share(contact.Table()["status"]),
    }


def Share(status):
    """Of those that are closed how many slip (2)."""
    return float(np.mean(status[status > 0] == 2))


def Rank(given, options, *, solve, comm=None):
    """Figures of a run, with those of each rank as lists; None but on the first one."""
    problem = Problem(**given)
    mesh = Distributed(problem.Mesh, comm)
    V = problem.Space(mesh)
    found = {"ndof": V.ndofglobal} | (Solved(mesh, problem, options) if solve else {})
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6  # GB, of kB
    here = {"elements": mesh.ne, "local": len(GridFunction(V).vec), "memory": memory}
    each = [here] if comm is None else comm.gather(here)
    return None if each is None else found | {name: [e[name] for e in each] for name in here}


def Worker(arguments):
    """What mpiexec starts."""
    parser = argparse.ArgumentParser()
    parser.add_argument("file", type=Path)
    parser.add_argument("given", type=json.loads)
    args, comm = parser.parse_args(arguments), None
    if args.given.pop("distributed"):
        from mpi4py import MPI

        comm = MPI.COMM_WORLD
    figures = Rank(**args.given, comm=comm)
    if figures is not None:
        args.file.write_text(json.dumps(figures))


# ---------------------------------------------------------------- runs


def Start(ranks, folder, **given):
    """The figures of a run in processes of its own, with the bytes that each rank has sent."""
    file, count = folder / "figures.json", folder / "sent"
    given["distributed"] = ranks > 1
    command = [sys.executable, __file__, "--worker", str(file), json.dumps(given)]
    if ranks > 1:
        counting = (*COUNT, "--mca", "pml_monitoring_filename", str(count))
        command = ["mpiexec", *OPTIONS, *counting, "-n", str(ranks), *command]
    subprocess.run(command, env=os.environ | ENVIRONMENT, check=True)
    logs = [folder / f"sent.{rank}.prof" for rank in range(ranks) if ranks > 1]
    return json.loads(file.read_text()) | {"sent": [Sent(log) for log in logs] or [0]}


def Sent(log):
    """Bytes that Open MPI's log of a rank says it sent to others."""
    points, _, _ = log.read_text().partition("# OSC")
    return sum(map(int, SENT.findall(points)))


def Run(ranks, **given):
    """The row of a number of ranks."""
    with tempfile.TemporaryDirectory() as folder:
        mesh = Start(ranks, Path(folder), **given, solve=False)
    with tempfile.TemporaryDirectory() as folder:
        row = Start(ranks, Path(folder), **given, solve=True)
    row["sent"] = [all_ - before for all_, before in zip(row["sent"], mesh["sent"], strict=True)]
    row["memory_mesh"] = mesh["memory"]
    working = row["elements"][1:] or row["elements"]
    return row | {
        "ranks": ranks,
        "ghosts": sum(row["local"]) - row["ndof"],
        "balance": max(working) * len(working) / sum(working),
    }


def Line(row):
    """The cells of a row."""
    workers = slice(1, None) if row["ranks"] > 1 else slice(None)
    return [
        str(row["ranks"]),
        f"{row['ndof']}",
        f"{row['newton']}",
        f"{row['krylov']}",
        f"{row['slip']:.2f}",
        f"{row['ghosts']}",
        f"{row['sent'][0] / 1e6:.1f}",
        f"{max(row['sent'][workers]) / 1e6:.1f}",
        f"{row['memory'][0]:.2f}",
        f"{max(row['memory'][workers]):.2f}",
        f"{row['balance']:.2f}",
        f"{row['seconds']:.1f}",
    ]


HEAD = (
    "ranks", "dofs", "Newton", "Krylov", "slip", "ghosts", "sent by the first [MB]",
    "by others [MB]", "memory of the first [GB]", "of others [GB]", "most elements over mean",
    "time [s]",
)  # fmt: skip


def main(arguments=None):
    parser = Parser(__doc__)
    parser.add_argument("--problem", choices=SIZES, default="sphere")
    parser.add_argument("--size", type=int, default=20_000, help="displacements, as in SIZES")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4, 8])
    parser.add_argument("--friction", type=float, default=0.3)
    parser.add_argument("--solver", help="option of ContactSolver; default: its choice")
    args = parser.parse_args(arguments)
    if max(args.ranks) > 1 and (lacks := missing()):
        sys.exit(lacks)
    options = {"solver": args.solver} if args.solver else {}
    given = {"name": args.problem, "size": args.size, "friction": args.friction}
    rows = [Run(ranks, given=given, options=options) for ranks in args.ranks]
    print("\n".join(Markdown(HEAD, [Line(row) for row in rows])))
    print("; ".join(f"{row['ranks']} ranks: {row['method']}" for row in rows))
    WriteJSON(args.json, rows)


if __name__ == "__main__":
    Worker(sys.argv[2:]) if sys.argv[1:2] == ["--worker"] else main()
