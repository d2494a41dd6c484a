"""What the contact meshes in 3D share: rotations, meshing, a check that sides do not match."""

from __future__ import annotations

import math

import numpy as np
from netgen.occ import Axis, Compound, OCCGeometry, Pnt, Vec
from ngsolve import CF, Integrate, Mesh
from scipy.spatial.transform import Rotation

__all__ = ["CheckNonMatching3D", "GenerateMesh3D", "RotationMatrix"]


def RotationMatrix(rotation):
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
        if axis.shape != (3,) or not np.linalg.norm(axis) > 0 or not math.isfinite(angle):
            raise ValueError(f"a rotation needs an axis of three numbers and an angle: {rotation}")
        e, t = axis / np.linalg.norm(axis), math.radians(angle)
        cross = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
        return np.eye(3) + math.sin(t) * cross + (1 - math.cos(t)) * cross @ cross
    matrix = np.array(rotation, dtype=float)
    if matrix.shape != (3, 3) or not np.allclose(matrix @ matrix.T, np.eye(3), rtol=0, atol=1e-12):
        raise ValueError("a rotation must be an orthogonal matrix of size 3 x 3")
    if np.linalg.det(matrix) < 0:
        raise ValueError("a rotation must not be a reflection: its determinant is -1")
    return matrix


def CheckNonMatching3D(mesh, *, slave="slave", master="master", tol=1e-4):
    """Raise if a slave vertex faces a master vertex; return the smallest relative distance.

    Distances are measured in the plane that fits the master vertices best, in units of the mean
    master edge. Vertices on the rims of both sides, such as common corners, may coincide, but
    no face of one side may have all its vertices at those of a face of the other.

    Parameters
    ----------
    mesh : ngsolve.Mesh
        Mesh of two separate bodies in 3D.
    slave, master : str
        Patterns of the two contact boundaries.
    tol : float
        Smallest allowed relative distance.

    Returns
    -------
    float
        The smallest distance of a slave vertex from the master vertices, relative to their
        spacing, without those on both rims.

    Raises
    ------
    ValueError
        If the meshes match somewhere, or a boundary does not exist.

    Examples
    --------
    >>> from ngslac.meshes.blocks3d import CheckNonMatching3D, TwoBlocks3D
    >>> round(CheckNonMatching3D(TwoBlocks3D("hex", "hex", 2, 3)), 6)
    0.707107
    """
    (s, s_rim, s_faces), (m, m_rim, m_faces) = (_BoundaryNodes(mesh, p) for p in (slave, master))
    centre = m.mean(axis=0)
    plane = np.linalg.svd(m - centre)[2][:2]
    xs, xm = (s - centre) @ plane.T, (m - centre) @ plane.T
    edges = [(f[i - 1], f[i]) for f in m_faces for i in range(len(f))]
    size = np.mean([np.linalg.norm(xm[a] - xm[b]) for a, b in edges])
    distance = np.linalg.norm(xs[:, None] - xm[None, :], axis=2) / size
    facing = {int(i): int(j) for i, j in np.argwhere(distance < tol)}
    if {frozenset(facing.get(i, -1 - i) for i in f) for f in s_faces} & set(
        map(frozenset, m_faces)
    ):
        raise ValueError("the contact meshes match: a slave face coincides with a master face")
    distance[np.ix_(s_rim, m_rim)] = np.inf
    smallest = distance.min()
    if smallest < tol:
        at = ", ".join(f"{c:g}" for c in s[np.unravel_index(distance.argmin(), distance.shape)[0]])
        raise ValueError(f"the contact meshes match: slave vertex ({at}) faces a master vertex")
    return float(smallest)


def _BoundaryNodes(mesh, pattern):
    """Vertices of a boundary, which of them lie on its rim, and its faces in their numbers."""
    faces = [[v.nr for v in el.vertices] for el in mesh.Boundaries(pattern).Elements()]
    if not faces:
        raise ValueError(f"the mesh has no boundary {pattern!r}")
    numbers = sorted({nr for face in faces for nr in face})
    local = {nr: i for i, nr in enumerate(numbers)}
    faces = [[local[nr] for nr in face] for face in faces]
    edges = [frozenset((f[i - 1], f[i])) for f in faces for i in range(len(f))]
    rim = np.zeros(len(numbers), dtype=bool)
    seen = set()
    twice = {e for e in edges if e in seen or seen.add(e)}
    for edge in set(edges) - twice:
        rim[list(edge)] = True
    points = np.array([mesh.vertices[nr].point for nr in numbers])
    return points, rim, faces


def GenerateMesh3D(solids, *, order=1, scale=1.0, rotation=None, **options):
    """Mesh two bodies far apart, then bring them together, scale and rotate.

    Apart they are meshed independently of each other: Netgen's element sizes are a function of
    the position. Numbering and connectivity are the same for any `scale` and `rotation`.

    Parameters
    ----------
    solids : callable
        ``solids(distance)`` returns the upper and the lower body, the latter moved down.
    order : int
        Order of the curved geometry.
    scale : float
        Factor for the coordinates.
    rotation : (3, 3) array_like or (axis, float), optional
        Rotation about the origin, see `RotationMatrix`.
    **options
        Handed on to ``OCCGeometry.GenerateMesh``.

    Returns
    -------
    ngsolve.Mesh
        The curved mesh.

    Raises
    ------
    RuntimeError
        If Netgen failed to mesh a body.

    Examples
    --------
    >>> from netgen.occ import Box
    >>> from ngslac.meshes.geometry3d import GenerateMesh3D
    >>> def Solids(distance):
    ...     return [Box((0, 0, 0), (1, 1, 1)), Box((0, 0, -1 - distance), (1, 1, -distance))]
    >>> mesh = GenerateMesh3D(Solids, maxh=1.0, rotation=("z", 30))
    >>> max(v.point[2] for v in mesh.vertices)
    1.0
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
        raise RuntimeError(
            f"netgen meshed a volume of {volume:g} of {wanted:g}: change the sizes or the grading"
        )
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
