"""TimeStepper: exact motions, impact, friction, energy."""

import numpy as np
import pytest
from motions import bar, elastic, neo_hooke, on_ground, shaken, sliding, two_bars, values
from ngsolve import (
    CF,
    BilinearForm,
    GridFunction,
    Integrate,
    TaskManager,
    VectorH1,
    ds,
    sin,
)
from ngsolve.meshes import MakeStructured3DMesh

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.steps.time import TimeStepper


@pytest.mark.parametrize("rho_inf", [0.0, 0.6, 1.0])
@pytest.mark.parametrize("condense", [False, True])
def test_free_fall_is_exact(rho_inf, condense):
    motion = on_ground(gap=10.0, gravity=3.0, dt=0.1, rho_inf=rho_inf, condense=condense, order=3)
    motion.throw(0.5, 1.0).run(1.0)
    u, v = (gf.components[0] for gf in (motion.gf, motion.stepper.velocity))
    expected = GridFunction(u.space)
    expected.Set((0.5, 1.0 - 1.5))
    assert values(u) == pytest.approx(values(expected), abs=1e-12)
    expected.Set((0.5, 1.0 - 3.0))
    assert values(v) == pytest.approx(values(expected), abs=1e-11)
    balance = motion.stepper.balance
    assert balance.external == pytest.approx(-3.0 * (1.0 - 1.5))
    assert [balance.internal, balance.friction, balance.impact] == pytest.approx([0] * 3, abs=1e-11)


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


@pytest.mark.parametrize(
    ("rho_inf", "dt", "order", "n"),
    [(1.0, 0.025, 2, 20), (1.0, 0.025, 1, 20), (0.5, 0.025, 2, 20)],
)
def test_impact_of_a_bar_on_a_wall(rho_inf, dt, order, n):
    """Exact: pressure density * c * v = 1 from t = 0.1 to 2.1, then back with velocity 1."""
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


def test_two_bars_exchange_their_velocities():
    motion = two_bars(dt=0.025)
    time, pressure, energy, _ = motion.run(2.6)
    during = pressure[(time > 0.3) & (time < 1.8)]
    assert during.mean() == pytest.approx(0.5, rel=0.02)
    velocity = motion.stepper.velocity
    assert motion.mean(velocity, "upper")[1] == pytest.approx(0, abs=0.03)
    assert motion.mean(velocity, "lower")[1] == pytest.approx(-1, abs=0.03)
    assert motion.mean(velocity)[1] == pytest.approx(-0.5, abs=1e-12)
    assert np.diff([0.5, *energy]).max() < 1e-13


def test_two_bars_with_finite_sliding():
    """Momentum is exact also where the surfaces are paired anew in each iterate."""
    motion = two_bars(dt=0.025, finite=True)
    time, pressure, *_ = motion.run(0.6)
    assert pressure[time > 0.3].mean() == pytest.approx(0.5, rel=0.05)
    assert motion.mean(motion.stepper.velocity)[1] == pytest.approx(-0.5, abs=1e-12)
    table = motion.stepper.Table()
    assert np.diff(table["friction"] + table["impact"]).min() > -1e-4
    assert table["algorithmic"] == pytest.approx(0, abs=1e-12)


def test_a_sliding_block_stops():
    """Stop distance v^2 / (2 F g), all energy lost to friction."""
    motion = sliding(dt=0.05)
    time, force, energy, tangential = motion.run(4.0)
    assert motion.mean()[0] == pytest.approx(1 / 0.6, rel=2e-4)
    assert motion.stepper.balance.friction == pytest.approx(0.05, rel=1e-3)
    table = motion.stepper.Table()
    assert np.all(np.diff(table["friction"]) >= -1e-15)
    assert np.diff(energy).max() < 1e-14
    slides = time < 3.2
    assert -tangential[slides] == pytest.approx(0.3 * force[slides], rel=1e-9)
    assert np.all(motion.contact.Table()["status"] == 1)
    assert table["algorithmic"] == pytest.approx(0, abs=1e-13)


def test_impulses_of_friction_and_pressure():
    """A block that slips all the time loses friction times what it gains upwards."""
    motion = on_ground(
        size=(1.0, 0.5), divisions=(4, 2), gap=0.03, friction=0.2, modulus=5.0, dt=0.02
    ).throw(3.0, -0.7)
    motion.run(1.5)
    velocity = motion.mean(motion.stepper.velocity)
    assert velocity[1] == pytest.approx(0.65, abs=0.02)
    assert (3.0 - velocity[0]) / (velocity[1] + 0.7) == pytest.approx(0.2, rel=0.03)
    assert motion.stepper.balance.friction > 0.3


def test_an_oblique_throw_with_friction_gains_nothing():
    motion = on_ground(
        divisions=(4, 4), gap=0.03, gravity=1.0, friction=0.4, modulus=5.0, dt=0.02
    ).throw(1.0, -0.7)
    motion.run(1.5)
    table = motion.stepper.Table()
    mechanical = table["kinetic"] + table["internal"] - table["external"]
    assert np.diff(mechanical).max() < 1e-12
    assert table["friction"][-1] > 0.01
    assert np.all(np.diff(table["friction"]) > -1e-14)
    assert table["algorithmic"] == pytest.approx(0, abs=1e-12)


def test_balance_with_supports_and_loads_that_move():
    """Work of what is prescribed: the algorithm itself neither takes nor gives."""
    motion = on_ground(
        gap=0.02,
        dt=0.05,
        modulus=10.0,
        flags={"dirichlet": "top"},
        load=lambda u, v, t: -0.2 * sin(7 * t) * v[0] * ds("right"),
    )
    stepper, t = motion.stepper, motion.time
    stepper.prescribe = {"top": CF((0.05 * t**2, -0.1 * t**2))}
    motion.run(1.0)
    table = stepper.Table()
    assert table["algorithmic"] == pytest.approx(0, abs=1e-12)
    assert abs(table["external"][-1]) > 0.01
    assert motion.contact.Force()[1] > 0


@pytest.mark.parametrize("rho_inf", [0.5, 1.0])
def test_a_support_that_starts_with_a_jump(rho_inf):
    """Its velocity does not swing, and the force to move a body at constant speed ends at 0."""
    motion = on_ground(gap=10.0, modulus=5.0, dt=0.05, flags={"dirichlet": "top"}, rho_inf=rho_inf)
    motion.stepper.prescribe = {"top": CF((0.3 * motion.time, 0))}
    speeds = []

    def callback(step):
        speeds.append(motion.stepper.velocity.components[0](motion.mesh(0.4, 1.0))[0])

    motion.run(0.5, callback=callback)
    assert speeds[1:] == pytest.approx([0.3] * 9)
    assert motion.stepper.Table()["algorithmic"][-1] == pytest.approx(0, abs=0.02 * 0.045)


def test_fast_oscillations_die_out():
    """One step reduces what is much faster than it by rho_inf; the kinetic energy by its square."""
    energies = {}
    for rho_inf in (0.0, 0.5, 1.0):
        motion = on_ground(gap=10.0, modulus=1e8, dt=0.1, rho_inf=rho_inf)
        motion.throw(where=CF((0, 0)))
        V = motion.gf.components[0].space
        rough = np.random.default_rng(3).normal(size=V.ndof)
        motion.stepper.velocity.components[0].vec.FV().NumPy()[:] = rough
        motion.run(2.0)
        energies[rho_inf] = [0.0, *np.array(motion.record).T[2]]
    elastic_part = {k: v[-1] / v[1] for k, v in energies.items()}
    assert elastic_part[1.0] == pytest.approx(1.0, rel=1e-6)
    assert elastic_part[0.5] < elastic_part[1.0]
    assert elastic_part[0.0] < 1.0


def test_newton_is_quadratic():
    motion = on_ground(gap=0.02, dt=0.02, nonlinear=True, friction=0.3).throw(0.5, -0.5)
    worst = []

    def callback(step):
        history = motion.stepper.solver.history
        merit = [np.hypot(h.equilibrium, h.constraint) for h in history]
        worst.append(merit)

    motion.stepper.Integrate(0.2, printing=False, callback=callback, tol=1e-12)
    assert motion.contact.Force()[1] > 0
    for merit in worst:
        assert len(merit) < 3 or merit[-1] < max(1e-12, 100 * merit[-2] ** 2)
    assert max(map(len, worst)) < 9


def test_energy_of_a_nonlinear_bulk_can_be_given():
    motion = on_ground(gap=0.05, dt=0.02, nonlinear=True, rho_inf=0.8).throw(0, -0.5)
    motion.stepper.energy = neo_hooke(motion.gf.components[0])
    motion.run(1.0)
    table = motion.stepper.Table()
    assert 0 < table["internal"].max() < 0.125
    assert abs(table["algorithmic"][-1]) < 0.01 * 0.125


def test_long_steps_of_a_stiff_body():
    """A body without supports, in steps of many thousands of the times waves need through it."""
    motion = on_ground(gap=1.0, gravity=10.0, modulus=1e12, dt=0.05).throw(0.2, 0.4)
    motion.run(0.1)
    assert motion.mean() == pytest.approx((0.02, 0.04 - 0.05), abs=1e-6)


def test_three_dimensions():
    """A cube thrown askew: friction keeps the direction of the motion."""
    mesh = MakeStructured3DMesh(hexes=True, nx=2, ny=2, nz=1)
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="bottom")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(elastic(u, v, 4.0))
    contact = LACContact(u, lam, obstacle=CF(0.02), friction=0.2)
    stepper = TimeStepper(ContactSolver(a, GridFunction(X), contact), 1.0, dt=0.05)
    stepper.velocity.components[0].Set((0.3, 0.2, -0.5))
    with TaskManager():
        stepper.Integrate(0.4, printing=False)
    speed = Integrate(stepper.velocity.components[0], mesh)
    table = stepper.Table()
    assert contact.Force()[2] > 0
    assert speed[0] / speed[1] == pytest.approx(1.5, rel=0.01)
    assert speed[0] < 0.29
    assert np.diff(table["kinetic"] + table["internal"]).max() < 1e-14
