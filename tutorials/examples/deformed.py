"""Deformed triangles, as matplotlib wants them, and fields on them."""

import numpy as np
from ngsolve import VOL, IntegrationRule


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


def DrawField(axes, result, bodies, factor, label):
    """The field of a result, element by element, on some deformed bodies."""
    mesh = result.contact.mesh
    points, faces = Deformed(result.displacement, bodies, factor)
    centers = mesh.MapToAllElements(IntegrationRule([(1 / 3, 1 / 3)], [1]), VOL)
    values = result.field(centers).ravel()[[el.mat in bodies for el in mesh.Elements(VOL)]]
    drawn = axes.tripcolor(*points.T, faces, facecolors=values, edgecolors="k", lw=0.1)
    axes.figure.colorbar(drawn, ax=axes, label=label, shrink=0.75)
    axes.set_aspect("equal")
