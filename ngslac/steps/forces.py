# SPDX-License-Identifier: LGPL-2.1-or-later
"""Forces of the bulk at the ends of a step, and on the way."""

from ngslac.solve.residual import Norm

__all__ = ["BulkForces"]

# Deviation of forces, relative to their size, that is rounding, and from a straight line relative
# to the way along it.
STEADY, STRAIGHT = 1e-11, 1e-10
# Inner points of the Gauss-Lobatto rule with four points on (0, 1), and the weight at its ends.
INNER, END = (0.5 - 0.05**0.5, 0.5 + 0.05**0.5), 1 / 12


class BulkForces:
    """The forces of the bulk of a static problem."""

    def __init__(self, static, rows):
        self.static, self.rows = static, rows
        self._seen = None  # displacement and what the bulk form said there, and of 0

    @property
    def _layout(self):
        return self.static.system.layout

    @property
    def _values(self):
        return self._layout.Values(self.static.gf.vec)

    def Now(self, force=None):
        """Force of the bulk including the loads (n,), and the loads alone.

        `force`: what the bulk form says of the solution, if it was asked.
        """
        zero, values = self.static.gf.vec.CreateVector(), self._values
        zero[:] = 0
        force = self._Apply(self.static.gf.vec) if force is None else force
        self._seen = values.copy(), force, self._Apply(zero)
        return self._Known(force)

    def Next(self, force, product):
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

    def _Deviation(self, force, before, change):
        return (force - before - change) * self.rows

    def _Least(self, *forces):
        return STEADY * max(Norm(force * self.rows) for force in forces)

    def _Known(self, force):
        load = self.static.system.bulk.load
        return (force - load) * self.rows, (load - self._seen[2]) * self.rows

    def Changed(self, before, now, change, isrounding):
        """Did the force without loads change in a step by `change`, that of a linear form?"""
        before, now = sum(before), sum(now)
        deviation = self._Deviation(now, before, change)
        return Norm(deviation) <= self._Least(now, before) or isrounding(deviation)

    def OnTheWay(self, motion, before, now, linear, isrounding):
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

    def _Straight(self, start, forces, now, isrounding):
        """Is the force a linear function on the way, as its inner points say, and its start?

        The law may change with the time: the force where the step began is another one by now.
        """
        (first, second), end = forces, sum(now)
        slope = (second - first) / (INNER[1] - INNER[0])

        def On(force, place):
            deviation = force - first - (place - INNER[0]) * slope
            return Norm(deviation) <= STRAIGHT * Norm(slope) or isrounding(deviation)

        return bool(On(end, 1.0) and On(self._At(start, now), 0.0))

    def _At(self, place, now):
        """The force without loads of a displacement (n,), under the loads of `Now`."""
        vec, (_, loads) = self.static.gf.vec.CreateVector(), now
        self._layout.Values(vec)[:] = place
        return (self._Apply(vec) - self.static.system.bulk.load) * self.rows + loads

    def _Apply(self, vec):
        result = vec.CreateVector()
        self._layout.Apply(self.static.a, vec, result)
        return self._layout.Values(result)
