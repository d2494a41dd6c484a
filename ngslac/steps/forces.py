# SPDX-License-Identifier: LGPL-2.1-or-later
"""Forces of the bulk at the ends of a step, and on the way."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ngslac.solve.residual import Norm

if TYPE_CHECKING:
    from ngsolve import BaseVector

    from ngslac.parallel.layout import Layout, Whole
    from ngslac.solve.solver import ContactSolver

__all__ = ["BulkForces"]

# Deviation of forces, relative to their size, that is rounding, and from a straight line relative
# to the way along it.
STEADY, STRAIGHT = 1e-11, 1e-10
# Inner points of the Gauss-Lobatto rule with four points on (0, 1), and the weight at its ends.
INNER, END = (0.5 - 0.05**0.5, 0.5 + 0.05**0.5), 1 / 12


class BulkForces:
    """The forces of the bulk of a static problem."""

    def __init__(self, static: ContactSolver, rows: np.ndarray):
        self.static, self.rows = static, rows
        self._seen = None  # displacement and what the bulk form said there, and of 0

    @property
    def _layout(self) -> Layout | Whole:
        return self.static.system.layout

    @property
    def _values(self) -> np.ndarray:
        return self._layout.Values(self.static.gf.vec)

    def Now(self, force: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Force of the bulk including the loads (n,), and the loads alone.

        `force`: what the bulk form says of the solution, if it was asked.
        """
        zero, values = self.static.gf.vec.CreateVector(), self._values
        zero[:] = 0
        force = self._Apply(self.static.gf.vec) if force is None else force
        self._seen = values.copy(), force, self._Apply(zero)
        return self._Known(force)

    def Next(
        self, force: np.ndarray | None, product: Callable[[np.ndarray], np.ndarray] | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """The same at the next solution.

        Where the force changes from that of before as a linear form does whose loads stay, these
        are known. Rounding errors of large motions leave no doubt for long: the loads are asked
        for anew then, and it goes on from there.
        """
        if force is None or product is None or self._seen is None:
            return self.Now(force)
        values, (start, before, _) = self._values, self._seen
        deviation = self._Deviation(force, before, product(values - start))
        known = Norm(deviation) <= self._Least(force, before)
        return self._Known(force) if known else self.Now(force)

    def _Deviation(self, force: np.ndarray, before: np.ndarray, change: np.ndarray) -> np.ndarray:
        return (force - before - change) * self.rows

    def _Least(self, *forces: np.ndarray) -> float:
        return STEADY * max(Norm(force * self.rows) for force in forces)

    def _Known(self, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        load = self.static.system.bulk.load
        return (force - load) * self.rows, (load - self._seen[2]) * self.rows

    def Changed(
        self,
        before: tuple[np.ndarray, np.ndarray],
        now: tuple[np.ndarray, np.ndarray],
        change: np.ndarray,
        isrounding: Callable[[np.ndarray], bool],
    ) -> bool:
        """Did the force without loads change in a step by `change`, that of a linear form?"""
        before, now = sum(before), sum(now)
        deviation = self._Deviation(now, before, change)
        return Norm(deviation) <= self._Least(now, before) or isrounding(deviation)

    def OnTheWay(
        self,
        motion: np.ndarray,
        before: tuple[np.ndarray, np.ndarray],
        now: tuple[np.ndarray, np.ndarray],
        linear: bool,
        isrounding: Callable[[np.ndarray], bool],
    ) -> tuple[list[tuple[float, np.ndarray, np.ndarray]], bool]:
        """Weights, places and forces (without loads) along a step; and is the force linear?

        For an elastic bulk their work is the change of the strain energy: exact for a linear one,
        of the sixth order in the length of the step for others.
        """
        end = self._values
        places, ends = [end - (1 - place) * motion for place in INNER], (sum(before), sum(now))
        if not linear:
            forces = [self._At(place, now) for place in places]
            linear = self._Straight(end - motion, forces, now, isrounding)
        weight = 0.5 if linear else END
        points = list(zip((weight, weight), (end - motion, end), ends, strict=True))
        if not linear:
            points += zip((0.5 - END, 0.5 - END), places, forces, strict=True)
        return points, linear

    def _Straight(
        self,
        start: np.ndarray,
        forces: Sequence[np.ndarray],
        now: tuple[np.ndarray, np.ndarray],
        isrounding: Callable[[np.ndarray], bool],
    ) -> bool:
        """Is the force a linear function on the way, as its inner points say, and its start?

        The law may change with the time: the force where the step began is another one by now.
        """
        (first, second), end = forces, sum(now)
        slope = (second - first) / (INNER[1] - INNER[0])

        def On(force: np.ndarray, place: float) -> bool:
            deviation = force - first - (place - INNER[0]) * slope
            return Norm(deviation) <= STRAIGHT * Norm(slope) or isrounding(deviation)

        return bool(On(end, 1.0) and On(self._At(start, now), 0.0))

    def _At(self, place: np.ndarray, now: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        """The force without loads of a displacement (n,), under the loads of `Now`."""
        vec, (_, loads) = self.static.gf.vec.CreateVector(), now
        self._layout.Values(vec)[:] = place
        return (self._Apply(vec) - self.static.system.bulk.load) * self.rows + loads

    def _Apply(self, vec: BaseVector) -> np.ndarray:
        result = vec.CreateVector()
        self._layout.Apply(self.static.a, vec, result)
        return self._layout.Values(result)
