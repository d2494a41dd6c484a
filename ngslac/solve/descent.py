# SPDX-License-Identifier: LGPL-2.1-or-later
"""Laws that soften: steps that go down in energy, to a state that is stable."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ngslac.solve.statussearch import FAILURES, NEARER, POLISH

if TYPE_CHECKING:
    from ngslac.errors import ContactConvergenceError, LinearSolveError
    from ngslac.solve.iteration import Iteration
    from ngslac.solve.newton import Newton
    from ngslac.solve.residual import Measurement

__all__ = ["Descent"]

# Residual from which Newton's method may end it.
NEAR = 1e-2
# Steps after which a law has to soften, else that is not why Newton's method failed.
BEGUN = 5
# A step that changes the residual by less than this part is followed by a longer one, up to so
# many times as long.
STEADY, LONGEST = 0.2, 16.0


class Descent:
    """A solve with matrices that know nothing of how laws soften.

    Where glue tears faster than bodies unload it, no state is near the last one, and Newton's
    method goes to and fro between branches. Without the softening a step minimises an energy that
    is not less than the true one, so that this falls in each full step, whatever the residual does
    (the concave-convex procedure: Yuille and Rangarajan, Neural Comput. 15 (2003) 915). It comes
    to rest in a stable state, as bodies do that move slowly in something viscous. What is
    not symmetric, as friction, stays whole.

    `maxit` is the number of linear solves up to which the table of Newton's method may grow.
    """

    def __init__(self, newton: Newton, maxit: int):
        self.newton, self.system, self.maxit = newton, newton.system, maxit

    def Run(self, error: ContactConvergenceError | LinearSolveError) -> Iteration:
        """The last line of the table; `error` is what Newton's method ended with."""
        self.newton.log.Say(f"  {error}: descent without softening")
        self.newton.onpath = True
        try:
            return self._Descend()
        except FAILURES as another:
            raise error from another

    def _Descend(self) -> Iteration:
        """The last line, where steps without softening have come to a stable state."""
        newton, system, near, factor = self.newton, self.system, NEAR, 1.0
        state, begin = system.Measure(), len(newton.history)
        while len(newton.history) <= self.maxit:
            size = max(state.equilibrium, state.constraint)
            state, damping = self._Step(state, factor)
            state = newton.Confirmed(state)
            newton.Record(state, damping)
            if newton.Converged(state):
                return newton.Accept()
            if len(newton.history) == begin + BEGUN and not system.Softens():
                break
            now = max(state.equilibrium, state.constraint)
            steady = damping >= 1 and abs(now - size) < STEADY * size
            factor = min(2 * factor, LONGEST) if steady else 1.0
            if system.motion is None and now < near:
                near = NEARER * now
                if last := self._Polish():
                    return last
                state, factor = system.Measure(), 1.0
        raise newton.NotConverged(state)

    def _Step(self, state: Measurement, factor: float) -> tuple[Measurement, float]:
        """The next Measurement after a step that is `factor` times as long, and its length."""
        system, before, carries = self.system, self.system.values.copy(), self.system.motion
        system.Assemble()
        state, damping = self.newton._Step(state, convex=True)
        if factor == 1 or damping < 1 or carries is not None:
            return state, damping
        found = system.values.copy()
        system.values[:] = before + factor * (found - before)
        longer = system.Measure()
        if longer.finite:
            return longer, factor
        system.values[:] = found
        return system.Measure(), damping

    def _Polish(self) -> Iteration | None:
        """The end of Newton's method from here; None, and back, if it does not come to one."""
        self.system.Assemble()
        return self.newton.Polish(self.system.Measure(), POLISH)
