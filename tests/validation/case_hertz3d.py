"""Hertz' sphere and cylinder in 3D, and NAFEMS benchmark 1 as a slice.

Sphere and cylinder are those of `tutorials/examples/hertz3d.py`.
"""

from __future__ import annotations

from functools import cache

import hertz3d
import numpy as np
from elasticity import Material, Pair, Sorted
from hertzmeans import Means as HertzMeans
from macros3d import Outlines, Solution
from ngsolve import Integrate, VectorH1, dx
from report_bounds import Element, Means, Meshes, Neglected, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREY, INK, ORANGE, Figure, Matplotlib, Profile
from sector3d import SliceMesh
from slavefaces import SlaveFaces

from ngslac.meshes import HertzMesh
from ngslac.reference import HertzLine


@cache
def Run(shape="sphere", *, h, order=2, stabilize="none", steps=1):
    """The solution of each load step of the example; the options are its own."""
    options = {"h": h, "order": order, "stabilize": stabilize, "steps": steps}
    _, contact, done = hertz3d.Run(shape, **options)["solution"]
    faces = SlaveFaces(contact.mesh, contact.space.macros, shape == "cylinder")
    load, solutions = hertz3d.FORCE[shape] * hertz3d.PART[shape, "quarter"], []
    for time, iterations, force, table in done:
        found = table["pressure"], table["status"], float(force[2] / (load * time))
        solutions.append(Solution(faces, hertz3d.Hertz(shape, time), *found, iterations))
    return solutions


def MeansError(solution):
    """Of Hertz' pressure against its means over the macro-elements, relative in L2 of these."""
    exact, area = solution.hertz, solution.faces.area
    shape = HertzMeans(solution.faces, exact) / exact.peak
    # Integral of the square over that of the pressure, for the peak 1.
    ratio = 8 / (3 * np.pi) if isinstance(exact, HertzLine) else 3 / 4
    return np.sqrt(ratio * (area @ shape) / (area @ shape**2) - 1)


def Sphere(quick):
    exact = hertz3d.Hertz("sphere")
    rows, coarser, radius = [], None, exact.contact_radius
    for n in (4,) if quick else (6, 8):
        (solution,) = Run(h=radius / n)
        figures, text = solution.figures, f"{n} faces along the radius"
        peak, wide = figures["p0_ratio"] * exact.peak, figures["contact_radius_ratio"] * radius
        meshes = Meshes(peak, coarser[1], n / coarser[0]) if coarser else None
        error, coarser = figures["profile_error"], (n, peak)
        rows += [
            Row(f"{text}: peak pressure", peak, exact.peak, meshes, "MPa"),
            Row(f"{text}: contact radius", wide, radius, Element(1 / n, kind="relative"), "mm"),
            Row(f"{text}: error of the pressure in L2", error, 0, Means(MeansError(solution))),
            Row(f"{text}: force over load", solution.share, 1, Tolerance()),
        ]
    caption = "Pressures of the macro-elements over the distance from the middle, and from below."

    def Draw(left, right):
        OverRadius(left, solution)
        left.set(ylabel="pressure [MPa]", title="multipliers, constant on each macro-element")
        _FromBelow(right, solution)

    options = {"columns": 2, "size": (9.4, 4.1), "width_ratios": (1.15, 1)}
    return Outcome(rows, Figure(Draw, **options), caption)


def OverRadius(ax, solution):
    """Pressures of the macro-elements over the distance from the middle, beside Hertz'."""
    faces, exact, closed = solution.faces, solution.hertz, solution.status > 0
    low, high = faces.extent.T
    middle, r = 0.5 * (low + high), np.linspace(0, high.max(), 1001)
    for mine, colour, label in ((closed, BLUE, "in contact"), (~closed, GREY, "open")):
        pressure = solution.pressure[mine]
        ax.hlines(pressure, low[mine], high[mine], color=colour, lw=0.8, alpha=0.5)
        ax.plot(middle[mine], pressure, "o", color=colour, ms=3, label=f"macro-element, {label}")
    means = HertzMeans(faces, exact)
    ax.plot(middle, means, "x", color=ORANGE, ms=3, mew=0.7, label="mean of Hertz'")
    ax.plot(r, exact.Pressure(r), color=INK, lw=0.9, label="Hertz' pressure")
    ax.set(xlabel="distance from the middle [mm]", xlim=(0, high.max()))
    ax.set(ylim=(-0.03 * exact.peak, None))
    ax.legend(loc="lower left")


def _FromBelow(ax, solution):
    collections, faces = Matplotlib().collections, solution.faces
    shown = collections.PolyCollection(faces.corners, cmap="viridis", edgecolors="face")
    shown.set_array(solution.pressure[faces.owner])
    ax.add_collection(shown)
    ax.add_collection(collections.LineCollection(Outlines(faces), colors="white", linewidths=0.5))
    angle, radius = np.linspace(0, 2 * np.pi, 361), solution.radius
    ax.plot(radius * np.cos(angle), radius * np.sin(angle), color=ORANGE, lw=1.0)
    (x0, y0), (x1, y1) = (end(faces.corners.reshape(-1, 2), axis=0) for end in (np.min, np.max))
    # The y axis points down when looking up.
    ax.set(xlim=(x0, x1), ylim=(y1, y0), aspect="equal", xlabel="x [mm]", ylabel="y [mm]")
    ax.set_title("seen from below, and Hertz' contact radius", pad=10)
    bar = ax.figure.colorbar(shown, ax=ax, shrink=0.85, label="pressure [MPa]")
    bar.outline.set_linewidth(0.5)


# ---------------------------------------------------------------- benchmark 1 as a slice
#
# Plane strain by two planes of symmetry, small strain, no friction, slave faces of 1 mm; half of
# the model with 17.5 kN per mm. The displacement of the block under the axis is from an independent
# program with the same multipliers. The cylinder consists of flat faces: their middles lie
# 0.0025 mm, or 0.2 % of the displacement, inside of the circle.

FORCE, SIZE, DEPTH = 17.5e3, 1.0, 2.0
DISPLACEMENT = -1.2734
HERTZ = HertzLine(force=2 * FORCE, radius1=50.0, young1=210e3, nu1=0.3, young2=70e3, nu2=0.3)


@cache
def Slice(size):
    """Displacement of the block, force, and macro-elements by x."""
    mesh = SliceMesh(HertzMesh(size, order=1, zone=8.0, grading=0.5), DEPTH)
    flags = {"dirichletx": "sym|bottom", "dirichlety": "front|back", "dirichletz": "bottom"}
    young = mesh.MaterialCF({"cylinder": 210e3, "block": 70e3})
    pair = Pair(VectorH1(mesh, order=2, **flags), Material(young, 0.3))
    weight = FORCE * DEPTH / Integrate(1, mesh.Materials("cylinder"))
    pair.load += -weight * pair.v[2] * dx("cylinder")
    pair.Solve(tol=1e-10)
    table = Sorted(pair.contact.Table())
    return pair.displacement(mesh(1e-9, 0.5, -1e-9))[2], pair.contact.Force(), table


def Ends(table):
    """Of the faces, along x."""
    ends = 50 * np.sin(SIZE / 50 * np.arange(len(table["pressure"]) + 1))
    return ends[:-1], ends[1:]


def Cylinder(quick):
    h = 0.8 if quick else 0.4
    solution, coarser = (Run("cylinder", h=k * h)[0] for k in (1, 2))
    exact, text = solution.hertz, "cylinder of prisms"
    peaks = [each.figures["p0_ratio"] * exact.peak for each in (solution, coarser)]
    error, means = solution.figures["profile_error"], Means(MeansError(solution))
    block, force, table = Slice(SIZE)
    half_planes = Neglected((HERTZ.halfwidth / 50) ** 2, "(a/R)^2")
    meshes, at = Meshes(block, Slice(2 * SIZE)[0], 2), "benchmark 1"
    load = Tolerance(kind="relative")
    rows = [
        Row(f"{text}: p(0)", peaks[0], exact.peak, Meshes(*peaks, 2), "MPa"),
        Row(f"{text}: error of the pressure in L2", error, 0, means),
        Row(f"{at}: displacement of the block", block, DISPLACEMENT, meshes, "mm"),
        Row(f"{at}: p(0)", table["pressure"][0], HERTZ.peak, half_planes, "MPa"),
        Row(f"{at}: contact force", force[2], FORCE * DEPTH, load, "N"),
    ]

    def Draw(ax):
        Profile(ax, *Ends(table), table["pressure"], table["status"])
        x = np.linspace(0, 8, 400)
        ax.plot(x, HERTZ.Pressure(x), color=INK, lw=0.9, label="Hertz")
        ax.set(xlim=(0, 8), xlabel="x [mm]", ylabel="pressure [MPa]")
        ax.legend()

    return Outcome(rows, Figure(Draw, size=(6, 3.4)), "The pressure of benchmark 1 in the slice.")


CASES = [
    Case(
        "hertz3d",
        "Hertz' point contact",
        "A steel sphere of radius 50 mm on an aluminium block, a quarter of both, in tetrahedra "
        "of order 2. The contact radius (2.5 mm) is a twentieth of the sphere's. The edge of "
        "the contact crosses macro-elements, which are open or closed as a whole.",
        "Johnson, Contact Mechanics (1985), sections 3.4 and 4.2, as `HertzPoint`.",
        "python tutorials/examples/hertz3d.py --h 0.3125 --out results",
        Sphere,
    ),
    Case(
        "hertz3d-line",
        "Hertz' line contact as a slice in 3D",
        "A cylinder of prisms between two planes of symmetry has the line contact of 2D; and so "
        "has NAFEMS benchmark 1 in small strain, here with slave faces of 1 mm.",
        "`HertzLine`; the displacement: a program of others with the same multipliers in 2D.",
        "pytest tests/validation/test_hertz3d.py -k 'cylinder or slice'",
        Cylinder,
    ),
]
