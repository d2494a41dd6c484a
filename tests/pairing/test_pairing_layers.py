"""Which faces pair where there are several: the nearest one that looks back."""

import numpy as np
import pytest
import shapely
from sheets import (
    FLAT,
    Motion,
    Sheet,
    areas_by_face,
    contact_on,
    faces_of,
    flat,
    flat_box,
    grid,
    in_plane,
    lower,
    mean_gap,
    paired,
    sheet_mesh,
    upper,
)


@pytest.fixture(params=["edge", "mixed"])
def kind(request):
    """In the plane and in space."""
    return request.param


def random_plates(rng, kind, gaps, slope=0.0):
    """A slave over plates at random places: their shapes seen from above, and all sheets."""
    kinds = ["edge"] if kind == "edge" else FLAT
    shapes, sheets = [], [upper(grid(rng.choice(kinds), rng=rng), renumbered=rng)]
    for k, gap in enumerate(gaps):
        low = rng.uniform(-0.2, 0.6, 2)
        box = low, low + rng.uniform(0.2, 1, 2)
        surface = grid(rng.choice(kinds), 2, box, rng)
        tilt = slope * rng.uniform(-1, 1, 2)
        middle = np.mean(surface[0], axis=0) @ tilt[: surface[0].shape[1]]
        shapes.append(flat_box(*(ends[: surface[0].shape[1]] for ends in box)))
        sheets.append(lower(surface, -gap - middle, 1e-3, f"plate{k}", tilt, renumbered=rng))
    return shapes, sheets


@pytest.mark.parametrize("seed", range(12))
def test_layers_hide_what_is_behind(kind, seed):
    """Two to four parallel plates of any sizes, one of them penetrated, against shapely.

    They are nearer to each other than faces are large: what is farther behind is left out.
    """
    rng = np.random.default_rng(seed)
    scale = 10.0 ** rng.integers(-3, 4)
    gaps = rng.permutation([0.005, -0.008, 0.02, 0.04])[: rng.integers(2, 5)]
    plates, sheets = random_plates(rng, kind, gaps)
    motion = Motion(2 if kind == "edge" else 3, seed, scale)
    mesh = sheet_mesh(*sheets, motion=motion)
    contact = contact_on(mesh, penetration=0.2 * scale)

    numbers, corners = faces_of(mesh, "slave")
    shapes = [flat(motion.back(c)[:, :-1]) for c in corners]
    exact, hidden = np.zeros((len(shapes), len(gaps))), shapely.Polygon()
    for k in np.argsort(np.abs(gaps)):
        exact[:, k] = shapely.area(shapely.intersection(shapes, plates[k].difference(hidden)))
        hidden = hidden.union(plates[k])
    segments, got = contact.Segments(), np.zeros_like(exact)
    layer = np.argmin(np.abs(segments.gap[:, None] / scale - gaps), axis=1)
    assert segments.gap / scale == pytest.approx(gaps[layer], abs=1e-10)
    area = segments.area / scale ** (mesh.dim - 1)
    np.add.at(got, (np.searchsorted(numbers, segments.slave), layer), area)
    assert got == pytest.approx(exact, abs=1e-13)


@pytest.mark.parametrize("seed", range(10))
def test_crossing_layers_cover_what_their_union_covers(kind, seed):
    """Inclined plates that pass through each other: who is nearest varies, but no area is lost."""
    rng = np.random.default_rng(100 + seed)
    plates, sheets = random_plates(rng, kind, rng.uniform(0, 0.03, 5), slope=0.03)
    contact = paired(sheets, penetration=2.0, maxdist=5.0)
    union = shapely.union_all(plates)
    exact = [flat(c[:, :-1]).intersection(union).area for c in faces_of(contact.mesh, "slave")[1]]
    assert areas_by_face(contact) == pytest.approx(exact, abs=1e-8)


@pytest.mark.parametrize("seed", [None, 1])
def test_of_tilted_layers_the_nearest_where_they_overlap_counts(kind, seed):
    """A wide inclined plate is far away on average, but in front of a strip at its near end."""
    wide = lower(grid(kind, 1), -0.001, 0.005, slope=(-1, 0))
    strip = lower(grid(kind, 1, ((0, 0), (0.1, 1))), -0.3, name="strip")
    contact = paired([upper(grid(kind, 2)), wide, strip], seed)
    seen = faces_of(contact.mesh, "master")[0][: len(wide.faces)]
    assert set(contact.Segments().master) <= set(seen)
    assert contact.Segments().area.sum() == pytest.approx(1, rel=1e-12)
    assert mean_gap(contact) == pytest.approx(0.501, rel=1e-12)


@pytest.mark.parametrize("seed", [None, 4])
def test_faces_that_look_away_never_pair(kind, seed):
    """Slave and master are the whole boundaries of both blocks: only the facing sides pair."""
    slave = upper(grid(kind, 2), 0.05, rest="slave")
    master = lower(grid(kind, 3, ((-0.2, -0.1), (0.7, 1.1))), rest="master")
    contact = paired([slave, master], seed)
    assert contact.Segments().area.sum() == pytest.approx(0.7, rel=1e-12)
    assert contact.Segments().gap == pytest.approx(0.05, rel=1e-11)


def test_only_faces_that_look_away_is_an_error(kind):
    with pytest.raises(Exception, match="never meet"):
        paired([upper(grid(kind)), lower(grid(kind), -0.1, -0.05)])


def test_side_walls_pair_across_a_slit(kind):
    """Whole boundaries beside each other: only the walls of the slit see each other."""
    left = upper(grid(kind, 3, ((-1, 0), (0, 1))), depth=1, rest="slave")
    right = lower(grid(kind, 4, ((0.02, -0.5), (1, 1.5))), 0.7, 1, rest="master")
    segments = paired([left, right]).Segments()
    assert segments.slave_points[..., 0] == pytest.approx(0, abs=1e-14)
    assert segments.area.sum() == pytest.approx(0.7, rel=1e-12)
    assert segments.gap == pytest.approx(0.02, rel=1e-11)


def test_a_thin_body_does_not_pair_through_itself(kind):
    """The upper side of a thin plate must not see the plate below as a deep penetration."""
    slave = upper(grid(kind, 2), depth=0.02, rest="slave")
    contact = paired([slave, lower(grid(kind), depth=0.02, rest="master")], penetration=0.01)
    assert contact.Check().paired_area == pytest.approx(1, rel=1e-12)
    assert contact.Segments().gap == pytest.approx(0, abs=1e-14)


@pytest.mark.parametrize("angle", [0.0, 60.0, 75.0, 78.0])
def test_steep_masters_pair_up_to_a_limit(kind, angle):
    """Planes at up to 80 degrees: the master's projection on the slave counts."""
    t, across = np.radians(angle), 1 if kind == "edge" else 0.7
    points, faces = grid(kind, 3, ((0, 0.2), (2, 0.9)))
    tilted = in_plane(points * ([np.cos(t), 1][: points.shape[1]]), -0.1)
    tilted[:, -1] -= points[:, 0] * np.sin(t)
    depth = -0.3 * np.array([np.sin(t), 0, np.cos(t)])[:: 1 if kind == "mixed" else 2]
    contact = paired([upper(grid(kind, 2)), Sheet("lower", tilted, faces, depth, "master")])
    width = min(2 * np.cos(t), 1)
    assert contact.Segments().area.sum() == pytest.approx(across * width, rel=1e-12)
    assert mean_gap(contact) == pytest.approx(0.1 + np.tan(t) * width / 2, rel=1e-12)


def box(kind, n):
    """The surface of the unit square or cube: points and faces."""
    numbers, faces = {}, []
    points, cells = grid(kind, n)
    for axis in range(points.shape[1] + 1):
        for end in (0.0, 1.0):
            side = np.insert(points, axis, end, axis=1)
            index = [numbers.setdefault(tuple(p.round(9).tolist()), len(numbers)) for p in side]
            turn = 1 if (end == 1) == (axis != 1) else -1
            faces += [tuple(index[i] for i in cell[::turn]) for cell in cells]
    return np.array(list(numbers)), faces


@pytest.mark.parametrize("gap", [0.02, -0.02])
@pytest.mark.parametrize("seed", [None, 5])
def test_a_cube_in_a_cavity(kind, gap, seed):
    """All sides at once: each side sees its own wall and none of the others."""
    (points, faces), (outer, walls) = box(kind, 3), box("edge" if kind == "edge" else "quad", 2)
    size, d = 1 + 2 * gap, points.shape[1]
    outer = 0.5 + size * (outer - 0.5)
    bodies = [
        Sheet("cube", points, faces, 0.3 * (0.5 - points), "slave"),
        Sheet("cavity", outer, walls, 0.3 * (outer - 0.5), "master"),
    ]
    segments = paired(bodies, seed, 10.0).Segments()
    area = 2 * d * min(1, size) ** (d - 1)
    assert segments.area.sum() / 10 ** (d - 1) == pytest.approx(area, rel=1e-12)
    assert segments.gap / 10 == pytest.approx(gap, rel=1e-10)


@pytest.mark.parametrize("seed", range(4))
def test_of_crossing_layers_the_one_is_seen_that_is_nearer_in_the_middle(seed):
    """The layers are divided in the same way, so that the pieces are those of both."""
    rng = np.random.default_rng(seed)
    gaps, tilts = rng.uniform(0.3, 0.4, 2), 0.3 * rng.uniform(-1, 1, (2, 2))
    surface = grid("trig", 3, ((-0.5, -0.7), (1.5, 1.4)))
    sheets = [
        lower(surface, -gap - tilt.sum() / 2, 1e-3, f"layer{k}", tilt)
        for k, (gap, tilt) in enumerate(zip(gaps, tilts, strict=True))
    ]
    contact = paired([upper(grid("trig", 2)), *sheets], penetration=2.0, maxdist=5.0)
    segments = contact.Segments()
    pieces = [
        flat(points[:, :2]) for points in np.split(segments.slave_points, segments.first[1:-1])
    ]
    middles = np.array([(piece.centroid.x, piece.centroid.y) for piece in pieces]) - 0.5
    assert sum(piece.area for piece in pieces) == pytest.approx(1)
    assert len(pieces) > 8  # faces of the slave, which are cut
    assert segments.gap == pytest.approx(np.min(gaps - middles @ tilts.T, axis=1))
