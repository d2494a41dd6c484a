# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sweeps over all dofs and algebraic multigrid on the vertices, for condensed systems."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy

from ngslac._ngslac import Condensation, StarSweeps, TwoLevel
from ngslac.arrays import AsBits, AsNumPy
from ngslac.linear.mixed import Mixed, PressureRows

if TYPE_CHECKING:
    from ngsolve import FESpace
    from pyngcore.pyngcore import Table_I
    from scipy.sparse import bsr_matrix

    from ngslac.linear.vertices import VertexNodes

__all__ = ["Multigrid"]

# Largest mean number of dofs of a star; the matrix of each star is inverted.
LARGEST_STAR = 100


class Multigrid:
    """Sweeps over all dofs before and after a V-cycle on the vertices; its setup is reused.

    In NGSolve's hierarchical bases the functions of the vertices are those of first order, so that
    their matrix is a part of the system's. Where nearly all functions are those of vertices, the
    sweeps are also the sweeps of the finest level. Each step of a sweep solves for the dofs at and
    around a vertex together. This takes less than half of the iterations that sweeps over single
    dofs take, and the stiffness may jump inside of elements.
    """

    growth = 1.5  # a new setup is made where iterations grow by more than this factor

    def __init__(self, nodes: VertexNodes, most: bool, space: FESpace):
        self.nodes, self.most, self.space = nodes, most, space
        self.Forget()

    def Forget(self) -> None:
        """Drop all that was learnt about the bulk."""
        self._sweeps = self._pressures = None
        self.Relearn()

    def Relearn(self) -> None:
        """Make another setup for the next matrix."""
        self._hierarchy = self._cycle = self._inverse = None
        self._best, self.learnt = np.inf, False

    def Preconditioner(self, system: Condensation, scale: np.ndarray) -> TwoLevel:
        """Return the preconditioner of a Condensation, whose matrix was scaled by `scale` (n,).

        It is valid until the next call.
        """
        if self._pressures is None:
            self._pressures = PressureRows(system)
        if self._sweeps is None:
            which = system.freedofs & AsBits(~self._pressures)
            self._sweeps = StarSweeps(system, which, Stars(self.space), self.space.dim)
        else:
            self._sweeps.Update(system)
        self.learnt, nodes = self._hierarchy is None, self.nodes.dofs
        changed = np.any((nodes >= 0) & system.changed[nodes], axis=1)
        if self.learnt:
            self._changed = changed
            self._Learn(system, Blocks(system, nodes), self.nodes.Modes(scale))
        elif self._skipped:  # the rows that did not change are not needed
            self._changed |= changed
            mat, rows = Blocks(system, nodes, self._changed), np.flatnonzero(self._changed)
            self._cycle.Take(self._hierarchy.Matrices(mat, rows)[1:])
        else:
            self._cycle.Take(self._hierarchy.Matrices(Blocks(system, nodes)))
        mixed = np.any(self._pressures)
        return Mixed(system, self._inverse, self._pressures) if mixed else self._inverse

    @property
    def _skipped(self) -> int:
        """Levels of the hierarchy on which the sweeps take the place of the cycle's."""
        return int(self.most and bool(self._hierarchy.prolongations))

    def _Learn(self, system: Condensation, mat: bsr_matrix, modes: np.ndarray) -> None:
        """Make the hierarchy, and the preconditioner of displacements."""
        from ngslac.linear.hierarchy import Hierarchy, VCycle

        self._hierarchy = Hierarchy(mat, modes, fewest=int(self.most))
        prolongations, skipped = self._hierarchy.prolongations, self._skipped
        onto = prolongations[0] if skipped else scipy.sparse.eye_array(mat.shape[0], format="csr")
        matrices = self._hierarchy.Matrices(mat)[skipped:]
        self._cycle = VCycle(prolongations[skipped:], matrices, onto)
        dofs = np.where(self.nodes.free, self.nodes.dofs, -1).ravel()
        self._inverse = TwoLevel(system, self._sweeps, self._cycle, dofs)

    def Watch(self, iterations: float) -> None:
        """Take the `iterations` for each digit: where they grow, the next setup is a new one."""
        if iterations > self.growth * self._best:
            self.Relearn()
        else:
            self._best = min(self._best, iterations)


def Stars(space: FESpace) -> Table_I:
    """Make a table of stars of dofs: all dofs around each vertex, or fewer where those are many.

    With all dofs around a vertex, iterations do not depend on order and shape of elements; but
    inverses of large stars take more time and memory than they save. The smaller stars are a vertex
    with its edges, and an edge with its faces.
    """
    stars = space.CreateSmoothingBlocks(blocktype=["vertexpatch"])
    sizes = np.fromiter(map(len, stars), int)
    if space.dim * sizes.mean() <= LARGEST_STAR:
        return stars
    return space.CreateSmoothingBlocks(blocktype=["vertexedge", "edgepatch"])


def Blocks(system: Condensation, nodes: np.ndarray, rows: np.ndarray | None = None) -> bsr_matrix:
    """Return the part of a Condensation on nodes (n, d) of dofs, or some `rows` (n,) bool of it.

    It is a bsr_matrix. An entry of `nodes` that is not a free dof gets a row of the identity.
    """
    used = (nodes >= 0) & AsNumPy(system.freedofs)[nodes]
    rows = None if rows is None else AsBits(np.repeat(rows, nodes.shape[1]))
    part = system.Part(np.where(used, nodes, -1).ravel(), rows)  # the arrays below view its memory
    mat = scipy.sparse.csr_matrix(tuple(map(np.asarray, part.CSR())), shape=part.shape)
    blocks = mat.tobsr(2 * (nodes.shape[1],))
    blocks.sort_indices()
    return blocks
