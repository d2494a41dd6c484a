"""Exact contact solutions with a free end of the contact: scalar and elastic."""

import numpy as np
import pytest

from ngslac.reference import ElasticSignorini, ScalarSignorini

INSIDE = np.array([[-0.7, 0.2], [0.1, 0.5], [0.4, 0.05], [0.9, 0.8], [1 / 3, 0.3]]).T


@pytest.fixture
def scalar():
    return ScalarSignorini(tip=1 / 3)


@pytest.fixture
def elastic():
    return ElasticSignorini(young1=3.0, nu1=0.3, young2=0.8, nu2=0.1, tip=1 / 3, strength=2.0)


def derivative(function, x, y, *, step=1e-5):
    """Central differences of each component along x and y."""
    along_x = np.subtract(function(x + step, y), function(x - step, y)) / (2 * step)
    along_y = np.subtract(function(x, y + step), function(x, y - step)) / (2 * step)
    return along_x, along_y


def test_value_in_polar_coordinates(scalar):
    x, y = INSIDE
    r, theta = np.hypot(x - 1 / 3, y), np.arctan2(y, x - 1 / 3)
    exact = r**1.5 * np.cos(1.5 * theta)
    np.testing.assert_allclose(scalar.Value(x, y), exact, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(scalar.Value(x, -y, body=2), -exact, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("body", [1, 2])
def test_gradient_and_laplace_equation(scalar, body):
    x, y = INSIDE[0], INSIDE[1] * (1 if body == 1 else -1)
    numeric = derivative(lambda x, y: scalar.Value(x, y, body=body), x, y)
    np.testing.assert_allclose(scalar.Gradient(x, y, body=body), numeric, atol=1e-8)
    along_x, along_y = derivative(lambda x, y: scalar.Gradient(x, y, body=body), x, y)
    np.testing.assert_allclose(along_x[0] + along_y[1], 0, atol=1e-8)


def test_scalar_contact_conditions(scalar):
    x = np.linspace(-1, 1, 81)
    zero = np.zeros_like(x)
    gap = scalar.Value(x, zero) - scalar.Value(x, zero, body=2)
    np.testing.assert_allclose(scalar.Gap(x), gap, atol=1e-14)
    pressure = -scalar.Gradient(x, zero)[1]
    np.testing.assert_allclose(scalar.Gradient(x, zero, body=2)[1], -pressure, atol=0)
    np.testing.assert_allclose(scalar.Pressure(x), pressure, atol=1e-14)
    assert (scalar.Gap(x)[x < 0.33] == 0).all()
    assert (scalar.Gap(x)[x > 0.34] > 0).all()
    assert (scalar.Pressure(x)[x < 0.33] > 0).all()
    assert (scalar.Pressure(x)[x > 0.34] == 0).all()
    assert scalar.Pressure(0.0) == pytest.approx(1.5 * np.sqrt(1 / 3))


@pytest.mark.parametrize("case", ["scalar", "elastic"])
def test_mean_pressure_is_the_average(case, request, integral):
    exact = request.getfixturevalue(case)
    x0, x1 = np.array([-1.0, 0.2, 0.5, 0.3]), np.array([-0.8, 0.5, 0.9, -0.3])
    for left, right, mean in zip(x0, x1, exact.MeanPressure(x0, x1), strict=True):
        low, high = min(left, right), max(left, right)
        average = integral(exact.Pressure, low, high, [1 / 3]) / (high - low)
        assert mean == pytest.approx(average, rel=1e-9)


@pytest.mark.parametrize("case", ["scalar", "elastic"])
def test_coefficient_functions(case, request):
    ngsolve = pytest.importorskip("ngsolve")
    exact = request.getfixturevalue(case)
    name = "Value" if case == "scalar" else "Displacement"
    mesh = ngsolve.Mesh(ngsolve.unit_square.GenerateMesh(maxh=0.5))
    field = ngsolve.CF(getattr(exact, name)(ngsolve.x, ngsolve.y, sqrt=ngsolve.sqrt))
    for x, y in ((0.1, 0.6), (0.8, 0.3)):
        np.testing.assert_allclose(field(mesh(x, y)), getattr(exact, name)(x, y), rtol=1e-12)


@pytest.mark.parametrize("body", [1, 2])
def test_elastic_stress_is_that_of_the_displacement(elastic, body):
    young, nu = (3.0, 0.3) if body == 1 else (0.8, 0.1)
    x, y = INSIDE[0], INSIDE[1] * (1 if body == 1 else -1)
    along_x, along_y = derivative(lambda x, y: elastic.Displacement(x, y, body=body), x, y)
    shear = young / (2 * (1 + nu))
    volume = 2 * shear * nu / (1 - 2 * nu) * (along_x[0] + along_y[1])
    hooke = (
        2 * shear * along_x[0] + volume,
        2 * shear * along_y[1] + volume,
        shear * (along_y[0] + along_x[1]),
    )
    np.testing.assert_allclose(elastic.Stress(x, y, body=body), hooke, atol=1e-8)


@pytest.mark.parametrize("body", [1, 2])
def test_elastic_equilibrium(elastic, body):
    x, y = INSIDE[0], INSIDE[1] * (1 if body == 1 else -1)
    along_x, along_y = derivative(lambda x, y: elastic.Stress(x, y, body=body), x, y)
    np.testing.assert_allclose(along_x[0] + along_y[2], 0, atol=1e-7)
    np.testing.assert_allclose(along_x[2] + along_y[1], 0, atol=1e-7)


def test_elastic_contact_conditions(elastic):
    x = np.linspace(-1, 1, 81)
    zero = np.zeros_like(x)
    gap = elastic.Displacement(x, zero)[1] - elastic.Displacement(x, zero, body=2)[1]
    np.testing.assert_allclose(elastic.Gap(x), gap, atol=1e-14)
    for body in (1, 2):
        _, normal, shear = elastic.Stress(x, zero, body=body)
        np.testing.assert_allclose(elastic.Pressure(x), -normal, atol=1e-14)
        assert (shear == 0).all()
    assert (elastic.Gap(x)[x < 0.33] == 0).all()
    assert (elastic.Gap(x)[x > 0.34] > 0).all()
    assert (elastic.Pressure(x)[x < 0.33] > 0).all()
    assert np.isfinite(elastic.Stress(1 / 3, 0.0)).all()
