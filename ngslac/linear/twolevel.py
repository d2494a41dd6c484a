"""Sweeps over all dofs and algebraic multigrid on the vertices, for condensed systems."""

import numpy as np
from scipy.sparse import bsr_matrix, eye_array

from ngslac._ngslac import StarSweeps, TwoLevel
from ngslac.arrays import AsBits
from ngslac.linear.mixed import Mixed, PressureRows
from ngslac.linear.multigrid import Hierarchy, VCycle

__all__ = ["Multigrid"]

# Mean number of dofs of a star, whose matrix is inverted.
LARGEST_STAR = 100


class Multigrid:
    """Sweeps over all dofs around a V-cycle on the vertices, whose setup serves again.

    In NGSolve's hierarchical bases the functions of the vertices are those of first order, so that
    their matrix is a part of the given one. Where they are nearly all functions, the sweeps are
    those of the finest level. The sweeps solve for a vertex and what is around it at once: that
    takes less than half of the iterations of single dofs; stiffness may jump inside of elements.

    Parameters
    ----------
    nodes : VertexNodes
    most : bool
        Are most dofs those of the vertices?
    space : FESpace
        Of the whole system.

    Attributes
    ----------
    learnt : bool
        Was the setup made for the last matrix?
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
        self._hierarchy, self._best, self.learnt = None, np.inf, False

    def Preconditioner(self, system, scale):
        """For a Condensation of the matrix that has got the factors `scale` (n,)."""
        if self._pressures is None:
            self._pressures = PressureRows(system)
        inverse = self._OnDisplacements(system, scale)
        return Mixed(system, inverse, self._pressures) if np.any(self._pressures) else inverse

    def _OnDisplacements(self, system, scale):
        """A TwoLevel."""
        if self._sweeps is None:
            which = system.freedofs & AsBits(~self._pressures)
            self._sweeps = StarSweeps(system, which, Stars(self.space), self.space.dim)
        else:
            self._sweeps.Update(system)
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
        return TwoLevel(system, self._sweeps, cycle, dofs, rows.indptr, rows.indices, rows.data)

    def Watch(self, iterations):
        """Tell how many `iterations` each digit took: where they grow the setup is made anew."""
        if iterations > self.growth * self._best:
            self.Relearn()
        else:
            self._best = min(self._best, iterations)


def Stars(space):
    """A table of dofs for each vertex: of all around it, or of its edges where these are many."""
    stars = space.CreateSmoothingBlocks(blocktype=["vertexpatch"])
    sizes = np.fromiter(map(len, stars), int)
    if space.dim * sizes.mean() <= LARGEST_STAR:
        return stars
    return space.CreateSmoothingBlocks(blocktype=["vertexedge"])


def Blocks(system, nodes):
    """The part of nodes (n, d) of dofs of a Condensation, as bsr_matrix."""
    starts, columns, values = system.NodeBlocks(nodes)
    width = nodes.shape[1]
    blocks = values.reshape(-1, width, width)
    return bsr_matrix((blocks, columns, starts), shape=(nodes.size, nodes.size))
