"""The mesh of the ironing problem: a die with a round foot above a slab."""

from __future__ import annotations

import math

import numpy as np
from netgen.occ import ArcOfCircle, Pnt, Segment

from ngslac.meshes.geometry import (
    Body,
    CheckPositive,
    Divisions,
    GenerateMesh,
    NonMatchingDivisions,
    Side,
)

__all__ = ["CLEARANCE", "HEIGHT", "LENGTH", "IroningMesh"]

LENGTH, HEIGHT = 12.0, 4.0  # of the slab, in mm
CLEARANCE = 0.2  # between slab and die
_LEFT, _RIGHT = 0.2, 1.4  # sides of the die
_CORNER, _TOP = 0.5, 1.4  # y of the ends of the arc and of the die's top
_RADIUS = 0.75


def IroningMesh(h=0.2, *, ratio=0.6, grading=0.3, order=2):
    """Mesh of the die above the left end of the slab, triangles, before any contact.

    The slab covers 0 <= x <= 12 and -4 <= y <= 0; the die is 1.2 wide and 0.9 high above an arc
    of radius 0.75, whose lowest point is 0.2 above the slab (code_aster SSNP153). Materials
    "die" and "slab"; boundaries "foot" (the arc), "flank" (both sides of the die), "top",
    "master" (the top of the slab), "bottom" and "side".

    Parameters
    ----------
    h : float
        Edge length on the top of the slab, in mm.
    ratio : float
        Edge length on the foot of the die over that of the slab.
    grading : float
        Growth of the element size into the bodies.
    order : int
        Order of the curved geometry.

    Returns
    -------
    ngsolve.Mesh
        No node of the foot is above a node of the slab.
    """
    CheckPositive(h=h, ratio=ratio, grading=grading)
    angle = math.asin((_RIGHT - _LEFT) / 2 / _RADIUS)
    foot = max(4, Divisions(2 * angle * _RADIUS, ratio * h))
    middle = (_LEFT + _RIGHT) / 2
    nodes = middle + _RADIUS * np.sin(np.linspace(-angle, angle, foot + 1))
    return GenerateMesh(
        [_Die(foot, middle), _Slab(NonMatchingDivisions(nodes, 0.0, LENGTH, h))],
        order=order,
        maxh=HEIGHT / 4,
        grading=grading,
    )


def _Die(foot, middle):
    flank = max(2, foot // 3)
    left, right = Pnt(_LEFT, _CORNER, 0), Pnt(_RIGHT, _CORNER, 0)
    upper = Pnt(_RIGHT, _TOP, 0), Pnt(_LEFT, _TOP, 0)
    return Body(
        [
            Side(ArcOfCircle(left, Pnt(middle, CLEARANCE, 0), right), "foot", foot),
            Side(Segment(right, upper[0]), "flank", flank),
            Side(Segment(*upper), "top", flank),
            Side(Segment(upper[1], left), "flank", flank),
        ],
        "die",
    )


def _Slab(count):
    points = [Pnt(0, -HEIGHT, 0), Pnt(LENGTH, -HEIGHT, 0), Pnt(LENGTH, 0, 0), Pnt(0, 0, 0)]
    names = ["bottom", "side", "master", "side"]
    sides = zip(points, [*points[1:], points[0]], names, strict=True)
    return Body(
        [Side(Segment(p, q), n, count if n == "master" else None) for p, q, n in sides], "slab"
    )
