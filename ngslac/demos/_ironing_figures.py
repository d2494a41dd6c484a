"""Orders of convergence."""

from __future__ import annotations

from itertools import pairwise

__all__ = ["Quadratic"]


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
