"""Which faces pair in 3D where there are several: the nearest one that looks back."""

import numpy as np
import pytest
import shapely
from surfaces3d import (
    Sheet,
    areas_by_face,
    contact_on,
    faces_of,
    in_plane,
    quad_grid,
    rigid,
    sheet_mesh,
    surface,
)

KINDS = ("trig", "quad", "mixed")
UNIT = ((0.0, 0.0), (1.0, 1.0))


def upper(z=0.0, n=2, box=UNIT, depth=0.5, **flags):
    points, faces = quad_grid(n, n, box, diagonals=[0])
    return Sheet("upper", in_plane(points, z), faces, (0, 0, depth), "slave", **flags)


def lower(z, box=UNIT, n=3, depth=0.005, name="lower", slope=(0.0, 0.0), **flags):
    """A plate whose upper side is z + slope.(x, y)."""
    points, faces = quad_grid(n, n, box, diagonals=[1])
    points3 = in_plane(points, z)
    points3[:, 2] += points @ np.asarray(slope)
    return Sheet(name, points3, faces, (0, 0, -depth), "master", **flags)


def area_at(contact, gap, scale=1.0):
    """Slave area whose segments have a mean gap."""
    segments = contact.Segments()
    return segments.area[np.abs(segments.gap - gap) < 1e-9 * scale].sum()


@pytest.mark.parametrize("seed", range(12))
def test_layers_hide_what_is_behind(seed):
    """Two to four parallel plates of any sizes, one of them penetrated, against shapely."""
    rng = np.random.default_rng(seed)
    scale, motion = 10.0 ** rng.integers(-3, 4), rigid(seed)
    gaps = rng.permutation([0.02, -0.03, 0.1, 0.4])[: rng.integers(2, 5)]
    points, faces = surface(rng, rng.choice(KINDS))
    sheets = [Sheet("upper", in_plane(points), faces, (0, 0, 0.5), "slave", renumbered=rng)]
    plates = []
    for k, gap in enumerate(gaps):
        low = rng.uniform(-0.2, 0.6, 2)
        plates.append((low, low + rng.uniform(0.2, 1, 2)))
        points, faces = surface(rng, rng.choice(KINDS), 2, plates[-1])
        sheets.append(Sheet(f"plate{k}", in_plane(points, -gap), faces, (0, 0, -1e-3), "master",
                            renumbered=rng))  # fmt: skip
    mesh = sheet_mesh(*sheets, motion=lambda p: scale * motion(p))
    contact = contact_on(mesh, penetration=0.2 * scale)

    numbers, corners = faces_of(mesh, "slave")
    back = np.linalg.inv(motion(np.eye(3)))
    flat = [shapely.Polygon((c / scale @ back)[:, :2]) for c in corners]
    exact, hidden = np.zeros((len(flat), len(gaps))), shapely.Polygon()
    for k in np.argsort(np.abs(gaps)):
        plate = shapely.box(*plates[k][0], *plates[k][1])
        exact[:, k] = shapely.area(shapely.intersection(flat, plate.difference(hidden)))
        hidden = hidden.union(plate)
    segments = contact.Segments()
    layer = np.argmin(np.abs(segments.gap[:, None] / scale - gaps), axis=1)
    assert segments.gap / scale == pytest.approx(gaps[layer], abs=1e-10)
    got = np.zeros_like(exact)
    np.add.at(got, (np.searchsorted(numbers, segments.slave), layer), segments.area / scale**2)
    assert got == pytest.approx(exact, abs=1e-13)


@pytest.mark.parametrize("seed", [None, 1])
def test_of_tilted_layers_the_nearest_where_they_overlap_counts(seed):
    """A wide inclined plate is far away on average, but in front of a strip at its near end."""
    mesh = sheet_mesh(
        upper(),
        lower(-0.001, slope=(-1, 0), n=1),
        lower(-0.3, ((0, 0), (0.1, 1)), n=1, name="strip"),
        motion=rigid(seed),
    )
    contact = contact_on(mesh)
    segments = contact.Segments()
    masters, _ = faces_of(mesh, "master")
    assert set(segments.master) == {masters[0]}
    assert segments.area.sum() == pytest.approx(1, rel=1e-12)
    assert segments.area @ segments.gap == pytest.approx(0.501, rel=1e-12)


def test_two_masters_side_by_side_at_different_heights():
    mesh = sheet_mesh(
        upper(n=3),
        lower(-0.1, ((-0.3, -0.1), (0.45, 1.1)), name="left"),
        lower(-0.2, ((0.62, -0.1), (1.2, 0.8)), name="right"),
    )
    contact = contact_on(mesh)
    assert area_at(contact, 0.1) == pytest.approx(0.45, rel=1e-12)
    assert area_at(contact, 0.2) == pytest.approx(0.38 * 0.8, rel=1e-12)
    assert contact.Segments().area.sum() == pytest.approx(0.45 + 0.38 * 0.8, rel=1e-12)


def test_two_slaves_on_one_master():
    second = Sheet("second", in_plane(quad_grid(3, 3, ((0.55, 0.1), (1.3, 0.9)))[0], 0.25),
                   quad_grid(3, 3)[1], (0, 0, 1), "slave")  # fmt: skip
    mesh = sheet_mesh(
        upper(box=((0, 0), (0.4, 1))), second, lower(0, ((-0.1, -0.1), (1, 1.1)), n=5)
    )
    areas = areas_by_face(contact_on(mesh))
    assert areas[:-9].sum() == pytest.approx(0.4, rel=1e-12)
    assert areas[-9:].sum() == pytest.approx(0.45 * 0.8, rel=1e-12)


@pytest.mark.parametrize("depth", [0.02, 0.3])
def test_nearest_counts_penetration_too(depth):
    """A plate that is penetrated a little is nearer than one that is far open."""
    wide = ((-0.1, -0.1), (1.1, 1.1))
    mesh = sheet_mesh(upper(n=3), lower(depth, wide), lower(-0.2, wide, n=4, name="far"))
    contact = contact_on(mesh, penetration=0.5)
    expected = -depth if depth < 0.2 else 0.2
    assert contact.Segments().gap == pytest.approx(expected, rel=1e-12)
    assert contact.Check().paired_area == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize(
    ("maxdist", "penetration"), [(0.15, 0.05), (0.3, 0.5), (1.0, 0.05), (0.05, 0.5)]
)
def test_maxdist_and_penetration_limit_the_search(maxdist, penetration):
    gaps = np.array([0.0, 0.1, 0.2, 0.4, 0.8, -0.3])
    points = in_plane([[i, j] for i in range(7) for j in (0, 1)])
    slave = Sheet("upper", points, [(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1) for i in range(6)],
                  (0, 0, 0.5), "slave")  # fmt: skip
    bodies = [
        lower(-gap, ((k + 0.01, 0), (k + 0.99, 1)), name=f"b{k}") for k, gap in enumerate(gaps)
    ]
    contact = contact_on(sheet_mesh(slave, *bodies), maxdist=maxdist, penetration=penetration)
    seen = (gaps < maxdist) & (gaps > -penetration)
    assert areas_by_face(contact) == pytest.approx(0.98 * seen, abs=1e-12)


@pytest.mark.parametrize("seed", [None, 4])
def test_faces_that_look_away_never_pair(seed):
    """Slave and master are the whole boundaries of both blocks: only the facing sides pair."""
    mesh = sheet_mesh(
        upper(0.05, rest="slave"),
        lower(0.0, ((-0.2, -0.1), (0.7, 1.1)), depth=0.5, rest="master"),
        motion=rigid(seed),
    )
    contact = contact_on(mesh)
    assert contact.Segments().area.sum() == pytest.approx(0.7, rel=1e-12)
    assert contact.Segments().gap == pytest.approx(0.05, rel=1e-11)


def test_only_faces_that_look_away_is_an_error():
    mesh = sheet_mesh(upper(), lower(-0.1, depth=-0.05))
    with pytest.raises(Exception, match="never meet"):
        contact_on(mesh)


def test_side_walls_pair_across_a_slit():
    """Whole boundaries beside each other: only the walls of the slit see each other."""
    left = upper(0.0, box=((-1, 0), (0, 1)), depth=1, rest="slave")
    right = lower(0.7, ((0.02, -0.5), (1, 1.5)), depth=1, rest="master")
    contact = contact_on(sheet_mesh(left, right))
    segments = contact.Segments()
    assert segments.slave_points[:, 0] == pytest.approx(0, abs=1e-14)
    assert segments.area.sum() == pytest.approx(0.7, rel=1e-12)
    assert segments.gap == pytest.approx(0.02, rel=1e-11)


def test_a_thin_body_does_not_pair_through_itself():
    """The upper side of a thin plate must not see the plate below as a deep penetration."""
    mesh = sheet_mesh(upper(depth=0.02, rest="slave"), lower(0.0, depth=0.02, rest="master"))
    contact = contact_on(mesh, penetration=0.01)
    assert contact.Check().paired_area == pytest.approx(1, rel=1e-12)
    assert contact.Segments().gap == pytest.approx(0, abs=1e-14)


@pytest.mark.parametrize("angle", [0.0, 60.0, 75.0, 78.0])
def test_steep_masters_pair_up_to_a_limit(angle):
    """Planes at up to 80 degrees: the master's projection on the slave counts."""
    t = np.radians(angle)
    points, faces = quad_grid(3, 3, ((0, 0.2), (2, 0.9)), diagonals=[0])
    tilted = np.stack(
        [points[:, 0] * np.cos(t), points[:, 1], -0.1 - points[:, 0] * np.sin(t)], axis=1
    )
    depth = -0.3 * np.array([np.sin(t), 0, np.cos(t)])
    contact = contact_on(sheet_mesh(upper(), Sheet("lower", tilted, faces, depth, "master")))
    width = min(2 * np.cos(t), 1)
    segments = contact.Segments()
    assert segments.area.sum() == pytest.approx(0.7 * width, rel=1e-12)
    mean = segments.area @ segments.gap / segments.area.sum()
    assert mean == pytest.approx(0.1 + np.tan(t) * width / 2, rel=1e-12)


@pytest.mark.parametrize("gap", [0.02, -0.02])
@pytest.mark.parametrize("seed", [None, 5])
def test_a_cube_in_a_cavity(gap, seed):
    """All six sides at once: each side sees its own wall and none of the others."""
    points, faces = cube(3, "mixed")
    outer, walls = cube(2, "quad")
    outer = 1 + 2 * gap, 0.5 + (1 + 2 * gap) * (outer - 0.5)
    mesh = sheet_mesh(
        Sheet("cube", points, faces, 0.3 * (0.5 - points), "slave"),
        Sheet("cavity", outer[1], walls, 0.3 * (outer[1] - 0.5), "master"),
        motion=rigid(seed, 10.0),
    )
    contact = contact_on(mesh)
    segments = contact.Segments()
    side = min(1, outer[0])
    assert segments.area.sum() / 100 == pytest.approx(6 * side**2, rel=1e-12)
    assert segments.gap / 10 == pytest.approx(gap, rel=1e-10)


def cube(n, kind):
    """The surface of the unit cube: points and faces, quadrilaterals or partly triangles."""
    numbers, faces = {}, []
    flat, cells = quad_grid(n, n, diagonals=range(0, n * n, 2) if kind == "mixed" else ())
    for axis in range(3):
        for end in (0.0, 1.0):
            side = np.insert(flat, axis, end, axis=1)
            index = [numbers.setdefault(tuple(p.round(9).tolist()), len(numbers)) for p in side]
            turn = 1 if (end == 1) == (axis != 1) else -1
            faces += [tuple(index[i] for i in cell[::turn]) for cell in cells]
    return np.array(list(numbers)), faces


@pytest.mark.parametrize("seed", [0, 13, 27, 31, 35, 68])
def test_crossing_layers_cover_what_their_union_covers(seed):
    """Inclined plates that pass through each other: who is nearest varies, but no area is lost."""
    rng = np.random.default_rng(100 + seed)
    points, faces = surface(rng, rng.choice(KINDS), 2)
    sheets, plates = [Sheet("upper", in_plane(points), faces, (0, 0, 0.5), "slave")], []
    for k in range(5):
        low = rng.uniform(-0.2, 0.6, 2)
        plates.append(shapely.box(*low, *(low + rng.uniform(0.2, 1, 2))))
        points, faces = surface(rng, rng.choice(KINDS), 2, np.reshape(plates[-1].bounds, (2, 2)))
        plate = in_plane(points, -rng.uniform(0, 0.4))
        plate[:, 2] += (points - points.mean(axis=0)) @ rng.uniform(-0.6, 0.6, 2)
        sheets.append(Sheet(f"plate{k}", plate, faces, (0, 0, -1e-3), "master"))
    mesh = sheet_mesh(*sheets)
    contact = contact_on(mesh, penetration=2.0, maxdist=5.0)
    union = shapely.union_all(plates)
    exact = [shapely.Polygon(c[:, :2]).intersection(union).area for c in faces_of(mesh, "slave")[1]]
    assert areas_by_face(contact) == pytest.approx(exact, abs=1e-8)
