"""Large sliding with friction: ironing and twisting blocks."""

from __future__ import annotations

import math

import ironing
import numpy as np
from problems_twistblocks import Measured
from report_bounds import Exact, Spread, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import ORANGE, Bodies, Figure
from twistblocks import MEAN_DISTANCE, DrawTorque

from ngslac.reference.ironing import DECK, DECK_SMOOTH, PUBLISHED, TIMES

CODE_ASTER = PUBLISHED["code_aster 2020"]


def _Others(force, k, time):
    """What the published curves differ from this force by, at this time."""
    forces = [float(np.interp(time, TIMES, curves[k])) for curves in PUBLISHED.values()]
    who = f"{min(forces):.3g} to {max(forces):.3g} in {len(forces)} papers"
    return Spread(force, forces, who)


def Ironing(quick):
    h, steps, stroke = (0.5, 16, 1.5) if quick else (0.3, 44, 5.0)
    model = ironing.Ironing(h)
    model.Iron(steps, stroke)
    rough = model.Figures()

    def At(figures, key, time):
        return float(np.interp(time, figures["time"], figures[f"{key}_force"]))

    rows = []
    for time in (0.6, 1.0) if quick else (0.6, 1.0, 1.5):
        at = TIMES.index(time)
        for k, key in enumerate(("vertical", "horizontal")):
            text, force = f"{key} force at t = {time:g}, published curve", CODE_ASTER[k][at]
            rows.append(Row(text, At(rough, key, time), force, _Others(force, k, time), "N/mm"))
    for time, forces in {} if quick else DECK.items():
        for k, (key, force) in enumerate(zip(("vertical", "horizontal"), forces, strict=True)):
            text = f"{key} force at t = {time:g}, test deck"
            rows.append(Row(text, At(rough, key, time), force, _Others(force, k, time), "N/mm"))
    smooth = None if quick else ironing.Run(h=h, steps=30, stroke=0.5, friction=0.0)
    for time, force in {} if quick else DECK_SMOOTH.items():
        text = f"frictionless: vertical force at t = {time:g}, test deck"
        rows.append(Row(text, At(smooth, "vertical", time), force, unit="N/mm"))
    done = rough["converged_steps"] / steps
    rows.append(Row("share of the steps that converged", done, 1, Exact()))
    caption = "The end, and the forces of this computation (lines) beside the published ones."

    def Draw(left, right):
        Bodies(left, model.mesh, model.displacement)
        ironing.DrawForces(right, rough)

    return Outcome(rows, Figure(Draw, columns=2), caption)


def Twist(quick):
    turn = 22.5
    count = 2 if quick else 4
    rigid = Measured(count, 2, angle=count * turn, rigid=True)
    elastic = rigid if quick else Measured(8, 4, angle=120.0)
    middles = 0.25 * math.sqrt(2) / MEAN_DISTANCE
    half = math.radians(turn / 2)
    steady, full = rigid.figures, elastic.figures
    rows = [
        Row(
            "rigid plane, 4 faces: steady torque over that of a flat punch",
            steady["punch_ratio"][-1],
            middles,
        ),
        Row(
            "rigid plane: work of friction over that of the tangential torque",
            steady["dissipation_ratio"],
            math.tan(half) / half,
        ),
    ]
    if not quick:
        change = abs(steady["torque"][-1] / steady["torque"][-2] - 1)
        rows += [
            Row("rigid plane: change of the torque in the last step", change, 0),
            Row(
                "two blocks, 16 faces: torque over that of a flat punch",
                full["punch_ratio"][-1],
                1,
            ),
        ]
    for name, value in full["balance"].items():
        text = f"balance of {name.replace('_', ', ')}: error over its size"
        rows.append(Row(text, value, 0, None if name == "torque_both" else Tolerance()))
    rows.append(Row("symmetry of the pressures", full["symmetry_error"], 0, Tolerance()))
    caption = "Pressures and tractions at the end from above, and the torque over the angle."

    def Draw(left, right):
        blocks, table = elastic.blocks, elastic.table
        points = left.scatter(*table["x"][:, :2].T, c=table["pressure"], s=60)
        left.figure.colorbar(points, ax=left, label="pressure [MPa]")
        left.quiver(*table["x"][:, :2].T, *table["traction"][:, :2].T, color=ORANGE)
        left.set_aspect("equal")
        DrawTorque(right, blocks.Figures(), blocks.friction)

    return Outcome(rows, Figure(Draw, columns=2), caption)


CASES = [
    Case(
        "ironing",
        "Shallow ironing",
        "A die is pressed into a soft slab by 1 mm (t = 0 to 1) and drawn over it (t = 1 to 2 for "
        "10 mm, of which half is computed here) with friction 0.3. Published forces differ by up "
        "to 25 % (vertical) and 90 % (horizontal); those of code_aster are the reference, a "
        "curve read from a figure and the numbers of its test decks.",
        "Fischer and Wriggers, Comput. Methods Appl. Mech. Engrg. 195 (2006); code_aster, tests "
        "SSNP153 and CONT003.",
        "python tutorials/examples/ironing.py --h 0.3 --steps 44 --stroke 5 --out results",
        Ironing,
    ),
    Case(
        "twisting-blocks",
        "Twisting blocks",
        "A soft block is pressed on another one and turned: it twists, then slides with friction "
        "0.3 and turns as a whole. Under a uniform pressure the torque of a flat square punch is "
        "0.3826 times friction, force and width; faces that count by their middles alone have "
        "0.924 of it if there are four. Forces and moments balance; the tractions act on both "
        "sides of a gap that vanishes on average, hence the error of the last moment.",
        "The torque of a flat punch; balances of forces, moments and work "
        "(`tests/validation/test_validation_twistblocks.py`).",
        "python tutorials/examples/twistblocks.py --n 4 --steps 8 --angle 120 --out results",
        Twist,
    ),
]
