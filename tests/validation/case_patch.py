"""Patch tests: a constant stress passes a non-matching interface without error, in 2D and 3D.

The exact solution is in the discrete spaces, hence the only errors are those of rounding. The two
blocks are loaded by the tractions of the constant stress wherever they do not touch and are not
held; the displacements where they are held are exact.
"""

from __future__ import annotations

import math

import numpy as np
import patch3d
from elasticity import NAMES, Displacements, Field, Material, Pair
from ngsolve import CF, ET, VOL, x, y, z
from report_bounds import Rounding
from report_case import Case, Outcome, Row
from report_pictures import BLUE, INK, ORANGE, Bodies, Figure, Matplotlib, Strip

from ngslac.meshes import TwoBlocks, TwoBlocks3D
from ngslac.meshes.geometry import CheckNonMatching, RotationMatrix

CONDITION_3D = 1e4  # scaled by the diagonal, of order 3 on split tetrahedra: 9.8e3
CODE_ASTER = "code_aster, test SSNP170 (manual V6.03.170)"
HELD = "bottom|left_upper"
FREE = "top|(right|front|back)_upper|(left|right|front|back)_lower"
FREE += "|(master|slave)_(left|right|rim)"
PRESSURE, SHEAR, FRICTION = 25.0, 4.0, 0.3
MESHES = {
    "flat": {},
    "coarse slave": {"h_slave": 0.34, "h_master": 0.1},
    "fine slave": {"h_slave": 0.1, "h_master": 0.34},
    "oblique": {"shape": "oblique"},
    "rotated": {"angle": 37.0},
    "structured": {"structured": True},
    "structured oblique": {"structured": True, "shape": "oblique", "slope": -31.0},
    "quads": {"quads": True},
    "quad grid": {"quads": True, "structured": True, "shape": "oblique"},
    "wide master": {"overhang": 0.3},
    "wide slave": {"overhang": -0.3, "shape": "oblique"},
}
OBLIQUE_3D = {"shape": "oblique", "perturb": 0.2, "rotation": ((1.0, 2.0, -0.5), 67.0)}
# Options of the contact, traction along the slip direction, and slip of the slave.
LAWS = {
    "frictionless": ({}, 0.0, 0.0),
    "stick": ({"friction": FRICTION}, SHEAR, 0.0),
    "slip": ({"friction": FRICTION}, FRICTION * PRESSURE, -2e-3),
    "slip back": ({"friction": FRICTION}, -FRICTION * PRESSURE, 1e-3),
    "tresca": ({"tresca": SHEAR}, SHEAR, -1e-3),
    "tied": ({"tied": True}, SHEAR, 0.0),
}


def Turn(dim, *, angle=0.0, rotation=None, **_):
    """The rotation (d, d) of the whole problem."""
    a = math.radians(angle)
    plane = np.array([[math.cos(a), -math.sin(a)], [math.sin(a), math.cos(a)]])
    return plane if dim == 2 else RotationMatrix(rotation)


def Axes(dim, *, slope=20.0, azimuth=30.0, shape="flat", **options):
    """The slip direction, the rest of the interface, and the normal out of the upper block.

    They are columns.
    """
    rise = math.tan(math.radians(slope)) if shape == "oblique" else 0.0
    if dim == 2:
        axes = np.array([[1.0, rise], [rise, -1.0]])
    else:
        a = math.radians(azimuth)
        normal = np.array([rise * math.cos(a), rise * math.sin(a), -1.0])
        tangent = np.cross(normal, [0.3, 0.8, 0.1])  # no direction of the meshes
        axes = np.column_stack([tangent, np.cross(normal, tangent), normal])
    return Turn(dim, **options) @ (axes / np.linalg.norm(axes, axis=0))


def Stress(dim, options, *, shear=0.0, pressure=PRESSURE):
    """A constant stress with the given traction on the interface."""
    inside = [[-7.0]] if dim == 2 else [[-7.0, 2.0], [2.0, 5.0]]
    local = np.zeros((dim, dim))
    local[:-1, :-1], local[-1, -1] = inside, -pressure
    local[0, -1] = local[-1, 0] = shear
    axes = Axes(dim, **options)
    return axes @ local @ axes.T


def Linear(dim, options, gradient, shift=0.0):
    """A linear displacement about the middle of the interface."""
    middle = Turn(dim, **options) @ np.array([0.5] * (dim - 1) + [0.0])
    r = CF((x, y, z)[:dim]) - CF(tuple(options.get("scale", 1.0) * middle))
    return Field(gradient) * r + CF(tuple(shift * Axes(dim, **options)[:, 0]))


def Blocks(space, cells=None, *, slave="slave", **options):
    """Displacements: with `cells` in 3D, where it is asserted that meshes do not match."""
    if cells is None:
        mesh = TwoBlocks(**{"h_slave": 0.25, **options})
        return Displacements(mesh, space, slave=slave, dirichlet=HELD)
    n = (4, 3) if space == "P1" else (3, 2)  # P1 has vertex stars as macro-elements
    mesh = TwoBlocks3D(*cells, **{"n_slave": n, "n_master": n[::-1], **options})
    V = Displacements(mesh, space, slave=slave, dirichlet=HELD)
    assert CheckNonMatching(V.mesh) > 1e-3
    return V


def Errors(pair, options, stress, *, slip=0.0, lower=None, contact="slave|master"):
    """Load, hold and solve; returns the largest errors of stress and traction."""
    mesh, dim = pair.mesh, pair.mesh.dim
    strain, below = (m.Strain(stress) for m in (Material(), lower or Material()))
    upper = Linear(dim, options, strain, slip)
    pair.Hold(mesh.BoundaryCF({"left_upper": upper, "bottom": Linear(dim, options, below)}), HELD)
    if any(el.type == ET.PYRAMID for el in mesh.Elements(VOL)):
        pair.LoadStressInside(stress, contact)
    else:
        pair.LoadStress(stress, FREE)
    pair.Solve(tol=1e-13)
    return pair.StressError(stress), TractionError(pair, stress)


def TractionError(pair, stress, weights=1.0):
    """Largest error of the multipliers relative to the stress; open ones must carry nothing."""
    table = pair.contact.Table()
    exact = np.where(table["area"][:, None] > 0, table["normal"] @ stress, 0.0)
    error = np.abs(table["traction"] - exact).max(axis=1)
    return (weights * error).max() / np.abs(stress).max()


def Solved(space, law, cells=None, *, slave="slave", master="master", **options):
    """A patch test: the pair, the stress and the two largest errors."""
    flags, shear, slip = LAWS[law]
    V = Blocks(space, cells, slave=slave, **options)
    pair = Pair(V, Material(), slave=slave, master=master, **flags)
    stress = Stress(V.mesh.dim, options, shear=shear)
    return pair, stress, Errors(pair, options, stress, slip=slip)


def Published(space, cells=None, *, quads=False, young=2000.0):
    """The case of code_aster: pressure on top, symmetries and one support; pair and pressure."""
    dim = 3 if cells else 2
    mesh = TwoBlocks3D(*cells, (3, 2), (2, 3)) if cells else TwoBlocks(0.25, quads=quads)
    fixed = {"dirichletx": "left.*", "dirichlety": "front.*", "dirichletz": "bottom"}
    fixed = fixed if cells else {"dirichletx": "left.*", "dirichlety": "bottom"}
    pair, pressure = (
        Pair(Displacements(mesh, space, **fixed), Material(young=young)),
        0.0125 * young,
    )
    pair.Load(CF((*[0.0] * (dim - 1), -pressure)), "top")
    pair.Solve(tol=1e-13)
    return pair, pressure


def Patch2D(quick):
    kinds = ["P1", "P2"] if quick else NAMES
    meshes = ["flat", "oblique"] if quick else MESHES
    errors = {
        kind: np.array([Solved(kind, law, **MESHES[m])[2] for m in meshes for law in LAWS])
        for kind in kinds
    }
    rows = []
    for kind, values in errors.items():
        for name, column in zip(("stress", "multipliers"), values.T, strict=True):
            text = f"{NAMES[kind]}: {name}, largest error of {len(values)} problems"
            rows.append(Row(text, column.max(), 0, Rounding()))
    pressure = Published("P2", quads=True)[0].contact.Table()["pressure"]
    farthest = pressure[np.abs(pressure - PRESSURE).argmax()]
    text = "pressure in the problem of code_aster"
    rows.append(Row(text, farthest, PRESSURE, Rounding(kind="relative")))

    def Draw(left, right):
        maxima = {NAMES[k]: v.max(axis=1) for k, v in errors.items()}
        Strip(left, maxima, tolerance=Rounding().size)
        pair, *_ = Solved("P2", "slip", **MESHES["oblique"])
        Bodies(right, pair.mesh, pair.displacement, factor=8, n=4)

    caption = (
        "Left: the errors of all problems. Right: one of them, an oblique interface that slips; "
        "displacements eight times as large."
    )
    return Outcome(rows, Figure(Draw, columns=2), caption)


def Patch3D(quick):
    cases = patch3d.Cases()
    if quick:  # each combination once, flat and oblique in turn
        cases = [cases[k + (k // 2) % 2] for k in range(0, len(cases), 2)]
    rows = patch3d.Run(cases=cases)["cases"]
    shapes = dict.fromkeys(row["name"].split()[1] for row in rows)
    table = []
    for shape in shapes:
        mine = [row for row in rows if row["name"].split()[1] == shape]
        for key in ("stress", "multiplier"):
            worst = max(row[f"{key}_error"] for row in mine)
            text = f"{shape}: {key}, largest error of {len(mine)} cases"
            table.append(Row(text, worst, 0, Rounding(condition=CONDITION_3D)))

    def Draw(*axes):
        for ax, shape in zip(axes, shapes, strict=True):
            Interface(ax, patch3d.Case(shape, oblique=True))
        handles = [ax.plot([], [], color=c)[0] for c in (ORANGE, BLUE)]
        labels = ["slave faces", "master faces (the segments are shaded)"]
        ax.figure.legend(handles, labels, loc="outside lower center", ncols=2)

    caption = "Interfaces of oblique cases: slave faces, master faces, and their segments."
    size = (2.5 * len(shapes), 2.9)
    return Outcome(table, Figure(Draw, columns=len(shapes), size=size), caption)


def Interface(ax, case):
    """Slave faces, master faces and segments, seen along the normal."""
    _, contact, _ = patch3d.Solve(case)
    plane, segments = case.axes[:, :2], contact.Segments()
    corners = np.split(segments.slave_points @ plane, segments.first[1:-1])
    shades = ("#FFFFFF", "#E8F1E4", "#F6ECD9", "#E3ECF6", "#F3E3EA")
    polygons = Matplotlib().collections.PolyCollection
    ax.add_collection(polygons(corners, facecolors=shades, edgecolors=INK, linewidths=0.3))
    mesh = contact.mesh
    for name, colour in (("master", BLUE), ("slave", ORANGE)):
        faces = [
            np.array([mesh.vertices[v.nr].point for v in el.vertices]) @ plane
            for el in mesh.Boundaries(name).Elements()
        ]
        ax.add_collection(polygons(faces, facecolors="none", edgecolors=colour, linewidths=1.1))
    ax.autoscale_view()
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_title(f"{case.element} on {patch3d.BELOW[case.element]}, {len(corners)} segments")


CASES = [
    Case(
        "patch2d",
        "Patch test in 2D",
        "Two blocks with meshes that do not match, under a constant stress with a pressure of 25. "
        "Flat and oblique interfaces, the slave coarse, fine, narrow and wide, triangles and "
        "quadrilaterals, and the laws frictionless, stick, slip to both sides, Tresca and tied. "
        "The exact solution is in the discrete spaces: what is left must be rounding.",
        f"The constant stress; {CODE_ASTER}, modellings a to j.",
        "pytest tests/validation/test_patch.py",
        Patch2D,
    ),
    Case(
        "patch3d",
        "Patch test in 3D",
        "The same in 3D for every combination of element, order and partition of the slave side, "
        "each with a flat interface and an oblique one between different elements, irregular and "
        "rotated. Errors are relative to the largest stress.",
        f"The constant stress; {CODE_ASTER}, modellings k to z.",
        "python tutorials/examples/patch3d.py --out results",
        Patch3D,
    ),
]
