# SPDX-License-Identifier: LGPL-2.1-or-later
"""Newton steps that raise the residual and lead nearer to the solution all the same."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ngslac.solve.residual import Norm

if TYPE_CHECKING:
    from ngslac.solve.residual import Measurement
    from ngslac.solve.system import System

__all__ = ["FEW", "Nearness"]

# Closed macro-elements that are so few that their status does not matter much.
FEW = 2
# How much stretching makes the residual grow, at least. Yielding makes it grow by less, and there
# residuals judge better.
MUCH = 3.0


class Nearness:
    """Tells by corrections whether a step from the present place leads nearer to the solution.

    A step moves along a tangent, and a thin body that bends is stretched on the way. It resists
    stretching so much more than bending that the residual grows, even a thousandfold, where the
    solution is near. Corrections are lengths, which know that (Deuflhard, Newton Methods for
    Nonlinear Problems, 2004).

    Parameters
    ----------
    system : System
    state : Measurement
        At the present place.
    way : (n,) array
        The whole step.
    """

    def __init__(self, system: System, state: Measurement, way: np.ndarray):
        self.system, self.state, self.way, self.place = system, state, way, system.Place()

    def Nears(self, part: float) -> bool:
        """Is a correction with the same matrices shorter than the part of the step that was taken?

        That is known at once.
        """
        return self._Length(self.system.SimplifiedCorrection()) <= part * self._Length(self.way)

    def May(self, trial: Measurement) -> bool:
        """Has the residual of the trial grown as it does where the bulk is stretched?

        Then the step may be taken, and the correction after it tells.
        """
        before, now = self.state.status, trial.status
        closed = max(np.count_nonzero(before), np.count_nonzero(now))
        steady = closed <= FEW or np.array_equal(before, now)
        return steady and trial.unbalance >= MUCH * self.state.unbalance

    def LedAway(self, correction: np.ndarray) -> bool:
        """Is the correction after the step longer than the step?"""
        return self._Length(correction) > self._Length(self.way)

    def Return(self) -> Measurement:
        """Go back to where the step began."""
        return self.system.Visit(self.place)

    def _Length(self, values: np.ndarray) -> float:
        """Of the displacements."""
        return Norm(values[self.system.residual.displacements])
