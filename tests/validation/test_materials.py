"""Rubber and thermal strain under contact: what the rows of the cases do not say.

The materials are forms of NGSolve; the contact knows nothing of them.
"""

from functools import lru_cache
from itertools import pairwise

import heateddisc
import hertz_large
import numpy as np
import pytest
from elasticity import Displacements, Material, Pair
from ngsolve import Det, Grad, Id, Integrate, Trace, dx

from ngslac.meshes import TwoBlocks


@lru_cache
def Squeezed(depth=0.25, h=0.08, steps=5, nu=0.4999, mixed=True, **options):
    """A cord of nearly incompressible rubber, squeezed by a quarter of its diameter."""
    return hertz_large.Run(h, depth=depth, steps=steps, nu=nu, mixed=mixed, **options)


def Peak(figures):
    return figures["solution"].contact.Table()["pressure"].max()


def test_small_squeeze_of_an_incompressible_cord():
    """Johnson 1985, equation 5.57: half a percent of the diameter."""
    force = Squeezed(0.005, 0.02, 1)["force"][-1]
    assert force == pytest.approx(hertz_large.HertzForce(0.005, 0.5), rel=5e-3)


def test_large_squeeze_converges_and_the_mixed_form_does_not_lock():
    """Linear displacements alone lock: the pressure of the contact is off by tens of percent."""
    squeezed, locking, exact = (
        Squeezed(**options)
        for options in (
            {},
            {"order": 1, "mixed": False, "steps": 8},
            {"h": 0.05, "order": 3, "steps": 3},
        )
    )
    forces = [figures["force"][-1] for figures in (squeezed, locking, exact)]
    assert forces[0] == pytest.approx(forces[2], rel=4e-3)
    assert Peak(squeezed) == pytest.approx(Peak(exact), rel=0.02)
    assert abs(Peak(locking) / Peak(exact) - 1) > 0.15
    assert forces[1] / forces[2] - 1 > 0.02
    # Large strains make it stiffer than the small ones say.
    assert 1.1 < forces[2] / hertz_large.HertzForce(0.25, 0.5) < 1.3


def test_rubber_keeps_its_volume_and_converges_quadratically():
    figures = Squeezed()
    gf, solver = figures["solution"].gf, figures["solution"].solver
    residuals = [entry.equilibrium for entry in solver.history]
    volume = Integrate(Det(Grad(gf.components[0]) + Id(2)), gf.space.mesh, order=6)
    assert abs(volume / Integrate(1, gf.space.mesh) - 1) < 2e-4
    assert not figures["cuts"].any()
    assert residuals[-1] < 1e-10
    fast = [b for a, b in pairwise(residuals) if a < 0.1]
    assert any(b < 1e-2 * a for a, b in pairwise(fast))
    assert len(residuals) - 1 <= 7


def test_pressure_in_the_rubber_meets_the_contact():
    """Under the plate's middle the hydrostatic pressure is of the size of the contact pressure.

    The Cauchy stress normal to the plate is the deviatoric part less the hydrostatic pressure.
    """
    solution = Squeezed()["solution"]
    moved, hydrostatic, _ = solution.gf.components
    F = Grad(moved) + Id(2)
    B, J, shear = F * F.trans, Det(F), hertz_large.YOUNG / (2 * 1.4999)
    normal = shear * J ** (-5 / 3) * (B[1, 1] - (Trace(B) + 1) / 3) - hydrostatic
    table = solution.contact.Table()
    first = np.argsort(table["x"][:, 0])[0]
    computed = -normal(moved.space.mesh(0.01, 0.002))
    assert computed == pytest.approx(table["pressure"][first], rel=0.1)


# ---------------------------------------------------------------- thermal strain


def test_heated_disc_in_a_ring_converges_to_lame():
    errors = []
    for h in (12.0, 6.0, 3.0):
        figures = heateddisc.Run(h=h)
        errors.append(abs(figures["pressure"] / figures["lame"] - 1))
        assert figures["spread"] < 0.01 * figures["lame"]
        assert figures["newton_iterations"] <= 4
    assert errors[1] < 0.5 * errors[0]
    assert errors[2] < 3e-4


def test_disc_that_is_not_hot_enough_does_not_touch():
    assert heateddisc.LamePressure(heating=1e-5, clearance=1e-3) == 0
    figures = heateddisc.Run(h=3.0, heating=1e-5)
    assert figures["pressure"] == 0
    gap = figures["solution"].Table()["gap"]
    np.testing.assert_allclose(gap, 1e-3 - 50 * 1.3 * 1e-5, rtol=0.02)


def test_slave_and_master_meshes_differ():
    mesh = heateddisc.Run(h=12.0)["solution"].mesh
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
