"""The tutorial on laws of your own: friction by speed, stick-slip, a grained floor, wear."""

import numpy as np
import pytest
from notebooks import Tutorial

LAWS, VALUES = (
    "13_laws_of_your_own",
    """
VALUES = dict(
    stop=stop, stopped=stopped, way=way, slid=slid_way, error=error, rest=abs(speeds[-1]),
    cycles={name: np.array(Cycle(rows)) for name, rows in runs.items()},
    swing=swing, highest=highest, lowest=lowest, lasts=lasts, period=period,
    friction=found, rule=np.array(rules), threshold=threshold, held=np.hypot(*states[0.99]),
    moved=moved, angle=angle, turned=Turned(1.01), limit=Turned(1 + 1e-9),
    pressures=pressures, euler=euler, first=first, depth=depth, stiffness=young / height,
    squeeze=squeeze,
)
""",
)
laws = Tutorial(LAWS, VALUES, pictures=4)


def test_friction_that_falls_with_speed(laws):
    assert laws.stop == pytest.approx(0.730775, abs=5e-7)
    assert laws.way == pytest.approx(0.79633, abs=5e-6)
    assert laws.stopped == pytest.approx(laws.stop, abs=0.01)
    assert laws.slid == pytest.approx(laws.way, abs=0.002)
    assert laws.error < 0.006
    assert laws.rest < 2e-3


@pytest.mark.parametrize(
    ("name", "force", "took"), [("switch", 0.012, 0.016), ("steep, 5 mm/s", 0.03, 0.03)]
)
def test_stick_and_slip(laws, name, force, took):
    """As the belt gets slow: forces from 2 to 4 N, and a slip of .02 m in .314 s."""
    assert laws.swing == pytest.approx(0.01)
    assert laws.highest == pytest.approx(4, abs=0.006)
    assert laws.lowest == pytest.approx(2, abs=0.006)
    assert laws.lasts == pytest.approx(np.pi / 10, abs=0.021)
    high, low, lasts, period = laws.cycles[name]
    assert high == pytest.approx(laws.highest, abs=force)
    assert low == pytest.approx(laws.lowest, abs=force)
    assert lasts == pytest.approx(laws.lasts, abs=took)
    assert period == pytest.approx(laws.period, abs=0.05)


def test_a_steeper_law_is_nearer_to_the_jump(laws):
    steep, flat = laws.cycles["steep, 5 mm/s"], laws.cycles["steep, 20 mm/s"]
    assert steep[0] - laws.highest < 0.5 * (flat[0] - laws.highest)
    assert steep[2] - laws.lasts < 0.5 * (flat[2] - laws.lasts)


def test_a_grained_floor(laws):
    """The associated rule, with its direction and its threshold."""
    assert laws.friction == pytest.approx(laws.rule, abs=1e-6)
    assert laws.friction[0] == pytest.approx(laws.threshold * np.sqrt([0.5, 0.5]), abs=1e-6)
    assert laws.threshold == pytest.approx(0.134164, abs=5e-7)
    assert laws.held < 1e-3 * np.hypot(*laws.moved)
    assert laws.limit == pytest.approx(6.34019, abs=1e-4)
    assert laws.angle == pytest.approx(laws.turned, abs=0.03)
    assert laws.angle == pytest.approx(6.34, abs=0.1)


def test_wear(laws):
    assert laws.pressures == pytest.approx(laws.euler, rel=1e-9)
    assert laws.pressures[-1] / laws.first == pytest.approx(np.exp(-1), rel=0.06)
    unloaded = laws.squeeze - laws.pressures[-1] / laws.stiffness
    assert laws.depth == pytest.approx(unloaded, rel=1e-9)
