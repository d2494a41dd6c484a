# SPDX-License-Identifier: LGPL-2.1-or-later
"""Meshes of round bodies: a cord under a plate, and a disc in a ring."""

from __future__ import annotations

import math

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
)
from ngslac.meshes.sizes import CheckAlike, CheckElements, CheckPositive, Graded

__all__ = ["CordMesh", "DiscInRing"]

_RADIUS = 50.0


def _Circle(radius):
    """About the origin, by the angle from the y axis, clockwise."""
    return lambda t: (radius * math.sin(t), radius * math.cos(t))


def CordMesh(h, *, zone=1.25) -> Mesh:
    """A quarter of a round cord of radius 50 below a flat, rigid plate that it touches.

    Bodies (materials): "rubber", "plate". Boundaries: "slave" (the arc from the top), "free" (the
    rest of the arc), "symx" (x = 0), "symy" (y = 0), "master" and "back" (the plate).

    Parameters
    ----------
    h : float
        Edge length on the slave side; the plate's edges are 0.73 times as long.
    zone : float
        Angle of the slave arc, in radians.

    Returns
    -------
    ngsolve.Mesh
    """
    CheckPositive(h=h, zone=zone)
    r = _RADIUS
    if not zone < math.pi / 2:
        raise ValueError(f"zone = {zone:g} must be an angle less than pi/2, in radians")
    CheckAlike(zone=zone, angle=math.pi / 2)
    CheckElements(Graded(0.73 * h, 0.3, 1.6 * r, 1.6 * r, 2), h=h)
    count = Divisions(r * zone, h)
    nodes = [r * math.sin(zone * k / count) for k in range(count + 1)]
    width, top = 1.6 * r, 1.2 * r
    cord = [
        Line((0, 0), (r, 0), "symy"),
        Arc(_Circle(r), math.pi / 2, zone, "free"),
        Arc(_Circle(r), zone, 0, "slave", count),
        Line((0, r), (0, 0), "symx"),
    ]
    corners, names = [(0, r), (width, r), (width, top), (0, top)], ("master", *["back"] * 3)
    other = NonMatchingDivisions(nodes, 0, width, 0.73 * h)
    bodies = [Body(cord, "rubber"), Polygon(corners, names, "plate", master=other)]
    mesh = GenerateMesh(bodies, order=2, maxh=r / 4, grading=0.3)
    CheckNonMatching(mesh)
    return mesh


def DiscInRing(h, *, clearance, outer=100.0) -> Mesh:
    """A quarter of a disc of radius 50 inside of a ring, with a clearance.

    Bodies (materials): "disc", "ring". Boundaries: "slave" (the disc's rim), "master" (the ring's
    inner side), "outer", "symx" (x = 0), "symy" (y = 0).

    Parameters
    ----------
    h : float
        Edge length on the slave side; the ring's edges are 0.73 times as long.
    clearance : float
        Radial gap, > 0.
    outer : float
        Outer radius of the ring.

    Returns
    -------
    ngsolve.Mesh
        Curved of order 3, with different numbers of edges on the two sides.
    """
    CheckPositive(h=h, clearance=clearance, outer=outer)
    CheckAlike(clearance=clearance, radius=_RADIUS, outer=outer)
    r, inner = _RADIUS, _RADIUS + clearance
    if not inner < outer:
        raise ValueError(f"outer = {outer:g} must be more than the inner radius, {inner:g}")
    CheckElements(2 * Graded(0.73 * h, 0.3, 2 * inner, outer, 2), h=h)
    length = math.pi / 2 * r
    count = Divisions(length, h)
    nodes = [length * k / count for k in range(count + 1)]
    other = NonMatchingDivisions(nodes, 0, length, 0.73 * h)
    disc = [
        Line((0, 0), (r, 0), "symy"),
        Arc(_Circle(r), math.pi / 2, 0, "slave", count),
        Line((0, r), (0, 0), "symx"),
    ]
    ring = [
        Line((inner, 0), (outer, 0), "symy"),
        Arc(_Circle(outer), math.pi / 2, 0, "outer"),
        Line((0, outer), (0, inner), "symx"),
        Arc(_Circle(inner), 0, math.pi / 2, "master", other),
    ]
    bodies = [Body(disc, "disc"), Body(ring, "ring")]
    return GenerateMesh(bodies, order=3, maxh=r / 4, grading=0.3)
