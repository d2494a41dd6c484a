# SPDX-License-Identifier: LGPL-2.1-or-later
"""Inverse of a matrix that falls into parts which nothing couples, many of them equal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy
from netgen.meshing import NgException

from ngslac._ngslac import SchurComplement
from ngslac.arrays import AsBits, Exported
from ngslac.errors import LinearSolveError
from ngslac.linear.factor import Factor

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

__all__ = ["PartsInverse"]

# Differences relative to the diagonal that are rounding; residual that a solution may leave.
EQUAL, SMALL = 1e-14, 1e-10
# Most parts that are distinguished; most rows of a dense complement.
MOST, MOST_ROWS = 100, 3000


class PartsInverse:
    """Inverse of a symmetric positive definite matrix, as the mass matrix of bodies is.

    The components of a vector in different directions, and on different bodies, know nothing of
    each other. Each of these parts is factored alone, equal ones once.
    """

    def __init__(self, mat: csr_matrix, free: np.ndarray):
        dofs = np.flatnonzero(free & (mat.diagonal() != 0))
        inner = mat[dofs][:, dofs]
        count, part = scipy.sparse.csgraph.connected_components(inner, directed=False)
        if count > MOST:
            count, part = 1, np.zeros(len(dofs), dtype=int)
        order = np.argsort(part, kind="stable")
        inner, ends = inner[order][:, order], np.cumsum(np.bincount(part, minlength=count))
        self._groups = []  # representative matrix, its factors, the dofs of each part
        for first, last in zip(ends - np.bincount(part, minlength=count), ends, strict=True):
            self._Add(inner[first:last, first:last], dofs[order[first:last]])
        self._Check(mat, dofs)

    def _Add(self, mat: csr_matrix, dofs: np.ndarray) -> None:
        """Take a part of the matrix, with factors of its own unless an equal part has some."""
        for other, _, parts in self._groups:
            if AreNear(mat, other):
                parts.append(dofs)
                return
        free = AsBits(np.ones(len(dofs), dtype=bool))
        self._groups.append((mat, Factor(Exported(mat), free, "sparsecholesky"), [dofs]))

    def _Check(self, mat: csr_matrix, dofs: np.ndarray) -> None:
        """The factorisation reports no errors: look at a residual."""
        wanted = np.random.default_rng(3).standard_normal(mat.shape[0])
        left = (mat @ self.Solve(wanted) - wanted)[dofs]
        if not np.linalg.norm(left) <= SMALL * np.linalg.norm(wanted[dofs]):
            raise LinearSolveError("the matrix is singular")

    def Solve(self, values: np.ndarray) -> np.ndarray:
        """The solution (n,) for a right hand side (n,); 0 on other dofs than the free ones."""
        solution = np.zeros(len(values))
        for _, inverse, parts in self._groups:
            right, found = inverse.CreateRowVector(), inverse.CreateColVector()
            for dofs in parts:
                right.FV().NumPy()[:] = values[dofs]
                found.data = inverse * right
                solution[dofs] = found.FV().NumPy()
        return solution

    def Complement(self, rows: csr_matrix) -> np.ndarray | None:
        """B A^-1 B^T of sparse rows B (k, n) as array (k, k); None where it is too large."""
        if rows.shape[0] > MOST_ROWS:
            return None
        total, columns = np.zeros((rows.shape[0],) * 2), rows.tocsc()
        try:
            for _, inverse, parts in self._groups:
                for dofs in parts:
                    own = columns[:, dofs].T.tocsc()
                    used = np.flatnonzero(np.diff(own.indptr))
                    own = own[:, used]
                    schur = SchurComplement(inverse, own.indptr, own.indices, own.data)
                    total[np.ix_(used, used)] += schur.complement
        except NgException:
            return None
        return total


def AreNear(mat: csr_matrix, other: csr_matrix) -> bool:
    """Are two sparse matrices equal to rounding, and their graphs?"""
    if mat.shape != other.shape or not np.array_equal(mat.indptr, other.indptr):
        return False
    if not np.array_equal(mat.indices, other.indices):
        return False
    rows = np.repeat(np.arange(mat.shape[0]), np.diff(mat.indptr))
    sizes = np.sqrt(np.abs(mat.diagonal()))
    allowed = EQUAL * sizes[rows] * sizes[mat.indices]
    return bool(np.all(np.abs(mat.data - other.data) <= allowed))
