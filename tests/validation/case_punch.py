"""NAFEMS contact benchmark 2: a punch with a rounded edge on an elastic foundation (T15).

A sector of five degrees between two planes of symmetry stands for the body of revolution. Data in
mm and MPa: punch of steel, radius 50, height 100, fillet 10; foundation of aluminium, radius 100,
height 200, fixed at its bottom; pressure 100 on top of the punch. Displacements are a thousandth of
the size: small strain.

The mesh has elements of 0.4 mm at the edge of the contact; with 0.2 mm the displacement changes by
0.02 %. The published stress (-91 and -94 MPa), extrapolated from coarse elements, is not compared:
on the axis the pressure is 87.5 MPa on both meshes, it equals the stress in both bodies, and an
axisymmetric computation agrees with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from elasticity import Material, Pair, Sorted
from netgen.occ import Compound, OCCGeometry, WorkPlane
from ngsolve import CF, Integrate, Mesh, Parameter, VectorH1, ds
from report_bounds import Spread, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import BLUE, ORANGE, Figure
from sector3d import SectorMesh

# Displacement of the middle from axisymmetric elements, mm: quadratic and linear ones.
PUBLISHED, LINEAR = {0.0: -0.132941, 0.1: -0.130794}, {0.0: -0.130734, 0.1: -0.128580}
LOAD, ANGLE = 100.0, np.radians(5.0)
EDGE = 40.0  # where the fillet begins
YOUNG = {"punch": 210e3, "foundation": 70e3}


def HalfSection(h):
    """Punch and foundation in the (r, z) plane, elements of size h at the edge of the contact."""
    punch = WorkPlane().MoveTo(0, 0).Line(EDGE).Arc(10, 90).Line(90).Rotate(90).Line(50).Close()
    base = WorkPlane().MoveTo(0, -200).Line(100).Rotate(90).Line(200).Rotate(90)
    base = base.Line(98 - EDGE).Line(EDGE + 2).Close()
    bodies = {"punch": punch.Face(), "foundation": base.Face()}
    for name, body in bodies.items():
        body.faces.name = name
        for edge in body.edges:
            r, z = edge.center.x, edge.center.y
            if abs(r) < 1e-9:
                edge.name = "axis"
            elif name == "punch":
                edge.name = "slave" if z < 9 else "top" if z > 99 else "side"
                edge.maxh = 3 if edge.name == "slave" and r > 1 else 25
            else:
                edge.name = "master" if abs(z) < 1e-9 else "bottom" if z < -199 else "side"
                edge.maxh = 25 if edge.name != "master" or r < 1 else 4 if r < EDGE else 8
        for vertex in body.vertices:
            if abs(vertex.p[1]) < 1e-9 and EDGE <= vertex.p[0] < EDGE + 3:
                vertex.maxh = h if name == "punch" else 1.3 * h
    geometry = OCCGeometry(Compound(list(bodies.values())), dim=2)
    return Mesh(geometry.GenerateMesh(maxh=25, grading=0.3))


@dataclass(frozen=True)
class Solution:
    """Displacements along z at the axis, and macro-elements from the axis on."""

    foundation: float
    punch: float
    load: float
    force: np.ndarray
    table: dict

    @property
    def radius(self):
        return Radius(self.table["x"])


def Radius(x):
    return np.hypot(x[:, 0], x[:, 1])


def Solve(h, friction):
    mesh = SectorMesh(HalfSection(h), ANGLE)
    V = VectorH1(mesh, order=2, dirichlety="front", dirichlet="bottom")
    pair = Pair(V, Material(mesh.MaterialCF(YOUNG), 0.3), friction=Parameter(friction))
    pair.Load(CF((0, 0, -LOAD)), "top")
    # The oblique plane of symmetry by stiff springs; their effect is below 1e-6.
    across, (u, _) = CF((-np.sin(ANGLE), np.cos(ANGLE), 0)), pair.X.TrialFunction()
    pair.a += 1e5 * YOUNG["punch"] * (u * across) * (pair.v * across) * ds("oblique")
    pair.Solve(tol=1e-10)
    axis = (pair.displacement(mesh(1e-9, 0, z))[2] for z in (-1e-9, 1e-9))
    load = LOAD * Integrate(CF(1), mesh.Boundaries("top"))
    return Solution(*axis, load, pair.contact.Force(), Sorted(pair.contact.Table(), Radius))


@cache
def Solved(h):
    """By the friction."""
    return {friction: Solve(h, friction) for friction in PUBLISHED}


def Punch(quick):
    found, rows = Solved(1.0 if quick else 0.4), []
    for friction, solution in found.items():
        text, exact = f"friction {friction:g}: displacement of the middle", PUBLISHED[friction]
        bound = Spread(exact, [LINEAR[friction]], f"linear {LINEAR[friction]}")
        rows.append(Row(text, solution.foundation, exact, bound, "mm"))
    change = found[0.1].foundation - found[0.0].foundation
    rows.append(Row("change by friction", change, PUBLISHED[0.1] - PUBLISHED[0.0], unit="mm"))
    for friction, solution in found.items():
        text = f"friction {friction:g}: contact force over load"
        rows.append(Row(text, solution.force[2] / solution.load, 1, Tolerance()))

    def Draw(ax):
        for colour, (friction, solution) in zip((BLUE, ORANGE), found.items(), strict=True):
            pressure, label = solution.table["pressure"], f"friction {friction:g}"
            ax.plot(solution.radius, pressure, "o", ms=3, color=colour, label=label)
        ax.set(xlabel="distance from the axis [mm]", ylabel="pressure [MPa]")
        ax.legend(loc="upper left")

    caption = "Pressures of the macro-elements: highest where the round edge begins."
    return Outcome(rows, Figure(Draw, size=(6, 3.4)), caption)


CASES = [
    Case(
        "nafems2",
        "NAFEMS contact benchmark 2",
        "A steel punch with a rounded edge on an aluminium foundation under a pressure of 100 "
        "MPa: a sector of five degrees between two planes of symmetry. Published values with "
        "linear and quadratic elements differ by 1.7 %; the reference are the quadratic ones.",
        "A. Konter, NAFEMS (2006); values of code_aster, test SSNA122.",
        "pytest tests/validation/test_punch.py",
        Punch,
    ),
]
