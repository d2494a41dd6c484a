# SPDX-License-Identifier: LGPL-2.1-or-later
"""Arrays of which each process has its own rows, with the verbs of NumPy."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ngslac.parallel.together import Together

__all__ = ["MaxAt", "Pick", "Spread", "SumAt"]

REDUCED = {
    np.add: "SUM",
    np.maximum: "MAX",
    np.minimum: "MIN",
    np.logical_or: "LOR",
    np.logical_and: "LAND",
}
LEAST = {np.add: 0, np.maximum: -np.inf, np.minimum: np.inf, np.logical_or: 0, np.logical_and: 1}


class Spread(np.ndarray):
    """An array with a row for each dof that this process knows.

    Sums, norms, products and whatever else NumPy does along the rows are taken over all processes,
    so that each of them has to ask for them. A row that several processes know is the same there.

    Attributes
    ----------
    owned : (n,) bool
        The rows that count for this process, of those that others know, too.
    together : Together
        The processes.
    """

    owned = together = None

    @classmethod
    def Of(cls, values: np.ndarray, owned: np.ndarray, together: Together) -> Spread:
        """Make these values an array of all processes, which shares their memory."""
        found = np.asarray(values).view(cls)
        found.owned, found.together = owned, together
        return found

    def __array_finalize__(self, other: Any) -> None:
        """Views of an array with all of its rows are arrays of all processes, too."""
        if (
            isinstance(other, Spread)
            and other.owned is not None
            and self.shape[:1] == other.owned.shape
        ):
            self.owned, self.together = other.owned, other.together

    def Like(self, values: np.ndarray, owned: np.ndarray | None = None) -> Spread:
        """Make an array of other values with the same rows."""
        return Spread.Of(values, self.owned if owned is None else owned, self.together)

    @property
    def own(self) -> np.ndarray:
        """An ordinary array of the rows that count for this process."""
        return np.asarray(self)[self.owned]

    # --- rows ----------------------------------------------------------------------------------

    def __getitem__(self, key: Any) -> Any:
        found = np.asarray(self)[Plain(key)]
        rows = key[0] if isinstance(key, tuple) else key
        if not isinstance(found, np.ndarray) or self.owned is None or not KeepsRows(rows):
            return found
        return self.Like(found, self.owned[Plain(rows)])

    def __setitem__(self, key: Any, values: Any) -> None:
        np.asarray(self)[Plain(key)] = Plain(values)

    def reshape(self, *shape, **options) -> Spread:
        """Join or split rows; what comes of a row belongs to the process that had it."""
        found = np.asarray(self).reshape(*shape, **options)
        count = len(self.owned)
        if len(found) == count:
            return self.Like(found)
        if len(found) and count % len(found) == 0:
            return self.Like(found, self.owned[:: count // len(found)])
        return self.Like(found, np.repeat(self.owned, len(found) // max(count, 1)))

    def ravel(self, **options) -> Spread:
        """Return the entries row by row."""
        return self.reshape(-1, **options)

    def repeat(self, repeats: int, axis: int | None = None) -> Spread:
        """Repeat each row."""
        return self.Like(np.asarray(self).repeat(repeats, axis), self.owned.repeat(repeats))

    @property
    def T(self) -> Turned | Spread:
        """The transpose, whose products are sums over the rows of all processes."""
        return Turned(self) if self.ndim == 2 else self

    # --- functions -----------------------------------------------------------------------------

    def __array_ufunc__(
        self, ufunc: np.ufunc, method: str, *inputs, out: tuple | None = None, **options
    ) -> Any:
        """Apply an operator of NumPy, or a function of numbers."""
        if ufunc is np.matmul:
            return Product(*inputs)
        rows = next(part for part in (*inputs, *(out or ())) if isinstance(part, Spread))
        plain, options = [Plain(part) for part in inputs], Plain(options)
        if out is not None:
            options["out"] = tuple(map(Plain, out))
        if method == "reduce":
            return Reduced(ufunc, inputs[0], options)
        found = getattr(ufunc, method)(*plain, **options)
        if out is not None:
            return out[0]
        if isinstance(found, tuple):
            return tuple(rows.Like(part) for part in found)
        return rows.Like(found) if np.ndim(found) and len(found) == len(rows.owned) else found

    def __array_function__(
        self, function: Callable, types: Iterable[type], args: Sequence, options: dict[str, Any]
    ) -> Any:
        """Apply another function of NumPy, or refuse it."""
        if function in FUNCTIONS:
            return FUNCTIONS[function](*args, **options)
        if function in LOCAL:
            return function(*Plain(args), **Plain(options))
        if function in BY_METHODS:
            return super().__array_function__(function, types, args, options)
        raise TypeError(f"numpy.{function.__name__} is not known of arrays of many processes")

    def mean(self, axis: int | None = None, **_) -> Any:
        """Return the mean of all rows, or of the entries of each."""
        if axis not in (None, 0):
            return self.Like(np.asarray(self).mean(axis))
        return self.sum(axis) / (Count(self) * (np.prod(self.shape[1:]) if axis is None else 1))

    def tolist(self) -> list:
        """Return a list of the rows of this process."""
        return np.asarray(self).tolist()


class Turned:
    """A Spread array with rows and columns exchanged: its products are sums over the rows."""

    __array_ufunc__ = None

    def __init__(self, values: Spread):
        self.T = values

    def __matmul__(self, other: np.ndarray) -> np.ndarray:
        return self.T.together.Sum(self.T.own.T @ OwnOf(other, self.T))


def Plain(thing: Any) -> Any:
    """Replace arrays of all processes by ordinary arrays."""
    if isinstance(thing, Spread):
        return thing.view(np.ndarray)
    if isinstance(thing, (tuple, list)):
        return type(thing)(map(Plain, thing))
    if isinstance(thing, dict):
        return {name: Plain(part) for name, part in thing.items()}
    return thing


def KeepsRows(key: Any) -> bool:
    """Whether an index chooses rows."""
    return isinstance(key, (slice, np.ndarray, list)) or key is Ellipsis


def OwnOf(values: np.ndarray, rows: Spread) -> np.ndarray:
    """The rows of an array that count for this process in another array."""
    return np.asarray(values)[rows.owned]


def Reduced(ufunc: np.ufunc, values: Spread, options: dict[str, Any]) -> Any:
    """Reduce all rows, or the entries of each row, by a function of NumPy."""
    axis = options.pop("axis", 0)
    if axis not in (None, 0) and not (isinstance(axis, tuple) and 0 in axis):
        found = ufunc.reduce(Plain(values), axis=axis, **options)
        return values.Like(found)
    options.pop("out", None)
    own = values.own
    if ufunc in (np.maximum, np.minimum):
        start = options.pop("initial", None)
        least = LEAST[ufunc] if own.dtype.kind == "f" else IntegerEnd(ufunc, own.dtype)
        found = ufunc.reduce(own, axis=axis, initial=least, **options)
        found = values.together.Reduce(found, REDUCED[ufunc])
        if start is not None:
            found = ufunc(found, start)
        return found
    found = ufunc.reduce(own, axis=axis, **options)
    return values.together.Reduce(found, REDUCED[ufunc])


def IntegerEnd(ufunc: np.ufunc, dtype: np.dtype) -> int:
    """The number that a maximum or a minimum of whole numbers begins with."""
    if dtype.kind == "b":
        return ufunc is np.minimum
    ends = np.iinfo(dtype)
    return ends.min if ufunc is np.maximum else ends.max


def Product(one: Any, other: Any) -> Any:
    """Multiply matrices and vectors, one of which at least has the rows of all processes."""
    if isinstance(one, Spread) and one.ndim == 1:
        return one.together.Sum(one.own @ OwnOf(other, one))
    if isinstance(one, Spread):
        return one.Like(np.asarray(one) @ Plain(other))
    raise TypeError("a product with an array of all processes is not known: turn the first one")


# --- functions of numpy --------------------------------------------------------------------------


def NormOf(
    x: Spread, ord: int | str | None = None, axis: int | None = None, keepdims: bool = False
) -> Any:
    """The norm of vectors; Frobenius' one of matrices."""
    if axis not in (None, 0):
        return x.Like(np.linalg.norm(np.asarray(x), ord, axis, keepdims))
    if ord == 2 and x.ndim == 2:
        return np.linalg.norm(x.T @ x, 2) ** 0.5
    return np.sqrt(np.sum(np.square(x), axis=axis))


def Triangle(a: Spread, mode: str = "reduced") -> Any:
    """The triangle of a QR decomposition; with the first factor where that is asked for."""
    local = np.linalg.qr(a.own, mode="r")
    r = np.linalg.qr(np.concatenate(a.together.Gather(local)), mode="r")
    if mode == "r":
        return r
    return a.Like(np.linalg.solve(r.T, np.asarray(a).T).T), r


def LeastSquares(a: Spread, b: np.ndarray, rcond: float | None = None) -> tuple:
    """Solve a least squares problem; of NumPy's four results only the solution is given."""
    many = b.ndim > 1
    both = a.Like(np.column_stack([np.asarray(a), np.asarray(b)]))
    r, n = Triangle(both, "r"), a.shape[1]
    found = np.linalg.lstsq(r[:n, :n], r[:n, n:], rcond=rcond)[0]
    return (found if many else found[:, 0]), None, None, None


def Count(values: Spread) -> int:
    """The number of rows of all processes."""
    return values.together.Sum(np.count_nonzero(values.owned))


def Median(values: Spread, **_) -> float:
    """Find the median of all rows by bisection, as no process knows all of them."""
    low, high, half = np.min(values), np.max(values), Count(values) / 2
    while low < (middle := (low + high) / 2) < high:
        low, high = (low, middle) if np.count_nonzero(values <= middle) >= half else (middle, high)
    return high


def ArrayEqual(one: Any, other: Any, **_) -> bool:
    """Whether two arrays are the same on all processes."""
    known = next(part for part in (one, other) if isinstance(part, Spread))
    same = np.shape(one) == np.shape(other) and np.array_equal(Plain(one), Plain(other))
    return bool(known.together.Reduce(same, "LAND"))


def Stack(arrays: Iterable[np.ndarray], axis: int = 0) -> Spread:
    """Put columns side by side."""
    arrays = list(arrays)
    known = next(part for part in arrays if isinstance(part, Spread))
    found = np.stack(Plain(arrays), axis=axis)
    if not axis:
        raise TypeError("arrays of all processes are stacked as columns: take axis=1")
    return known.Like(found)


def Concatenate(arrays: Iterable[np.ndarray], axis: int = 0) -> Spread:
    """Put arrays one after the other along the rows, or side by side."""
    arrays = list(arrays)
    known = next(part for part in arrays if isinstance(part, Spread))
    found = np.concatenate(Plain(arrays), axis=axis)
    if axis in (1, -1) and found.ndim > 1:
        return known.Like(found)
    owned = [
        part.owned if isinstance(part, Spread) else np.full(len(part), known.together.rank == 0)
        for part in arrays
    ]
    return known.Like(found, np.concatenate(owned))


def Where(condition: np.ndarray, *values) -> Any:
    """Choose row by row; without values, find the places of this process."""
    parts = (condition, *values)
    known = next(part for part in parts if isinstance(part, Spread))
    found = np.where(*Plain(parts))
    return known.Like(found) if values else found


def CountNonzero(values: Spread, axis: int | None = None) -> Any:
    """Count nonzero entries of all rows, or of each row."""
    if axis not in (None, 0):
        return values.Like(np.count_nonzero(Plain(values), axis=axis))
    return values.together.Sum(np.count_nonzero(values.own, axis=axis))


def ByRow(function: Callable) -> Callable:
    """Wrap a function of NumPy that gives a row for each row."""

    @wraps(function)
    def Of(values: np.ndarray, *args, **options) -> np.ndarray:
        found = function(Plain(values), *Plain(args), **Plain(options))
        return values.Like(found) if isinstance(values, Spread) else found

    return Of


def Ptp(values: Spread, axis: int | None = None) -> Any:
    """The difference of the largest and the smallest entry."""
    return np.max(values, axis=axis) - np.min(values, axis=axis)


FUNCTIONS = {
    np.linalg.norm: NormOf,
    np.linalg.qr: Triangle,
    np.linalg.lstsq: LeastSquares,
    np.median: Median,
    np.array_equal: ArrayEqual,
    np.stack: Stack,
    np.concatenate: Concatenate,
    np.where: Where,
    np.count_nonzero: CountNonzero,
    np.ptp: Ptp,
    np.nan_to_num: ByRow(np.nan_to_num),
    np.zeros_like: ByRow(np.zeros_like),
    np.full_like: ByRow(np.full_like),
    np.ones_like: ByRow(np.ones_like),
    np.clip: ByRow(np.clip),
    np.copy: ByRow(np.copy),
}
# These concern this process alone: places and shapes.
LOCAL = {np.flatnonzero, np.nonzero, np.shape, np.ndim, np.size, np.array_repr, np.array_str}
LOCAL |= {np.isin, np.column_stack, np.array2string}
BY_METHODS = {np.sum, np.any, np.all, np.max, np.min, np.amax, np.amin, np.mean, np.repeat}
BY_METHODS |= {np.reshape, np.ravel}


# --- sums of groups of rows ----------------------------------------------------------------------


def SumAt(numbers: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """Sums (count,) of values by the numbers (n,) of their groups."""
    if isinstance(values, Spread):
        sums = np.bincount(OwnOf(numbers, values), values.own, count).astype(float)
        return values.together.Sum(sums)
    return np.bincount(numbers, values, count)


def MaxAt(numbers: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """The largest ones, at least 0, (count, ...) of values by the numbers (n,) of their groups."""
    most = np.zeros((count, *values.shape[1:]))
    if isinstance(values, Spread):
        np.maximum.at(most, OwnOf(numbers, values), values.own)
        return values.together.Reduce(most, "MAX")
    np.maximum.at(most, numbers, values)
    return most


def Pick(values: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """A copy of some rows of this process, as ordinary array."""
    return np.array(np.asarray(values)[rows])
