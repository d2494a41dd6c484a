"""Two half spheres, and a rigid sphere on a block of hexahedra.

Both are quarter models of linear elasticity. Lengths in mm, stresses in MPa.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from case_hertz3d import OverRadius
from elasticity import Displacements, Material, Pair
from macros3d import Solution
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import CF, Mesh, TaskManager
from report_bounds import Meshes, Neglected, Spread
from report_case import Case, Outcome, Row
from report_pictures import Figure
from slavefaces import SlaveFaces

from ngslac.meshes.boxes import Cells, StructuredBox
from ngslac.meshes.geometry import CheckNonMatching
from ngslac.meshes.spheres import TwoSpheres
from ngslac.reference import HertzPoint

RADIUS = 50.0
SYMMETRY = {"dirichletx": "sym_x", "dirichlety": "sym_y"}


def Compared(pair, **bodies):
    """The multipliers of a solved quarter, with Hertz' solution of the same force."""
    table, faces = pair.contact.Table(), SlaveFaces(pair.mesh, pair.Q.macros)
    hertz = HertzPoint(force=4 * abs(float(pair.contact.Force()[2])), **bodies)
    vertical = -table["traction"] @ (0, 0, 1.0) * np.sign(table["normal"][:, 2])
    return Solution(faces, hertz, vertical * table["area"] / faces.area, table["status"])


# ---------------------------------------------------------------- two spheres (T04)
#
# Half spheres whose flat sides come closer by 4 mm: Hertz' contact radius is a fifth of the
# spheres', and the stresses reach a seventh of Young's modulus. An axisymmetric computation of the
# same bodies (elements of third order, without multipliers, the gap measured along the axis) gives
# 1.125 times Hertz' force and 1.040 times his pressure for this approach, hence 1.000 times the
# pressure that he has for that force: the bodies end at their middle, what lies beyond does not
# give way. For approaches of 0.36 and 0.04 mm it is 1.032 and 1.009 times the force: the effect is
# that of the radius over the size.
# Gaps along the normals of the undeformed slave side grow by a part of 2 (r/R)^2 faster than those
# along the axis, up to 8 % at the edge. The surfaces therefore are paired in the deformed
# configuration here. Without that the force is 1.10 and the pressure 1.07 times Hertz'.

STRESS = (2868.9, 2929.4)  # at the first point of contact: code_aster with LAC, modellings k to n
AXISYMMETRIC = 1.125  # force over Hertz'

SPHERES = {"radius1": RADIUS, "radius2": RADIUS} | dict(young1=2e4, nu1=0.3, young2=2e4, nu2=0.3)


@cache
def PressSpheres(approach, elements, *, updates=0):
    """Move the planes through the middles of two half spheres towards each other.

    `elements` faces lie along Hertz' contact radius of this `approach`, which is the sum of both
    displacements; the surfaces are paired anew `updates` times, in the deformed configuration.
    Returns the solution, and the stress at the first point of contact seen from below and above.
    """
    radius = HertzPoint.FromApproach(approach=approach, **SPHERES).contact_radius
    mesh = TwoSpheres(radius / elements, radius=RADIUS, zone=1.3 * radius)
    V = Displacements(mesh, "P2", dirichletz="top|bottom", **SYMMETRY)
    pair = Pair(V, Material(young=2e4, nu=0.3))
    down = {"top": -0.5 * approach, "bottom": 0.5 * approach}
    pair.Hold(CF((0, 0, mesh.BoundaryCF(down, default=0.0))), "top|bottom")
    with TaskManager():
        pair.Solve(tol=1e-10)
        for _ in range(updates):
            pair.contact.Update(pair.gf)
            pair.Solve(tol=1e-10)
    stress = [-pair.stress(mesh(1e-6, 1e-6, z))[8] for z in (-1e-3, 1e-3)]
    return Compared(pair, **SPHERES), stress


# ---------------------------------------------------------------- a rigid sphere on hexahedra

YOUNG, FORCE = 70e3, 24e3
GROWTH, SHELLS = 1.95, 5  # cells outside of the slave's square
FIXED = {
    "dirichletx": "sym_x|rigid|master",
    "dirichlety": "sym_y|rigid|master",
    "dirichletz": "rigid|master",
}


@cache
def PressBlock(elements, space="P2"):
    """Press a block of hexahedra, which is the slave, against a rigid sphere that lies on it.

    The slave's square has `elements` rows of faces, and the side of 1.3 contact radii.
    """
    bodies = dict(radius1=RADIUS, young1=np.inf, nu1=0.0, young2=YOUNG, nu2=0.3)
    size = 1.3 * HertzPoint(force=FORCE, **bodies).contact_radius
    mesh = BlockUnderSphere(elements, size)
    pair = Pair(Displacements(mesh, space, **FIXED), Material(young=YOUNG, nu=0.3))
    bottom = (size * GROWTH**SHELLS) ** 2
    pair.Load(CF((0, 0, 0.25 * FORCE / bottom)), "bottom")
    with TaskManager():
        pair.Solve(tol=1e-10)
    return Compared(pair, **bodies)


def BlockUnderSphere(elements, size):
    """A block of hexahedra under a rigid plate whose lower side is a sphere.

    The faces of the plate are straight, and so small that this does not matter.
    """
    out = NetgenMesh(dim=3)
    around = size * GROWTH ** np.arange(1, SHELLS + 1)
    grid = np.concatenate([np.linspace(0, size, elements + 1), around])
    symmetry = {"left": "sym_x", "front": "sym_y", "bottom": "bottom"}

    def Name(side, centre):
        if side == "top":
            return "slave" if max(centre[:2]) < size else "surface"
        return symmetry.get(side, "side")

    StructuredBox(grid, grid, -grid[::-1], names=Name).AddTo(out, "block")
    fine = np.linspace(0, 1.15 * size, 2 * elements + 1)
    names = {"bottom": "master"}
    box = StructuredBox(fine, fine, [0, size], names=lambda side, _: names.get(side, "rigid"))
    points = box.points.copy()
    points[:, 2] += RADIUS - np.sqrt(RADIUS**2 - (points[:, :2] ** 2).sum(axis=1))
    Cells(points, box.cells, box.faces).AddTo(out, "sphere")
    out.Compress()
    mesh = Mesh(out)
    CheckNonMatching(mesh)
    return mesh


# ---------------------------------------------------------------- rows and picture


def Spheres(quick):
    (wide, stress), (coarser, _) = (PressSpheres(4.0, n, updates=3) for n in (4, 3))
    exact = HertzPoint.FromApproach(approach=4.0, **SPHERES)
    middle, text = sum(STRESS) / 2, "two half spheres, contact radius a fifth of theirs"
    published = Spread(middle, STRESS, f"{STRESS[0]} to {STRESS[1]}")
    forces = [solution.hertz.force / exact.force for solution in (wide, coarser)]
    meshes = Meshes(*forces, 4 / 3)
    size = Neglected((wide.hertz.contact_radius / RADIUS) ** 2, "(a/R)^2")
    peak, radius = (wide.figures[name] for name in ("p0_ratio", "contact_radius_ratio"))
    first = f"{text}: stress at the first point of contact"
    rows = [
        Row(first, stress[1], middle, published, "MPa"),
        Row(f"{text}: force over that of half-spaces", forces[0], AXISYMMETRIC, meshes),
        Row(f"{text}: peak pressure over Hertz' for this force", peak, 1, size),
        Row(f"{text}: contact radius over Hertz' for this force", radius, 1, size),
    ]
    for space, fine, coarse in (("P2", 3, 2), ("P1bubble", 8, 6))[: 1 if quick else 2]:
        last, before = (PressBlock(n, space) for n in (fine, coarse))
        peaks = [solution.figures["p0_ratio"] for solution in (last, before)]
        text = f"rigid sphere on hexahedra of order {space[1]}: peak pressure over Hertz'"
        rows.append(Row(text, peaks[0], 1, Meshes(*peaks, fine / coarse)))

    def Draw(*axes):
        titles = "two half spheres", "rigid sphere on hexahedra"
        for ax, solution, title in zip(axes, (wide, last), titles, strict=True):
            OverRadius(ax, solution)
            ax.set_title(title)
        axes[0].set_ylabel("pressure [MPa]")

    caption = "Pressures over the distance from the middle of the contact."
    return Outcome(rows, Figure(Draw, columns=2), caption)


CASES = [
    Case(
        "spheres",
        "Two half spheres, and a rigid sphere on hexahedra",
        "Two half spheres come closer by 4 mm: the contact radius is a fifth of theirs, so that "
        "the bodies are stiffer than the half-spaces of Hertz, and their normals turn. The "
        "surfaces are paired in the deformed configuration. Second, a block of hexahedra as slave "
        "under a rigid sphere.",
        "Code_aster with Local Average Contact, test SSNV104, modellings k to n (2868.9 to 2929.4 "
        "MPa); an axisymmetric computation of third order without multipliers for the force; "
        "`HertzPoint`.",
        "pytest tests/validation/test_hertz3d.py -k 'spheres or hexahedra'",
        Spheres,
    ),
]
