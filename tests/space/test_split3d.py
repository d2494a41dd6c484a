"""SplitSlaveFaces in 3D: cones and hexahedra, curved geometry, several slave faces."""

from collections import Counter
from itertools import combinations

import numpy as np
import pytest
from ngsolve import BBBND, BBND, BND, H1, VOL, Mesh, Periodic
from splitmeshes3d import (
    CELLS,
    ROUND,
    area,
    brick,
    cube,
    elements,
    interface_mesh,
    is_conforming,
    mesh_of,
    min_jacobian,
    occ_hemisphere,
    parents,
    shapes,
    single_cell,
    straight_volume,
    vertices,
    volume,
)

from ngslac import SplitSlaveFaces

PATTERNS = [  # shape, slave face, keyword, volume elements, parts of the face, new vertices
    ("tet", 0, "pyramids", {"tet": 3}, {"trig": 3}, 1),
    ("pyramid", 0, "pyramids", {"tet": 4}, {"trig": 4}, 1),
    ("pyramid", 1, "pyramids", {"tet": 3, "pyramid": 1}, {"trig": 3}, 1),
    ("prism", 0, "pyramids", {"tet": 1, "pyramid": 3}, {"trig": 3}, 1),
    ("prism", 2, "pyramids", {"tet": 2, "pyramid": 2}, {"trig": 4}, 1),
    ("hex", 1, "pyramids", {"pyramid": 5}, {"trig": 4}, 1),
    ("hex", 1, "hexes", {"hex": 6}, {"quad": 5}, 8),
    ("prism", 2, "hexes", {"tet": 2, "pyramid": 2}, {"trig": 4}, 1),
]


def check_split(mesh, split):
    """What holds for every split of a straight mesh with flat faces."""
    assert straight_volume(split) == pytest.approx(straight_volume(mesh), rel=1e-13)
    for name in set(mesh.GetBoundaries()):
        assert area(split, name) == pytest.approx(area(mesh, name), rel=1e-13)
    assert min_jacobian(split) > 0
    assert is_conforming(split)
    np.testing.assert_array_equal(vertices(split)[: mesh.nv], vertices(mesh))


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(("shape", "face", "hexes", "volumes", "faces", "nodes"), PATTERNS)
def test_patterns_of_single_cells(shape, face, hexes, volumes, faces, nodes, mirrored):
    mesh = single_cell(shape, mirrored)
    split = SplitSlaveFaces(mesh, f"f{face}", hexes=hexes)
    check_split(mesh, split)
    assert shapes(split) == volumes
    assert split.nv == mesh.nv + nodes
    slave = Counter(
        el.type.name.lower() for el in split.Elements(BND) if el.mat == mesh.GetBoundaries()[face]
    )
    assert slave == faces
    assert split.GetNE(BND) == mesh.GetNE(BND) + sum(faces.values()) - 1


@pytest.mark.parametrize(("hexes", "cells", "nodes"), [("pyramids", 26, 9), ("hexes", 28, 16)])
def test_published_counts_of_a_hexahedron(hexes, cells, nodes):
    """All cells of DECOUPE_LAC's own test, with boundary cells and the twelve edges."""
    split = SplitSlaveFaces(single_cell("hex"), "f1", hexes=hexes)
    assert split.ne + split.GetNE(BND) + 12 == cells
    assert split.nv == nodes


@pytest.mark.parametrize("hexes", ["pyramids", "hexes"])
@pytest.mark.parametrize("shape", CELLS)
def test_several_slave_faces_of_one_element(shape, hexes):
    mesh = single_cell(shape)
    names = mesh.GetBoundaries()
    for pair in [*combinations(names, 2), names]:
        split = SplitSlaveFaces(mesh, "|".join(pair), hexes=hexes)
        check_split(mesh, split)
        for name in names:
            whole = name not in pair
            parts = [el for el in split.Elements(BND) if el.mat == name]
            assert (len(parts) == 1) == whole


def test_all_faces_of_single_cells():
    counts = {
        shape: shapes(SplitSlaveFaces(single_cell(shape), ".*")).total()
        for shape in ("tet", "pyramid", "hex")
    }
    assert counts == {"tet": 9, "pyramid": 12, "hex": 20}
    assert SplitSlaveFaces(single_cell("hex"), ".*", hexes="hexes").ne == 31


@pytest.mark.parametrize("slave", ["top", "top|left", "left|right", ".*"])
@pytest.mark.parametrize("kind", ["tet", "prism", "hex", "hexes", "unstructured"])
def test_bricks(kind, slave):
    mesh = cube() if kind == "unstructured" else brick("hex" if kind == "hexes" else kind)
    split = SplitSlaveFaces(mesh, slave, hexes="hexes" if kind == "hexes" else "pyramids")
    check_split(mesh, split)
    numbers = parents(mesh, split, slave)
    old, new = elements(mesh, BND), elements(split, BND)
    for parent in set(numbers.values()):
        pieces = [set(new[nr][0]) for nr, p in numbers.items() if p == parent]
        corners = {v for piece in pieces for v in piece if v < mesh.nv}
        assert corners == set(old[parent][0])
        inner = set.union(*pieces) - corners
        assert len(inner) == (4 if kind == "hexes" else 1)
        assert all(inner & piece for piece in pieces)
    assert split.GetNE(BBND) == mesh.GetNE(BBND)


@pytest.mark.parametrize("kind", ["tet", "prism", "hex"])
def test_only_slave_elements_change(kind):
    mesh = brick(kind, nz=3)
    split = SplitSlaveFaces(mesh, "top")
    slave = {face.nr for el in mesh.Boundaries("top").Elements() for face in el.faces}
    kept = [
        old
        for old, el in zip(elements(mesh), mesh.Elements(VOL), strict=True)
        if not slave & {face.nr for face in el.faces}
    ]
    assert len(kept) == mesh.ne - len(slave)
    assert set(kept) <= set(elements(split))
    others = [el for el in elements(mesh, BND) if el[1] != "top"]
    assert set(others) <= set(elements(split, BND))


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("name", ROUND)
def test_curved_geometry(name, order):
    """The slave faces get smaller but their edges do not: the error falls by a factor only."""
    make, exact_volume, exact_area = ROUND[name]
    mesh = make()
    if order > 1:
        mesh.Curve(order)
    before = abs(volume(mesh) - exact_volume), abs(area(mesh, "round") - exact_area)
    flat = area(mesh, "flat")
    split = SplitSlaveFaces(mesh, "round")
    assert split.GetCurveOrder() == order
    assert abs(volume(split) - exact_volume) < 0.6 * before[0]
    assert abs(area(split, "round") - exact_area) < 0.6 * before[1]
    assert area(split, "flat") == pytest.approx(flat, rel=1e-12, abs=1e-12)
    assert min_jacobian(split) > 0
    assert is_conforming(split)
    assert abs(volume(mesh) - exact_volume) == before[0]
    new = vertices(split)[mesh.nv :]
    radius = np.linalg.norm(new if "sphere" in name or "ball" in name else new[:, :2], axis=1)
    np.testing.assert_allclose(radius, 1, rtol=0, atol=1e-8)
    if order == 1:
        for higher in (2, 3):
            assert min_jacobian(split.Curve(higher)) > 0


@pytest.mark.parametrize("name", ["csg hemisphere", "occ cylinder"])
def test_round_and_flat_faces_of_one_element(name):
    mesh = ROUND[name][0]().Curve(2)
    slave = {face.nr for el in mesh.Elements(BND) for face in el.faces}
    assert any(sum(f.nr in slave for f in el.faces) == 2 for el in mesh.Elements(VOL))
    split = SplitSlaveFaces(mesh, "round|flat")
    assert abs(volume(split) - ROUND[name][1]) < 0.5 * abs(volume(mesh) - ROUND[name][1])
    assert min_jacobian(split) > 0
    assert is_conforming(split)
    assert split.GetNE(BND) == 3 * mesh.GetNE(BND)


def test_names_are_kept():
    mesh = occ_hemisphere()
    split = SplitSlaveFaces(mesh, "round")
    assert set(mesh.GetBBoundaries()) == {"rim"}
    assert set(mesh.GetBBBoundaries()) == {"corner"}
    assert split.GetMaterials() == mesh.GetMaterials() == ("body",)
    assert split.GetBoundaries() == mesh.GetBoundaries()
    assert split.GetBBoundaries() == mesh.GetBBoundaries()
    assert split.GetBBBoundaries() == mesh.GetBBBoundaries()
    assert elements(split, BBND) == elements(mesh, BBND)
    assert elements(split, BBBND) == elements(mesh, BBBND)


def test_mesh_is_untouched():
    mesh = occ_hemisphere().Curve(2)
    space = H1(mesh, order=2)
    before = elements(mesh), elements(mesh, BND), vertices(mesh), volume(mesh)
    SplitSlaveFaces(mesh, "round|flat")
    space.Update()
    assert (elements(mesh), elements(mesh, BND)) == before[:2]
    np.testing.assert_array_equal(vertices(mesh), before[2])
    assert volume(mesh) == before[3]
    assert mesh.GetCurveOrder() == 2


def test_interface_between_materials():
    mesh = interface_mesh()
    n = sum(1 for _ in mesh.Boundaries("interface").Elements())
    split = SplitSlaveFaces(mesh, "interface")
    check_split(mesh, split)
    assert split.nv == mesh.nv + n
    assert split.ne >= mesh.ne + 4 * n
    for material in "AB":
        assert volume(split, material) == pytest.approx(1, rel=1e-13)
    sides = [(f.domin, f.domout) for f in split.ngmesh.FaceDescriptors()]
    assert sides == [(f.domin, f.domout) for f in mesh.ngmesh.FaceDescriptors()]


@pytest.mark.parametrize("below", ["hex", "prism"])
def test_interface_between_shapes(below):
    """A pyramid stands on another element: hexes="hexes" must not hang their common face."""
    points = [(i, j, 0.5 * k) for i, j, k in CELLS["hex"][0]]  # their common face is the largest
    cell = range(8) if below == "hex" else (0, 7, 4, 1, 6, 5)  # a prism with the same top
    faces = (
        CELLS["hex"][1]
        if below == "hex"
        else [(4, 5, 6, 7), (0, 1, 5, 4), (0, 7, 6, 1), (0, 4, 7), (1, 6, 5)]
    )
    tip = [(4, 5, 8), (5, 6, 8), (6, 7, 8), (7, 4, 8)]
    mesh = mesh_of(
        [*points, (0.5, 0.5, 2)], [cell, (4, 5, 6, 7, 8)], [*faces, *tip], [(4, 5, 6, 7)]
    )
    inner = f"f{faces.index((4, 5, 6, 7))}"
    for hexes in ("pyramids", "hexes"):
        split = SplitSlaveFaces(mesh, inner, hexes=hexes)
        check_split(mesh, split)
        assert split.ne == (5 if below == "hex" else 4) + 4
    if below == "hex":
        split = SplitSlaveFaces(mesh, "f[1-9]", hexes="hexes")  # all but the base
        check_split(mesh, split)
        assert shapes(split)["hex"] == 20


def test_mesh_moved_off_its_geometry_stays_straight():
    mesh = occ_hemisphere()
    for p in mesh.ngmesh.Points():
        p[0] = 2 * p[0]
    moved = Mesh(mesh.ngmesh)
    check_split(moved, SplitSlaveFaces(moved, "round"))


@pytest.mark.parametrize("hexes", ["pyramids", "hexes"])
@pytest.mark.parametrize("kind", ["tet", "prism", "hex"])
def test_mapped_bricks_without_geometry(kind, hexes):
    mapping = lambda s, t, r: (s + 0.2 * t * r, t - 0.1 * r * r, 1e-3 * (r + 0.2 * s * t))  # noqa: E731
    mesh = brick(kind, mapping=mapping)
    split = SplitSlaveFaces(mesh, "top|left", hexes=hexes)
    assert min_jacobian(split) > 0
    assert is_conforming(split)
    assert volume(split) == pytest.approx(volume(mesh), rel=1e-12 if kind == "tet" else 3e-2)


def test_refine_afterwards():
    split = SplitSlaveFaces(occ_hemisphere(), "round").Curve(2)
    ne, error = split.ne, abs(volume(split) - 2 * np.pi / 3)
    split.Refine()
    split.Curve(2)
    assert split.ne == 8 * ne
    assert abs(volume(split) - 2 * np.pi / 3) < 0.2 * error
    assert min_jacobian(split) > 0
    assert is_conforming(split)


def test_split_after_local_refinement_and_again():
    mesh = occ_hemisphere()
    for el in mesh.Elements(VOL):
        mesh.SetRefinementFlag(el, el.nr % 5 == 0)
    mesh.Refine()
    split = mesh.Curve(2)
    for _ in range(2):
        n = sum(1 for _ in split.Boundaries("round").Elements())
        split = SplitSlaveFaces(split, "round")
        assert sum(1 for _ in split.Boundaries("round").Elements()) == 3 * n
        assert abs(volume(split) - 2 * np.pi / 3) < 1e-3
        assert min_jacobian(split) > 0


def test_periodic_mesh_keeps_its_identification():
    mesh = brick("hex", periodic_x=True)
    split = SplitSlaveFaces(mesh, "top")
    assert sum(Periodic(H1(split)).FreeDofs()) == split.nv - 4 * 3
