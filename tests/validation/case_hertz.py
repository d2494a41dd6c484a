"""Hertz' line contact, and NAFEMS benchmark 1.

The paper's Hertz problem is that of `tutorials/examples/hertz.py`. Benchmark 1 (Konter) has the
same bodies with friction 0.1; its published values contain large displacements (code_aster SSNP154,
Hooke's law of Green's strain, dead load at the top of the cylinder), those in small strain are from
an independent program with the same multipliers, which pushes along the normals of the slave.
"""

from __future__ import annotations

import math
from functools import cache

import hertz
import numpy as np
from hertz import AtOrigin, Exact, Figures
from ngsolve import VectorH1
from problems_large import Model, SaintVenant
from report_bounds import Both, Means, Meshes, Neglected, Spread, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import INK, Bodies, Figure, Profile

from ngslac.meshes import HertzMesh

# An independent program with the same multipliers: p(0) and the largest traction with friction.
INDEPENDENT = {0.1: (3640.0, 184.0), 0.2: (3641.7, 247.0)}
HALF_PLANES = 1.018  # what friction 0.2 does to p(0) of half-planes, from coupled equations
DISPLACEMENT, FRICTION = -1.2734, 0.1  # mm without friction, and the friction of the benchmark

# With large displacements: linear, quadratic elements.
PUBLISHED = {0.0: (-1.30690, -1.30802), 0.1: (-1.30108, -1.30264)}
FORCE = 17.5e3  # N/mm, half of it
AXIS = (0.0, 0.0)


@cache
def Pressed(steps=10, **options):
    """The problem, solved; its options are those of the example."""
    return hertz.Run(**({"h": 0.5, "power": 1, "steps": steps} | options))["solution"]


def Values(state):
    """`Figures` of a state, the pressure over Hertz' peak, and where the contact ends."""
    interval, estimate = ContactEdge(state)
    return Figures(state) | {
        "p0_ratio_raw": np.mean(state["pressure"][AtOrigin(state)]) / Exact(state["time"]).peak,
        "contact_edge_interval": interval,
        "contact_edge_estimate": estimate,
    }


def ContactEdge(state):
    """The last macro-element in contact (start, end), and an estimate of the edge inside.

    The estimate extends p^2, which is linear in x^2 for Hertz' pressure, from the outer half of the
    contact without the last macro-element; it is None with fewer than three values.
    """
    active = (state["status"] > 0) & (state["end"] > 0)
    start, end, pressure = (state[name][active] for name in ("start", "end", "pressure"))
    middle = 0.5 * (start + end)[:-1]
    outer = middle > 0.4 * end[-1]
    interval = float(start[-1]), float(end[-1])
    if outer.sum() < 3:
        return interval, None
    slope, constant = np.polyfit(middle[outer] ** 2, pressure[:-1][outer] ** 2, 1)
    return interval, math.sqrt(-constant / slope) if slope < 0 < constant else None


def L2(macros):
    """Error of the pressure against the means of Hertz', relative in L2."""
    means, size = _MeansAndSizes(macros)
    return float(np.sqrt(size @ (macros["pressure"] - means) ** 2 / (size @ means**2)))


def MeansError(macros):
    """Of Hertz' pressure against its means over the macro-elements, relative in L2 of these."""
    means, size = _MeansAndSizes(macros)
    # Half of the contact: the square of a semi-ellipse with axes 1 and a has the integral 2a/3.
    whole = 2 / 3 * Exact().halfwidth * Exact().peak ** 2
    return float(np.sqrt(whole / (size @ means**2) - 1))


def _MeansAndSizes(macros):
    start, end = macros["start"], macros["end"]
    return Exact().MeanPressure(start, end), end - start


def Peak(problem):
    return problem.states[-1]["pressure"][0]


def LargestTraction(problem):
    return abs(problem.states[-1]["traction"]).max()


def OfMacros(left, right, macros, sign, width, bound):
    """Draw pressures and tractions, and how large these may be."""
    spans = macros["start"], macros["end"]
    Profile(left, *spans, macros["pressure"], macros["status"])
    Profile(right, *spans, sign * macros["traction"], macros["status"])
    label, factor = bound
    limit = factor * macros["pressure"]
    right.step(macros["end"], limit, where="pre", color=INK, lw=0.8, label=label)
    left.set_ylabel("pressure [MPa]")
    for ax in (left, right):
        ax.set(xlim=(0, width), xlabel="x [mm]")
        ax.legend()


def Hertz2D(quick):
    smooth = Pressed(h=0.5 if quick else 0.25, friction=0.0, steps=1).states[-1]
    rough, rougher = (Pressed(h=h, friction=0.2) for h in (0.5, 1.0))
    exact, figures, macros = Exact(), Values(smooth), rough.states[-1]
    peak, traction = INDEPENDENT[0.2]
    largest = LargestTraction(rough), LargestTraction(rougher)
    half_planes = Neglected((exact.halfwidth / 50) ** 2, "(a/R)^2")
    meshes = Meshes(Peak(rough), Peak(rougher), 2)
    rows = [
        Row("p(0)", figures["p0_ratio"] * exact.peak, exact.peak, half_planes, "MPa"),
        Row("half width", figures["contact_edge_estimate"], exact.halfwidth, half_planes, "mm"),
        Row("error of the pressure in L2", L2(smooth), 0, Means(MeansError(smooth))),
        Row("contact force over load", figures["force_ratio"], 1, Tolerance()),
        Row("friction 0.2: p(0) over p0", Values(macros)["p0_ratio"], HALF_PLANES, half_planes),
        Row("friction 0.2: p(0)", Peak(rough), peak, meshes, "MPa"),
        Row("friction 0.2: largest traction", largest[0], traction, Meshes(*largest, 2), "MPa"),
        Row("friction 0.2: contact force over load", macros["force_ratio"], 1, Tolerance()),
    ]

    def Draw(bodies, left, right):
        Bodies(bodies, rough.mesh, rough.displacement, window=(0, 9, -6.2, 2.8))
        x = np.linspace(0, 9, 500)
        left.plot(x, exact.Pressure(x), color=INK, lw=0.8, label="Hertz, no friction")
        OfMacros(left, right, macros, 1, 9, ("-0.2 p", -0.2))
        right.set_ylabel("tangential traction [MPa]")

    caption = "Friction 0.2: deformed interface, pressure against Hertz', tangential traction."
    return Outcome(rows, Figure(Draw, columns=3, size=(12, 3.8)), caption)


# ---------------------------------------------------------------- benchmark 1


def Below(problem):
    """Displacement along y a little below the middle, where points of both bodies coincide."""
    return problem.displacement(problem.mesh(0.0, -1e-9))[1]


@cache
def Large(h, friction=None, energy=SaintVenant, *, finite=True):
    """With large displacements, solved; half of the model."""
    V = VectorH1(HertzMesh(h, order=2), order=2, dirichletx="bottom|sym", dirichlety="bottom")
    young = {"cylinder": 210e3, "block": 70e3}
    forces = {"load": (0.0, -FORCE)}
    model = Model(V, energy, young, friction=friction, finite=finite, forces=forces)
    model.Run(steps=2 if friction else 1)  # without friction the path does not matter
    return model


def Nafems(quick):
    smooth, smoother = (
        Below(Pressed(h=k * (0.5 if quick else 0.25), friction=0.0, steps=1)) for k in (1, 2)
    )
    pair = [Pressed(h=h, friction=FRICTION) for h in (0.5, 1.0)]
    peaks = [Peak(problem) for problem in pair]
    text, (peak, _) = f"small strain, friction {FRICTION:g}", INDEPENDENT[FRICTION]
    meshes = [Meshes(*values, 2) for values in ((smooth, smoother), peaks)]
    normals = Both(Neglected((Exact().halfwidth / 50) ** 2 / 3, "the mean of (x/R)^2"), meshes[0])
    rows = [
        Row("small strain: displacement of the block", smooth, DISPLACEMENT, normals, "mm"),
        Row(f"{text}: p(0)", peaks[0], peak, meshes[1], "MPa"),
    ]
    for friction, (linear, quadratic) in PUBLISHED.items():
        block = Large(0.5, friction or None).At("block", AXIS)[1]
        bound = Spread(quadratic, [linear], f"linear elements {linear:g}")
        what = f"large displacements, friction {friction:g}: the same"
        rows.append(Row(what, block, quadratic, bound, "mm"))

    def Draw(left, right):
        bound = "friction x pressure", FRICTION
        OfMacros(left, right, pair[0].states[-1], -1, 8, bound)
        right.set_ylabel("traction towards the axis [MPa]")

    caption = "Small strain with friction 0.1: pressure and tangential traction."
    return Outcome(rows, Figure(Draw, columns=2), caption)


# ---------------------------------------------------------------- either side as slave

OTHERS = {
    "block as slave": {"slave": "block"},
    "large sliding": {"finite": True},
    "large sliding, block as slave": {"finite": True, "slave": "block"},
}


def Sides(quick):
    options = {"h": 0.25, "steps": 10 if quick else 20}
    first = Pressed(**options).states[-1]
    other = {name: Pressed(**options, **change).states[-1] for name, change in OTHERS.items()}
    slope = Neglected((Exact().halfwidth / 50) ** 2, "(a/R)^2")
    rows = [
        Row(f"{name}: {what}", Figures(state)[key], Figures(first)[key], slope)
        for name, state in other.items()
        for key, what in {"p0_ratio": "p(0) over p0", "friction_used": "traction over F p"}.items()
    ]

    def Draw(left, right):
        OfMacros(left, right, first, 1, 9, ("-0.2 p", -0.2))
        for marker, (name, state) in zip("x+.", other.items(), strict=True):
            middle = 0.5 * (state["start"] + state["end"])
            right.plot(middle, state["traction"], marker, color=INK, ms=4, label=name)
        right.set_ylabel("tangential traction [MPa]")
        right.legend()

    caption = (
        "Pressure and tangential traction in small sliding with the cylinder as slave; others."
    )
    return Outcome(rows, Figure(Draw, columns=2, size=(10, 3.8)), caption)


CASES = [
    Case(
        "hertz2d",
        "Hertz' line contact, with and without friction",
        "The problem of the paper: a steel cylinder of diameter 100 mm is pressed on an aluminium "
        "block with 35 kN/mm, in plane strain. Hertz has no friction; with friction 0.2 the "
        "pressure in the middle rises by 1.8 % for half-planes, and by a little less here, where "
        "the contact is an eighth of the radius wide.",
        "Johnson, Contact Mechanics (1985), section 4.2, as `HertzLine`; with friction a program "
        "of others with the same multipliers (3641.7 MPa; 240 to 254 MPa on several meshes), "
        "and the coupled equations of half-planes (`tests/validation/problems_punch.py`).",
        "python tutorials/examples/hertz.py --h 0.25 --steps 10 --power 1 --friction 0",
        Hertz2D,
    ),
    Case(
        "nafems1",
        "NAFEMS contact benchmark 1",
        "The same bodies: displacement of the block under the axis, in small strain and with the "
        "large displacements of the published values (Hooke's law of Green's strain).",
        "A. Konter, Advanced Finite Element Contact Benchmarks, NAFEMS (2006); values of "
        "code_aster, test SSNP154. Small strain: a program of others with the same multipliers.",
        "pytest tests/validation/test_hertz.py -k 'benchmark or large'",
        Nafems,
    ),
    Case(
        "hertz-sides",
        "Friction does not depend on who is slave",
        "The frictional Hertz problem with the block as slave, and with large sliding: contact "
        "pushes in a direction between both normals, nearer to that of the stiffer body, so that "
        "pressure and traction (the norm in L2 over that of friction times pressure) stay.",
        "The same problem in small sliding with the cylinder as slave.",
        "python tutorials/examples/hertz.py --h 0.25 --steps 20 --power 1 --slave block --finite",
        Sides,
    ),
]
