# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which macro-elements meet, and which contact is too narrow for its macro-elements."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ngslac._ngslac import BoundaryVertices, LACSpace

if TYPE_CHECKING:
    from ngsolve import Mesh

__all__ = ["Neighbours"]


class Neighbours:
    """The macro-elements of a LACSpace, with the vertices of the mesh where they meet."""

    def __init__(self, space: LACSpace, mesh: Mesh):
        owner, corners = np.array(space.macros), BoundaryVertices(mesh)
        slave = np.flatnonzero(owner >= 0)
        known = corners[slave] >= 0
        vertices, columns = np.unique(corners[slave][known], return_inverse=True)
        rows = np.broadcast_to(owner[slave][:, None], known.shape)[known]
        shape = space.nmacros, len(vertices)
        touches = scipy.sparse.csr_matrix(
            (np.ones(len(rows)), (rows, columns.ravel())), shape=shape
        )
        touches.data[:] = 1
        self.dim, self._touches = mesh.dim, touches

    @cached_property
    def _count(self) -> np.ndarray:
        """Macro-elements at each vertex."""
        return np.asarray(self._touches.sum(axis=0)).ravel()

    def Near(self, chosen: np.ndarray) -> np.ndarray:
        """Which macro-elements are among the chosen ones, or share a vertex with one (m,)."""
        return self._touches @ (self._touches.T @ chosen.astype(float)) > 0

    def Narrow(self, closed: np.ndarray) -> np.ndarray:
        """Which closed macro-elements (m,) belong to a patch that is one of them wide.

        A patch is wider where a vertex inside of it, or a macro-element, has closed ones all around
        it; in 2D two neighbours are enough.
        """
        numbers = np.flatnonzero(closed)
        touches = self._touches[numbers]
        inside = np.asarray(touches.sum(axis=0)).ravel() == self._count
        inner = inside & (self._count >= self.dim)
        whole = touches @ (~inside).astype(float) == 0
        whole &= touches @ (self._count > 1).astype(float) >= 2
        npatches, patch = scipy.sparse.csgraph.connected_components(touches @ touches.T)
        wide = np.zeros(npatches, bool)
        wide[patch[(touches @ inner.astype(float) > 0) | whole]] = True
        return numbers[~wide[patch]]
