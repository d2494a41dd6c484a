"""TimeStepper: exact motions, impact, friction, energy."""

import numpy as np
import pytest
from motions import bar, moving, neo_hooke, on_ground, shaken, sliding, two_bars, values
from ngsolve import CF, H1, GridFunction, TaskManager, VectorH1, ds, sin
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh


@pytest.mark.parametrize("rho_inf", [0.0, 0.6, 1.0])
@pytest.mark.parametrize("condense", [False, True])
def test_free_fall_is_exact(rho_inf, condense):
    flags = {"rho_inf": rho_inf, "condense": condense, "order": 3}
    motion = on_ground(gap=10.0, gravity=3.0, dt=0.1, **flags).throw(0.5, 1.0)
    motion.run(1.0)
    expected = GridFunction(motion.gf.components[0].space)
    for gf, value, rounding in (
        (motion.gf, 1.0 - 1.5, 1e-12),
        (motion.stepper.velocity, 1.0 - 3.0, 1e-11),
    ):
        expected.Set((0.5, value))
        assert values(gf.components[0]) == pytest.approx(values(expected), abs=rounding)
    balance = motion.stepper.balance
    assert balance.external == pytest.approx(-3.0 * (1.0 - 1.5))
    assert [balance.internal, balance.friction, balance.impact] == pytest.approx([0] * 3, abs=1e-11)


def test_long_steps_of_a_stiff_body():
    """A body without supports, in steps of many thousands of the times waves need through it."""
    motion = on_ground(gap=1.0, gravity=10.0, modulus=1e12, dt=0.05).throw(0.2, 0.4)
    motion.run(0.1)
    assert motion.mean() == pytest.approx((0.02, 0.04 - 0.05), abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "rho_inf"), [(None, 1.0), (0.8, 0.5)])
def test_second_order_in_time_with_contact(friction, rho_inf):
    """Displacements at the ends of the steps, and the contact force in the middle of them."""
    fine = shaken(160, friction=friction, rho_inf=rho_inf)
    time, force = np.array(fine.record).T[:2]
    errors = []
    for n in (20, 40):
        coarse = shaken(n, friction=friction, rho_inf=rho_inf)
        at, mean = np.array(coarse.record).T[:2]
        middle = np.interp(at - 0.5 / n, time - 0.5 / 160, force)
        error = np.array(coarse.path) - np.array(fine.path)[160 // n - 1 :: 160 // n]
        errors.append((np.abs(error).max(), np.abs(mean - middle)[at > 0.2].max()))
        assert np.all(coarse.contact.Table()["status"] > 0)
    assert np.all(np.log2(np.divide(*errors)) > 1.8), errors


@pytest.mark.parametrize(("rho_inf", "order"), [(1.0, 2), (1.0, 1), (0.5, 2)])
def test_impact_of_a_bar_on_a_wall(rho_inf, order):
    """Exact: pressure density * c * v = 1 from t = 0.1 to 2.1, then back with velocity 1."""
    n, dt = 20, 0.025
    motion = bar(rho_inf=rho_inf, dt=dt, order=order, n=n)
    time, pressure, energy, _ = motion.run(2.6)
    closed = time[pressure > 0]
    assert closed[0] == pytest.approx(0.1, abs=1.5 * dt)
    assert closed[-1] == pytest.approx(2.1, abs=1 / n + dt)  # a wave passes one element
    assert len(closed) == np.ptp(np.flatnonzero(pressure > 0)) + 1  # it does not bounce in between
    during = pressure[(time > 0.3) & (time < 1.9)]
    assert during.mean() == pytest.approx(1.0, abs=2e-3 if order == 2 else 5e-3)
    assert during.std() < 0.05
    assert motion.mean(motion.stepper.velocity)[1] == pytest.approx(0.98, abs=0.02)
    # Exact: no energy is lost. The layer of elements at the wall loses its own.
    assert 0.49 * (0.98 if rho_inf < 1 else 1) < energy[-1] < 0.5
    gain = np.diff([0.5, *energy]).max()
    assert gain < (1e-13 if rho_inf == 1 else 1e-4)


def test_loss_at_impact_vanishes_with_the_mesh():
    lost = []
    for n in (10, 20, 40):
        motion = bar(n=n, dt=0.5 / n)
        motion.run(0.3)
        lost.append(motion.stepper.balance.impact)
    assert np.array(lost[:-1]) / lost[1:] == pytest.approx(2.0, rel=0.15)


@pytest.mark.parametrize("finite", [False, True])
def test_two_bars_exchange_their_velocities(finite):
    """Momentum is exact also where the surfaces are paired anew in each iterate."""
    motion = two_bars(dt=0.025, finite=finite)
    time, pressure, energy, _ = motion.run(0.6 if finite else 2.6)
    during = pressure[(time > 0.3) & (time < 1.8)]
    assert during.mean() == pytest.approx(0.5, rel=0.05 if finite else 0.02)
    velocity, table = motion.stepper.velocity, motion.stepper.Table()
    assert motion.mean(velocity)[1] == pytest.approx(-0.5, abs=1e-12)
    assert np.diff(table["friction"] + table["impact"]).min() > -1e-4
    assert table["algorithmic"] == pytest.approx(0, abs=1e-12)
    if not finite:
        assert motion.mean(velocity, "upper")[1] == pytest.approx(0, abs=0.03)
        assert motion.mean(velocity, "lower")[1] == pytest.approx(-1, abs=0.03)
        assert np.diff([0.5, *energy]).max() < 1e-13


def check_losses(table, rounding=1e-12):
    """Nothing but friction and impact takes energy, and nothing gives any."""
    mechanical = table["kinetic"] + table["internal"] - table["external"]
    assert np.diff(mechanical).max() < rounding
    assert np.diff(table["friction"]).min() > -1e-14
    assert table["friction"][-1] > 1e-3
    assert table["algorithmic"] == pytest.approx(0, abs=rounding)


def test_a_sliding_block_stops():
    """Stop distance v^2 / (2 F g), all energy lost to friction."""
    motion = sliding(dt=0.05)
    time, force, energy, tangential = motion.run(4.0)
    assert motion.mean()[0] == pytest.approx(1 / 0.6, rel=2e-4)
    assert motion.stepper.balance.friction == pytest.approx(0.05, rel=1e-3)
    assert np.diff(energy).max() < 1e-14
    slides = time < 3.2
    assert -tangential[slides] == pytest.approx(0.3 * force[slides], rel=1e-9)
    assert np.all(motion.contact.Table()["status"] == 1)
    check_losses(motion.stepper.Table(), 1e-13)


def test_impulses_of_friction_and_pressure():
    """A block that slips all the time loses friction times what it gains upwards."""
    flags = {"friction": 0.2, "modulus": 5.0, "dt": 0.02}
    motion = on_ground(size=(1.0, 0.5), divisions=(4, 2), gap=0.03, **flags).throw(3.0, -0.7)
    motion.run(1.5)
    velocity = motion.mean(motion.stepper.velocity)
    assert velocity[1] == pytest.approx(0.65, abs=0.02)
    assert (3.0 - velocity[0]) / (velocity[1] + 0.7) == pytest.approx(0.2, rel=0.03)
    assert motion.stepper.balance.friction > 0.3
    check_losses(motion.stepper.Table())


def test_an_oblique_throw_with_friction_gains_nothing():
    flags = {"gravity": 1.0, "friction": 0.4, "modulus": 5.0, "dt": 0.02}
    motion = on_ground(divisions=(4, 4), gap=0.03, **flags).throw(1.0, -0.7)
    motion.run(1.5)
    assert motion.stepper.balance.friction > 0.01
    check_losses(motion.stepper.Table())


def test_friction_keeps_the_direction_of_a_cube_thrown_askew():
    mesh = MakeStructured3DMesh(hexes=True, nx=2, ny=2, nz=1)
    motion = moving(mesh, gap=0.02, law={"friction": 0.2}, modulus=4.0, dt=0.05)
    motion.throw(0.3, 0.2, -0.5)
    with TaskManager():
        motion.stepper.Integrate(0.4, printing=False)
    speed = motion.mean(motion.stepper.velocity)
    assert motion.contact.Force()[2] > 0
    assert speed[0] / speed[1] == pytest.approx(1.5, rel=0.01)
    assert speed[0] < 0.29
    check_losses(motion.stepper.Table(), 1e-14)


@pytest.mark.parametrize("space", [VectorH1, lambda mesh, **flags: H1(mesh, dim=2, **flags)])
def test_balance_in_spaces_with_and_without_blocks(space):
    mesh = MakeStructured2DMesh(quads=True, nx=2, ny=2)
    flags = {"gap": 0.05, "law": {"friction": 0.2}, "dt": 0.05, "rho_inf": 0.7}
    motion = moving(mesh, space=space, **flags).throw(0.3, -0.5)
    motion.run(0.3)
    balance = motion.stepper.balance
    assert balance.total + balance.friction + balance.impact == pytest.approx(0.17, rel=1e-3)
    assert balance.friction > 1e-3


def test_balance_with_supports_and_loads_that_move():
    """Work of what is prescribed: the algorithm itself neither takes nor gives."""

    def load(u, v, t):
        return -0.2 * sin(7 * t) * v[0] * ds("right")

    flags = {"modulus": 10.0, "flags": {"dirichlet": "top"}}
    motion = on_ground(gap=0.02, dt=0.05, load=load, **flags)
    motion.stepper.prescribe = {"top": motion.time**2 * CF((0.05, -0.1))}
    motion.run(1.0)
    table = motion.stepper.Table()
    assert table["algorithmic"] == pytest.approx(0, abs=1e-12)
    assert abs(table["external"][-1]) > 0.01
    assert motion.contact.Force()[1] > 0


@pytest.mark.parametrize("rho_inf", [0.5, 1.0])
def test_a_support_that_starts_with_a_jump(rho_inf):
    """Its velocity does not swing, and the force to move a body at constant speed ends at 0."""
    motion = on_ground(gap=10.0, modulus=5.0, dt=0.05, flags={"dirichlet": "top"}, rho_inf=rho_inf)
    velocity = motion.stepper.velocity.components[0]
    motion.stepper.prescribe = {"top": CF((0.3 * motion.time, 0))}
    speeds = []
    motion.run(0.5, callback=lambda step: speeds.append(velocity(motion.mesh(0.4, 1.0))[0]))
    assert speeds[1:] == pytest.approx([0.3] * 9)
    assert motion.stepper.Table()["algorithmic"][-1] == pytest.approx(0, abs=0.02 * 0.045)


def test_fast_oscillations_die_out():
    """One step reduces what is much faster than it by rho_inf; the kinetic energy by its square."""
    left = {}
    for rho_inf in (0.0, 0.5, 1.0):
        motion = on_ground(gap=10.0, modulus=1e8, dt=0.1, rho_inf=rho_inf)
        rough = motion.stepper.velocity.components[0].vec.FV().NumPy()
        rough[:] = np.random.default_rng(3).normal(size=len(rough))
        energy = motion.run(2.0)[2]
        left[rho_inf] = energy[-1] / energy[0]
    assert left[1.0] == pytest.approx(1.0, rel=1e-6)
    assert left[0.5] < left[1.0]
    assert left[0.0] < 1.0


def test_newton_is_quadratic():
    motion = on_ground(gap=0.02, dt=0.02, nonlinear=True, friction=0.3).throw(0.5, -0.5)
    merits = []

    def callback(step):
        history = motion.stepper.solver.history
        merits.append([np.hypot(h.equilibrium, h.constraint) for h in history])

    motion.run(0.2, callback=callback, tol=1e-12)
    assert motion.contact.Force()[1] > 0
    for merit in merits:
        assert len(merit) < 3 or merit[-1] < max(1e-12, 100 * merit[-2] ** 2)
    assert max(map(len, merits)) < 9


def test_energy_of_a_nonlinear_bulk_can_be_given():
    motion = on_ground(gap=0.05, dt=0.02, nonlinear=True, rho_inf=0.8).throw(0, -0.5)
    motion.stepper.energy = neo_hooke(motion.gf.components[0])
    motion.run(1.0)
    table = motion.stepper.Table()
    assert 0 < table["internal"].max() < 0.125
    assert abs(table["algorithmic"][-1]) < 0.01 * 0.125
