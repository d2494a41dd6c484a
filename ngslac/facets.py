# SPDX-License-Identifier: LGPL-2.1-or-later
"""Tools with surfaces of plane facets: from corners, files, meshes and shapes."""

import re
from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np
import scipy
from netgen.meshing import MeshingStep
from netgen.occ import OCCGeometry, TopoDS_Shape
from ngsolve import Mesh

from ngslac._ngslac import FacetCorners, RegionWithFaces, ToolShape
from ngslac.arguments import CheckCount, CheckFlag, CheckInstance, CheckPositive
from ngslac.tool import CheckPoints, Tool

__all__ = ["FromMesh", "FromSTL", "FromShape", "Polygon"]

RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
HEADER = 84  # bytes before the first triangle of a binary file
# Corners that are nearer, relative to the size of all, are one.
SAME = 1e-6
# Along each side of a curved face; of the size of a shape along its longest edge.
DIVISIONS, PARTS = 4, 40
# Sizes whose sixth power is a number.
SMALLEST, LARGEST = 1e-50, 1e50


def Polygon(points: Sequence[Sequence[float]], *, closed: bool = True) -> Tool:
    """A tool in 2D with straight edges.

    Result and errors are as in `Plane`.

    Parameters
    ----------
    points : (n, 2) array-like
        Corners, counterclockwise around the tool.
    closed : bool
        An edge leads from the last point to the first. False: an open chain, with the tool on its
        left.

    Examples
    --------
    >>> from ngslac import tools
    >>> tools.Polygon([(0, 0), (2, 0), (2, 1), (0, 1)]).Distance([(1, 3), (1, 0.5)]).tolist()
    [2.0, -0.5]
    """
    points = CheckPoints("points", points, 2)
    least = 3 if CheckFlag("closed", closed) else 2
    if len(points) < least:
        raise ValueError(f"points must be at least {least} corners, got {len(points)}")
    _CheckSize(points)
    _CheckEncloses(points, closed)
    first = np.arange(len(points) if closed else len(points) - 1)
    edges = np.stack([first, (first + 1) % len(points)], axis=1)
    return _Facets(points, edges, closed)


def _CheckEncloses(points: np.ndarray, closed: bool) -> None:
    """Refuse corners on one line, and those of two loops that cancel."""
    x, y = (points - points.mean(axis=0)).T
    area = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    if closed and area <= SAME * (np.ptp(x) ** 2 + np.ptp(y) ** 2):
        raise ValueError(
            "points enclose no area: give the corners in their order around the tool, or "
            "closed=False for an open chain"
        )


def FromSTL(file: str | Path, *, closed: bool = True) -> Tool:
    """A tool with a triangulated surface, from an STL file (binary or text).

    Parameters
    ----------
    file : str or path
    closed : bool
        False: the surface may be open. What touches it has to stay away from its rim.

    Returns
    -------
    Tool

    Raises
    ------
    ValueError, OSError, ngsolve.NgException
        No such file, no STL; a surface that is open, turned inside out, or no surface.

    Examples
    --------
    A tetrahedron that is written and read:

    >>> from ngslac import tools
    >>> points = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"]
    >>> facets = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
    >>> with open("tetrahedron.stl", "w") as file:
    ...     print("solid", file=file)
    ...     for facet in facets:
    ...         print("facet outer loop", *("vertex " + points[i] for i in facet), file=file)
    >>> tools.FromSTL("tetrahedron.stl").Distance([(0, 0, 3), (0.1, 0.2, 0.2)]).tolist()
    [2.0, -0.1]
    """
    return _Facets(*ReadSTL(file), closed)


def FromMesh(
    mesh: Mesh, boundary: str = ".*", *, divisions: int | None = None, closed: bool = True
) -> Tool:
    """A tool with the boundary of a mesh, divided into plane facets.

    Result and errors are as in `Plane`.

    Parameters
    ----------
    mesh : ngsolve.Mesh
        In 2D or 3D.
    boundary : str or Region
        Its faces; the tool is on the side of the body.
    divisions : int, optional
        Parts of each side of a face. Default: 1, and 4 where the mesh is curved.
    closed : bool
        False: the surface may be open. What touches it has to stay away from its rim.

    Examples
    --------
    >>> from netgen.occ import unit_square
    >>> from ngsolve import Mesh
    >>> from ngslac import tools
    >>> tools.FromMesh(Mesh(unit_square.GenerateMesh(maxh=0.5))).Distance([(3, 0.4)]).tolist()
    [2.0]
    """
    return _Facets(*FacetsOfMesh(mesh, boundary, divisions), closed)


def FromShape(shape: TopoDS_Shape, *, maxh: float | None = None, closed: bool = True) -> Tool:
    """A tool from CAD, such as a STEP file: its surface is divided into plane facets.

    Result and errors are as in `Plane`.

    Parameters
    ----------
    shape : netgen.occ.TopoDS_Shape
        A body in 3D, such as ``OCCGeometry("punch.step").shape``.
    maxh : float, optional
        Longest edge of facets. Default: a fortieth of the size of the shape; the error of the
        distance is maxh**2 / (8 R) where the radius of curvature is R.
    closed : bool
        False: the surface may be open. What touches it has to stay away from its rim.

    Examples
    --------
    >>> from netgen.occ import Box
    >>> from ngslac import tools
    >>> tools.FromShape(Box((0, 0, 0), (1, 1, 1)), maxh=1).Distance([(0.5, 0.5, 3)]).tolist()
    [2.0]
    """
    return _Facets(*FacetsOfShape(shape, maxh), closed)


def _CheckSize(points: np.ndarray) -> None:
    """Refuse corners whose areas would be infinite, or zero, or that are no numbers."""
    size = np.ptp(points, axis=0).max(initial=0.0)
    if not np.isfinite(points).all() or not (size == 0 or SMALLEST < size < LARGEST):
        raise ValueError(
            f"the corners of the tool are {size:.3g} apart: give finite coordinates in a unit of "
            f"length in which that is between {SMALLEST:g} and {LARGEST:g}"
        )


def _Facets(points: np.ndarray, corners: np.ndarray, closed: bool) -> Tool:
    _CheckSize(points)
    flat = np.asarray(points, float).ravel(), np.asarray(corners, np.int32).ravel()
    return Tool(ToolShape.Facets(*flat, points.shape[1], CheckFlag("closed", closed)))


def ReadSTL(file: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """Points and triangles of an STL file; corners of triangles that meet are one point."""
    data = Path(CheckInstance("file", file, (str, PathLike), "the name of a file")).read_bytes()
    corners = _Binary(data)
    if corners is None:
        corners = _Text(data)
    if corners is None:
        raise ValueError(f"file = {str(file)!r} is no STL file, or holds no triangles")
    if not np.isfinite(corners).all():
        raise ValueError(f"file = {str(file)!r} holds NaN or infinite coordinates")
    return _Merged(corners.reshape(-1, 3))


def _Binary(data: bytes) -> np.ndarray | None:
    """Corners (n, 3, 3) in the bytes of a binary file; None if it is none."""
    if len(data) <= HEADER:
        return None
    count = int.from_bytes(data[HEADER - 4 : HEADER], "little")
    if len(data) != HEADER + count * RECORD.itemsize:
        return None
    return np.frombuffer(data, RECORD, count, HEADER)["corners"].astype(float)


def _Text(data: bytes) -> np.ndarray | None:
    number = rb"\s+([-+.\deEinfNa]+)"
    found = re.findall(rb"vertex" + 3 * number, data)
    if not found or len(found) % 3 or not data.lstrip().startswith(b"solid"):
        return None
    return np.array(found).astype(float)


def _Merged(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, d) of which d in a row make a facet: those that are the same become one.

    Facets of which nothing is left then are dropped.
    """
    size = np.ptp(points, axis=0).max()
    pairs = scipy.spatial.cKDTree(points).query_pairs(SAME * size, output_type="ndarray")
    graph = scipy.sparse.csr_matrix((np.ones(len(pairs)), pairs.T), shape=2 * (len(points),))
    _, number = scipy.sparse.csgraph.connected_components(graph, directed=False)
    _, first = np.unique(number, return_index=True)
    facets = number.reshape(-1, points.shape[1])
    sides = facets - np.roll(facets, 1, axis=1)
    return points[first], facets[np.all(sides != 0, axis=1)]


def FacetsOfMesh(mesh: Mesh, boundary: str, divisions: int | None) -> tuple[np.ndarray, np.ndarray]:
    """Boundary faces whose names match, with normals out of the body behind them."""
    CheckInstance("mesh", mesh, Mesh, "an ngsolve.Mesh")
    region = RegionWithFaces(mesh, "boundary", boundary)
    if divisions is None:
        divisions = 1 if mesh.GetCurveOrder() == 1 else DIVISIONS
    corners = FacetCorners(region, CheckCount("divisions", divisions))
    return _Merged(np.reshape(corners, (-1, mesh.dim)))


def FacetsOfShape(shape: TopoDS_Shape, maxh: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Triangles on the surface of a body."""
    CheckInstance("shape", shape, TopoDS_Shape, "a body of netgen.occ")
    low, high = (np.array([p.x, p.y, p.z]) for p in shape.bounding_box)
    size = float(np.linalg.norm(high - low))
    maxh = size / PARTS if maxh is None else CheckPositive("maxh", maxh)
    mesh = OCCGeometry(shape).GenerateMesh(maxh=maxh, perfstepsend=MeshingStep.MESHSURFACE)
    nodes = mesh.Elements2D().NumPy()["nodes"].astype(int) - 1
    if not len(nodes):
        raise ValueError("shape has no faces: give a body in 3D")
    return np.array(mesh.Coordinates()), nodes
