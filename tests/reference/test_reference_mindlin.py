"""Cattaneo-Mindlin partial slip, first loading and reversal."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

from ngslac.reference import CattaneoMindlin


@pytest.fixture
def partial(equal):
    return CattaneoMindlin(hertz=equal, shear=20.0, friction=0.3)


def edges(*states):
    return sorted({s * e for t in states for e in (t.stick, t.hertz.halfwidth) for s in (-1, 1)})


def test_published_formula(partial):
    """T17 of the reference cases, with its own symbols."""
    a, p0 = partial.hertz.halfwidth, partial.hertz.peak
    c = a * np.sqrt(1 - 20 / (0.3 * 120))
    assert partial.stick == pytest.approx(c, rel=1e-14)
    x = np.linspace(-0.99 * c, 0.99 * c, 7)
    expected = 0.3 * p0 * (np.sqrt(1 - x**2 / a**2) - c / a * np.sqrt(1 - x**2 / c**2))
    np.testing.assert_allclose(partial.Traction(x), expected, rtol=1e-13)


@pytest.mark.parametrize("shear", [-36.0, -7.0, 0.0, 0.1, 20.0, 36.0])
def test_traction_carries_the_load(equal, integral, shear):
    state = CattaneoMindlin(hertz=equal, shear=shear, friction=0.3)
    a = equal.halfwidth
    total = integral(state.Traction, -a, a, edges(state))
    assert total == pytest.approx(shear, rel=1e-9, abs=1e-12)
    assert state.MeanTraction(-2 * a, 2 * a) * 4 * a == pytest.approx(shear, rel=1e-13)


def test_no_slip_where_it_sticks(partial, hilbert):
    """The gradient of slip is -(2/E*) H(tau): zero in stick, against friction in slip."""
    a, c = partial.hertz.halfwidth, partial.stick
    scale = 0.3 * partial.hertz.peak
    for x in (-0.8 * c, 0.05 * c, 0.9 * c):
        assert abs(hilbert(partial.Traction, x, edges(partial))) < 1e-8 * scale
    for x in (c + 0.1 * (a - c), c + 0.8 * (a - c)):
        assert hilbert(partial.Traction, x, edges(partial)) > 1e-3 * scale


def test_slip_has_the_gradient_of_the_surface_strains(partial, hilbert):
    a, c = partial.hertz.halfwidth, partial.stick
    step = 1e-6 * a
    for x in (-0.5 * (a + c), c + 0.3 * (a - c), c + 0.9 * (a - c)):
        gradient = (partial.Slip(x + step) - partial.Slip(x - step)) / (2 * step)
        exact = -2 / partial.hertz.modulus * hilbert(partial.Traction, x, edges(partial))
        assert gradient == pytest.approx(exact, rel=1e-6)
    assert (partial.Slip(np.linspace(-c, c, 9)) == 0).all()
    assert np.isnan(partial.Slip(1.01 * a))


def test_coulomb_law(partial):
    a, c = partial.hertz.halfwidth, partial.stick
    x = np.linspace(-1.2 * a, 1.2 * a, 401)
    limit = 0.3 * partial.hertz.Pressure(x)
    traction = partial.Traction(x)
    assert (np.abs(traction) <= limit * (1 + 1e-14)).all()
    slips = (np.abs(x) > c) & (np.abs(x) < a)
    np.testing.assert_allclose(traction[slips], limit[slips], rtol=1e-14)
    assert (traction[slips] * partial.Slip(x[slips]) < 0).all()
    assert (traction[np.abs(x) < 0.99 * c] < limit[np.abs(x) < 0.99 * c]).all()


def test_mean_traction_is_the_average(partial, integral):
    back = partial.Reverse(-5.0)
    a = partial.hertz.halfwidth
    x0 = np.linspace(-1.3, 1.1, 9) * a
    x1 = x0 + 0.3 * a
    cuts = sorted([*edges(partial), -back.stick, back.stick])
    for state in (partial, back):
        for left, right, mean in zip(x0, x1, state.MeanTraction(x0, x1), strict=True):
            exact = integral(state.Traction, left, right, cuts) / (right - left)
            assert mean == pytest.approx(exact, rel=1e-8, abs=1e-10)


def test_limits_of_the_load(equal):
    x = np.linspace(-equal.halfwidth, equal.halfwidth, 11)
    none = CattaneoMindlin(hertz=equal, shear=0.0, friction=0.3)
    assert none.ratio == 1
    assert (none.Traction(x) == 0).all()
    assert CattaneoMindlin(hertz=equal, shear=36.0 * (1 + 1e-15), friction=0.3).ratio == 0
    sliding = CattaneoMindlin(hertz=equal, shear=-36.0, friction=0.3)
    assert sliding.ratio == 0
    np.testing.assert_allclose(sliding.Traction(x), -0.3 * equal.Pressure(x), rtol=1e-14)


def test_reversal_carries_its_load_and_keeps_the_middle(partial, integral, hilbert):
    back = partial.Reverse(4.0)
    a, b = partial.hertz.halfwidth, back.stick
    assert b > partial.stick
    cuts = sorted([*edges(partial), -b, b])
    assert integral(back.Traction, -a, a, cuts) == pytest.approx(4.0, rel=1e-9)
    for x in (0.3 * partial.stick, 0.5 * (partial.stick + b)):  # no change of slip since
        before, after = (hilbert(s.Traction, x, cuts) for s in (partial, back))
        assert after == pytest.approx(before, abs=1e-8 * partial.hertz.peak)
    x = np.linspace(1.001 * b, 0.999 * a, 7)
    np.testing.assert_allclose(back.Traction(x), -0.3 * partial.hertz.Pressure(x), rtol=1e-12)
    assert (np.abs(back.Slip(x)) < np.abs(partial.Slip(x))).all()


def test_reversal_ends(partial):
    a = partial.hertz.halfwidth
    x = np.linspace(-a, a, 21)
    np.testing.assert_array_equal(partial.Reverse(20.0).Traction(x), partial.Traction(x))
    mirrored = partial.Reverse(-20.0)
    np.testing.assert_allclose(mirrored.Traction(x), -partial.Traction(x), atol=1e-13)
    np.testing.assert_allclose(mirrored.Slip(x), -partial.Slip(x), atol=1e-16)


def test_full_cycle_dissipates(equal):
    """Friction work of a half cycle is positive and grows faster than the square of the load."""
    x = np.linspace(-1, 1, 20001) * equal.halfwidth
    work = []
    for shear in (9.0, 18.0):
        start = CattaneoMindlin(hertz=equal, shear=shear, friction=0.3)
        end = start.Reverse(-shear)
        change = end.Slip(x) - start.Slip(x)
        work.append(trapezoid(0.3 * equal.Pressure(x) * np.abs(change), x))
    assert work[0] > 0
    assert work[1] > 6 * work[0]  # nearly cubic for small loads, and more for larger ones
