"""Mesh of a rigid cylinder above a block, half of it."""

from __future__ import annotations

import math
from itertools import pairwise

from ngslac.meshes.geometry import (
    Arc,
    Body,
    CheckNonMatching,
    CheckPositive,
    Divisions,
    GenerateMesh,
    Line,
    NonMatchingDivisions,
    Polygon,
    Touching,
)

__all__ = ["IndentationMesh"]

_RADIUS = 100.0


def IndentationMesh(h, *, radius=100.0, zone=5.0, size=40.0, grading=0.3):
    """Mesh of half a block and of the lowest part of a cylinder that touches it at the origin.

    Bodies (materials): "block" and "cylinder", of which only a slice above the arc is meshed: it is
    meant to be rigid. Boundaries: "slave" (the block's top where contact can be), "top" (the rest),
    "side", "bottom", "sym" (x = 0, block); "master" (the arc) and "back" (all else of the
    cylinder).

    Parameters
    ----------
    h : float
        Edge length on the slave side; the arc's edges are nearly twice as long, and curved.
    radius : float
        Of the cylinder.
    zone : float
        Half width of the slave side.
    size : float
        Half width and height of the block.
    grading
        See `ngslac.meshes`.

    Returns
    -------
    ngsolve.Mesh
        Curved of order 3.
    """
    CheckPositive(h=h, radius=radius, zone=zone, size=size)
    scale = radius / _RADIUS  # meshed with this radius: netgen has absolute lengths inside
    h, zone, size = h / scale, zone / scale, size / scale
    if not zone < min(0.8 * size, 0.5 * _RADIUS):
        raise ValueError(f"zone = {zone * scale:g} is too long for the block or the cylinder")
    mesh = GenerateMesh(
        [_Block(size, zone, Divisions(zone, h)), _Cylinder(zone, Divisions(zone, h))],
        order=3,
        scale=scale,
        maxh=size / 5,
        grading=grading,
    )
    CheckNonMatching(mesh)
    return mesh


def _Block(size, zone, count):
    corners = [(0, -size), (size, -size), (size, 0), (zone, 0), (0, 0)]
    return Polygon(corners, ("bottom", "side", "top", "slave", "sym"), "block", slave=count)


def _Cylinder(zone, count):
    """The slice between the arc and a level line; its nodes avoid those of the slave side."""
    reach = 1.1 * zone
    angle = math.asin(reach / _RADIUS)
    nodes = [_RADIUS * math.asin(k * zone / count / _RADIUS) for k in range(count + 1)]
    edges = NonMatchingDivisions(nodes, 0, _RADIUS * angle, 1.8 * zone / count)
    point, level = Touching(_RADIUS), _RADIUS * (1 - math.cos(angle)) + 0.3 * zone
    corners = [point(angle), (reach, level), (0, level), point(0)]
    back = [Line(p, q, "back") for p, q in pairwise(corners)]
    return Body([Arc(point, 0, angle, "master", edges), *back], "cylinder")
