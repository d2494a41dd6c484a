"""Hertz line contact and elastic constants of a pair of bodies."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from ngslac.reference import ContactModulus, DundursBeta, HertzLine


def test_published_values(seed):
    assert seed.modulus == pytest.approx(57692.3, abs=0.05)
    assert seed.halfwidth == pytest.approx(6.2146, abs=5e-5)
    assert seed.peak == pytest.approx(3585.36, abs=5e-3)
    half = replace(seed, force=17.5e3)
    assert half.halfwidth == pytest.approx(4.394, abs=5e-4)
    assert half.peak == pytest.approx(2535.2, abs=0.05)


def test_pressure_carries_the_force(seed, integral):
    a = seed.halfwidth
    assert integral(seed.Pressure, -a, a) == pytest.approx(seed.force, rel=1e-9)
    assert seed.MeanPressure(-2 * a, 3 * a) * 5 * a == pytest.approx(seed.force, rel=1e-13)


def test_pressure_closes_the_gap_of_the_parabola(seed, hilbert):
    """The surface slope 2 H(p)/E* equals x/R in contact: the defining equation."""
    a = seed.halfwidth
    for x in (-0.7 * a, 0.1 * a, 0.9 * a):
        slope = 2 * hilbert(seed.Pressure, x, [-a, a]) / seed.modulus
        assert slope == pytest.approx(x / seed.radius, rel=1e-7)


def test_mean_pressure_is_the_average(seed, integral):
    a = seed.halfwidth
    x0 = np.array([-8.0, -1.0, 0.0, 6.0, 7.0, 2.0])
    x1 = np.array([-5.0, 1.0, 6.5, 6.3, 9.0, 1.0])
    means = seed.MeanPressure(x0, x1)
    for left, right, mean in zip(x0, x1, means, strict=True):
        low, high = min(left, right), max(left, right)
        exact = integral(seed.Pressure, low, high, [-a, a]) / (high - low)
        assert mean == pytest.approx(exact, rel=1e-9, abs=1e-9)


def test_pressure_is_even_and_ends_at_the_edge(seed):
    x = np.linspace(0, 2 * seed.halfwidth, 41)
    pressure = seed.Pressure(x)
    np.testing.assert_array_equal(pressure, seed.Pressure(-x))
    assert (pressure[x > seed.halfwidth] == 0).all()
    assert (pressure[x < seed.halfwidth] > 0).all()
    assert pressure[0] == seed.peak


def test_two_equal_cylinders_are_one_on_a_rigid_plane(equal):
    """By symmetry the plane of contact stays flat."""
    twins = replace(equal, radius2=equal.radius1)
    single = HertzLine(force=120, radius1=30, young1=2e4, nu1=0.25, young2=inf, nu2=0.0)
    assert twins.halfwidth == pytest.approx(single.halfwidth, rel=1e-14)
    assert twins.peak == pytest.approx(single.peak, rel=1e-14)


def test_units_do_not_matter(seed):
    metre = HertzLine(force=35e6, radius1=0.05, young1=210e9, nu1=0.3, young2=70e9, nu2=0.3)
    assert metre.halfwidth == pytest.approx(seed.halfwidth * 1e-3, rel=1e-13)
    assert metre.MeanPressure(0, 1e-3) == pytest.approx(seed.MeanPressure(0, 1) * 1e6, rel=1e-13)


def test_dundurs_constant():
    assert DundursBeta(young1=210e3, nu1=0.3, young2=70e3, nu2=0.3) == pytest.approx(-1 / 7)
    assert DundursBeta(young1=5.0, nu1=0.3) == pytest.approx(0.4 / 1.4)
    assert DundursBeta(young1=5.0, nu1=0.2, young2=5.0, nu2=0.2) == 0
    pair = DundursBeta(young1=5.0, nu1=0.1, young2=2.0, nu2=0.4)
    assert DundursBeta(young1=2.0, nu1=0.4, young2=5.0, nu2=0.1) == pytest.approx(-pair)


def test_dundurs_constant_is_the_inward_motion_under_pressure():
    """For a uniform strip of pressure p the free strain along the surface is -(1-2nu)p/(2G)."""
    young, nu = (3.0, 7.0), (0.1, 0.35)
    strain = [-(1 - 2 * n) * (1 + n) / e for e, n in zip(young, nu, strict=True)]
    modulus = ContactModulus(young1=3.0, nu1=0.1, young2=7.0, nu2=0.35)
    beta = DundursBeta(young1=3.0, nu1=0.1, young2=7.0, nu2=0.35)
    assert strain[0] - strain[1] == pytest.approx(-2 * beta / modulus, rel=1e-13)
