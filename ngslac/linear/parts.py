"""Inverse of a matrix that falls into parts which nothing couples, many of them equal."""

import numpy as np
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from ngslac.linear.factor import LinearSolveError

__all__ = ["PartsInverse"]

# Differences relative to the diagonal that are rounding; residual that a solution may leave.
EQUAL, SMALL = 1e-14, 1e-10
# Of SuperLU: without pivoting.
SYMMETRIC = {
    "permc_spec": "MMD_AT_PLUS_A",
    "diag_pivot_thresh": 0.0,
    "options": {"SymmetricMode": True},
}
# More parts than this are not told apart.
MOST = 100


class PartsInverse:
    """Inverse of a symmetric positive definite matrix, as the mass matrix of bodies is.

    The components of a vector in different directions, and on different bodies, know nothing of
    each other. Each of these parts is factored alone, equal ones once, and solved for all its
    right hand sides at the same time.

    Parameters
    ----------
    mat : (n, n) scipy.sparse.csr_matrix
        Without entries that are zero.
    free : (n,) bool
        Its dofs; others, and those with a zero diagonal, stay zero.

    Raises
    ------
    LinearSolveError
        The matrix is singular.
    """

    def __init__(self, mat, free):
        dofs = np.flatnonzero(free & (mat.diagonal() != 0))
        inner = mat[dofs][:, dofs]
        count, part = connected_components(inner, directed=False)
        if count > MOST:
            count, part = 1, np.zeros(len(dofs), dtype=int)
        order = np.argsort(part, kind="stable")
        inner, ends = inner[order][:, order], np.cumsum(np.bincount(part, minlength=count))
        self._groups = []  # representative matrix, its factors, the dofs of each part
        for first, last in zip(ends - np.bincount(part, minlength=count), ends, strict=True):
            self._Add(inner[first:last, first:last], dofs[order[first:last]])
        self._Check(mat, dofs)

    def _Add(self, mat, dofs):
        for other, _, parts in self._groups:
            if AreEqual(mat, other):
                parts.append(dofs)
                return
        try:
            factors = splu(mat.tocsc(), **SYMMETRIC)
        except RuntimeError as error:
            raise LinearSolveError(f"the matrix is singular: {error}") from error
        self._groups.append((mat, factors, [dofs]))

    def _Check(self, mat, dofs):
        """Pivots were not looked for: look at a residual."""
        wanted = np.random.default_rng(3).standard_normal(mat.shape[0])
        left = (mat @ self.Solve(wanted) - wanted)[dofs]
        if not np.linalg.norm(left) <= SMALL * np.linalg.norm(wanted[dofs]):
            raise LinearSolveError("the matrix is singular")

    def Solve(self, values):
        """The solution (n,) for a right hand side (n,); 0 on other dofs than the free ones."""
        solution = np.zeros(len(values))
        for _, factors, parts in self._groups:
            dofs = np.stack(parts, axis=1)
            solution[dofs] = factors.solve(np.asfortranarray(values[dofs]))
        return solution


def AreEqual(mat, other):
    """Are two sparse matrices equal to rounding, and their graphs?"""
    if mat.shape != other.shape or not np.array_equal(mat.indptr, other.indptr):
        return False
    if not np.array_equal(mat.indices, other.indices):
        return False
    rows = np.repeat(np.arange(mat.shape[0]), np.diff(mat.indptr))
    sizes = np.sqrt(np.abs(mat.diagonal()))
    allowed = EQUAL * sizes[rows] * sizes[mat.indices]
    return bool(np.all(np.abs(mat.data - other.data) <= allowed))
