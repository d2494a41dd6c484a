# SPDX-License-Identifier: LGPL-2.1-or-later
"""Constants of inequalities on triangles and tetrahedra, from eigenvalues on polynomials."""

from itertools import product
from math import factorial

import numpy as np
from ngsolve import ET, IntegrationRule

__all__ = ["Constants", "Rule"]

DEGREE = {2: 5, 3: 3}  # of the polynomials on which the suprema are computed
RIGID = 1e-9  # relative eigenvalues of the strain that are rigid motions


class Constants:
    """Of simplices with corners (n, d + 1, d): suprema over all displacements w that are not rigid.

    They are those over polynomials of a degree, which hardly grow any more with it.
    """

    def __init__(self, corners: np.ndarray, *, degree: int = 0):
        self.corners, self.dim = corners, corners.shape[2]
        self.degree = max(degree, DEGREE[self.dim])
        kind = ET.TRIG if self.dim == 2 else ET.TET
        self._points, self._weights = Rule(kind, 2 * self.degree, self.dim)
        edges = corners[:, 1:] - corners[:, :1]
        self._volume = np.abs(np.linalg.det(edges)) / factorial(self.dim)
        self._inverse = np.linalg.inv(edges)
        gradients = np.stack([Monomials(self._points, self.degree, k) for k in range(self.dim)])
        moments = np.einsum("kqa,q,lqb->klab", gradients, self._weights, gradients)
        moments *= factorial(self.dim)
        v, inverse = self._volume, self._inverse
        parts = np.einsum("nik,njl,klab,n->nijab", inverse, inverse, moments, v, optimize=True)
        self._square = self._Diagonal(np.einsum("niiab->nab", parts))
        self._swapped = parts.transpose(0, 2, 3, 1, 4).reshape(self._square.shape)
        means = np.einsum("kqa,q->ka", gradients, self._weights) * factorial(self.dim)
        self._means = np.einsum("nik,ka->nia", inverse, means)
        self._White()

    def _Diagonal(self, block: np.ndarray) -> np.ndarray:
        """The same matrix (n, a, a) for each component of a displacement: (n, d a, d a)."""
        n, size, _ = block.shape
        whole = np.einsum("ij,nab->niajb", np.eye(self.dim), block)
        return whole.reshape(n, self.dim * size, self.dim * size)

    def _White(self) -> None:
        """Displacements whose strains are orthonormal, as columns; 0 for rigid motions."""
        values, vectors = np.linalg.eigh(0.5 * (self._square + self._swapped))
        large = values > RIGID * values[:, -1:]
        factor = np.where(large, 1 / np.sqrt(np.where(large, values, 1)), 0)
        self._white = vectors * factor[:, None, :]

    def _Largest(self, matrix: np.ndarray) -> np.ndarray:
        """Root of the largest quotient of a quadratic form and the integral of |strain|^2."""
        white = self._white
        values = np.linalg.eigvalsh(white.transpose(0, 2, 1) @ matrix @ white)
        return np.sqrt(np.maximum(values[:, -1], 0))

    def Turn(self) -> np.ndarray:
        """Constant of the skew part of the gradient, less its mean (n,)."""
        d, n = self.dim, len(self.corners)
        matrix = 0.5 * (self._square - self._swapped)
        for i, j in product(range(d), repeat=2):
            turn = np.zeros((n, d, self._means.shape[2]))
            turn[:, i] += 0.5 * self._means[:, j]
            turn[:, j] -= 0.5 * self._means[:, i]
            flat = turn.reshape(n, -1) * np.sqrt(self._volume)[:, None]
            matrix = matrix - flat[:, :, None] * flat[:, None, :]
        return self._Largest(matrix)

    def Carrying(self, moments: np.ndarray) -> np.ndarray:
        """The displacements (n, d, a) that take up loads with the moments (n, d, a).

        Their strain is the stress: the modulus is that of ``stress = strain``. The loads push no
        rigid motion.
        """
        loads = moments.reshape(len(moments), 1, -1) @ self._white
        return (loads @ self._white.transpose(0, 2, 1)).reshape(moments.shape)

    @property
    def points(self) -> np.ndarray:
        """Those of the integrals (q, d), in coordinates that are 0 at the first corner."""
        return self._points

    def StrainMoments(self, tensors: np.ndarray) -> np.ndarray:
        """Integrals (n, d, a) of symmetric tensors (n, q, d, d) at the points with strains."""
        gradients = np.stack([Monomials(self._points, self.degree, k) for k in range(self.dim)])
        gradients = gradients * self._weights[:, None] * factorial(self.dim)
        along = np.einsum("nqij,njk->nqik", tensors, self._inverse)
        found = np.einsum("nqik,kqa->nia", along, gradients, optimize=True)
        return found * self._volume[:, None, None]

    def Values(self, element: np.ndarray, positions: np.ndarray) -> np.ndarray:
        """Monomials (q, a) of elements (q,) at positions (q, d)."""
        away = positions - self.corners[element, 0]
        return Monomials(np.einsum("qi,qik->qk", away, self._inverse[element]), self.degree)

    def Inside(self, less: int) -> np.ndarray:
        """Constant of the displacement in the element, less its part of a degree (n,); a length."""
        rest = Rest(self._points, self._weights, self.degree, less)
        return self._Largest(self._Diagonal(self._volume[:, None, None] * rest))


def Rest(points: np.ndarray, weights: np.ndarray, degree: int, less: int) -> np.ndarray:
    """Mean products (a, a) of monomials less their parts of a degree."""
    values, lower = Monomials(points, degree), Monomials(points, less)
    weights = weights / weights.sum()
    mass = lower.T @ (weights[:, None] * lower)
    part = np.linalg.solve(mass, lower.T @ (weights[:, None] * values))
    rest = values - lower @ part
    return rest.T @ (weights[:, None] * rest)


def Rule(kind: ET, order: int, dim: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (q, d) and weights (q,) of a reference simplex."""
    rule = IntegrationRule(kind, order)
    return np.array(rule.points)[:, :dim], np.array(rule.weights)


def Monomials(points: np.ndarray, degree: int, derivative: int | None = None) -> np.ndarray:
    """Values (q, a) of all monomials around the middle, or of their derivatives."""
    d = points.shape[1]
    moved = 2 * (points - 1 / (d + 1))
    columns = []
    for powers in product(range(degree + 1), repeat=d):
        if sum(powers) > degree:
            continue
        powers, factor = list(powers), 1.0
        if derivative is not None:
            factor = 2.0 * powers[derivative]
            powers[derivative] = max(0, powers[derivative] - 1)
        columns.append(factor * np.prod(moved ** np.array(powers), axis=1))
    return np.stack(columns, axis=1)
