"""TimeStepper: steps that fail, going on, arguments."""

import numpy as np
import pytest
from motions import bar, elastic, on_ground, sliding, values
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry, Y
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    Mesh,
    Parameter,
    Trace,
    Variation,
    VectorH1,
    dx,
    sqrt,
)
from ngsolve.meshes import MakeStructured2DMesh

from ngslac import ContactConvergenceError, ContactSolver, LACContact, LACSpace
from ngslac.steps.balance import EnergyBalance
from ngslac.steps.time import TimeStepper


def test_a_failing_step_is_cut_and_grows_again(capsys):
    motion = on_ground(gap=0.01, dt=0.4, nonlinear=True, order=1).throw(0, -1.0)
    steps = motion.stepper.Integrate(0.8, maxit=4)
    sizes = np.diff([0, *(s.time for s in steps)])
    assert sum(s.cuts for s in steps) > 0
    assert sizes.max() > 1.5 * sizes.min()
    assert motion.time.Get() == steps[-1].time == 0.8
    assert "halved" in capsys.readouterr().out


def test_giving_up_leaves_the_last_step():
    motion = on_ground(gap=0.01, dt=0.1, nonlinear=True, friction=0.2, maxcuts=1).throw(0.3, -0.5)
    motion.stepper.Integrate(0.2, printing=False)
    before = values(motion.gf), values(motion.stepper.velocity)
    balance, slip = motion.stepper.balance, motion.contact.form.Vectors("reference")
    with pytest.raises(ContactConvergenceError):
        motion.stepper.Integrate(0.3, maxit=1, tol=1e-14, printing=False)
    assert np.array_equal(values(motion.gf), before[0])
    assert np.array_equal(values(motion.stepper.velocity), before[1])
    assert np.array_equal(motion.contact.form.Vectors("reference"), slip)
    assert motion.stepper.balance == balance
    assert motion.time.Get() == 0.2
    motion.stepper.Integrate(0.3, printing=False)
    assert len(motion.stepper.steps) == 3


def test_a_state_without_energy_is_no_solution():
    motion = on_ground(gap=1.0, dt=0.1, maxcuts=1).throw(0, -1.0)
    motion.run(0.1)
    before = values(motion.gf)
    # Has no value below -0.15, as that of an element turned inside out.
    motion.stepper.energy = sqrt(motion.gf.components[0][1] + 0.15)
    with pytest.raises(ContactConvergenceError, match="inside out"):
        motion.stepper.Integrate(0.2, printing=False)
    assert values(motion.gf) == pytest.approx(before, abs=0.05 + 1e-12)
    assert motion.time.Get() <= 0.15
    motion.stepper.energy = CF(float("nan"))
    with pytest.raises(ValueError, match="energy is NaN or infinite where the motion begins"):
        motion.stepper.Integrate(0.2, printing=False)


def test_continues_where_it_stopped():
    motion, other = (bar(n=8, dt=0.05) for _ in range(2))
    motion.run(0.5)
    motion.run(1.0)
    other.run(1.0)
    assert values(motion.gf) == pytest.approx(values(other.gf), abs=1e-13)
    assert [s.number for s in motion.stepper.steps] == list(range(1, 21))


def test_a_static_solution_stays():
    """In equilibrium nothing moves, and the static solver is as before."""
    motion = sliding(speed=0.0)
    before = values(motion.gf)
    motion.run(0.2)
    assert values(motion.gf) == pytest.approx(before, abs=1e-12 * np.abs(before).max())
    motion.stepper.static.Solve(printing=False)
    assert values(motion.gf) == pytest.approx(before, abs=1e-10 * np.abs(before).max())


def test_displacement_anywhere_in_the_product_space():
    """A displacement that is not the first component."""
    mesh = MakeStructured2DMesh(quads=True, nx=1, ny=1)
    V, W = VectorH1(mesh, order=2), VectorH1(mesh, order=1, dirichlet=".*")
    X = W * LACSpace(V, slave="bottom") * V
    (w, lam, u), (dw, _, v) = X.TnT()
    a = BilinearForm(X)
    a += elastic(u, v) + elastic(w, dw)
    gf, time = GridFunction(X), Parameter(0)
    contact = LACContact(u, lam, obstacle=CF(1.0))
    stepper = TimeStepper(ContactSolver(a, gf, contact), 2.0, dt=0.5, time=time)
    stepper.velocity.components[2].Set((0, -0.5))
    stepper.Integrate(1.0, printing=False)
    assert time.Get() == 1.0
    assert gf.components[2](mesh(0.3, 0.2)) == pytest.approx((0, -0.5), abs=1e-12)
    assert stepper.balance.kinetic == pytest.approx(0.25)


@pytest.mark.parametrize("space", [VectorH1, lambda mesh, **flags: H1(mesh, dim=2, **flags)])
def test_spaces_with_and_without_blocks(space):
    mesh = MakeStructured2DMesh(quads=True, nx=2, ny=2)
    V = space(mesh, order=2)
    X = V * LACSpace(V, slave="bottom")
    (u, lam), (v, _) = X.TnT()
    contact = LACContact(u, lam, obstacle=CF(0.05), friction=0.2)
    solver = ContactSolver(BilinearForm(elastic(u, v)), GridFunction(X), contact)
    stepper = TimeStepper(solver, 1.0, dt=0.05, rho_inf=0.7)
    stepper.velocity.components[0].Set((0.3, -0.5))
    stepper.Integrate(0.3, printing=False)
    balance = stepper.balance
    assert balance.total + balance.friction + balance.impact == pytest.approx(0.17, rel=1e-3)
    assert balance.friction > 1e-3


def test_steps_that_bring_in_energy_are_cut(capsys):
    """A ball bounces off a block, in steps in which waves cross it nine times."""
    ball, block = Circle((0, 1.1), 1.0).Face(), MoveTo(-3, -1).Rectangle(6, 1).Face()
    ball.edges.name, block.edges.name = "ball", "free"
    block.edges.Max(Y).name, block.edges.Min(Y).name = "top", "fix"
    ball.faces.name, ball.faces.maxh, block.faces.maxh = "ball", 0.6, 1.0
    shapes = OCCGeometry(Compound([block, ball]), dim=2)
    mesh = Mesh(shapes.GenerateMesh()).Curve(2)
    V = VectorH1(mesh, order=2, dirichlet="fix")
    X = V * LACSpace(V, slave="ball")
    (u, lam), _ = X.TnT()

    def strain(u):
        F = Id(2) + Grad(u)
        C = F.trans * F
        return 0.5 * (Trace(C - Id(2)) + 3 * Det(C) ** (-1 / 3) - 3)

    a, gf = BilinearForm(X), GridFunction(X)
    a += Variation(strain(u) * dx)
    contact = LACContact(u, lam, master="top", finite=True)
    energy = strain(gf.components[0])
    stepper = TimeStepper(ContactSolver(a, gf, contact), 1.0, dt=12.0, rho_inf=0.8, energy=energy)
    stepper.velocity.components[0].Set((0, -0.0115), definedon=mesh.Materials("ball"))
    steps = stepper.Integrate(60.0)
    begin = 0.5 * np.pi * 0.0115**2
    totals = np.array([step.balance.total for step in steps])
    assert totals.max() < 1.02 * begin
    assert totals[-1] > 0.3 * begin
    assert "of the energy; halved" in capsys.readouterr().out


def test_energy_won_is_that_of_contact_and_time_integration():
    before = EnergyBalance(0.0, 2.0, 1.0)
    lost = before.After(1.0, 1.5, internal=0.2, external=0.0, friction=0.1, impact=0.2)
    assert lost.Won(before) == pytest.approx(0, abs=1e-15)
    by_contact = before.After(1.0, 3.0, internal=0.0, external=0.5, friction=0.1, impact=-0.6)
    assert by_contact.Won(before) == pytest.approx(0.5 / 4)
    by_time = before.After(1.0, 3.0, internal=0.0, external=0.0, friction=0.0, impact=0.0)
    assert by_time.Won(before) == pytest.approx(1.0 / 4)
    assert EnergyBalance().Won(EnergyBalance()) == 0.0
