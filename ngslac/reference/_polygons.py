# SPDX-License-Identifier: LGPL-2.1-or-later
"""Averages over polygons in the plane of contact, for comparison with multipliers on faces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._checks import points

__all__ = ["PolygonEdges", "semi_ellipsoid_mean"]


def _shoelace(vertices: np.ndarray) -> float | np.ndarray:
    """Signed area, positive if anticlockwise; free of cancellation far from the origin."""
    x, y = np.moveaxis(vertices - vertices[..., :1, :], -1, 0)
    return 0.5 * (x * np.roll(y, -1, axis=-1) - y * np.roll(x, -1, axis=-1)).sum(axis=-1)


@dataclass(frozen=True)
class PolygonEdges:
    """Edges of polygons, each along s -> foot + s * tangent with s from `start` to `end`.

    `distance` is that of the origin from the line of the edge, positive if it lies to the left.
    All have the shape (..., corners), `tangent` a last axis of 2 more, `area` (signed) one less.
    """

    tangent: np.ndarray
    start: np.ndarray
    end: np.ndarray
    distance: np.ndarray
    area: np.ndarray

    @classmethod
    def FromVertices(cls, vertices: np.ndarray) -> PolygonEdges:
        """Edges of polygons given by an array of shape (..., corners, 2)."""
        vertices = points("vertices", vertices)
        if vertices.ndim < 2 or vertices.shape[-1] != 2 or vertices.shape[-2] < 3:
            raise ValueError(
                f"vertices of shape {vertices.shape} are not valid: "
                "give an array of shape (..., corners, 2) with 3 corners or more"
            )
        area = _shoelace(vertices)
        if (area == 0).any():
            raise ValueError(f"vertices = {vertices!r} is not valid: give polygons of nonzero area")
        side = np.roll(vertices, -1, axis=-2) - vertices
        length = np.hypot(side[..., 0], side[..., 1])
        tangent = side / np.where(length > 0, length, 1.0)[..., None]
        start = (vertices * tangent).sum(axis=-1)
        distance = vertices[..., 0] * tangent[..., 1] - vertices[..., 1] * tangent[..., 0]
        return cls(tangent, start, start + length, distance, area)

    def Angle(self) -> np.ndarray:
        """Signed angle under which each edge is seen from the origin."""
        away = np.abs(self.distance)
        return np.sign(self.distance) * (np.arctan2(self.end, away) - np.arctan2(self.start, away))

    def Chord(self, radius: float | np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Half chord h of each edge's line in the disc of `radius`, and both ends cut to it.

        `radius` is a number, or an array of the shape of the edges with further axes at the end.
        """
        further = np.ndim(radius) - self.distance.ndim
        shape = self.distance.shape + max(further, 0) * (1,)
        distance, start, end = (
            field.reshape(shape) for field in (self.distance, self.start, self.end)
        )
        half = np.sqrt(np.maximum(radius**2 - distance**2, 0.0))
        return half, np.clip(start, -half, half), np.clip(end, -half, half)


def semi_ellipsoid_mean(vertices: np.ndarray, radius: float) -> float | np.ndarray:
    """Average sqrt(1 - (x^2 + y^2)/radius^2), zero outside the disc, exactly over polygons.

    By the divergence theorem an edge at distance d contributes the integral along it of
    d M(r)/r^2, with M(r) = radius^2/3 (1 - (1 - r^2/radius^2)^(3/2)) and constant outside. With
    h^2 = radius^2 - d^2, w^2 = h^2 - s^2, the primitive of d (1 - r^2/radius^2)^(3/2)/r^2 is
    arctan(radius s/(d w)) - d/radius^3 ((radius^2 + h^2/2) arcsin(s/h) + s w/2).
    """
    edges = PolygonEdges.FromVertices(vertices)
    if radius == 0:
        return np.zeros_like(edges.area)[()]
    half, *ends = edges.Chord(radius)
    away = np.abs(edges.distance)

    def primitive(s: np.ndarray) -> np.ndarray:
        root = np.sqrt(np.maximum(half**2 - s**2, 0.0))
        arc = (radius**2 + 0.5 * half**2) * np.arctan2(s, root) + 0.5 * s * root
        return np.arctan2(radius * s, away * root) - away / radius**3 * arc

    angle = edges.Angle()
    cap = np.sign(edges.distance) * (primitive(ends[1]) - primitive(ends[0]))
    total = radius**2 / 3.0 * (angle - cap).sum(axis=-1)
    misses = (ends[0] == ends[1]).all(axis=-1) & (np.abs(angle.sum(axis=-1)) < 1.0)
    return np.where(misses, 0.0, np.maximum(total / edges.area, 0.0))[()]
