"""Coulomb friction in 3D: no direction is special, and the coefficient may vary or change."""

import numpy as np
import pytest
from case_directions import (
    ANGLES,
    FRICTION,
    OPEN,
    PRESSURE,
    SLIP,
    STICK,
    Direction,
    ShearedBlocks,
)
from elasticity import Material
from ngsolve import CF, IfPos, Integrate, Parameter, x, y


def AssertCoulomb(blocks, tol=1e-10):
    """Every macro-element obeys the law; no tangential component of the normal is left."""
    table, size = blocks.table, np.linalg.norm(blocks.tangential, axis=1)
    slip, bound = table["slip"][:, :2], table["friction"] * table["pressure"]
    sticks, slips = (table["status"] == k for k in (STICK, SLIP))
    assert np.all(size <= bound + tol * bound.max())
    assert np.abs(size - bound)[slips].max(initial=0.0) <= tol * bound.max()
    displacement = PRESSURE / Material().young  # of a block of height one
    assert np.abs(slip[sticks]).max(initial=0.0) <= tol * displacement
    work = (blocks.tangential * slip).sum(axis=1)[slips]
    opposite = -size[slips] * np.linalg.norm(slip[slips], axis=1)
    assert np.abs(work - opposite).max(initial=0.0) <= tol * np.abs(opposite).max(initial=1.0)


@pytest.fixture(scope="module")
def blocks():
    return ShearedBlocks(friction=FRICTION)


@pytest.mark.parametrize("angle", ANGLES)
def test_no_direction_is_special(blocks, angle):
    """At the cone all slips against the shear, below it all sticks, above it more than slips."""
    bound, along, slip = FRICTION * PRESSURE, Direction(angle), 2e-3
    for stress, status, moved in ((bound, SLIP, slip), (0.999 * bound, STICK, 0.0)):
        blocks.Shear(along, stress=stress, slip=moved)
        assert set(blocks.table["status"]) == {status}
        assert np.abs(blocks.tangential - stress * along).max() <= 1e-10 * bound
        assert np.abs(blocks.table["slip"][:, :2] + moved * along).max() <= 1e-10 * slip
        force = np.asarray(blocks.contact.Force())
        assert np.linalg.norm(force[:2]) == pytest.approx(stress / PRESSURE * force[2], rel=1e-10)
        AssertCoulomb(blocks)
    blocks.Shear(along, stress=1.01 * bound)
    assert SLIP in blocks.table["status"]
    assert OPEN not in blocks.table["status"]
    AssertCoulomb(blocks)


def test_friction_as_function_of_the_position():
    """Stick on one side, slip on the other, with the mean coefficient of each macro-element."""
    blocks = ShearedBlocks(friction=IfPos(x - 0.5, 5.0, 0.1 + 0.2 * y))
    blocks.Shear(Direction(0.4), stress=0.4 * PRESSURE)
    status, middle = blocks.table["status"], blocks.table["x"]
    left = middle[:, 0] < 0.4
    assert np.all(status[left] == SLIP)
    assert np.all(status[middle[:, 0] > 0.6] == STICK)
    AssertCoulomb(blocks)
    ratio = (np.linalg.norm(blocks.tangential, axis=1) / blocks.table["pressure"])[left]
    assert ratio == pytest.approx(0.1 + 0.2 * middle[left, 1], rel=1e-10)
    assert np.ptp(ratio) > 0.1
    # A linear function has its mean in the centroid; over all faces the means are the integral.
    linear = 0.1 + 0.2 * y
    other = ShearedBlocks(friction=linear)
    other.Shear((1, 0))
    total = Integrate(CF(linear), other.mesh.Boundaries("slave"))
    assert other.table["friction"] @ other.table["fullarea"] == pytest.approx(total, rel=1e-12)


def test_friction_as_parameter():
    """The same contact slips, sticks where it came to rest, and slips again."""
    friction = Parameter(0.2)
    blocks = ShearedBlocks(friction=friction)
    along = Direction(2.2)
    for value, stress, status in ((0.2, 0.2 * PRESSURE, SLIP), (0.5, 0.4 * PRESSURE, STICK)):
        friction.Set(value)
        blocks.Shear(along, stress=stress, slip=1e-3)
        assert set(blocks.table["status"]) == {status}
        assert blocks.table["friction"] == pytest.approx(value, rel=1e-14)
        assert np.abs(blocks.tangential - stress * along).max() <= 1e-10 * PRESSURE
        blocks.Commit()
    friction.Set(0.1)
    blocks.Shear(Direction(2.2 + np.pi / 2), stress=0.1 * PRESSURE, slip=1e-3)
    assert SLIP in blocks.table["status"]
    AssertCoulomb(blocks)


@pytest.mark.parametrize("kinds", [("tet", "hex"), ("prism", "pyramid"), ("pyramid", "tet")])
@pytest.mark.parametrize("space", ["P1bubble", "P2"])
def test_partial_slip_of_all_elements(kinds, space):
    """The law holds in each macro-element, and Newton's method takes few iterations."""
    blocks = ShearedBlocks(kinds, space, friction=0.1 + 0.4 * x)
    last = blocks.Shear(Direction(1.0), stress=0.35 * PRESSURE)
    assert {STICK, SLIP} <= set(blocks.table["status"])
    AssertCoulomb(blocks)
    assert last.number <= 10
