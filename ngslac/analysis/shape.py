# SPDX-License-Identifier: LGPL-2.1-or-later
"""Changes of shape: the points of a mesh move along a field."""

from itertools import combinations

import numpy as np
from ngsolve import CF, ET, VOL, CoefficientFunction, IntegrationRule, Mesh, x, y, z

from ngslac.arguments import CheckDisplacement, CheckInstance, CheckNumber
from ngslac.errors import RefuseCopy

__all__ = ["Shape"]

# Corners of the reference elements.
CORNERS = {
    ET.TRIG: [(0, 0), (1, 0), (0, 1)],
    ET.QUAD: [(0, 0), (1, 0), (1, 1), (0, 1)],
    ET.TET: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    ET.PYRAMID: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)],
    ET.PRISM: [(i, j, k) for k in (0, 1) for i, j in ((0, 0), (1, 0), (0, 1))],
    ET.HEX: [(i, j, k) for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))],
}
# Points of a hexahedron: corners, and middles between two of them.
MOST = 36


class Shape:
    """A design variable: how far the points of a mesh move along a velocity field.

    What moves are the points of the mesh, and with them straight elements. Edges that ``Curve`` has
    bent keep how far they bend away from the straight line; where that has to change, too, make
    the mesh of second order instead, ``ngmesh.SecondOrder()``, whose points in the middle of edges
    move. Give a field that leaves elements in good shape inside of bodies, too, such as the
    solution of an elastic problem.

    Parameters
    ----------
    mesh : Mesh
    velocity : CoefficientFunction or GridFunction
        With d components; positions change by it for each unit of `Move`.

    Attributes
    ----------
    velocity : (points, d) array
        At the points of the mesh.

    Raises
    ------
    TypeError, ValueError
        `velocity` is no real field with d components, is zero everywhere or has no value somewhere;
        the mesh is distributed.

    Examples
    --------
    >>> from ngsolve import CF, Integrate, x
    >>> from ngslac.analysis import Shape
    >>> area, shape = Integrate(1, mesh), Shape(mesh, CF((x, 0)))
    >>> shape.Move(0.5)
    >>> round(Integrate(1, mesh) / area, 9)
    1.5
    >>> shape.Move(-0.5)
    """

    __deepcopy__ = __reduce_ex__ = RefuseCopy

    def __init__(self, mesh: Mesh, velocity: CoefficientFunction | tuple[CoefficientFunction, ...]):
        CheckInstance("mesh", mesh, Mesh, "an ngsolve.Mesh")
        if mesh.comm.size > 1:
            raise ValueError(
                "mesh is distributed, and its points cannot be moved: take one process"
            )
        if isinstance(velocity, tuple):
            velocity = CF(velocity)
        CheckInstance(
            "velocity", velocity, CoefficientFunction, f"a field with {mesh.dim} components"
        )
        CheckDisplacement("velocity", velocity, mesh)
        self.mesh, self.velocity = mesh, AtPoints(mesh, velocity)
        if not np.all(np.isfinite(self.velocity)):
            raise ValueError("velocity is NaN or infinite somewhere")
        if not np.any(self.velocity):
            raise ValueError("velocity is zero at all points of the mesh, nothing would move")

    def __repr__(self) -> str:
        return f"<Shape: {np.count_nonzero(np.any(self.velocity, axis=1))} points move>"

    def Points(self) -> np.ndarray:
        """The positions (points, d) of the mesh, to be written to.

        Raises
        ------
        ValueError
            The mesh was refined since.
        """
        points = self.mesh.ngmesh.Coordinates()
        if points.shape != self.velocity.shape:
            raise ValueError("the mesh was refined: make a new Shape")
        return points

    def Move(self, way: float) -> None:
        """Move the points by a factor of the velocity.

        Call ``contact.Update()`` of each contact afterwards, and make a new ContactSolver.

        Parameters
        ----------
        way : float
            Also negative.
        """
        self.Points()[:] += CheckNumber("way", way) * self.velocity


def AtPoints(mesh: Mesh, field: CoefficientFunction) -> np.ndarray:
    """Values (points, d) of a field at the points of a mesh, by its elements."""
    ngmesh, d = mesh.ngmesh, mesh.dim
    elements = ngmesh.Elements2D() if d == 2 else ngmesh.Elements3D()
    nodes = np.array(elements.NumPy()["nodes"], dtype=int)
    values = np.zeros(ngmesh.Coordinates().shape)
    samples = mesh.MapToAllElements({kind: Rule(kind) for kind in CORNERS if Dim(kind) == d}, VOL)
    place = CF((x, y, z)[:d])(samples).reshape(len(nodes), MOST, d)
    found = np.asarray(CF(field)(samples)).reshape(len(nodes), MOST, d)
    for column in nodes.T:  # the first, second, ... point of all elements
        there = np.flatnonzero(column)
        point = column[there] - 1
        away = np.linalg.norm(place[there] - ngmesh.Coordinates()[point][:, None], axis=2)
        values[point] = found[there, np.argmin(away, axis=1)]
    return values


def Dim(kind: ET) -> int:
    """Of an element type."""
    return len(CORNERS[kind][0])


def Rule(kind: ET) -> IntegrationRule:
    """Corners and middles between them, as many for each type."""
    corners = np.array(CORNERS[kind], dtype=float)
    middles = [(a + b) / 2 for a, b in combinations(corners, 2)]
    points = np.array([*corners, *middles])
    points = points[np.minimum(np.arange(MOST), len(points) - 1)]
    return IntegrationRule([tuple(point) for point in points.tolist()], [0.0] * MOST)
