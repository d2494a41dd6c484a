# SPDX-License-Identifier: LGPL-2.1-or-later
"""Linear systems of the displacements alone."""

import numpy as np

from ngslac.arrays import AsBits
from ngslac.linear.factor import LU, Cholesky, Factor, IsSymmetric
from ngslac.linear.solver import LinearSolver

__all__ = ["PrimalSolver"]


class PrimalSolver(LinearSolver):
    """Direct solver of the displacements alone, which keeps its factorisation of the same matrix.

    For the springs of the interior point method.

    Parameters
    ----------
    linear : LinearSolver
        Knows the free dofs, also those of the multipliers.
    inverse : str or None
        For symmetric matrices; default: the fastest. Others go to that of `ContactSolver`.

    Attributes
    ----------
    contacts : list[BaseMatrix]
        What the contacts add to the bulk's matrix.
    symmetric : bool
        Is the sum so?
    """

    def __init__(self, linear, inverse):
        self.wanted = inverse or Cholesky()
        super().__init__(linear.freedofs, self.wanted)
        self.contacts, self.symmetric = [], True
        self.Forget()

    def __str__(self):
        return f"linear systems: displacements alone, with {self.wanted}"

    def Forget(self):
        """Factor the next matrix anew."""
        self._kept = None

    def Leave(self, rows):
        """Leave out the multipliers, a (n,) array of bool."""
        self.bits &= AsBits(~rows)

    def Solve(self, bulk, forms, scale, rhs, shift=None, accuracy=0.0):
        """As LinearSolver, with the matrices `contacts` in place of the forms."""
        self.symmetric = all(map(IsSymmetric, (bulk, *self.contacts)))
        self.inverse = self.wanted if self.symmetric else LU()
        self.NewBulk()  # a matrix that is kept must not be changed
        return super().Solve(bulk, forms, scale, rhs, shift)

    def _Matrices(self, _):
        return self.contacts

    def _Factor(self, mat, inverse):
        if self._kept and self._kept[1] == inverse and SameMatrix(self._kept[0], mat):
            return self._kept[2]
        inv = Factor(mat, self.bits, inverse, symmetric=self.symmetric)
        self._kept = mat, inverse, inv  # the factorisation dies with the matrix
        return inv


def SameMatrix(one, other):
    """Do they differ by rounding only?"""
    (values, columns, starts), (others, *graph) = one.CSR(), other.CSR()
    return (
        len(values) == len(others)
        and np.array_equal(columns, graph[0])
        and np.array_equal(starts, graph[1])
        and np.allclose(values, others, rtol=0, atol=1e-14 * np.abs(values).max())
    )
