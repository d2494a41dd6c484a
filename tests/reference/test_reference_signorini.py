"""Exact contact solutions with a free end of the contact: scalar, elastic, and a disc in 3D."""

import numpy as np
import pytest
from exact_disc import ElasticSignoriniDisc
from exact_signorini import ElasticSignorini, ScalarSignorini

MATERIALS = {1: (3.0, 0.3), 2: (0.8, 0.1)}
ELASTIC = dict(young1=3.0, nu1=0.3, young2=0.8, nu2=0.1, strength=2.0)
SCALAR, PLANE = ScalarSignorini(tip=1 / 3), ElasticSignorini(**ELASTIC, tip=1 / 3)
DISC = ElasticSignoriniDisc(**ELASTIC, radius=0.6)
INSIDE = np.array([[-0.7, 0.2], [0.1, 0.5], [0.4, 0.05], [0.9, 0.8], [1 / 3, 0.3]]).T
IN_SPACE = np.array(
    [[0.0, 0.0, 0.3], [0.3, 0.2, 0.05], [0.5, -0.4, 0.4], [-0.9, 0.1, 0.1], [0.2, 0.55, 0.9]]
).T
STEP = 1e-3


@pytest.fixture(params=[1, 2])
def body(request):
    return request.param


def mirrored(x, body):
    """The points, on the side of the body."""
    return np.concatenate([x[:-1], x[-1:] * (1 if body == 1 else -1)])


def differences(function, x):
    """Fourth-order central differences: the axis of the derivative comes first."""
    columns = []
    for step in STEP * np.eye(len(x))[:, :, None]:
        values = [np.asarray(function(*(x + k * step))) for k in (-2, -1, 1, 2)]
        columns.append((values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * STEP))
    return np.stack(columns)


def stress(exact, x, body):
    """Hooke's law for the differences of the displacement: an array (d, d, points)."""
    young, nu = MATERIALS[body]
    gradient = differences(lambda *p: exact.Displacement(*p, body=body), x)
    strain = 0.5 * (gradient + gradient.swapaxes(0, 1))
    volume = nu / (1 - 2 * nu) * np.trace(strain) * np.eye(len(x))[:, :, None]
    return young / (1 + nu) * (strain + volume)


def test_value_in_polar_coordinates():
    x, y = INSIDE
    r, theta = np.hypot(x - 1 / 3, y), np.arctan2(y, x - 1 / 3)
    exact = r**1.5 * np.cos(1.5 * theta)
    np.testing.assert_allclose(SCALAR.Value(x, y), exact, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(SCALAR.Value(x, -y, body=2), -exact, rtol=1e-12, atol=1e-14)


def test_gradient_and_laplace_equation(body):
    x = mirrored(INSIDE, body)
    numeric = differences(lambda *p: SCALAR.Value(*p, body=body), x)
    np.testing.assert_allclose(SCALAR.Gradient(*x, body=body), numeric, atol=1e-7)
    second = differences(lambda *p: SCALAR.Gradient(*p, body=body), x)
    np.testing.assert_allclose(np.trace(second), 0, atol=1e-6)


def test_stress_is_that_of_the_displacement(body):
    x = mirrored(INSIDE, body)
    hooke = stress(PLANE, x, body)
    expected = hooke[0, 0], hooke[1, 1], hooke[0, 1]
    np.testing.assert_allclose(PLANE.Stress(*x, body=body), expected, atol=1e-6)


@pytest.mark.parametrize(("exact", "x"), [(PLANE, INSIDE), (DISC, IN_SPACE)])
def test_equilibrium(exact, x, body):
    second = differences(lambda *p: stress(exact, np.array(p), body), mirrored(x, body))
    np.testing.assert_allclose(np.trace(second), 0, atol=2e-5)


@pytest.mark.parametrize("exact", [SCALAR, PLANE, DISC])
def test_contact_conditions(exact):
    """The gap is that of the displacements; the pressure ends where the gap begins."""
    x = np.linspace(0, 1.5, 62) if exact is DISC else np.linspace(-1, 1, 82)
    zero, edge = np.zeros_like(x), 0.6 if exact is DISC else 1 / 3
    if exact is SCALAR:
        up, down = (exact.Value(x, zero, body=b) for b in (1, 2))
    elif exact is PLANE:
        up, down = (exact.Displacement(x, zero, body=b)[1] for b in (1, 2))
    else:
        up, down = (exact.Displacement(0.6 * x, 0.8 * x, zero, body=b)[2] for b in (1, 2))
    np.testing.assert_allclose(exact.Gap(x), up - down, atol=1e-14)
    np.testing.assert_allclose(np.abs([up, down])[:, x < edge], 0, atol=1e-14)
    assert ((exact.Gap(x) > 0) == (x > edge)).all()
    assert ((exact.Pressure(x) > 0) == (x < edge)).all()
    near = edge + 1e-4 * np.array([1, 4])
    assert exact.Gap(near)[1] / exact.Gap(near)[0] == pytest.approx(8, rel=2e-3)


def test_pressure_is_that_of_both_bodies():
    x = np.linspace(-1, 1, 81)
    zero = np.zeros_like(x)
    for body, sign in ((1, -1), (2, 1)):
        slope = SCALAR.Gradient(x, zero, body=body)[1]
        np.testing.assert_allclose(SCALAR.Pressure(x), -slope, atol=1e-14)
        _, normal, shear = PLANE.Stress(x, zero, body=body)
        np.testing.assert_allclose(PLANE.Pressure(x), -normal, atol=1e-14)
        assert (shear == 0).all()
        assert sign * PLANE.Stress(0.5, -sign * 0.1, body=body)[2] != 0
    assert SCALAR.Pressure(0.0) == pytest.approx(1.5 * np.sqrt(1 / 3))
    assert np.isfinite(PLANE.Stress(1 / 3, 0.0)).all()


def test_tractions_on_the_plane(body):
    """Extrapolated from the inside, at points in contact and beyond."""
    r = np.array([0.0, 0.2, 0.5, 0.7, 1.0])
    values = [
        stress(DISC, mirrored(np.stack([0.6 * r, -0.8 * r, 0 * r + z]), body), body)[2]
        for z in (0.01, 0.02, 0.03, 0.04)
    ]
    limit = 4 * values[0] - 6 * values[1] + 4 * values[2] - values[3]
    expected = np.stack([0 * r, 0 * r, -DISC.Pressure(r)])
    np.testing.assert_allclose(limit, expected, atol=2e-3)


def test_displacement_turns_with_the_point():
    x, y, z = IN_SPACE
    u, v, w = DISC.Displacement(x, y, z)
    np.testing.assert_allclose(DISC.Displacement(-y, x, z), (-v, u, w), atol=1e-15)
    assert np.isfinite(DISC.Displacement(0.6, 0.0, 0.0)).all()


@pytest.mark.parametrize(
    ("function", "extra"),
    [(SCALAR.Value, "sqrt"), (PLANE.Displacement, "sqrt"), (DISC.Displacement, "functions")],
)
def test_coefficient_functions(function, extra):
    ngsolve = pytest.importorskip("ngsolve")
    domain, n = (ngsolve.unit_square, 2) if extra == "sqrt" else (ngsolve.unit_cube, 3)
    mesh = ngsolve.Mesh(domain.GenerateMesh(maxh=1))
    x = (ngsolve.x, ngsolve.y, ngsolve.z)[:n]
    field = ngsolve.CF(function(*x, **{extra: ngsolve.sqrt if extra == "sqrt" else ngsolve}))
    for point in ((0.1, 0.6, 0.2), (0.8, 0.3, 0.0), (0.2, 0.1, 0.0)):
        values = function(*point[:n])
        np.testing.assert_allclose(field(mesh(*point[:n])), values, rtol=1e-11, atol=1e-15)
