"""Which faces pair where there are several of them: the nearest one that looks back."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ngsolve import TaskManager
from strips import Strip, areas_by_face, contact_on, on_line, strip_mesh

fast = settings(derandomize=True, deadline=None, max_examples=100, database=None)


def upper(nodes, y=0.0, face="slave", rest="rest", **flags):
    return Strip("upper", on_line(nodes, y), (0, 0.5), face, rest, **flags)


def lower(nodes, y=0.0, face="master", rest="rest", depth=0.5, name="lower"):
    return Strip(name, on_line(nodes, y), (0, -depth), face, rest)


def masters_y(contact):
    """Height of the master surface in the middle of each segment."""
    return contact.Segments().master_points[:, :, 1].mean(axis=1)


def test_two_masters_side_by_side_at_different_heights():
    slave = np.linspace(0, 1, 8)
    mesh = strip_mesh(
        upper(slave),
        lower(np.linspace(-0.3, 0.45, 5), -0.1, name="left"),
        lower(np.linspace(0.62, 1.2, 4), -0.2, name="right"),
    )
    contact = contact_on(mesh)
    segments = contact.Segments()
    left = segments.slave_points[:, :, 0].mean(axis=1) < 0.5
    assert segments.area[left].sum() == pytest.approx(0.45, rel=1e-13)
    assert segments.area[~left].sum() == pytest.approx(0.38, rel=1e-13)
    assert segments.gap[left] == pytest.approx(0.1, rel=1e-12)
    assert segments.gap[~left] == pytest.approx(0.2, rel=1e-12)


def test_two_slaves_on_one_master():
    mesh = strip_mesh(
        upper(np.linspace(0, 0.4, 4)),
        Strip("second", on_line(np.linspace(0.55, 1.3, 6), 0.25), (0, 1), "slave"),
        lower(np.linspace(-0.1, 1, 9)),
    )
    areas = areas_by_face(contact_on(mesh))
    assert areas[:3].sum() == pytest.approx(0.4, rel=1e-13)
    assert areas[3:].sum() == pytest.approx(0.45, rel=1e-13)


@fast
@given(
    st.floats(0.01, 0.3),
    st.floats(0.01, 0.3),
    st.lists(st.floats(-0.2, 1.2), min_size=2, max_size=2, unique=True),
)
def test_of_two_stacked_masters_the_nearest_wins(first, second, ends):
    """A plate between both bodies hides the lower master, but only where the plate is."""
    a, b = sorted(ends)
    if b - a < 0.01:
        b = a + 0.01
    slave = np.linspace(0, 1, 6)
    mesh = strip_mesh(
        upper(slave),
        lower(np.linspace(a, b, 4), -first, depth=0.005, name="plate"),
        lower(np.linspace(-0.5, 1.5, 8), -first - second),
    )
    contact = contact_on(mesh)
    segments = contact.Segments()
    on_plate = np.abs(masters_y(contact) + first) < 1e-12
    covered = max(min(b, 1) - max(a, 0), 0)
    assert segments.area[on_plate].sum() == pytest.approx(covered, abs=1e-12)
    assert segments.area.sum() == pytest.approx(1, rel=1e-12)
    assert segments.gap[on_plate] == pytest.approx(first, rel=1e-10)
    assert segments.gap[~on_plate] == pytest.approx(first + second, rel=1e-10)


@pytest.mark.parametrize("depth", [0.02, 0.3])
def test_nearest_counts_penetration_too(depth):
    """A master that is penetrated a little beats one that is far open."""
    mesh = strip_mesh(
        upper(np.linspace(0, 1, 6)),
        lower(np.linspace(-0.1, 1.1, 5), depth, depth=0.01, name="plate"),
        lower(np.linspace(-0.1, 1.1, 8), -0.2),
    )
    contact = contact_on(mesh, penetration=0.5)
    expected = -depth if depth < 0.2 else 0.2
    assert contact.Segments().gap == pytest.approx(expected, rel=1e-12)
    assert contact.Check().paired_area == pytest.approx(1, rel=1e-13)


def test_maxdist_and_penetration_limit_the_search():
    steps = [0.0, 0.1, 0.2, 0.4, 0.8]
    bodies = [
        lower([k + 0.01, k + 0.99], -gap, name=f"b{k}") for k, gap in enumerate([*steps, -0.1])
    ]
    mesh = strip_mesh(upper(np.arange(7)), *bodies)
    for maxdist, penetration in ((0.15, 0.05), (0.3, 0.2), (1.0, 0.05), (0.05, 0.2)):
        contact = contact_on(mesh, maxdist=maxdist, penetration=penetration)
        seen = [gap < maxdist for gap in steps] + [penetration > 0.1]
        assert areas_by_face(contact) == pytest.approx(0.98 * np.array(seen), abs=1e-12)


def test_faces_that_look_away_never_pair():
    """Slave and master are the whole boundaries of both blocks."""
    mesh = strip_mesh(
        upper(np.linspace(0, 1, 6), 0.05, rest="slave"),
        lower(np.linspace(-0.2, 0.7, 8), rest="master"),
    )
    contact = contact_on(mesh)
    points = contact.Segments().slave_points.reshape(-1, 2)
    assert points[:, 1] == pytest.approx(0.05, abs=1e-14)
    assert contact.Check().paired_area == pytest.approx(0.7, rel=1e-12)
    assert contact.Segments().gap == pytest.approx(0.05, rel=1e-12)


def test_neighbouring_side_walls_pair_across_a_slit():
    """Whole boundaries again, now beside each other: only the walls of the slit see each other."""
    left = Strip("left", on_line(np.linspace(-1, 0, 4), 0), (0, 1), "slave", "slave")
    right = Strip("right", on_line(np.linspace(0.02, 1, 5), -0.3), (0, 1), "master", "master")
    contact = contact_on(strip_mesh(left, right))
    segments = contact.Segments()
    assert segments.slave_points[:, :, 0] == pytest.approx(0, abs=1e-14)
    assert segments.area.sum() == pytest.approx(0.7, rel=1e-12)
    assert segments.gap == pytest.approx(0.02, rel=1e-12)


def test_a_thin_body_does_not_pair_through_itself():
    """The upper side of a thin plate must not see the plate below as a deep penetration."""
    upper_plate = Strip("upper", on_line(np.linspace(0, 1, 6)), (0, 0.02), "slave", "slave")
    lower_plate = Strip("lower", on_line(np.linspace(0, 1, 9)), (0, -0.02), "master", "master")
    contact = contact_on(strip_mesh(upper_plate, lower_plate), penetration=0.01)
    assert contact.Check().paired_area == pytest.approx(1, rel=1e-12)
    assert contact.Segments().gap == pytest.approx(0, abs=1e-14)


@pytest.mark.parametrize("seed", range(5))
def test_flipped_segments_change_nothing(seed):
    rng = np.random.default_rng(seed)
    slave, master = np.sort(rng.uniform(0, 1, 9)), np.sort(rng.uniform(0, 1, 12))

    def segments(flips):
        a = Strip("upper", on_line(slave, 0.03), (0, 0.5), "slave", flipped=flips[0])
        b = Strip("lower", on_line(master), (0, -0.5), "master", flipped=flips[1])
        return contact_on(strip_mesh(a, b))

    reference = segments((False, False))
    other = segments((rng.random(8) < 0.5, rng.random(11) < 0.5))
    assert areas_by_face(other) == pytest.approx(areas_by_face(reference), rel=1e-12)
    assert other.Segments().gap == pytest.approx(0.03, rel=1e-12)
    assert other.Table()["normal"] == pytest.approx(reference.Table()["normal"], abs=1e-15)


def test_the_number_of_threads_does_not_matter():
    rng = np.random.default_rng(1)
    slave, master = np.sort(rng.uniform(0, 1, 200)), np.sort(rng.uniform(0, 1, 300))
    mesh = strip_mesh(upper(slave, 0.001), lower(master))
    contact = contact_on(mesh)
    contact.Update()
    alone, table = contact.Segments(), contact.Table()
    D, M = (op.ToDense().NumPy().copy() for op in contact.Mortar())
    with TaskManager():
        contact.Update()
        threaded = contact.Segments()
        operators = contact.Mortar()
    for name in ("slave", "master", "area", "gap", "slave_points", "master_points"):
        assert np.array_equal(getattr(alone, name), getattr(threaded, name)), name
    for name, values in contact.Table().items():
        assert np.array_equal(table[name], values), name
    for before, after in zip((D, M), operators, strict=True):
        assert np.array_equal(before, after.ToDense().NumPy())
