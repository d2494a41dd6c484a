"""Forces of the bulk at the ends of a step, and on the way."""

__all__ = ["BulkForces"]

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

    def Now(self):
        """Force of the bulk including the loads (n,), and the loads alone."""
        static, zero = self.static, self.static.gf.vec.CreateVector()
        zero[:] = 0
        load = static.system.bulk.load
        loads = (load - self._Apply(zero)) * self.rows
        return (self._Apply(static.gf.vec) - load) * self.rows, loads

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
