"""Rotations and translations of a stressed pair, which must change nothing."""

from __future__ import annotations

import numpy as np
from finitepress import Led, blocks2d, blocks3d
from report_bounds import Rounding
from report_case import Case, Outcome, Row
from report_pictures import BLUE, INK, ORANGE, Bodies, Figure
from test_finite_invariance import FRICTION, lead2d, lead3d


def Invariance(quick):
    problems = {"2D, order 2": Led(blocks2d(0.15), lead2d, **FRICTION)}
    if not quick:
        problems["3D, hexahedra on tetrahedra"] = Led(blocks3d("hex", "tet"), lead3d, **FRICTION)
    rows, curves, degrees = [], {}, (10, 90, 137, 180, 310)
    for name, problem in problems.items():
        problem.run(0.5, tol=1e-12)
        problem.solve(1.0, tol=1e-12)
        problem.contact.Follow(problem.gf)
        before, found = problem.table(), []
        size = before["pressure"].max()
        for angle in degrees:
            moved, R = problem.moved(angle, (3, -2, 1)[: problem.dim])
            problem.contact.Follow(moved)
            after = problem.table(moved)
            change = {
                "pressure, relative": (after["pressure"] - before["pressure"]) / size,
                "traction, relative": (after["traction"] - before["traction"] @ R.T) / size,
                "gap": after["gap"] - before["gap"],
                "slip": after["slip"] - before["slip"] @ R.T,
            }
            found.append([np.abs(values).max() for values in change.values()])
        curves[name] = np.array(found)
        for key, largest in zip(change, curves[name].max(axis=0), strict=True):
            rows.append(Row(f"{name}: change of the {key}", largest, 0, Rounding()))

    def Draw(left, right):
        first = problems["2D, order 2"]
        Bodies(left, first.mesh, first.gf.components[0], n=3)
        for colour, (name, values) in zip((BLUE, ORANGE), curves.items(), strict=False):
            right.semilogy(degrees, values.max(axis=1), "o-", color=colour, ms=4, label=name)
        right.axhline(Rounding().size, color=INK, lw=0.8, ls="--", label="accepted")
        right.set_ylim(1e-17, 1e-8)
        right.set_xlabel("rotation [degrees]")
        right.set_ylabel("largest change")
        right.legend()

    caption = "Left: the stressed pair in 2D. Right: what a rotation and a translation change."
    return Outcome(rows, Figure(Draw, columns=2), caption)


CASES = [
    Case(
        "invariance",
        "Rotations and translations",
        "Two blocks are pressed on each other so that parts of the surface are open, stick and "
        "slip in a step under way. Then everything is turned by large angles and shifted: "
        "tractions, gaps and slips turn with the bodies, and nothing else changes.",
        "The state before.",
        "pytest tests/validation/test_cases.py -k invariance",
        Invariance,
    ),
]
