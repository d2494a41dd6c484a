"""Thin layers that face each other, made by hand: 2D and 3D meshes for the cost of pairing."""

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import Mesh

__all__ = ["LayerMesh"]


def LayerMesh(n, dim):
    """One layer of cells along 0 <= x <= 1, "slave" with n faces above "master" with more.

    Strips of quadrilaterals in 2D; in 3D prisms on n = 2 m^2 triangles. The master has one division
    more in each direction, its diagonals go the other way: inner nodes do not meet.
    """
    m = n if dim == 2 else round((n / 2) ** 0.5)
    ngmesh = NetgenMesh(dim=dim)
    for name, count, depth in (("slave", m, 1 / m), ("master", m + 1, -1 / m)):
        line, first = np.linspace(0, 1, count + 1), len(ngmesh.Points())
        grid = np.stack(np.meshgrid(*[line] * (dim - 1), indexing="ij"), -1).reshape(-1, dim - 1)
        near = np.pad(grid, ((0, 0), (0, 4 - dim)))  # netgen's points have three coordinates
        far = near + depth * np.eye(3)[dim - 1]
        ngmesh.AddPoints(np.concatenate([near, far]))
        faces = first + (Segments(count) if dim == 2 else Triangles(count, depth > 0))
        opposite = faces + len(near)
        if dim == 2:  # counterclockwise
            order = (faces, opposite[:, ::-1]) if depth > 0 else (opposite, faces[:, ::-1])
            cells = np.hstack(order)
        else:
            cells = np.hstack([faces, opposite])
            faces = faces[:, ::-1].copy()
        ngmesh.AddElements(dim, ngmesh.AddRegion(name, dim=dim), cells, 0)
        ngmesh.AddElements(dim - 1, ngmesh.AddRegion(name, dim=dim - 1), faces, 0)
    return Mesh(ngmesh)


def Segments(count):
    near = np.arange(count, dtype=np.int32)
    return np.stack([near, near + 1], axis=1)


def Triangles(count, upper):
    """Halves of the squares of a grid."""
    number = np.arange((count + 1) ** 2, dtype=np.int32).reshape(count + 1, -1)
    corners = (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    a, b, c, d = (grid.ravel() for grid in corners)
    halves = [(a, b, c), (a, c, d)] if upper else [(a, d, b), (b, d, c)]
    return np.concatenate([np.stack(half, axis=1) for half in halves])
