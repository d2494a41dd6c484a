"""Spence's self-similar partial slip under a growing normal load."""

import numpy as np
import pytest
from exact_spence import SpenceLine, StickZone
from scipy.optimize import brentq
from scipy.special import ellipk, ellipkm1


@pytest.fixture
def spence(seed):
    return SpenceLine(hertz=seed, friction=0.2)


def test_published_stick_ratios():
    published = {(-1 / 7, 0.1): 0.4058, (1 / 7, 0.2): 0.9063, (-1 / 7, 0.3): 0.9891}
    for (beta, friction), ratio in published.items():
        assert StickZone(beta=beta, friction=friction).ratio == pytest.approx(ratio, abs=5e-5)


@pytest.mark.parametrize("quotient", [0.3, 0.6, 0.999, 1.0, 1.001, 1.7, 3.0])
def test_stick_ratio_solves_the_equation_of_elliptic_integrals(quotient):
    """A bracketed root of K(k)/K(sqrt(1-k^2)) = F/|beta|; scipy takes the square of k."""

    def residual(logit):
        m = 1 / (1 + np.exp(-logit))
        return ellipk(m) / ellipkm1(m) - quotient

    logit = brentq(residual, -40, 30, xtol=1e-13)
    expected = np.sqrt(1 / (1 + np.exp(-logit)))
    assert StickZone(beta=0.2, friction=0.2 * quotient).ratio == pytest.approx(expected, rel=1e-11)


def test_traction_ratio_against_independent_numbers():
    """Numbers of a numerical superposition of punches, good to 3e-3 (they lie below)."""
    t = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95]
    numbers = [0.186, 0.310, 0.413, 0.506, 0.595, 0.684, 0.778, 0.884, 0.942, 0.996, 1.0]
    mobilised = StickZone(beta=1 / 7, friction=0.2).HertzFriction(t) / 0.2
    np.testing.assert_allclose(mobilised, numbers, atol=3e-3)


@pytest.mark.parametrize("friction", [0.06, 0.2, 0.45])
def test_hertz_sums_up_the_punches(integral, friction):
    """With dp = s ds/sqrt(s^2 - x^2), v = sqrt(s^2 - x^2): the average of the punch over v."""
    zone = StickZone(beta=1 / 7, friction=friction)
    for t in (0.02, 0.3, 0.7, 0.99):
        width = np.sqrt(1 - t**2)
        kink = min(t * np.sqrt(1 / zone.ratio**2 - 1), width)
        total = integral(lambda v, t=t: zone.PunchFriction(t / np.hypot(t, v)), 0, width, [kink])
        assert zone.HertzFriction(t) == pytest.approx(total / width, rel=1e-9)


@pytest.mark.parametrize("beta", [-1 / 7, 1 / 7])
def test_punch_increment_solves_the_singular_integral_equation(hilbert, beta):
    """beta dp + H(dq) vanishes in stick; its sign in slip is that of slip against friction."""
    zone = StickZone(beta=beta, friction=0.2)
    k = zone.ratio

    def traction(t):
        return zone.PunchFriction(t) / np.sqrt(1 - t * t)

    def residual(t):
        return beta / np.sqrt(1 - t * t) + hilbert(traction, t, [-1, -k, 0, k, 1])

    for t in (-0.6, 0.05, 0.4, 0.88):
        assert abs(residual(t)) < 1e-8
    for t in (0.93, 0.97):
        assert beta * residual(t) > 1e-3


def test_traction_direction_and_coulomb_law(spence):
    a, c = spence.hertz.halfwidth, spence.stick
    x = np.linspace(0.01 * a, 1.3 * a, 301)
    traction, limit = spence.Traction(x), 0.2 * spence.hertz.Pressure(x)
    np.testing.assert_array_equal(spence.Traction(-x), -traction)
    assert spence.hertz.beta < 0
    assert (traction[x < a] < 0).all()  # stiffer slave: friction pulls it inwards
    np.testing.assert_allclose(traction[x > c], -limit[x > c], rtol=1e-14)
    assert (np.abs(traction[x < 0.99 * c]) < limit[x < 0.99 * c]).all()
    assert spence.Traction(0.0) == 0
    below, above = spence.Traction(c * (1 - 1e-12)), spence.Traction(c * (1 + 1e-12))
    assert below == pytest.approx(above, rel=1e-5)


def test_little_friction_slips_everywhere_and_much_nowhere():
    """Without slip the punch is Goodman's, q = (beta/pi) p ln((1 + t)/(1 - t))."""
    t = np.array([-0.9, -0.01, 0.01, 0.9])
    values = StickZone(beta=0.3, friction=0.01).HertzFriction(t)
    np.testing.assert_allclose(values, 0.01 * np.sign(t), rtol=1e-12)
    goodman = 0.1 / np.pi * np.log((1 + t) / (1 - t))
    for friction in (5.0, 50.0, 1e4):
        values = StickZone(beta=0.1, friction=friction).PunchFriction(t)
        np.testing.assert_allclose(values, goodman, rtol=1e-10)
    ratios = [StickZone(beta=0.1, friction=f).ratio for f in np.geomspace(1e-3, 10, 60)]
    assert (np.diff(ratios) >= 0).all()
    assert ratios[0] < 1e-60
    assert ratios[-1] == 1
    for beta, friction, ratio in ((0.0, 0.3, 1.0), (0.1, 0.0, 0.0)):  # no traction at all
        zone = StickZone(beta=beta, friction=friction)
        assert zone.ratio == ratio
        assert (zone.HertzFriction(t) == 0).all()
        assert (zone.PunchFriction(t) == 0).all()
