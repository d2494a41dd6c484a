"""Boxes and blocks of every element shape: names, orientation, non-matching, invariance."""

import math

import numpy as np
import pytest
from measures3d import Area, Connectivity, Determinants, Flux, Samples, Volume
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import (
    BND,
    CF,
    ET,
    VOL,
    GridFunction,
    InnerProduct,
    Integrate,
    Mesh,
    VectorH1,
    specialcf,
    x,
    y,
    z,
)

from ngslac.meshes.blocks3d import TwoBlocks3D
from ngslac.meshes.boxes import KINDS, AddBody, StructuredBox
from ngslac.meshes.geometry3d import CheckNonMatching3D, RotationMatrix

SIDES = {"left", "right", "front", "back", "bottom", "top"}
OUTER = {f"{s}_{b}" for s in ("left", "right", "front", "back") for b in ("upper", "lower")}
TYPES = {
    "tet": (ET.TET, 6, ET.TRIG, 2),
    "hex": (ET.HEX, 1, ET.QUAD, 1),
    "prism": (ET.PRISM, 2, ET.TRIG, 2),
    "prism_side": (ET.PRISM, 2, ET.QUAD, 1),
    "pyramid": (ET.PYRAMID, 6, ET.QUAD, 1),
}
# NGSolve cuts pyramids off at the height 1 - 1e-10: volumes have that error.
ROUNDING = {kind: 1e-12 if kind != "pyramid" else 3e-10 for kind in KINDS}
TURN = ((1.0, 2.0, -0.5), 67.0)
FRAMES = [(1e-3, None), (1.0, TURN), (1e3, ("z", -120.0))]


def Box(*args, **options):
    ngmesh = NetgenMesh(dim=3)
    AddBody(ngmesh, "box", StructuredBox(*args, **options))
    ngmesh.Compress()
    return Mesh(ngmesh)


@pytest.mark.parametrize("kind", KINDS)
class TestStructuredBox:
    def test_elements_and_names(self, kind):
        mesh = Box([0, 1, 3], [0, 0.5, 1, 2], [-1, 1], kind)
        element, per_cube, face, per_square = TYPES[kind]
        assert {el.type for el in mesh.Elements(VOL)} == {element}
        assert mesh.ne == 6 * per_cube
        assert set(mesh.GetBoundaries()) == SIDES
        top = list(mesh.Boundaries("top").Elements())
        assert {el.type for el in top} == {face}
        assert len(top) == 6 * per_square
        sizes = {"left": 4, "right": 4, "front": 6, "back": 6, "bottom": 6, "top": 6}
        for side, area in sizes.items():
            assert Area(mesh, side) == pytest.approx(area, rel=1e-13)

    @pytest.mark.parametrize("perturb", [0.0, 0.25])
    def test_volume_normals_and_orientation(self, kind, perturb):
        mesh = Box(*[np.linspace(0, 1, 4)] * 3, kind, perturb=perturb)
        assert Volume(mesh) == pytest.approx(1, rel=ROUNDING[kind])
        assert Flux(mesh) == pytest.approx(3, rel=1e-12)
        assert Flux(mesh, "top") == pytest.approx(1, rel=1e-12)
        assert Flux(mesh, "bottom|left|front") == pytest.approx(0, abs=1e-14)
        determinants = Determinants(mesh)  # Netgen's hexahedra have a negative one
        assert determinants.min() * determinants.max() > 0

    def test_is_conforming(self, kind):
        """A continuous space has the linear functions, and no more vertices than the points."""
        box = StructuredBox(*[np.linspace(0, 1, 3)] * 3, kind, perturb=0.2)
        mesh = Box(*[np.linspace(0, 1, 3)] * 3, kind, perturb=0.2)
        assert mesh.nv == len(box.points)
        faces = np.zeros(mesh.nface, dtype=int)
        for el in mesh.Elements(VOL):
            faces[[f.nr for f in el.faces]] += 1
        outer = {f.nr for el in mesh.Elements(BND) for f in el.faces}
        assert set(np.flatnonzero(faces == 1)) == outer
        assert faces.max() == 2

    def test_perturbed_points_stay_in_sides_and_planes(self, kind):
        axis = np.linspace(0, 1, 5)
        flat, moved = (
            StructuredBox(axis, axis, axis, kind, perturb=p, fixed=(0.25,)).points for p in (0, 0.2)
        )
        shift = moved - flat
        for a in range(3):
            for end in (0.0, 1.0):
                assert np.all(shift[flat[:, a] == end, a] == 0)
        assert np.all(shift[flat[:, 0] == 0.25, 0] == 0)
        assert np.any(shift[flat[:, 2] == 0.25, 2] != 0)
        assert np.abs(shift).max() <= 0.2 * 0.25
        assert np.count_nonzero(shift) > 100


class TestStructuredBoxInput:
    def test_names(self):
        def Name(side, centre):
            return f"{side}{int(centre[0] > 1)}" if side == "top" else "rest"

        mesh = Box([0, 1, 3], [0, 1], [0, 1], names=Name)
        assert set(mesh.GetBoundaries()) == {"rest", "top0", "top1"}
        assert Area(mesh, "top1") == pytest.approx(2)

    @pytest.mark.parametrize(
        ("args", "message"),
        [
            (([0, 1], [0, 1], [0, 1], "brick"), "kind must be one of tet, hex"),
            (([0, 1], [0, 0], [0, 1]), "y must be at least two increasing"),
            (([0], [0, 1], [0, 1]), "x must be at least two increasing"),
            (([0, 1], [0, 1], [[0, 1]]), "z must be at least two increasing"),
        ],
    )
    def test_bad_input(self, args, message):
        with pytest.raises(ValueError, match=message):
            StructuredBox(*args)

    @pytest.mark.parametrize("perturb", [-0.1, 0.3, math.nan])
    def test_bad_perturbation(self, perturb):
        with pytest.raises(ValueError, match="perturb must be at least 0"):
            StructuredBox([0, 1], [0, 1], [0, 1], perturb=perturb)


class TestTwoBlocks3D:
    @pytest.mark.parametrize("kind", KINDS)
    @pytest.mark.parametrize("shape", ["flat", "oblique"])
    def test_names_volumes_and_areas(self, shape, kind):
        mesh = TwoBlocks3D(kind, shape=shape, slope=15, perturb=0.2)
        assert set(mesh.GetBoundaries()) == OUTER | {"slave", "master", "top", "bottom"}
        assert mesh.GetMaterials() == ("upper", "lower")
        area = 1 / math.cos(math.radians(15)) if shape == "oblique" else 1
        for body in ("upper", "lower"):
            assert Volume(mesh, body) == pytest.approx(1, rel=ROUNDING[kind])
        for side, sign in (("slave", 1), ("master", -1)):
            assert Area(mesh, side) == pytest.approx(area, rel=1e-12)
            first = Integrate(CF((x, y, z)), mesh.Boundaries(side))
            assert first == pytest.approx((0.5 * area, 0.5 * area, 0), abs=1e-12)
            normal = Integrate(specialcf.normal(3), mesh.Boundaries(side))
            assert normal[2] == pytest.approx(-sign, rel=1e-12)
        assert Area(mesh, "left_upper") + Area(mesh, "left_lower") == pytest.approx(2, rel=1e-12)

    def test_bodies_share_no_vertex(self):
        mesh = TwoBlocks3D("tet", "hex")
        upper, lower = (
            {v.nr for el in mesh.Materials(m).Elements() for v in el.vertices}
            for m in ("upper", "lower")
        )
        assert not upper & lower
        assert len(upper | lower) == mesh.nv

    @pytest.mark.parametrize("kind", KINDS)
    @pytest.mark.parametrize("aligned", [True, False])
    def test_overhang(self, kind, aligned):
        wide = TwoBlocks3D(kind, overhang=0.3, aligned=aligned, perturb=0.2)
        rim = 1.6**2 - 1
        assert Area(wide, "slave") == pytest.approx(1, rel=1e-12)
        assert Area(wide, "master") == pytest.approx(1 if aligned else 1 + rim, rel=1e-12)
        assert ("master_rim" in wide.GetBoundaries()) == aligned
        if aligned:
            assert Area(wide, "master_rim") == pytest.approx(rim, rel=1e-12)
        narrow = TwoBlocks3D(kind, overhang=-0.3, aligned=aligned, perturb=0.2)
        assert Area(narrow, "slave.*") == pytest.approx(1 + rim, rel=1e-12)
        assert Area(narrow, "master") == pytest.approx(1, rel=1e-12)
        assert Volume(narrow, "upper") == pytest.approx(1 + rim, rel=ROUNDING[kind])

    @pytest.mark.parametrize("options", [{}, {"unstructured": True}, {"perturb": 0.2}])
    @pytest.mark.parametrize(("scale", "rotation"), FRAMES)
    def test_frame_and_units(self, options, scale, rotation):
        options = {"kind_upper": "prism", "kind_lower": "tet", "shape": "oblique"} | options
        mesh = TwoBlocks3D(**options)
        moved = TwoBlocks3D(scale=scale, rotation=rotation, **options)
        assert Connectivity(moved) == Connectivity(mesh)
        expected = scale * Samples(mesh) @ RotationMatrix(rotation).T
        assert np.abs(Samples(moved) - expected).max() < 1e-13 * scale

    def test_unstructured(self):
        options = {"shape": "oblique", "aligned": False, "overhang": -0.2, "unstructured": True}
        mesh = TwoBlocks3D(n_slave=(4, 3), n_master=2, **options)
        assert {el.type for el in mesh.Elements(VOL)} == {ET.TET}
        assert Determinants(mesh).min() > 0
        assert Flux(mesh) == pytest.approx(3 * Volume(mesh), rel=1e-12)
        assert Area(mesh, "slave") == pytest.approx(1.96 / math.cos(math.radians(20)), rel=1e-12)
        ends = {v.nr for el in mesh.Boundaries("slave").Elements() for v in el.vertices}
        ends &= {v.nr for el in mesh.Boundaries("front_upper").Elements() for v in el.vertices}
        assert len(ends) == 5

    @pytest.mark.parametrize("kind", KINDS)
    def test_linear_fields_are_exact(self, kind):
        mesh = TwoBlocks3D(kind, shape="oblique", perturb=0.2)
        u, field = GridFunction(VectorH1(mesh, order=2)), CF((1 + 2 * x - z, 3 * x + y, y - z))
        u.Set(field)
        assert Integrate(InnerProduct(u - field, u - field), mesh) < 1e-25

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"shape": "round"}, 'shape must be "flat" or "oblique"'),
            ({"shape": "oblique", "slope": 60}, "leaves the blocks"),
            ({"width": 0}, "width must be positive"),
            ({"scale": math.nan}, "scale must be positive"),
            ({"n_slave": 0}, "divisions must be"),
            ({"n_master": (1, 2, 3)}, "divisions must be"),
            ({"kind_upper": "wedge"}, "kind must be one of"),
            ({"unstructured": True, "perturb": 0.1}, "has no perturb"),
            ({"unstructured": True, "overhang": 0.1}, "aligned=False with an overhang"),
            ({"n_slave": 2, "n_master": 2}, "coincides with a master face"),
            ({"n_slave": 2, "n_master": 4}, r"slave vertex \(0.5, 0.5, 0\) faces"),
        ],
    )
    def test_bad_input(self, options, message):
        with pytest.raises(ValueError, match=message):
            TwoBlocks3D(**options)


class TestRotationMatrix:
    @pytest.mark.parametrize("rotation", [None, ("x", 30.0), TURN, ([0, 0, 2], -90)])
    def test_is_a_rotation(self, rotation):
        matrix = RotationMatrix(rotation)
        assert matrix @ matrix.T == pytest.approx(np.eye(3), abs=1e-15)
        assert np.linalg.det(matrix) == pytest.approx(1)
        assert RotationMatrix(matrix) == pytest.approx(matrix, abs=0)

    def test_directions(self):
        assert RotationMatrix(("z", 90)) @ [1, 0, 0] == pytest.approx([0, 1, 0])
        assert RotationMatrix(([1, 1, 1], 120)) @ [1, 2, 3] == pytest.approx([3, 1, 2])

    @pytest.mark.parametrize(
        ("rotation", "message"),
        [
            (np.diag([1, 1, -1]), "reflection"),
            (2 * np.eye(3), "orthogonal"),
            (np.eye(4), "orthogonal"),
            (([0, 0, 0], 30), "axis of three numbers"),
            (("z", math.inf), "axis of three numbers"),
            (("w", 30), "axis of three numbers"),
        ],
    )
    def test_bad_input(self, rotation, message):
        with pytest.raises(ValueError, match=message):
            RotationMatrix(rotation)


class TestCheckNonMatching3D:
    def test_distance_is_relative_to_the_master_edges(self):
        assert CheckNonMatching3D(TwoBlocks3D("hex", None, 2, 3)) == pytest.approx(math.sqrt(0.5))

    def test_matching_meshes_are_refused(self):
        mesh = TwoBlocks3D("hex", None, 2, 3)
        with pytest.raises(ValueError, match="the contact meshes match"):
            CheckNonMatching3D(mesh, slave="slave", master="slave")

    def test_unknown_boundary(self):
        with pytest.raises(ValueError, match="no boundary 'nothing'"):
            CheckNonMatching3D(TwoBlocks3D(), master="nothing")
