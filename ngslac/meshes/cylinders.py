# SPDX-License-Identifier: LGPL-2.1-or-later
"""A slice of a cylinder on a block, of prisms: a plane mesh of triangles drawn into the depth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import Face, OCCGeometry
from ngsolve import BND, Mesh

from ngslac.meshes.boxes import Cells
from ngslac.meshes.geometry import (
    Arc,
    Body,
    CheckNonMatching,
    Line,
    Polygon,
    Touching,
)
from ngslac.meshes.sizes import CheckAlike, CheckElements, CheckGrading, CheckPositive, Graded

__all__ = ["THICKNESS", "CylinderOnBlock"]

THICKNESS = 1.0
LAYERS = {"cylinder": 2, "block": 3}


def CylinderOnBlock(
    h: float,
    *,
    radius: float = 50.0,
    zone: float | None = None,
    width: float | None = None,
    ratio: float = 1.2,
    model: str = "quarter",
    grading: float = 0.3,
    scale: float = 1.0,
) -> Mesh:
    """Mesh of a slice of the lower half of a cylinder on a block, of prisms.

    The cylinder's axis points along y, the slice lies between y = 0 and y = `THICKNESS` (times
    `scale`); z points up and the origin is the point of contact. Faces are straight; on the slave
    side they are quadrilaterals, two along the axis against three on the master side. Bodies are
    "cylinder" and "block"; boundaries "slave", "master", "top", "bottom", "side", the symmetry
    planes "sym_y" (both faces of the slice) and "sym_x" (x = 0, of the quarter model).

    Parameters
    ----------
    h : float
        Size of the slave faces across the axis; on the master side it is ``ratio * h``.
    radius, zone, width : float
        Radius of the cylinder, half width of the slave face (by default ``0.07 * radius``), half
        width and height of the block (by default ``2 * radius``).
    model : {"quarter", "full"}
        x >= 0, or all.
    grading, scale
        See `ngslac.meshes`.

    Returns
    -------
    ngsolve.Mesh

    Examples
    --------
    >>> from ngslac.meshes import CylinderOnBlock
    >>> CylinderOnBlock(1.0).GetMaterials()
    ('cylinder', 'block')
    """
    zone = 0.07 * radius if zone is None else zone
    width = 2 * radius if width is None else width
    CheckPositive(h=h, radius=radius, zone=zone, width=width, ratio=ratio, scale=scale)
    if model not in ("quarter", "full"):
        raise ValueError(f'model must be "quarter" or "full", but is {model!r}')
    if not zone < min(0.9 * radius, 0.9 * width):
        raise ValueError("zone is too wide")
    CheckGrading(grading)
    CheckAlike(zone=zone, radius=radius, width=width, thickness=THICKNESS)
    fine, layers = h * min(1.0, ratio), sum(LAYERS.values())
    number = Graded(fine, grading, 2 * zone, 2 * max(radius, width), 2)
    CheckElements(layers * number, h=h, ratio=ratio, grading=grading)
    full = model == "full"
    disc = _HalfDisc(radius, zone, full), h
    block = _Rectangle(width, zone * 16 / 15, full), ratio * h
    plane = []
    for face, fine in (disc, block):  # apart from each other, so that their sizes do not mix
        for edge in face.edges:
            edge.maxh = fine if edge.name in ("slave", "master") else 1e99
        geometry = OCCGeometry(face, dim=2)
        plane.append(Mesh(geometry.GenerateMesh(maxh=radius / 2, grading=grading)))
    mesh = _Extruded(plane, scale)
    CheckNonMatching(mesh)
    return mesh


def _HalfDisc(radius: float, zone: float, full: bool) -> Face:
    """The lower half of a disc that touches the origin from above."""
    point, end, right = Touching(radius), math.asin(zone / radius), math.pi / 2
    start = -end if full else 0
    sides = [Arc(point, start, end, "slave"), Arc(point, end, right, "cap")]
    if full:
        sides = [Arc(point, -right, -end, "cap"), *sides, Line(point(right), point(-right), "top")]
    else:
        centre = (0, radius)
        sides += [Line(point(right), centre, "top"), Line(centre, point(0), "sym_x")]
    return Body(sides, "cylinder")


def _Rectangle(width: float, zone: float, full: bool) -> Face:
    """The block below the origin."""
    start = -1 if full else 0
    x = [start * width, width, width, zone, start * zone]
    y = [-width, -width, 0, 0, 0]
    names = ["bottom", "side", "surface", "master", "sym_x"]
    if full:
        x, y, names = [*x, -width], [*y, 0], [*names[:-1], "surface", "side"]
    return Polygon(list(zip(x, y, strict=True)), names, "block")


def _Extruded(plane: Sequence[Mesh], scale: float) -> Mesh:
    """Draw the plane meshes of the bodies into the depth; their y becomes z."""
    out = NetgenMesh(dim=3)
    for mesh, (name, layers) in zip(plane, LAYERS.items(), strict=True):
        _Prisms(mesh, np.linspace(0, THICKNESS, layers + 1), scale).AddTo(out, name)
    out.Compress()
    return Mesh(out)


def _Prisms(mesh: Mesh, depth: np.ndarray, scale: float) -> Cells:
    """The prisms on the triangles of a plane mesh and their outer faces."""
    flat = np.array([v.point for v in mesh.vertices])
    number = np.arange(len(depth) * len(flat)).reshape(len(depth), len(flat))
    points = np.empty((*number.shape, 3))
    points[..., [0, 2]], points[..., 1] = flat, depth[:, None]
    cells, faces = [], []
    directed = set()
    for el in mesh.Elements():
        triangle = [v.nr for v in el.vertices]
        (ax, ay), (bx, by) = (flat[triangle[i]] - flat[triangle[0]] for i in (1, 2))
        if ax * by < ay * bx:
            triangle.reverse()
        cells += [(*far[triangle], *near[triangle]) for near, far in pairwise(number)]
        faces += [("sym_y", number[0][triangle]), ("sym_y", number[-1][triangle[::-1]])]
        directed |= {(triangle[i - 1], triangle[i]) for i in range(3)}
    for el in mesh.Elements(BND):
        a, b = (v.nr for v in el.vertices)
        side = [a, b] if (a, b) in directed else [b, a]
        faces += [(el.mat, (*near[side[::-1]], *far[side])) for near, far in pairwise(number)]
    as_numbers = [tuple(int(i) for i in cell) for cell in cells]
    named = [(name, tuple(int(i) for i in face)) for name, face in faces]
    return Cells(scale * points.reshape(-1, 3), as_numbers, named)
