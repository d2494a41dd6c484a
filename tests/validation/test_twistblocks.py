"""Twisting blocks: torques, balances, objectivity of large rotations with slip."""

import math

import numpy as np
import pytest
from case_twistblocks import HALF, MIDDLES, TURN, Measured, SymmetryError
from twistblocks import MEAN_DISTANCE


@pytest.fixture(scope="module")
def figures():
    """A quarter turn on a rigid plane: stick, then slip, then steady slip."""
    return Measured(4, 2, angle=4 * TURN, rigid=True).figures


def test_every_step_converges_in_one_piece(figures):
    assert len(figures["angle"]) == 4
    assert figures["cuts"] == 0
    assert max(figures["iterations"]) <= 9
    assert figures["quadratic_steps"] == 6


def test_slip_becomes_steady(figures):
    """Turning as a whole on a plane the block keeps its deformed shape: large rotations, slip."""
    torque, force = figures["torque"], figures["force"]
    change = np.abs(np.diff(torque)) / torque[-1]
    assert np.all(change[1:] < 0.15 * change[:-1])
    assert change[-1] < 1e-4
    assert force[-1] == pytest.approx(force[-2], rel=1e-4)
    assert figures["sideways"] < 1e-9 * force[-1]
    assert [row[2] for row in figures["status"]][1:] == [4, 4, 4]


def test_torque_is_close_to_that_of_a_flat_punch_and_its_work_is_dissipated(figures):
    """With a uniform pressure it is 0.3826 mu F a; the mesh of four faces has 0.924 of it
    by its middles alone, and the friction tilts the faces."""
    assert pytest.approx(0.924, abs=1e-3) == MIDDLES
    assert figures["punch_ratio"][-1] == pytest.approx(MIDDLES, rel=0.08)
    assert figures["dissipation_ratio"] == pytest.approx(math.tan(HALF) / HALF, rel=2e-3)
    # The rest of the torque is the pressure, whose direction is not quite that of the plane.
    assert figures["tangential_share"][-1] == pytest.approx(1.0, abs=0.01)
    assert sum(figures["dissipated"]) > 0


def test_balance_on_both_sides_of_the_gap(figures):
    """It vanishes on the average only. Two deformable blocks have nearly the torque of one."""
    elastic = Measured(2, 2, angle=45.0).figures
    assert figures["balance"]["torque_both"] < 1e-3
    assert elastic["balance"]["torque_both"] < 2e-3
    assert elastic["balance"]["force_both"] < 1e-9
    assert elastic["symmetry_error"] < 1e-8
    assert 0.8 < elastic["punch_ratio"][-1] < 1.0


def test_mean_distance_of_a_square():
    at = (np.arange(400) + 0.5) / 400 - 0.5
    distance = np.hypot(*np.meshgrid(at, at)).mean()
    assert pytest.approx(distance, rel=1e-5) == MEAN_DISTANCE


def test_symmetry_of_a_made_up_table():
    x = np.array([[0.25, 0.25, 0], [-0.25, 0.25, 0], [0.25, -0.25, 0], [-0.25, -0.25, 0]])
    assert SymmetryError({"pressure": np.full(4, 2.0)}, x, 2) == 0
    assert SymmetryError({"pressure": np.array([2.0, 1.0, 2.0, 2.0])}, x, 2) == 0.5
