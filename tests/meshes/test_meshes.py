"""The meshes in 2D: names, sizes, areas, non-matching contact edges, invariance."""

import math
from itertools import pairwise

import numpy as np
import pytest
from netgen.occ import unit_square
from ngsolve import (
    BBND,
    BND,
    CF,
    ET,
    H1,
    L2,
    VOL,
    GridFunction,
    Integrate,
    IntegrationRule,
    Mesh,
    VectorH1,
    VectorValued,
    x,
    y,
)

from ngslac.meshes import CheckNonMatching, HertzMesh, PointForce, TwoBlocks

HALF = {"slave", "master", "arc", "top", "bottom", "side", "sym"}
SIDES = {"top", "bottom", "left_upper", "right_upper", "left_lower", "right_lower"}
FRAMES = [(1e-3, 0.0), (1.0, 37.0), (1e3, -120.0)]


def Length(mesh, name):
    return Integrate(1, mesh.Boundaries(name))


def EdgeLengths(mesh, name):
    return np.array(Integrate(1, mesh.Boundaries(name), element_wise=True))[
        [mesh.Boundaries(name).Mask()[el.index] for el in mesh.Elements(BND)]
    ]


def Connectivity(mesh):
    return [
        (vb, el.index, tuple(v.nr for v in el.vertices))
        for vb in (VOL, BND, BBND)
        for el in mesh.Elements(vb)
    ]


def Rotated(points, scale, angle):
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return scale * points @ np.array([[c, s], [-s, c]])


def Samples(mesh):
    """Points in all elements, seen through the curved geometry."""
    rule = IntegrationRule(points=[(0.2, 0.3), (0.5, 0.5), (0.1, 0.0)], weights=[0, 0, 0])
    return CF((x, y))(mesh.MapToAllElements({ET.TRIG: rule, ET.QUAD: rule}, VOL))


class TestHertz:
    @pytest.mark.parametrize("half", [True, False])
    def test_names(self, half):
        mesh = HertzMesh(1, half=half)
        assert set(mesh.GetMaterials()) == {"cylinder", "block"}
        assert set(mesh.GetBoundaries()) == (HALF if half else HALF - {"sym"})
        assert {"load", "foot"} <= set(mesh.GetBBoundaries())

    @pytest.mark.parametrize("half", [True, False])
    def test_areas_and_lengths(self, half):
        mesh = HertzMesh(1, half=half)
        sides = 1 if half else 2
        disc = sides * math.pi * 50**2 / 2
        assert Integrate(1, mesh.Materials("cylinder")) == pytest.approx(disc, rel=2e-5)
        assert Integrate(1, mesh.Materials("block")) == pytest.approx(sides * 20000, rel=1e-12)
        assert Length(mesh, "slave") == pytest.approx(sides * 15, rel=1e-8)
        assert Length(mesh, "master") == pytest.approx(sides * 16, rel=1e-12)
        assert Length(mesh, "bottom") == pytest.approx(sides * 100, rel=1e-12)
        if half:
            assert Length(mesh, "sym") == pytest.approx(300, rel=1e-12)

    @pytest.mark.parametrize("name", ["load", "foot"])
    def test_named_vertices(self, name):
        mesh = HertzMesh(1)
        points = [
            mesh.vertices[v.nr].point
            for el in mesh.BBoundaries(name).Elements()
            for v in el.vertices
        ]
        assert len(points) == 1
        assert points[0] == pytest.approx((0, 100 if name == "load" else 0), abs=1e-9)

    @pytest.mark.parametrize("h", [1.0, 0.5, 0.3])
    def test_contact_edges_have_equal_sizes(self, h):
        mesh = HertzMesh(h)
        slave, master = EdgeLengths(mesh, "slave"), EdgeLengths(mesh, "master")
        assert np.ptp(slave) < 1e-6 * h
        assert np.ptp(master) < 1e-9 * h
        assert slave.mean() == pytest.approx(h, rel=0.01)
        assert master.mean() == pytest.approx(0.73 * h, rel=0.06)

    def test_dofs_under_refinement(self):
        dofs = [VectorH1(HertzMesh(h), order=2).ndof for h in (1, 0.5, 0.25)]
        assert 5000 < dofs[1] < 10000
        assert all(1.4 * a < b < 2.6 * a for a, b in pairwise(dofs))

    def test_bodies_share_no_vertex(self):
        mesh = HertzMesh(1)
        owner = [
            {v.nr for el in mesh.Materials(m).Elements() for v in el.vertices}
            for m in ("cylinder", "block")
        ]
        assert not owner[0] & owner[1]
        assert len(owner[0] | owner[1]) == mesh.nv

    @pytest.mark.parametrize("half", [True, False])
    @pytest.mark.parametrize("ratio", [0.5, 0.73, 1.0, 2.0])
    def test_non_matching(self, half, ratio):
        assert CheckNonMatching(HertzMesh(1, half=half, ratio=ratio)) > 5e-4

    @pytest.mark.parametrize("half", [True, False])
    @pytest.mark.parametrize(("scale", "angle"), FRAMES)
    def test_frame_and_units(self, half, scale, angle):
        mesh, moved = HertzMesh(1, half=half), HertzMesh(1, half=half, scale=scale, angle=angle)
        assert Connectivity(moved) == Connectivity(mesh)
        assert moved.GetBoundaries() == mesh.GetBoundaries()
        assert moved.GetCurveOrder() == mesh.GetCurveOrder() == 2
        expected = Rotated(Samples(mesh), scale, angle)
        assert np.abs(Samples(moved) - expected).max() < 1e-12 * 200 * scale

    def test_size_of_the_bodies(self):
        mesh = HertzMesh(1)
        small = HertzMesh(0.02, radius=1.0, width=2.0, height=4.0)
        assert Connectivity(small) == Connectivity(mesh)
        assert np.abs(50 * Samples(small) - Samples(mesh)).max() < 1e-10

    @pytest.mark.parametrize("order", [1, 2, 3])
    def test_curve_order(self, order):
        mesh = HertzMesh(1, order=order, scale=1e-3)
        assert mesh.GetCurveOrder() == order
        area = Integrate(1, mesh.Materials("cylinder")) * 1e6
        error = abs(area / (math.pi * 50**2 / 2) - 1)
        assert error < {1: 7e-3, 2: 2e-5, 3: 5e-6}[order]

    @pytest.mark.parametrize("name", ["h", "radius", "width", "height", "ratio", "zone", "scale"])
    @pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
    def test_bad_sizes(self, name, value):
        with pytest.raises(ValueError, match=f"{name} must be positive"):
            HertzMesh(**{"h": 1.0, name: value})

    def test_zone_too_long(self):
        with pytest.raises(ValueError, match="zone is too long"):
            HertzMesh(1, zone=95)


KINDS = [
    {},
    {"quads": True},
    {"structured": True},
    {"structured": True, "quads": True},
    {"curved": True},
]


class TestTwoBlocks:
    @pytest.mark.parametrize("kind", KINDS)
    @pytest.mark.parametrize("shape", ["flat", "oblique"])
    def test_names_areas_and_lengths(self, shape, kind):
        mesh = TwoBlocks(shape=shape, slope=15, **kind)
        arc = {"arc"} if "curved" in kind else set()
        assert set(mesh.GetBoundaries()) == SIDES | {"slave", "master"} | arc
        for body in ("upper", "lower"):
            assert Integrate(1, mesh.Materials(body)) == pytest.approx(1, rel=1e-12)
        length = 1 / math.cos(math.radians(15)) if shape == "oblique" else 1
        for side in ("slave", "master"):
            assert Length(mesh, side) == pytest.approx(length, rel=1e-12)
            first = Integrate(CF((x, y)), mesh.Boundaries(side))
            assert first == pytest.approx((0.5 * length, 0), abs=1e-12)

    @pytest.mark.pairwise
    @pytest.mark.parametrize("kind", KINDS)
    @pytest.mark.parametrize("overhang", [0.0, 0.3, -0.3, 0.25])
    @pytest.mark.parametrize("aligned", [True, False])
    def test_non_matching(self, kind, overhang, aligned):
        mesh = TwoBlocks(0.2, overhang=overhang, aligned=aligned, **kind)
        assert CheckNonMatching(mesh) > 5e-4

    @pytest.mark.parametrize("h_master", [0.25, 0.125, 0.5])
    def test_equal_or_nested_sizes_do_not_match(self, h_master):
        assert CheckNonMatching(TwoBlocks(0.25, h_master)) > 0.01

    @pytest.mark.parametrize("kind", KINDS)
    def test_overhang(self, kind):
        wide = TwoBlocks(overhang=0.3, **kind)
        assert Length(wide, "slave") == pytest.approx(1, rel=1e-12)
        assert Length(wide, "master") == pytest.approx(1, rel=1e-12)
        assert Length(wide, "master_left") == pytest.approx(0.3, rel=1e-12)
        assert Length(wide, "master_right") == pytest.approx(0.3, rel=1e-12)
        assert Integrate(1, wide.Materials("lower")) == pytest.approx(1.6, rel=1e-12)
        even = TwoBlocks(overhang=-0.3, aligned=False, **kind)
        assert Length(even, "slave") == pytest.approx(1.6, rel=1e-12)
        assert Length(even, "master") == pytest.approx(1, rel=1e-12)

    def test_structured_elements(self):
        quads = TwoBlocks(0.25, 0.2, structured=True, quads=True)
        trigs = TwoBlocks(0.25, 0.2, structured=True)
        assert (quads.ne, trigs.ne) == (4 * 4 + 5 * 5, 2 * (4 * 4 + 5 * 5))
        assert quads.nv == trigs.nv == 5 * 5 + 6 * 6

    def test_curved_edges_lie_inside(self):
        mesh = TwoBlocks(curved=True)
        arc = Length(mesh, "arc")
        assert arc > 2.02  # two arcs over a height of 1 each
        straight = TwoBlocks(curved=True, order=1)
        assert Length(straight, "arc") < arc - 1e-4
        for side in ("slave", "master"):
            assert Integrate(y * y, mesh.Boundaries(side)) == pytest.approx(0, abs=1e-25)

    def test_interpolates_linear_fields(self):
        mesh = TwoBlocks(curved=True, shape="oblique")
        u = GridFunction(VectorH1(mesh, order=2))
        field = CF((1 + 2 * x - y, 3 * x + 0.5 * y))
        u.Set(field)
        assert Integrate((u - field) ** 2, mesh) < 1e-25

    @pytest.mark.parametrize("kind", KINDS)
    @pytest.mark.parametrize(("scale", "angle"), FRAMES)
    def test_frame_and_units(self, kind, scale, angle):
        mesh = TwoBlocks(shape="oblique", **kind)
        moved = TwoBlocks(shape="oblique", scale=scale, angle=angle, **kind)
        assert Connectivity(moved) == Connectivity(mesh)
        error = np.abs(Samples(moved) - Rotated(Samples(mesh), scale, angle)).max()
        assert error < 1e-12 * scale

    def test_bad_input(self):
        with pytest.raises(ValueError, match='shape must be "flat" or "oblique"'):
            TwoBlocks(shape="round")
        with pytest.raises(ValueError, match="structured or curved, not both"):
            TwoBlocks(structured=True, curved=True)
        with pytest.raises(ValueError, match="leaves the blocks"):
            TwoBlocks(shape="oblique", slope=70)
        with pytest.raises(ValueError, match="h_slave must be positive"):
            TwoBlocks(0)


class TestCheckNonMatching:
    def test_matching_meshes_are_refused(self):
        mesh = TwoBlocks(0.25, 0.2, structured=True)
        with pytest.raises(ValueError, match=r"slave node .* faces a master node"):
            CheckNonMatching(mesh, slave="slave", master="slave|left_upper")

    def test_distance_is_relative_to_the_master_size(self):
        mesh = TwoBlocks(1 / 2, 1 / 3, structured=True)  # nodes 1/2 and 1/3, 2/3
        assert CheckNonMatching(mesh) == pytest.approx(0.5)

    def test_unknown_boundary(self):
        with pytest.raises(ValueError, match="no boundary 'nothing'"):
            CheckNonMatching(TwoBlocks(), master="nothing")


class TestPointForce:
    @pytest.mark.parametrize("order", [1, 2, 3])
    def test_is_the_value_at_the_vertex(self, order):
        mesh = HertzMesh(2, order=order)  # isoparametric: linear fields are in the space
        V = VectorH1(mesh, order=order)
        u = GridFunction(V)
        u.Set(CF((x + 2 * y, y - 3 * x)))
        load = PointForce(V, (5, -7))
        assert load.InnerProduct(u.vec) == pytest.approx(5 * 200 - 7 * 100, rel=1e-12)
        assert np.count_nonzero(load.FV().NumPy()) == 2

    def test_in_a_product_space(self):
        mesh = HertzMesh(2)
        V = VectorH1(mesh, order=2)
        X = L2(mesh, order=0) * V
        load = PointForce(X, (0, -7), component=1).FV().NumPy()
        assert np.all(load[: mesh.ne] == 0)
        assert load[mesh.ne :] == pytest.approx(PointForce(V, (0, -7)).FV().NumPy(), abs=0)

    def test_other_vector_spaces(self):
        mesh = HertzMesh(2)
        for V in (VectorValued(H1(mesh, order=2), 2), H1(mesh, order=2) ** 2):
            u = GridFunction(V)
            u.Set(CF((x + 2 * y, y - 3 * x)))
            value = PointForce(V, (5, -7)).InnerProduct(u.vec)
            assert value == pytest.approx(5 * 200 - 7 * 100, rel=1e-12)

    def test_unknown_vertex(self):
        V = VectorH1(Mesh(unit_square.GenerateMesh(maxh=0.5)), order=1)
        with pytest.raises(ValueError, match="no vertex named 'load'"):
            PointForce(V, (0, 1))
