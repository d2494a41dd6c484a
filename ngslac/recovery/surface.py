# SPDX-License-Identifier: LGPL-2.1-or-later
"""The slave side as arrays: its vertices, and the points where contact acts."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import CF, ET, CoefficientFunction, GridFunction, IntegrationRule, x, y, z

from ngslac._ngslac import BoundaryVertices

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix, spmatrix

    from ngslac.contact.contact import LACContact

__all__ = ["Patches", "SlaveSurface"]

CORNERS = {
    ET.SEGM: [(1, 0), (0, 0)],
    ET.TRIG: [(1, 0), (0, 1), (0, 0)],
    ET.QUAD: [(0, 0), (1, 0), (1, 1), (0, 1)],
}


def _Shapes(corners: np.ndarray, xi: np.ndarray) -> np.ndarray:
    """Values (n, 4) of the (bi)linear functions of faces with so many corners, at points (n, 2)."""
    s, t = xi.T
    values = np.zeros((len(xi), 4))
    for count, shapes in (
        (2, (s, 1 - s)),
        (3, (s, t, 1 - s - t)),
        (4, ((1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t)),
    ):
        mine = corners == count
        values[mine, :count] = np.stack(shapes, axis=1)[mine]
    return values


class SlaveSurface:
    """Vertices, macro-elements and quadrature points of the slave side of a contact.

    Attributes
    ----------
    vertices : (n,) int
        Their numbers in the mesh.
    faces : (f, 4) int
        Positions of the corners in `vertices`, -1 behind the last.
    owner : (f,) int
        Macro-element of each face.
    macro : (q,) int
        Macro-element of each quadrature point.
    weight, gap, normal, position : (q, ...)
        Of the points, as the contact has them.
    shapes : (q, n) sparse matrix
        Values of the continuous functions that are linear on the faces.
    area : (m,)
        Paired area of the macro-elements.
    """

    def __init__(self, contact: LACContact):
        mesh, d = contact.surface.mesh, contact.surface.mesh.dim
        self.table = contact.form.Points().reshape(-1, 8 + 2 * d)
        owner, corners = np.array(contact.surface.macros), BoundaryVertices(mesh)
        slave = np.flatnonzero(owner >= 0)
        self.owner, corners = owner[slave], corners[slave]
        known = corners >= 0
        self.vertices, numbers = np.unique(corners[known], return_inverse=True)
        self.faces = np.full(corners.shape, -1)
        self.faces[known] = numbers
        self.points = np.empty((len(self.vertices), d))
        at = mesh.MapToAllElements(
            {kind: IntegrationRule(c, [0] * len(c)) for kind, c in CORNERS.items()},
            contact.surface.slave,
        )
        self._mesh_point = at[:1]
        self.points[numbers] = CF((x, y, z)[:d])(at).reshape(-1, d)
        face = np.searchsorted(slave, self.table[:, 0].astype(int))
        self.macro, self.weight, self.gap = self.owner[face], *self.table[:, 6:8].T
        self.normal, self.position = self.table[:, 8 : 8 + d], self.table[:, 8 + d :]
        values = _Shapes(known[face].sum(axis=1), self.table[:, 2:4])
        self.shapes = self._Sparse(values, self.faces[face], known[face])
        self.nmacros = contact.surface.nmacros
        self.area = np.bincount(self.macro, self.weight, self.nmacros)

    def _Sparse(self, values: np.ndarray, columns: np.ndarray, known: np.ndarray) -> csr_matrix:
        rows = np.broadcast_to(np.arange(len(values))[:, None], values.shape)
        shape = len(values), len(self.vertices)
        return scipy.sparse.csr_matrix((values[known], (rows[known], columns[known])), shape=shape)

    def Jump(self, displacement: GridFunction) -> np.ndarray:
        """Slave minus master displacement (q, d) at the points, of a function on the mesh."""
        slave, master = (self.table[:, k].astype(int) for k in (0, 1))
        jump = self.Evaluate(displacement, slave, self.table[:, 2:4])
        faced = master >= 0
        jump[faced] -= self.Evaluate(displacement, master[faced], self.table[faced, 4:6])
        return jump

    def Evaluate(
        self, function: CoefficientFunction, element: np.ndarray, xi: np.ndarray
    ) -> np.ndarray:
        points = np.repeat(self._mesh_point, len(element))
        points["nr"], points["x"], points["y"] = element, *xi.T
        return function(points).reshape(len(element), function.dim)

    @cached_property
    def touches(self) -> csr_matrix:
        """Which macro-elements (rows) have which vertices (columns), as a sparse matrix."""
        known = self.faces >= 0
        rows = np.broadcast_to(self.owner[:, None], known.shape)[known]
        shape = self.nmacros, len(self.vertices)
        return scipy.sparse.csr_matrix((np.ones(len(rows)), (rows, self.faces[known])), shape=shape)

    @cached_property
    def neighbours(self) -> csr_matrix:
        """Which vertices belong to a common face, as a sparse matrix."""
        known = self.faces >= 0
        rows = np.broadcast_to(np.arange(len(known))[:, None], known.shape)[known]
        shape = len(known), len(self.vertices)
        corners = scipy.sparse.csr_matrix(
            (np.ones(len(rows)), (rows, self.faces[known])), shape=shape
        )
        return (corners.T @ corners).tocsr()

    @cached_property
    def share(self) -> np.ndarray:
        """Paired area (n,) that belongs to each vertex."""
        return self.shapes.T @ self.weight

    def Means(self, density: np.ndarray) -> csr_matrix:
        """Sparse matrix (m, n): means over the macro-elements, weighted by (q,) at the points."""
        weight = self.weight * density
        sums = np.bincount(self.macro, weight, self.nmacros)[self.macro]
        share = np.divide(weight, sums, out=np.zeros_like(weight), where=sums > 0)
        rows = scipy.sparse.csr_matrix(
            (share, (self.macro, np.arange(len(share)))), shape=(self.nmacros, len(share))
        )
        return rows @ self.shapes

    def OnVertices(self, values: np.ndarray) -> np.ndarray:
        """Means (n, ...) over what touches each vertex of values (m, ...) of macro-elements."""
        counts = np.asarray(self.touches.sum(axis=0)).reshape(-1, *[1] * (values.ndim - 1))
        return (self.touches.T @ values) / counts


class Patches:
    """Macro-elements that transmit forces, by the parts that share no vertex."""

    def __init__(self, surface: SlaveSurface, closed: np.ndarray):
        self._neighbours, touches = surface.neighbours, surface.touches
        self.touched = touches.T @ closed > 0  # vertices of those that transmit forces
        mine = touches[closed]
        _, labels = scipy.sparse.csgraph.connected_components(mine @ mine.T, directed=False)
        self.count = int(labels.max()) + 1 if len(labels) else 0
        # The patch of each macro-element, open ones included where they touch one; -1 for none.
        self.macro = np.full(len(closed), -1)
        self.macro[closed] = labels
        self.vertex = self._Largest(touches.T, self.macro)
        around = self._Largest(touches, self.vertex)
        self.macro = np.where(closed, self.macro, around)

    def Around(self, labels: np.ndarray) -> np.ndarray:
        """Labels of vertices with those of their neighbours where they have none."""
        return np.where(labels < 0, self._Largest(self._neighbours, labels), labels)

    @staticmethod
    def _Largest(graph: spmatrix, labels: np.ndarray) -> np.ndarray:
        """The largest label on the other side of a graph, -1 where there is none."""
        graph = graph.tocsr().copy()
        graph.data = labels[graph.indices] + 1.0
        return graph.max(axis=1).toarray().ravel().astype(int) - 1

    def Sums(self, of: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Sums (count, ...) of `values` (n, ...) of things that belong to the patches `of` (n,)."""
        mine = of >= 0
        flat = values[mine].reshape(mine.sum(), -1)
        sums = [np.bincount(of[mine], column, self.count) for column in flat.T]
        return np.stack(sums, axis=1).reshape(self.count, *values.shape[1:])
