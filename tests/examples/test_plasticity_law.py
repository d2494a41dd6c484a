"""J2 plasticity on quadrature points against an independent return map: stress, energy, state."""

import math

import numpy as np
import pytest
from ngsolve import CF, Parameter
from ngsolve.meshes import MakeStructured2DMesh
from plasticity import J2Plasticity

MATERIALS = [
    {"yield_stress": 35.0},
    {"yield_stress": 35.0, "hardening": 900.0},
    {"yield_stress": 35.0, "hardening": 500.0, "saturation": 20.0, "rate": 300.0},
]


def path():
    """Strains (3, 3) that load, turn and unload."""
    shear = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 0]])
    first = np.diag([1.0, -0.6, -0.2]) + 0.5 * shear
    second = np.diag([-0.2, 1.2, 0.0]) - 0.4 * shear
    for t in (0.2, 0.6, 1.0):
        yield 2e-3 * t * first
    for t in (0.5, 1.0):
        yield 2e-3 * (first + t * second)
    yield 1e-3 * first


class ReturnMap:
    """Radial return by bisection on the plastic increment, written without the code under test."""

    def __init__(self, young, poisson, **law):
        self.shear, self.bulk = young / 2 / (1 + poisson), young / 3 / (1 - 2 * poisson)
        self.law, self.plastic, self.a = law, np.zeros((3, 3)), 0.0

    def Yield(self, a):
        law = self.law
        voce = law.get("saturation", 0) * (1 - math.exp(-law.get("rate", 0) * a))
        return law["yield_stress"] + law.get("hardening", 0) * a + voce

    def Step(self, strain):
        deviator = strain - np.trace(strain) / 3 * np.eye(3)
        trial = 2 * self.shear * (deviator - self.plastic)
        mises = math.sqrt(1.5 * np.sum(trial**2))
        low, high = 0.0, mises / self.shear
        if mises <= self.Yield(self.a):
            high = 0.0
        for _ in range(200):
            b = (low + high) / 2
            if mises - 3 * self.shear * b > self.Yield(self.a + b):
                low = b
            else:
                high = b
        flow = 1.5 * low / max(mises, 1e-300) * trial
        self.plastic, self.a = self.plastic + flow, self.a + low
        return self.bulk * np.trace(strain) * np.eye(3) + trial - 2 * self.shear * flow


@pytest.mark.parametrize("law", MATERIALS)
def test_stress_state_and_energy_of_the_law(law):
    elastic = {"young": 70e3, "poisson": 0.3}
    mesh = MakeStructured2DMesh(quads=False, nx=1, ny=1)
    material = J2Plasticity(mesh, **elastic, **law)
    exact = ReturnMap(**elastic, **law)
    values = [Parameter(0.0) for _ in range(9)]
    strain = CF(tuple(values), dims=(3, 3))
    stress, energy = material.Stress(strain), material.Energy(strain)
    area = material.Integral(CF(1))

    def Set(matrix):
        for value, entry in zip(values, matrix.ravel(), strict=True):
            value.Set(float(entry))

    for matrix in path():
        direction = np.array([[1.0, 0.3, 0], [0.3, -0.4, 0], [0, 0, 0.5]])
        size = 1e-6
        around = []
        for sign in (-1, 1):
            Set(matrix + sign * size * direction)
            around.append(material.Integral(energy) / area)
        Set(matrix)
        computed = [[material.Integral(stress[i, j]) / area for j in range(3)] for i in range(3)]
        expected = exact.Step(matrix)
        np.testing.assert_allclose(computed, expected, rtol=1e-9, atol=1e-6)
        slope = (around[1] - around[0]) / (2 * size)
        assert slope == pytest.approx(np.sum(expected * direction), rel=1e-6, abs=1e-4)
        material.Commit(strain)
        state = material.state.vec.FV().NumPy().reshape(5, -1)
        wanted = [exact.plastic[0, 0], exact.plastic[1, 1], exact.plastic[2, 2]]
        wanted += [exact.plastic[0, 1], exact.a]
        np.testing.assert_allclose(state, np.outer(wanted, np.ones(state.shape[1])), atol=1e-12)
    assert exact.a > 1e-3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"yield_stress": -1.0}, "must be positive"),
        ({"poisson": 0.5}, "poisson"),
        ({"hardening": -1.0}, "must not be negative"),
    ],
)
def test_bad_constants(options, message):
    constants = {"young": 70e3, "poisson": 0.3, "yield_stress": 35.0} | options
    with pytest.raises(ValueError, match=message):
        J2Plasticity(MakeStructured2DMesh(nx=1, ny=1), **constants)
