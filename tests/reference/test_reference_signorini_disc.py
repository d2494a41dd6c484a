"""The exact solution with a circular contact between two elastic bodies."""

from dataclasses import replace

import numpy as np
import pytest

from ngslac.reference import ElasticSignoriniDisc

RADIUS, STRENGTH, STEP = 0.6, 2.0, 1e-3
MATERIALS = {1: (3.0, 0.3), 2: (0.8, 0.1)}
POINTS = np.array(
    [[0.0, 0.0, 0.3], [0.3, 0.2, 0.05], [0.5, -0.4, 0.4], [-0.9, 0.1, 0.1], [0.2, 0.55, 0.9]]
).T


@pytest.fixture
def disc():
    return ElasticSignoriniDisc(
        young1=3.0, nu1=0.3, young2=0.8, nu2=0.1, radius=RADIUS, strength=STRENGTH
    )


def differences(function, x, axis):
    """Fourth-order central differences."""
    step = STEP * np.eye(3)[axis][:, None]
    values = [np.asarray(function(*(x + k * step))) for k in (-2, -1, 1, 2)]
    return (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * STEP)


def stress(disc, x, body):
    """Hooke's law for the differences of the displacement: an array (3, 3, points)."""
    young, nu = MATERIALS[body]
    gradient = np.stack(
        [differences(lambda *p: disc.Displacement(*p, body=body), x, k) for k in range(3)], axis=1
    )
    strain = 0.5 * (gradient + gradient.swapaxes(0, 1))
    volume = nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3)[:, :, None]
    return young / (1 + nu) * (strain + volume)


def side(body):
    return np.array([[1.0], [1.0], [1.0 if body == 1 else -1.0]])


@pytest.mark.parametrize("body", [1, 2])
def test_equilibrium(disc, body):
    x = POINTS * side(body)
    divergence = sum(
        differences(lambda *p: stress(disc, np.array(p), body), x, k)[:, k] for k in range(3)
    )
    np.testing.assert_allclose(divergence, 0, atol=1e-5 * STRENGTH)


@pytest.mark.parametrize("body", [1, 2])
def test_tractions_on_the_plane(disc, body):
    """Extrapolated from the inside, at points in contact and beyond."""
    r = np.array([0.0, 0.2, 0.5, 0.7, 1.0])
    heights = (0.01, 0.02, 0.03, 0.04)
    values = []
    for height in heights:
        x = np.stack([0.6 * r, -0.8 * r, np.full_like(r, height)]) * side(body)
        values.append(stress(disc, x, body)[2])
    limit = 4 * values[0] - 6 * values[1] + 4 * values[2] - values[3]
    expected = np.stack([0 * r, 0 * r, -disc.Pressure(r)])
    np.testing.assert_allclose(limit, expected, atol=1e-3 * STRENGTH)


def test_contact_conditions(disc):
    r = np.linspace(0, 1.5, 61)
    zero = np.zeros_like(r)
    up, down = (disc.Displacement(0.6 * r, 0.8 * r, zero, body=b)[2] for b in (1, 2))
    np.testing.assert_allclose(disc.Gap(r), up - down, atol=1e-14)
    assert (disc.Gap(r)[r < RADIUS] == 0).all()
    assert (disc.Gap(r)[r > RADIUS + 1e-6] > 0).all()
    assert (disc.Pressure(r)[r < RADIUS - 1e-6] > 0).all()
    assert (disc.Pressure(r)[r > RADIUS + 1e-6] == 0).all()
    np.testing.assert_allclose(np.abs([up, down])[:, r < RADIUS], 0, atol=1e-14)
    near = RADIUS * (1 + np.array([1e-4, 4e-4]))
    assert disc.Gap(near)[1] / disc.Gap(near)[0] == pytest.approx(8, rel=1e-3)


def test_displacement_turns_with_the_point(disc):
    x, y, z = POINTS
    u, v, w = disc.Displacement(x, y, z)
    np.testing.assert_allclose(disc.Displacement(-y, x, z), (-v, u, w), atol=1e-15)
    assert np.isfinite(disc.Displacement(RADIUS, 0.0, 0.0)).all()


def test_mean_pressure_is_the_average(disc):
    face = np.array([[0.1, 0.2], [0.4, 0.1], [0.2, 0.4]])
    nodes = (face + np.roll(face, -1, axis=0)) / 2
    coarse = disc.Pressure(np.hypot(*nodes.T)).mean()  # exact to the second degree
    assert disc.MeanPressure(face) == pytest.approx(coarse, rel=1e-2)
    whole = 2.0 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    force = 2 / 3 * np.pi * STRENGTH * RADIUS**3
    assert disc.MeanPressure(whole) * 16 == pytest.approx(force, rel=1e-13)


def test_coefficient_functions(disc):
    ngsolve = pytest.importorskip("ngsolve")
    mesh = ngsolve.Mesh(ngsolve.unit_cube.GenerateMesh(maxh=1))
    field = ngsolve.CF(disc.Displacement(ngsolve.x, ngsolve.y, ngsolve.z, functions=ngsolve))
    for point in ((0.1, 0.6, 0.2), (0.8, 0.3, 0.0), (0.2, 0.1, 0.0)):
        np.testing.assert_allclose(
            field(mesh(*point)), disc.Displacement(*point), rtol=1e-11, atol=1e-15
        )


def test_disc_refuses(disc):
    for name, bad in (("radius", 0.0), ("strength", -1.0), ("young1", 0.0), ("nu2", 0.5)):
        with pytest.raises(ValueError, match=rf"{name} = {bad} is not valid"):
            replace(disc, **{name: bad})
    with pytest.raises(ValueError, match=r"body = 3 is not valid"):
        disc.Displacement(0.0, 0.0, 0.0, body=3)
    with pytest.raises(ValueError, match=r"r = nan is not valid"):
        disc.Gap(float("nan"))
