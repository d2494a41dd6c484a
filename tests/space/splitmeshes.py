"""Meshes for the tests of SplitSlaveFaces and BubbleVectorH1, and what is measured on them."""

import numpy as np
from netgen.geom2d import SplineGeometry, unit_square
from netgen.occ import Circle, Glue, MoveTo, OCCGeometry, Rectangle, X
from ngsolve import BND, CF, ET, VOL, Integrate, Mesh, ds, dx


def square(maxh=0.3):
    return Mesh(unit_square.GenerateMesh(maxh=maxh))


def occ_disk(maxh=0.4, quads=False):
    face = Circle((0, 0), 1).Face()
    face.edges.name, face.faces.name = "rim", "body"
    return Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=maxh, quad_dominated=quads))


def spline_disk(maxh=0.4):
    geo = SplineGeometry()
    geo.AddCircle((0, 0), 1, bc="rim")
    return Mesh(geo.GenerateMesh(maxh=maxh))


def occ_ring(maxh=0.4):
    """The slave boundary is the inner circle: the body is concave there."""
    hole = Circle((0, 0), 1).Face()
    hole.edges.name = "rim"
    body = Circle((0, 0), 2).Face()
    body.edges.name = "outer"
    return Mesh(OCCGeometry(body - hole, dim=2).GenerateMesh(maxh=maxh))


def interface_mesh(quads=False):
    left, right = Rectangle(1, 1).Face(), MoveTo(1, 0).Rectangle(1, 1).Face()
    left.faces.name, right.faces.name = "A", "B"
    left.edges.Max(X).name = "interface"
    right.faces.quad_dominated = quads
    return Mesh(OCCGeometry(Glue([left, right]), dim=2).GenerateMesh(maxh=0.3))


DISKS = {"occ": occ_disk, "quads": lambda: occ_disk(quads=True), "splines": spline_disk}


def area(mesh):
    return Integrate(CF(1) * dx, mesh)


def length(mesh, boundary=".*"):
    return Integrate(CF(1) * ds(boundary), mesh)


def vertices(mesh):
    return np.array([v.point for v in mesh.vertices])


def elements(mesh, vb=VOL):
    """Sorted vertex numbers, material and curve of every element."""
    return [(tuple(sorted(v.nr for v in el.vertices)), el.mat) for el in mesh.Elements(vb)]


def min_jacobian(mesh):
    grid = np.linspace(0, 1, 6)
    least = np.inf
    for el in mesh.Elements(VOL):
        trafo = mesh.GetTrafo(el)
        for xi in grid:
            for eta in grid:
                if el.type == ET.QUAD or xi + eta <= 1 + 1e-12:
                    jac = np.array(trafo(xi, eta).jacobi).reshape(2, 2)
                    least = min(least, np.linalg.det(jac))
    return least


def is_conforming(mesh):
    """No hanging vertex: an edge with one volume element is an edge of the boundary."""
    count = np.zeros(mesh.nedge, dtype=int)
    for el in mesh.Elements(VOL):
        for edge in el.edges:
            count[edge.nr] += 1
    outer = {edge.nr for el in mesh.Elements(BND) for edge in el.edges}
    return count.max() <= 2 and {int(e) for e in np.flatnonzero(count == 1)} <= outer


def inner_vertices(mesh, split, slave):
    """New vertices per slave edge of a straight mesh, by position."""
    points = vertices(split)
    numbers = []
    for el in mesh.Boundaries(slave).Elements():
        a, b = (np.array(mesh[v].point) for v in el.vertices)
        s = (points - a) @ (b - a) / np.dot(b - a, b - a)
        off = np.linalg.norm(points - a - np.outer(s, b - a), axis=1)
        numbers.append(np.sum((off < 1e-12) & (s > 1e-8) & (s < 1 - 1e-8)))
    return numbers
