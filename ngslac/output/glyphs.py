# SPDX-License-Identifier: LGPL-2.1-or-later
"""Lines and areas that show a field on the slave faces in a webgui scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

if TYPE_CHECKING:
    from ngslac.output.facepoints import FacePoints

__all__ = ["Arrows", "Bands", "BarAreas", "Bars", "Lines", "Ticks"]

LENGTH = 0.2  # of the longest glyph, as a part of the slave's diameter
BAND, OF_FACE = 0.03, 0.4  # its largest thickness, as a part of the same, and of a face
STROKE = 0.12  # half its width, as a part of half its length


def Lines(name: str, colour: str, lines: np.ndarray) -> dict[str, Any]:
    """Thin `lines` (n, 2, d): first and last point of each."""
    lines = np.pad(lines, ((0, 0), (0, 0), (0, 3 - lines.shape[2])))
    return {"type": "lines", "name": name, "color": colour, "position": lines.ravel().tolist()}


def _Scaled(values: np.ndarray, faces: FacePoints, size: float | None) -> np.ndarray:
    largest = np.abs(values).max() if values.ndim == 1 else np.linalg.norm(values, axis=1).max()
    return values * (size or LENGTH * faces.diameter) / (largest or 1)


def Arrows(
    faces: FacePoints, name: str, colour: str, vectors: np.ndarray, size: float | None = None
) -> dict[str, Any]:
    """Arrows for `vectors` (n, d), one per face, outside of the slave body.

    They start in the middle of the face; those that point into the body end there.
    """
    arrows = _Scaled(vectors, faces, size)
    shown = np.linalg.norm(arrows, axis=1) > 1e-3 * (size or LENGTH * faces.diameter)
    start, arrows, normals = faces.centers[shown], arrows[shown], faces.normals[shown]
    inwards = np.sum(arrows * normals, axis=1, keepdims=True) < 0
    tip = np.where(inwards, start, start + arrows)
    start = tip - arrows
    side = _Perpendicular(arrows)
    barbs = [tip - 0.3 * arrows + s * side for s in np.linspace(-0.1, 0.1, 9)]
    return Lines(
        name, colour, np.concatenate([np.stack([e, tip], axis=1) for e in (start, *barbs)])
    )


def _Perpendicular(vectors: np.ndarray) -> np.ndarray:
    """Vectors of the same length at right angles."""
    if vectors.shape[1] == 2:
        return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)
    least = np.eye(3)[np.abs(vectors).argmin(axis=1)]
    side = np.cross(vectors, least)
    lengths = [np.linalg.norm(v, axis=1, keepdims=True) for v in (vectors, side)]
    return side * lengths[0] / lengths[1]


def Bars(
    faces: FacePoints, name: str, colour: str, values: np.ndarray, size: float | None = None
) -> dict[str, Any]:
    """In 2D the outline of a bar for `values` (n,), one per face, that stands on its normal."""
    feet, tops = _Bars(faces, values, size)
    sides = np.stack([feet, tops], axis=2).reshape(-1, 2, 2)
    return Lines(name, colour, np.concatenate([sides, np.stack([*tops], axis=1)]))


def BarAreas(faces: FacePoints, values: np.ndarray, size: float | None = None) -> np.ndarray:
    """Triangles (n, 3, 3) that fill the `Bars`."""
    feet, tops = _Bars(faces, values, size)
    return _Quads(*feet, *tops[::-1])


def _Quads(*corners: np.ndarray) -> np.ndarray:
    """Triangles (2 n, 3, 3) of quadrilaterals with four `corners` (n, 2) in their order."""
    halves = [np.stack([corners[k] for k in half], axis=1) for half in ((0, 1, 2), (0, 2, 3))]
    return np.pad(np.concatenate(halves), ((0, 0), (0, 0), (0, 1)))


def _Bars(
    faces: FacePoints, values: np.ndarray, size: float | None
) -> tuple[np.ndarray, np.ndarray]:
    """Feet and tops (2, n, 2) at the ends of each face."""
    return faces.ends, faces.ends + _Scaled(values, faces, size)[:, None] * faces.normals


def Ticks(faces: FacePoints, size: float | None = None) -> np.ndarray:
    """In 2D triangles (n, 3, 3) of strokes across the slave side at ends of macro-elements."""
    half = (size or LENGTH * faces.diameter / 2) / 2 * faces.normals
    macro = np.tile(faces.macro, 2)
    ends = faces.ends.reshape(-1, 2)
    near = scipy.spatial.cKDTree(ends).query_pairs(1e-9 * faces.diameter, output_type="ndarray")
    inner = near[macro[near[:, 0]] == macro[near[:, 1]]].ravel()
    ends, half = (np.delete(points, inner, axis=0) for points in (ends, np.tile(half, (2, 1))))
    width = STROKE * _Perpendicular(half)
    corners = [-half - width, -half + width, half + width, half - width]
    return _Quads(*(ends + corner for corner in corners))


def Bands(faces: FacePoints, chosen: np.ndarray) -> np.ndarray:
    """In 2D triangles (n, 3, 3) of a band along each of the `chosen` (n,) faces."""
    length = np.median(np.linalg.norm(faces.ends[1] - faces.ends[0], axis=1))
    half = min(BAND * faces.diameter, OF_FACE * length) / 2 * faces.normals[chosen]
    first, last = faces.ends[:, chosen]
    return _Quads(first - half, last - half, last + half, first + half)
