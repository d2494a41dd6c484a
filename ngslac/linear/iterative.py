"""Condensed Newton systems by a preconditioned iteration, which needs little memory."""

import numpy as np
from scipy.sparse import bsr_matrix, eye_array

from ngslac._ngslac import OrthogonalCondensation, TwoLevel, TwoLevelProduct
from ngslac.linear.condensed import Condensed, IsNear, RightGMRes
from ngslac.linear.multigrid import Hierarchy, VCycle

__all__ = ["IterativeCondensed", "Multigrid"]


class IterativeCondensed(Condensed):
    """With multigrid, which needs little memory, made for each system.

    Slip is in it: a frictionless one costs up to twice the iterations.

    Parameters
    ----------
    freedofs, bits, dim, inverse :
        As above.
    multigrid : Multigrid
    preconditioner : callable, optional
        Takes the place of the multigrid method: see ContactSolver.
    """

    system = OrthogonalCondensation
    most_iterations = 250
    best = 1e-5  # in single precision; the rounds do the rest

    def __init__(self, freedofs, bits, dim, inverse, multigrid, preconditioner=None):
        self.multigrid, self.preconditioner = multigrid, preconditioner
        super().__init__(freedofs, bits, dim, inverse)

    def Forget(self):
        """Keep no preconditioner for the next system."""
        super().Forget()
        if self.multigrid:
            self.multigrid.Forget()

    def NewBulk(self):
        """The bulk matrix has got other values."""
        super().NewBulk()
        if self.multigrid:
            self.multigrid.Forget()

    def _Accuracy(self, wanted):
        return max(wanted, self.exact)

    def _Frictionless(self, _):
        return None

    def _Preconditioners(self, system, _, __):
        if self._kept is None or not IsNear(system, self._kept[0]):
            self._kept = None
            self._kept = system, *self._Make(system)
        yield self._kept[1], self.most_iterations
        if self.preconditioner is None and not self.multigrid.learnt:
            self.multigrid.Forget()
            self._kept = None
            self._kept = system, *self._Make(system)
            yield self._kept[1], self.most_iterations

    def _Make(self, system):
        """The preconditioner, and what has to live as long."""
        if self.preconditioner is None:
            return self.multigrid.Preconditioner(system, self.scale), None
        mat = system.Part()
        inverse = self.preconditioner(mat, system.freedofs)
        if getattr(inverse, "shape", None) != mat.shape:
            raise ValueError(
                f"preconditioner= returned {inverse}, not an operator of the size {mat.shape}"
            )
        return inverse, mat

    def _Iterate(self, system, _, inverse, rhs, tol, iterations):
        own = isinstance(inverse, TwoLevel)
        product = TwoLevelProduct(inverse, system) if own else system @ inverse
        given = product, inverse, rhs, system.freedofs
        krylov, solution = RightGMRes(*given, tol=tol, maxiter=iterations)
        if own:
            self.multigrid.Watch(krylov.iterations / -np.log10(tol))
        return krylov, solution


class Multigrid:
    """Sweeps over all dofs around a V-cycle on the vertices, whose setup serves again.

    In NGSolve's hierarchical bases the functions of the vertices are those of first order, so that
    their matrix is a part of the given one. Where they are nearly all functions, the sweeps are
    those of the finest level.

    Parameters
    ----------
    nodes : VertexNodes
    most : bool
        Are most dofs those of the vertices?

    Attributes
    ----------
    learnt : bool
        Was the setup made for the last matrix?
    """

    growth = 1.5  # of the iterations, from which on a new setup is made

    def __init__(self, nodes, most):
        self.nodes, self.most = nodes, most
        self.Forget()

    def Forget(self):
        """Make another setup for the next matrix."""
        self._hierarchy, self._best, self.learnt = None, np.inf, False

    def Preconditioner(self, system, scale):
        """A TwoLevel for a Condensation of the matrix that has got the factors `scale` (n,)."""
        mat = Blocks(system, self.nodes.dofs)
        self.learnt = self._hierarchy is None
        if self.learnt:
            self._hierarchy = Hierarchy(mat, self.nodes.Modes(scale), fewest=int(self.most))
        matrices, prolongations = self._hierarchy.Matrices(mat), self._hierarchy.prolongations
        skipped = int(self.most and bool(prolongations))
        first = prolongations[0].tocsr() if skipped else eye_array(mat.shape[0], format="csr")
        cycle = VCycle(matrices[skipped:], prolongations[skipped:])
        free = self.nodes.free.ravel()
        rows = first[free]
        dofs = self.nodes.dofs.ravel()[free]
        return TwoLevel(system, cycle, dofs, rows.indptr, rows.indices, rows.data)

    def Watch(self, iterations):
        """Tell how many `iterations` each digit took: where they grow the setup is made anew."""
        if iterations > self.growth * self._best:
            self.Forget()
        else:
            self._best = min(self._best, iterations)


def Blocks(system, nodes):
    """The part of nodes (n, d) of dofs of a Condensation, as bsr_matrix."""
    starts, columns, values = system.NodeBlocks(nodes)
    width = nodes.shape[1]
    blocks = values.reshape(-1, width, width)
    return bsr_matrix((blocks, columns, starts), shape=(nodes.size, nodes.size))
