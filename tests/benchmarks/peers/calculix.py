"""CalculiX (`ccx`) in the comparison.

    python tests/benchmarks/peers/calculix.py sphere sphere.npz --order 2 --json row.json

--variant penalty (default)
    Surface-to-surface contact: pressures by a penalty at integration points of the slave faces.
    `--stiffness` is in Young's moduli of the softer body per mm. Hertz' pressures are best with 10;
    the patch, which is always in contact, takes any.
--variant mortar
    Dual mortar contact, hard by default. Nodes of the slave that a symmetry plane holds carry no
    pressure.

--linear-solver
    CalculiX' name. SPOOLES is the only direct one of Debian's package `calculix-ccx`.

The time is that of a run of `ccx`, which reads its input and writes its results.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from boundary import Lowered
from calculix_files import ReadContact, ReadDisplacement, Solid, WriteInput
from metrics import YOUNG, LineErrors, PatchErrors, SphereErrors
from peercommand import Main, NotInstalledError

__all__ = ["Solve"]

STIFFNESS = {"hertz": 10.0, "sphere": 10.0, "patch": 1e4}


def Solve(mesh, arguments, watch):
    """Solve a problem; see `peercommand.Main`."""
    program = shutil.which("ccx")
    if not program:
        raise NotInstalledError("ccx not found: install CalculiX (apt-get install calculix-ccx)")
    if arguments.stiffness is None:
        arguments.stiffness = STIFFNESS[mesh.problem] if arguments.variant == "penalty" else 0.0
    if arguments.stiffness <= 0 and arguments.variant == "penalty":
        raise ValueError("the penalty needs a positive --stiffness")
    softer = min(YOUNG[name] for name in np.unique(mesh.materials).tolist())
    with TemporaryDirectory() as folder:
        job = Path(folder) / "job"
        WriteInput(
            job.with_suffix(".inp"),
            mesh,
            arguments.order,
            friction=arguments.friction,
            steps=arguments.steps,
            variant=arguments.variant,
            stiffness=arguments.stiffness * softer,
            linear_solver=arguments.linear_solver,
        )
        with watch.Running():
            log = Run(program, job)
        return {
            "version": Find(r"Version (\S+?),", log),
            "dofs": mesh.Points(arguments.order).size,
            "equations": int(Find(r"number of equations\s+(\d+)", log)),
            "iterations": len(re.findall(r"^ *iteration +\d+", log, re.MULTILINE)),
            "settings": Settings(mesh, arguments),
            **Errors(mesh, arguments.order, job),
        }


def Settings(mesh, arguments):
    """What was chosen, for the table."""
    contact = {"penalty": "surface to surface", "mortar": "mortar"}[arguments.variant]
    element = Solid(mesh, arguments.order).kind
    law = f"K = {arguments.stiffness:g} E/mm" if arguments.stiffness else "hard"
    return f"{contact}, {law}, {element}, {arguments.linear_solver}"


def Run(program, job):
    """Run ccx on the input file of `job`; returns what it prints."""
    threads = os.environ.get("OMP_NUM_THREADS") or str(len(os.sched_getaffinity(0)))
    result = subprocess.run(
        [program, job.name],
        cwd=job.parent,
        env=dict(os.environ, OMP_NUM_THREADS=threads),
        capture_output=True,
        text=True,
        errors="replace",
    )
    log = result.stdout + result.stderr
    finished = result.returncode == 0 and "Job finished" in log
    if not finished or "*ERROR" in log or not Completed(job.with_suffix(".sta")):
        solver = job.with_name("spooles.out")  # says what the log does not
        said = LastWords(log + (solver.read_text(errors="replace") if solver.exists() else ""))
        raise RuntimeError(f"ccx ended with {result.returncode}: {said}")
    return log


def LastWords(log):
    """The first error in what was printed, else the last line."""
    lines = [line.strip() for line in log.splitlines() if line.strip(" _*")]
    at = next((i for i, line in enumerate(lines) if "*ERROR" in line), len(lines) - 1)
    return " ".join(lines[max(at, 0) : max(at, 0) + 2])


def Completed(file):
    """Whether a .sta file ends at the total time 1."""
    rows = [line.split() for line in file.read_text().splitlines()] if file.exists() else []
    times = [float(row[4]) for row in rows if len(row) > 4 and row[0].isdigit()]
    return bool(times) and abs(times[-1] - 1) < 1e-6


def Find(pattern, log):
    """The last match in what ccx printed."""
    found = re.findall(pattern, log)
    if not found:
        raise ValueError(f"ccx printed no {pattern!r}")
    return found[-1]


def Errors(mesh, order, job):
    """The figures of `metrics`."""
    nodes = len(mesh.Points(order))
    if mesh.problem == "patch":
        displacement = ReadDisplacement(job.with_suffix(".dat"), nodes)
        return PatchErrors(mesh, displacement + Lowered(mesh, order) - mesh.Points(order))
    pressure = ReadContact(job.with_suffix(".frd"), nodes)
    if mesh.problem == "sphere":
        return SphereErrors(mesh.points, mesh.Faces(1, "slave"), pressure)
    slave = mesh.Nodes(order, "slave")  # those at z = 0 stand for the layer
    return LineErrors(mesh.points[slave, 0], pressure[slave])


def Options(parser):
    """What only CalculiX has."""
    parser.add_argument("--variant", choices=("penalty", "mortar"), default="penalty")
    parser.add_argument(
        "--stiffness", type=float, help="over Young's modulus, 1/mm; mortar: 0 is hard"
    )
    parser.add_argument("--linear-solver", default="SPOOLES", help="CalculiX' name")


if __name__ == "__main__":
    sys.exit(Main(Solve, peer="CalculiX", options=Options))
