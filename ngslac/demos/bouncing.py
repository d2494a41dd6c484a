"""Bouncing: an elastic ring is thrown at a rigid ground with friction, and leaves it spinning.

Plane strain, neo-Hookean material, large deformation and rotation, gravity. The ring flattens,
rebounds and carries away a part of its energy as vibration; friction slows it down and turns it.
Printed is where the energy goes. Start it with::

    python -m ngslac.demos.bouncing --picture bouncing.png
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry
from ngsolve import (
    CF,
    BilinearForm,
    Det,
    GridFunction,
    Id,
    InnerProduct,
    Integrate,
    Mesh,
    Trace,
    Variation,
    VectorH1,
    dx,
    log,
    x,
    y,
)
from ngsolve import Grad as Gradient

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.meshes.geometry import CheckPositive
from ngslac.steps.time import TimeStepper

from ._bouncing_figures import Figures, Report
from ._bouncing_picture import Picture
from ._command import CommandParser, RunCommand
from ._pictures import Matplotlib

__all__ = ["Model", "Problem", "Results", "Run", "State", "main"]

GROUND = (-1.5, 4.5, 0.25)  # from, to, thickness, in radii


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What to compute; any consistent units, by default those of a ring of radius and density 1.

    Parameters
    ----------
    radius, thickness : float
        Outer radius of the ring, and its thickness.
    young, poisson, density : float
        Of the ring.
    friction : float
        Coefficient of friction.
    velocity : tuple of float
        With which the ring is thrown.
    height : float
        Of its lowest point at the start.
    gravity : float
        Acceleration downwards.
    end : float
        Time at the end.
    h, dt : float
        Size of the elements of the ring, and the time step.
    rho_inf : float
        Spectral radius of `TimeStepper`.
    """

    radius: float = 1.0
    thickness: float = 0.1
    young: float = 2000.0
    poisson: float = 0.3
    density: float = 1.0
    friction: float = 0.5
    velocity: tuple = (2.0, -1.0)
    height: float = 0.05
    gravity: float = 0.5
    end: float = 2.4
    h: float = 0.17
    dt: float = 0.02
    rho_inf: float = 0.9

    def __post_init__(self):
        CheckPositive(
            radius=self.radius,
            thickness=self.thickness,
            young=self.young,
            density=self.density,
            height=self.height,
            end=self.end,
            h=self.h,
            dt=self.dt,
        )
        if not self.thickness < self.radius:
            raise ValueError(f"thickness = {self.thickness} must be less than the radius")
        if self.velocity[1] >= 0:
            raise ValueError(f"velocity = {self.velocity} must point downwards")

    def Mesh(self):
        """Materials "ring" and "ground", boundaries "slave" (outside), "inside", "master"."""
        outside = Circle((0, self.radius + self.height), self.radius).Face()
        inside = Circle((0, self.radius + self.height), self.radius - self.thickness).Face()
        outside.edges.name, inside.edges.name = "slave", "inside"
        ring = outside - inside
        ring.faces.name = "ring"
        ring.faces.maxh = self.h
        left, right, depth = (self.radius * c for c in GROUND)
        ground = MoveTo(left, -depth).Rectangle(right - left, depth).Face()
        ground.faces.name, ground.edges.name = "ground", "fixed"
        ground.edges[np.argmax([e.center.y for e in ground.edges])].name = "master"
        shape = OCCGeometry(Compound([ring, ground]), dim=2)
        return Mesh(shape.GenerateMesh(maxh=0.5 * self.radius)).Curve(2)

    def Energy(self, u):
        """Energy per area of the compressible neo-Hookean material."""
        shear = self.young / (2 * (1 + self.poisson))
        lame = self.young * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson))
        F = Id(2) + Gradient(u)
        volume = log(Det(F))
        return shear / 2 * (Trace(F.trans * F) - 2 - 2 * volume) + lame / 2 * volume**2


@dataclass(frozen=True)
class State:
    """The ring after a step: centre of mass, velocity of it, spin, turn, force of the ground."""

    time: float
    center: tuple
    velocity: tuple
    angular_momentum: float  # about the centre of mass
    angle: float
    force: tuple
    iterations: int
    closed: int


class Model:
    """The discrete problem."""

    def __init__(self, problem):
        self.problem, self.mesh = problem, problem.Mesh()
        V = VectorH1(self.mesh, order=2, dirichlet="master|fixed")
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        weight = problem.density * problem.gravity
        a = BilinearForm(X)
        a += Variation(problem.Energy(u).Compile() * dx)
        a += weight * v[1] * dx("ring")
        self.gf = GridFunction(X)
        self.contact = LACContact(u, lam, master="master", friction=problem.friction, finite=True)
        self.stepper = TimeStepper(
            ContactSolver(a, self.gf, self.contact),
            problem.density,
            dt=problem.dt,
            rho_inf=problem.rho_inf,
            energy=problem.Energy(self.gf.components[0]).Compile(),
        )
        throw = self.mesh.MaterialCF({"ring": CF(problem.velocity)}, default=CF((0, 0)))
        self.stepper.velocity.components[0].Set(throw, definedon=self.mesh.Materials("ring"))
        self.area = self._Sum(1)
        self.states = []
        self._Record(0.0, 0)

    @property
    def displacement(self):
        return self.gf.components[0]

    def _Sum(self, function):
        return Integrate(function, self.mesh, definedon=self.mesh.Materials("ring"))

    def _Record(self, time, iterations):
        u, velocity = self.displacement, self.stepper.velocity.components[0]
        at, start = CF((x, y)) + u, CF((0, self.problem.radius + self.problem.height))
        center = CF(tuple(self._Sum(at[i]) / self.area for i in range(2)))
        arm, first = at - center, CF((x, y)) - start
        turned = self._Sum(first[0] * arm[1] - first[1] * arm[0])
        table = self.contact.Table() if self.contact.form.paired else None
        self.states.append(
            State(
                time=time,
                center=tuple(self._Sum(at[i]) / self.area for i in range(2)),
                velocity=tuple(self._Sum(velocity[i]) / self.area for i in range(2)),
                angular_momentum=self.problem.density
                * self._Sum(arm[0] * velocity[1] - arm[1] * velocity[0]),
                angle=float(np.arctan2(turned, self._Sum(InnerProduct(first, arm)))),
                force=tuple(self.contact.Force()) if table else (0.0, 0.0),
                iterations=iterations,
                closed=int(np.sum(table["status"] > 0)) if table else 0,
            )
        )

    def Run(self, callback=None):
        """Compute the whole motion; `callback(state)` after each step."""

        def Record(step):
            self._Record(step.time, step.iterations)
            if callback:
                callback(self.states[-1])

        self.stepper.Integrate(self.problem.end, printing=False, callback=Record)


@dataclass
class Results:
    """Outcome of `Run`: the model with its states, and `figures` as in the JSON file."""

    problem: Problem
    model: Model
    figures: dict = field(default_factory=dict)
    instants: list = field(default_factory=list)  # (time, displacement vector)


def Run(*, picture=None, quiet=True, **options):
    """Compute the problem.

    Parameters
    ----------
    picture : str or path, optional
        File for a picture of several instants and of the energies.
    quiet : bool
        Print nothing.
    **options
        The fields of `Problem`.

    Returns
    -------
    Results
        With ``results.figures``, the dict that is written to the JSON file.
    """
    problem = Problem(**options)
    if picture is not None:
        Matplotlib()  # complain before the work, not after it
    start = time.perf_counter()
    results = Results(problem, Model(problem))
    model, every = results.model, problem.end / 5

    def Follow(state):
        if state.time >= (len(results.instants)) * every - 1e-9 or state is model.states[0]:
            results.instants.append((state.time, model.displacement.vec.FV().NumPy().copy()))
        if not quiet and len(model.states) % 10 == 0:
            print(f"time {state.time:6.3f}  {model.stepper.balance}", flush=True)

    Follow(model.states[0])
    model.Run(Follow)
    results.figures = Figures(results, time.perf_counter() - start)
    if not quiet:
        print(Report(results.figures))
    if picture is not None:
        Picture(results, picture)
    return results


def main(argv=None):
    """Run the demo from the command line."""
    parser = CommandParser("bouncing", __doc__)
    for name in ("friction", "gravity", "end", "h", "dt", "rho_inf", "thickness", "young"):
        option, default = "--" + name.replace("_", "-"), getattr(Problem, name)
        parser.add_argument(option, type=float, default=default, help=f"default {default}")
    parser.add_argument("--velocity", type=float, nargs=2, default=Problem.velocity)
    parser.add_argument("--picture", help="file for a picture of several instants")
    options = vars(parser.parse_args(argv))
    options["velocity"] = tuple(options["velocity"])
    RunCommand(Run, options)


if __name__ == "__main__":
    main()
