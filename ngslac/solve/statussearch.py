# SPDX-License-Identifier: LGPL-2.1-or-later
"""Where Newton's method finds no contact status: another method does, and Newton's ends it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ngslac.bodies.messages import LostMessage
from ngslac.errors import ContactConvergenceError, FloatingBodyError, LinearSolveError
from ngslac.solve.interior import EvenPressures, InteriorPoint
from ngslac.solve.look import MechanismError

if TYPE_CHECKING:
    from ngslac.solve.iteration import Iteration
    from ngslac.solve.newton import Newton
    from ngslac.solve.residual import Measurement

__all__ = ["StatusSearch"]

FAILURES = (ContactConvergenceError, LinearSolveError)
# Residual from which Newton's method may end what the other one began, how many steps it gets for
# that, and how much nearer it has to be the next time.
NEAR, POLISH, NEARER = 1e-3, 8, 1e-2
# The same where it began with even pressures.
POLISH_ENDS = 20
# Number of residuals that are those of some steps before, up to a relative difference.
STALLED, PERIOD, SAME = 8, 4, 1e-3
# Part of a step so short that there is no way on, and how many of these are the end.
TINY, MOST_TINY = 1e-3, 3


class StatusSearch:
    """A solve by an interior point method, from its start and with its table."""

    def __init__(self, newton: Newton, maxit: int):
        self.newton, self.system, self.maxit = newton, newton.system, maxit

    def Run(self, error: ContactConvergenceError | LinearSolveError) -> Iteration:
        """The last line of the table; `error` is what Newton's method ended with."""
        system = self.system
        self.newton.log.Say(f"  {error}: interior point method")
        self.newton.onpath = True
        system.Assemble()
        system.residual.Follow()
        try:
            with EvenPressures(system.contacts):
                last = self._Follow(InteriorPoint(system, system.Measure()))
            self._CheckLost(error)
            return last
        except FAILURES as another:
            self._CheckLost(error)
            loose = isinstance(error, (LinearSolveError, FloatingBodyError))
            if loose and not isinstance(error, MechanismError):
                raise another from error
            raise error from another

    def _Follow(self, path: InteriorPoint) -> Iteration:
        """The last line at the end of a central path, or where Newton's method ends it."""
        newton, state, near, tiny = self.newton, path.state, NEAR, 0
        while len(newton.history) <= self.maxit and tiny < MOST_TINY and not self._Stalls():
            state, damping = path.Step(state)
            tiny = tiny + 1 if damping < TINY else 0
            state = newton.Confirmed(state)
            newton.Record(state, damping)
            converged = newton.Converged(state)
            if converged and not path.approximates:
                return newton.Accept()
            if self.system.motion is None and max(state.equilibrium, state.constraint) < near:
                near *= NEARER
                if last := self._Polish(state, path.approximates):
                    return last
                state = self.system.Measure()
            if converged:
                break
            self.system.Assemble()
        if last := self._Stalls() and self._Polish(state, path.approximates):
            return last
        raise newton.NotConverged(state)

    def _Stalls(self) -> bool:
        """Have the residuals for some time been those of one, or a few, steps before?"""
        last = self.newton.history[-STALLED - PERIOD :]
        if len(last) < STALLED + PERIOD or self.system.motion is not None:
            return False
        sizes = np.array([(entry.equilibrium, entry.constraint) for entry in last])
        now = sizes[PERIOD:]
        before = (sizes[PERIOD - p : len(sizes) - p] for p in range(1, PERIOD + 1))
        return any(np.all(np.abs(now - old) <= SAME * now.max(axis=0)) for old in before)

    def _Polish(self, state: Measurement, was_even: bool) -> Iteration | None:
        """The end of Newton's method from here; None, and back, if it does not come to one."""
        if not was_even:
            return self.newton.Polish(state, POLISH)
        with EvenPressures(self.system.contacts, even=False):
            self.system.Assemble()
            return self.newton.Polish(self.system.Measure(), POLISH_ENDS)

    def _CheckLost(self, error: ContactConvergenceError | LinearSolveError) -> None:
        """Raise an error if a body is carried off: that before, if it knows of it."""
        if not (lost := self.system.bodies.Lost(self.system.values)):
            return
        if isinstance(error, FloatingBodyError):
            raise error
        raise FloatingBodyError(LostMessage(lost)) from error
