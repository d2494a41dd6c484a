"""Rigid obstacles that move: what they do to a body depends on the relative velocity alone."""

from functools import cache

import numpy as np
import pytest
from motions import bar, on_ground, two_bars, values
from ngsolve import CF, GridFunction, Parameter, sin
from press import press

from ngslac import TimeStepper

SPEED, GAP = 1.0, 0.12  # no multiple of the step: there a rounding error tells what touches
LOSSES = ("impact", "friction", "algorithmic", "internal")


@cache
def hit(*, end, rho_inf=1.0):
    """Motions of a body at rest, hit by a wall; and of one thrown at a wall that stands."""
    same = {"n": 10, "dt": 0.05, "rho_inf": rho_inf}
    wall = bar(gap=lambda t: GAP - SPEED * t, **same)
    wall.throw(0, 0)
    body = bar(gap=GAP, **same)
    for motion in (wall, body):
        motion.run(end)
    return wall, body


def in_frame(motion, field, speed):
    """Values of a displacement or velocity, seen by one who moves up with `speed`."""
    moved = GridFunction(motion.gf.space.components[0])
    moved.Set(CF((0, speed)))
    return values(field.components[0]) - values(moved)


def same_losses(moved, still):
    assert [getattr(moved, name) for name in LOSSES] == pytest.approx(
        [getattr(still, name) for name in LOSSES], rel=0, abs=1e-10
    )


OTHERS = [pytest.param(*case, marks=pytest.mark.full) for case in ((1.0, 1.0), (2.6, 0.8))]


# In the middle of the impact, and after it.
@pytest.mark.sample(1)
@pytest.mark.parametrize(("end", "rho_inf"), [(1.0, 0.8), (2.6, 1.0), *OTHERS])
def test_a_wall_that_moves_does_what_a_body_that_moves_gets(end, rho_inf):
    wall, body = hit(end=end, rho_inf=rho_inf)
    forces = [[row[1] for row in motion.record] for motion in (wall, body)]
    assert forces[0] == pytest.approx(forces[1], rel=0, abs=1e-10)
    displacement = in_frame(wall, wall.gf, SPEED * end)
    assert displacement == pytest.approx(values(body.gf.components[0]), rel=0, abs=1e-10)
    velocity = in_frame(wall, wall.stepper.velocity, SPEED)
    expected = values(body.stepper.velocity.components[0])
    assert velocity == pytest.approx(expected, rel=0, abs=1e-9)


def test_the_wall_does_the_work_and_the_body_leaves_it_with_twice_its_velocity():
    wall, body = hit(end=2.6)
    assert wall.mean(wall.stepper.velocity)[1] == pytest.approx(2 * SPEED, rel=0.05)
    moved, still = wall.stepper.balance, body.stepper.balance
    same_losses(moved, still)
    losses = [step.balance.impact for step in wall.stepper.steps]
    assert np.all(np.diff(losses) >= -1e-13)
    assert still.external == pytest.approx(0, abs=1e-12)
    gained = moved.kinetic + moved.internal + moved.impact + moved.friction + moved.algorithmic
    assert moved.external == pytest.approx(gained, rel=1e-10)


def test_a_body_on_a_shaken_ground_moves_with_it():
    """Heavy enough to stay: its lower side has the ground's velocity, of second order."""
    errors = []
    given = {"gravity": 1.0, "modulus": 1e4, "rho_inf": 0.5}
    for dt in (0.04, 0.02):
        motion = on_ground(
            gap=lambda t: -0.01 * sin(2 * t), dt=dt, flags={"dirichletx": "left|right"}, **given
        )
        motion.run(0.8)
        assert np.all(motion.contact.Table()["status"] > 0)
        at = motion.mesh(0.5, 0.0)
        errors.append(abs(motion.stepper.velocity.components[0](at)[1] - 0.02 * np.cos(1.6)))
    assert errors[1] < 2e-5
    assert errors[1] < 0.35 * errors[0]


def test_friction_on_a_wall_that_moves_is_that_of_the_one_that_stands():
    results = []
    for speed in (0.0, 0.5):
        motion = on_ground(gap=lambda t, v=speed: -v * t, friction=0.3, gravity=1.0, dt=0.05)
        motion.throw(0.4, speed)
        motion.run(1.0)
        results.append((motion.mean(motion.stepper.velocity), motion.stepper.balance.friction))
    (still, lost), (moved, lostthere) = results
    assert moved - still == pytest.approx([0, 0.5], abs=1e-9)
    assert lostthere == pytest.approx(lost, rel=1e-9)


def carried(speed):
    """A block thrown at another one whose lower side moves with `speed`, as all of it does."""
    problem, time = press(h=0.5, spring=0, friction=0.3), Parameter(0.0)
    way = {"bottom": CF((0, speed * time))}
    stepper = TimeStepper(problem.solver(), 100.0, dt=0.05, time=time, prescribe=way)
    parts = {"upper": CF((0.2, speed - 1)), "lower": CF((0, speed))}
    stepper.velocity.components[0].Set(problem.mesh.MaterialCF(parts))
    stepper.Integrate(0.6, printing=False)
    return stepper.balance


def test_losses_do_not_depend_on_the_frame_where_a_support_moves():
    still, moved = carried(0.0), carried(0.7)
    assert still.impact > 1e-4
    same_losses(moved, still)


def test_an_offset_moves_as_an_obstacle_does():
    wall, _ = hit(end=1.0)
    other = bar(gap=GAP, offset=lambda t: -SPEED * t, n=10, dt=0.05)
    other.throw(0, 0)
    other.run(1.0)
    assert np.array(other.record) == pytest.approx(np.array(wall.record), rel=0, abs=1e-10)


def test_an_offset_that_parts_two_bodies_does_the_work():
    """They are at rest until it is used up; then it pushes them apart."""
    motion = two_bars(gap=0.0, offset=lambda t: GAP - SPEED * t)
    motion.throw(0, 0)
    motion.run(0.6)
    balance = motion.stepper.balance
    gained = balance.kinetic + balance.internal + balance.impact + balance.algorithmic
    assert balance.kinetic > 0.01
    assert balance.external == pytest.approx(gained, rel=1e-10)
    assert np.all(np.diff([step.balance.impact for step in motion.stepper.steps]) >= -1e-13)
