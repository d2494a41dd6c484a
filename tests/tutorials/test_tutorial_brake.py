"""The tutorial on a brake disc: energy, moving pressure, fading, wear."""

import numpy as np
import pytest
from notebooks import Tutorial

BRAKE, VALUES = (
    "15_brake_disc",
    """
VALUES = dict(
    most=max(new.iterations), steps=len(new.record), balance=stored / new.heat, work=work_error,
    torques=torques / even_torque, opened=[np.count_nonzero(e["status"] == 0) for e in new.record],
    loads=[e["pressure"] @ e["area"] / force for e in new.record], evenly=evenly, hottest=hottest,
    ratio=ratio, cooler=cooler, unevenness=unevenness, worn=worn @ area / by_work,
    edges=[[p[0], p[-1]] for p in cold], middles=[np.mean(p[5:-5]) for p in cold],
)
""",
)
brake = Tutorial(BRAKE, VALUES, pictures=2)


def test_energy(brake):
    assert brake.balance == pytest.approx(1, rel=1e-12)
    assert brake.work < 1e-4  # faces of 2 mm at radii from 75 mm on
    assert np.all(np.abs(brake.loads - 1) < 1e-8)
    assert brake.most <= 8


def test_pressure_moves(brake):
    assert brake.opened[0] == 0
    assert np.all(np.diff(brake.opened[-10:]) >= 0)
    assert 3 <= brake.opened[-1] <= 8
    assert np.all(np.abs(brake.torques - 1) < 0.02)


def test_temperature(brake):
    assert 0.85 * brake.evenly < brake.hottest < 1.3 * brake.evenly


def test_fading(brake):
    assert brake.ratio[0] > 0.95
    assert 0.6 < brake.ratio.min() < 0.75
    assert 0.8 > brake.cooler > 0.65


def test_wear(brake):
    assert brake.worn == pytest.approx(1, rel=1e-10)
    assert np.all(np.diff(brake.unevenness) < 0)
    assert brake.unevenness[-1] < 0.5 * brake.unevenness[0]
    edges = brake.edges / brake.middles[:, None]
    assert np.all(np.diff(edges, axis=0) > 0)
    assert np.all(edges[0] < 1)
    assert np.all(edges[-1] > 1.4)
