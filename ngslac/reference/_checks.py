# SPDX-License-Identifier: LGPL-2.1-or-later
"""Input checks shared by the reference solutions: say what is wrong, and what to do."""

from collections.abc import Sequence
from math import inf, isfinite, isnan
from numbers import Real
from typing import Any

import numpy as np

__all__ = [
    "choice",
    "finite",
    "instance",
    "interval",
    "nonnegative",
    "points",
    "poisson",
    "positive",
]


def _require(
    ok: bool, name: str, value: Any, remedy: str, kind: type[Exception] = ValueError
) -> None:
    if not ok:
        text = " ".join(repr(value).split())
        text = text if len(text) <= 80 else text[:77] + "..."
        raise kind(f"{name} = {text} is not valid: {remedy}")


def _number(name: str, value: Any, remedy: str) -> float:
    """The number as float: texts, truth values, and what else compares with numbers, are none."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    real = isinstance(value, Real) and not isinstance(value, (bool, np.bool_))
    _require(real, name, value, remedy, TypeError)
    try:
        return float(value)
    except OverflowError as error:
        raise ValueError(f"{name} is too large for a float: {remedy}") from error


def finite(name: str, value: Any) -> None:
    """Accept any finite number."""
    remedy = "give a finite number"
    _require(isfinite(_number(name, value, remedy)), name, value, remedy)


def positive(name: str, value: Any, *, infinite: bool = False) -> None:
    """Accept numbers above zero, and `inf` only where `infinite` is set."""
    remedy = "give a number > 0, or inf" if infinite else "give a finite number > 0"
    number = _number(name, value, remedy)
    ok = number > 0 and (infinite or number < inf)
    _require(ok and not isnan(number), name, value, remedy)


def nonnegative(name: str, value: Any) -> None:
    """Accept finite numbers from zero on."""
    remedy = "give a finite number >= 0"
    _require(0 <= _number(name, value, remedy) < inf, name, value, remedy)


def poisson(name: str, value: Any) -> None:
    """Accept Poisson ratios of a compressible, stable solid."""
    remedy = "give a ratio in the open interval (-1, 0.5), say 0.499 if nearly incompressible"
    _require(-1 < _number(name, value, remedy) < 0.5, name, value, remedy)


def choice(name: str, value: Any, options: Sequence, remedy: str) -> None:
    """Accept one of a few numbers or words."""
    plain = isinstance(value, (str, Real, np.ndarray)) and type(value) is not bool
    ok = plain and np.ndim(value) == 0 and any(value == o for o in options)
    _require(ok, name, value, remedy)


def instance(name: str, value: Any, kind: type) -> None:
    """Accept an object of a class."""
    _require(isinstance(value, kind), name, value, f"give a {kind.__name__}", TypeError)


def points(name: str, values: Any) -> np.ndarray:
    """Return `values` as a float array without NaN or infinite entries."""
    remedy = "give finite coordinates"
    try:
        array = np.asarray(values)
        numbers = array.dtype.kind in "fiuO" and array.astype(float)
    except (TypeError, ValueError, OverflowError):  # what cannot be an array of numbers
        numbers = False
    _require(numbers is not False, name, values, remedy, TypeError)
    _require(np.isfinite(numbers).all(), name, values, remedy)
    return numbers


def interval(x0: Any, x1: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the two ends as float arrays of one shape, refusing empty intervals."""
    start, end = points("x0", x0), points("x1", x1)
    try:
        start, end = np.broadcast_arrays(start, end)
    except ValueError:
        _require(False, "x1", x1, f"give ends of one shape, x0 has {start.shape}")
    _require((start != end).all(), "x1", x1, "give intervals of nonzero length, x1 != x0")
    return start, end
