"""Forces of the bulk at the ends of a step, and on the way."""

from ngslac.solve.residual import Norm

__all__ = ["BulkForces"]

# Deviation of forces, relative to their size, that is rounding.
STEADY = 1e-11
# Inner points of the Gauss-Lobatto rule with four points on (0, 1), and the weight at its ends.
INNER, END = (0.5 - 0.05**0.5, 0.5 + 0.05**0.5), 1 / 12


class BulkForces:
    """What the bulk of a static problem pushes with.

    Parameters
    ----------
    static : ContactSolver
    rows : (n,) bool
        Scalar dofs of the displacement.
    """

    def __init__(self, static, rows):
        self.static, self.rows = static, rows
        self._seen = None  # displacement and what the bulk form said there, and of 0

    def Now(self, force=None):
        """Force of the bulk including the loads (n,), and the loads alone.

        `force`: what the bulk form says of the solution, if it was asked.
        """
        zero, values = self.static.gf.vec.CreateVector(), self.static.gf.vec.FV().NumPy()
        zero[:] = 0
        force = self._Apply(self.static.gf.vec) if force is None else force
        self._seen = values.copy(), force, self._Apply(zero)
        return self._Known(force)

    def Next(self, force, product):
        """The same at the next solution.

        Where the force changes from that of before as a linear form does whose loads stay, these
        are known. Rounding errors of large motions leave no doubt for long: the loads are asked
        for anew then, and it goes on from there.

        Parameters
        ----------
        force : (n,) array or None
            What the bulk form says of the solution, if it was asked.
        product : callable or None
            ``product(motion)`` is what a linear form adds to it; None: it is not linear.
        """
        if force is None or product is None or self._seen is None:
            return self.Now(force)
        values, (start, before, _) = self.static.gf.vec.FV().NumPy(), self._seen
        deviation = (force - before - product((values - start) * self.rows)) * self.rows
        size = max(Norm(force * self.rows), Norm(before * self.rows))
        if not Norm(deviation) <= STEADY * size:
            return self.Now(force)
        return self._Known(force)

    def _Known(self, force):
        load = self.static.system.bulk.load
        return (force - load) * self.rows, (load - self._seen[2]) * self.rows

    def OnTheWay(self, motion, before, now, linear):
        """Forces without loads at points of the straight way of a step, to be integrated along it.

        For an elastic bulk their work is the change of the strain energy: exact for a linear one,
        of the sixth order in the length of the step for others.

        Parameters
        ----------
        motion : (n,) array
            Leads to the solution.
        before, now : tuple
            Of `Now`, at the begin and at the end of the motion.
        linear : bool
            Is the force known to be linear?

        Returns
        -------
        list
            Of weights (of the sum 1), displacements (n,) and forces (n,).
        """
        end, load = self.static.gf.vec.FV().NumPy(), self.static.system.bulk.load
        weight, inner = (0.5, ()) if linear else (END, INNER)
        points = [(weight, end - motion, sum(before)), (weight, end, sum(now))]
        vec, (_, loads) = self.static.gf.vec.CreateVector(), now
        for place in inner:
            vec.FV().NumPy()[:] = at = end - (1 - place) * motion
            points.append((0.5 - END, at, (self._Apply(vec) - load) * self.rows + loads))
        return points

    def _Apply(self, vec):
        result = vec.CreateVector()
        self.static.a.Apply(vec, result)
        return result.FV().NumPy()
