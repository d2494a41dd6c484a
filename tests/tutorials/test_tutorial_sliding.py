"""Tutorial 06, large sliding, runs, and what it computes is right."""

import numpy as np
import pytest
from notebooks import Errors, Execute, Pictures

from ngslac.reference.ironing import DECK, PUBLISHED, TIMES

pytestmark = pytest.mark.slow

VALUES = """
VALUES = dict(
    rows=np.array(patient), resultant=resultant, reaction=reaction, piola=piola,
    stretches=stretches[here], times=times, code_aster=published["code_aster 2020"],
    published={name: np.concatenate(curves) for name, curves in published.items()},
    smallest=smallest, hasty=np.array(rows), crushed=SmallestJ(displacement),
    curve=np.array(curve[1:]), thin=thin, inside=inside.Table(),
)
"""
NAME = "06_large_sliding"


@pytest.fixture(scope="module")
def sliding():
    return Execute(NAME, VALUES)


@pytest.fixture(scope="module")
def forces(sliding):
    """Time, vertical and horizontal force."""
    return sliding[0]["rows"][:, :3].T


def test_no_errors_in_sliding(sliding):
    _, outputs = sliding
    assert not Errors(outputs)
    assert Pictures(outputs) == 3


def test_steps_of_the_stroke(sliding):
    time, _, _, solves, cuts, opened, sticking, slipping = sliding[0]["rows"].T
    expected = np.append(np.linspace(0.1, 1, 10), np.linspace(1.025, 2, 40))
    np.testing.assert_allclose(time, expected, atol=1e-12)
    assert cuts.max() == 0
    assert solves.max() <= 12
    assert np.all(opened[time < 0.21] == 9)  # the clearance
    assert np.all(sticking[(time > 0.3) & (time < 1.02)] > 0)
    sliding_all = (time > 1.06) & (time < 1.6)
    assert np.all(sticking[sliding_all] == 0)
    assert np.all(slipping[sliding_all] >= 4)


def test_published_forces_are_those_of_the_package(sliding):
    values = sliding[0]
    at = [TIMES.index(time) for time in values["times"]]
    assert list(values["published"]) == list(PUBLISHED)
    for name, curves in PUBLISHED.items():
        np.testing.assert_array_equal(values["published"][name], np.array(curves)[:, at].ravel())


def test_forces_against_the_figure_of_code_aster(sliding, forces):
    time, vertical, horizontal = forces
    times, reference = sliding[0]["times"], sliding[0]["code_aster"]
    down = np.interp(times, time, vertical) / reference[0]
    right = np.interp(times, time, horizontal) / reference[1]
    np.testing.assert_allclose(down[times < 0.9], 1, atol=0.035)
    np.testing.assert_allclose(down[times > 0.9], 1, atol=0.012)
    np.testing.assert_allclose(right[times <= 1], 1, atol=0.03)
    assert np.all((right[times > 1] > 0.89) & (right[times > 1] < 0.98))


@pytest.mark.parametrize("time", DECK)
def test_forces_against_the_deck_of_code_aster(forces, time):
    computed = [np.interp(time, forces[0], force) for force in forces[1:]]
    np.testing.assert_allclose(computed, DECK[time], rtol=0.01)


def test_the_die_ploughs(forces):
    time, vertical, horizontal = forces
    stroke = (time > 1.2) & (time < 1.8)
    ratio = horizontal[stroke] / vertical[stroke]
    assert ratio.min() > 0.3
    assert ratio.max() < 0.32


def test_resultants(sliding):
    values = sliding[0]
    np.testing.assert_allclose(values["reaction"], -values["resultant"], rtol=1e-8)
    np.testing.assert_allclose(values["piola"], values["resultant"][:2], rtol=0.01)
    assert 0.95 < values["stretches"].min() < values["stretches"].max() < 1.01


def test_short_and_long_steps(sliding):
    values = sliding[0]
    patient, hasty = values["rows"], values["hasty"]
    assert hasty[-1, 0] == pytest.approx(1.2)
    assert hasty[:, 4].sum() >= 1  # cut
    assert min(values["smallest"]) > 0.4
    assert values["crushed"] > 0.4
    there = patient[np.argmin(abs(patient[:, 0] - 1.2)), 1:3]
    np.testing.assert_allclose(hasty[-1, 1:3], there, rtol=1e-3)  # the same equilibrium


def test_ring(sliding):
    values = sliding[0]
    travel, plates, inside = values["curve"].T
    assert len(travel) == 19
    assert np.all(np.diff(plates) > 0)
    assert plates[0] == pytest.approx(values["thin"] * travel[0], rel=0.2)
    np.testing.assert_array_equal(inside[:-1], 0)
    assert 0.75 < inside[-1] / plates[-1] < 0.9
    assert plates[-1] == pytest.approx(0.168, rel=0.03)  # finer: 0.177, 0.176, 0.183
    table = {name: np.array(value) for name, value in values["inside"].items()}
    closed = table["status"] > 0
    assert 0.3 * len(closed) < closed.sum() < 0.6 * len(closed)  # one of two that touch
    size = table["pressure"].max()
    assert abs(table["gap"][closed]).max() < 1e-8
    assert table["pressure"][~closed].max() < 1e-9 * size
    q = table["traction"] + table["pressure"][:, None] * table["normal"]
    assert np.all(np.linalg.norm(q, axis=1) < 0.2 * table["pressure"] + 1e-9 * size)
