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

from calculix_files import KINDS, ReadContact, ReadDisplacement, Solid, WriteInput
from meshes import BODIES
from metrics import YOUNG, Errors
from peercommand import Main, NotInstalledError

__all__ = ["Options", "Solve"]

STIFFNESS = {"hertz": 10.0, "sphere": 10.0, "patch": 1e4}


def Solve(mesh, arguments, watch):
    """Solve a problem; see `peercommand.Main`."""
    program = shutil.which("ccx")
    if not program:
        raise NotInstalledError("ccx not found: install CalculiX (apt-get install calculix-ccx)")
    stiffness, penalty = arguments.stiffness, arguments.variant == "penalty"
    if stiffness is None:
        stiffness = STIFFNESS[mesh.problem] if penalty else 0.0
    if stiffness <= 0 and penalty:
        raise ValueError("the penalty needs a positive --stiffness")
    solid, nodes = Solid(mesh, arguments.order), mesh.Points(arguments.order)
    contact = "surface to surface" if penalty else "mortar"
    kind = KINDS[mesh.dim, arguments.order]
    law = f"K = {stiffness:g} E/mm" if stiffness else "hard"
    with TemporaryDirectory() as folder:
        job = Path(folder) / "job"
        softer = min(YOUNG[name] for name in BODIES[mesh.problem])
        WriteInput(job.with_suffix(".inp"), solid, arguments, stiffness * softer)
        with watch.Running():
            log = Run(program, job)

        def Displacement():
            moved = ReadDisplacement(job.with_suffix(".dat"), len(nodes))
            return moved + mesh.Lowered(arguments.order) - nodes

        def Pressure():  # the nodes at z = 0 stand for the layer
            return ReadContact(job.with_suffix(".frd"), len(nodes))

        return {
            "version": Find(r"Version (\S+?),", log),
            "dofs": nodes.size,
            "equations": int(Find(r"number of equations\s+(\d+)", log)),
            "iterations": len(re.findall(r"^ *iteration +\d+", log, re.MULTILINE)),
            "settings": f"{contact}, {law}, {kind}, {arguments.linear_solver}",
            **Errors(mesh, arguments.order, Displacement, Pressure),
        }


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


def Options(parser):
    add = parser.add_argument
    add("--variant", choices=("penalty", "mortar"), default="penalty")
    add("--stiffness", type=float, help="over Young's modulus, 1/mm; mortar: 0 is hard")
    add("--linear-solver", default="SPOOLES", help="CalculiX' name")


if __name__ == "__main__":
    sys.exit(Main(Solve, peer="CalculiX", options=Options))
