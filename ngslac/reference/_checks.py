"""Input checks shared by the reference solutions: say what is wrong, and what to do."""

from math import inf, isfinite, isnan

import numpy as np

__all__ = ["finite", "interval", "nonnegative", "points", "poisson", "positive"]


def _require(ok, name, value, remedy):
    if not ok:
        raise ValueError(f"{name} = {value!r} is not valid: {remedy}")


def finite(name, value):
    """Accept any finite number."""
    _require(isfinite(value), name, value, "give a finite number")


def positive(name, value, *, infinite=False):
    """Accept numbers above zero, and `inf` only where `infinite` is set."""
    kind = "a number > 0, or inf" if infinite else "a finite number > 0"
    ok = value > 0 and (infinite or value < inf)
    _require(ok and not isnan(value), name, value, f"give {kind}")


def nonnegative(name, value):
    """Accept finite numbers from zero on."""
    _require(0 <= value < inf, name, value, "give a finite number >= 0")


def poisson(name, value):
    """Accept Poisson ratios of a compressible, stable solid."""
    remedy = "give a ratio in the open interval (-1, 0.5), say 0.499 if nearly incompressible"
    _require(-1 < value < 0.5, name, value, remedy)


def points(name, values):
    """Return `values` as a float array without NaN or infinite entries."""
    array = np.asarray(values, dtype=float)
    _require(np.isfinite(array).all(), name, values, "give finite coordinates")
    return array


def interval(x0, x1):
    """Return the two ends as float arrays of one shape, refusing empty intervals."""
    start, end = np.broadcast_arrays(points("x0", x0), points("x1", x1))
    _require((start != end).all(), "x1", x1, "give intervals of nonzero length, x1 != x0")
    return start, end
