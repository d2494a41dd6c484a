"""Pairing of flat surfaces against the plane geometry of shapely."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from ngsolve import TaskManager
from pyngcore import GetNumThreads, SetNumThreads
from sheets import (
    FLAT,
    PAIRS,
    SHIFTED,
    WIDER,
    Motion,
    areas_by_face,
    areas_by_pair,
    contact_on,
    dimension,
    face_sizes,
    faces_of,
    flat,
    grid,
    lower,
    outlines,
    paired,
    projected_overlaps,
    sheet_mesh,
    two_sheets,
    upper,
)

KINDS = ("edge", *FLAT)
pairs = pytest.mark.parametrize("kinds", PAIRS, ids="-".join)


def check_pairs(contact):
    """Every pair against the intersection of both faces seen along the slave normal.

    To 1e-12 of the face's area, or what rounding the coordinates makes of its longest side.
    """
    (slave, own), (master, others) = (faces_of(contact.mesh, r) for r in ("slave", "master"))
    exact, found = projected_overlaps(own, others), areas_by_pair(contact)
    got = [[found.pop((s, m), 0.0) for m in master] for s in slave]
    assert not found
    size, far = face_sizes(own), np.abs(np.concatenate(own + others)).max()
    thick = np.ones(len(own)) if contact.mesh.dim == 2 else [np.ptp(c, axis=0).max() for c in own]
    rounding = 8e-15 * far * np.array(thick)
    error = np.abs(np.array(got) - exact) / np.maximum(1e-12 * size, rounding)[:, None]
    assert error.max() < 1
    return exact, size


CASES = [(("edge", "edge"), seed) for seed in range(20)]
CASES += [((a, b), seed) for a in FLAT for b in FLAT for seed in range(2)]


@pytest.mark.parametrize(("kinds", "seed"), CASES)
def test_areas_of_all_pairs(kinds, seed):
    """Random meshes, openings, slopes, motions and units; table and report say the same."""
    rng = np.random.default_rng(seed)
    box = (SHIFTED, WIDER, ((0.2, 0.3), (0.7, 1.1)))[seed % 3]
    slope = rng.choice([0, 1]) * rng.uniform(-0.3, 0.3, 2)
    sheets = two_sheets(rng, kinds, box, rng.choice([0.0, 0.01, 0.5]), slope)
    scale = 10.0 ** rng.integers(-4, 5)
    contact = paired(sheets, seed, scale, penetration=scale)
    exact, size = check_pairs(contact)
    area = exact.sum(axis=1)
    assert exact.max() > 0.05 * size.max()
    assert areas_by_face(contact) == pytest.approx(area, abs=1e-12 * size.max())
    if box is WIDER:
        assert areas_by_face(contact) == pytest.approx(size, rel=1e-12)
    table, report = contact.Table(), contact.Check()
    assert table["fullarea"] == pytest.approx(size, rel=1e-12)
    assert table["area"] == pytest.approx(area, abs=1e-12 * size.max())
    assert report.paired_area == pytest.approx(area.sum(), rel=1e-12)
    area[area <= 1e-5 * size] = 0  # slivers count as unpaired
    assert report.unpaired.tolist() == np.flatnonzero(area == 0).tolist()
    partial = (area > 0) & (area < (1 - 1e-6) * size)
    assert report.partial.tolist() == np.flatnonzero(partial).tolist()


@pairs
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_gap_of_tilted_planes(kinds, scale):
    """The mean over a pair is the distance of the planes at the centroid of its overlap."""
    slope, motion = np.array([0.2, -0.35]), Motion(dimension(kinds), 5, scale, (2.0, 0, 0))
    sheets = two_sheets(np.random.default_rng(7), kinds, gap=0.02, slope=slope)
    segments = contact_on(sheet_mesh(*sheets, motion=motion)).Segments()
    below = motion.back(segments.master_points.reshape(-1, len(motion.R)))
    plane = -0.02 + below[:, :-1] @ slope[: len(motion.R) - 1]
    assert below[:, -1] == pytest.approx(plane, abs=1e-12 / min(scale, 1))
    for i, corners in enumerate(map(motion.back, outlines(segments))):
        assert corners[:, -1] == pytest.approx(0, abs=1e-12 / min(scale, 1))
        shape = flat(corners[:, :-1])
        assert segments.area[i] / scale ** (motion.R.shape[0] - 1) == pytest.approx(
            shape.area, abs=1e-13
        )
        centroid = np.array(shape.centroid.coords[0])[: corners.shape[1] - 1]
        gap = 0.02 - centroid @ slope[: len(centroid)]
        assert segments.gap[i] / scale == pytest.approx(gap, abs=1e-11 + 1e-15 / shape.area)


@pairs
@pytest.mark.parametrize("gap", [0.0, 1e-9, 0.3, 20.0, -0.05])
def test_parallel_planes(kinds, gap):
    """Touching, nearly, open by far more than the size of faces, penetrating: segments tile."""
    motion = Motion(dimension(kinds), 3)
    mesh = sheet_mesh(*two_sheets(np.random.default_rng(3), kinds, WIDER, gap), motion=motion)
    contact = contact_on(mesh)
    segments, normal = contact.Segments(), -motion.R[:, -1]
    assert segments.gap == pytest.approx(gap, abs=1e-13 * (1 + abs(gap)))
    across = (segments.master_points - segments.slave_points).reshape(-1, len(normal))
    assert across == pytest.approx(np.tile(gap * normal, (len(across), 1)), abs=1e-12)
    normals = contact.Table()["normal"]
    assert normals == pytest.approx(np.tile(normal, (len(normals), 1)), abs=1e-13)

    shapes = [flat(motion.back(p)[:, :-1]) for p in outlines(segments)]
    assert shapely.area(shapes) == pytest.approx(segments.area, abs=1e-14)
    assert shapely.union_all(shapes).area == pytest.approx(1, rel=1e-12)
    assert segments.area.sum() == pytest.approx(1, rel=1e-13)
    numbers, corners = faces_of(mesh, "slave")
    faces = [flat(motion.back(c)[:, :-1]).buffer(1e-12) for c in corners]
    owners = (faces[i] for i in np.searchsorted(numbers, segments.slave))
    assert all(face.contains(shape) for face, shape in zip(owners, shapes, strict=True))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [None, 1, 2])
def test_matching_faces_give_no_slivers(kind, seed):
    points, faces = grid(kind, rng=np.random.default_rng(4))
    rng = np.random.default_rng(5)
    sheets = [upper((points, faces), renumbered=rng), lower((points, faces[::-1]), renumbered=rng)]
    contact = paired(sheets, seed, 3.0)
    segments = contact.Segments()
    assert len(segments) == len(faces)
    check_pairs(contact)
    centers = [{n: c.mean(axis=0) for n, c in zip(*faces_of(contact.mesh, r), strict=True)}
               for r in ("slave", "master")]  # fmt: skip
    for s, m in zip(segments.slave, segments.master, strict=True):
        assert centers[0][s] == pytest.approx(centers[1][m], abs=1e-13)


@pytest.mark.parametrize("seed", [None, 3])
@pytest.mark.parametrize(
    ("kind", "corner"),
    [("edge", (1, 0)), ("quad", (1.0, 0.0)), ("quad", (1.0, 1.0)), ("quad", (0.5, 1.0))],
)
def test_touching_at_an_edge_or_a_corner_is_no_contact(kind, corner, seed):
    """A second slave body that overlaps keeps the pairing alive."""
    there, box = ((3, 0), (4, 1)), (corner, np.add(corner, 1))
    sheets = [upper(grid(kind, 2)), upper(grid(kind, 1, there), name="second")]
    sheets += [lower(grid(kind, 3, box)), lower(grid(kind, 3, there), name="other")]
    contact = paired(sheets, seed)
    assert areas_by_face(contact)[:-1] == pytest.approx(0, abs=1e-13)
    assert areas_by_face(contact)[-1] == pytest.approx(1, abs=1e-13)
    assert np.all(contact.Table()["area"][:-1] == 0)
    assert contact.Segments().area.min() > 1e-3


def stretched(kinds, stretch):
    sheets = two_sheets(np.random.default_rng(8), kinds, gap=0.01)
    return [replace(s, points=s.points * (*stretch, 1.0), renumbered=None) for s in sheets]


def graded(kind, swap):
    """Sizes from 1 to 1e-6 on both sides, towards different points."""
    grades = [np.concatenate([[0], 10.0 ** np.arange(-6, 1)]) for _ in range(2)]
    grades[1] = 1.1 - 1.1 * grades[1][::-1] if swap else 0.13 + grades[1]
    points, faces = grid(kind, 7)
    both = [(grade[np.rint(7 * points).astype(int)], faces) for grade in grades]
    return [upper(both[0]), lower(both[1], -1e-3)]


def one_and_many(kinds, size, swap):
    """One huge face and many small ones."""
    many = grid(kinds[0], 6, rng=np.random.default_rng(6))
    one = grid(kinds[1], 1, ((0.5 - size, 0.3 - size), (0.3 + size, 0.6 + size)))
    return [upper(one), lower(many, -0.1)] if swap else [upper(many), lower(one, -0.1)]


UNEVEN = [(stretched, kinds, stretch) for kinds in PAIRS[1:] for stretch in ((1e3, 1), (1e2, 1e-3))]
UNEVEN += [(graded, kind, swap) for kind in ("edge", "mixed") for swap in (False, True)]
UNEVEN += [
    (one_and_many, kinds, size, swap)
    for kinds in (("edge", "edge"), ("mixed", "quad"))
    for size in (1.0, 50.0, 1e4)
    for swap in (False, True)
]


@pytest.mark.parametrize("case", UNEVEN, ids=lambda case: case[0].__name__)
def test_uneven_faces(case):
    make, *arguments = case
    contact = paired(make(*arguments), 2)
    exact, size = check_pairs(contact)
    assert areas_by_face(contact).sum() == pytest.approx(exact.sum(), rel=1e-11)
    big = size > 1e-3 * size.max()
    assert areas_by_face(contact)[big] == pytest.approx(exact.sum(axis=1)[big], rel=1e-11)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("kind", ["edge", "quad"])
@pytest.mark.parametrize("divisions", [6, 12, 7])  # matching, nested, neither
def test_motion_and_unit_change_nothing(kind, divisions, finite):
    """Of six faces in a row on others, rounded twice; edges on edges give no slivers."""

    def areas(scale=1.0, at=0.0):
        sheets = [upper(grid(kind, 6)), lower(grid(kind, divisions), slope=(0.1, 0))]
        rng, last = np.random.default_rng(0), at * np.finfo(float).eps / 2
        sheets[0].points[:] += last * rng.choice([-1, 0, 1], sheets[0].points.shape)
        shift = scale * at * np.array((1, -0.7, 0.3))
        contact = paired(sheets, 4, scale, shift, finite=finite, penetration=0.2 * scale)
        unit = scale ** (contact.mesh.dim - 1)
        found = {pair: area / unit for pair, area in areas_by_pair(contact).items()}
        return found, contact.Table()["gap"] / scale, len(contact.Segments())

    expected, gap, number = areas()
    assert divisions == 7 or number == len(grid(kind, divisions)[1])
    for scale, at in ((1e-9, 0), (1e6, 0), (1, 1e2), (1, 1e4), (1e-6, 1e4), (1e6, 1e4)):
        found, other, count = areas(scale, at)
        assert count == number
        assert found == pytest.approx(expected, abs=1e-13 + 1e-15 * at)
        assert other == pytest.approx(gap, abs=1e-11 + 1e-15 * at)


def entries(contact):
    """Values and columns of the operators D and M, segments and table."""
    found = [np.array(part) for operator in contact.Mortar() for part in operator.CSR()[:2]]
    names = ("slave", "master", "area", "gap", "slave_points", "master_points")
    segments = contact.Segments()
    return [*found, *(getattr(segments, name) for name in names), *contact.Table().values()]


@pytest.mark.parametrize(("kinds", "n"), [(("edge", "edge"), 100), (("mixed", "mixed"), 8)])
def test_the_number_of_threads_does_not_matter(kinds, n):
    rng = np.random.default_rng(1)
    contact = paired(two_sheets(rng, kinds, WIDER, 0.01, slope=(0.05, 0), n=(n, n + 1)), 1)
    alone, number = entries(contact), GetNumThreads()
    assert len(contact.Segments()) > 300
    try:
        for threads in (1, 2, 4):
            SetNumThreads(threads)
            with TaskManager():
                contact.Update()
                assert all(map(np.array_equal, alone, entries(contact)))
    finally:
        SetNumThreads(number)
