"""Pairing of flat surfaces: the overlap of two divisions of a line is known by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strips import (
    Strip,
    areas_by_face,
    contact_on,
    moved,
    on_line,
    overlap,
    slave_elements,
    strip_mesh,
)

fast = settings(derandomize=True, deadline=None, max_examples=150, database=None)


@st.composite
def divisions(draw):
    """Nodes of a divided interval; lengths of neighbours differ by up to a factor of fifty."""
    lengths = draw(st.lists(st.floats(0.02, 1.0), min_size=1, max_size=6))
    start = draw(st.floats(-1.0, 1.0))
    return start + np.concatenate([[0.0], np.cumsum(lengths)])


@st.composite
def configurations(draw):
    """Two divided lines that overlap, their opening, and a motion of both."""
    slave, master = draw(divisions()), draw(divisions())
    lap = min(slave[-1], master[-1]) - max(slave[0], master[0])
    if lap < 1e-3:  # bring them together: that they never meet is an error of its own
        master = master + slave[0] - master[0] + draw(st.floats(-0.01, 0.01))
    return {
        "slave": slave,
        "master": master,
        "opening": draw(st.sampled_from([0.0, 1e-6, 0.1, 1.0]) | st.floats(-0.001, 1.0)),
        "angle": draw(st.floats(0, 2 * np.pi)),
        "scale": 10.0 ** draw(st.integers(-6, 6)),
        "flipped": draw(st.tuples(st.booleans(), st.booleans())),
    }


def two_strips(conf, **flags):
    upper = Strip("upper", on_line(conf["slave"], conf["opening"]), (0, 0.5), "slave",
                  flipped=conf["flipped"][0])  # fmt: skip
    lower = Strip("lower", on_line(conf["master"]), (0, -0.5), "master",
                  flipped=conf["flipped"][1])  # fmt: skip
    return strip_mesh(upper, lower, angle=conf["angle"], scale=conf["scale"], **flags)


@fast
@given(configurations())
def test_paired_area_is_the_overlap_and_the_gap_the_opening(conf):
    contact = contact_on(two_strips(conf))
    scale = conf["scale"]
    exact = overlap(conf["slave"], conf["master"])
    assert areas_by_face(contact) / scale == pytest.approx(exact.sum(axis=1), rel=1e-12, abs=1e-12)
    segments = contact.Segments()
    assert segments.gap / scale == pytest.approx(conf["opening"], rel=1e-12, abs=1e-12)
    # Segment by segment: each lies between one slave and one master face.
    first_slave, first_master = slave_elements(contact)[0], segments.master.min()
    first_master -= np.flatnonzero(exact.sum(axis=0) > 1e-13)[0]
    found = np.zeros_like(exact)
    found[segments.slave - first_slave, segments.master - first_master] += segments.area / scale
    assert found == pytest.approx(exact, rel=1e-12, abs=1e-12)
    assert np.sum(exact > 1e-12) <= len(segments) <= np.sum(exact > 0)


@fast
@given(configurations())
def test_segments_tile_each_slave_face(conf):
    contact = contact_on(two_strips(conf))
    segments = contact.Segments()
    back = moved(segments.slave_points.reshape(-1, 2), -conf["angle"], 1 / conf["scale"])
    ends = np.sort(back[:, 0].reshape(-1, 2), axis=1)
    assert back[:, 1] == pytest.approx(conf["opening"], abs=1e-12)
    assert ends[:, 1] - ends[:, 0] == pytest.approx(segments.area / conf["scale"], abs=1e-12)
    ends = ends[np.argsort(ends[:, 0])]
    assert ends[1:, 0] == pytest.approx(ends[:-1, 1], abs=1e-12)  # neither holes nor overlaps
    slave, master = conf["slave"], conf["master"]
    assert ends[0, 0] == pytest.approx(max(slave[0], master[0]), abs=1e-12)
    assert ends[-1, 1] == pytest.approx(min(slave[-1], master[-1]), abs=1e-12)
    across = segments.master_points - segments.slave_points
    normal = moved([[0.0, -1.0]], conf["angle"], conf["scale"])[0]
    assert across.reshape(-1, 2) / conf["scale"] == pytest.approx(
        np.tile(conf["opening"] * normal / conf["scale"], (2 * len(segments), 1)), abs=1e-12
    )


@fast
@given(configurations())
def test_report_and_table_agree_with_the_overlap(conf):
    contact = contact_on(two_strips(conf))
    table, report = contact.Table(), contact.Check()
    size = np.diff(conf["slave"])
    exact = overlap(conf["slave"], conf["master"]).sum(axis=1)
    exact[exact <= 1e-5 * size] = 0  # slivers count as unpaired
    assert table["fullarea"] / conf["scale"] == pytest.approx(size, rel=1e-12)
    assert table["area"] / conf["scale"] == pytest.approx(exact, abs=1e-12)
    assert report.paired_area / conf["scale"] == pytest.approx(exact.sum(), rel=1e-12)
    assert report.unpaired.tolist() == np.flatnonzero(exact == 0).tolist()
    partial = (exact > 0) & (exact < (1 - 1e-6) * size)
    assert report.partial.tolist() == np.flatnonzero(partial).tolist()
    expected = moved([[0.0, -1.0]], conf["angle"])
    assert table["normal"] == pytest.approx(np.tile(expected, (len(size), 1)), abs=1e-12)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (1e3, -1e3)])
@pytest.mark.parametrize("angle", [0.0, 0.6457718232379019, np.pi / 2, 4.0])
def test_a_motion_changes_nothing(angle, shift):
    conf = {"slave": np.linspace(0, 1, 8), "master": np.linspace(-0.2, 0.83, 12), "opening": 0.01}
    conf |= {"angle": 0.0, "scale": 1.0, "flipped": (False, [True, False] * 5 + [True])}
    reference = contact_on(two_strips(conf)).Segments()
    there = contact_on(two_strips(conf | {"angle": angle}, shift=shift)).Segments()
    tol = 1e-13 * (1 + 1e3 * np.linalg.norm(shift))
    assert there.slave.tolist() == reference.slave.tolist()
    assert there.master.tolist() == reference.master.tolist()
    assert there.area == pytest.approx(reference.area, abs=tol)
    assert there.gap == pytest.approx(reference.gap, abs=tol)
    points = moved(reference.slave_points.reshape(-1, 2), angle, 1.0, shift)
    assert there.slave_points.reshape(-1, 2) == pytest.approx(points, abs=tol)


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1e3, 1e9])
def test_the_unit_of_length_changes_nothing(scale):
    conf = {"slave": np.linspace(0, 1, 8), "master": np.linspace(-0.2, 0.83, 12), "opening": 0.01}
    conf |= {"angle": 0.3, "scale": 1.0, "flipped": (False, False)}
    reference = contact_on(two_strips(conf)).Segments()
    there = contact_on(two_strips(conf | {"scale": scale})).Segments()
    assert there.master.tolist() == reference.master.tolist()
    assert there.area / scale == pytest.approx(reference.area, rel=1e-11)
    assert there.gap / scale == pytest.approx(reference.gap, rel=1e-11)


def test_matching_nodes_give_no_slivers():
    nodes = np.linspace(0, 1, 11)
    conf = {"slave": nodes, "master": nodes, "opening": 0.0, "angle": 0.7, "scale": 3.0}
    contact = contact_on(two_strips(conf | {"flipped": (True, False)}))
    assert len(contact.Segments()) == 10
    assert contact.Check().paired_area == pytest.approx(3.0, rel=1e-14)
