"""Curved surfaces in 3D: faces of a cube blown up to a sphere, and bent sheets."""

import numpy as np
from ngsolve import CF, GridFunction, VectorH1, sqrt, x, y, z
from surfaces3d import Sheet, quad_grid, rigid, sheet_mesh


def cube_on_sphere(n, cut=(), turn=None):
    """Points on the unit sphere and 6 n^2 faces; faces in `cut` ("all") are two triangles."""
    numbers, faces = {}, []
    grid = np.tan(np.linspace(-np.pi / 4, np.pi / 4, n + 1))

    def number(axis, side, i, j):
        point = np.zeros(3)
        point[[axis, (axis + 1) % 3, (axis + 2) % 3]] = side, grid[i], grid[j]
        return numbers.setdefault(tuple(point.round(9).tolist()), len(numbers))

    cells = [(a, s, i, j) for a in range(3) for s in (-1, 1) for i in range(n) for j in range(n)]
    for k, (a, s, i, j) in enumerate(cells):
        f = [number(a, s, *ij) for ij in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
        split = cut == "all" or k in cut
        faces += [(f[0], f[1], f[2]), (f[0], f[2], f[3])] if split else [tuple(f)]
    points = np.array(list(numbers))
    points /= np.linalg.norm(points, axis=1)[:, None]
    return rigid(turn)(points), faces


def bend(mesh, order, field, region):
    """Move boundaries by a field, which turns into polynomials of an order on each face."""
    deformation = GridFunction(VectorH1(mesh, order=order))
    deformation.Set(field, definedon=mesh.Boundaries(region))
    mesh.SetDeformation(deformation)


def spheres(n, m, order, opening, cut=((), ()), seed=1):
    """A ball of radius 1 (boundary "ball") in a shell ("shell") of inner radius 1 + opening."""
    (inner, inner_faces), (outer, outer_faces) = (
        cube_on_sphere(n, cut[0]),
        cube_on_sphere(m, cut[1], seed),
    )
    outer = (1 + opening) * outer
    mesh = sheet_mesh(
        Sheet("in", inner, inner_faces, -0.3 * inner, "ball"),
        Sheet("out", outer, outer_faces, 0.3 * outer, "shell"),
    )
    radius = mesh.BoundaryCF({"ball": 1, "shell": 1 + opening}, default=1)
    field = (radius / sqrt(x * x + y * y + z * z) - 1) * CF((x, y, z))
    bend(mesh, order, field, "ball|shell")
    return mesh


def cylinders(order, kinds, arc, n=3):
    """A cylinder of radius 1 about the y axis ("slave", from -0.6 to 0.6 radians, length 1) in a
    longer shell of radius 1.05 ("master") over an arc, of triangles ("trig") or quadrilaterals.
    """
    sheets = []
    for name, kind, angles, ends, radius in (
        ("slave", kinds[0], (-0.6, 0.6), (0.0, 1.0), 1.0),
        ("master", kinds[1], arc, (-0.2, 1.1), 1.05),
    ):
        box = ((angles[0], ends[0]), (angles[1], ends[1]))
        points, faces = quad_grid(n, n, box, diagonals=range(n * n) if kind == "trig" else ())
        t, along = points[:, 0], np.outer(points[:, 1], [0, 1, 0])
        radial = np.stack([np.sin(t), 0 * t, np.cos(t)], axis=1)
        into = -0.2 * radial if name == "slave" else 0.2 * radial
        sheets.append(Sheet(name, radius * radial + along, faces, into, name))
        n += 1
    radii = {"slave": 1, "master": 1.05}
    mesh = sheet_mesh(*sheets)
    stretch = mesh.BoundaryCF(radii, default=1) / sqrt(x * x + z * z) - 1
    bend(mesh, order, CF((stretch * x, 0, stretch * z)), "slave|master")
    return mesh
