"""Hertz point contact: two spheres, or a sphere on a flat surface."""

from dataclasses import replace
from math import inf, pi, sqrt

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.special import ellipkm1

from ngslac.reference import HertzPoint

TURNS = np.linspace(0, 2 * pi, 8, endpoint=False)


@pytest.fixture
def spheres():
    """Case T04 of the reference cases: two equal spheres brought together by 2 + 2."""
    return HertzPoint.FromApproach(
        approach=4, radius1=50, radius2=50, young1=20e3, nu1=0.3, young2=20e3, nu2=0.3
    )


@pytest.fixture
def seed():
    return HertzPoint(force=2e3, radius1=50, young1=210e3, nu1=0.3, young2=70e3, nu2=0.2)


def test_published_values(spheres):
    assert spheres.contact_radius == pytest.approx(10, rel=1e-14)
    assert spheres.peak == pytest.approx(2798.33, abs=5e-3)
    assert spheres.force == pytest.approx(586081, abs=0.5)
    assert spheres.peak == pytest.approx(20e3 / (pi * (1 - 0.09)) * sqrt(2 * 4 / 50), rel=1e-14)


def test_force_and_approach_belong_together(seed):
    bodies = {k: v for k, v in vars(seed).items() if k != "force"}
    assert HertzPoint.FromApproach(approach=seed.approach, **bodies).force == pytest.approx(
        seed.force, rel=1e-14
    )


def test_pressure_carries_the_force(seed, integral):
    a = seed.contact_radius
    total = integral(lambda r: 2 * pi * r * seed.Pressure(r), 0, a)
    assert total == pytest.approx(seed.force, rel=1e-10)
    square = 3 * a * np.array([[-1, -1], [1.5, -1], [1.5, 1], [-1, 1]])
    assert seed.MeanPressure(square) * 45 * a**2 == pytest.approx(seed.force, rel=1e-13)


def ring_motion(hertz, r, integral):
    """Normal motion of both surfaces under the pressure: rings of Boussinesq point forces."""
    a = hertz.contact_radius

    def ring(s):
        kernel = 4 * ellipkm1(((r - s) / (r + s)) ** 2) / (r + s)
        return s * hertz.Pressure(s) * kernel / (pi * hertz.modulus)

    return integral(ring, 0, a, [r])


def test_surfaces_fit_in_contact_and_leave_the_gap_around_it(seed, integral):
    a = seed.contact_radius
    for r in (0.3 * a, 0.95 * a, 1.05 * a, 2 * a, 7 * a):
        gap = r**2 / (2 * seed.radius) - seed.approach + ring_motion(seed, r, integral)
        assert seed.Gap(r) == pytest.approx(gap, abs=1e-8 * seed.approach)
    assert (seed.Gap(np.linspace(0, a, 9)) == 0).all()
    assert seed.Gap(1.001 * a) > 0


def test_two_equal_spheres_are_one_on_a_rigid_plane(spheres):
    """By symmetry the plane of contact stays flat, and each body makes half the approach."""
    single = HertzPoint.FromApproach(
        approach=2, radius1=50, young1=20e3, nu1=0.3, young2=inf, nu2=0.0
    )
    assert single.contact_radius == pytest.approx(spheres.contact_radius, rel=1e-14)
    assert single.force == pytest.approx(spheres.force, rel=1e-14)


def test_units_do_not_matter(seed):
    metre = HertzPoint(force=2e3, radius1=0.05, young1=210e9, nu1=0.3, young2=70e9, nu2=0.2)
    face = np.array([[0, 0], [0.5, 0.1], [0.1, 2.0]])
    assert metre.contact_radius == pytest.approx(seed.contact_radius * 1e-3, rel=1e-13)
    assert metre.MeanPressure(face * 1e-3) == pytest.approx(seed.MeanPressure(face) * 1e6)


@pytest.mark.parametrize("body", [1, 2])
def test_axis_stress_sums_up_boussinesq_point_forces(seed, integral, body):
    nu, a = (seed.nu1, seed.nu2)[body - 1], seed.contact_radius
    for z in (0.2 * a, 0.5 * a, 3 * a):

        def vertical(r, z=z):
            return -3 * z**3 * r * seed.Pressure(r) / np.hypot(r, z) ** 5

        def radial(r, z=z):
            far = np.hypot(r, z)
            value = (1 - 2 * nu) * z / far**3 - 3 * z * r**2 / far**5
            return 0.5 * r * seed.Pressure(r) * value

        expected = [integral(f, 0, a) for f in (radial, vertical)]
        np.testing.assert_allclose(seed.AxisStress(z, body=body), expected, rtol=1e-8)


def test_axis_stress_at_the_surface_and_deepest_shear(seed):
    radial, vertical = seed.AxisStress(0.0)
    assert vertical == pytest.approx(-seed.peak, rel=1e-14)
    assert radial == pytest.approx(-0.8 * seed.peak, rel=1e-14)  # -(1 + 2 nu)/2

    def shear(z):
        radial, vertical = seed.AxisStress(z * seed.contact_radius)
        return -abs(radial - vertical) / (2 * seed.peak)

    deepest = minimize_scalar(shear, bounds=(0.1, 1.0), method="bounded")
    assert deepest.x == pytest.approx(0.48, abs=0.005)  # Johnson, section 4.2, nu = 0.3
    assert -deepest.fun == pytest.approx(0.31, abs=0.001)


def strip_mean(hertz, corners, integral):
    """Average over a convex polygon from strips along x, whose integral is elementary."""
    corners = np.asarray(corners)
    a = hertz.contact_radius

    def chord(y):
        ends = []
        for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            if min(y0, y1) < y < max(y0, y1):
                ends.append(x0 + (x1 - x0) * (y - y0) / (y1 - y0))
        half = sqrt(max(a * a - y * y, 0.0))
        low, high = np.clip(sorted(ends), -half, half)
        if low == high:
            return 0.0
        root = [
            0.5 * (x * sqrt(half**2 - x**2) + half**2 * np.arcsin(x / half)) for x in (low, high)
        ]
        return hertz.peak / a * (root[1] - root[0])

    x, y = corners.T
    cuts = [*y, -a, a]
    for (x0, y0), (dx, dy) in zip(corners, np.roll(corners, -1, axis=0) - corners, strict=True):
        roots = np.roots([dx**2 + dy**2, 2 * (x0 * dx + y0 * dy), x0**2 + y0**2 - a**2])
        cuts += [y0 + t * dy for t in roots[np.isreal(roots)].real if 0 < t < 1]
    area = 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    return integral(chord, min(y), max(y), cuts) / area


@pytest.mark.parametrize(
    "corners",
    [
        [[0.1, 0.2], [0.4, 0.3], [0.2, 0.6]],  # inside
        [[-0.3, -0.2], [0.5, -0.1], [0.1, 0.4]],  # around the middle
        [[0.5, 0.5], [1.2, 0.4], [0.6, 1.3]],  # over the edge, corners outside
        [[-2.0, 0.9], [2.0, 0.95], [0.0, 3.0]],  # an edge is a chord, no corner inside
        [[-1.5, -1.2], [1.6, -1.3], [1.4, 1.2], [-1.3, 1.7]],  # holds the contact
        [[0.0, 0.0], [0.7, 0.0], [0.9, 0.8], [0.0, 0.7]],  # the middle is a corner
        [[-0.4, 0.0], [0.6, 0.0], [0.1, 0.9]],  # the middle is on an edge
        [[0.6999, 0.7], [0.7201, 0.69], [0.71, 0.73]],  # small, at the edge of the contact
    ],
)
def test_mean_pressure_is_the_average(seed, integral, corners):
    corners = seed.contact_radius * np.array(corners)
    expected = strip_mean(seed, corners, integral)
    for angle in TURNS:
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        assert seed.MeanPressure(corners @ turn) == pytest.approx(expected, rel=1e-9)
        assert seed.MeanPressure((corners @ turn)[::-1]) == pytest.approx(expected, rel=1e-9)


def test_mean_pressure_outside_is_exactly_zero(seed):
    a = seed.contact_radius
    triangle = a * np.array([[1.0, 0.3], [1.4, 0.2], [1.1, 0.6]])
    assert seed.MeanPressure(triangle) == 0
    around = a * np.array([[1.1, 0.0], [0.0, 9.0], [9.0, 9.0]])  # sees the contact at 90 degrees
    assert seed.MeanPressure(around) == 0


def test_mean_pressure_of_many_faces_carries_the_force(seed):
    """Triangles of a distorted grid: one call, averages times areas add up to the force."""
    grid = np.stack(np.meshgrid(*2 * [np.linspace(-1.2, 1.2, 14)], indexing="ij"), axis=-1)
    grid[1:-1, 1:-1] += np.random.default_rng(3).uniform(-0.06, 0.06, (12, 12, 2))
    grid *= seed.contact_radius
    quads = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=-2)
    triangles = np.stack([quads[..., [0, 1, 2], :], quads[..., [0, 2, 3], :]], axis=-3)

    def areas(faces):
        x, y = faces[..., 0], faces[..., 1]
        return 0.5 * (x * np.roll(y, -1, -1) - y * np.roll(x, -1, -1)).sum(axis=-1)

    for faces in (quads, triangles):
        means = seed.MeanPressure(faces)
        assert means.shape == faces.shape[:-2]
        assert (means * areas(faces)).sum() == pytest.approx(seed.force, rel=1e-13)
    pairs = seed.MeanPressure(triangles) * areas(triangles)
    np.testing.assert_allclose(
        pairs.sum(axis=-1), seed.MeanPressure(quads) * areas(quads), atol=1e-12 * seed.force
    )


def test_mean_pressure_tends_to_the_pressure(seed):
    a = seed.contact_radius
    small = 1e-3 * a * np.array([[-1, -1], [2, -1], [-1, 2]])
    for r in (0.0, 0.4 * a, 0.9 * a):
        mean = seed.MeanPressure(small + np.array([0, r]))
        assert mean == pytest.approx(seed.Pressure(r), rel=2e-5)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("force", 0.0),
        ("radius1", -50.0),
        ("young2", -1.0),
        ("nu1", 0.5),
    ],
)
def test_hertz_point_refuses(seed, name, value):
    with pytest.raises(ValueError, match=rf"{name} = {value} is not valid: .*give"):
        replace(seed, **{name: value})


def test_more_refused_input(seed):
    bodies = dict(radius1=50, young1=1e5, nu1=0.3, young2=1e5, nu2=0.3)
    with pytest.raises(ValueError, match=r"approach = -1\.0 is not valid"):
        HertzPoint.FromApproach(approach=-1.0, **bodies)
    with pytest.raises(ValueError, match=r"radius2 = inf is not valid: surface 1 is flat"):
        replace(seed, radius1=inf)
    with pytest.raises(ValueError, match=r"r = nan is not valid: give finite"):
        seed.Pressure(float("nan"))
    with pytest.raises(ValueError, match=r"depth = -1\.0 is not valid"):
        seed.AxisStress([1.0, -1.0])
    with pytest.raises(ValueError, match=r"body = 3 is not valid"):
        seed.AxisStress(1.0, body=3)
    with pytest.raises(ValueError, match=r"shape \(2, 2\) are not valid.*corners, 2"):
        seed.MeanPressure([[0, 0], [1, 1]])
    with pytest.raises(ValueError, match=r"(?s)vertices = .*nonzero area"):
        seed.MeanPressure([[0, 0], [1, 1], [2, 2]])
