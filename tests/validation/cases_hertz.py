"""Hertz' line contact, NAFEMS benchmark 1, frame and units."""

from __future__ import annotations

import numpy as np
from hertz import Exact as Hertz
from hertzline import Pressed, Values
from problems_cb1 import PUBLISHED, CylinderModel
from report_bounds import Exact, Means, Meshes, Neglected, Rounding, Spread, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import INK, Bodies, Figure, Profile
from test_validation_nafems import DISPLACEMENT, FRICTION
from test_validation_nafems import Outcome as Benchmark

# An independent program with the same multipliers: p(0) with friction.
INDEPENDENT = {0.1: 3640.0, 0.2: 3641.7}
HALF_PLANES = 1.018  # what friction 0.2 does to p(0) of half-planes, from coupled equations


def L2(macros):
    """Error of the pressure against the means of Hertz', relative in L2."""
    means = Hertz().MeanPressure(macros["start"], macros["end"])
    size = macros["end"] - macros["start"]
    return float(np.sqrt(size @ (macros["pressure"] - means) ** 2 / (size @ means**2)))


def MeansError(macros):
    """Of Hertz' pressure against its means over the macro-elements, relative in L2 of these."""
    exact = Hertz()
    means = exact.MeanPressure(macros["start"], macros["end"])
    size = macros["end"] - macros["start"]
    # Half of the contact: the square of a semi-ellipse with axes 1 and a has the integral 2a/3.
    whole = 2 / 3 * exact.halfwidth * exact.peak**2
    return float(np.sqrt(whole / (size @ means**2) - 1))


def Peak(problem):
    return problem.states[-1]["pressure"][0]


def Hertz2D(quick):
    h = 1.0 if quick else 0.25
    smooth = Pressed(h=h, friction=0.0, steps=1).states[-1]
    steps = 2 if quick else 10
    rough, rougher = (Pressed(h=k * max(h, 0.5), friction=0.2, steps=steps) for k in (1, 2))
    exact, figures, macros = Hertz(), Values(smooth), rough.states[-1]
    largest = [abs(r.states[-1]["traction"]).max() for r in (rough, rougher)]
    half_planes = Neglected((exact.halfwidth / 50) ** 2, "(a/R)^2")
    meshes = Meshes(Peak(rough), Peak(rougher), 2)
    rows = [
        Row("p(0)", figures["p0_ratio"] * exact.peak, exact.peak, half_planes, "MPa"),
        Row("half width", figures["contact_edge_estimate"], exact.halfwidth, half_planes, "mm"),
        Row("error of the pressure in L2", L2(smooth), 0, Means(MeansError(smooth))),
        Row("contact force over load", figures["force_ratio"], 1, Tolerance()),
        Row("friction 0.2: p(0) over p0", Values(macros)["p0_ratio"], HALF_PLANES, half_planes),
        Row("friction 0.2: p(0)", Peak(rough), INDEPENDENT[0.2], meshes, "MPa"),
        Row("friction 0.2: largest traction", largest[0], 247.0, Meshes(*largest, 2), "MPa"),
        Row("friction 0.2: contact force over load", macros["force_ratio"], 1, Tolerance()),
    ]

    def Draw(bodies, left, right):
        Bodies(bodies, rough.mesh, rough.displacement, window=(0, 9, -6.2, 2.8))
        spans, x = (macros["start"], macros["end"]), np.linspace(0, 9, 500)
        Profile(left, *spans, macros["pressure"], macros["status"])
        left.plot(x, exact.Pressure(x), color=INK, lw=0.8, label="Hertz, no friction")
        Profile(right, *spans, macros["traction"], macros["status"])
        bound = -0.2 * macros["pressure"]
        right.step(macros["end"], bound, where="pre", color=INK, lw=0.8, label="-0.2 p")
        left.set_ylabel("pressure [MPa]")
        right.set_ylabel("tangential traction [MPa]")
        for ax in (left, right):
            ax.set_xlim(0, 9)
            ax.set_xlabel("x [mm]")
            ax.legend()

    caption = "Friction 0.2: deformed interface, pressure against Hertz', tangential traction."
    return Outcome(rows, Figure(Draw, columns=3, size=(12, 3.8)), caption)


def Nafems(quick):
    h, steps = 1.0 if quick else 0.25, 2 if quick else 10
    smooth, smoother = (Benchmark.Of(h=k * h, friction=0.0, steps=1) for k in (1, 2))
    rough, rougher = (Benchmark.Of(h=k, friction=FRICTION, steps=steps) for k in (0.5, 1.0))
    macros = rough.macros
    peaks = [outcome.macros["pressure"][0] for outcome in (rough, rougher)]
    largest = [abs(outcome.macros["traction"]).max() for outcome in (rough, rougher)]
    meshes = [Meshes(*pair, 2) for pair in ((smooth.block, smoother.block), peaks, largest)]
    text = "small strain, friction 0.1"
    rows = [
        Row("small strain: displacement of the block", smooth.block, DISPLACEMENT, meshes[0], "mm"),
        Row(f"{text}: p(0)", peaks[0], INDEPENDENT[FRICTION], meshes[1], "MPa"),
        Row(f"{text}: largest traction", largest[0], 184.0, meshes[2], "MPa"),
    ]
    for friction, (linear, quadratic) in PUBLISHED.items():
        model = CylinderModel(1.0 if quick else 0.5, friction=friction or None)
        model.Run(steps=2 if friction else 1)
        block = model.At("block", (0.0, 0.0))[1]
        text = f"large displacements, friction {friction:g}: the same"
        bound = Spread(quadratic, [linear], f"linear elements {linear:g}")
        rows.append(Row(text, block, quadratic, bound, "mm"))

    def Draw(left, right):
        spans = macros["start"], macros["end"]
        Profile(left, *spans, macros["pressure"], macros["status"])
        Profile(right, *spans, -macros["traction"], macros["status"])
        bound = FRICTION * macros["pressure"]
        right.step(
            macros["end"], bound, where="pre", color=INK, lw=0.8, label="friction x pressure"
        )
        left.set_ylabel("pressure [MPa]")
        right.set_ylabel("traction towards the axis [MPa]")
        for ax in (left, right):
            ax.set_xlim(0, 8)
            ax.set_xlabel("x [mm]")
            ax.legend()

    caption = "Small strain with friction 0.1: pressure and tangential traction."
    return Outcome(rows, Figure(Draw, columns=2), caption)


def Frame(quick):
    options = {"h": 1.0 if quick else 0.5, "friction": 0.2, "steps": 1 if quick else 3}
    before = Pressed(**options, full=True)
    changes = {"rotated by 37 degrees": {"angle": 37.0}}
    changes["in metres and pascals"] = {"length": 1e-3, "stress": 1e6}
    rows, curves = [], {}
    first = before.states[-1]
    for name, change in changes.items():
        after = Pressed(**options, full=True, **change)
        last = after.states[-1]
        for key in ("pressure", "traction"):
            error = np.abs(last[key] - first[key]).max() / first["pressure"].max()
            rows.append(Row(f"{name}: change of the {key} over p0", error, 0, Rounding()))
        status = float(np.sum(last["status"] != first["status"]))
        rows.append(Row(f"{name}: statuses that change", status, 0, Exact()))
        curves[name] = last

    def Draw(ax):
        Profile(ax, first["start"], first["end"], first["pressure"], label="upright, mm and MPa")
        for marker, (name, last) in zip("x+", curves.items(), strict=True):
            middle = 0.5 * (last["start"] + last["end"])
            ax.plot(middle, last["pressure"], marker, color=INK, ms=5, label=name)
        ax.set_xlim(-8, 8)
        ax.set_xlabel("x [mm]")
        ax.set_ylabel("pressure [MPa]")
        ax.legend(loc="lower center")

    return Outcome(rows, Figure(Draw, size=(6, 3.4)), "The pressures of all three, in MPa.")


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
        "python tutorials/examples/hertz.py --h 0.25 --friction 0",
        Hertz2D,
    ),
    Case(
        "nafems1",
        "NAFEMS contact benchmark 1",
        "The same bodies: displacement of the block under the axis, in small strain and with the "
        "large displacements of the published values (Hooke's law of Green's strain).",
        "A. Konter, Advanced Finite Element Contact Benchmarks, NAFEMS (2006); values of "
        "code_aster, test SSNP154. Small strain: a program of others with the same multipliers.",
        "pytest tests/validation/test_validation_nafems.py "
        "tests/validation/test_validation_cb1_large.py",
        Nafems,
    ),
    Case(
        "frame-and-units",
        "Frame and units",
        "The frictional Hertz problem once more, turned by 37 degrees, and in metres and pascals: "
        "nothing in the method knows directions or sizes.",
        "The same problem upright, in millimetres and megapascals.",
        "pytest tests/validation/test_validation_hertz.py -k frame",
        Frame,
    ),
]
