"""Balance of forces and moments, and paired areas, which must hold exactly."""

from __future__ import annotations

import numpy as np
from finitepress import blocks2d
from report_bounds import Rate, Rounding
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREEN, ORANGE, Figure
from test_finite_momentum import wavy, worst
from test_sliding3d import ASIDE, OFFSETS, Sliding, works

COLOURS = (BLUE, ORANGE, GREEN)


def Balance(quick):
    kinds = [("hex", "hex")] if quick else [("hex", "hex"), ("tet", "prism")]
    slides = {" on ".join(pair): SlidOff(pair) for pair in kinds}
    rows = []
    for name, values in slides.items():
        _, area, sides = values.T
        text = f"{name}, sliding off the edge"
        rows += [
            Row(f"{text}: largest error of the paired area", area.max(), 0, Rounding()),
            Row(f"{text}: forces on both sides, largest difference", sides.max(), 0, Rounding()),
        ]
    moments, forces = {}, []
    for order in (2,) if quick else (1, 2, 3):
        found = np.array([worst(wavy(blocks2d(h), order)) for h in (0.1, 0.05)])
        forces.append(found[:, 0].max())
        moments[order] = found[:, 1]
        rate = float(np.log2(found[0, 1] / found[1, 1]))
        text = f"large sliding, order {order}: rate at which the moments balance"
        rows.append(Row(text, rate, order + 1, Rate()))
    text = "large sliding: sum of all forces over their size"
    rows.append(Row(text, max(forces), 0, Rounding()))

    def Draw(left, right):
        for colour, (name, values) in zip(COLOURS, slides.items(), strict=False):
            left.plot(OFFSETS, values[:, 0], "o-", ms=4, color=colour, label=name)
        left.set_xlabel("way over the width of the block")
        left.set_ylabel("contact force")
        for colour, (order, values) in zip(COLOURS, moments.items(), strict=False):
            right.loglog([0.1, 0.05], values, "o-", ms=4, color=colour, label=f"order {order}")
        right.set_xlabel("edge length")
        right.set_xticks([], minor=True)
        right.set_xticks([0.05, 0.1], ["0.05", "0.1"])
        right.set_ylabel("sum of moments over size of the forces")
        for ax in (left, right):
            ax.legend()

    caption = "Left: the force of a block that slides off another. Right: balance of moments."
    return Outcome(rows, Figure(Draw, columns=2), caption)


def SlidOff(kinds):
    """(n, 3): force, error of the area, and difference of the forces for each offset."""
    sliding, found = Sliding(kinds), []
    for offset in OFFSETS:
        sliding.MoveRigidly(offset)
        slave, master = works(sliding.contact, [(0, 0, 1)])
        left = (1 - offset) * (1 - ASIDE * offset)
        area = abs(sliding.contact.Table()["area"].sum() - left)
        found.append((sliding.contact.Force()[2], area, abs(master[0] - slave[0])))
    return np.array(found)


CASES = [
    Case(
        "balance",
        "Balance of forces and moments",
        "Actio and reactio: a block slides off the edge of another one, step by step to where "
        "nothing is left to touch; the paired area is that of the overlap, and the tractions do "
        "the same work on a shift of either body. With large sliding on wavy surfaces all forces "
        "balance as well; moments do so up to the gap that is left between points of the "
        "surfaces, which vanishes with the mesh size.",
        "Area of the overlap; zero sums; one order more than that of the displacement.",
        "pytest tests/validation/test_cases.py -k balance",
        Balance,
    ),
]
