"""Rubber and thermal strain under contact: what the rows of the cases do not say.

The materials are forms of NGSolve; the contact knows nothing of them.
"""

from functools import lru_cache
from itertools import pairwise

import numpy as np
import pytest
from elasticity import Displacements, Material, Pair
from materials import Rubber, SqueezeForce, Thermal, ThermalPressure
from ngsolve import Det, Grad, Id, Trace, dx

from ngslac.meshes import TwoBlocks


@lru_cache
def Squeezed(**options):
    """The cord at a quarter of its diameter."""
    return Rubber(**options)


def test_small_squeeze_of_an_incompressible_cord():
    """Johnson 1985, equation 5.57: half a percent of the diameter."""
    result = Rubber(h=1.0, squeeze=0.005, steps=1)
    assert result.figures["force"] == pytest.approx(SqueezeForce(0.005), rel=5e-3)


def test_large_squeeze_converges_and_the_mixed_form_does_not_lock():
    """Linear displacements alone lock: the pressure of the contact is off by tens of percent."""
    squeezed, locking, exact = (
        Squeezed(**options).figures
        for options in (
            {},
            {"order": 1, "mixed": False, "steps": 8},
            {"h": 2.5, "order": 3, "steps": 3},
        )
    )
    assert squeezed["force"] == pytest.approx(exact["force"], rel=4e-3)
    assert squeezed["peak_pressure"] == pytest.approx(exact["peak_pressure"], rel=0.02)
    assert abs(locking["peak_pressure"] / exact["peak_pressure"] - 1) > 0.15
    assert locking["force"] / exact["force"] - 1 > 0.02
    # Large strains make it stiffer than the small ones say.
    assert 1.1 < exact["force"] / SqueezeForce(0.25) < 1.3


def test_rubber_keeps_its_volume_and_converges_quadratically():
    figures = Squeezed().figures
    residuals = figures["last_residuals"]
    assert abs(figures["volume_change"]) < 2e-4
    assert figures["cuts"] == 0
    assert residuals[-1] < 1e-10
    fast = [b for a, b in pairwise(residuals) if a < 0.1]
    assert any(b < 1e-2 * a for a, b in pairwise(fast))
    assert figures["newton_iterations"][-1] <= 7


def test_pressure_in_the_rubber_meets_the_contact():
    """Under the plate's middle the hydrostatic pressure is of the size of the contact pressure.

    The Cauchy stress normal to the plate is the deviatoric part less the hydrostatic pressure.
    """
    squeezed = Squeezed()
    F = Grad(squeezed.displacement) + Id(2)
    B, J = F * F.trans, Det(F)
    normal = J ** (-5 / 3) * (B[1, 1] - (Trace(B) + 1) / 3) - squeezed.field
    table = squeezed.contact.Table()
    first = np.argsort(table["x"][:, 0])[0]
    computed = -normal(squeezed.contact.mesh(0.5, 49.9))
    assert computed == pytest.approx(table["pressure"][first], rel=0.1)


@pytest.mark.parametrize("poisson", [0.5, 0.0])
def test_bad_poisson_ratio(poisson):
    with pytest.raises(ValueError, match="poisson"):
        Rubber(poisson=poisson)


# ---------------------------------------------------------------- thermal strain


def test_heated_disc_in_a_ring_converges_to_lame():
    errors = []
    for h in (12.0, 6.0, 3.0):
        figures = Thermal(h=h).figures
        errors.append(abs(figures["pressure"] / figures["lame"] - 1))
        assert figures["spread"] < 0.01 * figures["lame"]
        assert figures["newton_iterations"] <= 4
    assert errors[1] < 0.5 * errors[0]
    assert errors[2] < 3e-4


def test_disc_that_is_not_hot_enough_does_not_touch():
    assert ThermalPressure(heating=1e-5, clearance=1e-3) == 0
    result = Thermal(h=3.0, heating=1e-5)
    assert result.figures["pressure"] == 0
    gap = result.contact.Table()["gap"]
    np.testing.assert_allclose(gap, 1e-3 - 50 * 1.3 * 1e-5, rtol=0.02)


def test_slave_and_master_meshes_differ():
    mesh = Thermal(h=12.0).contact.mesh
    counts = [sum(1 for _ in mesh.Boundaries(name).Elements()) for name in ("slave", "master")]
    assert counts[1] > 1.2 * counts[0]


@pytest.mark.parametrize(("heating", "touches"), [(0.004, False), (0.02, True)])
def test_heated_bars_between_walls(heating, touches):
    """Two bars with a gap between fixed walls: the hot one grows, then both are compressed."""
    young, nu, opening = (200.0, 70.0), 0.3, 0.01
    mesh = TwoBlocks(0.34, structured=True)
    V = Displacements(mesh, "P2", dirichletx="left_upper|left_lower", dirichlety="top|bottom")
    modulus = mesh.MaterialCF({"upper": young[0], "lower": young[1]})
    pair = Pair(V, Material(young=modulus, nu=nu))
    hot = mesh.MaterialCF({"upper": heating}, default=0)  # held out of the plane, too
    pair.load += modulus * hot / (1 - 2 * nu) * Trace(Grad(pair.v)) * dx
    pair.Hold((0, opening), "top")  # the walls pull the bars apart by the opening
    pair.Solve()
    free = (1 + nu) * heating  # of a bar of length 1 in plane strain
    expected = max(0.0, (free - opening) / ((1 - nu**2) * sum(1 / E for E in young)))
    assert (expected > 0) == touches
    table = pair.contact.Table()
    np.testing.assert_allclose(table["pressure"], expected, rtol=1e-9, atol=1e-12)
    if not touches:
        np.testing.assert_allclose(table["gap"], opening - free, rtol=1e-9)
