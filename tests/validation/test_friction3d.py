"""Coulomb friction in 3D: no direction is special, and the coefficient may vary or change."""

import numpy as np
import pytest
from ngsolve import CF, IfPos, Integrate, Parameter, x, y
from problems_friction3d import OPEN, PRESSURE, SLIP, STICK, ShearedBlocks

FRICTION = 0.3
ANGLES = np.radians([0, 17, 90, 133.7, 180, 251, 300, 359])


def Direction(angle):
    return np.array([np.cos(angle), np.sin(angle)])


@pytest.fixture(scope="module")
def blocks():
    return ShearedBlocks(friction=FRICTION)


@pytest.mark.parametrize("angle", ANGLES)
def test_sliding_friction_has_the_same_size_in_all_directions(blocks, angle):
    blocks.Shear(Direction(angle), stress=FRICTION * PRESSURE, slip=2e-3)
    assert set(blocks.table["status"]) == {SLIP}
    bound = FRICTION * PRESSURE
    error = blocks.tangential - bound * Direction(angle)
    assert np.abs(error).max() <= 1e-10 * bound
    force = np.asarray(blocks.contact.Force())
    assert np.linalg.norm(force[:2]) == pytest.approx(FRICTION * force[2], rel=1e-10)
    slip = -2e-3 * Direction(angle)
    assert np.abs(blocks.table["slip"][:, :2] - slip).max() <= 1e-10 * 2e-3
    blocks.AssertCoulomb()


@pytest.mark.parametrize("angle", ANGLES)
def test_stick_below_the_cone(blocks, angle):
    stress = 0.999 * FRICTION * PRESSURE
    blocks.Shear(Direction(angle), stress=stress)
    assert set(blocks.table["status"]) == {STICK}
    assert np.abs(blocks.tangential - stress * Direction(angle)).max() <= 1e-10 * stress
    blocks.AssertCoulomb()


@pytest.mark.parametrize("angle", ANGLES[:4])
def test_slip_above_the_cone(blocks, angle):
    blocks.Shear(Direction(angle), stress=1.01 * FRICTION * PRESSURE)
    assert SLIP in blocks.table["status"]
    assert OPEN not in blocks.table["status"]
    blocks.AssertCoulomb()


def test_friction_as_function_of_the_position():
    """Stick on one side, slip on the other, with the mean coefficient of each macro-element."""
    friction = IfPos(x - 0.5, 5.0, 0.1 + 0.2 * y)
    blocks = ShearedBlocks(friction=friction)
    blocks.Shear(Direction(0.4), stress=0.4 * PRESSURE)
    status, middle = blocks.table["status"], blocks.table["x"]
    assert np.all(status[middle[:, 0] < 0.4] == SLIP)
    assert np.all(status[middle[:, 0] > 0.6] == STICK)
    blocks.AssertCoulomb()
    left = middle[:, 0] < 0.4
    size = np.linalg.norm(blocks.tangential, axis=1)
    ratio = (size / blocks.table["pressure"])[left]
    assert ratio == pytest.approx(0.1 + 0.2 * middle[left, 1], rel=1e-10)
    assert np.ptp(ratio) > 0.1
    # A linear function has its mean in the centroid; over all faces the means are the integral.
    slave = blocks.mesh.Boundaries("slave")
    total = blocks.table["friction"] @ blocks.table["fullarea"]
    assert total == pytest.approx(Integrate(friction, slave, order=4), rel=0.05)
    linear = Integrate(CF(0.1 + 0.2 * y), slave)
    other = ShearedBlocks(friction=0.1 + 0.2 * y)
    other.Shear((1, 0))
    assert other.table["friction"] @ other.table["fullarea"] == pytest.approx(linear, rel=1e-12)


def test_friction_as_parameter():
    """The same contact slips, sticks where it came to rest, and slips again."""
    friction = Parameter(0.2)
    blocks = ShearedBlocks(friction=friction)
    along = Direction(2.2)
    blocks.Shear(along, stress=0.2 * PRESSURE, slip=1e-3)
    assert set(blocks.table["status"]) == {SLIP}
    assert np.abs(blocks.tangential - 0.2 * PRESSURE * along).max() <= 1e-10 * PRESSURE
    blocks.Commit()
    friction.Set(0.5)
    blocks.Shear(along, stress=0.4 * PRESSURE, slip=1e-3)
    assert set(blocks.table["status"]) == {STICK}
    assert np.all(blocks.table["friction"] == 0.5)
    assert np.abs(blocks.tangential - 0.4 * PRESSURE * along).max() <= 1e-10 * PRESSURE
    blocks.Commit()
    across = Direction(2.2 + np.pi / 2)
    friction.Set(0.1)
    blocks.Shear(across, stress=0.1 * PRESSURE, slip=1e-3)
    assert SLIP in blocks.table["status"]
    blocks.AssertCoulomb()


@pytest.mark.parametrize("kinds", [("tet", "hex"), ("prism", "pyramid"), ("pyramid", "tet")])
@pytest.mark.parametrize("space", ["P1bubble", "P2"])
def test_partial_slip_of_all_elements(kinds, space):
    """The law holds in each macro-element, and Newton's method takes few iterations."""
    blocks = ShearedBlocks(kinds, space, friction=0.1 + 0.4 * x)
    last = blocks.Shear(Direction(1.0), stress=0.35 * PRESSURE)
    assert {STICK, SLIP} <= set(blocks.table["status"])
    blocks.AssertCoulomb()
    assert last.number <= 10
