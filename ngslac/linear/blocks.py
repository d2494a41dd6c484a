# SPDX-License-Identifier: LGPL-2.1-or-later
"""The blocks of a Newton system: what contacts add to the matrix of the bulk."""

import numpy as np
import scipy

from ngslac.linear.factor import LinearSolveError

__all__ = ["Blocks", "Weights"]

# Of what is left of rows that are combinations of others, relative to the largest entry.
ROUNDING = 1e-10


class Blocks:
    """(K + S) u + G lam = f, E u + F lam = g, scaled.

    Parameters
    ----------
    system : LinearSystem
    free : (n,) bool

    Attributes
    ----------
    multipliers : (m,) int
        Their dofs, d in a row for each macro-element.
    forces : (n, m) csc_matrix
        G, with the rows of the whole system.
    rows : (m, n) csr_matrix
        E, with its columns.
    own : (m, m) csr_matrix
        F; 1 on the diagonal of what is not free.
    stiffness : (n, n) csr_matrix
        What contacts add to K, as in large sliding.
    touched : (k,) int
        The dofs of this.
    """

    def __init__(self, system, free):
        n = len(free)
        self.multipliers = np.asarray(system.multipliers)
        m = len(self.multipliers)
        number = np.full(n, -1)
        number[self.multipliers] = np.arange(m)
        row, column, value = self._Entries(system.contacts, system.scale, free)
        k, j = number[row], number[column]
        on, by, both = (k < 0) & (j >= 0), (k >= 0) & (j < 0), (k >= 0) & (j >= 0)
        apart = (k < 0) & (j < 0)
        self.stiffness = scipy.sparse.csr_matrix(
            (value[apart], (row[apart], column[apart])), shape=(n, n)
        )
        self.touched = np.union1d(row[apart], column[apart])
        held = np.flatnonzero(~free[self.multipliers])
        self.forces = scipy.sparse.csc_matrix((value[on], (row[on], j[on])), shape=(n, m))
        self.rows = scipy.sparse.csr_matrix((value[by], (k[by], column[by])), shape=(m, n))
        self.own = scipy.sparse.csr_matrix(
            (
                np.concatenate([value[both], np.ones(len(held))]),
                (np.concatenate([k[both], held]), np.concatenate([j[both], held])),
            ),
            shape=(m, m),
        )

    @staticmethod
    def _Entries(contacts, scale, free):
        """Rows, columns and values of the sum of all contacts, without zeros."""
        found = []
        for contact in contacts:
            values, columns, starts = (np.asarray(a) for a in contact.CSR())
            rows = np.repeat(np.arange(len(scale)), np.diff(starts.astype(np.int64)))
            values = scale[rows] * values * scale[columns]
            used = (values != 0) & free[rows] & free[columns]
            found.append((rows[used], columns[used], values[used]))
        return (np.concatenate(part) for part in zip(*found, strict=True))

    def Times(self, x):
        """The product (n,) of the matrix without K with x (n,)."""
        multipliers = x[self.multipliers]
        product = self.forces @ multipliers + self.stiffness @ x
        product[self.multipliers] = self.rows @ x + self.own @ multipliers
        return product

    def Own(self, d):
        """The blocks (k, d, d) of macro-elements on the diagonal of F, which has no others."""
        blocks = DiagonalBlocks(self.own, d)
        if np.count_nonzero(blocks) < self.own.count_nonzero():
            raise LinearSolveError("macro-elements have conditions with each other")
        return blocks


def Weights(rows, forces, d):
    """T with rows = T forces^T for the d rows of each macro-element: (k, d, d) or None."""
    products = DiagonalBlocks(rows @ forces, d)
    squares = DiagonalBlocks(forces.T @ forces, d)
    weights = products @ np.linalg.pinv(squares, rcond=ROUNDING, hermitian=True)
    left = np.abs((rows - BlockDiagonal(weights) @ forces.T).data).max(initial=0)
    return weights if left <= ROUNDING * np.abs(rows.data).max(initial=0) else None


def BlockDiagonal(blocks):
    """A sparse matrix of blocks (k, d, d)."""
    k, d, _ = blocks.shape
    where = np.arange(k * d).reshape(k, d)
    rows = np.broadcast_to(where[:, :, None], blocks.shape)
    columns = np.broadcast_to(where[:, None], blocks.shape)
    return scipy.sparse.csr_matrix(
        (blocks.ravel(), (rows.ravel(), columns.ravel())), (k * d, k * d)
    )


def DiagonalBlocks(mat, d):
    """(k, d, d): those of a sparse matrix of k x k blocks."""
    mat = mat.tocoo()
    inside = mat.row // d == mat.col // d
    row, column = mat.row[inside], mat.col[inside]
    blocks = np.zeros((mat.shape[0] // d, d, d))
    np.add.at(blocks, (row // d, row % d, column % d), mat.data[inside])
    return blocks
