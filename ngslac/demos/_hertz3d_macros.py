"""Macro-elements as polygons seen from above, and the means of Hertz' pressure over them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from ngsolve import BND

from ngslac.reference._polygons import semi_ellipsoid_mean

__all__ = ["Macros", "StripMean"]


def StripMean(vertices, halfwidth):
    """Average of sqrt(1 - (x/halfwidth)^2), zero outside, exactly over polygons.

    By the divergence theorem: the mean is the sum over the edges of the integral of F dy over the
    area, F a primitive. Along an edge F dy has the primitive G dy/dx with G' = F.

    Parameters
    ----------
    vertices : array of shape (..., corners, 2)
    halfwidth : float

    Returns
    -------
    array of shape (...)
    """
    t, y = vertices[..., 0] / halfwidth, vertices[..., 1]
    dt, dy = np.roll(t, -1, axis=-1) - t, np.roll(y, -1, axis=-1) - y
    area = 0.5 * (t * np.roll(y, -1, axis=-1) - np.roll(t, -1, axis=-1) * y).sum(axis=-1)

    def First(t):
        s = np.clip(t, -1, 1)
        return 0.5 * (s * np.sqrt(1 - s**2) + np.arcsin(s))

    def Second(t):
        s = np.clip(t, -1, 1)
        root = np.sqrt(1 - s**2)
        return 0.5 * (s * np.arcsin(s) + root - root**3 / 3) + (np.abs(t) - np.abs(s)) * np.pi / 4

    steep = np.abs(dt) < 1e-4  # the difference quotient would lose digits
    slope = np.where(steep, 1.0, dt)
    mean = np.where(steep, First(t + 0.5 * dt), (Second(t + dt) - Second(t)) / slope)
    return (mean * dy).sum(axis=-1) / area


@dataclass(frozen=True)
class Macros:
    """The macro-elements of the slave side, seen from above.

    Parameters
    ----------
    mesh : ngsolve.Mesh
    macros : sequence of int
        Macro-element of each boundary element of the mesh, -1 off the slave side.
    line : bool
        Line contact along y in place of a point contact: distances from the middle are along x.
    frame : (3, 3) array_like, optional
        Unit vectors of x, y and z as rows.
    length : float
        Unit of length of the mesh: a millimetre expressed in it.
    """

    mesh: object
    macros: object
    line: bool = False
    frame: object = None
    length: float = 1.0

    @cached_property
    def owner(self):
        """Macro-element of each slave face."""
        return np.array([m for m in self.macros if m >= 0])

    @cached_property
    def _numbers(self):
        """Vertex numbers (n, 4) of the faces, the last one of a triangle twice."""
        elements = zip(self.mesh.Elements(BND), self.macros, strict=True)
        faces = [[v.nr for v in el.vertices] for el, macro in elements if macro >= 0]
        return np.array([face if len(face) == 4 else [*face, face[-1]] for face in faces])

    @cached_property
    def corners(self):
        """Corners (n, 4, 2) of the faces from above, the last one of a triangle twice."""
        points = np.array([v.point for v in self.mesh.vertices])[self._numbers]
        frame = np.eye(3) if self.frame is None else np.asarray(self.frame)
        return (points @ frame.T)[..., :2] / self.length

    def Sum(self, values):
        """Sum over the faces of each macro-element."""
        return np.bincount(self.owner, values)

    @cached_property
    def _face_areas(self):
        (x, y), (u, v) = (np.moveaxis(self.corners, -1, 0) for _ in range(2))
        return 0.5 * np.abs((x * np.roll(v, -1, axis=-1) - y * np.roll(u, -1, axis=-1)).sum(axis=1))

    @cached_property
    def area(self):
        """Projected area of each macro-element."""
        return self.Sum(self._face_areas)

    @cached_property
    def extent(self):
        """Smallest and largest distance (n, 2) of its points from the middle of the contact."""
        far = np.linalg.norm(self.corners[..., : 1 if self.line else 2], axis=-1).max(axis=1)
        extent = np.tile((np.inf, 0.0), (len(self.area), 1))
        np.minimum.at(extent[:, 0], self.owner, self._Near())
        np.maximum.at(extent[:, 1], self.owner, far)
        return extent

    def _Near(self):
        """Distance of each face from the middle, zero if it holds it."""
        start, side = self.corners, np.roll(self.corners, -1, axis=1) - self.corners
        if self.line:
            start, side = start[..., :1], side[..., :1]
        square = (side**2).sum(axis=-1)
        foot = -(start * side).sum(axis=-1) / np.where(square > 0, square, 1.0)
        nearest = start + np.clip(foot, 0, 1)[..., None] * side
        distance = np.linalg.norm(nearest, axis=-1).min(axis=1)
        if self.line:
            return distance
        turn = start[..., 0] * side[..., 1] - start[..., 1] * side[..., 0]
        inside = (turn >= 0).all(axis=1) | (turn <= 0).all(axis=1)
        return np.where(inside, 0.0, distance)

    @cached_property
    def _edges(self):
        """The macro-elements of each edge and the edge's ends (2, 2)."""
        edges = {}
        for face, at, macro in zip(self._numbers, self.corners, self.owner, strict=True):
            for i, (a, b) in enumerate(zip(np.roll(face, 1), face, strict=True)):
                if a != b:
                    owners, _ = edges.setdefault(frozenset((a, b)), (set(), at[[i - 1, i]]))
                    owners.add(int(macro))
        return list(edges.values())

    @cached_property
    def neighbours(self):
        """Pairs (k, 2) of macro-elements with a common edge, each in both orders."""
        pairs = {tuple(sorted(owners)) for owners, _ in self._edges if len(owners) == 2}
        pairs = np.array(sorted(pairs)).reshape(-1, 2)
        return np.concatenate([pairs, pairs[:, ::-1]])

    def Outlines(self):
        """Ends (k, 2, 2) of the edges between different macro-elements."""
        return np.array([ends for owners, ends in self._edges if len(owners) == 2])

    def Shape(self, radius):
        """Means of Hertz' pressure over its peak for a given contact radius."""
        faces = (StripMean if self.line else semi_ellipsoid_mean)(self.corners, radius)
        return self.Sum(self._face_areas * faces) / self.area

    def Bends(self, values):
        """Second differences: value of a macro-element less the mean of its neighbours."""
        one, other = self.neighbours.T
        count = np.bincount(one, minlength=len(values))
        total = np.bincount(one, values[other], minlength=len(values))
        return values - total / np.maximum(count, 1)
