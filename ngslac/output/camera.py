# SPDX-License-Identifier: LGPL-2.1-or-later
"""From where a 3D scene is seen: before the slave face, a little from the side."""

import numpy as np
import scipy

__all__ = ["View"]

# Towards the camera from a face that closes on itself.
ANYWHERE = np.array([0.6, -1.0, 0.5])
SIDEWAYS = 0.7  # of the direction to the camera, beside the normal
ROUND = 0.3  # mean of unit normals below which the face closes on itself
AROUND = 1.6  # radius of what is seen, by that of the slave face


def View(points, normals):
    """Options euler_angles, center, radius of a scene that looks at a face with these `points`."""
    low, high = points.min(axis=0), points.max(axis=0)
    turn = scipy.spatial.transform.Rotation.from_matrix(_Axes(_Towards(normals)))
    return {
        "euler_angles": turn.as_euler("XYZ", degrees=True).round(3).tolist(),
        "center": ((low + high) / 2).tolist(),
        "radius": float(AROUND * np.linalg.norm(high - low) / 2),
    }


def _Towards(normals):
    """The direction from the faces to the camera."""
    mean = normals.mean(axis=0)
    if np.linalg.norm(mean) < ROUND:
        return ANYWHERE / np.linalg.norm(ANYWHERE)
    mean /= np.linalg.norm(mean)
    side = ANYWHERE - (ANYWHERE @ mean) * mean
    towards = mean + SIDEWAYS * side / np.linalg.norm(side)
    return towards / np.linalg.norm(towards)


def _Axes(towards):
    """Rows: what the picture has to its right, above, and towards the camera; z goes up."""
    up = np.eye(3)[2 if abs(towards[2]) < 0.95 else 1]
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(towards, right), towards])
