# SPDX-License-Identifier: LGPL-2.1-or-later
"""The bulk, held by a few springs and factored once, for all systems of contact on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy

from ngslac._ngslac import MergeMatrices, SchurComplement
from ngslac.arrays import AddToDiagonal, AsBits, Multiply, SameMatrix
from ngslac.errors import LinearSolveError
from ngslac.linear.factor import Factor, IsSymmetric

if TYPE_CHECKING:
    from ngsolve import BaseMatrix
    from scipy.sparse import csc_matrix

    from ngslac.linear.system import LinearSystem

__all__ = ["SPRING", "Grounded", "GroundedBulk", "MostApart", "UnitColumns"]

# Stiffness of the springs in the scaled matrix, whose diagonal is 1.
SPRING = 1.0
# Of a motion that is none, relative to the largest.
NO_MOTION = 1e-6


class GroundedBulk:
    """The scaled matrix of the bulk with a few springs, and its factors.

    The springs make it regular, whatever holds the bodies; their forces are unknowns of the
    interface, so that the solution knows nothing of them.
    """

    def __init__(self, system: LinearSystem, free: np.ndarray, motions: np.ndarray):
        self.bulk, self.shift, self.free = system.mat, system.shift, free
        self.scale = system.scale * free
        self.mat = MergeMatrices(system.mat, [], system.scale)
        if not IsSymmetric(self.mat):
            raise LinearSolveError("the bulk is not symmetric")
        self.springs = Grounded(self.mat, free, motions)
        added = np.zeros(len(free)) if system.shift is None else system.shift * free
        added[self.springs] += SPRING
        AddToDiagonal(self.mat, added)
        self.inverse = Factor(self.mat, AsBits(free), "sparsecholesky")
        self._columns = self._schur = None

    def Fits(self, system: LinearSystem, free: np.ndarray) -> bool:
        """Was it made of these?"""
        pairs = (free, self.free), (system.scale * free, self.scale), (system.shift, self.shift)
        return system.mat is self.bulk and all(np.array_equal(*pair) for pair in pairs)

    def Times(self, u: np.ndarray) -> np.ndarray:
        """The free rows of its product, without the springs, with u (n,), zero where not free."""
        product = Multiply([self.mat], u) * self.free
        product[self.springs] -= SPRING * u[self.springs]
        return product

    def Schur(self, columns: csc_matrix) -> tuple[SchurComplement, np.ndarray]:
        """Of columns C (n, m), and one more for each spring: a SchurComplement, and C^T K^-1 C."""
        if self._columns is None or not SameMatrix(self._columns, columns):
            unit = UnitColumns(self.springs, len(self.free))
            every = scipy.sparse.hstack([columns, unit], format="csc")
            schur = SchurComplement(self.inverse, every.indptr, every.indices, every.data)
            self._columns, self._schur = columns, (schur, schur.complement)
        return self._schur


def UnitColumns(dofs: np.ndarray, n: int) -> csc_matrix:
    """The columns (n, k) of the unit matrix of k dofs."""
    return scipy.sparse.csc_matrix(
        (np.ones(len(dofs)), (dofs, np.arange(len(dofs)))), (n, len(dofs))
    )


def Grounded(mat: BaseMatrix, free: np.ndarray, motions: np.ndarray) -> np.ndarray:
    """Dofs (k,) that springs on them hold all bodies by, whatever else holds these."""
    dofs = np.flatnonzero(free & np.any(motions, axis=1))
    part = FreeParts(mat, free)[dofs]
    dofs = dofs[np.argsort(part, kind="stable")]
    ends = np.flatnonzero(np.diff(np.sort(part))) + 1
    chosen = [MostApart(own, motions[own]) for own in np.split(dofs, ends)]
    return np.sort(np.concatenate(chosen))


def FreeParts(mat: BaseMatrix, free: np.ndarray) -> np.ndarray:
    """A number (n,) for each free dof: the same where the matrix connects them without others."""
    values, columns, starts = (np.asarray(a) for a in mat.CSR())
    starts = starts.astype(columns.dtype)
    rows = np.repeat(free, np.diff(starts))
    links = rows & free[columns] & (values != 0)
    count = np.concatenate([[0], np.cumsum(links, dtype=columns.dtype)])
    columns, starts = columns[links], count[starts]
    graph = scipy.sparse.csr_matrix(
        (np.ones(len(columns), np.int8), columns, starts), shape=mat.shape
    )
    return scipy.sparse.csgraph.connected_components(graph, directed=False)[1]


def MostApart(dofs: np.ndarray, motions: np.ndarray) -> np.ndarray:
    """The dofs that distinguish their motions best, by a pivoted elimination."""
    if not len(dofs):
        return dofs
    triangle, order = scipy.linalg.qr(motions.T, mode="r", pivoting=True)
    pivots = np.abs(np.diag(triangle))
    return dofs[order[: len(pivots)][pivots > NO_MOTION * pivots[0]]]
