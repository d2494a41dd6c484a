# SPDX-License-Identifier: LGPL-2.1-or-later
"""The convergence table of a solve, as it grows."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ngslac.parallel.layout import LayoutOf
from ngslac.progress import Progress, Say, ShowLive
from ngslac.solve.callback import TellIterate

if TYPE_CHECKING:
    from ngsolve import GridFunction

    from ngslac.solve.residual import Measurement

__all__ = ["STILL", "Iteration", "Log", "MostlySlips", "Unchanged"]

# Part of the closed macro-elements that slips on the way to a state that friction does not hold.
SLIPPED = 0.8
# Iterations without a change of status after which it is settled.
STILL = 4


@dataclass(frozen=True)
class Iteration:
    """One line of the convergence table.

    Attributes
    ----------
    number : int
    equilibrium, constraint : float
        Norms of the scaled residuals of both kinds of rows, relative to the forces at work.
    open, stick, slip : int
        Macro-elements of each status.
    changed : int
        Macro-elements whose status differs from the iteration before.
    damping : float
        Share of the Newton step that was taken to get here.
    """

    number: int
    equilibrium: float
    constraint: float
    open: int
    stick: int
    slip: int
    changed: int
    damping: float

    @classmethod
    def Of(cls, number: int, state: Measurement, before: np.ndarray, damping: float) -> Iteration:
        """The line for a Measurement.

        Parameters
        ----------
        number : int
        state : Measurement
            What was measured of the iterate.
        before : (n,) array
            Statuses of the iterate before.
        damping : float

        Returns
        -------
        Iteration
        """
        counts = (int(np.sum(state.status == s)) for s in range(3))
        changed = int(np.sum(before != state.status))
        return cls(number, state.equilibrium, state.constraint, *counts, changed, damping)

    def __str__(self) -> str:
        damping = "" if self.damping == 1 else f"  damped {self.damping:g}"
        return (
            f"  {self.number:3d}  equilibrium {self.equilibrium:8.2e}  "
            f"constraint {self.constraint:8.2e}  open {self.open}  stick {self.stick}  "
            f"slip {self.slip}  changed {self.changed}{damping}"
        )


def MostlySlips(history: Sequence[Iteration]) -> bool:
    """Does nearly all that is closed slip, all along the way after the start?"""
    slipped = sum(entry.slip for entry in history[1:])
    return slipped > SLIPPED * (slipped + sum(entry.stick for entry in history[1:]))


def Unchanged(history: Sequence[Iteration]) -> bool:
    """Has the status of late been the same?"""
    return not any(entry.changed for entry in history[-STILL:])


class Log:
    """Notes each iterate, and shows it to whom it concerns."""

    def __init__(
        self,
        gf: GridFunction,
        tol: float,
        printing: bool,
        callback: Callable[[Iteration], object] | None,
        progress: Progress,
    ):
        self.gf, self.tol, self.printing, self.callback = gf, tol, printing, callback
        self.history, self.progress, self._status = [], progress, None

    def Say(self, line: Iteration | str) -> None:
        """Print a line between those of the table."""
        if self.printing:
            Say(line)

    def Add(self, state: Measurement, damping: float = 1.0) -> None:
        """The line of a Measurement, which a part of a step led to."""
        number = len(self.history)
        entry = Iteration.Of(number, state, self._status if number else state.status, damping)
        self._status = state.status
        self.history.append(entry)
        LayoutOf(self.gf.space).together.CheckInterrupts()
        logging.getLogger("ngslac").debug("%s", entry)
        sizes = [max(e.equilibrium, e.constraint) for e in (self.history[0], entry)]
        if min(sizes) > self.tol:
            self.progress.At(np.log(sizes[1] / sizes[0]) / np.log(self.tol / sizes[0]))
        self.Say(entry)
        if not self.printing:
            ShowLive(str(entry))
        if self.callback:
            TellIterate(self.callback, entry, self.gf)
