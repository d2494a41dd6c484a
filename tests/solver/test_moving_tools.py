"""Tools that move in dynamics: only velocities relative to them count, and forces carry them."""

import numpy as np
import pytest
from bricks import brick
from ngsolve import (
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    NumberSpace,
    Parameter,
    Variation,
    VectorH1,
    dx,
    sin,
)
from press import numpy as values

from ngslac import ContactSolver, LACContact, LACSpace, TimeStepper, tools
from ngslac.materials import NeoHooke
from ngslac.solve.solver import Equilibrium

UP = {2: (0, 1), 3: (0, 0, 1)}
SPEED = {2: (0.5, 0.3), 3: (0.4, -0.3, 0.3)}  # of a belt that comes nearer
GRAVITY, DT = 9.81, 0.01


class Flight:
    """A block, free unless `held`, over a tool; `make(time, *numbers)` returns it."""

    def __init__(self, dim, make, *, numbers=0, held="", gravity=GRAVITY, rho_inf=1.0, **law):
        mesh = brick("trig" if dim == 2 else "tet", {2: 4, 3: 2}[dim])
        V = VectorH1(mesh, order=2, dirichlet=held)
        X = V * LACSpace(V, slave="bottom")
        for _ in range(numbers):
            X = X * NumberSpace(mesh)
        (u, lam, *unknowns), (v, *_) = X.TnT()
        self.time, self.gf, self.forces = Parameter(0), GridFunction(X), []
        a = BilinearForm(X)
        a += Variation(NeoHooke(Id(dim) + Grad(u), 2000, 0.3).Compile() * dx)
        a += gravity * v[dim - 1] * dx
        tool = make(self.time, *unknowns)
        self.contact = LACContact(u, lam, obstacle=tool, finite=True, **law)
        solver = ContactSolver(a, self.gf, self.contact)
        self.stepper = TimeStepper(solver, 1.0, dt=DT, time=self.time, rho_inf=rho_inf)
        self.velocity = self.stepper.velocity.components[0]

    def Run(self, end, look=lambda _: None):
        def callback(step):
            self.forces.append(self.contact.Force())
            look(step)

        self.stepper.Integrate(end, printing=False, callback=callback)


def belt(dim, motion, rho_inf, **law):
    """A block on a belt that moves, or thrown at one at rest: displacement, velocity, forces."""
    speed, end = np.array(SPEED[dim]), 6 * DT
    plane = tools.Plane((0,) * dim, UP[dim])
    moves = motion == "belt"
    flight = Flight(
        dim,
        lambda t: plane.Moved(shift=tuple(s * t for s in speed)) if moves else plane,
        rho_inf=rho_inf,
        **law,
    )
    frame = GridFunction(flight.velocity.space)
    frame.Set(tuple(speed))
    if not moves:
        flight.velocity.vec.data = -frame.vec
    flight.Run(end)
    displacement, velocity = values(flight.gf.components[0]), values(flight.velocity)
    if not moves:
        displacement, velocity = displacement + end * values(frame), velocity + values(frame)
    balance = flight.stepper.balance
    losses = [balance.friction, balance.impact, balance.algorithmic, balance.internal]
    return displacement, velocity, np.array(flight.forces), losses


@pytest.mark.pairwise
@pytest.mark.parametrize("rho_inf", [1.0, 0.8])
@pytest.mark.parametrize("friction", [None, 0.3, 5.0])  # slips all the time, and sticks
@pytest.mark.parametrize("dim", [2, 3])
def test_only_the_velocity_relative_to_a_belt_counts(dim, friction, rho_inf):
    """Seen by one who moves with the belt, all is the same: displacements, forces, losses."""
    moved, thrown = (belt(dim, which, rho_inf, friction=friction) for which in ("belt", "block"))
    for one, two in zip(moved, thrown, strict=True):
        assert one == pytest.approx(two, rel=0, abs=1e-9 * np.max(np.abs(two)))
    assert np.any(moved[2])


@pytest.mark.parametrize("dim", [2, 3])
def test_forces_move_a_tool_that_has_no_mass(dim):
    """It passes on its load at each time, and its work is that of the load."""
    center = (0.5,) * (dim - 1) + (-2.0,)

    def make(time, way):
        travel, force = [None] * dim, [0] * dim
        travel[-1], force[-1] = way, 3 * sin(10 * time)
        return tools.Sphere(center, 2).Driven(travel=travel, force=tuple(force))

    flight = Flight(dim, make, numbers=1, held="top", gravity=0, friction=0.3)
    ways, times, end = [0.0], [], {2: 0.1, 3: 0.04}[dim]
    flight.Run(
        end,
        lambda step: (times.append(step.time), ways.append(flight.gf.components[2].vec[0])),
    )
    loads = 3 * np.sin(10 * np.array(times))
    assert np.array(flight.forces)[:, -1] == pytest.approx(loads, rel=1e-8)
    balance = flight.stepper.balance
    assert balance.external == pytest.approx(loads @ np.diff(ways), rel=0.02)
    assert balance.kinetic > 0
    assert balance.impact + balance.friction >= 0


def test_a_step_is_solved_once(monkeypatch):
    """The pressures of tools keep their directions: none are learnt for another solution."""
    count, solve = [], Equilibrium.Solve
    monkeypatch.setattr(Equilibrium, "Solve", lambda *a, **k: count.append(1) or solve(*a, **k))

    def Pressing(time):
        return tools.Sphere((0.5, -1), 1).Moved(shift=(0.5 * time, 0.5 * time))

    flight = Flight(2, Pressing, held="top", gravity=0, friction=0.3)
    flight.Run(6 * DT)
    assert abs(flight.forces[-1][1]) > 1
    assert len(count) == len(flight.stepper.steps)
