"""The flattened cylinder: against Hertz, its energy, and an independent penalty solution."""

import hertz_large
import numpy as np
import pytest
from problems_flattened import EnergyError, Penalty

CONVERGED = 0.6282  # N/mm at the approach 0.3: 0.62828 for h = 0.025, 0.62817 for h = 0.0125


@pytest.fixture(scope="module")
def figures():
    return hertz_large.Run(h=0.1, steps=15)


def test_every_step_converges_in_one_piece(figures):
    assert figures["converged_steps"] == 15
    assert sum(figures["cuts"]) == 0


def test_work_is_the_strain_energy(figures):
    curves = (figures[name] for name in ("approach", "force", "energy"))
    assert abs(EnergyError(*curves)) < 2e-3


def test_final_force(figures):
    assert figures["force"][-1] == pytest.approx(CONVERGED, rel=3e-3)
    assert figures["force"][-1] > 1.2 * figures["hertz"][-1]


def test_no_sideways_force_without_friction(figures):
    """The plate is flat, its normal vertical; that of the faces is as good as the mesh."""
    assert figures["sideways"][-1] < 0.02 * figures["force"][-1]


def test_small_loads_are_those_of_hertz():
    figures = hertz_large.Run(h=0.02, depth=0.02, steps=2)
    assert figures["force"] == pytest.approx(figures["hertz"], rel=0.01)
    halfwidth = 2 * np.sqrt(figures["force"][-1] * (1 - 0.49**2) / np.pi)
    assert figures["halfwidth"][-1] == pytest.approx(halfwidth, abs=0.02)


def test_against_an_independent_solution(figures):
    """The error of the penalty is in proportion to its inverse: extrapolated."""
    soft, stiff = (Penalty(0.1, 0.3, 10, factor) for factor in (200, 800))
    assert stiff + (stiff - soft) / 3 == pytest.approx(figures["force"][-1], rel=4e-3)


def test_friction_stiffens():
    rough = hertz_large.Run(h=0.2, steps=6, friction=0.5)
    smooth = hertz_large.Run(h=0.2, steps=6)
    assert rough["force"][-1] > 1.01 * smooth["force"][-1]
    assert smooth["force"][-1] == pytest.approx(CONVERGED, rel=0.03)


def test_energy_error_of_a_cubic():
    d = np.linspace(0.1, 1, 10)
    assert EnergyError(d, d**3, d**4 / 4) == pytest.approx(0, abs=1e-12)
    assert EnergyError(d, 1.1 * d**3, d**4 / 4) == pytest.approx(0.1, abs=1e-12)
