"""Rigid tools that are no meshes: belt, rolling, a pyramid, deep drawing; and rollers."""

from __future__ import annotations

import math
from functools import partial

import belt
import carter
import cup
import flatpunch
import pyramid
import rolling
import upsetting
from report_bounds import Element, Meshes, Neglected, Step, Tolerance
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


def Carter(quick):
    options = {"shares": (0.5,), "h": 0.25} if quick else {}
    figures, h = carter.Run(**options), options.get("h", 0.125)
    half = Element(h / 4, "half an edge over the width 2a")
    rows = []
    columns = (figures[name] for name in ("creep", "share", "share_exact", "stick"))
    for creep, share, exact, stick in zip(*columns, strict=True):
        rows += [
            Row(f"creep {creep:.5f}: Q/(mu P)", share, exact, half),
            Row("stick zone over the width", stick, math.sqrt(1 - exact), Element(h / 2)),
        ]
    draw = FromFolder(partial(_Draw, carter, **options), "carter.png")
    return Outcome(rows, draw, "The tangential force on the way, and the tractions at its end.")


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


def FlatPunch(quick):
    h = 0.125 if quick else 0.0625
    rows = []
    for friction, name in ((0.0, "smooth"), (1.0, "friction 1")):
        fine, coarse = (flatpunch.Run(k * h, friction)["pressure"] for k in (1, 2))
        bound = Meshes(fine, coarse, 2)
        rows.append(Row(f"{name}: mean pressure over Y", fine, flatpunch.PRANDTL, bound))
    draw = FromFolder(partial(_Draw, flatpunch, h), "flatpunch.png")
    caption = "Mean pressure on the way down, pressure at its end, and plastic strain (smooth)."
    return Outcome(rows, draw, caption)


def Upsetting(quick):
    options = {"n": 2, "depth": 2.0, "steps": 4} if quick else {}
    smooth = upsetting.Run(friction=0.0, **options)
    rough = upsetting.Run(**options)
    strains = Neglected(1e-6, "rational form of the logarithm")
    rows = [
        Row("smooth: force over that of the law", smooth["force_ratio"][-1], 1, strains),
        Row("smooth: bulge over the radius", smooth["bulge"] / upsetting.RADIUS, 0, Tolerance()),
        Row("friction 0.2: force over that without", rough["force_ratio"][-1], 1),
        Row("friction 0.2: bulge [mm]", rough["bulge"], 0),
        Row("volume over that before", rough["volume"], 1),
    ]
    draw = FromFolder(partial(_Draw, upsetting, **options), "upsetting.png")
    return Outcome(rows, draw, "With friction: force on the way, and the side of the billet.")


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


def Cup(quick):
    options = {"h": 0.2, "depth": 0.01, "steps": 2} if quick else {}
    figures = cup.Run(**options)
    rows = [
        Row("force of the holder", figures["holder_force"], 3.0, Tolerance(1e-6, kind="relative")),
        Row("sum of all forces over that of the die", figures["balance"], 0, Tolerance(1e-6)),
        Row("volume over that before", figures["volume"], 1),
        Row("draw-in", figures["draw_in"], 0),
        Row("spread of the rim over the draw-in", figures["rim_spread"] / figures["draw_in"], 0),
    ]
    draw = FromFolder(partial(_Draw, cup, **options), "cup.png")
    return Outcome(rows, draw, "The cup, the forces, and the thickness along the radius.")


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
        "carter",
        "Rollers that creep",
        "Two equal rollers are pressed together, and one turns a little faster: friction holds "
        "where the surfaces come in, and slips behind. Creep is that of the surfaces: of that of "
        "the hubs what still winds the rollers up does not count.",
        "Carter, Proc. R. Soc. Lond. A 112 (1926); Johnson, Contact Mechanics (1985), section 8.3.",
        "python tutorials/examples/carter.py",
        Carter,
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
        "upsetting",
        "A billet is upset",
        "An eighth of a cylinder in 3D under a flat die, smooth or rough; large plastic strains.",
        "Smooth: the force of a cylinder that stays one, from the law of the material.",
        "python tutorials/examples/upsetting.py",
        Upsetting,
    ),
    Case(
        "flatpunch",
        "The limit load of a flat punch",
        "Plane strain, von Mises without hardening; the punch is a polygon with sharp corners.",
        "Prandtl (1920); Hill (1950): (2 + pi) times the shear yield stress, smooth or rough.",
        "python tutorials/examples/flatpunch.py",
        FlatPunch,
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
        "cup",
        "Deep drawing of a round cup",
        "A quarter of the blank in 3D, large plastic strains, friction on die, punch and a holder "
        "that a force moves.",
        "The balance of forces, and symmetry: the rim of a round cup is round.",
        "python tutorials/examples/cup.py",
        Cup,
    ),
]
