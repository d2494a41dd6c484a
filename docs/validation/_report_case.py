"""What the validation report is made of: cases, and rows that compare a number with a reference."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

__all__ = ["Case", "Outcome", "Row", "Worst"]

KINDS = ("relative", "absolute", "least")


@dataclass(frozen=True)
class Row:
    """A computed number against its reference.

    Parameters
    ----------
    quantity : str
        What it is.
    ours, reference : float
    tolerance : float
        Largest accepted difference; 0: none.
    kind : {"relative", "absolute", "least"}
        How they are compared: ours over the reference less 1; their difference; the same, where
        ours may be larger by any amount, as a rate of convergence may.
    unit : str
        Of both numbers.
    """

    quantity: str
    ours: float
    reference: float
    tolerance: float
    kind: str = "relative"
    unit: str = ""

    def __post_init__(self):
        if self.kind not in KINDS:
            raise ValueError(f"kind must be one of {', '.join(KINDS)}, not {self.kind!r}")
        if not self.tolerance >= 0:
            raise ValueError(
                f"tolerance = {self.tolerance} of {self.quantity!r} must be at least 0"
            )

    @property
    def difference(self):
        if self.kind == "relative":
            return self.ours / self.reference - 1
        return self.ours - self.reference

    @property
    def share(self):
        """The difference over what is accepted; infinite for NaN."""
        size = max(0.0, -self.difference if self.kind == "least" else abs(self.difference))
        if not math.isfinite(self.difference) or (size and not self.tolerance):
            return math.inf
        return size / self.tolerance if size else 0.0

    @property
    def holds(self):
        return self.share <= 1

    def _Text(self, value, sign=""):
        if self.kind == "relative":
            return f"{100 * value:{sign}.2g} %"
        return f"{value:{sign}.2g}"

    def Cells(self):
        """The row as texts: quantity, ours, reference, difference, accepted."""
        name = f"{self.quantity} [{self.unit}]" if self.unit else self.quantity
        numbers = (Number(self.ours), Number(self.reference))
        accepted = self._Text(self.tolerance)
        if not self.tolerance:
            accepted = "0"
        sign = {"relative": "±", "absolute": "±", "least": "at least −"}[self.kind]
        mark = "" if self.holds else " **too large**"
        return [name, *numbers, self._Text(self.difference, "+") + mark, sign + accepted]


def Number(value):
    """Five digits; two where it is so small that it must be rounding."""
    if value == 0:
        return "0"
    return f"{value:.2g}" if abs(value) < 1e-8 else f"{value:.5g}"


def Worst(rows):
    """The row nearest to its tolerance, or farthest beyond."""
    return max(rows, key=lambda row: row.share)


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
        ``function(quick)`` returns an `Outcome`; with `quick` for small sizes.
    """

    name: str
    title: str
    text: str
    source: str
    command: str
    function: Callable = field(repr=False)
