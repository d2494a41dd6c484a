# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the contact meshes in 3D share: rotations, and meshing."""

from __future__ import annotations

import math

import numpy as np
from netgen.occ import Axis, Compound, OCCGeometry, Pnt, Vec
from ngsolve import CF, Integrate, Mesh
from scipy.spatial.transform import Rotation

from ngslac.meshes.geometry import CheckNonMatching as CheckNonMatching3D

__all__ = ["CheckNonMatching3D", "GenerateMesh3D", "RotationMatrix"]


def RotationMatrix(rotation) -> np.ndarray:
    """Return the matrix (3, 3) of a rotation.

    Parameters
    ----------
    rotation : None, (3, 3) array_like or (axis, float)
        None is the identity. An axis (three numbers, not zero, or the name "x", "y", "z") comes
        with the angle in degrees by which to turn about it, counter-clockwise seen from its tip.

    Raises
    ------
    ValueError
        If it is no rotation: not orthogonal, or a reflection.

    Examples
    --------
    >>> from ngslac.meshes.geometry3d import RotationMatrix
    >>> RotationMatrix(("z", 90)).round(12) @ [1, 0, 0]
    array([0., 1., 0.])
    """
    if rotation is None:
        return np.eye(3)
    if len(rotation) == 2:
        axis, angle = rotation
        axis = [c == axis for c in "xyz"] if isinstance(axis, str) else axis
        axis = np.array(axis, dtype=float)
        valid = axis.shape == (3,) and np.isfinite(axis).all() and np.any(axis)
        if not (valid and math.isfinite(angle)):
            raise ValueError(f"a rotation needs an axis of three numbers and an angle: {rotation}")
        e = axis / np.abs(axis).max()  # whose square neither over- nor underflows
        e, t = e / np.linalg.norm(e), math.radians(angle)
        cross = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
        return np.eye(3) + math.sin(t) * cross + (1 - math.cos(t)) * cross @ cross
    matrix = np.array(rotation, dtype=float)
    if matrix.shape != (3, 3) or not np.allclose(matrix @ matrix.T, np.eye(3), rtol=0, atol=1e-12):
        raise ValueError("a rotation must be an orthogonal matrix of size 3 x 3")
    if np.linalg.det(matrix) < 0:
        raise ValueError("a rotation must not be a reflection: its determinant is -1")
    return matrix


def GenerateMesh3D(solids, *, order=1, scale=1.0, rotation=None, **options):
    """Mesh two bodies far apart, then bring them together, scale and rotate; curve to `order`.

    Apart they are meshed independently of each other: Netgen's element sizes are a function of
    the position. ``solids(distance)`` returns the upper and the lower body, the latter moved down;
    the `options` go to ``OCCGeometry.GenerateMesh``. Numbering and connectivity are the same for
    any `scale` and `rotation` (see `RotationMatrix`) about the origin. A ``RuntimeError`` is raised
    if Netgen failed to mesh a body.
    """
    shape = Compound(solids(0.0))
    (low, high), matrix = shape.bounding_box, scale * RotationMatrix(rotation)
    distance = 2 * (high[2] - low[2])
    apart = Compound(solids(distance))
    # One thread makes the same mesh in less time.
    ngmesh = OCCGeometry(apart).GenerateMesh(parallel_meshing=False, **options)
    points = np.array([p.p for p in ngmesh.Points()])
    points[points[:, 2] < high[2] - distance, 2] += distance
    for point, new in zip(ngmesh.Points(), points @ matrix.T, strict=True):
        point[0], point[1], point[2] = new
    ngmesh.SetGeometry(OCCGeometry(_Transformed(shape, scale, rotation)))
    mesh = Mesh(ngmesh)
    mesh.Curve(order)
    volume, wanted = Integrate(CF(1), mesh), scale**3 * sum(s.mass for s in shape.solids)
    if abs(volume - wanted) > 0.05 * wanted:
        hint = "change the sizes or the grading"
        raise RuntimeError(f"netgen meshed a volume of {volume:g} of {wanted:g}: {hint}")
    return mesh


def _Transformed(shape, scale, rotation):
    """The OCC shape scaled and rotated about the origin."""
    matrix = RotationMatrix(rotation)
    turn = Rotation.from_matrix(matrix).as_rotvec(degrees=True)
    angle = float(np.linalg.norm(turn))
    if scale != 1.0:
        shape = shape.Scale(Pnt(0, 0, 0), scale)
    if angle:
        shape = shape.Rotate(Axis(Pnt(0, 0, 0), Vec(*(turn / angle))), angle)
    return shape
