"""A ring of two halves that are tied along their cuts, of meshes that do not match."""

import math

from ngslac.meshes.geometry import Arc, Body, GenerateMesh, Line

INNER, OUTER = 1.0, 2.0


def on_circle(radius, height):
    return lambda angle: (radius * math.cos(angle), radius * math.sin(angle) + height)


def half(name, start, height, cut, count):
    """Half a ring that begins at an angle; both cuts have the name and number of edges."""
    end, inner, outer = start + math.pi, on_circle(INNER, height), on_circle(OUTER, height)
    sides = [
        Line(inner(start), outer(start), cut, count),
        Arc(outer, start, end, f"rim_{name}"),
        Line(outer(end), inner(end), cut, count),
        Arc(inner, end, start, f"bore_{name}"),
    ]
    return Body(sides, name)


def halves_mesh(gap=0.0, *, h=0.4):
    """The upper half is raised by the gap."""
    bodies = [half("upper", 0.0, gap, "slave", 5), half("lower", math.pi, 0.0, "master", 4)]
    return GenerateMesh(bodies, order=2, maxh=h, grading=0.5)
