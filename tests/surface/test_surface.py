"""Geometry of slave surfaces alone: an obstacle takes every face, whatever it looks at."""

import math

import numpy as np
import pytest
from bricks import KINDS, ball, brick, dimension, glued
from measures import area, volume
from netgen import occ
from ngsolve import BND, CF, GridFunction, Integrate, Mesh, TaskManager, VectorH1, x, y, z
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ngslac import BubbleVectorH1, LACContact, LACSpace


def surface(mesh, slave=".*", *, bubble=True):
    """A contact of all faces of a region with an obstacle, each a macro-element."""
    V = BubbleVectorH1(mesh, order=1, slave=slave) if bubble else VectorH1(mesh, order=2)
    u, lam = (V * LACSpace(V, slave=slave)).TrialFunction()
    contact = LACContact(u, lam, obstacle=CF(0.0))
    contact.Update()
    return contact


def meshed(shape, maxh, order=1):
    dim = 3 if len(shape.solids) else 2
    return Mesh(occ.OCCGeometry(shape, dim=dim).GenerateMesh(maxh=maxh)).Curve(order)


def star(corners=5):
    """A polygon with reentrant corners."""
    wp = occ.WorkPlane().MoveTo(1, 0)
    for k in range(1, 2 * corners):
        radius, angle = (0.4, 1)[k % 2 == 0], k * math.pi / corners
        wp.LineTo(radius * math.cos(angle), radius * math.sin(angle))
    return meshed(wp.Close().Face(), 0.4)


def cavity():
    return meshed(occ.Box((0, 0, 0), (3, 3, 3)) - occ.Box((1, 1, 1), (2, 2, 2)), 1.0)


CLOSED = {kind: lambda kind=kind: brick(kind, 2, 3) for kind in KINDS}
CLOSED |= {"star": star, "cavity": cavity}


@pytest.mark.parametrize("shape", CLOSED)
def test_closed_plane_surfaces(shape):
    """Area, and by the divergence theorem: sum of n A = 0, sum of x.n A = dim volumes."""
    mesh = CLOSED[shape]()
    table = surface(mesh).Table()
    areas, normal, dim = table["fullarea"], table["normal"], mesh.dim
    assert len(areas) == mesh.GetNE(BND)
    assert areas.sum() == pytest.approx(area(mesh), rel=1e-12)
    assert areas @ normal == pytest.approx(np.zeros(dim), abs=1e-12 * areas.sum())
    # NGSolve's rules for pyramids end 1e-10 below the tip.
    whole = 1 if shape in KINDS else volume(mesh)
    assert np.sum(table["x"] * normal, axis=1) @ areas == pytest.approx(dim * whole, rel=1e-12)
    assert np.linalg.norm(normal, axis=1) == pytest.approx(1, rel=1e-14)
    assert table["area"] == pytest.approx(areas, rel=1e-12)
    for axis in range(dim) if shape in KINDS else ():
        for end, sign in ((0, -1), (1, 1)):
            there = np.abs(table["x"][:, axis] - end) < 1e-12
            wanted = np.tile(sign * np.eye(dim)[axis], (there.sum(), 1))
            assert np.any(there)
            assert normal[there] == pytest.approx(wanted, abs=1e-14)


def hollow(dim, maxh, order):
    centre = (0.5, -1, 2)[:dim]
    outer, inner = (
        occ.Circle(centre, r).Face() if dim == 2 else occ.Sphere(centre, r) for r in (2, 1)
    )
    return meshed(outer - inner, maxh, order), np.array(centre)


@pytest.mark.parametrize(("dim", "order"), [*((2, p) for p in (1, 2, 3, 4, 5)), (3, 2), (3, 3)])
def test_round_body_with_a_cavity(dim, order):
    """Normals point outwards on the rim and into the cavity."""
    mesh, centre = hollow(dim, 0.4 if dim == 2 else 1.2, order)
    table = surface(mesh, bubble=dim == 3).Table()
    total = Integrate(CF(1), mesh, BND, order=12)
    assert table["fullarea"].sum() == pytest.approx(total, rel=1e-10 if dim == 3 else 1e-6)
    radial = table["x"] - centre
    radius = np.linalg.norm(radial, axis=1)
    outer = radius > 1.5
    wanted = (np.where(outer, 1, -1) / radius)[:, None] * radial
    assert table["normal"] == pytest.approx(wanted, abs=1e-12 if dim == 2 else 0.03)
    areas = table["fullarea"][outer].sum(), table["fullarea"][~outer].sum()
    exact = 2 * np.pi * np.array([2, 1]) if dim == 2 else 4 * np.pi * np.array([4, 1])
    rel = 5e-3 if dim == 3 else {1: 1e-2, 2: 3e-4, 3: 1e-4}.get(order, 1e-5)
    assert areas == pytest.approx(exact, rel=rel)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("dim", [2, 3])
def test_centroids_and_areas_of_curved_faces(dim, order):
    body = occ.Circle((0, 0), 1).Face() if dim == 2 else occ.Cylinder((0, 0, 0), occ.Z, r=1, h=1)
    mesh = meshed(body, 0.4 if dim == 2 else 0.6, order)
    contact = surface(mesh, bubble=dim == 3)
    table, macros = contact.Table(), np.array(contact.space.macros)
    functions = (CF(1), x, y, z)[: dim + 1]
    exact = [Integrate(f, mesh, BND, element_wise=True, order=16).NumPy() for f in functions]
    rel = 1e-8 if dim == 3 and order < 4 else 1e-6
    assert table["fullarea"][macros] == pytest.approx(exact[0], rel=rel)
    centroids = np.stack([moment / exact[0] for moment in exact[1:]], axis=1)
    assert table["x"][macros] == pytest.approx(centroids, abs=1e-6)


def unit(dim, axis, sign, n):
    return pytest.approx(np.tile(sign * np.eye(dim)[axis], (n, 1)), abs=1e-14)


@pytest.mark.parametrize("dim", [2, 3])
def test_glued_materials_inside_one_body(dim):
    """Interfaces inside of a body are no problem as long as they are not slaves."""
    mesh = glued(dim, 0.5)
    table = surface(mesh, "end").Table()
    assert table["fullarea"].sum() == pytest.approx(1, rel=1e-13)
    assert table["normal"] == unit(dim, 0, 1, len(table["x"]))
    with pytest.raises(Exception, match="material on both sides"):
        surface(mesh, "interface")


@pytest.mark.parametrize("turn", [(0, 1), (1, 0), "mirror"])
@pytest.mark.parametrize("kind", ["trig", "quad", "tet", "hex"])
def test_mirrored_meshes(kind, turn):
    """A mapping that turns elements inside out (negative determinants): normals stay outward."""

    def Map(a, b, *c):
        return (-a, b, *c) if turn == "mirror" else (*((a, b)[i] for i in turn), *c)

    if dimension(kind) == 2:
        mesh = MakeStructured2DMesh(quads=kind == "quad", nx=3, ny=3, mapping=Map)
    else:
        mesh = MakeStructured3DMesh(hexes=kind == "hex", nx=2, ny=2, nz=2, mapping=Map)
    table = surface(mesh).Table()
    centre = np.mean([v.point for v in mesh.vertices], axis=0)
    assert np.all(np.sum((table["x"] - centre) * table["normal"], axis=1) > 0)


@pytest.mark.parametrize("kind", ["trig", "tet"])
def test_normals_turn_with_the_deformation(kind):
    mesh = brick(kind, 3)
    dim = mesh.dim
    deformation = GridFunction(VectorH1(mesh, order=1))
    deformation.Set(CF((-y - x, x - y) if dim == 2 else (z - x, 0, -x - z)))  # by 90 degrees
    reference = surface(mesh, "bottom").Table()
    mesh.SetDeformation(deformation)
    turned = surface(mesh, "bottom").Table()
    n = len(reference["x"])
    assert reference["normal"] == unit(dim, dim - 1, -1, n)
    assert turned["normal"] == unit(dim, 0, 1 if dim == 2 else -1, n)
    assert turned["fullarea"] == pytest.approx(reference["fullarea"], rel=1e-13)


def test_moments_are_those_of_a_uniform_pressure():
    """A pressure on the top of a box: force, and moment about any point."""
    mesh = brick("tet", 2, 1)
    contact = surface(mesh, "top")
    contact.form.SetConstant(1.0)
    gf = GridFunction(contact.form.fes)
    gf.components[1].vec.FV().NumPy().reshape(-1, 3)[:] = [0.0, 0, -2.0]
    gf.components[0].Set(CF((0, 0, 1e-3)))
    contact.Evaluate(gf)
    assert contact.Force() == pytest.approx([0, 0, -2], abs=1e-13)
    assert contact.Moment((0.5, 0.5, 0)) == pytest.approx([0, 0, 0], abs=1e-13)
    assert contact.Moment((0, 0, 0)) == pytest.approx([-1, 1, 0], abs=1e-13)


@pytest.mark.parametrize(("dim", "maxh"), [(2, 0.05), (3, 0.5)])
def test_threads(dim, maxh):
    mesh = ball(dim, maxh, order=3)
    alone = surface(mesh).Table()
    with TaskManager():
        threaded = surface(mesh).Table()
    for name, values in alone.items():
        assert np.array_equal(values, threaded[name]), name
