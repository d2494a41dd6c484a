"""Geometry of slave surfaces in 3D alone: an obstacle takes every face, whatever it looks at."""

import math

import numpy as np
import pytest
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import Box, Cylinder, Glue, OCCGeometry, Pnt, Sphere, Z
from ngsolve import BND, CF, GridFunction, Integrate, Mesh, TaskManager, VectorH1, x, y, z
from ngsolve.meshes import MakeStructured3DMesh

from ngslac import BubbleVectorH1, LACContact, LACSpace
from ngslac.meshes.boxes import KINDS, AddBody, StructuredBox


def surface(mesh, slave=".*", obstacle=0.0):
    """A contact of all faces of a region with an obstacle, each a macro-element."""
    V = BubbleVectorH1(mesh, order=1, slave=slave)
    u, lam = (V * LACSpace(V, slave=slave)).TrialFunction()
    contact = LACContact(u, lam, obstacle=CF(obstacle))
    contact.Update()
    return contact


def occ(shape, maxh=0.6, order=1):
    mesh = Mesh(OCCGeometry(shape).GenerateMesh(maxh=maxh))
    mesh.Curve(order)
    return mesh


def check_closed(table, mesh, volume):
    """Area, and by the divergence theorem: sum of n A = 0, sum of x.n A = 3 volumes."""
    area, normal = table["fullarea"], table["normal"]
    assert len(area) == mesh.GetNE(BND)
    assert area.sum() == pytest.approx(Integrate(CF(1), mesh, BND), rel=1e-12)
    assert area @ normal == pytest.approx(np.zeros(3), abs=1e-12 * area.sum())
    assert np.linalg.norm(normal, axis=1) == pytest.approx(1, rel=1e-14)
    assert table["area"] == pytest.approx(area, rel=1e-12)
    flux = np.sum(table["x"] * normal, axis=1) @ area
    assert flux == pytest.approx(3 * volume, rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_closed_surfaces_of_every_element(kind):
    """Triangles and quadrilaterals of all volume elements, in either position."""
    box = StructuredBox([0, 0.5, 1.2], [-1, 0, 0.4], [0, 0.3, 1], kind)
    ngmesh = NetgenMesh(dim=3)
    AddBody(ngmesh, "body", box)
    ngmesh.Compress()
    mesh = Mesh(ngmesh)
    table = surface(mesh).Table()
    check_closed(table, mesh, 1.2 * 1.4 * 1)
    for axis, ends in enumerate([(0, 1.2), (-1, 0.4), (0, 1)]):
        for end, sign in zip(ends, (-1, 1), strict=True):
            there = np.abs(table["x"][:, axis] - end) < 1e-12
            assert np.any(there)
            normal = np.tile(sign * np.eye(3)[axis], (there.sum(), 1))
            assert table["normal"][there] == pytest.approx(normal, abs=1e-14)


SHAPES = {
    "edge cut off": lambda: Box(Pnt(0, 0, 0), Pnt(1, 2, 1)) - Box(Pnt(0.5, 0, 0.4), Pnt(2, 2, 2)),
    "cavity": lambda: Box(Pnt(0, 0, 0), Pnt(3, 3, 3)) - Box(Pnt(1, 1, 1), Pnt(2, 2, 2)),
    "two bodies": lambda: Box(Pnt(0, 0, 0), Pnt(1, 1, 1)) + Box(Pnt(3, 0, 0), Pnt(4, 2, 1)),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_closed_plane_surfaces(shape):
    mesh = occ(SHAPES[shape](), maxh=1.0)
    check_closed(surface(mesh).Table(), mesh, Integrate(CF(1), mesh))


@pytest.mark.parametrize("order", [2, 3])
def test_sphere_with_a_cavity(order):
    """Normals point outwards on the rim and into the cavity."""
    center = np.array([0.5, -1, 2])
    ball = Sphere(Pnt(*center), 2) - Sphere(Pnt(*center), 1)
    mesh = occ(ball, maxh=1.2, order=order)
    table = surface(mesh).Table()
    total = Integrate(CF(1), mesh, BND, order=12)
    assert table["fullarea"].sum() == pytest.approx(total, rel=1e-10)
    radial = table["x"] - center
    radius = np.linalg.norm(radial, axis=1)
    outer = radius > 1.5
    sign = np.where(outer, 1, -1)
    cosine = sign * np.sum(table["normal"] * radial, axis=1) / radius
    assert cosine.min() > 0.999
    areas = table["fullarea"][outer].sum(), table["fullarea"][~outer].sum()
    assert areas == pytest.approx(4 * math.pi * np.array([4, 1]), rel=5e-3)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_centroids_and_areas_of_curved_faces(order):
    mesh = occ(Cylinder(Pnt(0, 0, 0), Z, r=1, h=1), order=order)
    contact = surface(mesh)
    table, macros = contact.Table(), np.array(contact.space.macros)
    exact = [Integrate(f, mesh, BND, element_wise=True, order=12).NumPy() for f in (CF(1), x, y, z)]
    assert table["fullarea"][macros] == pytest.approx(exact[0], rel=1e-8)
    centroids = np.stack([moment / exact[0] for moment in exact[1:]], axis=1)
    assert table["x"][macros] == pytest.approx(centroids, abs=1e-6)


def test_glued_materials_inside_one_body():
    """Interfaces inside of a body are no problem as long as they are not slaves."""
    shape = Glue([Box(Pnt(0, 0, 0), Pnt(1, 1, 1)), Box(Pnt(1, 0, 0), Pnt(2, 1, 1))])
    for face in shape.faces:
        face.name = "bottom" if face.center.z < 1e-9 else "inner"
    mesh = occ(shape, maxh=1.0)
    table = surface(mesh, "bottom").Table()
    assert table["fullarea"].sum() == pytest.approx(2, rel=1e-13)
    down = np.tile([0, 0, -1], (len(table["x"]), 1))
    assert table["normal"] == pytest.approx(down, abs=1e-14)
    with pytest.raises(Exception, match="material on both sides"):
        surface(mesh, "inner")


@pytest.mark.parametrize(
    "mapping", [lambda a, b, c: (a, b, c), lambda a, b, c: (-a, b, c), lambda a, b, c: (b, a, c)]
)
@pytest.mark.parametrize("hexes", [False, True])
def test_mirrored_meshes(mapping, hexes):
    """A mapping that turns elements inside out (negative determinants): normals stay outward."""
    mesh = MakeStructured3DMesh(hexes=hexes, nx=2, ny=2, nz=2, mapping=mapping)
    table = surface(mesh).Table()
    center = np.mean([v.point for v in mesh.vertices], axis=0)
    assert np.all(np.sum((table["x"] - center) * table["normal"], axis=1) > 0)


def test_normals_turn_with_the_deformation():
    mesh = MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=2)
    deformation = GridFunction(VectorH1(mesh, order=1))
    deformation.Set(CF((z - x, y - y, -x - z)))  # x to -z, z to x: a rotation by 90 degrees
    reference = surface(mesh, "bottom").Table()
    mesh.SetDeformation(deformation)
    turned = surface(mesh, "bottom").Table()
    n = len(reference["x"])
    assert reference["normal"] == pytest.approx(np.tile([0, 0, -1], (n, 1)), abs=1e-14)
    assert turned["normal"] == pytest.approx(np.tile([-1, 0, 0], (n, 1)), abs=1e-14)
    assert turned["fullarea"] == pytest.approx(reference["fullarea"], rel=1e-13)


def test_moments_are_those_of_a_uniform_pressure():
    """A pressure on the top of a box: force, and moment about any point."""
    mesh = MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=1)
    contact = surface(mesh, "top")
    contact.form.SetConstant(1.0)
    gf = GridFunction(contact.form.fes)
    gf.components[1].vec.FV().NumPy().reshape(-1, 3)[:] = [0.0, 0, -2.0]
    gf.components[0].Set(CF((0, 0, 1e-3)))
    contact.Evaluate(gf)
    assert contact.Force() == pytest.approx([0, 0, -2], abs=1e-13)
    assert contact.Moment((0.5, 0.5, 0)) == pytest.approx([0, 0, 0], abs=1e-13)
    assert contact.Moment((0, 0, 0)) == pytest.approx([-1, 1, 0], abs=1e-13)


def test_threads():
    mesh = occ(Sphere(Pnt(0, 0, 0), 1), maxh=0.5, order=3)
    alone = surface(mesh).Table()
    with TaskManager():
        threaded = surface(mesh).Table()
    for name, values in alone.items():
        assert np.array_equal(values, threaded[name]), name
