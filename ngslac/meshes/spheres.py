# SPDX-License-Identifier: LGPL-2.1-or-later
"""Spheres in contact: meshes for Hertz, Mindlin and twist problems in 3D."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

from netgen.occ import ArcOfCircle, Axis, Box, Face, Glue, Pnt, Sphere, TopoDS_Shape, Y, Z
from ngsolve import Mesh

from ngslac.meshes.geometry import CheckNonMatching, GenerateMesh3D
from ngslac.meshes.sizes import (
    CheckAlike,
    CheckElements,
    CheckGrading,
    CheckOrder,
    CheckPositive,
    Graded,
)

__all__ = ["SphereOnBlock", "TwoSpheres"]

_RADIUS = 50.0  # all is meshed with this radius of the upper sphere: Netgen has absolute lengths


def SphereOnBlock(
    h: float,
    *,
    radius: float = 50.0,
    zone: float | None = None,
    width: float | None = None,
    height: float | None = None,
    ratio: float = 1.2,
    model: str = "quarter",
    order: int = 2,
    grading: float = 0.45,
    maxh: float | None = None,
    scale: float = 1.0,
    rotation: tuple[str | Sequence[float], float] | None = None,
) -> Mesh:
    """Mesh of the lower half of a sphere on a block, fine and non-matching where they touch.

    The lowest point of the sphere touches the block at the origin; z points up. Bodies
    (materials) are "sphere" and "block". Boundaries: "slave" and "master" (round faces about the
    origin), "cap" (rest of the sphere), "top" (its flat upper side at ``z = radius``),
    "surface" (rest of the block's top), "bottom", "side", and the symmetry planes "sym_x" (x =
    0, only in the quarter model) and "sym_y" (y = 0, not in the full model).

    Parameters
    ----------
    h : float
        Size of the elements on the slave side; on the master side it is ``ratio * h``.
    radius : float
        Radius of the sphere.
    zone : float, optional
        Radius of the slave face, which has to contain the contact area; by default ``0.13 *
        radius``, which suits a contact radius of a tenth of the sphere's. The master face is
        wider by a fifteenth. Some 1.3 times the contact radius is a good value.
    width, height : float, optional
        Half width and height of the block, by default ``2 * radius``.
    ratio : float
        Master size over slave size.
    model : {"quarter", "half", "full"}
        x, y >= 0; or y >= 0, for tangential loads in x; or all.
    maxh : float, optional
        Largest size of elements, by default ``radius / 2``.
    order, grading, scale, rotation
        See `ngslac.meshes`. With the default grading the quarter model with twelve elements along
        the contact radius has about 28,000 displacements of order 2. For order 1 a grading of 0.2
        is better: elements that grow fast with the depth are too stiff.

    Returns
    -------
    ngsolve.Mesh

    Examples
    --------
    >>> from ngslac.meshes.spheres import SphereOnBlock
    >>> mesh = SphereOnBlock(2.0, radius=50, zone=6.5)
    >>> mesh.GetMaterials()
    ('sphere', 'block')
    >>> sorted(set(mesh.GetBoundaries()))[:5]
    ['bottom', 'cap', 'master', 'side', 'slave']
    """
    width = 2 * radius if width is None else width
    height = 2 * radius if height is None else height
    CheckPositive(h=h, radius=radius, width=width, height=height, ratio=ratio, scale=scale)
    zone = _Zone(zone, radius, model)
    CheckAlike(zone=zone, radius=radius, width=width, height=height)
    _CheckSizes(h, ratio, grading, maxh, max(radius, width, height), zone, order)
    size = radius / _RADIUS
    zone, h = zone / size, h / size
    if zone * 16 / 15 >= width / size:
        raise ValueError("zone is too wide for the block")

    def Below(distance: float) -> TopoDS_Shape:
        return _Block(model, width / size, height / size, zone * 16 / 15, ratio * h, -distance)

    above = _Cap(model, _RADIUS, zone, h, ("sphere", "slave", "cap", "top"))
    return _Mesh(above, Below, size, order, scale, rotation, maxh, grading)


def TwoSpheres(
    h: float,
    *,
    radius: float = 50.0,
    radius_lower: float | None = None,
    zone: float | None = None,
    ratio: float = 1.2,
    model: str = "quarter",
    order: int = 2,
    grading: float = 0.45,
    maxh: float | None = None,
    scale: float = 1.0,
    rotation: tuple[str | Sequence[float], float] | None = None,
) -> Mesh:
    """Mesh of the lower half of a sphere on the upper half of another one.

    They touch at the origin; z points up. Bodies (materials) are "upper" and "lower". Boundaries:
    "slave" and "master" (round faces about the origin), "cap_upper" and "cap_lower" (the rest of
    the spheres), "top" and "bottom" (the flat sides, at ``z = radius`` and ``z =
    -radius_lower``), "sym_x" and "sym_y" as in `SphereOnBlock`.

    Parameters
    ----------
    radius, radius_lower : float
        Radii of the upper and the lower sphere, by default equal.
    h, zone, ratio, model, order, grading, maxh, scale, rotation
        As in `SphereOnBlock`.

    Returns
    -------
    ngsolve.Mesh

    Examples
    --------
    >>> from ngslac.meshes.spheres import TwoSpheres
    >>> TwoSpheres(4.0, zone=13.0).GetMaterials()
    ('upper', 'lower')
    """
    radius_lower = radius if radius_lower is None else radius_lower
    CheckPositive(h=h, radius=radius, radius_lower=radius_lower, ratio=ratio, scale=scale)
    zone = _Zone(zone, radius, model)
    CheckAlike(zone=zone, radius=radius, radius_lower=radius_lower)
    _CheckSizes(h, ratio, grading, maxh, max(radius, radius_lower), zone, order)
    size = radius / _RADIUS
    zone, h, lower = zone / size, h / size, radius_lower / size
    if zone * 16 / 15 >= 0.9 * lower:
        raise ValueError("zone is too wide for the lower sphere")

    above = _Cap(model, _RADIUS, zone, h, ("upper", "slave", "cap_upper", "top"))
    names = ("lower", "master", "cap_lower", "bottom")
    below = _Cap(model, lower, zone * 16 / 15, ratio * h, names, -1)

    def Below(distance: float) -> TopoDS_Shape:
        return below.Move((0, 0, -distance))

    return _Mesh(above, Below, size, order, scale, rotation, maxh, grading)


def _Mesh(
    above: TopoDS_Shape,
    Below: Callable[[float], TopoDS_Shape],
    size: float,
    order: int,
    scale: float,
    rotation: tuple[str | Sequence[float], float] | None,
    maxh: float | None,
    grading: float,
) -> Mesh:
    """Mesh the upper body and the lower one, moved down by a distance at first."""
    maxh = _RADIUS / 2 if maxh is None else maxh / size
    mesh = GenerateMesh3D(
        lambda distance: [above, Below(distance)],
        order=order,
        scale=scale * size,
        rotation=rotation,
        maxh=maxh,
        grading=grading,
    )
    CheckNonMatching(mesh)
    return mesh


def _CheckSizes(
    h: float, ratio: float, grading: float, maxh: float | None, size: float, zone: float, order: int
) -> None:
    """Refuse invalid sizes, and those that make too many elements, before meshing."""
    CheckOrder(order)
    CheckGrading(grading)
    CheckPositive(maxh=size if maxh is None else maxh)
    number = Graded(h * min(1.0, ratio), grading, zone, size, 3)
    number += 0 if maxh is None else 6 * (size / maxh) ** 3
    CheckElements(number, h=h, ratio=ratio, grading=grading, maxh=maxh or size / 2)


# ---------------------------------------------------------------- shapes


def _Zone(zone: float | None, radius: float, model: str) -> float:
    """The radius of the contact zone, checked; by default a part of that of the sphere."""
    zone = 0.13 * radius if zone is None else zone
    CheckPositive(zone=zone)
    if zone >= 0.9 * radius:
        raise ValueError("zone is too wide for the sphere")
    if model not in ("quarter", "half", "full"):
        raise ValueError(f'model must be "quarter", "half" or "full", but is {model!r}')
    return zone


def _Space(model: str, size: float, low: float, high: float) -> TopoDS_Shape:
    """The part of space that a model consists of, between two heights."""
    x, y = (0.0 if model == "quarter" else -size), (-size if model == "full" else 0.0)
    return Box(Pnt(x, y, low), Pnt(size, size, high))


def _Imprint(solid: TopoDS_Shape, model: str, zone: float, height: float) -> TopoDS_Shape:
    """Divide the face about the origin by a circle of radius `zone` at a height."""
    angles = {"quarter": [0, 90], "half": [0, 180], "full": [0, 180, 360]}[model]

    def Point(degrees: float) -> Any:
        t = math.radians(degrees)
        return Pnt(zone * math.cos(t), zone * math.sin(t), height)

    arcs = [ArcOfCircle(Point(a), Point((a + b) / 2), Point(b)) for a, b in pairwise(angles)]
    return Glue([solid, *arcs]).solids[0]


def _Cap(
    model: str, radius: float, zone: float, h: float, names: Sequence[str], up: int = 1
) -> TopoDS_Shape:
    """The half of a sphere that touches the origin from above (or from below) with named faces."""
    body, contact, rest, far = names
    ball = Sphere(Pnt(0, 0, 0), radius)
    # Turn the seam of the parametrization to the half that is cut away, and its poles to the
    # great circle between the halves: outside of the quarter model, and away from the corners.
    ball = ball.Rotate(Axis(Pnt(0, 0, 0), Y), -90 * up)
    ball = ball.Rotate(Axis(Pnt(0, 0, 0), Z), -45)
    ball = ball.Move((0, 0, up * radius))
    height = up * (radius - math.sqrt(radius**2 - zone**2))
    low, high = sorted((-up * radius, up * radius))
    solid = _Imprint(ball * _Space(model, 2 * radius, low, high), model, zone, height)
    solid.name = body
    for face in solid.faces:
        face.name = rest
    _NameSymmetry(solid, model)
    max(solid.faces, key=lambda f: up * f.center.z).name = far
    _Fine(min(solid.faces, key=lambda f: up * f.center.z), contact, h)
    return solid


def _Block(
    model: str, width: float, height: float, zone: float, h: float, top: float
) -> TopoDS_Shape:
    """The block below z = `top` with named faces."""
    solid = _Imprint(_Space(model, width, top - height, top), model, zone, top)
    solid.name = "block"
    for face in solid.faces:
        face.name = "side"
    _NameSymmetry(solid, model)
    min(solid.faces, key=lambda f: f.center.z).name = "bottom"
    *_, outer, contact = sorted(solid.faces, key=lambda f: (round(f.center.z, 6), -f.mass))
    outer.name = "surface"
    _Fine(contact, "master", h)
    return solid


def _NameSymmetry(solid: TopoDS_Shape, model: str) -> None:
    if model == "quarter":
        min(solid.faces, key=lambda f: f.center.x).name = "sym_x"
    if model != "full":
        min(solid.faces, key=lambda f: f.center.y).name = "sym_y"


def _Fine(face: Face, name: str, h: float) -> None:
    face.name, face.maxh = name, h
    for edge in face.edges:
        edge.maxh = h
