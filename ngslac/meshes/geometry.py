# SPDX-License-Identifier: LGPL-2.1-or-later
"""Common parts of all meshes: bodies from named sides, divisions, meshing, a check.

The bodies are separate: they share no node, and their contact edges are divided so that no
node of one side faces a node of the other.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from netgen.occ import (
    ArcOfCircle,
    Axis,
    Compound,
    Edge,
    Face,
    OCCGeometry,
    Pnt,
    Segment,
    TopoDS_Shape,
    Vec,
    Wire,
)
from ngsolve import CF, Integrate, Mesh
from scipy.spatial.transform import Rotation

from ngslac.meshes.sizes import CheckFinite

if TYPE_CHECKING:
    from netgen.meshing import Mesh as NetgenMesh


def Incline(shape: str, slope: float, reach: float, height: float) -> float:
    """Return the slope, as a ratio, of an interface that rises by up to `reach` times that."""
    if shape not in ("flat", "oblique"):
        raise ValueError(f'shape must be "flat" or "oblique", but is {shape!r}')
    CheckFinite(slope=slope)
    rise = math.tan(math.radians(slope)) if shape == "oblique" else 0.0
    if not abs(rise) * reach < height:
        raise ValueError(f"an interface inclined by {slope} degrees leaves the blocks")
    return rise


def Divisions(length: float, h: float) -> int:
    """Return the number of edges of size about ``h`` on ``length`` (at least one)."""
    return max(1, round(length / h))


def NonMatchingDivisions(
    slave: Sequence[float], start: float, end: float, h: float, *, tol: float = 1e-3
) -> int:
    """Return a number of master edges of size about ``h`` whose nodes avoid the slave nodes.

    `slave` holds the positions of the slave nodes along the interface. The ends of the master edge,
    from `start` to `end`, may coincide with some; all its other nodes keep the distance `tol` times
    the master size. The smallest such number from ``(end - start) / h`` on is taken.
    """
    first = Divisions(end - start, h)
    for count in range(first, 2 * first + 3):
        inner = np.linspace(start, end, count + 1)[1:-1]
        gap = np.abs(inner[:, None] - np.asarray(slave)[None, :])
        if gap.size == 0 or gap.min() > tol * (end - start) / count:
            return count
    raise ValueError(f"no division of the master edge near h = {h} avoids the slave nodes")


@dataclass(frozen=True)
class Side:
    """An edge of a body with its name and, where prescribed, its number of equal parts."""

    edge: Edge
    name: str
    count: int | None = None


def Line(
    p: tuple[float, float], q: tuple[float, float], name: str, count: int | None = None
) -> Side:
    """Return the straight side from p to q, both (x, y)."""
    return Side(Segment(Pnt(*p, 0), Pnt(*q, 0)), name, count)


def Arc(
    point: Callable[[float], tuple[float, float]],
    first: float,
    last: float,
    name: str,
    count: int | None = None,
) -> Side:
    """Return the side on a circle, ``point(angle)`` -> (x, y), between two angles."""
    points = (Pnt(*point(t), 0) for t in (first, (first + last) / 2, last))
    return Side(ArcOfCircle(*points), name, count)


def Touching(radius: float) -> Callable[[float], tuple[float, float]]:
    """Return the circle that touches the origin from above, by the angle from the lowest point."""
    return lambda t: (radius * math.sin(t), radius * (1 - math.cos(t)))


def Body(sides: Sequence[Side], name: str) -> TopoDS_Shape:
    """Return the face enclosed by ``sides`` (counter-clockwise) as the body ``name``."""
    face = Face(Wire([side.edge for side in sides]))
    face.name = name
    Label(face, sides)
    return face


def Polygon(
    points: Sequence[tuple[float, float]], names: Sequence[str], name: str, **counts: int
) -> Face:
    """Return a polygon, points (x, y) counter-clockwise, as the body ``name``.

    The first of the names of its sides is that of the side between the first two corners; `counts`
    are the numbers of equal parts of sides by their names.
    """
    sides = zip(points, [*points[1:], points[0]], names, strict=True)
    return Body([Line(p, q, side, counts.get(side)) for p, q, side in sides], name)


def Label(shape: TopoDS_Shape, sides: Sequence[Side]) -> None:
    """Name and divide the edges of a shape, which OCC has copied from those of ``sides``."""
    for edge in shape.edges:
        side = min(sides, key=lambda side: _Distance(side.edge.center, edge.center))
        edge.name = side.name
        if side.count is not None:
            edge.partition = [k / side.count for k in range(1, side.count)]
            edge.maxh = edge.mass / side.count


def _Distance(p: Any, q: Any) -> float:
    return math.hypot(p.x - q.x, p.y - q.y)


def RotationMatrix(rotation: np.ndarray | tuple[str | Sequence[float], float] | None) -> np.ndarray:
    """Return the matrix (3, 3) of a rotation: None, the matrix itself, or an axis and an angle.

    The axis is "x", "y", "z" or three numbers, not all zero; the angle by which to turn about it
    is in degrees, counter-clockwise seen from its tip.
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


def GenerateMesh(
    faces: Sequence[TopoDS_Shape],
    *,
    order: int = 1,
    scale: float = 1.0,
    angle: float = 0.0,
    **options,
) -> Mesh:
    """Mesh plane bodies, then scale and rotate (degrees, about the origin) the result.

    The mesh is always generated in the original frame by ``OCCGeometry.GenerateMesh``, which gets
    the `options`, so that numbering and connectivity are the same for all frames.
    """
    shape = Compound(faces)
    ngmesh = OCCGeometry(shape, dim=2).GenerateMesh(minedgelen=None, **options)
    return _Placed(ngmesh, shape, shape.faces, order, scale, ("z", angle))


def GenerateMesh3D(
    solids: Callable[[float], Sequence[TopoDS_Shape]],
    *,
    order: int = 1,
    scale: float = 1.0,
    rotation: tuple[str | Sequence[float], float] | None = None,
    **options,
) -> Mesh:
    """Mesh two bodies far apart, then bring them together and go on as `GenerateMesh` does.

    Apart they are meshed independently of each other: Netgen's element sizes are a function of
    the position. ``solids(distance)`` returns the upper and the lower body, the latter moved down.
    """
    shape = Compound(solids(0.0))
    low, high = shape.bounding_box
    distance = 2 * (high[2] - low[2])
    # One thread makes the same mesh in less time.
    ngmesh = OCCGeometry(Compound(solids(distance))).GenerateMesh(parallel_meshing=False, **options)
    for point in ngmesh.Points():
        if point.p[2] < high[2] - distance:
            point[2] = point.p[2] + distance
    return _Placed(ngmesh, shape, shape.solids, order, scale, rotation)


def _Placed(
    ngmesh: NetgenMesh,
    shape: Compound,
    bodies: Iterable[TopoDS_Shape],
    order: int,
    scale: float,
    rotation: tuple[str | Sequence[float], float] | None,
) -> Mesh:
    """The mesh scaled, rotated and curved on its shape; a body that netgen left out is an error."""
    dim, matrix = ngmesh.dim, RotationMatrix(rotation)
    MovePoints(ngmesh, scale * matrix)
    wanted = scale**dim * sum(body.mass for body in bodies)
    if scale != 1.0:
        shape = shape.Scale(Pnt(0, 0, 0), scale)
    turn = Rotation.from_matrix(matrix).as_rotvec(degrees=True)
    if turn.any():
        shape = shape.Rotate(Axis(Pnt(0, 0, 0), Vec(*turn)), float(np.linalg.norm(turn)))
    ngmesh.SetGeometry(OCCGeometry(shape, dim=dim))
    mesh = Mesh(ngmesh)
    mesh.Curve(order)
    size = Integrate(CF(1), mesh)
    if abs(size - wanted) > 0.05 * wanted:
        kind, hint = ("an area", "a volume")[dim - 2], "change the sizes or the grading"
        raise RuntimeError(f"netgen meshed {kind} of {size:g} of {wanted:g}: {hint}")
    return mesh


def MovePoints(ngmesh: NetgenMesh, matrix: np.ndarray) -> None:
    """Multiply the points of a netgen mesh by a matrix (3, 3), in place."""
    points = np.array([point.p for point in ngmesh.Points()]) @ matrix.T
    for point, new in zip(ngmesh.Points(), points, strict=True):
        point[0], point[1], point[2] = new


def CheckNonMatching(
    mesh: Mesh, *, slave: str = "slave", master: str = "master", tol: float = 1e-4
) -> float:
    """Raise if a vertex of one side faces one of the other; return the smallest distance.

    Distances are measured along the line (in 3D: the plane) that fits the master vertices best, in
    units of the mean master edge. Vertices at the ends (on the rims) of both sides, such as common
    corners, may coincide; but in 3D no face of one side may have all its vertices at those of a
    face of the other.
    """
    (s, s_rim, s_faces), (m, m_rim, m_faces) = (_BoundaryNodes(mesh, p) for p in (slave, master))
    centre = m.mean(axis=0)
    along = np.linalg.svd(m - centre)[2][: mesh.dim - 1]
    xs, xm = (s - centre) @ along.T, (m - centre) @ along.T
    size = np.mean([np.linalg.norm(xm[a] - xm[b]) for a, b in _Edges(m_faces)])
    distance = np.linalg.norm(xs[:, None] - xm[None, :], axis=2) / size
    facing = {int(i): int(j) for i, j in np.argwhere(distance < tol)}
    opposite = {frozenset(facing.get(i, -1 - i) for i in f) for f in s_faces}
    if mesh.dim == 3 and opposite & set(map(frozenset, m_faces)):
        raise ValueError("the contact meshes match: a slave face coincides with a master face")
    distance[np.ix_(s_rim, m_rim)] = np.inf
    smallest = distance.min()
    if smallest < tol:
        at = ", ".join(f"{c:g}" for c in s[np.unravel_index(distance.argmin(), distance.shape)[0]])
        node = "node" if mesh.dim == 2 else "vertex"
        raise ValueError(f"the contact meshes match: slave {node} ({at}) faces a master {node}")
    return float(smallest)


def _BoundaryNodes(mesh: Mesh, pattern: str) -> tuple[np.ndarray, np.ndarray, list[list[int]]]:
    """Vertices of a boundary, which of them lie on its rim, and its faces in their numbers."""
    faces = [[v.nr for v in el.vertices] for el in mesh.Boundaries(pattern).Elements()]
    if not faces:
        raise ValueError(f"the mesh has no boundary {pattern!r}")
    numbers = sorted({nr for face in faces for nr in face})
    local = {nr: i for i, nr in enumerate(numbers)}
    faces = [[local[nr] for nr in face] for face in faces]
    ends = _Edges(faces) if mesh.dim == 3 else [(i,) for face in faces for i in face]
    rim = np.zeros(len(numbers), dtype=bool)
    for end, times in Counter(map(frozenset, ends)).items():
        rim[list(end)] |= times == 1
    return np.array([mesh.vertices[nr].point for nr in numbers]), rim, faces


def _Edges(faces: Sequence[Sequence[int]]) -> list[tuple[int, int]]:
    """Pairs of vertices around every face; of an edge of a plane mesh itself, twice."""
    return [(face[i - 1], face[i]) for face in faces for i in range(len(face))]
