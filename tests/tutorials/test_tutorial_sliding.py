"""Tutorial 06, large sliding, runs, and what it computes is right."""

import numpy as np
import pytest
from notebooks import Tutorial
from published import DECK, PUBLISHED, TIMES

sliding = Tutorial("06_large_sliding", """
VALUES = dict(
    rows=np.array(patient), resultant=resultant, reaction=reaction, piola=piola,
    stretches=stretches[here], times=times, code_aster=published["code_aster 2020"],
    published={name: np.concatenate(curves) for name, curves in published.items()},
    smallest=smallest, hasty=np.array(rows), crushed=SmallestJ(displacement),
    curve=np.array(curve[1:]), thin=thin, inside=inside.Table()["status"],
)
""", pictures=3)  # fmt: skip


def test_steps_of_the_stroke(sliding):
    time, _, _, solves, cuts, opened, sticking, slipping = sliding.rows.T
    expected = np.append(np.linspace(0.1, 1, 10), np.linspace(1.025, 2, 40))
    np.testing.assert_allclose(time, expected, atol=1e-12)
    assert cuts.max() == 0
    assert solves.max() <= 12
    assert np.all(opened[time < 0.21] == 9)  # the clearance
    assert np.all(sticking[(time > 0.3) & (time < 1.02)] > 0)
    slides = (time > 1.06) & (time < 1.6)
    assert np.all(sticking[slides] == 0)
    assert np.all(slipping[slides] >= 4)


def test_published_forces_are_those_of_the_package(sliding):
    at = [TIMES.index(time) for time in sliding.times]
    assert list(sliding.published) == list(PUBLISHED)
    for name, curves in PUBLISHED.items():
        np.testing.assert_array_equal(sliding.published[name], np.array(curves)[:, at].ravel())


def test_forces_are_those_of_code_aster(sliding):
    time, vertical, horizontal = sliding.rows[:, :3].T
    times, (down, right) = sliding.times, sliding.code_aster
    down, right = (
        np.interp(times, time, vertical) / down,
        np.interp(times, time, horizontal) / right,
    )
    np.testing.assert_allclose(down[times < 0.9], 1, atol=0.035)
    np.testing.assert_allclose(down[times > 0.9], 1, atol=0.012)
    np.testing.assert_allclose(right[times <= 1], 1, atol=0.03)
    assert np.all((right[times > 1] > 0.89) & (right[times > 1] < 0.98))
    for at, forces in DECK.items():
        computed = [np.interp(at, time, force) for force in (vertical, horizontal)]
        np.testing.assert_allclose(computed, forces, rtol=0.01)
    stroke = (time > 1.2) & (time < 1.8)  # the die ploughs
    ratio = horizontal[stroke] / vertical[stroke]
    assert 0.3 < ratio.min() < ratio.max() < 0.32


def test_resultants(sliding):
    np.testing.assert_allclose(sliding.reaction, -sliding.resultant, rtol=1e-8)
    np.testing.assert_allclose(sliding.piola, sliding.resultant[:2], rtol=0.01)
    assert 0.95 < sliding.stretches.min() < sliding.stretches.max() < 1.01


def test_short_and_long_steps(sliding):
    patient, hasty = sliding.rows, sliding.hasty
    assert hasty[-1, 0] == pytest.approx(1.2)
    assert hasty[:, 4].sum() >= 1  # cut
    assert min(*sliding.smallest, sliding.crushed) > 0.4
    there = patient[np.argmin(abs(patient[:, 0] - 1.2)), 1:3]
    np.testing.assert_allclose(hasty[-1, 1:3], there, rtol=1e-3)  # the same equilibrium


def test_ring(sliding):
    travel, plates, inside = sliding.curve.T
    assert len(travel) == 19
    assert np.all(np.diff(plates) > 0)
    assert plates[0] == pytest.approx(sliding.thin * travel[0], rel=0.2)
    np.testing.assert_array_equal(inside[:-1], 0)
    assert 0.75 < inside[-1] / plates[-1] < 0.9
    assert plates[-1] == pytest.approx(0.168, rel=0.03)  # finer: 0.177, 0.176, 0.183
    closed = sliding.inside > 0
    assert 0.3 * len(closed) < closed.sum() < 0.6 * len(closed)  # one of two that touch
