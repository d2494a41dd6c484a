"""What the validation report is made of: cases, and rows that compare a number with a reference."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from report_bounds import Bound

__all__ = ["Case", "Outcome", "Row", "Worst"]


@dataclass(frozen=True)
class Row:
    """A computed number against its reference.

    Parameters
    ----------
    quantity : str
        What it is.
    ours, reference : float
    bound : Bound, optional
        Accepted difference and its origin; without one the number is shown, and not judged.
    unit : str
        Of both numbers.
    """

    quantity: str
    ours: float
    reference: float
    bound: Bound | None = None
    unit: str = ""

    def __post_init__(self):
        if not isinstance(self.bound, Bound | None):
            raise TypeError(f"bound = {self.bound} of {self.quantity!r} must say where it is from")

    @property
    def kind(self):
        if self.bound:
            return self.bound.kind
        return "relative" if self.reference else "absolute"

    @property
    def difference(self):
        if self.kind == "relative":
            return self.ours / self.reference - 1
        return self.ours - self.reference

    @property
    def judged(self):
        return self.bound is not None

    @property
    def share(self):
        """The difference over what is accepted; infinite for NaN; 0 without a bound."""
        if not math.isfinite(self.difference):
            return math.inf
        if not self.judged:
            return 0.0
        size = max(0.0, -self.difference if self.kind == "least" else abs(self.difference))
        if size and not self.bound.size:
            return math.inf
        return size / self.bound.size if size else 0.0

    @property
    def holds(self):
        return self.share <= 1

    def _Text(self, value, sign=""):
        if self.kind == "relative":
            return f"{100 * value:{sign}.2g} %"
        return f"{value:{sign}.2g}"

    def _Accepted(self):
        if not self.judged:
            return ["-", "not judged"]
        sign = {"relative": "±", "absolute": "±", "least": "at least −"}[self.kind]
        size = self.bound.size
        return [sign + (self._Text(size) if size else "0"), self.bound.text]

    def Cells(self):
        """The row as texts: quantity, ours, reference, difference, accepted, origin."""
        name = f"{self.quantity} [{self.unit}]" if self.unit else self.quantity
        numbers = (Number(self.ours), Number(self.reference))
        mark = "" if self.holds else " **too large**"
        return [name, *numbers, self._Text(self.difference, "+") + mark, *self._Accepted()]


def Number(value):
    """Five digits; two where it is so small that it must be rounding."""
    if value == 0:
        return "0"
    return f"{value:.2g}" if abs(value) < 1e-8 else f"{value:.5g}"


def Worst(rows):
    """The row nearest to its bound, or farthest beyond; judged ones first."""
    return max(rows, key=lambda row: (row.share, row.judged))


@dataclass(frozen=True)
class Outcome:
    """What a case's function returns.

    Parameters
    ----------
    rows : list of Row
    picture : callable
        ``picture(file)`` draws into a PNG file.
    caption : str
        What it shows.
    """

    rows: list
    picture: Callable
    caption: str


@dataclass(frozen=True)
class Case:
    """A reference case.

    Parameters
    ----------
    name : str
        Short, also of the picture's file and for the option ``--cases``.
    title : str
    text : str
        What is computed, in a few sentences, as markdown.
    source : str
        Where the reference comes from.
    command : str
        That computes it, too, in the root of the repository.
    function : callable
        ``function(quick)`` returns an `Outcome`. With `quick` for small sizes, whose judged rows
        must hold, too: ``test_cases.py`` asserts it.
    """

    name: str
    title: str
    text: str
    source: str
    command: str
    function: Callable = field(repr=False)
