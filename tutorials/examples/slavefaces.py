"""The slave faces of a contact in 3D seen from above: to compare multipliers with formulas.

Multipliers are means over macro-elements. So a formula is averaged, too, before they are compared.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from ngsolve import BND


@dataclass(frozen=True)
class SlaveFaces:
    """Corners and areas of the slave faces, all triangles or all quadrilaterals.

    Each process of a distributed mesh knows those of all, but for the numbers of vertices.
    """

    mesh: object
    macros: object  # macro-element of each boundary element, -1 off the slave side
    line: bool = False  # distances are along x, as in a line contact along y

    @cached_property
    def owner(self):
        """Macro-element (n,) of each face."""
        return self._Everywhere([m for m in self.macros if m >= 0])

    @cached_property
    def vertices(self):
        """Vertex numbers (n, corners) of the faces of this process."""
        elements = zip(self.mesh.Elements(BND), self.macros, strict=True)
        return np.array([[v.nr for v in el.vertices] for el, macro in elements if macro >= 0])

    @cached_property
    def corners(self):
        """Corners (n, corners, 2) of the faces."""
        points = [v.point[:2] for v in self.mesh.vertices]
        return self._Everywhere([[points[v] for v in face] for face in self.vertices])

    def _Everywhere(self, rows):
        """The rows of all processes as array."""
        if self.mesh.comm.size > 1:
            rows = [row for part in self.mesh.comm.mpi4py.allgather(rows) for row in part]
        return np.array(rows)

    @cached_property
    def areas(self):
        """Areas (n,) of the faces."""
        (x, y), (u, v) = (np.moveaxis(self.corners, -1, 0) for _ in range(2))
        return 0.5 * np.abs((x * np.roll(v, -1, axis=-1) - y * np.roll(u, -1, axis=-1)).sum(axis=1))

    @cached_property
    def area(self):
        """Area (m,) of each macro-element."""
        return np.bincount(self.owner, self.areas)

    def Means(self, values):
        """Means (m, ...) over the macro-elements of values (n, ...) on the faces."""
        columns = np.asarray(values).reshape(len(self.owner), -1).T
        sums = [np.bincount(self.owner, self.areas * column) for column in columns]
        return (np.array(sums) / self.area).T.reshape(-1, *np.shape(values)[1:])

    @cached_property
    def middle(self):
        """Centres (m, 2) of the macro-elements, of triangles."""
        return self.Means(self.corners.mean(axis=1))

    @cached_property
    def extent(self):
        """Smallest and largest distance (m, 2) of each macro-element from the middle."""
        far = np.linalg.norm(self.corners[..., : 1 if self.line else 2], axis=-1).max(axis=1)
        extent = np.tile((np.inf, 0.0), (len(self.area), 1))
        np.minimum.at(extent[:, 0], self.owner, self._Near())
        np.maximum.at(extent[:, 1], self.owner, far)
        return extent

    def _Near(self):
        """Distance of each face from the middle, zero if it holds it."""
        start = self.corners[..., : 1 if self.line else 2]
        side = np.roll(start, -1, axis=1) - start
        square = (side**2).sum(axis=-1)
        foot = -(start * side).sum(axis=-1) / np.where(square > 0, square, 1.0)
        nearest = start + np.clip(foot, 0, 1)[..., None] * side
        distance = np.linalg.norm(nearest, axis=-1).min(axis=1)
        if self.line:
            return distance
        turn = start[..., 0] * side[..., 1] - start[..., 1] * side[..., 0]
        inside = (turn >= 0).all(axis=1) | (turn <= 0).all(axis=1)
        return np.where(inside, 0.0, distance)
