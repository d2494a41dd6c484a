"""Figures of the ironing problem: force curves, iteration counts, orders of convergence."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ._ironing_reference import PUBLISHED, TIMES

__all__ = ["Figures", "Quadratic", "Report"]


def Quadratic(residuals):
    """Do the last residuals of a step fall as those of a quadratic method?

    A fall is a quadratic one if r_n <= 1000 r_(n-1)^2 and r_n <= 1e-2 r_(n-1); the residuals are
    relative to the forces at work. One of the last two falls must be, and the last one must be by
    100 at least or end in rounding (1e-12). Linear convergence by a factor above 1e-2 fails.

    Parameters
    ----------
    residuals : sequence of float
        Of the iterations of one step, the last one converged.
    """
    falls = [*pairwise(residuals)][-2:]
    if not falls:
        return True  # no iteration at all
    before, last = falls[-1]
    return last <= max(1e-2 * before, 1e-12) and any(
        after <= min(1000 * first**2, 1e-2 * first) for first, after in falls
    )


def Figures(results, seconds):
    """All figures of the run, ready for JSON."""
    problem, states = results.problem, results.states
    forces = np.array([state.force for state in states]).reshape(-1, 2)
    quadratic = [Quadratic(state.residuals) for state in states]
    return {
        "steps": problem.steps,
        "converged_steps": _Reached(results),
        "quadratic": all(quadratic) and bool(quadratic),
        "quadratic_steps": sum(quadratic),
        "time": [state.time for state in states],
        "vertical_force": forces[:, 1].tolist(),
        "horizontal_force": forces[:, 0].tolist(),
        "cuts": sum(state.cuts for state in states),
        "iterations": [state.iterations for state in states],
        "residuals": [list(state.residuals) for state in states],
        "status": [list(state.counts) for state in states],
        "published": {
            name: {"time": TIMES, "vertical_force": v, "horizontal_force": h}
            for name, (v, h) in PUBLISHED.items()
        },
        "failure": results.failure,
        "ndof": len(results.solution.vec),
        "h": problem.h,
        "order": problem.order,
        "friction": problem.friction,
        "stroke": problem.stroke,
        "seconds": seconds,
    }


def _Reached(results):
    """How many of the wanted steps have converged, in one piece or in several."""
    (down, right), (turn, end) = results.problem.parts, results.problem.times
    wanted = np.concatenate(
        [np.linspace(0, turn, down + 1)[1:], np.linspace(turn, end, right + 1)[1:]]
    )
    times = np.array([state.time for state in results.states])
    return sum(bool(np.any(np.abs(times - t) < 1e-9)) for t in wanted)


def Report(results):
    """The run against the published forces as text."""
    figures = results.figures
    lines = [
        f"Ironing: h = {figures['h']:g} mm, order {figures['order']}, friction "
        f"{figures['friction']:g}, {figures['ndof']} unknowns",
        f"{figures['converged_steps']} of {figures['steps']} steps, {figures['cuts']} cuts, "
        f"{sum(figures['iterations'])} iterations (at most {max(figures['iterations'], default=0)} "
        f"a step), quadratic in {figures['quadratic_steps']} of {len(figures['time'])}; "
        f"{figures['seconds']:.1f} s",
        "",
        f"{'force [N/mm]':<24}{'vertical at t =':>15}{'0.6      1    1.5':>21}"
        f"{'horizontal':>14}{'0.6      1    1.5':>20}",
    ]
    rows = {"this run": (figures["time"], figures["vertical_force"], figures["horizontal_force"])}
    rows |= {name: (TIMES, v, h) for name, (v, h) in PUBLISHED.items()}
    for name, (times, vertical, horizontal) in rows.items():
        values = [
            np.interp((0.6, 1.0, 1.5), times, curve, right=np.nan) if len(times) else [np.nan] * 3
            for curve in (vertical, horizontal)
        ]
        texts = ["".join(f"{value:7.0f}" for value in part) for part in values]
        lines.append(f"{name:<39}{texts[0]}{'':>13}{texts[1]}")
    return "\n".join(lines)
