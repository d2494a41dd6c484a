# SPDX-License-Identifier: LGPL-2.1-or-later
"""Newton systems on the interface: the bulk is factored once for all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ngslac.errors import LinearSolveError
from ngslac.linear.grounded import SPRING, GroundedBulk, UnitColumns
from ngslac.linear.refine import Refine
from ngslac.linear.system import LinearSystem, Method

if TYPE_CHECKING:
    from ngsolve import BaseMatrix
    from scipy.sparse import csc_matrix, csr_matrix

__all__ = ["Compliance", "DenseFactors", "Interface"]

# Of what is left of rows that are combinations of others, relative to the largest entry.
ROUNDING = 1e-10
# Reciprocal condition number of a singular matrix.
SINGULAR = 1e-14


class Interface(Method):
    """Solves for multipliers first, by the Schur complement of the bulk, then for displacements.

    The bulk K, with springs alpha P P^T on some dofs (`GroundedBulk`), is factored once. With the
    columns C = [G, P] and C^T K^-1 C, which are computed once, too, a system

        u = K^-1 (f - C x),  E u + F lam = g,  x = (lam, -alpha P^T u)

    takes a dense matrix of the closed macro-elements, and a forward and a backward substitution.
    """

    most = 3000  # multipliers: the dense matrix of more costs as much as factors of the bulk

    def __init__(self, dim: int, motions: Callable[[], np.ndarray]):
        self.dim, self.motions = dim, motions
        self.factorisations = self._systems = 0
        self.once = False  # did the last matrix of the bulk serve for one system only?
        self.NewBulk()

    def __str__(self) -> str:
        return "on the interface, the bulk with sparsecholesky, once"

    def NewBulk(self) -> None:
        """The bulk matrix has got other values."""
        self.once = self._systems == 1 or (self.once and not self._systems)
        self._systems, self._fails, self._kept = 0, False, {}

    def State(self) -> dict:
        """What has been learnt about the bulk."""
        return {"once": self.once}

    def SetState(self, state: dict) -> None:
        """Go on with a `State`."""
        self.once = state["once"]

    def Solve(self, system: LinearSystem, b: np.ndarray) -> tuple[np.ndarray, float]:
        """See Method.

        Not for the first system of a matrix if that before served once only: a nonlinear bulk has
        another one each time.
        """
        self._systems += 1
        if self._fails or (self.once and self._systems == 1):
            raise LinearSolveError("the bulk is not factored")
        blocks = Blocks(system, system.free)
        kept = self._Kept(system, blocks)
        interface = InterfaceSystem(kept, blocks, self.dim)
        return Refine(interface.Solve, lambda x: b - blocks.Times(x) - kept.Times(x), b)

    def Compliance(self, system: LinearSystem, b: np.ndarray) -> Compliance:
        """See Method."""
        if self._fails:
            raise LinearSolveError("the bulk is not factored")
        blocks = Blocks(system, system.free)
        return Compliance(self._Kept(system, blocks), blocks, b)

    def _Kept(self, system: LinearSystem, blocks: Blocks) -> GroundedBulk:
        """The GroundedBulk; where bodies slip, systems with and without a shift take turns."""
        displacements = system.free
        displacements[blocks.multipliers] = False
        key = system.shift is not None
        if key not in self._kept or not self._kept[key].Fits(system, displacements):
            self._kept.pop(key, None)  # two of them would need twice the memory
            self._fails = True
            if len(blocks.multipliers) > self.most:
                raise LinearSolveError("the interface is large")
            self.factorisations += 1
            kept = GroundedBulk(system, displacements, self.motions())
            kept.Schur(blocks.forces)
            self._kept[key], self._fails = kept, False
        return self._kept[key]


class Compliance:
    """How the bulk follows what acts on the interface: C^T u = start - matrix x.

    Attributes
    ----------
    matrix : (k, k) array
        C^T K^-1 C of all multipliers, and of the springs after them.
    start : (k,) array
        C^T u under the right side alone.
    spring : float
        Stiffness of these springs.
    """

    spring = SPRING

    def __init__(self, kept: GroundedBulk, blocks: Blocks, b: np.ndarray):
        self.multipliers = blocks.multipliers
        self.schur, self.matrix = kept.Schur(blocks.forces)
        self._begin = self.schur.Forward(b)
        self.start = self.schur.Trace(self._begin)

    def Solution(self, x: np.ndarray) -> np.ndarray:
        """The solution (n,), multipliers included, with x (k,)."""
        solution = self.schur.Solve(self._begin, x)
        solution[self.multipliers] = x[: len(self.multipliers)]
        return solution


class InterfaceSystem:
    """K u + C x = f, E u + F lam = g with x = (lam, S u, -alpha P^T u), see `Interface`.

    The rows of E are combinations of the columns of C, or are appended to these.
    """

    def __init__(self, kept: GroundedBulk, blocks: Blocks, d: int):
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

    def _Factor(self, own: np.ndarray) -> None:
        """Scale and factor the dense matrix of closed macro-elements, springs and other rows."""
        matrix = -self._Constrained(self.complement[:, self.used])
        rows = np.arange(self.closed.size).reshape(self.closed.shape)
        matrix[rows[:, :, None], rows[:, None]] += own
        others = np.arange(rows.size, len(matrix))
        matrix[others, others] += 1
        self.factors = DenseFactors.Of(matrix)
        if self.factors is None:
            raise LinearSolveError("the interface is singular")

    def _Constrained(self, values: np.ndarray) -> np.ndarray:
        """Rows of the closed macro-elements, of S and of the springs from C^T u (k, ...)."""
        if self.weights is None:
            rows = values[self.touched.size + len(self.blocks.multipliers) :][: self.closed.size]
        else:
            means = values[self.closed].reshape(*self.closed.shape, values[0].size)
            rows = (self.weights @ means).reshape(self.closed.size, *values.shape[1:])
        added = -self.stiffness @ values[self.touched]
        return np.concatenate([rows, added, SPRING * values[self.springs]])

    def Solve(self, rhs: np.ndarray) -> np.ndarray:
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
            x[self.used] = self.factors.Solve(right)
        solution = self.schur.Solve(start, x)
        solution[self.blocks.multipliers] = x[: len(own)]
        return solution


class DenseFactors:
    """Of a dense matrix whose rows are scaled."""

    def __init__(self, factors: tuple, scale: np.ndarray):
        self._factors, self._scale = factors, scale

    @classmethod
    def Of(cls, matrix: np.ndarray) -> DenseFactors | None:
        """Of a matrix (n, n); None if it is singular."""
        scale = 1 / np.maximum(np.abs(matrix).max(axis=1, initial=0), np.finfo(float).tiny)
        matrix = matrix * scale[:, None]
        if not np.all(np.isfinite(matrix)):
            return None
        norm = np.abs(matrix).sum(axis=0).max(initial=0)
        if not len(matrix):
            return cls((), scale)
        factors = scipy.linalg.lu_factor(matrix, check_finite=False)
        regular = scipy.linalg.lapack.dgecon(factors[0], norm)[0] > SINGULAR
        return cls(factors, scale) if regular else None

    def Solve(self, right: np.ndarray) -> np.ndarray:
        """The solution (n,)."""
        if not len(right):
            return right
        return scipy.linalg.lu_solve(self._factors, self._scale * right, check_finite=False)


class Blocks:
    """(K + S) u + G lam = f, E u + F lam = g, scaled."""

    def __init__(self, system: LinearSystem, free: np.ndarray):
        n = len(free)
        self.multipliers = np.asarray(system.multipliers)  # (m,): their dofs
        m = len(self.multipliers)
        number = np.full(n, -1)
        number[self.multipliers] = np.arange(m)
        row, column, value = self._Entries(system.contacts, system.scale, free)
        k, j = number[row], number[column]
        on, by, both = (k < 0) & (j >= 0), (k >= 0) & (j < 0), (k >= 0) & (j >= 0)
        apart = (k < 0) & (j < 0)
        # S (n, n), which contacts add to K, as in large sliding; G (n, m), E (m, n); F (m, m) that
        # has 1 on the diagonal of what is not free.
        self.stiffness = scipy.sparse.csr_matrix(
            (value[apart], (row[apart], column[apart])), shape=(n, n)
        )
        self.touched = np.union1d(row[apart], column[apart])  # dofs of S
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
    def _Entries(
        contacts: Sequence[BaseMatrix], scale: np.ndarray, free: np.ndarray
    ) -> Iterator[np.ndarray]:
        """Rows, columns and values of the sum of all contacts, without zeros."""
        found = []
        for contact in contacts:
            values, columns, starts = (np.asarray(a) for a in contact.CSR())
            rows = np.repeat(np.arange(len(scale)), np.diff(starts.astype(np.int64)))
            values = scale[rows] * values * scale[columns]
            used = (values != 0) & free[rows] & free[columns]
            found.append((rows[used], columns[used], values[used]))
        return (np.concatenate(part) for part in zip(*found, strict=True))

    def Times(self, x: np.ndarray) -> np.ndarray:
        """The product (n,) of the matrix without K with x (n,)."""
        multipliers = x[self.multipliers]
        product = self.forces @ multipliers + self.stiffness @ x
        product[self.multipliers] = self.rows @ x + self.own @ multipliers
        return product

    def Own(self, d: int) -> np.ndarray:
        """The blocks (k, d, d) of macro-elements on the diagonal of F, which has no others."""
        blocks = DiagonalBlocks(self.own, d)
        if np.count_nonzero(blocks) < self.own.count_nonzero():
            raise LinearSolveError("macro-elements have conditions with each other")
        return blocks


def Weights(rows: csr_matrix, forces: csc_matrix, d: int) -> np.ndarray | None:
    """T with rows = T forces^T for the d rows of each macro-element: (k, d, d) or None."""
    products = DiagonalBlocks(rows @ forces, d)
    squares = DiagonalBlocks(forces.T @ forces, d)
    weights = products @ np.linalg.pinv(squares, rcond=ROUNDING, hermitian=True)
    left = np.abs((rows - BlockDiagonal(weights) @ forces.T).data).max(initial=0)
    return weights if left <= ROUNDING * np.abs(rows.data).max(initial=0) else None


def BlockDiagonal(blocks: np.ndarray) -> csr_matrix:
    """A sparse matrix of blocks (k, d, d)."""
    k, d, _ = blocks.shape
    shape = k * d, k * d
    return scipy.sparse.bsr_matrix((blocks, np.arange(k), np.arange(k + 1)), shape).tocsr()


def DiagonalBlocks(mat: csr_matrix, d: int) -> np.ndarray:
    """(k, d, d): those of a sparse matrix of k x k blocks."""
    mat = mat.tocoo()
    inside = mat.row // d == mat.col // d
    row, column = mat.row[inside], mat.col[inside]
    blocks = np.zeros((mat.shape[0] // d, d, d))
    np.add.at(blocks, (row // d, row % d, column % d), mat.data[inside])
    return blocks
