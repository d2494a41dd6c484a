"""Data of the problems of the comparison, and the accuracy of a solution: the same for every peer.

Nothing here needs more than NumPy. Units are mm, N and MPa.

- `LineErrors` (hertz): the pressure along the slave edge, linear between the samples.
- `SphereErrors` (sphere): the pressure at the corners of the slave faces. A method whose pressures
  live elsewhere projects them in L2 to continuous functions that are linear on the faces.
- `PatchErrors` (patch): the displacement of the nodes; stresses are computed from it here.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from meshes import EDGES

__all__ = [
    "Errors",
    "LineErrors",
    "PatchErrors",
    "SphereErrors",
    "SphereFieldError",
    "SpherePlaces",
]

NU = 0.3
RADIUS = 50.0
YOUNG = {"cylinder": 210e3, "sphere": 210e3, "block": 70e3, "upper": 1e3, "lower": 1e3}

# Hertz: Johnson, Contact Mechanics (Cambridge, 1985), sections 4.2(c) and 3.4.
MODULUS = 1 / ((1 - NU**2) / YOUNG["cylinder"] + (1 - NU**2) / YOUNG["block"])
LINE_FORCE = 35e3  # N/mm on the whole cylinder: half of it on the half model
LINE_HALFWIDTH = float(np.sqrt(4 * LINE_FORCE * RADIUS / (np.pi * MODULUS)))
LINE_PEAK = 2 * LINE_FORCE / (np.pi * LINE_HALFWIDTH)
SPHERE_CONTACT_RADIUS = 5.0
SPHERE_FORCE = 4 * MODULUS * SPHERE_CONTACT_RADIUS**3 / (3 * RADIUS)  # N; a quarter on the model
SPHERE_PEAK = 3 * SPHERE_FORCE / (2 * np.pi * SPHERE_CONTACT_RADIUS**2)
PRESSURE = {"sphere": SPHERE_FORCE / (np.pi * RADIUS**2), "patch": 1.0}  # on the boundary "top"
STRAIN = PRESSURE["patch"] / YOUNG["upper"]


def LinePressure(x):
    """Hertz' pressure of the cylinder without friction."""
    return LINE_PEAK * np.sqrt(np.maximum(0, 1 - (np.asarray(x) / LINE_HALFWIDTH) ** 2))


def SpherePressure(r):
    return SPHERE_PEAK * np.sqrt(np.maximum(0, 1 - (np.asarray(r) / SPHERE_CONTACT_RADIUS) ** 2))


# ---------------------------------------------------------------- accuracy


def Errors(mesh, order, displacement, pressure):
    """The figures of a `PeerMesh`.

    Two functions are called as needed: `displacement` gives values at the nodes of an order, (n,
    dim), `pressure` values (n,) at all nodes, of which those of `order` on the slave side matter.
    """
    if mesh.problem == "patch":
        return PatchErrors(mesh, displacement())
    values, slave = pressure(), mesh.Nodes(order, "slave")
    if mesh.problem == "sphere":
        return SphereErrors(mesh.points, mesh.Faces(1, "slave"), values)
    return LineErrors(mesh.points[slave, 0], values[slave])


def LineErrors(x, pressure):
    """Compare the pressure of the cylinder with Hertz.

    From samples along the slave edge of the half model, in any order, > 0 in compression. ``peak``:
    largest sample over Hertz' peak, minus 1; ``l2``: relative error in L2 over one and a half times
    the half width; ``force``: relative error of the integral.
    """
    order = np.argsort(x)
    x, pressure = np.asarray(x, float)[order], np.asarray(pressure, float)[order]
    at = np.linspace(0, 1.5 * LINE_HALFWIDTH, 3001)
    exact = LinePressure(at)
    error = np.interp(at, x, pressure) - exact
    inside = np.linspace(0, x[-1], 3001)
    force = 2 * Trapezoid(np.interp(inside, x, pressure), inside)
    return {
        "peak": float(pressure.max() / LINE_PEAK - 1),
        "l2": float(np.sqrt(Trapezoid(error**2, at) / Trapezoid(exact**2, at))),
        "force": float(force / LINE_FORCE - 1),
    }


def Trapezoid(values, x):
    """Integral of samples (NumPy 2 renamed its own)."""
    return float(np.sum(np.diff(x) * 0.5 * (values[1:] + values[:-1])))


def SphereErrors(points, faces, pressure):
    """Compare the pressure of the sphere with Hertz; the same figures as of `LineErrors`.

    Of the nodes (n, 3) of the mesh with a pressure (n,) those at the corners of the slave faces
    count. It is linear on each face, and integrated over the plane of contact; the error, too, and
    not only at the corners.
    """
    corners = np.asarray(faces)[:, :3]
    flat, pressure = points[corners][..., :2], np.asarray(pressure)[corners]
    one, two = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    area = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    at = Centroids(PARTS)
    exact = SpherePressure(np.linalg.norm(np.einsum("kc,mcx->mkx", at, flat), axis=-1))
    error = ((pressure @ at.T - exact) ** 2).mean(axis=1)
    return {
        "peak": float(pressure.max() / SPHERE_PEAK - 1),
        "l2": float(np.sqrt(area @ error / (area @ (exact**2).mean(axis=1)))),
        "force": float(4 * area @ pressure.mean(axis=1) / SPHERE_FORCE - 1),
    }


def SphereFieldError(points, faces, pressure):
    """Relative error in L2 of a pressure that is given at the `SpherePlaces` of each face, (m, k).

    The same as ``l2`` of `SphereErrors`, of functions that are not linear on the faces.
    """
    corners = points[np.asarray(faces)[:, :3], :2]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    radius = np.linalg.norm(np.einsum("kc,mcx->mkx", SpherePlaces(), corners), axis=-1)
    exact = SpherePressure(radius)
    error = ((pressure - exact) ** 2).mean(axis=1)
    return float(np.sqrt(area @ error / (area @ (exact**2).mean(axis=1))))


def SpherePlaces():
    """Barycentric coordinates (k, 3) on each face where pressures are compared."""
    return Centroids(PARTS)


PARTS = 12  # of the edges of a face: Hertz' pressure has a steep edge


def Centroids(n):
    """Barycentric coordinates (n^2, 3) of the centroids of equal parts of a triangle."""
    upright = [(i + 1 / 3, j + 1 / 3) for i in range(n) for j in range(n - i)]
    inverted = [(i + 2 / 3, j + 2 / 3) for i in range(n - 1) for j in range(n - 1 - i)]
    b, c = np.array(upright + inverted).T / n
    return np.column_stack([1 - b - c, b, c])


def PatchErrors(mesh, displacement):
    """Compare the displacement (n, 3), at the corners or at all nodes, with the linear one.

    ``displacement``: relative error in L2; ``stress``: the largest error of the vertical stress
    over the pressure, at the corners of the elements; ``penetration``: by how much the mean of the
    upper body is too low, over the largest displacement. A penalty makes it, and all of
    ``displacement`` may be due to it.
    """
    order = 1 if len(displacement) == mesh.nvertices else 2
    elements, points = mesh.Elements(order), mesh.Points(order)
    error = displacement - PatchDisplacement(points)
    sides = points[elements[:, 1:4]] - points[elements[:, :1]]
    volume = np.linalg.det(sides)
    size = np.sqrt(SquareNorm(error[elements], volume, order))
    exact = np.sqrt(SquareNorm(PatchDisplacement(points)[elements], volume, order))
    stress = VerticalStress(displacement[elements], sides, order) / PRESSURE["patch"]
    return {
        "displacement": float(size / exact),
        "stress": float(np.abs(stress + 1).max()),
        "penetration": float(-error[mesh.MaterialNodes(1, "upper"), 2].mean() / (2 * STRAIN)),
    }


def PatchDisplacement(points):
    """The exact displacement: uniaxial compression, from the bottom at z = -1."""
    x, y, z = points.T
    return STRAIN * np.stack([NU * x, NU * y, -(z + 1)], axis=-1)


# ---------------------------------------------------------------- finite elements, by hand


def Shapes(order, at):
    """Shape functions (k, n) and their gradients (k, n, 3) on the reference tetrahedron."""
    values = np.column_stack([1 - at.sum(axis=1), at])
    gradients = np.vstack([-np.ones(3), np.eye(3)])
    if order == 1:
        return values, np.broadcast_to(gradients, (len(at), 4, 3))
    a, b = np.array(EDGES[3]).T
    corner = (4 * values - 1)[..., None] * gradients
    edge = 4 * (values[:, a, None] * gradients[b] + values[:, b, None] * gradients[a])
    shapes = np.hstack([values * (2 * values - 1), 4 * values[:, a] * values[:, b]])
    return shapes, np.concatenate([corner, edge], axis=1)


def SquareNorm(values, volume, order):
    """Square of the L2 norm of nodal values (m, n, 3) on elements of six times their volume."""
    x, w = np.polynomial.legendre.leggauss(4)
    r, s, t = 0.5 * (np.array(list(product(x, x, x))).T + 1)
    weights = np.prod(list(product(w, w, w)), axis=1) / 8
    at = np.column_stack([r, s * (1 - r), t * (1 - r) * (1 - s)])  # the cube collapsed
    shapes, _ = Shapes(order, at)
    mass = shapes.T @ ((weights * (1 - r) ** 2 * (1 - s))[:, None] * shapes)
    return float(np.einsum("mac,ab,mbc,m->", values, mass, values, volume, optimize=True))


def VerticalStress(values, sides, order):
    """Stress zz (m, 4) at the corners of elements with edge vectors `sides` (m, 3, 3)."""
    _, gradients = Shapes(order, np.vstack([np.zeros(3), np.eye(3)]))
    inverse = np.linalg.inv(sides)  # gradient in space = inverse @ gradient on the reference
    normal = np.einsum("mai,kaj,mij->mki", values, gradients, inverse, optimize=True)
    shear = YOUNG["upper"] / (2 * (1 + NU))
    return 2 * shear * (normal[..., 2] + NU / (1 - 2 * NU) * normal.sum(axis=-1))
