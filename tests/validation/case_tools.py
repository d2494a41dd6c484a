"""Rigid tools that are no meshes: belt, rolling, indentation by a pyramid, deep drawing."""

from __future__ import annotations

import math
from functools import partial

import belt
import drawing
import pyramid
import rolling
from report_bounds import Neglected, Step, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import FromFolder


def Belt(quick):
    thickness = 0.02 if quick else 0.01
    options = {"thickness": thickness, "h": 0.05 if quick else 0.03}
    thin = Neglected(thickness / belt.RADIUS, "thickness over radius")
    runs = [(90.0, 0.3)] if quick else [(90.0, 0.3), (180.0, 0.3), (90.0, 0.2)]
    found = [belt.Run(wrap, friction, **options) for wrap, friction in runs]
    rows = [
        Row(f"{wrap:g} degrees, friction {friction:g}: ratio", f["ratio"], f["ratio_exact"], thin)
        for (wrap, friction), f in zip(runs, found, strict=True)
    ]
    draw = FromFolder(partial(_Draw, belt, *runs[0], **options), "belt.png")
    return Outcome(rows, draw, "Pressure along the arc, against the tension over the radius.")


def Rolling(quick):
    options = {"h": 0.25, "steps": 6} if quick else {}
    figures = rolling.Run(**options)
    size = Step(options.get("h", 0.167) / 10, "flattening between nodes", kind="absolute")
    rows = [
        Row(f"thickness after pass {k + 1}", figures["thickness"][k], gap, size)
        for k, gap in enumerate(rolling.GAPS)
    ]
    rows.append(Row("volume over that before", figures["volume"], 1))
    draw = FromFolder(partial(_Draw, rolling, **options), "rolling.png")
    return Outcome(rows, draw, "The plate between both passes, and the force on the roll.")


def Pyramid(quick):
    options = {"h": 0.5} if quick else {}
    figures = pyramid.Run(**options)
    slope = Neglected(1 / math.tan(pyramid.FLANK), "slope of the flank")
    rows = [
        Row("cone: force over Sneddon's", figures["cone_ratio"], 1, slope),
        Row("cone around the pyramid: the same", figures["outer_cone_ratio"], 1, slope),
        Row("pyramid over the cone inside of it", figures["pyramid_ratio"], 1),
    ]
    draw = FromFolder(partial(_Draw, pyramid, **options), "pyramid.png")
    return Outcome(rows, draw, "Pressures under a cone, the pyramid and the cone around it.")


def Drawing(quick):
    options = {"depth": 0.03, "steps": 6} if quick else {"depth": 0.08, "steps": 16}
    figures = drawing.Run(**options)
    rows = [
        Row("force of the holder", figures["holder_force"], 10.0, Tolerance(1e-6, kind="relative")),
        Row("sum of all forces over that of the die", figures["balance"], 0, Tolerance(1e-6)),
        Row("draw-in", figures["draw_in"], 0),
    ]
    draw = FromFolder(partial(_Draw, drawing, **options), "drawing.png")
    return Outcome(rows, draw, "The sheet, and the forces of punch, die and holder.")


def _Draw(example, *given, **options):
    *given, folder = given
    example.Run(*given, out=folder, **options)


CASES = [
    Case(
        "belt-drum",
        "A belt on a drum that turns",
        "A thin belt is stretched around a drum, a tool without mesh, that turns until all slips.",
        "Euler and Eytelwein: T2/T1 = exp(friction times angle).",
        "python tutorials/examples/belt.py --wrap 180 --friction 0.3",
        Belt,
    ),
    Case(
        "rolling",
        "A plate is rolled in two passes",
        "Large plastic strains, friction, a roll on a path that turns: from 1 to 0.75 and to 0.5.",
        "The gap between the rolls; the volume does not change in plastic flow.",
        "python tutorials/examples/rolling.py",
        Rolling,
    ),
    Case(
        "pyramid",
        "Cones and a pyramid from an STL file",
        "Pressed into a large block; the pyramid lies between two cones.",
        "Sneddon (1965) for cones, in small displacements; the pyramid between them.",
        "python tutorials/examples/pyramid.py",
        Pyramid,
    ),
    Case(
        "drawing",
        "Deep drawing of a channel",
        "Punch on a path, die at rest, holder moved by a force: its travel is an unknown.",
        "The balance of forces.",
        "python tutorials/examples/drawing.py --depth 0.08 --steps 16",
        Drawing,
    ),
]
