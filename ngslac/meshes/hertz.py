# SPDX-License-Identifier: LGPL-2.1-or-later
"""Plane meshes of a cylinder on a block, for the Hertz problem."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import Mesh

from ngslac.meshes.geometry import (
    Arc,
    Body,
    CheckNonMatching,
    Divisions,
    GenerateMesh,
    Line,
    NonMatchingDivisions,
    Polygon,
    Side,
    Touching,
)
from ngslac.meshes.sizes import (
    FLATTEST,
    CheckAlike,
    CheckElements,
    CheckGrading,
    CheckMoved,
    CheckOrder,
    CheckPositive,
    Graded,
)

if TYPE_CHECKING:
    from netgen.occ import Face

__all__ = ["HertzMesh"]


_RADIUS = 50.0  # all is meshed with this radius: netgen has absolute lengths inside


def HertzMesh(
    h: float,
    *,
    radius: float = 50.0,
    width: float = 100.0,
    height: float = 200.0,
    ratio: float = 0.73,
    order: int = 2,
    half: bool = True,
    zone: float | None = None,
    grading: float | None = None,
    scale: float = 1.0,
    angle: float = 0.0,
) -> Mesh:
    """Mesh of a cylinder on a block, fine and non-matching in the contact zone.

    The lowest point of the cylinder touches the block at the origin. Bodies (materials) are
    "cylinder" and "block". Boundaries: "slave" and "master" (contact), "arc" (rest of the
    cylinder), "top" (rest of the block's top), "bottom", "side", and "sym" (line x = 0, only
    in the half model). Vertices: "load" (top of the cylinder), "foot" (its lowest point).

    Parameters
    ----------
    h : float
        Edge length on the slave side; on the master side it is about ``ratio * h``.
    radius, width, height : float
        Radius of the cylinder, half width and height of the block.
    ratio : float
        Master size over slave size.
    half : bool
        Half model (x >= 0) or the full one.
    zone : float, optional
        Length of the slave arc on each side of the origin, by default ``0.3 * radius``. The
        master edge is a fifteenth longer.
    order, grading, scale, angle
        See `ngslac.meshes`. By default the grading decreases slowly with `h`, so that the whole
        mesh is refined.

    Returns
    -------
    ngsolve.Mesh
    """
    CheckPositive(h=h, radius=radius, width=width, height=height, ratio=ratio)
    CheckMoved(scale, angle)
    CheckOrder(order)
    size = radius / _RADIUS
    h, width, height = h / size, width / size, height / size
    zone = 0.3 * _RADIUS if zone is None else zone / size
    CheckPositive(zone=zone)
    CheckAlike(zone=zone * size, radius=radius, width=width * size, height=height * size)
    if not (zone * 16 / 15 < width and zone < 1.5 * _RADIUS):
        raise ValueError("zone is too long for the cylinder or the block")
    grading = min(0.12 * math.sqrt(2 * h), 0.3) if grading is None else grading
    CheckPositive(grading=grading)
    fine, largest = h * min(1.0, ratio), max(_RADIUS, width, height)
    number = Graded(fine, max(grading, FLATTEST), 2 * zone, 2 * largest, 2)
    CheckElements(number, h=h * size, ratio=ratio, grading=grading)
    CheckGrading(grading)
    ns, nm = _HertzDivisions(h, ratio, zone, half)
    mesh = GenerateMesh(
        [_Cylinder(zone, ns, half), _Block(width, height, zone * 16 / 15, nm, half)],
        order=order,
        scale=scale * size,
        angle=angle,
        maxh=_RADIUS / 5,
        grading=grading,
    )
    CheckNonMatching(mesh)
    return mesh


def _HertzDivisions(h: float, ratio: float, zone: float, half: bool) -> tuple[int, int]:
    """Return the numbers of slave edges (per side) and of master edges (in all)."""
    ns = Divisions(zone, h)
    slave = _RADIUS * np.sin(np.linspace(-zone, zone, 2 * ns + 1) / _RADIUS)
    end = zone * 16 / 15
    if half:
        return ns, NonMatchingDivisions(slave[ns:], 0, end, ratio * zone / ns)
    return ns, NonMatchingDivisions(slave, -end, end, ratio * zone / ns)


def _Cylinder(zone: float, ns: int, half: bool) -> Face:
    """The (half) disc; the slave arc begins at the origin."""
    sides = _Arcs(zone, ns, 1)
    sides += [Line((0, 2 * _RADIUS), (0, 0), "sym")] if half else _Arcs(zone, ns, -1)[::-1]
    face = Body(sides, "cylinder")
    for vertex in face.vertices:
        if abs(vertex.p.x) < 1e-6 * _RADIUS:
            vertex.name = "foot" if vertex.p.y < _RADIUS else "load"
    return face


def _Arcs(zone: float, ns: int, side: int) -> list[Side]:
    """Arcs from the lowest to the highest point on one side (1 right, -1 left), both upwards."""
    angles = [0, zone / _RADIUS, (zone / _RADIUS + math.pi) / 2, math.pi]
    names = [("slave", ns), ("arc", None), ("arc", None)]
    return [
        Arc(Touching(_RADIUS), *(side * t for t in ends[::side]), *name)
        for ends, name in zip(pairwise(angles), names, strict=True)
    ]


def _Block(width: float, height: float, end: float, nm: int, half: bool) -> Face:
    """The block below y = 0, its master edge from the symmetry line (or -end) to end."""
    left = 0 if half else -width
    points = [(left, -height), (width, -height), (width, 0), (end, 0)]
    points += [(0, 0)] if half else [(-end, 0), (left, 0)]
    names = ["bottom", "side", "top", "master", *(["sym"] if half else ["top", "side"])]
    return Polygon(points, names, "block", master=nm)
