# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pressures like a semi-ellipse, and averages over intervals for piecewise constant multipliers."""

import numpy as np

from ._checks import interval, points

__all__ = ["semi_ellipse", "semi_ellipse_mean", "semi_ellipsoid_gap"]


def semi_ellipse(x: float | np.ndarray, halfwidth: float) -> float | np.ndarray:
    """Evaluate sqrt(1 - (x/halfwidth)^2) inside, 0 outside (and 0 for zero width)."""
    x = points("x", x)
    if halfwidth == 0:
        return np.zeros_like(x)[()]
    return np.sqrt(np.maximum(0.0, 1.0 - (x / halfwidth) ** 2))


def semi_ellipse_mean(
    x0: float | np.ndarray, x1: float | np.ndarray, halfwidth: float
) -> float | np.ndarray:
    """Average `semi_ellipse` exactly over the intervals from `x0` to `x1`."""
    x0, x1 = interval(x0, x1)
    if halfwidth == 0:
        return np.zeros_like(x0)[()]

    def primitive(x: float | np.ndarray) -> float | np.ndarray:
        t = np.clip(x / halfwidth, -1.0, 1.0)
        return 0.5 * halfwidth * (t * np.sqrt(1.0 - t * t) + np.arcsin(t))

    return (primitive(x1) - primitive(x0)) / (x1 - x0)


def semi_ellipsoid_gap(r: float | np.ndarray, radius: float) -> float | np.ndarray:
    """Gap around a contact with the pressure sqrt(radius^2 - r^2) of bodies with E* = 1/2."""
    distance = np.abs(points("r", r))
    outside = np.maximum(distance, radius)
    sag = (outside**2 - 2.0 * radius**2) * np.arccos(radius / outside)
    gap = sag + radius * np.sqrt(outside**2 - radius**2)
    return np.where(distance > radius, np.maximum(gap, 0.0), 0.0)[()]
