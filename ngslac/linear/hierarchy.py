# SPDX-License-Identifier: LGPL-2.1-or-later
"""Algebraic multigrid by smoothed aggregation of nodes, with a setup that is reused."""

from collections.abc import Sequence

import numpy as np
from ngsolve import BaseMatrix, BaseVector, CreateVVector
from pyamg.aggregation.aggregate import standard_aggregation
from pyamg.aggregation.tentative import fit_candidates
from pyamg.relaxation.relaxation import block_gauss_seidel
from pyamg.strength import symmetric_strength_of_connection
from pyamg.util.utils import get_block_diag
from scipy.sparse import bsr_matrix, csr_array, diags_array
from scipy.sparse.linalg import splu

from ngslac.errors import LinearSolveError

__all__ = ["Hierarchy", "VCycle"]

# Smallest coupling of two nodes of an aggregate, relative to their own stiffness.
STRONG = 0.03
# Unknowns that are left to a factorisation.
COARSEST = 2000
# Cycles one after the other: a second one saves a quarter of the iterations on blocks.
CYCLES = 2
MOST_LEVELS = 12
# Changes of a matrix that are rounding errors, relative to its largest entries.
ROUNDING = 1e-13
# Vectors are empty where they are smaller than this part of their size before.
EMPTY = 1e-8


class Hierarchy:
    """Smoothed aggregation (Vanek, Mandel, Brezina 1996) on blocks of nodes.

    Rigid motions are functions of each level. Aggregates and prolongations are learnt from one
    matrix; the matrices of all levels follow from any other one with the same rows.
    """

    def __init__(self, mat: bsr_matrix, modes: np.ndarray, fewest: int = 0):
        self._products = []
        while len(self._products) < MOST_LEVELS and (
            mat.shape[0] > COARSEST or len(self._products) < fewest
        ):
            found, modes = Prolongation(mat, modes)
            if not 0 < found.shape[1] < 0.8 * mat.shape[0]:
                break
            self._products.append(Galerkin(mat, found))
            mat = self._products[-1].Coarse(mat)

    @property
    def prolongations(self) -> list[bsr_matrix]:
        """To each level but the last from the one below."""
        return [product.prolongation for product in self._products]

    def Matrices(self, mat: bsr_matrix, rows: np.ndarray | None = None) -> list[bsr_matrix]:
        """Of all levels, the finest one first, which has to hold only the `rows` that changed."""
        matrices = [mat]
        for product in self._products:
            matrices.append(product.Coarse(matrices[-1], rows))
            rows = None
        return matrices


class Galerkin:
    """Products P^T A P of matrices that differ from the first one in some rows: these alone cost.

    Images of a random vector show which rows these are.
    """

    def __init__(self, mat: bsr_matrix, prolongation: bsr_matrix):
        self.prolongation, self._probe = prolongation, Probe(mat.shape[1])
        self._image, self._product = self._Image(mat), mat @ prolongation
        self._coarse = Restricted(prolongation, self._product)

    def Coarse(self, mat: bsr_matrix, rows: np.ndarray | None = None) -> bsr_matrix:
        """P^T A P, with a unit where an aggregate is too small for all of the modes."""
        coarse, rows = self._coarse, self._Changed(mat) if rows is None else rows
        if len(rows):
            change = Rows(mat, rows) @ self.prolongation - Rows(self._product, rows)
            coarse = coarse + Restricted(Rows(self.prolongation, rows), change)
        return Filled(coarse)

    def _Changed(self, mat: bsr_matrix) -> np.ndarray:
        """The rows that are not those of the first matrix."""
        change = np.abs(self._Image(mat) - self._image).max(axis=1)
        return np.flatnonzero(change > ROUNDING * np.abs(self._image).max(initial=0.0))

    def _Image(self, mat: bsr_matrix) -> np.ndarray:
        return (mat @ self._probe).reshape(-1, mat.blocksize[0])


def Prolongation(mat: bsr_matrix, modes: np.ndarray) -> tuple[bsr_matrix, np.ndarray]:
    """From aggregates to nodes, smoothed, and the modes of the aggregates."""
    strength = symmetric_strength_of_connection(mat, STRONG)
    aggregates, _ = standard_aggregation(strength)
    tentative, coarse = fit_candidates(aggregates, modes, tol=EMPTY)
    inverse = BlockDiagonal(mat)
    omega = 4 / 3 / SpectralRadius(mat, inverse)
    return bsr_matrix(tentative - omega * (inverse @ (mat @ tentative))), coarse


def BlockDiagonal(mat: bsr_matrix) -> bsr_matrix:
    """The inverse of the blocks on the diagonal, as matrix."""
    blocks = get_block_diag(mat, mat.blocksize[0], inv_flag=True)
    count = len(blocks)
    return bsr_matrix((blocks, np.arange(count), np.arange(count + 1)), shape=mat.shape)


def SpectralRadius(mat: bsr_matrix, inverse: bsr_matrix) -> float:
    """Of the inverse times the matrix, by power iteration: up to some per cent too small."""
    x, radius = Probe(mat.shape[0]), 1.0
    for _ in range(10):
        x = inverse @ (mat @ (x / np.linalg.norm(x)))
        radius = np.linalg.norm(x)
    return 1.1 * radius


def Restricted(prolongation: bsr_matrix, product: bsr_matrix) -> bsr_matrix:
    """P^T times a matrix."""
    return prolongation.T.tobsr(blocksize=prolongation.blocksize[::-1]) @ product


def Filled(mat: bsr_matrix) -> bsr_matrix:
    """The matrix with a unit where its diagonal is empty."""
    diagonal = mat.diagonal()
    empty = diagonal <= EMPTY * np.max(diagonal, initial=0.0)
    if not np.any(empty):
        return mat
    return mat + diags_array(empty.astype(float)).tobsr(blocksize=mat.blocksize)


def Rows(mat: bsr_matrix, rows: np.ndarray) -> bsr_matrix:
    """Some rows of blocks of a bsr_matrix."""
    first, count = mat.indptr[rows], np.diff(mat.indptr)[rows]
    starts = np.concatenate([[0], np.cumsum(count)])
    places = np.arange(starts[-1]) + np.repeat(first - starts[:-1], count)
    shape = len(rows) * mat.blocksize[0], mat.shape[1]
    return bsr_matrix((mat.data[places], mat.indices[places], starts), shape=shape)


def Probe(size: int) -> np.ndarray:
    """A random vector."""
    return np.random.default_rng(0).standard_normal(size)


class VCycle(BaseMatrix):
    """Gauss-Seidel sweeps by nodes on each level, a factorisation on the coarsest one.

    `onto` is a sparse matrix from the finest level to what residuals and corrections are given on.
    """

    def __init__(
        self,
        prolongations: Sequence[bsr_matrix],
        matrices: Sequence[bsr_matrix],
        onto: bsr_matrix | csr_array,
    ):
        super().__init__()
        self.size, self._onto, self._from = onto.shape[0], onto, onto.T.asformat(onto.format)
        self._transfers = [(prolongation, prolongation.T.tocsr()) for prolongation in prolongations]
        self.Take(matrices)

    def Take(self, matrices: Sequence[bsr_matrix]) -> None:
        """Cycles for these matrices from now on."""
        self._levels = [
            (mat, *Triangles(mat), *transfer, Inverses(mat))
            for mat, transfer in zip(matrices, self._transfers, strict=False)
        ]
        options = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0}
        try:
            coarsest = matrices[-1].tocsc()
            self._coarsest = splu(coarsest, options={"SymmetricMode": True}, **options)
        except RuntimeError as error:
            raise LinearSolveError(f"multigrid: {error}") from error

    def IsComplex(self) -> bool:
        return False

    def Height(self) -> int:
        return self.size

    def Width(self) -> int:
        return self.size

    def CreateColVector(self) -> BaseVector:
        return CreateVVector(self.size)

    CreateRowVector = CreateColVector

    def Mult(self, x: BaseVector, y: BaseVector) -> None:
        rhs = self._from @ x.FV().NumPy()
        solution = self._Cycle(0, rhs)
        for _ in range(CYCLES - 1 if self._levels else 0):
            solution += self._Cycle(0, rhs - self._levels[0][0] @ solution)
        y.FV().NumPy()[:] = self._onto @ solution

    def _Cycle(self, level: int, rhs: np.ndarray) -> np.ndarray:
        """The correction on a level for what is left there, from those below."""
        if level == len(self._levels):
            return self._coarsest.solve(rhs)
        mat, lower, upper, prolongation, restriction, inverses = self._levels[level]
        smooth = {"blocksize": mat.blocksize[0], "Dinv": inverses}
        x = np.zeros_like(rhs)
        # From zero the sweep solves with the lower triangle: what is left is the upper one's part.
        block_gauss_seidel(lower, x, rhs, sweep="forward", **smooth)
        x -= prolongation @ self._Cycle(level + 1, restriction @ (upper @ x))
        block_gauss_seidel(mat, x, rhs, sweep="backward", **smooth)
        return x


def Triangles(mat: bsr_matrix) -> list[bsr_matrix]:
    """The blocks up to the diagonal, and those above it: two of bsr_matrix."""
    rows = np.repeat(np.arange(len(mat.indptr) - 1), np.diff(mat.indptr))
    return [Selected(mat, rows, which) for which in (mat.indices <= rows, mat.indices > rows)]


def Selected(mat: bsr_matrix, rows: np.ndarray, which: np.ndarray) -> bsr_matrix:
    """Some of the blocks, whose rows are given."""
    counts = np.bincount(rows[which], minlength=len(mat.indptr) - 1)
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(mat.indptr.dtype)
    return bsr_matrix((mat.data[which], mat.indices[which], starts), shape=mat.shape)


def Inverses(mat: bsr_matrix) -> np.ndarray:
    """(n, k, k) array: of the blocks on the diagonal."""
    return get_block_diag(mat, mat.blocksize[0], inv_flag=True)
