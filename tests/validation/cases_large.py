"""Large deformation: pin, half ring, flattened cylinder, self-contact."""

from __future__ import annotations

import math

import flatring
import hertz_large
import numpy as np
import test_validation_halfring as halfring
from problems_flattened import EnergyError, Penalty
from problems_halfring import QuadMesh, RingMesh, RingModel
from problems_large import Small
from problems_pin import FORCE, PinMesh, PinModel
from report_bounds import Both, Exact, Extrapolated, Meshes, Neglected, Spread, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import Bodies, Figure
from test_validation_pin import BEHIND, PUSHED


def Pin(quick):
    mesh = PinMesh(20 if quick else 30)
    rough, smooth = PinModel(mesh), PinModel(mesh, friction=None)
    linear = PinModel(mesh, energy=Small, finite=False)
    for model, steps in ((rough, 2), (smooth, 1), (linear, 1)):
        model.Run(steps=steps)
    spread = Spread(0.73617, [0.71799], "linear against quadratic elements, friction 0.1")
    front = [model.At("sheet", PUSHED)[0] for model in (rough, linear, smooth)]
    at = "in front of the pin"
    rows = [
        Row(f"large displacements, friction 0.1: {at}", front[0], 0.73617, spread, "mm"),
        Row(f"small strain, friction 0.1: {at}", front[1], 0.73924, spread, "mm"),
        Row(f"frictionless: {at}", front[2], 0.75485, spread, "mm"),
        Row("frictionless: back of the pin", smooth.At("pin", BEHIND)[0], 0.77928, spread, "mm"),
        Row("contact force over load", -rough.contact.Force()[0] / FORCE, 1, Tolerance()),
    ]
    caption = "Displacements 20 times as large: the contact opens behind the pin."
    return Outcome(
        rows,
        Figure(lambda ax: Bodies(ax, mesh, rough.displacement, factor=20), size=(7, 3)),
        caption,
    )


def _Variants(time, k):
    """What the published variants of the frictionless problem differ by."""
    value, other = halfring.LOGARITHMIC[None][time][k], halfring.UPDATED[time][k]
    return Spread(value, [other], f"{value:.4g} and {other:.4g}, frictionless")


def _OnThePublishedMesh(frictions):
    rows = []
    for friction in frictions:
        model, motion = RingModel(QuadMesh(), order=1, friction=friction)
        values, _, _ = halfring.Follow(model, motion, end=0.6, steps=12)
        text = "published mesh, " + (f"friction {friction:g}" if friction else "frictionless")
        for time, (middle, beside) in halfring.LOGARITHMIC[friction].items():
            if time == 0.4 or friction is None:
                rows.append(
                    Row(
                        f"{text}: middle of the block at t = {time:g}",
                        values[time]["PA"][1],
                        middle,
                        _Variants(time, 0),
                        "mm",
                    )
                )
            if time == 0.6:
                rows.append(
                    Row(
                        f"{text}: beside it at t = {time:g}",
                        values[time]["PB"][1],
                        beside,
                        _Variants(time, 1),
                        "mm",
                    )
                )
    return rows


def HalfRing(quick):
    rows = _OnThePublishedMesh([None] if quick else halfring.LOGARITHMIC)
    model, motion = RingModel(RingMesh(12.0 if quick else 6.3))
    values, _, steps = halfring.Follow(
        model, motion, end=0.6 if quick else 1.0, steps=24 if quick else 40
    )
    middle, beside = halfring.FINE[0.6]
    found = values[0.6]
    rows += [
        Row(
            "order 2: middle of the block at t = 0.6, against a mesh three times finer",
            found["PA"][1],
            middle,
            unit="mm",
        ),
        Row("order 2: beside it", found["PB"][1], beside, unit="mm"),
        Row(
            "order 2: steps that had to be cut",
            sum(step.cuts for step in steps),
            0,
            Exact(),
        ),
    ]
    caption = "The end: the ring has buckled and rests on two places."

    def Draw(ax):
        Bodies(ax, model.V.mesh, model.displacement, n=3)

    return Outcome(rows, Figure(Draw, size=(5.5, 4.4)), caption)


def _Strain(force, modulus, radius=1.0):
    """Largest strain of a line contact in Hertz' theory, about a/(2 R)."""
    return math.sqrt(4 * force * radius / (math.pi * modulus)) / (2 * radius)


def _OfSteps(curves, error):
    """Change of the work if it is summed over pairs of steps; None if they are too few."""
    half = [curve[-15::2] for curve in curves]
    if len(half[0]) < 8:
        return None
    return Meshes(1 + error, 1 + EnergyError(*half), 2, of="steps")


def Cylinder(quick):
    h = 0.2 if quick else 0.1
    cylinder = hertz_large.Cylinder(h)
    cylinder.Press(8 if quick else 15)
    figures = cylinder.Figures()
    small = hertz_large.Run(h=0.05 if quick else 0.02, depth=0.02, steps=2)
    depth, steps = 0.3, 6 if quick else 10
    soft, stiff = (Penalty(h, depth, steps, factor) for factor in (200, 800))
    limit = stiff + (stiff - soft) / 3
    modulus = hertz_large.YOUNG / (1 - cylinder.nu**2)
    strains = [Neglected(_Strain(force, modulus), "strains of a/(2 R)") for force in small["hertz"]]
    curves = [figures[name] for name in ("approach", "force", "energy")]
    error = EnergyError(*curves)
    at = "force at an approach of"
    rows = [
        Row(f"{at} 1 % of the radius", small["force"][0], small["hertz"][0], strains[0], "N/mm"),
        Row(f"{at} 2 %", small["force"][1], small["hertz"][1], strains[1], "N/mm"),
        Row(
            "force at 30 %, against a penalty method by NGSolve alone",
            figures["force"][-1],
            limit,
            Extrapolated(limit, stiff),
            "N/mm",
        ),
        Row(
            "work of the plates over strain energy",
            1 + error,
            1,
            _OfSteps(curves, error),
        ),
    ]
    caption = "The section at the end, the forces and the pressures."

    def Draw(left, middle, right):
        Bodies(left, cylinder.mesh, cylinder.displacement, window=(0, 1.3, -0.15, 1.05))
        for name, style in (("force", "-"), ("hertz", "k--")):
            middle.plot([0, *figures["approach"]], [0, *figures[name]], style, label=name)
        middle.set(xlabel="approach [mm]", ylabel="force [N/mm]")
        middle.legend()
        cylinder.contact.Plot("pressure", axes=right)

    return Outcome(rows, Figure(Draw, columns=3), caption)


def FlatRing(quick):
    travel, steps = (1.0, 10) if quick else (1.71, 38)
    rings = [flatring.Ring(h, quarter=quarter) for h in (0.12, 0.18) for quarter in (False, True)]
    for ring in rings:
        ring.Press(travel, steps)
    table = [{key: np.array(v) for key, v in ring.Figures().items()} for ring in rings]
    before = table[0]["travel"] < 1.6
    worst = np.abs(table[0]["force"] / table[1]["force"] - 1)[before].argmax()

    def Differ(step):
        force = [figures["force"][step] for figures in table]
        return *force[:2], Both(*(Meshes(force[k], force[k + 2], 1.5) for k in range(2)))

    rows = [
        Row("force before the inside touches, where it differs most", *Differ(worst), "G R"),
        Row(
            "forces above and below",
            table[0]["force_below"][-1],
            table[0]["force"][-1],
            Tolerance(kind="relative"),
            "G R",
        ),
    ]
    if not quick:
        text = "force at the end, where the inside carries most of it"
        rows.append(Row(text, *Differ(-1), "G R"))
    caption = "The ring at the end, and the force over the travel of the plates."

    def Draw(left, right):
        Bodies(left, rings[0].mesh, rings[0].displacement)
        for name, style in (("force", "o-"), ("force_inside", "s")):
            values = np.where(table[0][name] > 0, table[0][name], np.nan)
            right.semilogy(table[0]["travel"], values, style, ms=3, label=name.replace("_", " "))
        right.set(xlabel="travel / R", ylabel="force / (G R)")
        right.legend()

    return Outcome(rows, Figure(Draw, columns=2), caption)


CASES = [
    Case(
        "pin",
        "A loaded pin",
        "A steel pin fills the hole of an aluminium sheet without clearance and is pushed towards "
        "its round end; the contact opens at the back of the pin (receding contact).",
        "Code_aster, test SSNP156 with quadratic elements, and CONT014 with linear ones for the "
        "rows without friction.",
        "pytest tests/validation/test_validation_pin.py",
        Pin,
    ),
    Case(
        "half-ring",
        "A half ring is pressed on a block",
        "A ring of two layers, the inner one a hundred times stiffer, sinks into a soft block, "
        "then buckles and rests on two places. The published values belong to a mesh with one "
        "linear quadrilateral through each layer, which locks in bending: they are met on that "
        "mesh, within what code_aster's own variants differ by (2 % at t = 0.4, 15 % at 0.6), and "
        "not by a converged computation.",
        "Code_aster, test SSNP165 (modellings a and b); for order 2 a finer mesh of this program.",
        "pytest tests/validation/test_validation_halfring.py",
        HalfRing,
    ),
    Case(
        "hertz-large",
        "A rubber cylinder is flattened",
        "A neo-Hookean cylinder (Poisson ratio 0.49) between rigid plates, until each has come "
        "nearer to its middle by 30 % of the radius. Small approaches are those of Hertz; the "
        "large one is compared with a penalty method, extrapolated to an infinite penalty, and "
        "the work with the energy.",
        "Johnson (1985), equation 5.56 for the approach; a penalty on the plane, by NGSolve alone "
        "(`tests/validation/test_validation_hertz_large.py`).",
        "python tutorials/examples/hertz_large.py --h 0.1 --steps 15 --out results",
        Cylinder,
    ),
    Case(
        "flat-ring",
        "Self-contact: a ring is pressed flat",
        "A rubber ring between two plates, until its inside touches itself. By symmetry this is "
        "contact with a rigid plane through the middle, which is a problem of two bodies. At the "
        "end a small difference of the travel makes a large one of the force.",
        "The computation with the plane.",
        "python tutorials/examples/flatring.py --out results",
        FlatRing,
    ),
]
