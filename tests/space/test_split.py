"""SplitSlaveFaces: the mesh modification of the Local Average Contact paper, in 2D and 3D."""

from itertools import combinations, product

import numpy as np
import pytest
from bricks import brick, glued, slave_faces
from measures import area, volume
from ngsolve import BBBND, BBND, BND, H1, VOL, Mesh, Periodic
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh
from splits import (
    CELLS,
    ROUND,
    block,
    check_split,
    elements,
    is_conforming,
    mesh_of,
    min_jacobian,
    parents,
    shapes,
    single_cell,
    split_of,
    vertices,
)

from ngslac import SplitSlaveFaces

# Shape, slave faces, keyword, volume elements, parts of faces, new vertices. Triangle, two faces
# of a quadrilateral and hexahedra are DECOUPE_LAC's own tests: it has 6, 15, 26 and 28 cells with
# those of the boundary (and twelve edges), and 4, 12, 9 and 16 nodes.
PATTERNS = [
    ("trig", 0, "pyramids", {"trig": 2}, {"segm": 2}, 1),
    ("quad", 0, "pyramids", {"quad": 4}, {"segm": 3}, 4),
    ("quad", "[01]", "pyramids", {"quad": 7}, {"segm": 6}, 8),
    ("tet", 0, "pyramids", {"tet": 3}, {"trig": 3}, 1),
    ("pyramid", 0, "pyramids", {"tet": 4}, {"trig": 4}, 1),
    ("pyramid", 1, "pyramids", {"tet": 3, "pyramid": 1}, {"trig": 3}, 1),
    ("prism", 0, "pyramids", {"tet": 1, "pyramid": 3}, {"trig": 3}, 1),
    ("prism", 2, "pyramids", {"tet": 2, "pyramid": 2}, {"trig": 4}, 1),
    ("hex", 1, "pyramids", {"pyramid": 5}, {"trig": 4}, 1),
    ("hex", 1, "hexes", {"hex": 6}, {"quad": 5}, 8),
    ("prism", 2, "hexes", {"tet": 2, "pyramid": 2}, {"trig": 4}, 1),
]


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(("shape", "face", "hexes", "volumes", "faces", "nodes"), PATTERNS)
def test_patterns_of_single_cells(shape, face, hexes, volumes, faces, nodes, mirrored):
    mesh = single_cell(shape, mirrored and shape not in ("trig", "quad"))
    split = SplitSlaveFaces(mesh, f"f{face}", hexes=hexes)
    check_split(mesh, split)
    assert shapes(split) == volumes
    assert split.nv == mesh.nv + nodes
    slave = [el.type.name.lower() for el in slave_faces(split, f"f{face}")]
    assert {name: slave.count(name) for name in slave} == faces
    assert split.GetNE(BND) - mesh.GetNE(BND) == sum(faces.values()) - (1 + (face == "[01]"))


@pytest.mark.parametrize("hexes", ["pyramids", "hexes"])
@pytest.mark.parametrize("shape", CELLS)
def test_several_slave_faces_of_one_element(shape, hexes):
    mesh = single_cell(shape)
    names = mesh.GetBoundaries()
    for pair in [*combinations(names, 2), names]:
        split = SplitSlaveFaces(mesh, "|".join(pair), hexes=hexes)
        check_split(mesh, split)
        for name in names:
            assert (len(slave_faces(split, name)) == 1) == (name not in pair)
    counts = {"trig": 4, "tet": 9, "pyramid": 12, "hex": 20 if hexes == "pyramids" else 31}
    assert split.ne == counts.get(shape, split.ne)


@pytest.mark.parametrize("slave", ["top", "top|left", "left|right", ".*"])
@pytest.mark.parametrize("kind", ["trig", "quad", "square", "tet", "prism", "hex", "hexes", "cube"])
def test_bricks(kind, slave):
    mesh = block(kind, 3)
    split = split_of(mesh, kind, slave)
    check_split(mesh, split, slave)
    numbers = parents(mesh, split, slave)
    old, new = elements(mesh, BND), elements(split, BND)
    for parent in set(numbers.values()):
        pieces = [set(new[nr][0]) for nr, p in numbers.items() if p == parent]
        corners = {v for piece in pieces for v in piece if v < mesh.nv}
        assert corners == set(old[parent][0])
        inner = set.union(*pieces) - corners
        assert len(inner) == {"quad": 2, "hexes": 4}.get(kind, 1)
        assert all(inner & piece for piece in pieces)
    if mesh.dim == 2:
        more = np.array([split.ne - mesh.ne, split.nv - mesh.nv]) / len(slave_faces(mesh, slave))
        assert more.tolist() == ([3, 4] if kind == "quad" else [1, 1])
        assert set(shapes(split)) == set(shapes(mesh))
    else:
        assert split.GetNE(BBND) == mesh.GetNE(BBND)


@pytest.mark.parametrize(
    ("name", "order"),
    [*product(ROUND, (1, 2, 3)), *product(("disk", "disk of quadrilaterals", "spline disk"), (4,))],
)
def test_curved_geometry(name, order):
    """In 2D the slave edges get shorter, in 3D their edges do not: the error falls less."""
    make, exact_volume, exact_area = ROUND[name]
    mesh = make().Curve(order)
    before = abs(volume(mesh) - exact_volume), abs(area(mesh, "surface") - exact_area)
    flat = area(mesh, "flat")
    split = SplitSlaveFaces(mesh, "surface")
    assert split.GetCurveOrder() == order
    factor = {1: 0.3, 2: 0.08, 3: 0.08, 4: 0.03}[order] if mesh.dim == 2 else 0.6
    assert abs(volume(split) - exact_volume) < factor * before[0]
    assert abs(area(split, "surface") - exact_area) < factor * before[1]
    assert area(split, "flat") == pytest.approx(flat, rel=1e-12, abs=1e-12)
    assert min_jacobian(split) > 0
    assert is_conforming(split)
    assert abs(volume(mesh) - exact_volume) == before[0]
    new = vertices(split)[mesh.nv :]
    radius = np.linalg.norm(new if "sphere" in name or name == "ball" else new[:, :2], axis=1)
    at = abs(radius - 1) < (1e-12 if mesh.dim == 2 else 1e-8)
    assert at.sum() == (split.GetNE(BND) - mesh.GetNE(BND)) / (mesh.dim - 1)
    assert mesh.dim == 2 or all(at)
    for higher in (2, 3) if order == 1 else ():
        assert min_jacobian(split.Curve(higher)) > 0


@pytest.mark.parametrize("name", ["csg hemisphere", "cylinder"])
def test_round_and_flat_faces_of_one_element(name):
    mesh = ROUND[name][0]().Curve(2)
    split = SplitSlaveFaces(mesh, "surface|flat")
    assert abs(volume(split) - ROUND[name][1]) < 0.5 * abs(volume(mesh) - ROUND[name][1])
    assert min_jacobian(split) > 0
    assert is_conforming(split)
    assert split.GetNE(BND) == 3 * mesh.GetNE(BND)


@pytest.mark.parametrize("name", ["plate", "occ hemisphere"])
def test_names_are_kept_and_the_mesh_is_untouched(name):
    mesh = ROUND[name][0]().Curve(2)
    space = H1(mesh, order=2)

    def Of(mesh):
        parts = [elements(mesh, vb) for vb in (VOL, BND)]
        return parts, vertices(mesh).tolist(), volume(mesh), mesh.GetCurveOrder()

    before = Of(mesh)
    split = SplitSlaveFaces(mesh, "surface")
    space.Update()
    assert Of(mesh) == before
    assert split.GetMaterials() == mesh.GetMaterials()
    assert split.GetBoundaries() == mesh.GetBoundaries()
    assert split.GetBBoundaries() == mesh.GetBBoundaries()
    if mesh.dim == 3:
        assert (set(mesh.GetBBoundaries()), set(mesh.GetBBBoundaries())) == ({"rim"}, {"corner"})
        assert split.GetBBBoundaries() == mesh.GetBBBoundaries()
        for vb in (BBND, BBBND):
            assert elements(split, vb) == elements(mesh, vb)


@pytest.mark.parametrize(("dim", "quads"), [(2, False), (2, True), (3, False)])
def test_interface_between_materials(dim, quads):
    mesh = glued(dim, 0.3 if dim == 2 else 0.6, quads)
    n = len(slave_faces(mesh, "interface"))
    split = SplitSlaveFaces(mesh, "interface")
    check_split(mesh, split, "interface")
    new = vertices(split)[mesh.nv :]
    assert np.sum(abs(new[:, 0] - 1) < 1e-12) == (2 if quads else 1) * n
    assert quads or split.nv == mesh.nv + n
    assert split.ne >= mesh.ne + 2 * (dim - 1) * n
    for material in "AB":
        assert volume(split, material) == pytest.approx(1, rel=1e-13)
    if dim == 3:
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
    inner = f"f{faces.index((4, 5, 6, 7))}"
    cells = [cell, (4, 5, 6, 7, 8)]
    mesh = mesh_of([*points, (0.5, 0.5, 2)], cells, [*faces, *tip], inside=inner)
    for hexes in ("pyramids", "hexes"):
        split = SplitSlaveFaces(mesh, inner, hexes=hexes)
        check_split(mesh, split)
        assert split.ne == (5 if below == "hex" else 4) + 4
    if below == "hex":
        split = SplitSlaveFaces(mesh, "f[1-9]", hexes="hexes")  # all but the base
        check_split(mesh, split)
        assert shapes(split)["hex"] == 20


@pytest.mark.parametrize("name", ["disk", "occ hemisphere"])
def test_mesh_moved_off_its_geometry_stays_straight(name):
    mesh = ROUND[name][0]()
    for p in mesh.ngmesh.Points():
        p[0] = 2 * p[0]
    moved = Mesh(mesh.ngmesh)
    check_split(moved, SplitSlaveFaces(moved, "surface"))


@pytest.mark.parametrize("hexes", ["pyramids", "hexes"])
@pytest.mark.parametrize("kind", ["quad", "tet", "prism", "hex"])
def test_mapped_bricks_without_geometry(kind, hexes):
    if kind == "quad":
        plane = lambda s, t: (1 + s + 0.2 * t * t, t + 0.1 * s)  # noqa: E731
        mesh, rel = MakeStructured2DMesh(quads=True, nx=4, ny=4, mapping=plane), 1e-14
    else:

        def Map(p):
            s, t, r = p.T
            return np.stack([s + 0.2 * t * r, t - 0.1 * r * r, 1e-3 * (r + 0.2 * s * t)], axis=1)

        mesh, rel = brick(kind, 3, mapping=Map), 1e-12 if kind == "tet" else 3e-2
    split = SplitSlaveFaces(mesh, "top|left", hexes=hexes)
    assert min_jacobian(split) > 0
    assert is_conforming(split)
    assert volume(split) == pytest.approx(volume(mesh), rel=rel)


@pytest.mark.parametrize(
    ("name", "order", "factor"),
    [
        ("disk", 3, 0.1),
        ("disk of quadrilaterals", 3, 0.1),
        ("spline disk", 3, 0.1),
        ("occ hemisphere", 2, 0.2),
    ],
)
def test_refine_afterwards(name, order, factor):
    make, exact, _ = ROUND[name]
    split = SplitSlaveFaces(make(), "surface").Curve(order)
    ne, error = split.ne, abs(volume(split) - exact)
    split.Refine()
    split.Curve(order)
    assert split.ne == 2**split.dim * ne
    assert abs(volume(split) - exact) < factor * error
    assert min_jacobian(split) > 0
    assert is_conforming(split)


@pytest.mark.parametrize(("name", "order", "tol"), [("disk", 3, 1e-4), ("occ hemisphere", 2, 1e-3)])
def test_split_after_local_refinement_and_again(name, order, tol):
    make, exact, _ = ROUND[name]
    mesh = make()
    for el in mesh.Elements(VOL):
        mesh.SetRefinementFlag(el, el.nr % 5 == 0)
    mesh.Refine()
    split = mesh.Curve(order)
    for _ in range(2):
        n = len(slave_faces(split, "surface"))
        split = SplitSlaveFaces(split, "surface")
        assert len(slave_faces(split, "surface")) == split.dim * n
        assert abs(volume(split) - exact) < tol
        assert min_jacobian(split) > 0


@pytest.mark.parametrize("dim", [2, 3])
def test_periodic_mesh_keeps_its_identification(dim):
    make = MakeStructured2DMesh if dim == 2 else MakeStructured3DMesh
    mesh = make(nx=3, ny=3, periodic_x=True, **({} if dim == 2 else {"nz": 2}))
    split = SplitSlaveFaces(mesh, "top")
    held = sum(v.point[0] == 0 for v in mesh.vertices)
    assert sum(Periodic(H1(split)).FreeDofs()) == split.nv - held
    if dim == 2:
        SplitSlaveFaces(mesh, "left")
