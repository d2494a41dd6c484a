"""The Hertz problem of `tutorials/examples/hertz.py`, and what else is compared with Hertz."""

import math

import numpy as np
from hertz import AtOrigin, Exact, Figures, Hertz

__all__ = ["ContactEdge", "Pressed", "Values"]


def Pressed(steps=10, **options):
    """The problem, solved; its options are those of `Hertz`."""
    problem = Hertz(**options)
    problem.Press(steps)
    return problem


def Values(state):
    """`Figures` of a state, the pressure over Hertz' peak, and where the contact ends."""
    interval, estimate = ContactEdge(state)
    return Figures(state) | {
        "p0_ratio_raw": np.mean(state["pressure"][AtOrigin(state)]) / Exact(state["time"]).peak,
        "contact_edge_interval": interval,
        "contact_edge_estimate": estimate,
    }


def ContactEdge(state):
    """The last macro-element in contact (start, end), and an estimate of the edge inside.

    The estimate extends p^2, which is linear in x^2 for Hertz' pressure, from the outer half of the
    contact without the last macro-element; it is None with fewer than three values.
    """
    active = (state["status"] > 0) & (state["end"] > 0)
    if not active.any():
        return (0.0, 0.0), None
    start, end, pressure = (state[name][active] for name in ("start", "end", "pressure"))
    middle = 0.5 * (start + end)[:-1]
    outer = middle > 0.4 * end[-1]
    interval = float(start[-1]), float(end[-1])
    if outer.sum() < 3:
        return interval, None
    slope, constant = np.polyfit(middle[outer] ** 2, pressure[:-1][outer] ** 2, 1)
    return interval, math.sqrt(-constant / slope) if slope < 0 < constant else None
