# SPDX-License-Identifier: LGPL-2.1-or-later
"""Lines and dots that show a field on the slave faces, as objects of a webgui scene."""

import numpy as np
import scipy

__all__ = ["Arrows", "Bars", "Dots", "Ticks"]

LENGTH = 0.2  # of the longest glyph, as a part of the slave's diameter
HATCHES = 80  # lines in all bars, about


def _Lines(name, colour, lines):
    """`lines` (n, 2, d): first and last point of each."""
    lines = np.pad(lines, ((0, 0), (0, 0), (0, 3 - lines.shape[2])))
    return {"type": "lines", "name": name, "color": colour, "position": lines.ravel().tolist()}


def _Scaled(values, faces, size):
    largest = np.abs(values).max() if values.ndim == 1 else np.linalg.norm(values, axis=1).max()
    return values * (size or LENGTH * faces.diameter) / (largest or 1)


def Arrows(faces, name, colour, vectors, size=None):
    """Arrows for `vectors` (n, d), one per face, that start in the middle of the face."""
    arrows = _Scaled(vectors, faces, size)
    shown = np.linalg.norm(arrows, axis=1) > 1e-3 * (size or LENGTH * faces.diameter)
    start, arrows = faces.centers[shown], arrows[shown]
    side = _Perpendicular(arrows)
    tip = start + arrows
    barbs = [tip - 0.3 * arrows + s * side for s in np.linspace(-0.1, 0.1, 9)]
    return _Lines(
        name, colour, np.concatenate([np.stack([e, tip], axis=1) for e in (start, *barbs)])
    )


def _Perpendicular(vectors):
    """Vectors of the same length at right angles."""
    if vectors.shape[1] == 2:
        return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)
    least = np.eye(3)[np.abs(vectors).argmin(axis=1)]
    side = np.cross(vectors, least)
    lengths = [np.linalg.norm(v, axis=1, keepdims=True) for v in (vectors, side)]
    return side * lengths[0] / lengths[1]


def Bars(faces, name, colour, values, size=None):
    """In 2D a hatched bar for `values` (n,), one per face, that stands on it along the normal."""
    height = _Scaled(values, faces, size)[:, None] * faces.normals
    shares = np.linspace(0, 1, max(2, HATCHES // len(values)))[:, None, None]
    feet = (1 - shares) * faces.ends[0] + shares * faces.ends[1]
    tops = np.stack([feet[0], feet[-1]], axis=1) + height[:, None]
    hatches = np.stack([feet, feet + height], axis=2).reshape(-1, 2, 2)
    return _Lines(name, colour, np.concatenate([hatches, tops]))


def Ticks(faces, name, colour, size=None):
    """In 2D lines across the slave side at the ends of the macro-elements."""
    half = (size or LENGTH * faces.diameter / 4) / 2 * faces.normals
    lines = np.stack([faces.ends - half, faces.ends + half], axis=2).reshape(-1, 2, 2)
    macro = np.tile(faces.macro, 2)
    near = scipy.spatial.cKDTree(faces.ends.reshape(-1, 2)).query_pairs(
        1e-9 * faces.diameter, output_type="ndarray"
    )
    inner = near[macro[near[:, 0]] == macro[near[:, 1]]]
    return _Lines(name, colour, np.delete(lines, inner.ravel(), axis=0))


def Dots(faces, name, colour, chosen):
    """A dot on each of the `chosen` (n,) faces."""
    points = np.pad(faces.centers[chosen], ((0, 0), (0, 3 - faces.centers.shape[1])))
    position = points.ravel().tolist()
    return {"type": "points", "name": name, "color": colour, "size": 8, "position": position}
