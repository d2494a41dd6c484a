"""The tutorial on squeal: modes of a sliding pad, damping, the growth in time."""

import numpy as np
import pytest
from notebooks import Tutorial

SQUEAL, VALUES = (
    "18_squeal",
    """
VALUES = dict(
    springs=[sorted(abs(TwoSprings(mu).real)) for mu in (0.3, 0.8, 1.0)], force=force,
    status=solver.contacts[0].Table()["status"], growth=growth, frequency=frequency,
    growths=modes.growth, frequencies=modes.frequencies, residuals=modes.residuals, k=k,
    begins=begins, plain=plain.real, damped=damped.real, turning=plain.imag, damper=damper,
)
""",
)
squeal = Tutorial(SQUEAL, VALUES, pictures=2)


def test_two_springs(squeal):
    assert squeal.springs[:, 1] == pytest.approx([0, 0.09110, 0.20207], abs=5e-6)


def test_the_pad_slides(squeal):
    assert np.all(squeal.status == 2)
    assert -squeal.force[0] / squeal.force[1] == pytest.approx(0.4, rel=1e-9)


def test_modes_grow(squeal):
    assert squeal.frequencies[squeal.k] == pytest.approx(20.0e3, rel=0.01)
    assert squeal.growths[squeal.k] == pytest.approx(4500, rel=0.02)
    assert np.all(squeal.residuals < 1e-9)


def test_time_integration_grows_alike(squeal):
    assert squeal.growth == pytest.approx(squeal.growths[squeal.k], rel=0.01)
    assert squeal.frequency == pytest.approx(squeal.frequencies[squeal.k], rel=0.003)


def test_damping(squeal):
    assert not np.any(squeal.plain[0])
    expected = -squeal.damper / 2 * squeal.turning[0] ** 2
    assert squeal.damped[0] == pytest.approx(expected, rel=1e-3)
    assert 0 < squeal.begins[0] < squeal.begins[1] < 0.4
