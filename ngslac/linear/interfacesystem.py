# SPDX-License-Identifier: LGPL-2.1-or-later
"""One Newton system as a dense one of its closed macro-elements."""

import numpy as np
import scipy

from ngslac.linear.blocks import Weights
from ngslac.linear.factor import LinearSolveError
from ngslac.linear.grounded import SPRING, UnitColumns

__all__ = ["InterfaceSystem"]

# Reciprocal condition number of a singular matrix.
SINGULAR = 1e-14


class InterfaceSystem:
    """K u + C x = f, E u + F lam = g with x = (lam, S u, -alpha P^T u), see `Interface`.

    The rows of E are combinations of the columns of C, or are appended to these.

    Parameters
    ----------
    kept : GroundedBulk
    blocks : Blocks
    d : int
        Multipliers of a macro-element.

    Raises
    ------
    LinearSolveError
        The system is singular.
    """

    def __init__(self, kept, blocks, d):
        self.blocks, own = blocks, blocks.Own(d)
        m = len(blocks.multipliers)
        numbers = np.arange(m).reshape(-1, d)
        closed = np.diff(blocks.rows.indptr).reshape(-1, d).any(axis=1)
        self.closed, self.open, self.free = numbers[closed], numbers[~closed], own[~closed]
        self.weights = Weights(blocks.rows, blocks.forces, d)
        columns = [blocks.forces, UnitColumns(blocks.touched, len(kept.free))]
        if self.weights is None:
            columns.append(blocks.rows[self.closed.ravel()].T)
        else:
            self.weights = self.weights[closed]
        self.schur, self.complement = kept.Schur(scipy.sparse.hstack(columns, format="csc"))
        self.touched = np.arange(m, m + len(blocks.touched))
        self.stiffness = blocks.stiffness[blocks.touched][:, blocks.touched]
        count = len(self.complement)
        self.springs = np.arange(count - len(kept.springs), count)
        # Unknowns of the dense system, as columns of the complement.
        self.used = np.concatenate([self.closed.ravel(), self.touched, self.springs])
        self._Factor(own[closed])

    def _Factor(self, own):
        matrix = -self._Constrained(self.complement[:, self.used])
        rows = np.arange(self.closed.size).reshape(self.closed.shape)
        matrix[rows[:, :, None], rows[:, None]] += own
        others = np.arange(rows.size, len(matrix))
        matrix[others, others] += 1
        self.scale = 1 / np.maximum(np.abs(matrix).max(axis=1, initial=0), np.finfo(float).tiny)
        matrix *= self.scale[:, None]
        if len(matrix):
            norm = np.abs(matrix).sum(axis=0).max()
            self.factors = scipy.linalg.lu_factor(matrix, check_finite=False)
            if not scipy.linalg.lapack.dgecon(self.factors[0], norm)[0] > SINGULAR:
                raise LinearSolveError("the interface is singular")

    def _Constrained(self, values):
        """Rows of the closed macro-elements, of S and of the springs from C^T u (k, ...)."""
        if self.weights is None:
            rows = values[self.touched.size + len(self.blocks.multipliers) :][: self.closed.size]
        else:
            means = values[self.closed].reshape(*self.closed.shape, values[0].size)
            rows = (self.weights @ means).reshape(self.closed.size, *values.shape[1:])
        added = -self.stiffness @ values[self.touched]
        return np.concatenate([rows, added, SPRING * values[self.springs]])

    def Solve(self, rhs):
        """The solution (n,) of the whole system."""
        own, x = rhs[self.blocks.multipliers], np.zeros(len(self.complement))
        x[self.open] = np.linalg.solve(self.free, own[self.open][:, :, None])[:, :, 0]
        start = self.schur.Forward(rhs)
        trace = self.schur.Trace(start)
        if np.any(x):
            trace -= self.complement @ x
        if len(self.used):
            right = -self._Constrained(trace)
            right[: self.closed.size] += own[self.closed].ravel()
            x[self.used] = scipy.linalg.lu_solve(
                self.factors, self.scale * right, check_finite=False
            )
        solution = self.schur.Solve(start, x)
        solution[self.blocks.multipliers] = x[: len(own)]
        return solution
