# SPDX-License-Identifier: LGPL-2.1-or-later
"""How much of a Newton step to take."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ngslac.solve.nearness import Nearness
    from ngslac.solve.residual import Measurement

__all__ = ["Globalization"]

# Iterations of late, and how far the residual falls in them where it is worth to go on.
LATE, FELL = 10, 0.5
# Iterations after which a residual that falls by less in three of them hardly falls.
CRAWLED, CRAWL = 5, 0.8
# Part of the macro-elements that changes in so many iterations in a row where the status jumps.
MANY, LEAPS = 0.25, 3


class Globalization:
    """Full steps where they do, shorter ones where there is no residual or the status cycles.

    Friction has no energy, so steps are judged by the size of the scaled residual. It need not fall
    in every step: a change of status often raises that of the contact conditions on the way to the
    solution, and a line search on it costs iterations. At first only the equilibrium counts, which
    a nonlinear bulk may lose. When a status returns or nothing gets better, all of the residual
    does. The search then goes down to a thousandth of the step: where all that holds a body slips,
    a Newton step moves it far, and only a small part of it makes something stick.
    """

    SHORT = 3  # halvings of a line search that has found a smaller residual
    LONG = 10  # and of one that has not
    TINY = 1 / 64

    def __init__(self, halvings: int = 12, patience: int = 6):
        self.halvings, self.patience = halvings, patience
        self.Begin()

    def Begin(self) -> None:
        """Forget the solve before."""
        self._seen, self._merits, self._tiny, self._leaps = {}, [], 0, 0
        self.cycles = self.damped = False  # a contact status came back; a line search is made
        self.unproven = None  # the Nearness of a step that only the next correction judges
        self.returns = 0  # how many of these led away

    @property
    def stagnates(self) -> bool:
        """Are the steps so short that nothing comes of it?"""
        return self._tiny >= self.patience

    @property
    def crawls(self) -> bool:
        """Does the residual hardly fall, as where a thin body opens one macro-element at a time?"""
        merits = self._merits
        return len(merits) > CRAWLED and min(merits[-3:]) > CRAWL * min(merits[:-3])

    @property
    def leaps(self) -> bool:
        """Has the status of late been nearly another one each time?"""
        return self._leaps >= LEAPS

    @property
    def falls(self) -> bool:
        """Has the residual of late become as small as never before?"""
        merits = self._merits
        return len(merits) > LATE and min(merits[-LATE:]) < FELL * min(merits[:-LATE])

    def Knows(self, state: Measurement) -> bool:
        """Has an iterate of this solve had that contact status?"""
        return state.status.tobytes() in self._seen

    def Watch(
        self, state: Measurement, changed: int, *, patient: bool = False, moving: bool = False
    ) -> None:
        """Look at a new iterate: does the status return, or nothing get better?

        Where only contact is nonlinear the residual tells nothing about how near the status is: of
        thin bodies it is large up to the last macro-element. `patient`: it need not fall.
        `moving`: Dirichlet values still have to be carried, of which the residual does not know.
        """
        number = len(self._merits)
        first = self._seen.setdefault(state.status.tobytes(), number)
        self._leaps = self._leaps + 1 if changed > MANY * len(state.status) else 0
        returned = changed > 0 and number - first > 1
        returned = returned and state.merit > 0.1 * min(self._merits)
        self._merits.append(np.inf if moving else state.merit)
        patient = patient or self.unproven is not None
        stuck = not patient and number > 5 and min(self._merits[-4:]) > 0.5 * min(self._merits[:-4])
        self.cycles, self.damped = self.cycles or returned, self.damped or returned or stuck

    def TakeBack(self) -> Measurement:
        """Go back to where the last step began: it led away."""
        self._merits.pop()
        self.returns += 1
        return self.unproven.Return()

    def Search(
        self,
        move: Callable[[float], Measurement],
        moving: bool = False,
        nearness: Nearness | None = None,
    ) -> tuple[Measurement, float]:
        """The part of a step, by ``move(part)``: its Measurement, not finite if none is, and it.

        `moving`: the step carries Dirichlet values, of which the residual before does not know.
        `nearness` knows more of the step than the residual.
        """
        best, damping, taken, whole, self.unproven = None, 1.0, 0.0, True, None
        for halving in range(self.halvings + 1):
            trial, taken = move(damping), damping
            whole = whole and trial.finite
            if best is None or trial.merit < best[0].merit:
                best = trial, damping
            if best[0].finite and (moving or halving >= self._Halvings(*best)):
                break
            judged = nearness and trial.finite and halving <= self.SHORT
            if judged and self._Leads(nearness, trial, damping, whole):
                best = trial, damping
                break
            damping /= 2
        if taken != best[1] and best[0].finite:
            best = move(best[1]), best[1]
        self._tiny = self._tiny + 1 if best[1] <= self.TINY else 0
        return best

    def _Leads(self, nearness: Nearness, trial: Measurement, damping: float, whole: bool) -> bool:
        """Does a part of a step lead nearer to the solution, or may it?

        `whole`: longer parts have a residual, too.
        """
        if nearness.Nears(damping):
            return True
        if whole and not self.damped and nearness.May(trial):
            self.unproven = nearness
        return self.unproven is not None

    def SearchStart(self, move: Callable[[float], Measurement]) -> tuple[Measurement, float] | None:
        """The first step of a body that a few macro-elements hold: as Search, None if none fits.

        The full step pushes the body far through the master: it closes nearly everything, and it
        takes an iteration for each ring of macro-elements to open again. The longest part, down to
        an eighth, that leaves half of them open is a better start.
        """
        for damping in 0.5 ** np.arange(4):
            trial = move(damping)
            if trial.finite and np.mean(trial.status > 0) <= 0.5:
                return trial, damping
        return None

    def _Last(self) -> float:
        return self._merits[-1] if self._merits else np.inf

    def _Halvings(self, state: Measurement, damping: float) -> int:
        """How many halvings have to be looked at if this state is the best so far."""
        if not self.damped:
            if damping == 1:
                return 0 if state.unbalance <= self._Last() else self.SHORT
            # Beside a state without residual a shorter step is better still.
            return max(self.SHORT, round(np.log2(1 / damping)) + 1)
        if state.merit >= self._merits[-1]:
            return self.LONG
        return 0 if damping == 1 else self.SHORT
