"""Hertz' sphere and cylinder in 3D, and NAFEMS benchmark 1 as a slice.

Sphere and cylinder are those of `tutorials/examples/hertz3d.py`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import hertz3d
import numpy as np
from elasticity import Material, Pair
from hertzmeans import Means as HertzMeans
from macros3d import Comparison, Outlines
from ngsolve import Integrate, VectorH1, dx
from report_bounds import Element, Means, Meshes, Neglected, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREY, INK, ORANGE, Figure, Profile
from sector3d import SliceMesh
from slavefaces import SlaveFaces

from ngslac.meshes import HertzMesh
from ngslac.meshes.cylinders import THICKNESS
from ngslac.reference import HertzLine


@dataclass(frozen=True)
class State:
    """A converged load step; macro-elements in the order of the space."""

    hertz: object  # exact, for this load
    iterations: int
    pressure: np.ndarray
    status: np.ndarray
    force: float  # contact force over the load of this step


@dataclass(frozen=True)
class Results:
    shape: str
    h: float
    faces: SlaveFaces
    states: list

    def Figures(self, state):
        return Comparison(self.faces, state.hertz, state.pressure, state.status)

    @property
    def figures(self):
        """Of the whole load."""
        return self.Figures(self.states[-1])


@cache
def Run(shape="sphere", *, h, order=2, stabilize="none", steps=1):
    """Compute the example; the options are its own."""
    mesh = hertz3d.Mesh(shape, h, order=order, stabilize=stabilize)
    line = shape == "cylinder"
    load = hertz3d.FORCE[shape] * hertz3d.PART[shape, "quarter"] * (THICKNESS if line else 1.0)
    pressed = hertz3d.Press(mesh, load, order=order, stabilize=stabilize, steps=steps)
    states = [
        State(
            hertz3d.Hertz(shape, time),
            iterations,
            table["pressure"],
            table["status"],
            float(force[2] / (load * time)),
        )
        for time, iterations, force, table in pressed.steps
    ]
    contact = pressed.contact
    return Results(shape, h, SlaveFaces(contact.mesh, contact.space.macros, line), states)


def MeansError(results):
    """Of Hertz' pressure against its means over the macro-elements, relative in L2 of these."""
    exact, area = results.states[-1].hertz, results.faces.area
    shape = HertzMeans(results.faces, exact) / exact.peak
    # Integral of the square over that of the pressure, for the peak 1.
    ratio = 8 / (3 * np.pi) if results.shape == "cylinder" else 3 / 4
    return np.sqrt(ratio * (area @ shape) / (area @ shape**2) - 1)


def Sphere(quick):
    exact = hertz3d.Hertz("sphere")
    rows, coarser, radius = [], None, exact.contact_radius
    for n in (4,) if quick else (6, 8):
        results = Run(h=radius / n)
        figures, text = results.figures, f"{n} faces along the radius"
        peak, wide = figures["p0_ratio"] * exact.peak, figures["contact_radius_ratio"] * radius
        meshes = Meshes(peak, coarser[1], n / coarser[0]) if coarser else None
        error, coarser = figures["profile_error"], (n, peak)
        rows += [
            Row(f"{text}: peak pressure", peak, exact.peak, meshes, "MPa"),
            Row(f"{text}: contact radius", wide, radius, Element(1 / n, kind="relative"), "mm"),
            Row(f"{text}: error of the pressure in L2", error, 0, Means(MeansError(results))),
            Row(f"{text}: force over load", results.states[-1].force, 1, Tolerance()),
        ]
    caption = "Pressures of the macro-elements over the distance from the middle, and from below."
    options = {"columns": 2, "size": (9.4, 4.1), "width_ratios": (1.15, 1)}
    return Outcome(rows, Figure(lambda *axes: _Pressures(*axes, results), **options), caption)


def _Pressures(left, right, results):
    """Over the distance from the middle, and on the macro-elements from below."""
    state, faces = results.states[-1], results.faces
    low, high = faces.extent.T
    closed, middle = state.status > 0, 0.5 * (low + high)
    for mine, colour, label in ((closed, BLUE, "in contact"), (~closed, GREY, "open")):
        pressure = state.pressure[mine]
        left.hlines(pressure, low[mine], high[mine], color=colour, lw=0.8, alpha=0.5)
        left.plot(middle[mine], pressure, "o", color=colour, ms=3, label=f"macro-element, {label}")
    means, r = HertzMeans(faces, state.hertz), np.linspace(0, high.max(), 1001)
    left.plot(middle, means, "x", color=ORANGE, ms=3, mew=0.7, label="mean of Hertz'")
    left.plot(r, state.hertz.Pressure(r), color=INK, lw=0.9, label="Hertz' pressure")
    left.set(xlabel="distance from the middle [mm]", ylabel="pressure [MPa]", xlim=(0, high.max()))
    left.set(
        ylim=(-0.03 * state.hertz.peak, None), title="multipliers, constant on each macro-element"
    )
    left.legend(loc="lower left")
    _FromBelow(right, faces, state)


def _FromBelow(ax, faces, state):
    from matplotlib.collections import LineCollection, PolyCollection

    shown = PolyCollection(faces.corners, cmap="viridis", edgecolors="face")
    shown.set_array(state.pressure[faces.owner])
    ax.add_collection(shown)
    ax.add_collection(LineCollection(Outlines(faces), colors="white", linewidths=0.5))
    angle, radius = np.linspace(0, 2 * np.pi, 361), state.hertz.contact_radius
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
    table = pair.contact.Table()
    along = np.argsort(table["x"][:, 0])
    table = {name: values[along] for name, values in table.items()}
    return pair.displacement(mesh(1e-9, 0.5, -1e-9))[2], pair.contact.Force(), table


def Ends(table):
    """Of the faces, along x."""
    ends = 50 * np.sin(SIZE / 50 * np.arange(len(table["pressure"]) + 1))
    return ends[:-1], ends[1:]


def Cylinder(quick):
    h = 0.8 if quick else 0.4
    results, coarser = (Run("cylinder", h=k * h) for k in (1, 2))
    exact, text = results.states[-1].hertz, "cylinder of prisms"
    peaks = [each.figures["p0_ratio"] * exact.peak for each in (results, coarser)]
    error, means = results.figures["profile_error"], Means(MeansError(results))
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
