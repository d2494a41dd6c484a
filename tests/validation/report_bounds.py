"""Accepted differences, each with where it comes from: never from the result that it judges."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

KINDS = ("relative", "absolute", "least")
UNIT = 2.2e-16
CONDITION = (
    5e3  # in the 1-norm, scaled by the diagonal, of order 3 on tetrahedra with bubbles: 5.4e3
)
SAFETY = 3.0  # Roache, J. Fluids Eng. 116 (1994) 405: for an estimate from two meshes
SHORTFALL = 0.2  # of an observed rate

ORIGINS = {
    "exact": "nothing may differ",
    "rounding": "unit roundoff times the condition number of the matrix",
    "tolerance": "the tolerance that Newton's method was given",
    "digits": "half a unit of the last digit that the reference has",
    "rate": f"a rate may fall short of the theory by {SHORTFALL}, since meshes are finite",
    "published": "what published values of the same quantity differ by",
    "stated": "the accuracy that the source of the reference states for it",
    "neglected": "the size of the terms that the theory of the reference leaves out",
    "means": "what the exact profile differs by from its own means over the same macro-elements: "
    "no piecewise constant pressure is nearer to it",
    "element": "one macro-element, which is open, sticks or slips as a whole",
    "two meshes": f"difference to a coarser mesh of size ratio r, times {SAFETY:g}/(r - 1): "
    "Roache's estimate of the error for two meshes and first order",
    "extrapolation": "the step from the last computed value to the extrapolated one",
    "step": "what changes in one time step, or while a wave passes one element",
}


@dataclass(frozen=True)
class Bound:
    """Largest accepted difference.

    Parameters
    ----------
    size : float
        0: none.
    origin : str
        A key of `ORIGINS`.
    why : str
        The numbers it was made of.
    kind : {"relative", "absolute", "least"}
        How values are compared: ours over the reference less 1; their difference; the same, where
        ours may be larger by any amount, as a rate of convergence may.
    """

    size: float
    origin: str
    why: str = ""
    kind: str = "relative"

    def __post_init__(self):
        if self.kind not in KINDS:
            raise ValueError(f"kind must be one of {', '.join(KINDS)}, not {self.kind!r}")
        if self.origin not in ORIGINS:
            raise ValueError(f"origin must be one of {', '.join(ORIGINS)}, not {self.origin!r}")
        if not 0 <= self.size < math.inf:
            raise ValueError(f"size = {self.size} must be at least 0 and finite")

    @property
    def text(self):
        return f"{self.origin}: {self.why}" if self.why else self.origin


def Exact():
    return Bound(0.0, "exact", kind="absolute")


def Rounding(*, condition=CONDITION, scale=1.0, kind="absolute"):
    """`scale`: size of the numbers whose rounding it is, if not one."""
    why = f"condition {condition:.0g}" + (f", numbers of {scale:.3g}" if scale != 1 else "")
    return Bound(UNIT * condition * scale, "rounding", why, kind)


def Tolerance(tol=1e-10, *, factor=1.0, why="", kind="absolute"):
    return Bound(tol * factor, "tolerance", f"{tol:.0e}{why}", kind)


def HalfDigit(unit):
    return Bound(unit / 2, "digits", f"{unit:g}", "absolute")


def Rate():
    return Bound(SHORTFALL, "rate", kind="least")


def Spread(reference, others, who):
    """Largest difference of published values to the one that is the reference."""
    size = max(abs(other / reference - 1) for other in others)
    return Bound(size, "published", who)


def Stated(size, source):
    return Bound(size, "stated", source)


def Neglected(size, what, *, kind="relative"):
    return Bound(size, "neglected", what, kind)


def Means(size, why=""):
    return Bound(float(size), "means", why, "absolute")


def MeshSpread(function, start, end, *, n=200):
    """Root mean square over intervals of a function's difference to its mean on each.

    Parameters
    ----------
    function : callable
    start, end : (m,) arrays
    n : int
        Points in each interval.

    Returns
    -------
    float
    """
    share = (np.arange(n) + 0.5) / n
    values = function(start[:, None] + (end - start)[:, None] * share)
    return float(np.sqrt(np.mean(np.var(values, axis=1))))


def Element(size, why="", *, kind="absolute"):
    return Bound(float(size), "element", why, kind)


def Meshes(fine, coarse, ratio, *, of="mesh sizes"):
    """For the result of the fine one."""
    size = SAFETY * abs(coarse / fine - 1) / (ratio - 1)
    return Bound(float(size), "two meshes", f"{of} {ratio:.3g} : 1, {coarse:.5g}")


def Both(one, other):
    """For two computed results that are compared with each other."""
    return Bound(one.size + other.size, one.origin, f"{one.why}; {other.why}", one.kind)


def Extrapolated(to, last):
    return Bound(abs(last / to - 1), "extrapolation", f"from {last:.5g}")


def Step(size, why, *, kind="relative"):
    return Bound(size, "step", why, kind)
