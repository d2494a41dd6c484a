"""SplitSlaveFaces: the mesh modification of the Local Average Contact paper, in 2D."""

from math import pi

import numpy as np
import pytest
from netgen.geom2d import SplineGeometry
from ngsolve import BND, CF, ET, H1, VOL, Integrate, Mesh, Periodic, dx
from ngsolve.meshes import MakeStructured2DMesh
from splitmeshes import (
    DISKS,
    area,
    elements,
    inner_vertices,
    interface_mesh,
    is_conforming,
    length,
    min_jacobian,
    occ_disk,
    occ_ring,
    square,
    vertices,
)

from ngslac import SplitSlaveFaces


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
