"""What must hold exactly: balances of forces, areas, invariance under rotations."""

from __future__ import annotations

import numpy as np
from finitepress import Led, blocks2d, blocks3d
from ngsolve import CF, GridFunction
from report_bounds import Rate, Rounding
from report_case import Case, Outcome, Row
from report_pictures import BLUE, GREEN, INK, ORANGE, Bodies, Figure
from test_finite_invariance import FRICTION, lead2d, lead3d
from test_finite_momentum import wavy, worst
from test_sliding3d import ASIDE, OFFSETS, Sliding

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
        sliding.Press()
        contact, table = sliding.contact, sliding.contact.Table()
        sides = []
        for operator in contact.Mortar():
            nodal = table["traction"].ravel() @ operator.ToDense().NumPy()
            unit = GridFunction(contact.space.displacement)
            unit.Set(CF((0, 0, 1)))
            sides.append(float(nodal @ unit.vec.FV().NumPy()))
        area = abs(table["area"].sum() - (1 - offset) * (1 - ASIDE * offset))
        found.append((contact.Force()[2], area, abs(sides[1] - sides[0])))
    return np.array(found)


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
            found.append(
                (
                    np.abs(after["pressure"] - before["pressure"]).max() / size,
                    np.abs(after["traction"] - before["traction"] @ R.T).max() / size,
                    np.abs(after["gap"] - before["gap"]).max(),
                    np.abs(after["slip"] - before["slip"] @ R.T).max(),
                )
            )
        curves[name] = np.array(found)
        keys = ("pressure, relative", "traction, relative", "gap", "slip")
        for key, largest in zip(keys, curves[name].max(axis=0), strict=True):
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
        "balance",
        "Balance of forces and moments",
        "Actio and reactio: a block slides off the edge of another one, step by step to where "
        "nothing is left to touch; the paired area is that of the overlap, and the tractions do "
        "the same work on a shift of either body. With large sliding on wavy surfaces all forces "
        "balance as well; moments do so up to the gap that is left between points of the "
        "surfaces, which vanishes with the mesh size.",
        "Area of the overlap; zero sums; one order more than that of the displacement.",
        "pytest tests/solver/test_sliding3d.py tests/contact/test_finite_momentum.py",
        Balance,
    ),
    Case(
        "invariance",
        "Rotations and translations",
        "Two blocks are pressed on each other so that parts of the surface are open, stick and "
        "slip in a step under way. Then everything is turned by large angles and shifted: "
        "tractions, gaps and slips turn with the bodies, and nothing else changes.",
        "The state before.",
        "pytest tests/contact/test_finite_invariance.py",
        Invariance,
    ),
]
