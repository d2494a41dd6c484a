"""Materials under contact, each with a number from elsewhere: large strains, rubber, heat.

The materials are forms of NGSolve; the contact knows nothing of them. Plasticity:
tests/examples/test_example_indentation.py.
"""

from itertools import pairwise

import numpy as np
import pytest
from materials import Rubber, SqueezeForce, Thermal, ThermalPressure
from ngsolve import (
    CF,
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Parameter,
    Sym,
    Trace,
    Variation,
    VectorH1,
    dx,
    log,
)
from scipy.optimize import brentq

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import Stress
from ngslac.meshes import TwoBlocks

# ---------------------------------------------------------------- hyperelasticity

STIFF, SOFT = (40.0, 60.0), (15.0, 30.0)  # shear modulus and Lame's constant: upper, lower block


def nominal_stress(stretch, shear, lame):
    """Of the compressible neo-Hooke material in uniaxial strain, per reference area."""
    return shear * (stretch - 1 / stretch) + lame * np.log(stretch) / stretch


def squeezed_blocks(finite):
    """Two blocks between walls, pressed by 0.6: displacement and contact."""
    mesh = TwoBlocks(0.34, structured=True)
    walls = "left_upper|right_upper|left_lower|right_lower|top|bottom"
    V = VectorH1(mesh, order=2, dirichletx=walls, dirichlety="top|bottom")
    X = V * LACSpace(V, slave="slave")
    (u, lam), _ = X.TnT()
    both = zip(STIFF, SOFT, strict=True)
    shear, lame = (mesh.MaterialCF({"upper": up, "lower": low}) for up, low in both)
    F = Grad(u) + Id(2)
    J = Det(F)
    energy = shear / 2 * (Trace(F.trans * F) - 2 - 2 * log(J)) + lame / 2 * log(J) ** 2
    a = BilinearForm(X)
    a += Variation(energy * dx)
    contact = LACContact(u, lam, master="master", finite=finite)
    gf, load = GridFunction(X), Parameter(0.0)
    prescribe = {"top": CF((0, -0.6 * load))}
    stepper = LoadStepper(ContactSolver(a, gf, contact), load, prescribe=prescribe)
    stepper.Integrate(steps=3, printing=False)
    return gf.components[0], contact


def squeezed_stretch():
    """The stretch of the upper block, from one scalar equation."""

    def difference(stretch):
        return nominal_stress(stretch, *STIFF) - nominal_stress(1.4 - stretch, *SOFT)

    return brentq(difference, 0.5, 0.95, xtol=1e-15)


@pytest.mark.parametrize("finite", [False, True])
def test_two_hyperelastic_blocks_in_series(finite):
    """Uniaxial strain: the stretches are right to rounding."""
    gf, contact = squeezed_blocks(finite)
    stretch = squeezed_stretch()
    pressure = contact.Table()["pressure"]
    np.testing.assert_allclose(pressure, -nominal_stress(stretch, *STIFF), rtol=1e-9)
    middle = gf(contact.mesh(0.31, 0.5))[1]
    assert middle == pytest.approx(-0.6 + 0.5 * (1 - stretch), abs=1e-10)


# ---------------------------------------------------------------- rubber


@pytest.fixture(scope="module")
def squeezed():
    """The cord at a quarter of its diameter."""
    return Rubber()


@pytest.fixture(scope="module")
def converged():
    """The same with displacements of order 3 and a finer mesh."""
    return Rubber(h=2.5, order=3, steps=3)


def test_small_squeeze_of_an_incompressible_cord():
    """Johnson 1985, equation 5.57: half a percent of the diameter."""
    result = Rubber(h=1.0, squeeze=0.005, steps=1)
    assert result.figures["force"] == pytest.approx(SqueezeForce(0.005), rel=5e-3)


def test_large_squeeze_converges(squeezed, converged):
    assert squeezed.figures["force"] == pytest.approx(converged.figures["force"], rel=4e-3)
    pressure = converged.figures["peak_pressure"]
    assert squeezed.figures["peak_pressure"] == pytest.approx(pressure, rel=0.02)
    # Large strains make it stiffer than the small ones say.
    assert 1.1 < converged.figures["force"] / SqueezeForce(0.25) < 1.3


def test_rubber_keeps_its_volume(squeezed):
    assert abs(squeezed.figures["volume_change"]) < 2e-4


def test_rubber_converges_quadratically(squeezed):
    residuals = squeezed.figures["last_residuals"]
    assert squeezed.figures["cuts"] == 0
    assert residuals[-1] < 1e-10
    fast = [b for a, b in pairwise(residuals) if a < 0.1]
    assert any(b < 1e-2 * a for a, b in pairwise(fast))
    assert squeezed.figures["newton_iterations"][-1] <= 7


def test_mixed_form_does_not_lock(squeezed, converged):
    """Linear displacements alone lock: the pressure of the contact is off by tens of percent."""
    locking = Rubber(order=1, mixed=False, steps=8)
    exact = converged.figures["peak_pressure"]
    errors = [abs(r.figures["peak_pressure"] / exact - 1) for r in (squeezed, locking)]
    assert errors[0] < 0.02
    assert errors[1] > 0.15
    forces = [r.figures["force"] / converged.figures["force"] - 1 for r in (squeezed, locking)]
    assert abs(forces[0]) < 4e-3
    assert forces[1] > 0.02


def test_pressure_in_the_rubber_meets_the_contact(squeezed):
    """Under the plate's middle the hydrostatic pressure is of the size of the contact pressure.

    The Cauchy stress normal to the plate is the deviatoric part less the hydrostatic pressure.
    """
    mesh, gf = squeezed.contact.mesh, squeezed.displacement
    F = Grad(gf) + Id(2)
    B, J = F * F.trans, Det(F)
    deviatoric = B[1, 1] - (Trace(B) + 1) / 3
    normal = J ** (-5 / 3) * deviatoric - squeezed.field
    table = squeezed.contact.Table()
    first = np.argsort(table["x"][:, 0])[0]
    computed = -normal(mesh(0.5, 49.9))
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
    young, poisson, opening = (200.0, 70.0), 0.3, 0.01
    mesh = TwoBlocks(0.34, structured=True)
    V = VectorH1(mesh, order=2, dirichletx="left_upper|left_lower", dirichlety="top|bottom")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    modulus = mesh.MaterialCF({"upper": young[0], "lower": young[1]})
    hot = mesh.MaterialCF({"upper": heating}, default=0)
    stress = Stress(Sym(Grad(u)), modulus, poisson)
    stress -= modulus * hot / (1 - 2 * poisson) * Id(2)  # held out of the plane, too
    a = BilinearForm(X)
    a += InnerProduct(stress, Sym(Grad(v))) * dx
    gf = GridFunction(X)
    # The walls pull the bars apart by the opening.
    gf.components[0].Set((0, opening), definedon=mesh.Boundaries("top"))
    contact = LACContact(u, lam, master="master")
    ContactSolver(a, gf, contact).Solve(printing=False)
    free = (1 + poisson) * heating  # of a bar of length 1 in plane strain
    compliance = (1 - poisson**2) * sum(1 / E for E in young)
    expected = max(0.0, (free - opening) / compliance)
    assert (expected > 0) == touches
    np.testing.assert_allclose(contact.Table()["pressure"], expected, rtol=1e-9, atol=1e-12)
    if not touches:
        np.testing.assert_allclose(contact.Table()["gap"], opening - free, rtol=1e-9)
