# SPDX-License-Identifier: LGPL-2.1-or-later
"""Rigid tools without a mesh, and their motion.

A tool is given by its signed distance in the coordinates of the space, > 0 outside. It is the
`obstacle` of a `LACContact` with ``finite=True``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from ngsolve import CoefficientFunction

from ngslac._ngslac import ToolShape
from ngslac.arguments import (
    CheckInstance,
    CheckNumber,
    CheckPoint,
    CheckPositive,
    CheckValues,
    Coefficient,
    Wrong,
)
from ngslac.facets import FromMesh, FromShape, FromSTL, Polygon
from ngslac.tool import Direction, Tool

__all__ = [
    "Cone",
    "Cylinder",
    "FromMesh",
    "FromSTL",
    "FromShape",
    "Plane",
    "Polygon",
    "Revolved",
    "SignedDistance",
    "Sphere",
    "Tool",
    "Torus",
]


def Plane(point: Sequence[float], normal: Sequence[float]) -> Tool:
    """The half space behind a plane, in 2D behind a line.

    Parameters
    ----------
    point : (d,) array-like
        Of the plane.
    normal : (d,) array-like
        Out of the tool; of any length.

    Returns
    -------
    Tool

    Raises
    ------
    ValueError, TypeError
        Another number of coordinates, a direction of zeros, a length that is not positive.

    Examples
    --------
    >>> from ngslac import tools
    >>> tools.Plane((0, 0, 1), (0, 0, 2)).Distance([(5, 5, 3)]).tolist()
    [2.0]
    """
    dim = _Dimension("point", point)
    place = CheckPoint("point", point, dim), Direction("normal", normal, dim)
    return Tool(ToolShape.HalfSpace(*place))


def Sphere(center: Sequence[float], radius: float) -> Tool:
    """A ball, in 2D a disc; a plane roll.

    Result and errors are as in `Plane`.

    Parameters
    ----------
    center : (d,) array-like
    radius : float

    Examples
    --------
    >>> from ngslac import tools
    >>> tools.Sphere((0, 1), 1).Distance([(0, 3), (0, 1)]).tolist()
    [1.0, -1.0]
    """
    dim = _Dimension("center", center)
    place = CheckPoint("center", center, dim), CheckPositive("radius", radius)
    return Tool(ToolShape.Ball(*place, np.zeros(dim)))


def Cylinder(point: Sequence[float], axis: Sequence[float], radius: float) -> Tool:
    """An infinite cylinder in 3D.

    Result and errors are as in `Plane`.

    Parameters
    ----------
    point : (3,) array-like
        Of its axis.
    axis : (3,) array-like
        Direction.
    radius : float

    Examples
    --------
    >>> from ngslac import tools
    >>> tools.Cylinder((0, 0, 0), (0, 0, 1), 2).Distance([(3, 0, 7)]).tolist()
    [1.0]
    """
    place = CheckPoint("point", point, 3), CheckPositive("radius", radius)
    return Tool(ToolShape.Ball(*place, Direction("axis", axis, 3)))


def Cone(apex: Sequence[float], axis: Sequence[float], half_angle: float) -> Tool:
    """An infinite cone in 3D.

    Result and errors are as in `Plane`.

    Parameters
    ----------
    apex : (3,) array-like
    axis : (3,) array-like
        From the apex into the cone.
    half_angle : float
        Between axis and flank, in radians, less than a right angle.

    Examples
    --------
    >>> from ngslac import tools
    >>> from math import pi
    >>> cone = tools.Cone((0, 0, 0), (0, 0, 1), pi / 4)
    >>> cone.Distance([(0, 0, -2), (1, 0, 1)]).round(12).tolist()
    [2.0, 0.0]
    """
    wanted = "an angle between 0 and pi/2"
    angle = CheckNumber("half_angle", half_angle, wanted, lambda a: 0 < a < np.pi / 2)
    return Tool(
        ToolShape.Revolution(
            ToolShape.Wedge(angle), CheckPoint("apex", apex, 3), Direction("axis", axis, 3)
        )
    )


def Torus(center: Sequence[float], axis: Sequence[float], radius: float, tube: float) -> Tool:
    """A ring with a round section in 3D.

    Result and errors are as in `Plane`.

    Parameters
    ----------
    center : (3,) array-like
    axis : (3,) array-like
        Direction.
    radius : float
        Of the circle in the middle of the tube.
    tube : float
        Radius of the tube.

    Examples
    --------
    >>> from ngslac import tools
    >>> tools.Torus((0, 0, 0), (0, 0, 1), 3, 1).Distance([(3, 0, 2), (0, 0, 0)]).tolist()
    [1.0, 2.0]
    """
    profile = Sphere((CheckPositive("radius", radius), 0), CheckPositive("tube", tube))
    return Revolved(profile, center, axis)


def Revolved(profile: Tool, point: Sequence[float], axis: Sequence[float]) -> Tool:
    """A tool in 2D turned about an axis: its x is the distance from the axis, its y that along.

    Result and errors are as in `Plane`.

    Parameters
    ----------
    profile : Tool
        In 2D, at rest. What lies at x < 0 does not count, but goes on there: mirror what crosses
        the axis.
    point : (3,) array-like
        Of the axis, where y is 0.
    axis : (3,) array-like
        Direction of y.

    Examples
    --------
    A punch with a flat end and a rounded rim:

    >>> from ngslac import tools
    >>> half = tools.Polygon([(-0.8, 0.2), (0.8, 0.2), (0.8, 5), (-0.8, 5)]).Grown(0.2)
    >>> tools.Revolved(half, (0, 0, 0), (0, 0, 1)).Distance([(0, 0, -1), (2, 0, 2)]).tolist()
    [1.0, 1.0]
    """
    if CheckInstance("profile", profile, Tool, "a tool in 2D").dim != 2:
        raise ValueError("profile must be a tool in 2D, got one in 3D")
    place = CheckPoint("point", point, 3), Direction("axis", axis, 3)
    return Tool(ToolShape.Revolution(profile._AtRest(), *place))


def SignedDistance(function: CoefficientFunction, *, dim: int = 3) -> Tool:
    """A tool given by a function of the coordinates.

    Parameters
    ----------
    function : CoefficientFunction
        Of x, y (and z) and of Parameters, < 0 inside: the distance from the tool, or what is near
        it where that is small. Its derivatives up to the second are formed symbolically; where
        they have no value, as in the middle of a ball, nothing touches.
    dim : int
        Of the space, 2 or 3.

    Returns
    -------
    Tool

    Raises
    ------
    TypeError, ValueError, ngsolve.NgException
        A function that has no value away from the mesh, has no derivatives or does not depend on
        the coordinates.

    Examples
    --------
    >>> from ngsolve import Parameter, sqrt, x, y
    >>> from ngslac import tools
    >>> radius = Parameter(1)
    >>> disc = tools.SignedDistance(sqrt(x**2 + y**2) - radius, dim=2)
    >>> radius.Set(2)
    >>> disc.Distance([(3, 4)]).tolist()
    [3.0]
    """
    CheckInstance("function", function, CoefficientFunction, "a function of x, y, z")
    wanted = "2 or 3"
    dim = int(CheckNumber("dim", dim, wanted, lambda number: number in (2, 3)))
    function = Coefficient("function", CheckValues("function", function))
    return Tool(ToolShape.Expression(function, dim))


def _Dimension(name: str, value: Sequence[float]) -> int:
    """The number of coordinates of a point, 2 or 3."""
    try:
        dim = len(value)
    except TypeError:
        dim = 0
    if dim not in (2, 3):
        raise Wrong(TypeError, name, value, "a point with 2 or 3 coordinates")
    return dim
