"""What all peers share: command line, stop watch, JSON file, and how to fail.

A peer is a script that hands `Main` a function. It runs in a process of its own:

    python tests/benchmarks/peers/lac.py sphere sphere.npz --order 2 --json row.json

and ends with 0, with 3 if a program is not installed (`NotInstalledError`), and with 1 and a last
line that says why if anything else fails.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import time
from contextlib import contextmanager
from pathlib import Path

from meshes import HELD, Load

__all__ = ["Main", "NotInstalledError", "StopWatch"]

MISSING = 3
PROCESSES = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)


class NotInstalledError(Exception):
    """Raised with a sentence that says what to install."""


class StopWatch:
    """Wall seconds, processor seconds of the process and its children, of the `Running` blocks."""

    def __init__(self):
        self.seconds = self.cpu = 0.0

    @contextmanager
    def Running(self):
        wall, cpu = time.perf_counter(), ProcessorSeconds()
        try:
            yield
        finally:
            self.seconds += time.perf_counter() - wall
            self.cpu += ProcessorSeconds() - cpu


def ProcessorSeconds():
    """User and system time so far, of finished children, too."""
    return sum(u.ru_utime + u.ru_stime for u in map(resource.getrusage, PROCESSES))


def PeakMemory():
    """GB: of the process or of its largest child, whichever is more."""
    own, children = (resource.getrusage(who).ru_maxrss for who in PROCESSES)
    status = Path("/proc/self/status")  # unlike getrusage without the parent's share before exec
    if status.exists():
        line = next(x for x in status.read_text().splitlines() if x.startswith("VmHWM"))
        own = int(line.split()[1])
    return max(own, children) * 1024 / 1e9


def Main(solve, *, peer, options=None, argv=None):
    """Run a peer, by its name for the table, from the command line; returns the exit code.

    ``solve(mesh, arguments, watch)`` gets a `PeerMesh`, the parsed command line and a `StopWatch`
    for building, assembling and solving. It returns a dict with ``version``, ``dofs``,
    ``iterations`` (linear solves of all steps), ``settings`` (a short phrase) and the figures of
    `metrics`, or raises `NotInstalledError`. `options` adds options of its own to the parser.
    """
    parser, watch = argparse.ArgumentParser(), StopWatch()
    add = parser.add_argument
    add("problem", choices=HELD)
    add("mesh", help=".npz file of meshes.py")
    add("--order", type=int, choices=(1, 2), default=2)
    add("--friction", type=float, default=0.0)
    add("--steps", type=int, default=1)
    add("--json", metavar="FILE", required=True)
    if options:
        options(parser)
    arguments = parser.parse_args(argv)
    try:
        mesh = Load(arguments.mesh)
        if mesh.problem != arguments.problem:
            raise ValueError(f"{arguments.mesh} is a mesh of the problem {mesh.problem}")
        row = {"peer": peer, "problem": arguments.problem, "order": arguments.order}
        row |= solve(mesh, arguments, watch)
    except NotInstalledError as missing:
        print(missing)
        return MISSING
    except Exception as error:
        print(f"{type(error).__name__}: {' '.join(str(error).split())}", file=sys.stderr)
        return 1
    row |= {"h": mesh.h, "friction": arguments.friction, "steps": arguments.steps}
    row |= {"seconds": watch.seconds, "cpu": watch.cpu, "memory": PeakMemory()}
    Path(arguments.json).write_text(json.dumps(row, indent=2) + "\n")
    return 0
