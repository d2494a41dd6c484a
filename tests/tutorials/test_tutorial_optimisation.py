"""The tutorial on optimisation: a derivative, an identification, a punch, a press fit."""

import numpy as np
import pytest
from notebooks import Tutorial

OPTIMISATION, VALUES = (
    "17_optimisation",
    """
VALUES = dict(
    error=error, forces=forces, by_mu=by_mu, exact=exact.x, noisy=rough.x, runs=exact.nfev,
    jacobian=calls[-1], flat=flat[0], even=even[0], pressures=even[1]["pressure"],
    deviation=deviation, peaks=[straight_peak, crowned_peak], solves=result.nfev,
    widened=widened, bore=Pressures()[1],
)
""",
)
optimisation = Tutorial(OPTIMISATION, VALUES, pictures=3)


def test_the_derivative_is_that_of_differences(optimisation):
    assert optimisation.error < 1e-6
    assert optimisation.by_mu.shape == optimisation.forces.shape == (10, 2)
    assert np.all(optimisation.by_mu[-5:, 0] < 0)  # more friction, more drag


def test_friction_and_modulus_are_identified(optimisation):
    assert optimisation.exact == pytest.approx([0.3, 2.0], rel=1e-6)
    assert optimisation.noisy == pytest.approx([0.3, 2.0], rel=0.02)
    assert optimisation.runs < 20


def test_the_best_punch_presses_evenly(optimisation):
    assert optimisation.flat > 0.3
    assert optimisation.even < 1e-4
    assert optimisation.pressures == pytest.approx(10, rel=0.05)
    assert optimisation.deviation < 0.02


def test_the_crowned_bore_presses_evenly(optimisation):
    straight, crowned = optimisation.peaks
    assert straight > 1.5
    assert crowned < 1.02
    assert np.all(optimisation.bore > 0)
    assert optimisation.solves < 10
    assert 0 < optimisation.widened < 0.02
