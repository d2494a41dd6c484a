"""The GRECO slab on a rigid plane: friction 1, SI units, three zones along the contact line.

The problem is solved in 2D, and in 3D as a slice between two planes of symmetry (x along the
contact, y across the slice, z up). Refinement of the plane mesh to 64 x 64 cells moves the
displacements by less than 0.1 %.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from elasticity import Displacements, Material, Pair, Sorted
from exact_slab import GRECO_SLAB
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import CF, Mesh, Parameter
from ngsolve.meshes import MakeStructured2DMesh
from report_bounds import Stated
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREY, INK, Figure, Profile
from scipy.optimize import brentq

from ngslac.meshes.boxes import StructuredBox

__all__ = ["CASES", "SLICE", "Solve"]

CELLS = 32
SLICE = 0.002  # thickness


@dataclass(frozen=True)
class Solution:
    """Displacements along x at the abscissae of the reference, in metres; a `table` sorted by x."""

    displacement: np.ndarray
    across: np.ndarray  # displacements on the other side of the slice
    table: dict
    force: np.ndarray
    iterations: list


def PlaneMesh(length):
    width, height = GRECO_SLAB.width * length, GRECO_SLAB.height * length
    return MakeStructured2DMesh(
        quads=False, nx=CELLS, ny=CELLS, mapping=lambda x, y: (width * x, height * y)
    )


def Graded(first, length, n):
    """Points from 0 to `length`; their n spacings are a geometric series from `first`."""
    powers = np.arange(n)
    q = brentq(lambda q: first * np.sum(q**powers) - length, 1.0, 10.0, xtol=1e-14)
    return np.concatenate([[0.0], np.cumsum(q**powers)]) * length / np.sum(q**powers)


def SliceOfCells(kind, order, length):
    n = (12, 6) if order == 2 else (28, 14)
    along = Graded(0.02 / n[0], GRECO_SLAB.width, n[0])
    up = Graded(0.02 / n[1], GRECO_SLAB.height, n[1])
    mesh = NetgenMesh(dim=3)
    grid = (length * g for g in (along, np.array([0.0, SLICE]), up))
    StructuredBox(*grid, kind).AddTo(mesh, "slab")
    mesh.Compress()
    return Mesh(mesh)


def Solve(name, *, steps=1, length=1.0, stress=1.0):
    """Solve the slab; `name` is a space ("P1bubble"), or in 3D cells and a space ("hex P2").

    One metre is `length` units of the computation, and one pascal is `stress` units.
    """
    *kind, space = name.split()
    if kind:
        mesh, held = SliceOfCells(*kind, int(space[1]), length), {"dirichlety": "front|back"}
    else:
        mesh, held = PlaneMesh(length), {}
    V = Displacements(mesh, space, slave="bottom", dirichletx="right", **held)
    law = {"master": None, "obstacle": CF(0), "friction": GRECO_SLAB.friction}
    pair = Pair(V, Material(stress * GRECO_SLAB.young, GRECO_SLAB.nu), slave="bottom", **law)
    load, rest = Parameter(0.0), (0,) * (mesh.dim - 1)
    pair.Load(CF((*rest, -load * stress * GRECO_SLAB.top_pressure)), "top")
    pair.Load(CF((load * stress * GRECO_SLAB.side_pressure, *rest)), "left")
    iterations = []
    for k in range(1, steps + 1):
        load.Set(k / steps)
        iterations.append(pair.Solve().number)
        pair.contact.Commit(pair.gf)
    along = [
        np.array([pair.displacement(V.mesh(x * length, *y))[0] for x in GRECO_SLAB.abscissae])
        for y in ([(0.0, 0.0), (SLICE * length, 0.0)] if kind else [(0.0,), (0.0,)])
    ]
    table, force = Sorted(pair.contact.Table()), np.asarray(pair.contact.Force())
    return Solution(along[0] / length, along[1] / length, table, force, iterations)


def Slab(quick):
    spaces = {"2D, order 2": "P2"}
    if not quick:
        spaces |= {"2D, order 1 with bubbles": "P1bubble"}
        spaces |= {"3D slice of hexahedra, order 2": "hex P2"}
    found = {name: Solve(space) for name, space in spaces.items()}
    limit, manual = Stated(5e-3, "`GRECO_SLAB`"), Stated(5e-2, "manual of code_aster")
    first = "the first one against the published value at x ="
    sets = [(f"{name}: displacement at x =", limit, "converged", name) for name in found]
    rows = [
        Row(f"{text} {1e3 * at:g} mm", 1e6 * ours, 1e6 * exact, bound, "µm")
        for text, bound, kind, name in [*sets, (first, manual, "published", "2D, order 2")]
        for at, ours, exact in zip(
            GRECO_SLAB.abscissae, found[name].displacement, getattr(GRECO_SLAB, kind), strict=True
        )
    ]

    def Draw(left, right):
        table = found["2D, order 2"].table
        ends = 1e3 * np.concatenate([[0.0], np.cumsum(table["fullarea"])])
        Profile(left, ends[:-1], ends[1:], 1e-6 * table["pressure"], table["status"])
        friction = -1e-6 * table["traction"][:, 0]
        left.plot(1e3 * table["x"][:, 0], friction, color=INK, lw=0.9, label="friction")
        left.set(xlabel="x [mm]", ylabel="pressure, friction [MPa]")
        left.legend(loc="upper left")
        x = 1e3 * np.array(GRECO_SLAB.abscissae)
        right.plot(x, 1e6 * np.array(GRECO_SLAB.published), "s", color=GREY, label="published")
        for marker, (name, solution) in zip("ox+", found.items(), strict=False):
            right.plot(x, 1e6 * solution.displacement, marker, color=BLUE, label=name)
        right.set(xlabel="x [mm]", ylabel="displacement [µm]")
        right.legend()

    caption = "Left: pressure and friction along the plane. Right: displacements of the base."
    return Outcome(rows, Figure(Draw, columns=2), caption)


CASES = [
    Case(
        "slab",
        "A compressed slab with friction 1",
        "Half of a slab is pressed down on a rigid plane and in from its side (the benchmark of "
        "the French group GRECO, in SI units). Along the plane it is open, slips and sticks. The "
        "last published value is 3 % too low.",
        "Code_aster, test SSNV128 (manual V6.04.128; accepted there: 5 %), and the limit of mesh "
        "refinement, `GRECO_SLAB`.",
        "pytest tests/validation/test_slab.py",
        Slab,
    ),
]
