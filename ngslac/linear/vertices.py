# SPDX-License-Identifier: LGPL-2.1-or-later
"""Dofs of first order: those of the vertices, and the rigid motions on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ngslac._ngslac import VertexDofs
from ngslac.arrays import AsNumPy
from ngslac.rigid import MotionsAt

if TYPE_CHECKING:
    from ngsolve import BitArray, FESpace

__all__ = ["VertexNodes"]


@dataclass(frozen=True)
class VertexNodes:
    """The vertices with free displacements.

    Vertices that share a dof, as in periodic spaces, leave it to the first of them, and count where
    they have others. Rigid motions take its position. A rotation is no motion of a periodic body:
    such a column jumps at the seam, and makes the coarse levels there less good, no less right.
    """

    dofs: np.ndarray  # (n, d) int: scalar ones of each vertex, -1 for none
    free: np.ndarray  # (n, d) bool: of these
    motions: np.ndarray  # (n, d, m): rotations about the middle, divided by the size of the mesh

    @classmethod
    def Of(cls, space: FESpace, freedofs: BitArray, first: int = 0) -> VertexNodes | None:
        """Those of a displacement space whose scalar dofs begin at `first`; None for others."""
        d = space.TestFunction().dim
        dofs = VertexDofs(space)
        if space.dim > 1:
            dofs = dofs[:, :, None] * space.dim + np.arange(space.dim)
            dofs = dofs.reshape(len(dofs), dofs.shape[1] * space.dim)
        if dofs.shape[1] != d:
            return None
        dofs = FirstOnly(np.where(dofs < 0, -1, dofs + first))
        free = AsNumPy(freedofs)[dofs] & (dofs >= 0)
        used = free.any(axis=1)
        points = np.asarray(space.mesh.ngmesh.Coordinates())[: len(dofs), : space.mesh.dim]
        motions = MotionsAt(points[used]) if d > 1 else np.ones((used.sum(), 1, 1))
        return cls(dofs[used], free[used], motions)

    @property
    def count(self) -> int:
        """Of the free dofs."""
        return int(self.free.sum())

    def Modes(self, scale: np.ndarray) -> np.ndarray:
        """The rigid motions (n d, m) in scaled variables, zero where nothing is free."""
        factor = np.where(self.free, 1 / scale[self.dofs], 0.0)
        return (factor[:, :, None] * self.motions).reshape(self.dofs.size, -1)


def FirstOnly(dofs: np.ndarray) -> np.ndarray:
    """The table with -1 in place of all but the first occurrence of a number."""
    _, first = np.unique(dofs, return_index=True)
    kept = np.full(dofs.size, -1)
    kept[first] = dofs.ravel()[first]
    return kept.reshape(dofs.shape)
