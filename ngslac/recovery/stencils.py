# SPDX-License-Identifier: LGPL-2.1-or-later
"""Smoothness of values at the vertices of a surface: differences, and a fit of means."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_matrix, diags, identity
from scipy.sparse.linalg import splu

if TYPE_CHECKING:
    from ngslac.recovery.surface import SlaveSurface

__all__ = ["FitMeans", "SecondDifferences", "ThirdDifferences"]

SINGULAR = 1e-4  # eigenvalue of a fit where the neighbours lie on a line
SMOOTHNESS = 0.1  # weight of second differences
LOOSE, REFINEMENTS = 1e-6, 12  # what keeps the matrix regular, and the steps that take it back
ONE_SIDED = 1.3  # sum of the weights where the neighbours lie on one side: 1 in the middle of them


def SecondDifferences(
    points: np.ndarray, normals: np.ndarray, neighbours: csr_matrix
) -> csr_matrix:
    """How far values at vertices are from the linear function that fits those around them best.

    Zero for functions that are linear in the tangent plane. Where the neighbours do not surround a
    vertex, as at an end of the surface, the row is empty.
    """
    n, graph = len(points), neighbours.tocoo()
    i, j = (ends[graph.row != graph.col] for ends in (graph.row, graph.col))
    counts = np.maximum(np.bincount(i, minlength=n), 1)
    arms = points[j] - points[i]
    arms -= np.einsum("ek,ek->e", arms, normals[i])[:, None] * normals[i]
    size = np.bincount(i, np.linalg.norm(arms, axis=1), n) / counts
    terms = np.column_stack([np.ones(len(i)), arms / size[i, None]])
    inverse, good = _Inverses(_Sums(i, terms, n) / counts[:, None, None], normals)
    weights = np.einsum("ea,ea->e", inverse[i, 0], terms) / counts[i]
    good &= np.bincount(i, np.abs(weights), n) < ONE_SIDED
    rows = identity(n, format="csr") - csr_matrix((weights, (i, j)), shape=(n, n))
    return csr_matrix(rows.multiply(good[:, None]))


def ThirdDifferences(second: csr_matrix, neighbours: csr_matrix) -> csr_matrix:
    """How far second differences are from their means over the neighbours that have some.

    Zero for quadratic functions where vertices lie regularly; sparse matrices as there.
    """
    has = np.asarray(abs(second).sum(axis=1)).ravel() > 0
    mine = diags(has.astype(float))
    around = (neighbours > 0).astype(float) @ mine - mine
    counts = np.asarray(around.sum(axis=1)).ravel()
    means = diags(1 / np.maximum(counts, 1)) @ around @ second
    return csr_matrix(diags(1.0 * (has & (counts > 1))) @ (second - means))


def _Sums(i: np.ndarray, terms: np.ndarray, n: int) -> np.ndarray:
    """Of the products (n, d + 1, d + 1) of the terms that belong to each vertex."""
    size = terms.shape[1]
    products = np.einsum("ea,eb->eab", terms, terms).reshape(len(i), -1)
    return np.stack([np.bincount(i, c, n) for c in products.T], axis=1).reshape(n, size, size)


def _Inverses(moments: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    moments[:, 1:, 1:] += normals[:, :, None] * normals[:, None, :]  # nothing varies along these
    good = np.linalg.eigvalsh(moments)[:, 0] > SINGULAR
    moments[~good] = np.eye(moments.shape[1])
    return np.linalg.inv(moments), good


def FitMeans(
    surface: SlaveSurface,
    rough: csr_matrix,
    density: np.ndarray,
    means: np.ndarray,
    chosen: np.ndarray,
) -> np.ndarray:
    """Values at the vertices of a function that is linear on the faces, by least squares.

    Exact for means of linear functions.
    """
    values = np.zeros((len(surface.vertices), means.shape[1]))
    touched = np.flatnonzero(surface.touches.T @ chosen > 0)
    if not len(touched):
        return values
    share = np.bincount(surface.macro, surface.weight * density, surface.nmacros) * chosen
    rows = surface.Means(density)[:, touched]
    inner = rough[:, touched]
    # A row with a vertex elsewhere carries no information.
    whole = np.isclose(*(np.asarray(abs(part).sum(axis=1)).ravel() for part in (inner, rough)))
    weight = SMOOTHNESS * (surface.shapes.T @ (surface.weight * density)) * whole
    matrix = rows.T @ diags(share) @ rows + inner.T @ diags(weight) @ inner
    # Values that neither means nor differences determine stay near the mean around them.
    factor = splu((matrix + LOOSE * matrix.diagonal().max() * identity(len(touched))).tocsc())
    right = rows.T @ (share[:, None] * means)
    found = surface.OnVertices(means * chosen[:, None])[touched]
    for _ in range(REFINEMENTS):
        found = found + factor.solve(right - matrix @ found)
    values[touched] = found
    return values
