"""Pairing of flat surfaces in 3D against the plane geometry of shapely."""

import numpy as np
import pytest
import shapely
from ngsolve import TaskManager
from pyngcore import GetNumThreads, SetNumThreads
from surfaces3d import (
    Sheet,
    areas_by_face,
    areas_by_pair,
    contact_on,
    face_vector,
    faces_of,
    in_plane,
    projected_overlaps,
    quad_grid,
    rigid,
    sheet_mesh,
    surface,
)

KINDS = ("trig", "quad", "mixed")
SQUARE = ((0.0, 0.0), (1.0, 1.0))
WIDER = ((-0.3, -0.2), (1.2, 1.3))
SHIFTED = ((-0.2, -0.1), (0.8, 1.1))


def upper(points, faces, z=0.0, depth=0.5, **flags):
    return Sheet("upper", in_plane(points, z), faces, (0, 0, depth), "slave", **flags)


def lower(points, faces, z=0.0, depth=0.5, name="lower", **flags):
    return Sheet(name, in_plane(points, z), faces, (0, 0, -depth), "master", **flags)


def two_sheets(rng, kinds=("trig", "quad"), box=SHIFTED, gap=0.0, slope=(0.0, 0.0), n=(3, 4)):
    """Random divisions; the master's plane z = -gap + slope.(x, y); any numbering of faces."""
    slave, (points, faces) = surface(rng, kinds[0], n[0]), surface(rng, kinds[1], n[1], box)
    below = in_plane(points, -gap)
    below[:, 2] += points @ np.asarray(slope)
    return [
        upper(*slave, renumbered=rng),
        Sheet("lower", below, faces, (0, 0, -0.5), "master", renumbered=rng),
    ]


def check_pairs(contact):
    """Every pair against the intersection of both faces seen along the slave normal.

    To 1e-12 of the face's area, or what rounding the coordinates makes of its longest side.
    """
    (slave, own), (master, others) = (faces_of(contact.mesh, r) for r in ("slave", "master"))
    exact, found = projected_overlaps(own, others), areas_by_pair(contact)
    got = [[found.pop((s, m), 0.0) for m in master] for s in slave]
    assert not found
    size = np.array([0.5 * np.linalg.norm(face_vector(c)) for c in own])
    far = np.abs(np.concatenate(own + others)).max()
    rounding = 8e-15 * far * np.array([np.ptp(c, axis=0).max() for c in own])
    error = np.abs(np.array(got) - exact) / np.maximum(1e-12 * size, rounding)[:, None]
    assert error.max() < 1
    return exact, size


@pytest.mark.parametrize("kinds", [(a, b) for a in KINDS for b in KINDS], ids="-".join)
@pytest.mark.parametrize("seed", range(3))
def test_areas_of_all_pairs(kinds, seed):
    rng = np.random.default_rng(seed)
    box = (SHIFTED, WIDER, ((0.2, 0.3), (0.7, 1.1)))[seed]
    slope = rng.choice([0, 1]) * rng.uniform(-0.3, 0.3, 2)
    sheets = two_sheets(rng, kinds, box, rng.choice([0.0, 0.01, 0.5]), slope)
    contact = contact_on(sheet_mesh(*sheets, motion=rigid(seed, 10.0 ** rng.integers(-4, 5))))
    exact, size = check_pairs(contact)
    assert exact.max() > 0.05 * size.max()
    assert areas_by_face(contact) == pytest.approx(exact.sum(axis=1), abs=1e-12 * size.max())
    if box is WIDER:
        assert areas_by_face(contact) == pytest.approx(size, rel=1e-12)


@pytest.mark.parametrize("kinds", [("trig", "mixed"), ("quad", "quad"), ("mixed", "trig")])
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_gap_of_tilted_planes(kinds, scale):
    """The mean over a pair is the distance of the planes at the centroid of its overlap."""
    rng = np.random.default_rng(7)
    slope, motion = np.array([0.2, -0.35]), rigid(5, scale, (2.0, 0, 0))
    contact = contact_on(sheet_mesh(*two_sheets(rng, kinds, gap=0.02, slope=slope), motion=motion))
    segments = contact.Segments()
    plane = rigid(5)(np.eye(3))
    back = (segments.slave_points - (2.0, 0, 0)) / scale @ plane.T
    assert back[:, 2] == pytest.approx(0, abs=1e-12 / min(scale, 1))
    for i, (start, end) in enumerate(zip(segments.first[:-1], segments.first[1:], strict=True)):
        polygon = shapely.Polygon(back[start:end, :2])
        centroid = np.array(polygon.centroid.coords[0])
        assert segments.area[i] / scale**2 == pytest.approx(polygon.area, abs=1e-13)
        gap = 0.02 - centroid @ slope
        assert segments.gap[i] / scale == pytest.approx(gap, abs=1e-11 + 1e-15 / polygon.area)


@pytest.mark.parametrize("kinds", [("trig", "quad"), ("mixed", "mixed")])
@pytest.mark.parametrize("gap", [0.0, 1e-9, 0.3, 20.0, -0.05])
def test_gap_of_parallel_planes(kinds, gap):
    """Touching, nearly, open by far more than the size of faces, and penetrating."""
    sheets = two_sheets(np.random.default_rng(3), kinds, WIDER, gap)
    contact = contact_on(sheet_mesh(*sheets, motion=rigid(3)))
    segments = contact.Segments()
    assert segments.gap == pytest.approx(gap, abs=1e-13 * (1 + abs(gap)))
    assert segments.area.sum() == pytest.approx(1, rel=1e-13)
    across = segments.master_points - segments.slave_points
    normal = rigid(3)([[0.0, 0.0, -1.0]])
    assert across == pytest.approx(np.tile(gap * normal, (len(across), 1)), abs=1e-12)
    assert contact.Table()["normal"] == pytest.approx(
        np.tile(normal, (contact.space.nmacros, 1)), abs=1e-13
    )


@pytest.mark.parametrize("seed", range(3))
def test_polygons_tile_the_faces(seed):
    """Corners of segments: inside of their slave face, with the segment's area, no overlaps."""
    rng = np.random.default_rng(seed)
    contact = contact_on(sheet_mesh(*two_sheets(rng, ("mixed", "mixed"), WIDER, 0.1)))
    segments = contact.Segments()
    polygons = [shapely.Polygon(p) for p in np.split(segments.slave_points, segments.first[1:-1])]
    assert shapely.area(polygons) == pytest.approx(segments.area, abs=1e-14)
    assert shapely.union_all(polygons).area == pytest.approx(1, rel=1e-12)
    numbers, corners = faces_of(contact.mesh, "slave")
    faces = {
        int(n): shapely.Polygon(c).buffer(1e-12) for n, c in zip(numbers, corners, strict=True)
    }
    assert all(faces[s].contains(p) for s, p in zip(segments.slave, polygons, strict=True))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [None, 1, 2])
def test_matching_faces_give_no_slivers(kind, seed):
    points, faces = surface(np.random.default_rng(4), kind)
    rng = np.random.default_rng(5)
    mesh = sheet_mesh(
        upper(points, faces, renumbered=rng),
        lower(points, faces[::-1], renumbered=rng),
        motion=rigid(seed, 3.0),
    )
    contact = contact_on(mesh)
    segments = contact.Segments()
    assert len(segments) == len(faces)
    check_pairs(contact)
    centers = [{n: c.mean(axis=0) for n, c in zip(*faces_of(mesh, r), strict=True)}
               for r in ("slave", "master")]  # fmt: skip
    for s, m in zip(segments.slave, segments.master, strict=True):
        assert centers[0][s] == pytest.approx(centers[1][m], abs=1e-13)


@pytest.mark.parametrize("seed", [None, 1, 2])
def test_edges_on_edges(seed):
    """A grid on one three times finer: every second edge lies on an edge of the other side."""
    coarse, fine = quad_grid(2, 2), quad_grid(6, 6, diagonals=range(36))
    for slave, master in ((coarse, fine), (fine, coarse)):
        contact = contact_on(sheet_mesh(upper(*slave), lower(*master), motion=rigid(seed)))
        assert len(contact.Segments()) == 72
        assert contact.Segments().area == pytest.approx(1 / 72, rel=1e-11)


@pytest.mark.parametrize("seed", [None, 3])
@pytest.mark.parametrize("corner", [(1.0, 0.0), (1.0, 1.0), (0.5, 1.0)])
def test_touching_at_an_edge_or_a_corner_is_no_contact(corner, seed):
    """A second slave body that overlaps keeps the pairing alive."""
    x, y = corner
    contact = contact_on(
        sheet_mesh(
            upper(*quad_grid(2, 2)),
            Sheet("second", in_plane(quad_grid(1, 1, ((3, 0), (4, 1)))[0]), [(0, 2, 3, 1)],
                  (0, 0, 1), "slave"),
            lower(*quad_grid(3, 3, ((x, y), (x + 1, y + 1)))),
            lower(*quad_grid(3, 3, ((3, 0), (4, 1))), name="other"),
            motion=rigid(seed),
        )
    )  # fmt: skip
    assert areas_by_face(contact) == pytest.approx([0, 0, 0, 0, 1], abs=1e-13)
    assert np.all(contact.Table()["area"][:4] == 0)
    assert contact.Segments().area.min() > 1e-3


@pytest.mark.parametrize("kinds", [("trig", "quad"), ("quad", "trig"), ("mixed", "mixed")])
@pytest.mark.parametrize("stretch", [(1e3, 1.0), (1.0, 1e-3), (1e2, 1e-3)])
def test_anisotropic_faces(kinds, stretch):
    rng = np.random.default_rng(8)
    sheets = [
        Sheet(s.name, s.points * (*stretch, 1.0), s.faces, s.depth, s.face, renumbered=rng)
        for s in two_sheets(rng, kinds, gap=0.01)
    ]
    check_pairs(contact_on(sheet_mesh(*sheets, motion=rigid(8))))


@pytest.mark.parametrize("swap", [False, True])
def test_strongly_graded_faces(swap):
    """Sizes from 1 to 1e-6 on both sides, towards different points."""
    grades = [np.concatenate([[0], 10.0 ** np.arange(-6, 1)]) for _ in range(2)]
    grades[1] = 1.1 - 1.1 * grades[1][::-1] if swap else 0.13 + grades[1]
    both = []
    for grade in grades:
        points, faces = quad_grid(7, 7, diagonals=range(0, 49, 3))
        i, j = np.rint(7 * points).astype(int).T
        both.append((np.stack([grade[i], grade[j]], axis=1), faces))
    contact = contact_on(sheet_mesh(upper(*both[0]), lower(*both[1], z=-1e-3), motion=rigid(2)))
    exact, size = check_pairs(contact)
    assert areas_by_face(contact).sum() == pytest.approx(exact.sum(), rel=1e-12)
    big = size > 1e-3
    assert areas_by_face(contact)[big] == pytest.approx(exact.sum(axis=1)[big], rel=1e-12)


@pytest.mark.parametrize("size", [1.0, 50.0, 1e4])
def test_one_huge_face_and_many_small_ones(size):
    many = surface(np.random.default_rng(6), "mixed", 6)
    one = quad_grid(1, 1, ((0.5 - size, 0.3 - size), (0.3 + size, 0.6 + size)))
    for slave, master in ((one, many), (many, one)):
        mesh = sheet_mesh(upper(*slave), lower(*master, z=-0.1), motion=rigid(1))
        contact = contact_on(mesh)
        check_pairs(contact)
        assert contact.Segments().area.sum() == pytest.approx(1, rel=1e-12 + 1e-15 * size)


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1e6])
def test_motion_and_unit_change_nothing(scale):
    def segments(motion):
        sheets = two_sheets(np.random.default_rng(9), ("mixed", "trig"), gap=0.02, slope=(0.1, 0))
        return contact_on(sheet_mesh(*sheets, motion=motion)).Segments()

    reference, motion = segments(rigid()), rigid(4, scale, (0, 3 * scale, scale))
    there = segments(motion)
    order, other = (np.lexsort((s.area.round(9), s.master, s.slave))
                    for s in (reference, Scaled(there, scale)))  # fmt: skip
    assert there.slave[other].tolist() == reference.slave[order].tolist()
    assert there.master[other].tolist() == reference.master[order].tolist()
    assert there.area[other] / scale**2 == pytest.approx(reference.area[order], abs=1e-13)
    assert there.gap[other] / scale == pytest.approx(reference.gap[order], rel=1e-8, abs=1e-12)


class Scaled:
    """Segments in another unit, as far as their order is concerned."""

    def __init__(self, segments, scale):
        self.slave, self.master, self.area = segments.slave, segments.master, segments.area
        self.area = self.area / scale**2


def entries(contact):
    """Values and columns of the operators D and M."""
    return [np.array(part) for operator in contact.Mortar() for part in operator.CSR()[:2]]


def test_the_number_of_threads_does_not_matter():
    sheets = two_sheets(
        np.random.default_rng(1), ("mixed", "mixed"), WIDER, 0.01, slope=(0.05, 0), n=(8, 9)
    )
    contact = contact_on(sheet_mesh(*sheets, motion=rigid(1)), order=2)
    alone, table, before = contact.Segments(), contact.Table(), entries(contact)
    assert len(alone) > 300
    number = GetNumThreads()
    try:
        for threads in (1, 2, 4):
            SetNumThreads(threads)
            with TaskManager():
                contact.Update()
                threaded, after = contact.Segments(), entries(contact)
            for name in ("slave", "master", "area", "gap", "slave_points", "master_points"):
                assert np.array_equal(getattr(alone, name), getattr(threaded, name)), name
            for name, values in contact.Table().items():
                assert np.array_equal(table[name], values), name
            assert all(map(np.array_equal, before, after))
    finally:
        SetNumThreads(number)
