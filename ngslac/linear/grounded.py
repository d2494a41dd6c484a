# SPDX-License-Identifier: LGPL-2.1-or-later
"""The bulk, held by a few springs and factored once, for all systems of contact on it."""

import numpy as np
import scipy

from ngslac._ngslac import MergeMatrices, SchurComplement
from ngslac.arrays import AddToDiagonal, AsBits, Multiply, SameMatrix
from ngslac.linear.factor import Factor, IsSymmetric, LinearSolveError
from ngslac.linear.grounding import Grounded

__all__ = ["SPRING", "GroundedBulk", "UnitColumns"]

# Stiffness of the springs in the scaled matrix, whose diagonal is 1.
SPRING = 1.0


class GroundedBulk:
    """The scaled matrix of the bulk with a few springs, and its factors.

    The springs make it regular, whatever holds the bodies; their forces are unknowns of the
    interface, so that the solution knows nothing of them.

    Parameters
    ----------
    bulk : BaseMatrix
    scale : (n,) array
    shift : (n,) array or None
        To be added to the scaled diagonal.
    free : (n,) bool
        Free displacements.
    motions : (n, m) array
        See `Grounded`.

    Attributes
    ----------
    springs : (k,) int
        Their dofs.

    Raises
    ------
    LinearSolveError
        The matrix is not symmetric, or has no factors.
    """

    def __init__(self, bulk, scale, shift, free, motions):
        self.bulk, self.shift, self.free = bulk, shift, free
        self.scale = scale * free
        self.mat = MergeMatrices(bulk, [], scale)
        if not IsSymmetric(self.mat):
            raise LinearSolveError("the bulk is not symmetric")
        self.springs = Grounded(self.mat, free, motions)
        added = np.zeros(len(scale)) if shift is None else shift * free
        added[self.springs] += SPRING
        AddToDiagonal(self.mat, added)
        self.inverse = Factor(self.mat, AsBits(free), "sparsecholesky")
        self._columns = self._schur = None

    def Fits(self, bulk, scale, shift, free):
        """Was it made of these?"""
        given = (free, self.free), (scale * free, self.scale), (shift, self.shift)
        return bulk is self.bulk and all(np.array_equal(*pair) for pair in given)

    def Times(self, u):
        """The free rows of its product, without the springs, with u (n,), zero where not free."""
        product = Multiply([self.mat], u) * self.free
        product[self.springs] -= SPRING * u[self.springs]
        return product

    def Schur(self, columns):
        """Of columns C (n, m), and one more for each spring: a SchurComplement, and C^T K^-1 C."""
        if self._columns is None or not SameMatrix(self._columns, columns):
            unit = UnitColumns(self.springs, len(self.free))
            given = scipy.sparse.hstack([columns, unit], format="csc")
            schur = SchurComplement(self.inverse, given.indptr, given.indices, given.data)
            self._columns, self._schur = columns, (schur, schur.complement)
        return self._schur


def UnitColumns(dofs, n):
    """The columns (n, k) of the unit matrix of k dofs."""
    return scipy.sparse.csc_matrix(
        (np.ones(len(dofs)), (dofs, np.arange(len(dofs)))), (n, len(dofs))
    )
