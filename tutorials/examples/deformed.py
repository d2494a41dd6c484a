"""Deformed triangles, as matplotlib wants them."""

import numpy as np
from ngsolve import VOL

__all__ = ["Deformed"]


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
