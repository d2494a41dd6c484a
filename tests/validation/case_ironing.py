"""Large sliding with friction: shallow ironing."""

from __future__ import annotations

import ironing
import numpy as np
from published import DECK, DECK_SMOOTH, PUBLISHED, TIMES
from report_bounds import Exact, Spread
from report_case import Case, Outcome, Row
from report_pictures import FromFolder

CODE_ASTER = PUBLISHED["code_aster 2020"]


def _Others(force, k, time):
    """What the published curves differ from this force by, at this time."""
    forces = [float(np.interp(time, TIMES, curves[k])) for curves in PUBLISHED.values()]
    who = f"{min(forces):.3g} to {max(forces):.3g} in {len(forces)} papers"
    return Spread(force, forces, who)


def Ironing(quick):
    h, steps, stroke = (0.5, 16, 1.5) if quick else (0.3, 44, 5.0)
    options = {"h": h, "steps": steps, "stroke": stroke}
    rough = ironing.Run(**options)

    def At(figures, key, time):
        return float(np.interp(time, figures["time"], figures[f"{key}_force"]))

    times = (0.6, 1.0) if quick else (0.6, 1.0, 1.5)
    curve = {time: [forces[TIMES.index(time)] for forces in CODE_ASTER] for time in times}
    rows = [
        Row(
            f"{key} force at t = {time:g}, {source}",
            At(rough, key, time),
            force,
            _Others(force, k, time),
            "N/mm",
        )
        for source, table in (("published curve", curve), ("test deck", {} if quick else DECK))
        for time, forces in table.items()
        for k, (key, force) in enumerate(zip(("vertical", "horizontal"), forces, strict=True))
    ]
    if not quick:
        smooth = ironing.Run(h=h, steps=30, stroke=0.5, friction=0.0)
        for time, force in DECK_SMOOTH.items():
            text = f"frictionless: vertical force at t = {time:g}, test deck"
            rows.append(Row(text, At(smooth, "vertical", time), force, unit="N/mm"))
    done = np.count_nonzero(rough["cuts"] == 0) / steps
    rows.append(Row("share of the steps that converged", done, 1, Exact()))
    caption = "The end, and the forces of this computation (lines) beside the published ones."
    draw = FromFolder(lambda folder: ironing.Run(**options, out=folder), "ironing.png")
    return Outcome(rows, draw, caption)


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
]
