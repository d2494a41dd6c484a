# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sweeps over all dofs and algebraic multigrid on the vertices, for condensed systems."""

import numpy as np
import scipy

from ngslac._ngslac import StarSweeps, TwoLevel
from ngslac.arrays import AsBits, AsNumPy
from ngslac.linear.mixed import Mixed, PressureRows

__all__ = ["Multigrid"]

# Mean number of dofs of a star, whose matrix is inverted.
LARGEST_STAR = 100


class Multigrid:
    """Sweeps over all dofs around a V-cycle on the vertices, whose setup serves again.

    In NGSolve's hierarchical bases the functions of the vertices are those of first order, so that
    their matrix is a part of the given one. Where they are nearly all functions, the sweeps are
    those of the finest level. The sweeps solve for a vertex and what is around it at once: that
    takes less than half of the iterations of single dofs; stiffness may jump inside of elements.
    """

    growth = 1.5  # of the iterations, from which on a new setup is made

    def __init__(self, nodes, most, space):
        self.nodes, self.most, self.space = nodes, most, space
        self.Forget()

    def Forget(self):
        """Know nothing of the bulk."""
        self._sweeps = self._pressures = None
        self.Relearn()

    def Relearn(self):
        """Make another setup for the next matrix."""
        self._hierarchy = self._cycle = self._inverse = None
        self._best, self.learnt = np.inf, False

    def Preconditioner(self, system, scale):
        """For a Condensation of the matrix that has got the factors `scale` (n,).

        It serves until the next call.
        """
        if self._pressures is None:
            self._pressures = PressureRows(system)
        if self._sweeps is None:
            which = system.freedofs & AsBits(~self._pressures)
            self._sweeps = StarSweeps(system, which, Stars(self.space), self.space.dim)
        else:
            self._sweeps.Update(system)
        mat, self.learnt = Blocks(system, self.nodes.dofs), self._hierarchy is None
        if self.learnt:
            self._Learn(system, mat, self.nodes.Modes(scale))
        else:
            self._cycle.Take(self._hierarchy.Matrices(mat)[self._skipped :])
        mixed = np.any(self._pressures)
        return Mixed(system, self._inverse, self._pressures) if mixed else self._inverse

    @property
    def _skipped(self):
        """Levels of the hierarchy on which the sweeps take the place of the cycle's."""
        return int(self.most and bool(self._hierarchy.prolongations))

    def _Learn(self, system, mat, modes):
        """Make the hierarchy, and the preconditioner of displacements."""
        from ngslac.linear.hierarchy import Hierarchy, VCycle

        self._hierarchy = Hierarchy(mat, modes, fewest=int(self.most))
        prolongations, skipped = self._hierarchy.prolongations, self._skipped
        same = scipy.sparse.eye_array(mat.shape[0], format="csr")
        first = prolongations[0].tocsr() if skipped else same
        matrices, free = self._hierarchy.Matrices(mat)[skipped:], self.nodes.free.ravel()
        self._cycle = VCycle(prolongations[skipped:], matrices, first[free])
        dofs = self.nodes.dofs.ravel()[free]
        self._inverse = TwoLevel(system, self._sweeps, self._cycle, dofs)

    def Watch(self, iterations):
        """Tell how many `iterations` each digit took: where they grow the setup is made anew."""
        if iterations > self.growth * self._best:
            self.Relearn()
        else:
            self._best = min(self._best, iterations)


def Stars(space):
    """A table of dofs: all around each vertex; or where these are many its edges, and edges' faces.

    With all around a vertex iterations take no notice of order and shape, but inverses of large
    stars take more time and memory than they save.
    """
    stars = space.CreateSmoothingBlocks(blocktype=["vertexpatch"])
    sizes = np.fromiter(map(len, stars), int)
    if space.dim * sizes.mean() <= LARGEST_STAR:
        return stars
    return space.CreateSmoothingBlocks(blocktype=["vertexedge", "edgepatch"])


def Blocks(system, nodes):
    """The part of nodes (n, d) of dofs of a Condensation, as bsr_matrix.

    What is not free, or no dof, is a row of the identity.
    """
    used = (nodes >= 0) & AsNumPy(system.freedofs)[nodes]
    part = system.Part(np.where(used, nodes, -1).ravel())  # whose memory the views below are
    mat = scipy.sparse.csr_matrix(tuple(map(np.asarray, part.CSR())), shape=part.shape)
    return mat.tobsr(2 * (nodes.shape[1],)).sorted_indices()
