# SPDX-License-Identifier: LGPL-2.1-or-later
"""Continuous vectors that have given means over macro-elements."""

import numpy as np
from scipy.sparse import diags, identity
from scipy.sparse.linalg import splu

__all__ = ["FitMeans"]

SMOOTHNESS = 0.1  # weight of second differences
LOOSE, REFINEMENTS = 1e-6, 12  # what keeps the matrix regular, and the steps that take it back


def FitMeans(surface, rough, density, means, chosen):
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
    # A row with a vertex elsewhere tells nothing.
    whole = np.isclose(*(np.asarray(abs(part).sum(axis=1)).ravel() for part in (inner, rough)))
    weight = SMOOTHNESS * (surface.shapes.T @ (surface.weight * density)) * whole
    matrix = rows.T @ diags(share) @ rows + inner.T @ diags(weight) @ inner
    # What neither means nor differences know stays near the mean of what touches it.
    factor = splu((matrix + LOOSE * matrix.diagonal().max() * identity(len(touched))).tocsc())
    right = rows.T @ (share[:, None] * means)
    found = surface.OnVertices(means * chosen[:, None])[touched]
    for _ in range(REFINEMENTS):
        found = found + factor.solve(right - matrix @ found)
    values[touched] = found
    return values
