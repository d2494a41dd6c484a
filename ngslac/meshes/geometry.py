"""What all contact meshes share: bodies from named sides, divisions, meshing, a check.

The bodies are separate: they share no node, and their contact edges are divided so that no
node of one side faces a node of the other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from netgen.occ import Axis, Compound, Edge, Face, OCCGeometry, Pnt, Segment, Wire, Z
from ngsolve import CF, Integrate, Mesh

__all__ = [
    "Body",
    "CheckNonMatching",
    "CheckPositive",
    "Divisions",
    "GenerateMesh",
    "Label",
    "MovePoints",
    "NonMatchingDivisions",
    "Polygon",
    "Side",
]


def CheckPositive(**values):
    """Raise a ``ValueError`` that names the first value which is not positive and finite."""
    for name, value in values.items():
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be positive, but is {value}")


def Divisions(length, h):
    """Return the number of edges of size about ``h`` on ``length`` (at least one)."""
    return max(1, round(length / h))


def NonMatchingDivisions(slave, start, end, h, *, tol=1e-3):
    """Return a number of master edges of size about ``h`` whose nodes avoid the slave nodes.

    Parameters
    ----------
    slave : array_like
        Positions of the slave nodes along the interface.
    start, end : float
        The master edge; its two end nodes may coincide with slave nodes.
    h : float
        Wanted size. The smallest number of divisions from ``(end - start) / h`` on that
        keeps the distance ``tol`` times the master size from every slave node is taken.
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


def Body(sides, name):
    """Return the face enclosed by ``sides`` (counter-clockwise) as the body ``name``."""
    face = Face(Wire([side.edge for side in sides]))
    face.name = name
    Label(face, sides)
    return face


def Polygon(points, names, name, **counts):
    """Return a polygon as the body ``name``.

    Parameters
    ----------
    points : sequence of (x, y)
        Corners, counter-clockwise.
    names : sequence of str
        Of the sides; the first one is between the first two corners.
    name : str
        Of the body.
    **counts : int
        Name of a side -> its number of equal parts.
    """
    corners = [Pnt(*point, 0) for point in points]
    sides = zip(corners, [*corners[1:], corners[0]], names, strict=True)
    return Body([Side(Segment(p, q), side, counts.get(side)) for p, q, side in sides], name)


def Label(shape, sides):
    """Name and divide the edges of a shape, which OCC has copied from those of ``sides``."""
    for edge in shape.edges:
        side = min(sides, key=lambda side: _Distance(side.edge.center, edge.center))
        edge.name = side.name
        if side.count is not None:
            edge.partition = [k / side.count for k in range(1, side.count)]
            edge.maxh = edge.mass / side.count


def _Distance(p, q):
    return math.hypot(p.x - q.x, p.y - q.y)


def GenerateMesh(shapes, *, order=1, scale=1.0, angle=0.0, **options):
    """Mesh bodies, then scale and rotate the result.

    The mesh is always generated in the original frame. For another ``scale`` or ``angle`` its
    points are moved, and the geometry is replaced by the transformed shape, on which `Curve`
    projects. Numbering and connectivity are therefore the same for all of them.

    Parameters
    ----------
    shapes : list of netgen.occ.Face
        The bodies.
    order : int
        Order of the curved geometry.
    scale : float
        Factor for the coordinates.
    angle : float
        Rotation about the origin, in degrees.
    **options
        Handed on to ``OCCGeometry.GenerateMesh``.
    """
    shape = Compound(shapes)
    ngmesh = OCCGeometry(shape, dim=2).GenerateMesh(minedgelen=None, **options)
    area, wanted = Integrate(CF(1), Mesh(ngmesh)), sum(face.mass for face in shape.faces)
    if abs(area - wanted) > 0.05 * wanted:  # netgen skips a face that it fails to mesh
        raise RuntimeError(
            f"netgen meshed an area of {area:g} of {wanted:g}: change the element size or grading"
        )
    if scale != 1.0 or angle != 0.0:
        MovePoints(ngmesh, scale, angle)
        shape = shape.Scale(Pnt(0, 0, 0), scale).Rotate(Axis(Pnt(0, 0, 0), Z), angle)
        ngmesh.SetGeometry(OCCGeometry(shape, dim=2))
    mesh = Mesh(ngmesh)
    mesh.Curve(order)
    return mesh


def MovePoints(ngmesh, scale, angle):
    """Scale and rotate (degrees, about the origin) the points of a netgen mesh in place."""
    c, s = scale * math.cos(math.radians(angle)), scale * math.sin(math.radians(angle))
    for point in ngmesh.Points():
        x, y, _ = point.p
        point[0], point[1] = c * x - s * y, s * x + c * y


def CheckNonMatching(mesh, *, slave="slave", master="master", tol=1e-4):
    """Raise if a slave node faces a master node; return the smallest relative distance.

    Distances are measured along the master side (which has to be straight) in units of its
    mean edge length. Nodes at the ends of both sides, such as common corners, may coincide.

    Parameters
    ----------
    mesh : ngsolve.Mesh
        Mesh of two separate bodies in 2D.
    slave, master : str
        Patterns of the two contact boundaries.
    tol : float
        Smallest allowed relative distance.

    Returns
    -------
    float
        The smallest distance of a slave node from the master nodes, relative to their spacing.
    """
    (s, s_end), (m, m_end) = (_BoundaryNodes(mesh, name) for name in (slave, master))
    centre = m.mean(axis=0)
    direction = np.linalg.svd(m - centre)[2][0]
    xs, xm = (s - centre) @ direction, (m - centre) @ direction
    size = np.ptp(xm) / (len(xm) - 1)
    distance = np.abs(xs[:, None] - xm[None, :]) / size
    distance[np.ix_(s_end, m_end)] = np.inf
    smallest = distance.min()
    if smallest < tol:
        at = s[np.unravel_index(distance.argmin(), distance.shape)[0]]
        raise ValueError(
            f"the contact meshes match: slave node ({at[0]:g}, {at[1]:g}) faces a master node"
        )
    return float(smallest)


def _BoundaryNodes(mesh, pattern):
    """Return the vertex coordinates of a boundary, and which of them are end points."""
    touched = [v.nr for el in mesh.Boundaries(pattern).Elements() for v in el.vertices]
    if not touched:
        raise ValueError(f"the mesh has no boundary {pattern!r}")
    numbers, counts = np.unique(touched, return_counts=True)
    points = np.array([mesh.vertices[int(nr)].point for nr in numbers])
    return points, counts == 1
