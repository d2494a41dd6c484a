"""Single cells and round bodies to be split by SplitSlaveFaces, and what is measured on them."""

from collections import Counter

import netgen.occ as occ
import numpy as np
import pytest
from bricks import ball, brick, by_hand, slave_faces, unstructured
from measures import area
from netgen.csg import CSGeometry, Plane, Pnt, Sphere, Vec
from netgen.geom2d import SplineGeometry
from ngsolve import BND, CF, ET, VOL, Det, Integrate, IntegrationRule, Mesh, specialcf
from scipy.spatial import ConvexHull

from ngslac import SplitSlaveFaces

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
CELLS = {  # vertices, faces
    "trig": (SQUARE[:2] + SQUARE[3:], [(0, 1), (1, 2), (2, 0)]),
    "quad": (SQUARE, [(0, 1), (1, 2), (2, 3), (3, 0)]),
    "tet": (
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
        [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)],
    ),
    "pyramid": (
        [*((i, j, 0) for i, j in SQUARE), (0.4, 0.3, 1)],
        [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    ),
    "prism": (
        [(i, j, k) for k in (0, 1) for i, j in [(0, 0), (1, 0), (0, 1)]],
        [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    ),
    "hex": (
        [(i, j, k) for k in (0, 1) for i, j in SQUARE],
        [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
    ),
}


def mesh_of(points, cells, faces, inside=()):
    """A mesh by hand: material m0, m1, ... for each cell, boundary f0, f1, ... for each face."""
    cells = [(f"m{k}", cell) for k, cell in enumerate(cells)]
    return by_hand(points, cells, [(f"f{k}", face) for k, face in enumerate(faces)], inside)


def single_cell(shape, mirrored=False):
    """One cell under an affine map, optionally mirrored."""
    points, faces = CELLS[shape]
    dim = len(points[0])
    A = np.array([[1, 0.2, 0.1], [0, 0.8, 0.3], [0.1, 0, 1.2]])[:dim, :dim]
    if mirrored:
        A[:, 0] *= -1
    return mesh_of([tuple(A @ p) for p in points], [range(len(points))], faces)


def block(kind, n, **options):
    """A brick; "square" and "cube" are unstructured, "hexes" is split into hexahedra."""
    if kind in ("square", "cube"):
        return unstructured(2 if kind == "square" else 3, 1 / n)
    return brick("hex" if kind == "hexes" else kind, n, **options)


def split_of(mesh, kind, slave="top"):
    return SplitSlaveFaces(mesh, slave, hexes="hexes" if kind == "hexes" else "pyramids")


def spline_disk():
    geo = SplineGeometry()
    geo.AddCircle((0, 0), 1, bc="surface")
    return Mesh(geo.GenerateMesh(maxh=0.4))


def csg_hemisphere(maxh=0.5):
    geo = CSGeometry()
    sphere = Sphere(Pnt(0, 0, 0), 1).bc("surface")
    geo.Add((sphere * Plane(Pnt(0, 0, 0), Vec(0, 0, -1)).bc("flat")).mat("body"))
    return Mesh(geo.GenerateMesh(maxh=maxh))


def occ_hemisphere():
    body = occ.Sphere((0, 0, 0), 1) * occ.Box((-2, -2, 0), (2, 2, 2))
    body.faces.name, body.edges.name, body.vertices.name = "surface", "rim", "corner"
    body.faces.Min(occ.Z).name = "flat"
    return Mesh(occ.OCCGeometry(body.mat("body")).GenerateMesh(maxh=0.5))


def cylinder():
    body = occ.Cylinder((0, 0, 0), occ.Z, r=1, h=1)
    body.faces.name = "surface"
    body.faces.Min(occ.Z).name = body.faces.Max(occ.Z).name = "flat"
    return Mesh(occ.OCCGeometry(body).GenerateMesh(maxh=0.5))


def hole(dim):
    """A plate around a circle or a cylinder: the body is concave at the slave boundary."""
    if dim == 2:
        outer, inner = occ.MoveTo(-1.5, -1.5).Rectangle(3, 3).Face(), occ.Circle((0, 0), 1).Face()
    else:
        outer = occ.Box((-1.5, -1.5, 0), (1.5, 1.5, 1))
        inner = occ.Cylinder((0, 0, -1), occ.Z, r=1, h=3)
    for body, name in ((outer, "flat"), (inner, "surface")):
        (body.edges if dim == 2 else body.faces).name = name
    geometry = occ.OCCGeometry(outer - inner, dim=dim)
    return Mesh(geometry.GenerateMesh(maxh=0.4 if dim == 2 else 0.6))


PI = np.pi
ROUND = {  # mesh, volume, area of the slave boundary "surface"
    "disk": (lambda: ball(2, 0.4, 1), PI, 2 * PI),
    "disk of quadrilaterals": (lambda: ball(2, 0.4, 1, quad_dominated=True), PI, 2 * PI),
    "spline disk": (spline_disk, PI, 2 * PI),
    "plate": (lambda: hole(2), 9 - PI, 2 * PI),
    "csg hemisphere": (csg_hemisphere, 2 * PI / 3, 2 * PI),
    "occ hemisphere": (occ_hemisphere, 2 * PI / 3, 2 * PI),
    "ball": (lambda: ball(3, 0.4, 1), 4 * PI / 3, 4 * PI),
    "cylinder": (cylinder, PI, 2 * PI),
    "plate in 3D": (lambda: hole(3), 9 - PI, 2 * PI),
}


def vertices(mesh):
    return np.array([v.point for v in mesh.vertices])


def elements(mesh, vb=VOL):
    """Sorted vertex numbers and material of every element."""
    return [(tuple(sorted(v.nr for v in el.vertices)), el.mat) for el in mesh.Elements(vb)]


def shapes(mesh, vb=VOL):
    return Counter(el.type.name.lower() for el in mesh.Elements(vb))


def min_jacobian(mesh):
    """Least Jacobian; in 3D positive if it has the same sign everywhere."""
    grid = np.stack(np.meshgrid(*[np.arange(5) / 4.001] * mesh.dim), axis=-1).reshape(-1, mesh.dim)
    flat, height = grid[:, :2], grid[:, -1]
    simplex, prism = grid.sum(axis=1) < 1 + 1e-9, flat.sum(axis=1) < 1 + 1e-9
    pyramid = (flat.max(axis=1) + height < 1 + 1e-9) & (height < 0.9)
    shapes = {ET.TRIG: simplex, ET.QUAD: height < 2}
    if mesh.dim == 3:
        shapes = {ET.TET: simplex, ET.PYRAMID: pyramid, ET.PRISM: prism, ET.HEX: height < 2}
    rules = {
        shape: IntegrationRule(points=grid[here].tolist(), weights=[1.0] * int(here.sum()))
        for shape, here in shapes.items()
    }
    jacobian = Det(specialcf.JacobianMatrix(mesh.dim))
    values = jacobian(mesh.MapToAllElements(rules, VOL)).ravel()
    return min(values if mesh.dim == 2 else values * np.sign(values[0]))


def is_conforming(mesh):
    """A facet with one volume element only is a facet of the boundary."""

    def Facets(el):
        return el.edges if mesh.dim == 2 else el.faces

    count = Counter(f for el in mesh.Elements(VOL) for f in Facets(el))
    outer = {f for el in mesh.Elements(BND) for f in Facets(el)}
    return max(count.values()) <= 2 and {f for f, n in count.items() if n == 1} <= outer


def check_split(mesh, split, slave=".*"):
    """What holds for every split of a straight mesh with flat faces."""
    assert exact_volume(split) == pytest.approx(exact_volume(mesh), rel=1e-13)
    for name in set(mesh.GetBoundaries()):
        assert area(split, name) == pytest.approx(area(mesh, name), rel=1e-13)
    assert min_jacobian(split) > 0
    assert is_conforming(split)
    np.testing.assert_array_equal(vertices(split)[: mesh.nv], vertices(mesh))
    old, numbers = elements(mesh, BND), {el.nr for el in slave_faces(mesh, slave)}
    assert {face for nr, face in enumerate(old) if nr not in numbers} <= set(elements(split, BND))
    faces = [set(old[nr][0]) for nr in numbers]
    kept = {el for el in elements(mesh) if not any(face <= set(el[0]) for face in faces)}
    assert kept <= set(elements(split))


def exact_volume(mesh):
    """Of pyramids from their vertices: NGSolve's rules end 1e-10 below the tip."""
    values, points = np.array(Integrate(CF(1), mesh, element_wise=True)), vertices(mesh)
    for el in mesh.Elements(VOL):
        if el.type == ET.PYRAMID:
            values[el.nr] = ConvexHull(points[[v.nr for v in el.vertices]]).volume
    return values.sum()


def parents(mesh, split, slave):
    """Boundary element of the old mesh for each slave face of the new, by the documented order."""
    new = list(split.Elements(BND))
    numbers, extra = {}, mesh.GetNE(BND)
    for old in slave_faces(mesh, slave):
        parts = 5 if new[old.nr].type == ET.QUAD else len(old.vertices)
        if mesh.dim == 2:  # of a mesh with one shape of cells
            parts = 3 if ET.QUAD in {el.type for el in mesh.Elements(VOL)} else 2
        for nr in [old.nr, *range(extra, extra + parts - 1)]:
            numbers[nr] = old.nr
        extra += parts - 1
    assert extra == len(new)
    return numbers
