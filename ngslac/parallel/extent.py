# SPDX-License-Identifier: LGPL-2.1-or-later
"""The size of a mesh, whichever process has which part of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ngslac.parallel.together import ALONE, Alone, Recall, Together

if TYPE_CHECKING:
    from ngsolve import Mesh

__all__ = ["Extent", "ExtentOf"]


@dataclass(frozen=True)
class Extent:
    """The size and place of a mesh.

    Attributes
    ----------
    center : (d,)
        Mean of the vertices.
    size, far : float
        The largest range of a coordinate; the largest coordinate.
    least : (3,)
        The smallest coordinates.
    elements : int
    """

    center: np.ndarray
    size: float
    far: float
    least: np.ndarray
    elements: int


def ExtentOf(mesh: Mesh) -> Extent:
    """The Extent of a mesh; all processes ask for it."""
    if mesh.comm.size == 1:
        return Measured(mesh, ALONE)
    together = Together.Of(mesh)
    fits, make = lambda known: known[0] == mesh, lambda: (mesh, Measured(mesh, together))
    return Recall(together.extents, fits, make)[1]


def Measured(mesh: Mesh, together: Together | Alone) -> Extent:
    """Measure a mesh of which these processes have parts."""
    points = np.asarray(mesh.ngmesh.Coordinates()).reshape(-1, mesh.dim)
    low = together.Reduce(points.min(axis=0, initial=np.inf), "MIN")
    high = together.Reduce(points.max(axis=0, initial=-np.inf), "MAX")
    vertices = points[: mesh.nv]
    total = together.Sum(np.append(vertices.sum(axis=0), len(vertices)))
    center = vertices.mean(axis=0) if together is ALONE else total[:-1] / total[-1]
    far = max(np.abs(low).max(), np.abs(high).max())
    return Extent(center, (high - low).max(), far, low, together.Sum(mesh.ne))
