# SPDX-License-Identifier: LGPL-2.1-or-later
"""The eigenvalue problem of small vibrations, and how it is solved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import scipy
from scipy.sparse.linalg import ArpackError, LinearOperator, eigs, eigsh

from ngslac.analysis.tangent import Factors, Tangent
from ngslac.errors import LinearSolveError

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

__all__ = ["GROWS", "WRONG", "Pencil"]

# Shifts, over the square of the highest frequency that the mesh knows: where bodies float 0 fails.
SHIFTS = (0.0, 1e-12, 1e-9, 1e-6)
# Squares of frequencies, over the rounding in the product with the stiffness, that are zero.
ROUNDING = 100 * np.finfo(float).eps
# Difference of a matrix from its transpose, relative to its size, that is rounding.
SYMMETRIC = 1e-11
# Relative residual of an eigenpair that is no eigenpair; growth over the size of an eigenvalue.
WRONG, GROWS = 1e-6, 1e-6
# So many dofs are dense algebra. Squares of frequencies beyond the highest one: constraints.
SMALL, BEYOND = 300, 1e4
# Accuracy of ARPACK, the least size of its space, and how often that is made anew.
ACCURATE, LEAST_SPACE, MOST_ROUNDS = 1e-11, 30, 300
# Dofs for each mode up to which dense algebra is as fast.
DENSE = 4
# Relative difference of copies of an eigenvalue, how often more of them are looked for, and the
# relative square of vectors that depend on others.
COPY, MOST_COPIES, DEPENDENT = 1e-8, 100, 1e-12


@dataclass(frozen=True)
class Pencil:
    """The eigenvalue problem  (K + lambda D + lambda^2 M) x = 0  on the free dofs; D may be None.

    `heavy` (n,) bool: free dofs that have mass; `highest`: about the square of the highest
    frequency that the mesh knows.
    """

    K: object
    D: object
    M: object
    heavy: np.ndarray
    tangent: Tangent
    symmetric: bool
    highest: float

    @classmethod
    def Of(cls, tangent: Tangent, mass: csr_matrix, dampings: list[csr_matrix]) -> Pencil:
        """That of a Tangent, a mass matrix and a list of damping matrices."""
        keep, units = (scipy.sparse.diags(x.astype(float)) for x in (tangent.free, tangent.scale))
        D = (keep @ sum(dampings) @ keep).tocsr() if dampings else None
        M, K = ((keep @ mat @ keep).tocsr() for mat in (mass, tangent.matrix))
        scaled = units @ K @ units
        symmetric = abs(scaled - scaled.T).max() <= SYMMETRIC * abs(scaled).max()
        heavy = M.diagonal() > 0
        highest = np.max(np.abs(tangent.bulk.diagonal()[heavy]) / M.diagonal()[heavy])
        return cls(K, D, M, heavy, tangent, bool(symmetric), float(highest))

    def Modes(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Eigenvalues (k,) of the lowest frequencies, and vectors; one more may be there."""
        squares, vectors, lowest = self._First(count + 1)
        if self.D is None:
            values = 1j * np.sqrt(squares.astype(complex))
            values = np.where(values.imag == 0, np.abs(values.real), values)  # both of +-
        else:
            values, vectors = self._Damped(np.sqrt(lowest), count)
        values, vectors = self._Lowest(values, vectors, count)
        return values, self._Normal(vectors)

    def _First(self, count: int) -> tuple[np.ndarray, np.ndarray, float]:
        """As `_Squares`, with the lowest one that is not zero, by a shift of its size if not 0."""
        for share in SHIFTS:
            try:
                squares, vectors = self._Squares(share * self.highest, count)
                lowest = np.min(np.abs(squares[squares != 0]), initial=np.inf)
                lowest = float(min(lowest, SHIFTS[-1] * self.highest))
                return *(self._Squares(lowest, count) if share else (squares, vectors)), lowest
            except LinearSolveError as error:
                failure = error
        raise failure

    def _Squares(self, shift: float, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Squares of angular frequencies without damping, nearest to zero, and vectors."""
        factors = Factors(self.K + shift * self.M, self.tangent.free, self.tangent.scale)
        if self._IsSmall(count):
            found, vectors = self._Dense(factors, count)
        else:

            def Some(
                project: Callable[[np.ndarray], np.ndarray], number: int, seed: int
            ) -> tuple[np.ndarray, np.ndarray]:
                """As many as `number`, without those that are projected out."""
                start = self.tangent.scale * Random(len(self.heavy), seed)
                inverse = LinearOperator(self.K.shape, lambda f: project(factors.Solve(f)))
                options = {"sigma": -shift, "OPinv": inverse, "v0": inverse @ (self.M @ start)}
                method = eigsh if self.symmetric else eigs
                squares, vectors = Tried(method, self.K, number, self.M, **options)
                return 1 / (squares + shift), vectors

            def Apply(vectors: np.ndarray) -> np.ndarray:
                return factors.Solve(self.M @ vectors)

            known = Apply, lambda vectors: self.M @ vectors
            found, vectors = WithCopies(Some, *known, count, symmetric=self.symmetric)
        squares = 1 / found - shift
        return np.where(np.abs(squares) <= self._Zero(vectors), 0.0, squares), vectors

    def _IsSmall(self, count: int) -> bool:
        """Is dense algebra as fast?"""
        return np.count_nonzero(self.heavy) <= max(SMALL, DENSE * count)

    def _Dense(self, factors: Factors, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Inverse squares with the shift added, by dense algebra on what has mass."""
        heavy = self.heavy
        moved, mass = factors.Solve(self.M[:, heavy].toarray()), self.M[heavy][:, heavy].toarray()
        if self.symmetric:
            found, parts = scipy.linalg.eigh(mass @ moved[heavy], mass)
        else:
            found, parts = scipy.linalg.eig(moved[heavy])
        first = np.argsort(-np.abs(found))[:count]
        first = first[found[first] != 0]
        return found[first], moved @ parts[:, first] / found[first]

    def _Damped(self, shift: float, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Eigenvalues with damping near a real one, and vectors: of (x, lambda x / shift)."""
        n, scale, move = len(self.heavy), self.tangent.scale, self.D + shift * self.M
        factors = Factors(self.K + shift * move, self.tangent.free, scale)

        def Inverse(z: np.ndarray) -> np.ndarray:
            x, y = np.split(z, 2)
            x, y = (x.T * scale).T, shift * (y.T * scale).T
            moved = -factors.Solve(self.M @ y + move @ x)
            return np.concatenate([moved, (x + shift * moved) / shift]) / units(z)

        def units(z: np.ndarray) -> np.ndarray:
            return np.tile(scale, 2).reshape(-1, *[1] * (z.ndim - 1))

        def Some(
            project: Callable[[np.ndarray], np.ndarray], number: int, seed: int
        ) -> tuple[np.ndarray, np.ndarray]:
            inverse = LinearOperator((2 * n, 2 * n), lambda z: project(Inverse(z.ravel())))
            return Tried(eigs, inverse, number, v0=inverse @ Random(2 * n, seed))

        if self._IsSmall(count):
            found, vectors = scipy.linalg.eig(Inverse(np.eye(2 * n)))
            first = np.argsort(-np.abs(found))[: 2 * count + 2]
            found, vectors = found[first], vectors[:, first]
        else:
            found, vectors = WithCopies(Some, Inverse, lambda z: z, 2 * count + 2, symmetric=False)
        vectors = scale[:, None] * vectors[:n]
        values = shift + 1 / found
        isreal = np.abs(values.imag) <= COPY * np.abs(values)  # copies are a pair by rounding
        values = np.where(isreal, values.real, values)
        zero = np.abs(values) ** 2 <= self._Zero(vectors)
        return np.where(zero, 0.0, values), vectors

    def _Zero(self, vectors: np.ndarray) -> np.ndarray:
        """Squares of frequencies that rounding makes of zero, for each vector."""
        size = np.abs(vectors)
        with np.errstate(divide="ignore"):
            return ROUNDING * np.sum(size * (abs(self.K) @ size), axis=0) / self._Masses(vectors)

    def _Masses(self, vectors: np.ndarray) -> np.ndarray:
        """The modal mass of each vector."""
        return np.sum(vectors.conj() * (self.M @ vectors), axis=0).real

    def _Lowest(
        self, values: np.ndarray, vectors: np.ndarray, count: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """One of two conjugate ones each, the first ones by size; a pair that flutters is whole."""
        size = np.abs(values)
        keep = np.flatnonzero((values.imag >= 0) & (size**2 <= BEYOND * self.highest))
        size = size[keep]
        keep = keep[np.argsort(size - GROWS * values[keep].real, kind="stable")]
        values, vectors = values[keep], vectors[:, keep]
        if len(values) > count:
            last, other = values[count - 1 : count + 1]
            small = GROWS * abs(last)
            count += bool(abs(last + other.conj()) <= small < abs(last.real))
        return values[:count], vectors[:, :count]

    def _Normal(self, vectors: np.ndarray) -> np.ndarray:
        """Modal mass 1, and the largest entry of what has mass is real and positive."""
        vectors = vectors / np.sqrt(self._Masses(vectors))
        largest = np.argmax(np.abs(vectors) * self.heavy[:, None], axis=0)
        there = vectors[largest, np.arange(vectors.shape[1])]
        return vectors * (there.conj() / np.abs(there))

    def Residuals(self, values: np.ndarray, vectors: np.ndarray) -> np.ndarray:
        """Of the eigenpairs (k,), relative to the forces of inertia, or to rounding."""
        inertia = (self.M @ vectors) * values**2
        left = self.K @ vectors + inertia
        if self.D is not None:
            left = left + (self.D @ vectors) * values
        stress = abs(self.K) @ np.abs(vectors)
        left, inertia, stress = (
            np.linalg.norm(self.tangent.scale[:, None] * forces, axis=0)
            for forces in (left, inertia, stress)
        )
        return left / np.maximum(inertia, stress * ROUNDING / WRONG)


def Random(size: int, seed: int) -> np.ndarray:
    """The same numbers (size,) each time."""
    return np.random.default_rng(seed).standard_normal(size)


def WithCopies(
    some: Callable[..., tuple[np.ndarray, np.ndarray]],
    apply: Callable[[np.ndarray], np.ndarray],
    weigh: Callable[[np.ndarray], np.ndarray],
    count: int,
    *,
    symmetric: bool,
) -> tuple[np.ndarray, np.ndarray]:
    """The `count` eigenvalues of an operator with the largest size or more, and vectors.

    A Krylov space knows one vector of each eigenvalue, and others by rounding errors only. So it is
    looked for more, across those that are known, until all that is found is smaller.

    ``some(project, number, seed)`` finds eigenvalues and vectors of the operator with a projection.
    `apply` is the operator, `weigh` the matrix of an inner product in which it may be symmetric:
    both of columns.
    """
    values, vectors = some(lambda x: x, count, 1)
    number = 2  # a pair may be complex
    for seed in range(2, MOST_COPIES):
        least = np.sort(np.abs(values))[-count:][0]
        basis = Basis(vectors, weigh)
        try:
            more, others = some(partial(Across, basis, weigh(basis)), number, seed)
        except LinearSolveError:
            break
        if not np.any(np.abs(more) >= (1 - COPY) * least):
            break
        basis, number = Basis(np.hstack([vectors, others]), weigh), max(2, count // 2)
        moved = apply(basis)
        small = basis.T @ weigh(moved)
        if symmetric:
            values, parts = scipy.linalg.eigh(0.5 * (small + small.T))
        else:
            values, parts = scipy.linalg.eig(small)
        vectors = moved @ parts / values
    return values, vectors


def Across(basis: np.ndarray, weighed: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The part of x across an orthonormal basis, whose columns are weighed, too."""
    for _ in range(2):  # the second time for rounding errors
        x = x - basis @ (weighed.T @ x)
    return x


def Basis(vectors: np.ndarray, weigh: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """An orthonormal basis of the space of vectors, which may be complex, in an inner product."""
    parts = np.hstack([vectors.real, vectors.imag]) if np.iscomplexobj(vectors) else vectors
    gram = parts.T @ weigh(parts)
    sizes = np.sqrt(gram.diagonal())
    known = sizes > 0
    parts = parts[:, known] / sizes[known]
    values, turns = np.linalg.eigh(parts.T @ weigh(parts))
    large = values > DEPENDENT * values[-1]
    return parts @ (turns[:, large] / np.sqrt(values[large]))


def Tried(
    method: Callable[..., tuple[np.ndarray, np.ndarray]],
    mat: csr_matrix | LinearOperator,
    count: int,
    *args,
    **options,
) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues and vectors that ARPACK finds; fewer than asked for where others are far away."""
    size = min(max(3 * count, LEAST_SPACE), mat.shape[0] - 1)
    known = {"ncv": size, "tol": ACCURATE, "maxiter": MOST_ROUNDS, "which": "LM"}
    try:
        return method(mat, count, *args, **known, **options)
    except ArpackError as error:
        if len(getattr(error, "eigenvalues", ())):
            return error.eigenvalues, error.eigenvectors
        raise LinearSolveError(f"no mode was found: {error}") from error
