"""Deformed triangles, as matplotlib wants them, and fields on them."""

import numpy as np
from ngsolve import CF, VOL, IntegrationRule, x, y


def Deformed(displacement, bodies, factor=1.0, values=None):
    """Points (n, 2) of all vertices and triangles (m, 3) of some bodies of a mesh.

    The vertices move by `factor` times the displacement, or by what `values`, kept from its vector,
    say in its place.
    """
    mesh = displacement.space.mesh
    values = displacement.vec.FV().NumPy() if values is None else values
    moves = values.reshape(2, -1)[:, : mesh.nv].T  # the functions of the vertices come first
    points = np.array([vertex.point for vertex in mesh.vertices])
    faces = [[v.nr for v in el.vertices] for el in mesh.Elements(VOL) if el.mat in bodies]
    return points + factor * moves, faces


def Smooth(mesh, functions, parts=3):
    """Points (n, 2), triangles (m, 3) and values of functions, each element of a mesh divided."""
    lattice = [(i / parts, j / parts) for i in range(parts + 1) for j in range(parts + 1 - i)]
    number = {(round(x * parts), round(y * parts)): k for k, (x, y) in enumerate(lattice)}
    upright = [[(i, j), (i + 1, j), (i, j + 1)] for i, j in number if i + j < parts]
    turned = [[(i + 1, j + 1), (i, j + 1), (i + 1, j)] for i, j in number if i + j < parts - 1]
    local = np.array([[number[corner] for corner in face] for face in upright + turned])
    places = mesh.MapToAllElements(IntegrationRule(lattice, [1] * len(lattice)), VOL)
    first = len(lattice) * np.arange(mesh.ne)
    faces = (first[:, None, None] + local).reshape(-1, 3)
    return CF((x, y))(places), faces, [np.asarray(f(places)) for f in functions]


def DrawField(axes, result, bodies, factor, label):
    """The field of a result, element by element, on some deformed bodies."""
    mesh = result.contact.mesh
    points, faces = Deformed(result.displacement, bodies, factor)
    centers = mesh.MapToAllElements(IntegrationRule([(1 / 3, 1 / 3)], [1]), VOL)
    values = result.field(centers).ravel()[[el.mat in bodies for el in mesh.Elements(VOL)]]
    drawn = axes.tripcolor(*points.T, faces, facecolors=values, edgecolors="k", lw=0.1)
    axes.figure.colorbar(drawn, ax=axes, label=label, shrink=0.75)
    axes.set_aspect("equal")
