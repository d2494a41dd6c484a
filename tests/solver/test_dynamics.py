"""TimeStepper: exact motions, impact, friction, energy."""

import numpy as np
import pytest
from motions import bar, moving, on_ground, shaken, sliding, two_bars, values
from ngsolve import CF, H1, GridFunction, ds, sin, x, y
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ngslac.steps.balance import EnergyBalance


@pytest.mark.parametrize("rho_inf", [0.0, 0.6, 1.0])
@pytest.mark.parametrize("condense", [False, True])
def test_free_fall_is_exact(rho_inf, condense):
    flags = {"rho_inf": rho_inf, "condense": condense, "order": 3}
    motion = on_ground(gap=10.0, gravity=3.0, dt=0.1, **flags).throw(0.5, 1.0)
    motion.run(1.0)
    expected = GridFunction(motion.gf.components[0].space)
    for gf, up, rounding in (motion.gf, -0.5, 1e-12), (motion.stepper.velocity, -2.0, 1e-11):
        expected.Set((0.5, up))
        assert values(gf.components[0]) == pytest.approx(values(expected), abs=rounding)
    balance = motion.stepper.balance
    assert balance.external == pytest.approx(-3.0 * -0.5)
    assert [balance.internal, balance.friction, balance.impact] == pytest.approx([0] * 3, abs=1e-11)


def test_long_steps_of_a_stiff_body():
    """A body without supports, in steps of many thousands of the times waves need through it."""
    motion = on_ground(gap=1.0, gravity=10.0, modulus=1e12, dt=0.05).throw(0.2, 0.4)
    motion.run(0.1)
    assert motion.mean() == pytest.approx((0.02, 0.04 - 0.05), abs=1e-6)


@pytest.mark.parametrize(
    ("friction", "rho_inf"), [pytest.param(None, 1.0, marks=pytest.mark.full), (0.8, 0.5)]
)
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
    ("rho_inf", "order"),
    [(1.0, 2), *(pytest.param(*case, marks=pytest.mark.full) for case in ((1.0, 1), (0.5, 2)))],
)
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


def thrown(*velocity, mesh=None, divisions=(4, 4), size=(1.0, 1.0), friction=0.4, **flags):
    """Slips and sticks on the ground."""
    flags = {"gap": 0.03, "dt": 0.02, "modulus": 5.0} | flags
    law = {"size": size, "divisions": divisions} if mesh is None else {"mesh": mesh}
    return on_ground(friction=friction, **law, **flags).throw(*velocity)


def cube():
    mesh = MakeStructured3DMesh(hexes=True, nx=2, ny=2, nz=1)
    return thrown(0.3, 0.2, -0.5, mesh=mesh, friction=0.2, dt=0.05)


def in_blocks():
    mesh = MakeStructured2DMesh(quads=True, nx=2, ny=2)
    flags = {"gap": 0.05, "law": {"friction": 0.2}, "dt": 0.05}
    return moving(mesh, space=lambda m, **f: H1(m, dim=2, **f), **flags).throw(0.3, -0.5)


LOSING = {  # motion, end, rounding
    "sliding": (lambda: sliding(dt=0.05), 4.0, 1e-14),
    "slipping": (
        lambda: thrown(3, -0.7, size=(1, 0.5), divisions=(4, 2), friction=0.2),
        1.5,
        1e-12,
    ),
    "oblique": (lambda: thrown(1.0, -0.7, gravity=1.0), 1.5, 1e-12),
    "cube": (cube, 0.4, 1e-14),
    "blocks of dofs": (in_blocks, 0.3, 1e-12),
    "two bars": (lambda: two_bars(dt=0.025), 2.6, 1e-13),
    "finite sliding of two bars": (lambda: two_bars(dt=0.025, finite=True), 0.6, 1e-4),
}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.full if n == "oblique" else ()) for n in LOSING]
)
def test_nothing_but_friction_and_impact_takes_energy(name):
    make, end, rounding = LOSING[name]
    motion = make()
    time, force, _, tangential = motion.run(end)
    table, velocity = motion.stepper.Table(), motion.stepper.velocity
    mechanical = table["kinetic"] + table["internal"] - table["external"]
    assert np.diff(mechanical).max() < rounding
    assert np.diff(table["friction"] + table["impact"]).min() > -rounding
    assert table["algorithmic"] == pytest.approx(0, abs=min(10 * rounding, 1e-12))
    right, *_, up = motion.mean(velocity)
    if "bars" in name:  # momentum is exact, and they exchange their velocities
        assert up == pytest.approx(-0.5, abs=1e-12)
        during = force[(time > 0.3) & (time < 1.8)]
        assert during.mean() == pytest.approx(0.5, rel=0.02 if name == "two bars" else 0.05)
        if name == "two bars":
            ends = [motion.mean(velocity, body)[1] for body in ("upper", "lower")]
            assert ends == pytest.approx([0, -1], abs=0.03)
        return
    assert np.diff(table["friction"]).min() > -1e-14
    assert table["friction"][-1] > 1e-3
    if name == "slipping":  # all the time: impulses of friction and pressure
        assert up == pytest.approx(0.65, abs=0.02)
        assert (3.0 - right) / (up + 0.7) == pytest.approx(0.2, rel=0.03)
    elif name == "cube":  # friction keeps the direction
        assert right / motion.mean(velocity)[1] == pytest.approx(1.5, rel=0.01)
        assert right < 0.29
    elif name == "sliding":  # v^2 / (2 F g)
        assert motion.mean()[0] == pytest.approx(1 / 0.6, rel=2e-4)
        assert table["friction"][-1] == pytest.approx(0.05, rel=1e-3)
        slides = time < 3.2
        assert -tangential[slides] == pytest.approx(0.3 * force[slides], rel=1e-9)
        assert np.all(motion.contact.Table()["status"] == 1)


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

    def callback(step):
        history = motion.stepper.solver.history
        merit = [np.hypot(h.equilibrium, h.constraint) for h in history]
        assert len(merit) < 3 or merit[-1] < max(1e-12, 100 * merit[-2] ** 2)
        assert len(merit) < 9

    motion.run(0.2, callback=callback, tol=1e-12)
    assert motion.contact.Force()[1] > 0


def test_bodies_that_meet_where_the_mesh_has_them():
    """The step ends as the gap closes: gaps and slip are rounding errors, nothing has moved."""
    motion = two_bars(0.1, dt=0.01, finite=True, friction=0.3)
    motion.run(0.06)
    assert len(motion.steps) == 6
    assert motion.stepper.balance.total == pytest.approx(0.5, rel=0.01)


@pytest.mark.parametrize("nonlinear", [False, True])
def test_a_stretched_body_that_is_let_go(nonlinear):
    """Its energy counts from there, and is 0 but for rounding: steps are not measured by that."""
    motion = on_ground(gap=1.0, dt=0.05, nonlinear=nonlinear)
    motion.gf.components[0].Set((0.2 * x, 0.1 * y))
    motion.run(0.3)
    balance = motion.stepper.balance
    assert balance.internal < -1e-2
    assert abs(balance.total) < (1e-4 if nonlinear else 1e-12)
    assert [step.cuts for step in motion.steps] == [0] * 6


def test_energies_that_steps_are_measured_by():
    before = EnergyBalance(0.0, 6.0, -9.0)
    after = before.After(0.1, 5.0, internal=0.5, external=-1e-15, friction=0.0, impact=-0.06)
    assert after.Won(before) == pytest.approx(0.06 / 6)  # contact has won it
    assert after.AtHand(before) == 6
    slow = EnergyBalance(0.0, 0.0, -9.0)
    assert slow.After(0.1, 0, internal=0.5, external=0, friction=0, impact=0).AtHand(slow) == 0.5
