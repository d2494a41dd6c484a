"""The tutorial on an O-ring: force of the flange, balance of the fluid, seal, hoop stiffness."""

import numpy as np
import pytest
from notebooks import Tutorial

O_RING, VALUES = (
    "12_o_ring",
    """
VALUES = dict(
    hertz=force_cord / hertz, lindley=force / Lindley(np.array([0.05, 0.1, 0.15, 0.2])),
    stiffer=force_cord / force, ratio=ratio, wider=wider,
    flange={name: ring.rows[4][2] for name, ring in groove.items()},
    side={name: ring.rows[4][3] for name, ring in groove.items()},
    free=force[-1], balance=balance, margins=margins, slopes=slopes, jumps=jumps,
    travel=[travel[8], travel[40]],
)
""",
)
ring = Tutorial(O_RING, VALUES, pictures=2)


def test_cord_follows_hertz_at_small_squeeze(ring):
    assert ring.hertz[0] == pytest.approx(1, abs=0.03)
    assert ring.hertz[1] == pytest.approx(1, abs=0.06)
    assert np.all(np.diff(ring.hertz) > 0)


def test_free_ring_and_lindley(ring):
    assert np.all(np.abs(ring.lindley[1:] - 1) < 0.13)
    assert np.all(np.abs(ring.lindley[2:] - 1) < 0.05)


def test_held_cord_is_stiffer(ring):
    assert np.all(np.diff(ring.stiffer) > 0)
    assert ring.stiffer[-1] == pytest.approx(4 / 3, rel=0.05)


def test_radius_of_a_free_ring(ring):
    assert ring.ratio == pytest.approx(1, abs=2e-3)
    assert ring.wider == pytest.approx(8 / 40, rel=0.01)


def test_large_ring_in_a_groove_is_a_cord(ring):
    cord, large, small = (ring.flange[name] for name in ("cord", "radius 100", "radius 8"))
    assert large == pytest.approx(cord, rel=5e-3)
    assert 1.1 * ring.free < small < 0.98 * cord
    assert abs(ring.side["cord"]) < 1e-3
    assert 0 < ring.side["radius 100"] < ring.side["radius 8"] / 5


def test_wall_carries_the_fluid(ring):
    assert ring.balance["cord"] == pytest.approx(1, abs=1e-3)
    assert ring.balance["radius 100"] == pytest.approx(1, abs=0.01)
    assert ring.balance["radius 8"] == pytest.approx(1, abs=0.01)


def test_it_seals_itself(ring):
    assert min(ring.margins.values()) > 1.8
    assert all(0.93 < slope < 1.05 for slope in ring.slopes.values())
    assert ring.jumps.max() < 0.05  # LAC's pressure alone jumps by up to 3 there


def test_hoop_stiffness(ring):
    thin = 3.2 * np.array([8, 40]) ** 2 / (6 * 4 * np.pi)
    assert np.all((0.75 * thin < ring.travel) & (ring.travel < thin))
    assert ring.travel[1] / ring.travel[0] == pytest.approx(25, rel=0.08)
