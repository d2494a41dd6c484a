"""Friction in 3D: a sphere on a block that is pushed (Cattaneo-Mindlin), or twisted (Lubkin)."""

from __future__ import annotations

from functools import cache

import cattaneo3d
import numpy as np
import twist
from lubkin import TwistPoint
from report_bounds import Element, Meshes
from report_case import Case, Outcome, Row
from report_pictures import BLUE, INK, ORANGE, Figure

PushedSphere, TwistedSphere = cache(cattaneo3d.Solve), cache(twist.Solve)


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
    runs = [PushedSphere(elements=m, steps=steps, reverse=2, press=1) for m in (n, n - 1)]
    results, (figures, coarser) = runs[0], (run.figures for run in runs)
    ratio, rows, label = n / (n - 1), [], "tangential force over F P"
    for row, before in zip(figures["steps"][:steps], coarser["steps"], strict=False):
        text = f"displacement {1e3 * row['shift_half_spaces']:.3f} µm"
        rows += _OfStep(text, "shear", label, row, before, ratio, Element(1 / n))
    rows.append(_OfStiffness("4 G a / (2 - nu)", figures, coarser, ratio))
    text = "hysteresis: error of the displacement over that of sliding"
    rows.append(Row(text, figures["shift_error"], 0))
    caption = "Force over displacement, there and back; stick radius in each step."
    return Outcome(rows, _Curve(_Pushed, results), caption)


def Twist(quick):
    steps, n = 1 if quick else 4, 4 if quick else 6
    runs = [TwistedSphere(elements=m, steps=steps, angle=1.5, press=1) for m in (n, n * 2 // 3)]
    results, (figures, coarser) = runs[0], (run.figures for run in runs)
    ratio, rows, label = n / (n * 2 // 3), [], "moment over its limit"
    for row, before in zip(figures["steps"], coarser["steps"], strict=True):
        text = f"angle {1e3 * row['angle']:.3f} mrad"
        rows += _OfStep(text, "moment_ratio", label, row, before, ratio, Element(1 / n))
    rows.append(_OfStiffness("16/3 G* a^3", figures, coarser, ratio))
    caption = "Moment over angle, and the stick radius in each step."
    return Outcome(rows, _Curve(_Twisted, results), caption)


def _Curve(draw, results):
    """The load over the motion, and the stick radius in each step."""

    def Draw(left, right):
        draw(left, results)
        _StickRadius(right, results)

    return Figure(Draw, columns=2, size=(9.2, 3.6))


def _StickRadius(ax, results):
    rows = results.figures["steps"]
    number = np.arange(1, len(rows) + 1)
    for key, label, style in (
        ("stick_ratio_exact", "exact", {"color": INK, "marker": "_", "ms": 14, "mew": 1.2}),
        ("stick_ratio", "area that sticks", {"color": BLUE, "marker": "o", "ms": 4}),
        ("stick_ratio_fit", "fit of the tractions", {"color": ORANGE, "marker": "x", "ms": 5}),
    ):
        values = [np.nan if row[key] is None else row[key] for row in rows]
        ax.plot(number, values, ls="none", label=label, **style)
    label = "radius of the stick zone / contact radius"
    ax.set(xlabel="step", xticks=number, ylabel=label, ylim=(0, 1.05))
    ax.legend(loc="lower left")


def _Pushed(ax, results):
    """Draw the force over the shift."""
    problem, rows = results.problem, results.figures["steps"]
    force = results.states[problem.steps - 1].force[2]
    top = results.exact[problem.steps - 1]
    shear = np.linspace(0, top.shear, 101)
    up = [problem.Partial(force, q) for q in shear]
    back = [top.Reverse(q) for q in np.linspace(top.shear, -0.6 * top.shear, 101)]
    limit = problem.friction * force
    for path, label in ((up, "Mindlin"), (back if problem.reverse else [], None)):
        ax.plot(
            [-1e3 * e.shift for e in path],
            [-(e.shear if hasattr(e, "shear") else 0) / limit for e in path],
            color=INK,
            lw=0.9,
            label=label,
        )
    x = [0.0, *(1e3 * row["shift_half_spaces"] for row in rows)]
    ax.plot(x, [0.0, *(row["shear"] for row in rows)], "o", color=ORANGE, ms=4, label="computed")
    label = "displacement, without that of the finite bodies [\u00b5m]"
    ax.set(xlabel=label, ylabel="tangential force / (F P)")
    ax.legend(loc="lower right")


def _Twisted(ax, results):
    """Draw the moment over the angle."""
    problem, rows = results.problem, results.figures["steps"]
    hertz = problem.Hertz(results.states[-1].force[2])
    angles = np.linspace(0, 1.05 * rows[-1]["angle"], 61)
    exact = [TwistPoint.FromAngle(hertz=hertz, angle=t, friction=problem.friction) for t in angles]
    ax.plot(1e3 * angles, [e.moment / e.limit for e in exact], color=INK, lw=0.9, label="Lubkin")
    slope = exact[0].stiffness / exact[0].limit
    ax.plot(1e3 * angles, slope * angles, "--", color=INK, lw=0.7, label="no slip")
    ax.axhline(1.0, ls=":", color=INK, lw=0.7)
    x = [0.0, *(1e3 * row["angle"] for row in rows)]
    y = [0.0, *(row["moment_ratio"] for row in rows)]
    ax.plot(x, y, "o", color=ORANGE, ms=4, label="computed")
    ax.set(xlabel="angle [mrad]", ylabel="moment / (3 pi F P a / 16)", ylim=(0, 1.1))
    ax.legend(loc="lower right")


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
