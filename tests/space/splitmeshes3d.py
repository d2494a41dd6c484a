"""Three-dimensional meshes for the tests of SplitSlaveFaces, and what is measured on them."""

from collections import Counter

import netgen.meshing as ngm
import netgen.occ as occ
import numpy as np
from netgen.csg import CSGeometry, Plane, Pnt, Sphere, Vec, unit_cube
from ngsolve import (
    BND,
    CF,
    ET,
    H1,
    VOL,
    BilinearForm,
    Det,
    GridFunction,
    Integrate,
    IntegrationRule,
    LinearForm,
    Mesh,
    cos,
    ds,
    dx,
    exp,
    grad,
    sin,
    specialcf,
    x,
    y,
    z,
)
from ngsolve.meshes import MakeStructured3DMesh

# name: vertices, faces
CELLS = {
    "tet": (
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
        [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)],
    ),
    "pyramid": (
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.4, 0.3, 1)],
        [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    ),
    "prism": (
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
        [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    ),
    "hex": (
        [(i, j, k) for k in (0, 1) for i, j in [(0, 0), (1, 0), (1, 1), (0, 1)]],
        [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
    ),
}
TETS = {  # a division of each shape into tetrahedra
    4: [(0, 1, 2, 3)],
    5: [(0, 1, 2, 4), (0, 2, 3, 4)],
    6: [(0, 1, 2, 3), (1, 2, 3, 5), (1, 3, 4, 5)],
    8: [(0, 1, 3, 4), (1, 2, 3, 6), (1, 4, 5, 6), (3, 4, 6, 7), (1, 3, 4, 6)],
}


def mesh_of(points, cells, faces, inside=()):
    """A mesh by hand: boundary f0, f1, ... for each face; those of `inside` have cells 0 and 1."""
    mesh = ngm.Mesh(dim=3)
    numbers = [mesh.Add(ngm.MeshPoint(ngm.Pnt(*p))) for p in points]
    for k, cell in enumerate(cells):
        mesh.SetMaterial(k + 1, f"m{k}")
        mesh.Add(ngm.Element3D(k + 1, [numbers[i] for i in cell]))
    for k, face in enumerate(faces):
        owner = next(i for i, cell in enumerate(cells) if set(face) <= set(cell))
        other = 2 if face in inside else 0
        mesh.Add(ngm.FaceDescriptor(surfnr=k + 1, domin=owner + 1, domout=other, bc=k + 1))
        mesh.SetBCName(k, f"f{k}")
        mesh.Add(ngm.Element2D(k + 1, [numbers[i] for i in face]))
    return Mesh(mesh)


def single_cell(shape, mirrored=False):
    """One cell under an affine map, optionally mirrored."""
    points, faces = CELLS[shape]
    A = np.array([[1, 0.2, 0.1], [0, 0.8, 0.3], [0.1, 0, 1.2]])
    if mirrored:
        A[:, 0] *= -1
    return mesh_of([tuple(A @ p) for p in points], [range(len(points))], faces)


def brick(kind, n=3, nz=2, **options):
    shape = {"tet": {"hexes": False}, "prism": {"hexes": False, "prism": True}, "hex": {}}[kind]
    return MakeStructured3DMesh(nx=n, ny=n, nz=nz, **shape, **options)


def cube(maxh=0.5):
    return Mesh(unit_cube.GenerateMesh(maxh=maxh))


def occ_mesh(shape, maxh):
    return Mesh(occ.OCCGeometry(shape).GenerateMesh(maxh=maxh))


def csg_hemisphere(maxh=0.5):
    geo = CSGeometry()
    ball = Sphere(Pnt(0, 0, 0), 1).bc("round")
    geo.Add((ball * Plane(Pnt(0, 0, 0), Vec(0, 0, -1)).bc("flat")).mat("body"))
    return Mesh(geo.GenerateMesh(maxh=maxh))


def occ_hemisphere(maxh=0.5):
    body = occ.Sphere((0, 0, 0), 1) * occ.Box((-2, -2, 0), (2, 2, 2))
    body.faces.name, body.edges.name, body.vertices.name = "round", "rim", "corner"
    body.faces.Min(occ.Z).name = "flat"
    return occ_mesh(body.mat("body"), maxh)


def occ_ball(maxh=0.4):
    """The poles of the parameters of the surface lie inside of the slave boundary."""
    body = occ.Sphere((0, 0, 0), 1)
    body.faces.name = "round"
    return occ_mesh(body, maxh)


def occ_cylinder(maxh=0.5):
    body = occ.Cylinder((0, 0, 0), occ.Z, r=1, h=1)
    body.faces.name = "round"
    body.faces.Min(occ.Z).name = body.faces.Max(occ.Z).name = "flat"
    return occ_mesh(body, maxh)


def occ_hole(maxh=0.6):
    """A plate around a cylinder: the body is concave at the slave boundary."""
    body = occ.Box((-1.5, -1.5, 0), (1.5, 1.5, 1)) - occ.Cylinder((0, 0, -1), occ.Z, r=1, h=3)
    for face in body.faces:
        side = max(abs(c) for c in (face.center.x, face.center.y, face.center.z - 0.5))
        face.name = "round" if side < 0.4 else "flat"
    return occ_mesh(body, maxh)


def interface_mesh(maxh=0.6):
    left, right = occ.Box((0, 0, 0), (1, 1, 1)), occ.Box((1, 0, 0), (2, 1, 1))
    left.faces.name, right.faces.name = "outer", "outer"
    left.faces.Max(occ.X).name = "interface"
    return occ_mesh(occ.Glue([left.mat("A"), right.mat("B")]), maxh)


PI = np.pi
ROUND = {  # mesh, volume, area of the slave boundary
    "csg hemisphere": (csg_hemisphere, 2 * PI / 3, 2 * PI),
    "occ hemisphere": (occ_hemisphere, 2 * PI / 3, 2 * PI),
    "occ ball": (occ_ball, 4 * PI / 3, 4 * PI),
    "occ cylinder": (occ_cylinder, PI, 2 * PI),
    "occ hole": (occ_hole, 9 - PI, 2 * PI),
}


def volume(mesh, materials=".*"):
    return Integrate(CF(1) * dx(materials), mesh)


def area(mesh, boundary=".*"):
    return Integrate(CF(1) * ds(boundary), mesh)


def straight_volume(mesh):
    """From the vertices alone; NGSolve's rules for pyramids end 1e-10 below the tip."""
    p = vertices(mesh)
    total = 0
    for el in mesh.Elements(VOL):
        corners = p[[v.nr for v in el.vertices]]
        for a, b, c, d in TETS[len(corners)]:
            total += abs(np.linalg.det(corners[[b, c, d]] - corners[a])) / 6
    return total


def vertices(mesh):
    return np.array([v.point for v in mesh.vertices])


def elements(mesh, vb=VOL):
    """Sorted vertex numbers and material of every element."""
    return [(tuple(sorted(v.nr for v in el.vertices)), el.mat) for el in mesh.Elements(vb)]


def shapes(mesh, vb=VOL):
    return Counter(el.type.name.lower() for el in mesh.Elements(vb))


def min_jacobian(mesh):
    """Least Jacobian, positive if it has the same sign everywhere."""
    grid = np.array([(i, j, k) for i in range(5) for j in range(5) for k in range(5)]) / 4.001
    simplex = grid[grid.sum(axis=1) < 1 + 1e-9]
    prism = grid[grid[:, :2].sum(axis=1) < 1 + 1e-9]
    pyramid = np.array([(a * (1 - c), b * (1 - c), c) for a, b, c in grid if c < 0.9])
    points = {ET.TET: simplex, ET.PYRAMID: pyramid, ET.PRISM: prism, ET.HEX: grid}
    rules = {
        shape: IntegrationRule(points=p.tolist(), weights=[1.0] * len(p))
        for shape, p in points.items()
    }
    values = Det(specialcf.JacobianMatrix(3))(mesh.MapToAllElements(rules, VOL)).ravel()
    return min(values * np.sign(values[0]))


def is_conforming(mesh):
    """A face with one volume element only is a face of the boundary."""
    count = np.zeros(mesh.nface, dtype=int)
    for el in mesh.Elements(VOL):
        for face in el.faces:
            count[face.nr] += 1
    outer = {face.nr for el in mesh.Elements(BND) for face in el.faces}
    return count.max() <= 2 and {int(f) for f in np.flatnonzero(count == 1)} <= outer


def parents(mesh, split, slave):
    """Boundary element of the old mesh for each slave face of the new, by the documented order."""
    new = list(split.Elements(BND))
    numbers, extra = {}, mesh.GetNE(BND)
    for old in mesh.Boundaries(slave).Elements():
        parts = 5 if new[old.nr].type == ET.QUAD else len(old.vertices)
        for nr in [old.nr, *range(extra, extra + parts - 1)]:
            numbers[nr] = old.nr
        extra += parts - 1
    assert extra == len(new)
    return numbers


def poisson_error(mesh, order):
    exact = exp(x) * cos(y) + sin(x * z)
    fes = H1(mesh, order=order, dirichlet=".*")
    u, v = fes.TnT()
    a = BilinearForm(grad(u) * grad(v) * dx).Assemble()
    f = LinearForm((x * x + z * z) * sin(x * z) * v * dx).Assemble()
    gf = GridFunction(fes)
    gf.Set(exact, definedon=mesh.Boundaries(".*"))
    f.vec.data -= a.mat * gf.vec
    gf.vec.data += a.mat.Inverse(fes.FreeDofs(), inverse="sparsecholesky") * f.vec
    return Integrate((gf - exact) ** 2 * dx(bonus_intorder=4), mesh) ** 0.5
