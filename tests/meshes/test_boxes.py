"""Boxes of every element shape, rotations, and the check that two surfaces do not match."""

import math

import numpy as np
import pytest
from measures import area
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, ET, VOL, Mesh

from ngslac import meshes
from ngslac.meshes.boxes import KINDS
from ngslac.meshes.geometry import CheckNonMatching, RotationMatrix

TYPES = {  # cells, cells per cube, faces below and above, faces per square
    "tet": (ET.TET, 6, ET.TRIG, 2),
    "hex": (ET.HEX, 1, ET.QUAD, 1),
    "prism": (ET.PRISM, 2, ET.TRIG, 2),
    "prism_side": (ET.PRISM, 2, ET.QUAD, 1),
    "pyramid": (ET.PYRAMID, 6, ET.QUAD, 1),
}
UNIT = [np.linspace(0, 1, 4)] * 3


def Box(*args, **options):
    ngmesh = NetgenMesh(dim=3)
    meshes.StructuredBox(*args, **options).AddTo(ngmesh, "box")
    ngmesh.Compress()
    return Mesh(ngmesh)


@pytest.mark.parametrize("kind", KINDS)
class TestStructuredBox:
    def test_elements_and_names(self, kind):
        mesh = Box([0, 1, 3], [0, 0.5, 1, 2], [-1, 1], kind)
        element, per_cube, face, per_square = TYPES[kind]
        assert {el.type for el in mesh.Elements(VOL)} == {element}
        assert mesh.ne == 6 * per_cube
        top = list(mesh.Boundaries("top").Elements())
        assert {el.type for el in top} == {face}
        assert len(top) == 6 * per_square
        sizes = {"left": 4, "right": 4, "front": 6, "back": 6, "bottom": 6, "top": 6}
        assert {name: area(mesh, name) for name in mesh.GetBoundaries()} == pytest.approx(sizes)

    def test_is_conforming(self, kind):
        mesh = Box(*UNIT, kind, perturb=0.2)
        assert mesh.nv == len(meshes.StructuredBox(*UNIT, kind).points)
        faces = np.zeros(mesh.nface, dtype=int)
        for el in mesh.Elements(VOL):
            faces[[f.nr for f in el.faces]] += 1
        outer = {f.nr for el in mesh.Elements(BND) for f in el.faces}
        assert set(np.flatnonzero(faces == 1)) == outer
        assert faces.max() == 2

    def test_perturbed_points_stay_in_sides_and_planes(self, kind):
        grid = [np.linspace(0, 1, 5)] * 3
        flat, moved = (
            meshes.StructuredBox(*grid, kind, perturb=p, fixed=(0.25,)).points for p in (0, 0.2)
        )
        shift = moved - flat
        for a in range(3):
            for end in (0.0, 1.0):
                assert np.all(shift[flat[:, a] == end, a] == 0)
        assert np.all(shift[flat[:, 0] == 0.25, 0] == 0)
        assert np.any(shift[flat[:, 2] == 0.25, 2] != 0)
        assert np.abs(shift).max() <= 0.2 * 0.25
        assert np.count_nonzero(shift) > 100


def test_names_by_position():
    def Name(side, centre):
        return f"{side}{int(centre[0] > 1)}" if side == "top" else "rest"

    mesh = Box([0, 1, 3], [0, 1], [0, 1], names=Name)
    assert set(mesh.GetBoundaries()) == {"rest", "top0", "top1"}
    assert area(mesh, "top1") == pytest.approx(2)


@pytest.mark.parametrize("rotation", [None, ("x", 30.0), ((1.0, 2.0, -0.5), 67), ([0, 0, 2], -90)])
def test_rotations(rotation):
    matrix = RotationMatrix(rotation)
    assert matrix @ matrix.T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det(matrix) == pytest.approx(1)
    assert RotationMatrix(matrix) == pytest.approx(matrix, abs=0)
    assert RotationMatrix(("z", 90)) @ [1, 0, 0] == pytest.approx([0, 1, 0])
    assert RotationMatrix(([1, 1, 1], 120)) @ [1, 2, 3] == pytest.approx([3, 1, 2])


def test_distance_is_relative_to_the_master_size():
    plane = meshes.TwoBlocks(1 / 2, 1 / 3, structured=True)  # nodes 1/2 and 1/3, 2/3
    assert CheckNonMatching(plane) == pytest.approx(0.5)
    assert CheckNonMatching(meshes.TwoBlocks3D("hex", None, 2, 3)) == pytest.approx(math.sqrt(0.5))
