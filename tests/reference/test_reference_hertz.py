"""Hertz contact of lines and points, and the elastic constants of a pair."""

from dataclasses import replace
from math import inf, pi, sqrt

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.special import ellipkm1

from ngslac.reference import ContactModulus, DundursBeta, HertzLine, HertzPoint

SPHERES = dict(radius1=50, radius2=50, young1=20e3, nu1=0.3, young2=20e3, nu2=0.3)


@pytest.fixture
def point():
    return HertzPoint(force=2e3, radius1=50, young1=210e3, nu1=0.3, young2=70e3, nu2=0.2)


def test_published_values(seed):
    assert seed.modulus == pytest.approx(57692.3, abs=0.05)
    assert seed.halfwidth == pytest.approx(6.2146, abs=5e-5)
    assert seed.peak == pytest.approx(3585.36, abs=5e-3)
    half = replace(seed, force=17.5e3)
    assert half.halfwidth == pytest.approx(4.394, abs=5e-4)
    assert half.peak == pytest.approx(2535.2, abs=0.05)
    # Case T04 of the reference cases: two equal spheres brought together by 2 + 2.
    spheres = HertzPoint.FromApproach(approach=4, **SPHERES)
    assert spheres.approach == pytest.approx(4, rel=1e-14)
    assert spheres.contact_radius == pytest.approx(10, rel=1e-14)
    assert spheres.peak == pytest.approx(2798.33, abs=5e-3)
    assert spheres.force == pytest.approx(586081, abs=0.5)
    assert spheres.peak == pytest.approx(20e3 / (pi * (1 - 0.09)) * sqrt(2 * 4 / 50), rel=1e-14)


def test_pressure_carries_the_force(seed, point, integral):
    a, b = seed.halfwidth, point.contact_radius
    assert integral(seed.Pressure, -a, a) == pytest.approx(seed.force, rel=1e-9)
    assert seed.MeanPressure(-2 * a, 3 * a) * 5 * a == pytest.approx(seed.force, rel=1e-13)
    total = integral(lambda r: 2 * pi * r * point.Pressure(r), 0, b)
    assert total == pytest.approx(point.force, rel=1e-10)


def test_pressure_is_even_and_ends_at_the_edge(seed, point):
    for hertz, size in ((seed, seed.halfwidth), (point, point.contact_radius)):
        x = np.linspace(0, 2 * size, 42)
        pressure = hertz.Pressure(x)
        np.testing.assert_array_equal(pressure, hertz.Pressure(-x))
        assert ((pressure > 0) == (x < size)).all()
        assert pressure[0] == hertz.peak


def test_pressure_closes_the_gap_of_the_parabola(seed, hilbert):
    """The surface slope 2 H(p)/E* equals x/R in contact: the defining equation."""
    a = seed.halfwidth
    for x in (-0.7 * a, 0.1 * a, 0.9 * a):
        slope = 2 * hilbert(seed.Pressure, x, [-a, a]) / seed.modulus
        assert slope == pytest.approx(x / seed.radius, rel=1e-7)


def test_surfaces_fit_in_contact_and_leave_the_gap_around_it(point, integral):
    """The motion of both surfaces under the pressure: rings of Boussinesq point forces."""
    a = point.contact_radius
    for r in (0.3 * a, 0.95 * a, 1.05 * a, 2 * a, 7 * a):

        def ring(s, r=r):
            kernel = 4 * ellipkm1(((r - s) / (r + s)) ** 2) / (r + s)
            return s * point.Pressure(s) * kernel / (pi * point.modulus)

        gap = r**2 / (2 * point.radius) - point.approach + integral(ring, 0, a, [r])
        assert point.Gap(r) == pytest.approx(gap, abs=1e-8 * point.approach)
    assert (point.Gap(np.linspace(0, a, 9)) == 0).all()
    assert point.Gap(1.001 * a) > 0


def test_two_equal_bodies_are_one_on_a_rigid_plane():
    """By symmetry the plane of contact stays flat, and each body makes half the approach."""
    twins, rigid = SPHERES, dict(radius1=50, young1=20e3, nu1=0.3, young2=inf, nu2=0.0)
    two, one = (HertzLine(force=120, **bodies) for bodies in (twins, rigid))
    assert (two.halfwidth, two.peak) == pytest.approx((one.halfwidth, one.peak), rel=1e-14)
    two = HertzPoint.FromApproach(approach=4, **twins)
    one = HertzPoint.FromApproach(approach=2, **rigid)
    assert (two.contact_radius, two.force) == pytest.approx(
        (one.contact_radius, one.force), rel=1e-14
    )


def test_dundurs_constant():
    assert DundursBeta(young1=210e3, nu1=0.3, young2=70e3, nu2=0.3) == pytest.approx(-1 / 7)
    assert DundursBeta(young1=5.0, nu1=0.3) == pytest.approx(0.4 / 1.4)
    assert DundursBeta(young1=5.0, nu1=0.2, young2=5.0, nu2=0.2) == 0
    # For a uniform strip of pressure p the free strain along the surface is -(1-2nu)p/(2G).
    first, second = (-(1 - 2 * nu) * (1 + nu) / young for young, nu in ((3.0, 0.1), (7.0, 0.35)))
    bodies = dict(young1=3.0, nu1=0.1, young2=7.0, nu2=0.35)
    beta, modulus = DundursBeta(**bodies), ContactModulus(**bodies)
    assert first - second == pytest.approx(-2 * beta / modulus, rel=1e-13)


@pytest.mark.parametrize("body", [1, 2])
def test_axis_stress_sums_up_boussinesq_point_forces(point, integral, body):
    nu, a = (point.nu1, point.nu2)[body - 1], point.contact_radius
    for z in (0.2 * a, 0.5 * a, 3 * a):

        def vertical(r, z=z):
            return -3 * z**3 * r * point.Pressure(r) / np.hypot(r, z) ** 5

        def radial(r, z=z):
            far = np.hypot(r, z)
            value = (1 - 2 * nu) * z / far**3 - 3 * z * r**2 / far**5
            return 0.5 * r * point.Pressure(r) * value

        expected = [integral(f, 0, a) for f in (radial, vertical)]
        np.testing.assert_allclose(point.AxisStress(z, body=body), expected, rtol=1e-8)


def test_deepest_shear(point):
    def shear(z):
        radial, vertical = point.AxisStress(z * point.contact_radius)
        return -abs(radial - vertical) / (2 * point.peak)

    deepest = minimize_scalar(shear, bounds=(0.1, 1.0), method="bounded")
    assert deepest.x == pytest.approx(0.48, abs=0.005)  # Johnson, section 4.2, nu = 0.3
    assert -deepest.fun == pytest.approx(0.31, abs=0.001)
    # -(1 + 2 nu)/2 and -1 at the surface
    assert point.AxisStress(0.0) == pytest.approx((-0.8 * point.peak, -point.peak), rel=1e-14)
