"""Geometry of slave surfaces alone: an obstacle takes every face, whatever it looks at."""

import math

import numpy as np
import pytest
from netgen.occ import Circle, Glue, MoveTo, OCCGeometry, Rectangle, WorkPlane
from ngsolve import BND, CF, GridFunction, Integrate, Mesh, TaskManager, VectorH1, x, y
from ngsolve.meshes import MakeStructured2DMesh

from ngslac import LACContact, LACSpace


def surface(mesh, slave=".*", order=2):
    """A contact of all faces of a region with an obstacle, each a macro-element."""
    V = VectorH1(mesh, order=order)
    u, lam = (V * LACSpace(V, slave=slave)).TrialFunction()
    contact = LACContact(u, lam, obstacle=CF(0.0))
    contact.Update()
    return contact


def occ(shape, maxh=0.4, order=1, **options):
    mesh = Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=maxh, **options))
    mesh.Curve(order)
    return mesh


def star(corners=5):
    """A polygon with reentrant corners."""
    wp = WorkPlane().MoveTo(1, 0)
    for k in range(1, 2 * corners):
        radius, angle = (0.4, 1)[k % 2 == 0], k * math.pi / corners
        wp.LineTo(radius * math.cos(angle), radius * math.sin(angle))
    return wp.Close().Face()


SHAPES = {
    "square": lambda: Rectangle(1, 2).Face(),
    "star": star,
    "hole": lambda: Rectangle(3, 3).Face() - MoveTo(1, 1).Rectangle(1, 1).Face(),
    "two bodies": lambda: Rectangle(1, 1).Face() + MoveTo(3, 0).Rectangle(1, 2).Face(),
}


@pytest.mark.parametrize("quads", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
def test_closed_straight_surfaces(shape, quads):
    """Length, and by the divergence theorem: sum of n A = 0, sum of x.n A = 2 area."""
    mesh = occ(SHAPES[shape](), quad_dominated=quads)
    table = surface(mesh).Table()
    area, normal = table["fullarea"], table["normal"]
    assert len(area) == mesh.GetNE(BND)
    assert area.sum() == pytest.approx(Integrate(CF(1), mesh, BND), rel=1e-13)
    assert area @ normal == pytest.approx([0, 0], abs=1e-12)
    flux = np.sum(table["x"] * normal, axis=1) @ area
    assert flux == pytest.approx(2 * Integrate(CF(1), mesh), rel=1e-12)
    assert np.linalg.norm(normal, axis=1) == pytest.approx(1, rel=1e-14)
    assert table["area"] == pytest.approx(area, rel=1e-14)


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
def test_curved_surface(order):
    """Normals of a disc with a hole: outwards on the rim, inwards in the hole."""
    shape = Circle((0.5, -1), 2).Face() - Circle((0.5, -1), 1).Face()
    table = surface(occ(shape, order=order)).Table()
    radial = table["x"] - np.array([0.5, -1])
    radius = np.linalg.norm(radial, axis=1)
    outer = radius > 1.5
    sign = np.where(outer, 1, -1)[:, None]
    assert table["normal"] == pytest.approx(sign * radial / radius[:, None], abs=1e-12)
    length = table["fullarea"][outer].sum(), table["fullarea"][~outer].sum()
    exact = 2 * np.pi * np.array([2, 1])
    assert length == pytest.approx(exact, rel={1: 1e-2, 2: 3e-4, 3: 1e-4}.get(order, 1e-5))


@pytest.mark.parametrize("order", [1, 2, 4])
def test_centroids_are_those_of_the_curved_faces(order):
    mesh = occ(Circle((0, 0), 1).Face(), order=order)
    contact = surface(mesh)
    table = contact.Table()
    exact = [Integrate(f, mesh, BND, element_wise=True, order=16).NumPy() for f in (CF(1), x, y)]
    macros = np.array(contact.space.macros)
    assert table["fullarea"][macros] == pytest.approx(exact[0], rel=1e-6)
    centroids = np.stack([exact[1] / exact[0], exact[2] / exact[0]], axis=1)
    assert table["x"][macros] == pytest.approx(centroids, abs=1e-6)


def test_glued_materials_inside_one_body():
    """Interfaces inside of a body are no problem as long as they are not slaves."""
    left, right = Rectangle(1, 1).Face(), MoveTo(1, 0).Rectangle(1, 1).Face()
    shape = Glue([left, right])
    for edge in shape.edges:
        edge.name = "bottom" if edge.center.y < 1e-9 else "other"
    table = surface(occ(shape), "bottom").Table()
    assert table["fullarea"].sum() == pytest.approx(2, rel=1e-13)
    assert table["normal"] == pytest.approx(np.tile([0, -1], (len(table["x"]), 1)), abs=1e-14)


@pytest.mark.parametrize(
    "mapping", [lambda a, b: (a, b), lambda a, b: (-a, b), lambda a, b: (b, a)]
)
def test_mirrored_meshes(mapping):
    """A mapping that turns elements inside out (negative determinants): normals stay outward."""
    mesh = MakeStructured2DMesh(quads=True, nx=3, ny=3, mapping=mapping)
    table = surface(mesh).Table()
    center = np.mean([v.point for v in mesh.vertices], axis=0)
    assert np.all(np.sum((table["x"] - center) * table["normal"], axis=1) > 0)


def test_normals_turn_with_the_deformation():
    mesh = MakeStructured2DMesh(quads=False, nx=3, ny=3)
    deformation = GridFunction(VectorH1(mesh, order=1))
    deformation.Set(CF((-y - x, x - y)))  # a rotation by 90 degrees
    reference = surface(mesh, "bottom").Table()
    mesh.SetDeformation(deformation)
    turned = surface(mesh, "bottom").Table()
    assert reference["normal"] == pytest.approx(np.tile([0, -1], (3, 1)), abs=1e-14)
    assert turned["normal"] == pytest.approx(np.tile([1, 0], (3, 1)), abs=1e-14)


def test_threads():
    mesh = occ(Circle((0, 0), 1).Face(), maxh=0.05, order=3)
    alone = surface(mesh).Table()
    with TaskManager():
        threaded = surface(mesh).Table()
    for name, values in alone.items():
        assert np.array_equal(values, threaded[name]), name
