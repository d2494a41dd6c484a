"""Friction in 3D: Cattaneo-Mindlin, twist, directions of slip, benchmark 2."""

from __future__ import annotations

import cattaneo3d
import numpy as np
import test_validation_punch3d as punch
import twist
from friction3d_pictures import CurvePicture, Pushed, Twisted
from ngsolve import Parameter
from problems_friction3d import PRESSURE, ShearedBlocks
from report_bounds import Element, Meshes, Spread, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import BLUE, INK, ORANGE, Figure
from sector3d import SectorMesh
from test_friction3d import ANGLES, FRICTION, Direction

# NAFEMS benchmark 2: displacement [mm] with linear elements.
LINEAR = {0.0: -0.130734, 0.1: -0.128580}


def Mindlin(quick):
    steps, n = 1 if quick else 3, 3 if quick else 4
    runs = [cattaneo3d.Solve(elements=m, steps=steps, reverse=2, press=1) for m in (n, n - 1)]
    results, (figures, coarser) = runs[0], (run.figures for run in runs)
    ratio, element, rows = n / (n - 1), Element(1 / n), []
    for row, before in zip(figures["steps"][:steps], coarser["steps"], strict=False):
        text = f"displacement {1e3 * row['shift_half_spaces']:.3f} µm: "
        meshes = _OfDeviations("shear", row, before, ratio)
        stick = row["stick_ratio_fit"], row["stick_ratio_exact"]
        rows += [
            Row(text + "tangential force over F P", row["shear"], row["shear_exact"], meshes),
            Row(text + "stick radius over a, from the tractions", *stick, element),
        ]
    stiffness = [each["stiffness_ratio"] for each in (figures, coarser)]
    text = "hysteresis: error of the displacement over that of sliding"
    rows += [
        Row(
            "stiffness before slip over 4 G a / (2 - nu)",
            stiffness[0],
            1,
            Meshes(*stiffness, ratio),
        ),
        Row(text, figures["shift_error"], 0),
    ]
    caption = "Force over displacement, there and back; stick radius in each step."
    return Outcome(rows, lambda file: CurvePicture(results, file, Pushed), caption)


def _OfDeviations(name, row, before, ratio):
    """What the deviation from the exact value changes by: each mesh has its own displacement."""
    fine, coarse = (r[name] / r[name.removesuffix("_ratio") + "_exact"] for r in (row, before))
    return Meshes(fine, coarse, ratio)


def Twist(quick):
    steps, n = 1 if quick else 4, 4 if quick else 6
    runs = [twist.Solve(elements=m, steps=steps, angle=1.5, press=1) for m in (n, n * 2 // 3)]
    results, (figures, coarser) = runs[0], (run.figures for run in runs)
    ratio, element, rows = n / (n * 2 // 3), Element(1 / n), []
    for row, before in zip(figures["steps"], coarser["steps"], strict=True):
        text = f"angle {1e3 * row['angle']:.3f} mrad: "
        meshes = _OfDeviations("moment_ratio", row, before, ratio)
        stick = row["stick_ratio_fit"], row["stick_ratio_exact"]
        rows += [
            Row(text + "moment over its limit", row["moment_ratio"], row["moment_exact"], meshes),
            Row(text + "stick radius over a, from the tractions", *stick, element),
        ]
    stiffness = [each["stiffness_ratio"] for each in (figures, coarser)]
    text = "stiffness before slip over 16/3 G* a^3"
    rows.append(Row(text, stiffness[0], 1, Meshes(*stiffness, ratio)))
    caption = "Moment over angle, and the stick radius in each step."
    return Outcome(rows, lambda file: CurvePicture(results, file, Twisted), caption)


def Directions(quick):
    blocks, bound = ShearedBlocks(friction=FRICTION), FRICTION * PRESSURE
    angles, found, errors = ANGLES[:3] if quick else ANGLES, [], {"slip": [], "stick": []}
    for angle in angles:
        blocks.Shear(Direction(angle), stress=bound, slip=2e-3)
        found.append(blocks.tangential.copy())
        errors["slip"].append(np.abs(found[-1] - bound * Direction(angle)).max() / bound)
        blocks.Shear(Direction(angle), stress=0.999 * bound)
        off = blocks.tangential - 0.999 * bound * Direction(angle)
        errors["stick"].append(np.abs(off).max() / bound)
    rows = [
        Row(
            f"{name}: largest error of the friction, {len(angles)} directions",
            max(values),
            0,
            Tolerance(),
        )
        for name, values in errors.items()
    ]

    def Draw(ax):
        circle = np.linspace(0, 2 * np.pi, 361)
        ax.plot(bound * np.cos(circle), bound * np.sin(circle), color=INK, lw=0.8, label="F p")
        points = np.concatenate(found)
        ax.plot(*points.T, "o", color=ORANGE, ms=5, label="macro-elements in slip")
        ax.set_aspect("equal")
        ax.set_xlabel("friction along x")
        ax.set_ylabel("friction along y")
        ax.legend(loc="center")

    return Outcome(rows, Figure(Draw, size=(4.2, 4)), "Friction of all macro-elements in slip.")


def Punch(quick):
    mesh = SectorMesh(punch.HalfSection(1.0 if quick else 0.4), punch.ANGLE)
    found = {f: punch.Outcome.Of(mesh, Parameter(f)) for f in punch.PUBLISHED}
    rows = [
        Row(
            f"friction {friction:g}: displacement of the middle",
            outcome.foundation,
            punch.PUBLISHED[friction],
            Spread(punch.PUBLISHED[friction], [LINEAR[friction]], f"linear {LINEAR[friction]}"),
            "mm",
        )
        for friction, outcome in found.items()
    ]
    change, published = (
        values[0.1] - values[0.0]
        for values in ({f: o.foundation for f, o in found.items()}, punch.PUBLISHED)
    )
    rows.append(Row("change by friction", change, published, unit="mm"))
    for friction, outcome in found.items():
        rows.append(
            Row(
                f"friction {friction:g}: contact force over load",
                outcome.force[2] / outcome.load,
                1,
                Tolerance(),
            )
        )

    def Draw(ax):
        for colour, (friction, outcome) in zip((BLUE, ORANGE), found.items(), strict=True):
            pressure = outcome.table["pressure"]
            ax.plot(
                outcome.radius, pressure, "o", ms=3, color=colour, label=f"friction {friction:g}"
            )
        ax.set_xlabel("distance from the axis [mm]")
        ax.set_ylabel("pressure [MPa]")
        ax.legend(loc="upper left")

    caption = "Pressures of the macro-elements: highest where the round edge begins."
    return Outcome(rows, Figure(Draw, size=(6, 3.4)), caption)


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
        "Lubkin, J. Appl. Mech. 18 (1951), as `TwistPoint`.",
        "python tutorials/examples/twist.py --steps 4 --out results",
        Twist,
    ),
    Case(
        "directions",
        "Coulomb's cone is round",
        "Two blocks under a pressure of 25, sheared in eight directions of the interface, at the "
        "bound of friction and just below it, on a mesh of hexahedra and tetrahedra.",
        "Coulomb's law: friction 0.3 times the pressure along the shear.",
        "pytest tests/validation/test_friction3d.py",
        Directions,
    ),
    Case(
        "nafems2",
        "NAFEMS contact benchmark 2",
        "A steel punch with a rounded edge on an aluminium foundation under a pressure of 100 "
        "MPa: a sector of five degrees between two planes of symmetry. Published values with "
        "linear and quadratic elements differ by 1.7 %; the reference are the quadratic ones.",
        "A. Konter, NAFEMS (2006); values of code_aster, test SSNA122.",
        "pytest tests/validation/test_validation_punch3d.py",
        Punch,
    ),
]
