"""Thin layers that face each other, made by hand: 2D and 3D meshes for the cost of pairing."""

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import Mesh

__all__ = ["LayerMesh", "StripMesh"]


def StripMesh(n):
    """Two strips along 0 <= x <= 1, "slave" with n faces above "master" with n + 1."""
    ngmesh = NetgenMesh(dim=2)
    for name, count, depth in (("slave", n, 1 / n), ("master", n + 1, -1 / n)):
        first = len(ngmesh.Points())
        points = np.zeros((2, count + 1, 3))
        points[:, :, 0] = np.linspace(0, 1, count + 1)
        points[1, :, 1] = depth
        ngmesh.AddPoints(points.reshape(-1, 3))
        near = np.arange(first, first + count, dtype=np.int32)
        far = near + count + 1
        cell = [near, near + 1, far + 1, far] if depth > 0 else [near, far, far + 1, near + 1]
        cells, faces = np.stack(cell, axis=1), np.stack([near, near + 1], axis=1)
        ngmesh.AddElements(2, ngmesh.AddRegion(name, dim=2), cells, 0)
        ngmesh.AddElements(1, ngmesh.AddRegion(name, dim=1), faces, 0)
    return Mesh(ngmesh)


def LayerMesh(n):
    """Two square layers of prisms, "slave" with n triangles (n = 2 m^2) above "master" with more.

    The master has m + 1 squares in each direction, its diagonals the other way, so that inner nodes
    do not meet.
    """
    m = round((n / 2) ** 0.5)
    ngmesh = NetgenMesh(dim=3)
    for name, count, depth in (("slave", m, 1 / m), ("master", m + 1, -1 / m)):
        first = len(ngmesh.Points())
        line = np.linspace(0, 1, count + 1)
        near = np.stack([*np.meshgrid(line, line, indexing="ij"), np.zeros((count + 1,) * 2)], -1)
        ngmesh.AddPoints(np.concatenate([near, near + np.array([0, 0, depth])]).reshape(-1, 3))
        number = np.arange(first, first + (count + 1) ** 2, dtype=np.int32).reshape(count + 1, -1)
        a, b, c, d = (
            grid.ravel()
            for grid in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
        )
        halves = [(a, b, c), (a, c, d)] if depth > 0 else [(a, d, b), (b, d, c)]
        faces = np.concatenate([np.stack(half, axis=1) for half in halves])
        cells = np.concatenate([faces, faces + (count + 1) ** 2], axis=1)
        ngmesh.AddElements(3, ngmesh.AddRegion(name, dim=3), cells, 0)
        ngmesh.AddElements(2, ngmesh.AddRegion(name, dim=2), faces[:, ::-1].copy(), 0)
    return Mesh(ngmesh)
