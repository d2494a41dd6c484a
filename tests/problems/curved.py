"""Curved surfaces: circles, and cubes blown up to spheres."""

import numpy as np
from netgen.occ import Circle, Compound, OCCGeometry
from ngsolve import CF, GridFunction, Mesh, VectorH1, sqrt, x, y, z
from sheets import Sheet, sheet_mesh

CUTS = {"trig": lambda k: True, "quad": lambda k: False, "mixed": lambda k: k % 3 != 1}


def circles(n, m, order, opening):
    """A disc of radius 1 with n edges (boundary "ball") in a ring with m edges inside ("shell")."""
    disc, hole = (Circle((0, 0), r).Face() for r in (1, 1 + opening))
    ring = Circle((0, 0), 2.2).Face() - hole
    disc.faces.name, ring.faces.name = "in", "out"
    for face in (disc, ring):
        for edge in face.edges:
            far = edge.mass > 4 * np.pi
            edge.name = "far" if far else "shell" if face is ring else "ball"
            parts = 12 if far else m if face is ring else n
            edge.partition = [k / parts for k in range(1, parts)]
            edge.maxh = 1.01 * edge.mass / parts
    geometry = OCCGeometry(Compound([disc, ring]), dim=2)
    return Mesh(geometry.GenerateMesh(maxh=1.1, grading=0.9, minedgelen=None)).Curve(order)


def ball(kind, n):
    """Points on the unit sphere and 6 n^2 faces."""
    numbers, faces = {}, []
    line = np.tan(np.linspace(-np.pi / 4, np.pi / 4, n + 1))

    def number(axis, side, i, j):
        point = np.zeros(3)
        point[[axis, (axis + 1) % 3, (axis + 2) % 3]] = side, line[i], line[j]
        return numbers.setdefault(tuple(point.round(9).tolist()), len(numbers))

    cells = [(a, s, i, j) for a in range(3) for s in (-1, 1) for i in range(n) for j in range(n)]
    for k, (a, s, i, j) in enumerate(cells):
        f = [number(a, s, *ij) for ij in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
        faces += [(f[0], f[1], f[2]), (f[0], f[2], f[3])] if CUTS[kind](k) else [tuple(f)]
    points = np.array(list(numbers))
    return points / np.linalg.norm(points, axis=1)[:, None], faces


def bend(mesh, order, field, region):
    """Move boundaries by a field, which turns into polynomials of an order on each face."""
    deformation = GridFunction(VectorH1(mesh, order=order))
    deformation.Set(field, definedon=mesh.Boundaries(region))
    mesh.SetDeformation(deformation)


def spheres(kind, n, m, order, opening, motion=lambda points: points):
    """A ball of radius 1 (boundary "ball") in a shell ("shell") of inner radius 1 + opening.

    Faces along a quarter of a circle, of edges along an eighth: n of the ball, m of the shell.
    """
    if kind == "edge":
        return circles(8 * n, round(8 * m), order, opening)
    (inner, inner_faces), (outer, outer_faces) = ball(kind, n), ball(kind, m)
    outer = (1 + opening) * motion(outer)
    mesh = sheet_mesh(
        Sheet("in", inner, inner_faces, -0.3 * inner, "ball"),
        Sheet("out", outer, outer_faces, 0.3 * outer, "shell"),
    )
    radius = mesh.BoundaryCF({"ball": 1, "shell": 1 + opening}, default=1)
    field = (radius / sqrt(x * x + y * y + z * z) - 1) * CF((x, y, z))
    bend(mesh, order, field, "ball|shell")
    return mesh
