"""Friction in 3D: a sphere on a block that is pushed (Cattaneo-Mindlin), or twisted (Lubkin)."""

from __future__ import annotations

from functools import cache, partial

import cattaneo3d
import twist
from report_bounds import Element, Meshes
from report_case import Case, Outcome, Row
from report_pictures import FromFolder

PushedSphere, TwistedSphere = cache(cattaneo3d.Run), cache(twist.Run)


def _OfStep(text, name, label, row, before, ratio, element):
    """The load against its exact value, whose deviation is compared on two meshes, and stick."""
    exact = name.removesuffix("_ratio") + "_exact"
    meshes = Meshes(row[name] / row[exact], before[name] / before[exact], ratio)
    stick = row["stick_ratio_fit"], row["stick_ratio_exact"]
    return [
        Row(f"{text}: {label}", row[name], row[exact], meshes),
        Row(f"{text}: stick radius over a, from the tractions", *stick, element),
    ]


def _OfStiffness(text, figures, coarser, ratio):
    """Before slip."""
    stiffness = figures["stiffness_ratio"], coarser["stiffness_ratio"]
    return Row(f"stiffness before slip over {text}", stiffness[0], 1, Meshes(*stiffness, ratio))


def Mindlin(quick):
    steps, n = 1 if quick else 3, 3 if quick else 4
    options = {"steps": steps, "reverse": 2, "press": 1}
    figures, coarser = (PushedSphere(elements=m, **options) for m in (n, n - 1))
    ratio, rows, label = n / (n - 1), [], "tangential force over F P"
    for row, before in zip(figures["steps"][:steps], coarser["steps"], strict=False):
        text = f"displacement {1e3 * row['shift_half_spaces']:.3f} µm"
        rows += _OfStep(text, "shear", label, row, before, ratio, Element(1 / n))
    rows.append(_OfStiffness("4 G a / (2 - nu)", figures, coarser, ratio))
    text = "hysteresis: error of the displacement over that of sliding"
    rows.append(Row(text, figures["shift_error"], 0))
    caption = "Force over displacement, there and back; stick radius in each step; tractions."
    draw = partial(cattaneo3d.Run, elements=n, **options)
    return Outcome(rows, FromFolder(lambda folder: draw(out=folder), "cattaneo3d.png"), caption)


def Twist(quick):
    steps, n = 1 if quick else 4, 4 if quick else 6
    options = {"steps": steps, "angle": 1.5, "press": 1}
    figures, coarser = (TwistedSphere(elements=m, **options) for m in (n, n * 2 // 3))
    ratio, rows, label = n / (n * 2 // 3), [], "moment over its limit"
    for row, before in zip(figures["steps"], coarser["steps"], strict=True):
        text = f"angle {1e3 * row['angle']:.3f} mrad"
        rows += _OfStep(text, "moment_ratio", label, row, before, ratio, Element(1 / n))
    rows.append(_OfStiffness("16/3 G* a^3", figures, coarser, ratio))
    caption = "Moment over angle; stick radius in each step; tractions."
    draw = partial(twist.Run, elements=n, **options)
    return Outcome(rows, FromFolder(lambda folder: draw(out=folder), "twist.png"), caption)


CASES = [
    Case(
        "cattaneo3d",
        "Cattaneo and Mindlin in 3D",
        "A sphere on a block of the same material is pressed, and pushed sideways until most of "
        "the contact slips, and back. Half of it is computed, with four element edges along the "
        "contact radius. The displacement of the finite bodies is taken off as computed without "
        "contact. Mindlin's solution neglects the slip across the load.",
        "Mindlin (1949), Mindlin and Deresiewicz (1953), Johnson (1985), sections 7.2 and 7.4, as "
        "`CattaneoMindlinPoint`.",
        "python tutorials/examples/cattaneo3d.py --steps 3 --out results",
        Mindlin,
    ),
    Case(
        "twist",
        "A sphere that is twisted",
        "The same sphere turns about its axis; slip comes in from the edge, and the stick zone "
        "shrinks to the middle. A quarter is computed, with six element edges along the contact "
        "radius.",
        "Lubkin, J. Appl. Mech. 18 (1951), as in `tutorials/examples/lubkin.py`.",
        "python tutorials/examples/twist.py --steps 4 --out results",
        Twist,
    ),
]
