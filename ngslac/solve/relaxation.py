# SPDX-License-Identifier: LGPL-2.1-or-later
"""Loose bodies come to rest as if they moved in something viscous, less and less."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ngslac.solve.statussearch import FAILURES

if TYPE_CHECKING:
    from ngslac.solve.iteration import Iteration
    from ngslac.solve.newton import Newton

__all__ = ["Relaxation"]

# Diagonal that holds bodies where they were, relative to that of the scaled bulk: the largest first
# one, the last one, and by what factor it falls after a stage that ends, and grows after one that
# fails.
FIRST, LAST, SOFTER, HARDER = 1.0, 1e-9, 0.2, 5.0
# The least of these factors, where bodies hardly move.
SOFTEST = 1e-3
# Newton steps of a stage, and how many stages in a row may fail.
STEPS, MOST_FAILURES = 10, 4
# The residual at the end of a stage; where bodies turn, or roll on each other, that has to be less.
ENDS, TURNED = 3e-2, 1e-3
# Stages after one that failed until the drag falls again.
WAIT = 3
# Ways of a stage, relative to the smallest macro-element: Newton's method may end it, for so many
# steps, and the drag stays as it is.
REST, FAR, POLISH = 1e-2, 0.05, 8
# The same where Newton's method needs a few steps only, and how many these are.
EASILY_FAR, EASY = 0.5, 2
# Way on which something flies about, relative to the smallest macro-element: no stage goes so far.
FLIES = 0.5
# Forces without balance, relative to those at work, from which Newton's method may end it, and how
# much smaller they have to be where it did not before.
BALANCED, LESS = 0.1, 0.3
# A way, relative to the mesh, on which bodies do not come to rest.
LOST = 1.0
# Bodies that slide with a force against them that changes by less than this part from one stage to
# the next, in so many of them, go on for ever, if they move so far meanwhile, relative to the
# smallest macro-element.
SAME_FORCE, STEADY, SLID = 5e-3, 5, 0.25


@dataclass
class Drag:
    """Forces against the way from a place.

    Attributes
    ----------
    size : float
        Relative to the scaled diagonal of the bulk.
    place : (n,) array
        Of all dofs.
    rows : (n,) bool
        Those of displacements that are not condensed.
    """

    size: float
    place: np.ndarray
    rows: np.ndarray

    def Forces(self, values: np.ndarray, scale: np.ndarray) -> np.ndarray:
        """At other values (n,), with the factors (n,) of the rows."""
        return np.where(self.rows, self.size * (values - self.place) / scale**2, 0.0)

    def Shift(self) -> np.ndarray:
        """What the scaled diagonal of the matrix gets."""
        return self.size * self.rows


class Relaxation:
    """A solve in stages, in each of which bodies move as far as a drag lets them.

    Where friction holds bodies, or large sliding turns them, neither the contact status nor a path
    of barriers leads to where they come to rest: from far away, forces roll and push them past each
    other. With drag each stage has a solution near its start.

    `maxit` is the number of linear solves up to which the table of Newton's method may grow.
    """

    def __init__(self, newton: Newton, maxit: int):
        self.newton, self.system, self.maxit = newton, newton.system, maxit

    def Run(self) -> Iteration:
        """The last line of the table, or an error if bodies do not come to rest."""
        newton, system = self.newton, self.system
        newton.log.Say("  relaxation of loose bodies")
        newton.onpath, failures, wait, self._stages = True, 0, 0, []
        start = system.values.copy()
        smallest = np.min(system.Sizes())
        self._flies, balanced = FLIES * smallest, BALANCED
        size = self._FirstDrag(FAR * smallest)
        try:
            while size > LAST and failures <= MOST_FAILURES and len(newton.history) < self.maxit:
                before = system.Place()
                if system.Way(start) > LOST * system.residual.size:
                    break
                if steps := self._Settles(size):
                    failures = 0
                    moved = system.Way(before[0])
                    if self._SlidesOn(moved / smallest):
                        system.slid = True
                        break
                    pushed = self._Unbalance()
                    if moved < REST * smallest and pushed < balanced:
                        if last := self._Polish():
                            return last
                        balanced = LESS * pushed
                    far = EASILY_FAR if steps <= EASY else FAR
                    if moved < far * smallest and not wait:
                        # The way is as long as the drag is small, and no longer.
                        size *= np.clip(moved / (FAR * smallest), SOFTEST, SOFTER)
                    wait = max(wait - 1, 0)
                else:
                    system.GoTo(before)
                    failures, size, wait = failures + 1, size * HARDER, WAIT
        finally:
            system.SetDrag(None)
            newton.reach = None
        raise newton.NotConverged(system.Measure())

    def _FirstDrag(self, way: float) -> float:
        """The size with which forces carry bodies about so far at first."""
        system = self.system
        system.Measure()
        drift = system.bodies.Drift(system.residual.scaled / system.scale, 1 / system.scale**2)
        return np.clip(drift / way, LAST, FIRST) if drift else FIRST

    def _SlidesOn(self, moved: float) -> bool:
        """Do bodies slide steadily and far, against a force that does not fall?

        `moved` is their way of the last stage, relative to the smallest macro-element.
        """
        last = self.newton.history[-1]
        drag = self.system.residual.drag
        force = np.linalg.norm(drag.Forces(self.system.values, self.system.scale))
        # In large sliding what sticks elsewhere may end it.
        steady = last.slip and not (last.stick and self.system.finite)
        self._stages = [*self._stages, (force, moved)] if steady else []
        forces, ways = np.array(self._stages[-STEADY - 1 :]).reshape(-1, 2).T
        same = np.abs(np.diff(forces)) <= SAME_FORCE * forces[1:]
        return len(same) == STEADY and bool(np.all(same)) and np.sum(ways[1:]) > SLID

    def _Settles(self, size: float) -> int:
        """In how many steps Newton's method comes to the end of a stage; 0 if it does not."""
        newton, system = self.newton, self.system
        rows = system.linear.free & system.residual.displacements & ~system.bulk.inner
        place = system.values.copy()
        system.SetDrag(Drag(size, place, rows))
        newton.reach = place, self._flies
        newton.globalization.Begin()
        ends = ENDS if system.islinear else TURNED
        try:
            system.residual.Follow()
            state = system.Measure()
            for step in range(1, STEPS + 1):
                system.Assemble()
                state, damping = newton._Step(state)
                newton.Record(state, damping)
                if max(state.equilibrium, state.constraint) < ends:
                    return step if system.motion is None else 0
                newton.Watch(state)
        except FAILURES:
            pass
        return 0

    def _Unbalance(self) -> float:
        """The forces that move bodies on without drag, relative to those at work."""
        self.system.SetDrag(None)
        return self.system.Measure().equilibrium

    def _Polish(self) -> Iteration | None:
        """The end of Newton's method from here; None, and back, if it does not come to one."""
        self.system.SetDrag(None)
        self.newton.reach = self.system.values.copy(), self._flies
        self.system.Assemble()
        return self.newton.Polish(self.system.Measure(), POLISH)
