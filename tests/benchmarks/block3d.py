"""A large frictional problem in 3D: a block pressed and pushed on a wider one, P2 tetrahedra.

Two load steps; prints unknowns, Newton iterations, the time of each phase and the peak memory.

    python tests/benchmarks/block3d.py --slave 15 --inverse pardiso

15 divisions of the slave face make 168,000 displacement unknowns. The phases are those of
`phases.py`; "setup" is the mesh, the spaces and the forms.
"""

from __future__ import annotations

import argparse
import json
import resource
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from ngsolve import (
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Parameter,
    Sym,
    TaskManager,
    VectorH1,
    ds,
    dx,
)
from phases import StopWatch

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import Stress
from ngslac.meshes import TwoBlocks3D

YOUNG, NU, FRICTION = 2000.0, 0.3, 0.3
PRESSURE, SHEAR = 25.0, (3.0, 1.0)  # on the top of the slave, area 1


@dataclass(frozen=True)
class Row:
    """One run; times in seconds, memory in GB."""

    ndof: int  # displacements
    macros: int
    inverse: str
    iterations: list  # per step
    status: list  # open, stick, slip macro-elements
    setup: float
    phases: dict
    memory: float
    balance: float  # of contact force and load, relative


def Problem(n):
    """Bulk form, load parameter, contact and solution for n divisions of the slave face."""
    mesh = TwoBlocks3D(
        "tet", n_slave=n, n_master=n + 1, layers=(max(1, n // 2), max(1, n // 2)), overhang=0.3
    )
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    fes = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    load = Parameter(0)
    a = BilinearForm(fes)
    a += InnerProduct(Stress(Sym(Grad(u)), YOUNG, NU), Sym(Grad(v))) * dx
    a += load * (PRESSURE * v[2] - SHEAR[0] * v[0] - SHEAR[1] * v[1]) * ds("top")
    return a, load, LACContact(u, lam, master="master", friction=FRICTION), GridFunction(fes)


def Measure(n, inverse=None, steps=2, printing=True):
    """Run the problem; returns a `Row`."""
    start = time.perf_counter()
    with TaskManager():
        a, load, contact, gf = Problem(n)
        solver = ContactSolver(a, gf, contact, inverse=inverse)
        setup = time.perf_counter() - start
        watch = StopWatch()
        with watch.Running():
            history = LoadStepper(solver, load).Integrate(steps=steps, printing=printing)
    force = contact.Force()
    balance = abs(force[2] - PRESSURE) + abs(force[0] + SHEAR[0]) + abs(force[1] + SHEAR[1])
    status = contact.Table()["status"]
    return Row(
        ndof=gf.space.components[0].ndof,
        macros=contact.space.nmacros,
        inverse=solver.linear.inverse,
        iterations=[step.iterations for step in history],
        status=[int((status == kind).sum()) for kind in range(3)],
        setup=setup,
        phases=dict(watch.seconds),
        memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
        balance=float(balance / PRESSURE),
    )


def main(argv=None):
    """Run from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--slave", type=int, default=15, help="divisions of the slave face")
    parser.add_argument("--inverse", help="sparse direct solver; default: that of ContactSolver")
    parser.add_argument("--json", metavar="FILE", help="write the figures to this file")
    options = parser.parse_args(argv)
    row = Measure(options.slave, options.inverse)
    for name, value in asdict(row).items():
        if name != "phases":
            print(f"{name:12} {value}")
    for name, seconds in row.phases.items():
        print(f"  {name:10} {seconds:9.2f} s")
    if options.json:
        Path(options.json).write_text(json.dumps(asdict(row), indent=2) + "\n")


if __name__ == "__main__":
    main()
