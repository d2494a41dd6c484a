"""Pictures of the problems with friction in 3D: the curve of the load, and the stick radius."""

from __future__ import annotations

import numpy as np
from report_pictures import BLUE, INK, ORANGE, STYLE, Matplotlib, Save

from ngslac.reference import TwistPoint

__all__ = ["CurvePicture", "Pushed", "Twisted"]


def CurvePicture(results, file, curve):
    """The curve of the load, drawn by ``curve(ax, results)``, and the stick radius."""
    mpl = Matplotlib()
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(9.2, 3.6), layout="constrained")
        left, right = figure.subplots(1, 2)
        curve(left, results)
        _StickRadius(right, results)
        Save(figure, file)


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
    ax.set_xlabel("step")
    ax.set_xticks(number)
    ax.set_ylabel("radius of the stick zone / contact radius")
    ax.set_ylim(0, 1.05)
    ax.legend(loc="lower left")


def Pushed(ax, results):
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
    ax.set_xlabel("displacement, without that of the finite bodies [\u00b5m]")
    ax.set_ylabel("tangential force / (F P)")
    ax.legend(loc="lower right")


def Twisted(ax, results):
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
    ax.set_xlabel("angle [mrad]")
    ax.set_ylabel("moment / (3 pi F P a / 16)")
    ax.set_ylim(0, 1.1)
    ax.legend(loc="lower right")
