"""SplitSlaveFaces: the mesh modification of the Local Average Contact paper, in 2D."""

import doctest
from math import pi

import numpy as np
import pytest
from netgen.csg import unit_cube
from netgen.geom2d import SplineGeometry, unit_square
from netgen.occ import Circle, Glue, MoveTo, OCCGeometry, Rectangle, X
from ngsolve import (
    BND,
    CF,
    ET,
    H1,
    VOL,
    BilinearForm,
    GridFunction,
    IfPos,
    InnerProduct,
    Integrate,
    LinearForm,
    Mesh,
    Periodic,
    cos,
    ds,
    dx,
    exp,
    grad,
    sin,
    x,
    y,
)
from ngsolve.meshes import Make1DMesh, MakeStructured2DMesh
from scipy.linalg import eigh

import ngslac.mesh
from ngslac import SplitSlaveFaces


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


@pytest.mark.parametrize("slave", ["left", "left|bottom", "top|bottom", ".*"])
def test_straight_triangles(slave):
    mesh = square()
    split = SplitSlaveFaces(mesh, slave)
    n = sum(1 for _ in mesh.Boundaries(slave).Elements())
    assert split.ne == mesh.ne + n
    assert split.nv == mesh.nv + n
    assert split.GetNE(BND) == mesh.GetNE(BND) + n
    assert inner_vertices(mesh, split, slave) == [1] * n
    assert area(split) == pytest.approx(1, rel=1e-14)
    for name in mesh.GetBoundaries():
        assert length(split, name) == pytest.approx(length(mesh, name), rel=1e-14)
    assert min_jacobian(split) > 0
    assert is_conforming(split)


@pytest.mark.parametrize("slave", ["left", "left|bottom", "top|bottom", ".*"])
def test_straight_quadrilaterals(slave):
    mesh = MakeStructured2DMesh(quads=True, nx=3, ny=4)
    split = SplitSlaveFaces(mesh, slave)
    n = sum(1 for _ in mesh.Boundaries(slave).Elements())
    assert split.ne == mesh.ne + 3 * n
    assert split.nv == mesh.nv + 4 * n
    assert split.GetNE(BND) == mesh.GetNE(BND) + 2 * n
    assert all(el.type == ET.QUAD for el in split.Elements(VOL))
    assert inner_vertices(mesh, split, slave) == [2] * n
    assert area(split) == pytest.approx(1, rel=1e-14)
    assert length(split) == pytest.approx(4, rel=1e-14)
    assert min_jacobian(split) > 0
    assert is_conforming(split)


def test_counts_of_single_cells():
    """All cells, boundary cells included, and nodes, as published for DECOUPE_LAC."""
    quad = SplitSlaveFaces(MakeStructured2DMesh(quads=True, nx=1, ny=1), "bottom|right")
    assert (quad.ne + quad.GetNE(BND), quad.nv) == (15, 12)
    geo = SplineGeometry()
    points = [geo.AppendPoint(*p) for p in [(0, 0), (1, 0), (0, 1)]]
    for i, name in enumerate("abc"):
        geo.Append(["line", points[i], points[(i + 1) % 3]], bc=name)
    mesh = Mesh(geo.GenerateMesh(maxh=10))
    assert mesh.ne == 1
    trig = SplitSlaveFaces(mesh, "a")
    assert (trig.ne + trig.GetNE(BND), trig.nv) == (6, 4)
    assert SplitSlaveFaces(mesh, ".*").ne == 4


@pytest.mark.parametrize("quads", [False, True])
def test_only_slave_elements_change(quads):
    mesh = MakeStructured2DMesh(quads=quads, nx=4, ny=4)
    split = SplitSlaveFaces(mesh, "top")
    slave = {edge.nr for el in mesh.Boundaries("top").Elements() for edge in el.edges}
    kept = [
        old
        for old, el in zip(elements(mesh), mesh.Elements(VOL), strict=True)
        if not slave & {edge.nr for edge in el.edges}
    ]
    assert len(kept) == mesh.ne - 4
    assert set(kept) <= set(elements(split))
    np.testing.assert_array_equal(vertices(split)[: mesh.nv], vertices(mesh))


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("disk", DISKS)
def test_curved_geometry(disk, order):
    """The split halves (or thirds) the slave edges, the error falls by more than half."""
    mesh = DISKS[disk]()
    if order > 1:
        mesh.Curve(order)
    before = abs(area(mesh) - pi), abs(length(mesh) - 2 * pi)
    split = SplitSlaveFaces(mesh, "rim")
    assert split.GetCurveOrder() == order
    factor = {1: 0.3, 2: 0.08, 3: 0.08, 4: 0.03}[order]
    assert abs(area(split) - pi) < factor * before[0]
    assert abs(length(split) - 2 * pi) < factor * before[1]
    assert min_jacobian(split) > 0
    assert is_conforming(split)
    assert (abs(area(mesh) - pi), abs(length(mesh) - 2 * pi)) == before
    radius = np.linalg.norm(vertices(split)[mesh.nv :], axis=1)
    assert np.sum(abs(radius - 1) < 1e-12) == split.GetNE(BND) - mesh.GetNE(BND)


def test_concave_boundary():
    mesh = occ_ring().Curve(3)
    split = SplitSlaveFaces(mesh, "rim")
    assert abs(area(split) - area(mesh)) < 1e-3
    assert abs(length(split, "rim") - 2 * pi) < 0.08 * abs(length(mesh, "rim") - 2 * pi)
    assert length(split, "outer") == pytest.approx(length(mesh, "outer"), rel=1e-14)
    assert min_jacobian(split) > 0


def test_names_are_kept():
    mesh = occ_ring()
    split = SplitSlaveFaces(mesh, "rim")
    assert split.GetBoundaries() == mesh.GetBoundaries()
    assert split.GetMaterials() == mesh.GetMaterials()
    assert split.GetBBoundaries() == mesh.GetBBoundaries()


def test_mesh_is_untouched():
    mesh = occ_disk().Curve(2)
    space = H1(mesh, order=2)
    before = elements(mesh), elements(mesh, BND), vertices(mesh), area(mesh)
    SplitSlaveFaces(mesh, "rim")
    space.Update()
    assert elements(mesh) == before[0]
    assert elements(mesh, BND) == before[1]
    np.testing.assert_array_equal(vertices(mesh), before[2])
    assert area(mesh) == before[3]
    assert mesh.GetCurveOrder() == 2


def interface_mesh(quads=False):
    left, right = Rectangle(1, 1).Face(), MoveTo(1, 0).Rectangle(1, 1).Face()
    left.faces.name, right.faces.name = "A", "B"
    left.edges.Max(X).name = "interface"
    right.faces.quad_dominated = quads
    return Mesh(OCCGeometry(Glue([left, right]), dim=2).GenerateMesh(maxh=0.3))


@pytest.mark.parametrize("quads", [False, True])
def test_interface_between_materials(quads):
    mesh = interface_mesh(quads)
    split = SplitSlaveFaces(mesh, "interface")
    n = sum(1 for _ in mesh.Boundaries("interface").Elements())
    assert split.GetNE(BND) == mesh.GetNE(BND) + (2 if quads else 1) * n
    assert inner_vertices(mesh, split, "interface") == [2 if quads else 1] * n
    assert area(split) == pytest.approx(2, rel=1e-14)
    for material in "AB":
        assert Integrate(CF(1) * dx(material), split) == pytest.approx(1, rel=1e-14)
    assert min_jacobian(split) > 0
    assert is_conforming(split)


def test_mesh_moved_off_its_geometry_stays_straight():
    mesh = occ_disk()
    for p in mesh.ngmesh.Points():
        p[0] = 2 * p[0]
    moved = Mesh(mesh.ngmesh)
    split = SplitSlaveFaces(moved, "rim")
    assert area(split) == pytest.approx(area(moved), rel=1e-14)
    assert length(split) == pytest.approx(length(moved), rel=1e-14)


def test_mapped_mesh_without_geometry():
    mesh = MakeStructured2DMesh(
        quads=True, nx=4, ny=4, mapping=lambda s, t: (1 + s + 0.2 * t * t, t + 0.1 * s)
    )
    split = SplitSlaveFaces(mesh, "left|top")
    assert area(split) == pytest.approx(area(mesh), rel=1e-14)
    assert min_jacobian(split) > 0


@pytest.mark.parametrize("disk", DISKS)
def test_refine_afterwards(disk):
    split = SplitSlaveFaces(DISKS[disk](), "rim").Curve(3)
    ne, nv = split.ne, split.nv
    error = abs(area(split) - pi)
    split.Refine()
    split.Curve(3)
    assert split.ne == 4 * ne
    assert split.nv > nv
    assert abs(area(split) - pi) < 0.1 * error
    assert min_jacobian(split) > 0


def test_split_after_local_refinement_and_again():
    mesh = occ_disk()
    for el in mesh.Elements(VOL):
        mesh.SetRefinementFlag(el, el.nr % 5 == 0)
    mesh.Refine()
    mesh.Curve(3)
    split = mesh
    for _ in range(2):
        n = split.GetNE(BND)
        split = SplitSlaveFaces(split, "rim")
        assert split.GetNE(BND) == 2 * n
        assert abs(area(split) - pi) < 1e-4
        assert min_jacobian(split) > 0


def test_periodic_mesh_keeps_its_identification():
    mesh = MakeStructured2DMesh(quads=False, nx=4, ny=4, periodic_x=True)
    split = SplitSlaveFaces(mesh, "top")
    free = sum(Periodic(H1(split)).FreeDofs())
    assert free == split.nv - 5
    SplitSlaveFaces(mesh, "left")


def poisson_error(mesh, order):
    exact = exp(x) * cos(y) + sin(x * y)
    source = (x * x + y * y) * sin(x * y)
    fes = H1(mesh, order=order, dirichlet=".*")
    u, v = fes.TnT()
    a = BilinearForm(grad(u) * grad(v) * dx).Assemble()
    f = LinearForm(source * v * dx).Assemble()
    gf = GridFunction(fes)
    gf.Set(exact, definedon=mesh.Boundaries(".*"))
    f.vec.data -= a.mat * gf.vec
    gf.vec.data += a.mat.Inverse(fes.FreeDofs(), inverse="sparsecholesky") * f.vec
    return Integrate((gf - exact) ** 2 * dx(bonus_intorder=6), mesh) ** 0.5


@pytest.mark.parametrize("quads", [False, True])
@pytest.mark.parametrize("order", [1, 2])
def test_poisson(order, quads):
    errors = []
    for n in (4, 8, 16):
        mesh = MakeStructured2DMesh(quads=quads, nx=n, ny=n)
        errors.append(poisson_error(SplitSlaveFaces(mesh, "left|top"), order))
        assert errors[-1] < 1.1 * poisson_error(mesh, order)
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert rates.min() > order + 0.8


def test_poisson_on_curved_split():
    for order in (2, 3):
        mesh = occ_disk(0.3).Curve(order)
        assert poisson_error(SplitSlaveFaces(mesh, "rim"), order) < poisson_error(mesh, order)


def contact_operator(fes, macros):
    """S = B A^-1 B^T: B the mean normal trace per macro-element, A the inner product of H1."""
    u, v = fes.TnT()
    a = BilinearForm((grad(u) * grad(v) + u * v) * dx).Assemble()
    inv = a.mat.Inverse(fes.FreeDofs(), inverse="sparsecholesky")
    columns = []
    for lower, upper in macros:
        one = IfPos(x - lower, 1, 0) * IfPos(upper - x, 1, 0)
        columns.append(LinearForm(one * v * ds("top")).Assemble().vec)
    solutions = [(inv * b).Evaluate() for b in columns]
    return np.array([[InnerProduct(b, s) for s in solutions] for b in columns])


@pytest.mark.parametrize("kind", ["trigs", "quads"])
@pytest.mark.parametrize("clamped", ["", "left|right"])
def test_parent_edges_are_stable_macro_elements(kind, clamped):
    """The inf-sup constant of one multiplier per parent edge does not fall with the mesh size."""
    betas = []
    for n in (4, 8, 16):
        mesh = MakeStructured2DMesh(quads=kind == "quads", nx=n, ny=n)
        split = SplitSlaveFaces(mesh, "top")
        macros = [(k / n, (k + 1) / n) for k in range(n)]
        lowest, fine = (
            contact_operator(H1(split, order=p, dirichlet=clamped), macros) for p in (1, 4)
        )
        betas.append(eigh(lowest, fine, eigvals_only=True)[0] ** 0.5)
    assert min(betas) > 0.5
    assert betas[-1] > 0.95 * betas[-2]


def test_example():
    result = doctest.testmod(ngslac.mesh)
    assert result.attempted > 0
    assert result.failed == 0


def test_region_argument():
    mesh = square()
    by_name = SplitSlaveFaces(mesh, "left|top")
    by_region = SplitSlaveFaces(mesh, mesh.Boundaries("left") + mesh.Boundaries("top"))
    assert elements(by_region) == elements(by_name)


def test_wrong_arguments():
    mesh, other = square(), square()
    with pytest.raises(ValueError, match=r"'rim' matches no boundary; there are 'bottom'"):
        SplitSlaveFaces(mesh, "rim")
    with pytest.raises(ValueError, match="region matches no boundary"):
        SplitSlaveFaces(mesh, mesh.Boundaries("rim"))
    with pytest.raises(Exception, match="belongs to another mesh"):
        SplitSlaveFaces(mesh, other.Boundaries("left"))
    for region in (mesh.Materials(".*"), mesh.BBoundaries(".*")):
        with pytest.raises(Exception, match="must be one of boundaries"):
            SplitSlaveFaces(mesh, region)
    with pytest.raises(TypeError, match="pattern or a Region"):
        SplitSlaveFaces(mesh, 3)
    with pytest.raises(TypeError, match=r"ngsolve\.Mesh"):
        SplitSlaveFaces(mesh.ngmesh, "left")


def test_unsupported_meshes():
    with pytest.raises(Exception, match="SplitSlaveFaces: three-dimensional meshes"):
        SplitSlaveFaces(Mesh(unit_cube.GenerateMesh(maxh=1)), "top")
    with pytest.raises(Exception, match="must be two-dimensional"):
        SplitSlaveFaces(Make1DMesh(3), "left")
    quadratic = occ_disk().ngmesh
    quadratic.SecondOrder()
    with pytest.raises(Exception, match="second order"):
        SplitSlaveFaces(Mesh(quadratic), "rim")


def test_boundary_too_coarse_to_split():
    """A hole whose circle is met by five edges only: the new vertices would leave the body."""
    body = MoveTo(-1.2, -1.2).Rectangle(2.4, 2.4).Face() - Circle((0, 0), 1).Face()
    body.edges.name = "rim"
    mesh = Mesh(
        OCCGeometry(body, dim=2).GenerateMesh(maxh=10, curvaturesafety=0.5, segmentsperedge=0.5)
    )
    with pytest.raises(Exception, match="fold over"):
        SplitSlaveFaces(mesh, "rim")
