"""Meshes of round bodies: a cord under a plate, and a disc in a ring."""

import math

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

RADIUS = 50.0


def _Circle(radius):
    """About the origin, by the angle from the y axis, clockwise."""
    return lambda t: (radius * math.sin(t), radius * math.cos(t))


def CordMesh(h, *, zone=1.25):
    """A quarter of a round cord of radius 50 below a flat, rigid plate that it touches.

    Bodies (materials): "rubber", "plate". Boundaries: "slave" (the arc from the top), "free" (the
    rest of the arc), "symx" (x = 0), "symy" (y = 0), "master" and "back" (the plate).

    The slave edges have the length `h`, the plate's are 0.73 times as long; `zone` is the angle of
    the slave arc in radians.
    """
    r = RADIUS
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


def DiscInRing(h, *, clearance, outer=100.0):
    """A quarter of a disc of radius 50 inside of a ring, with a clearance.

    Bodies (materials): "disc", "ring". Boundaries: "slave" (the disc's rim), "master" (the ring's
    inner side), "outer", "symx" (x = 0), "symy" (y = 0).

    The slave edges have the length `h`, the ring's are 0.73 times as long; the clearance is radial.
    The mesh is curved of order 3.
    """
    r, inner = RADIUS, RADIUS + clearance
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
