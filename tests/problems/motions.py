"""Bodies that move and meet: small problems for the time stepper."""

from dataclasses import dataclass, field

import numpy as np
from ngsolve import (
    CF,
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Integrate,
    Parameter,
    Sym,
    Variation,
    VectorH1,
    cos,
    ds,
    dx,
    log,
)
from ngsolve.meshes import MakeStructured2DMesh
from press import numpy as values

from ngslac import ContactSolver, LACContact, LACSpace, TimeStepper
from ngslac.meshes import TwoBlocks


def elastic(u, v, modulus=1.0):
    """Poisson's ratio is 0: Young's modulus is twice the shear modulus."""
    return modulus * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx


def neo_hooke(u, modulus=1.0):
    F = Id(2) + Grad(u)
    return modulus * (InnerProduct(F, F) - 2 - 2 * log(Det(F))) / 4


@dataclass
class Motion:
    """A stepper with what belongs to it, and a record of its steps."""

    stepper: TimeStepper
    width: float = 1.0
    record: list = field(default_factory=list)
    path: list = field(default_factory=list)  # displacements

    def __post_init__(self):
        self.gf, (self.contact,) = self.stepper.gf, self.stepper.solver.contacts
        self.mesh, self.time = self.gf.space.mesh, self.stepper.time

    def throw(self, *velocity, where=None):
        self.stepper.velocity.components[0].Set(where or CF(velocity))
        return self

    def settle(self):
        """Start from the equilibrium at rest."""
        self.stepper.static.Solve(printing=False)
        self.contact.Commit(self.gf)
        return self

    def run(self, end, **flags):
        def callback(step):
            self.path.append(values(self.gf.components[0]))
            force = self.contact.Force() / self.width
            self.record.append((step.time, force[1], step.balance.total / self.width, force[0]))

        flags = {"printing": False, "callback": callback} | flags
        self.steps = self.stepper.Integrate(end, **flags)
        return np.array(self.record).T

    def mean(self, gf=None, material=".*"):
        """Mean vector over a body."""
        part = self.mesh.Materials(material)
        u = (gf or self.gf).components[0]
        area = Integrate(1, self.mesh, definedon=part)
        return np.array(Integrate(u, self.mesh, definedon=part)) / area


def moving(
    mesh,
    slave="bottom",
    *,
    space=VectorH1,
    order=2,
    flags=None,
    condense=False,
    modulus=1.0,
    gravity=0.0,
    load=None,
    nonlinear=False,
    inverse=None,
    gap=None,
    offset=None,
    law=None,
    width=1.0,
    **options,
):
    """Bodies of density 1; `law` goes to LACContact, `options` to TimeStepper.

    `gap` is the distance of a rigid plane, a number or a function of time, `offset` one, too;
    `load(u, v, t)` adds forms.
    """
    V = space(mesh, order=order, **(flags or {}))
    X = V * LACSpace(V, slave=slave)
    (u, lam), (v, _) = X.TnT()
    time, law = Parameter(0.0), dict(law or {})
    a = BilinearForm(X, condense=condense)
    a += Variation(neo_hooke(u, modulus).Compile() * dx) if nonlinear else elastic(u, v, modulus)
    if gravity:
        a += gravity * v[mesh.dim - 1] * dx
    if load:
        a += load(u, v, time)
    if gap is not None:
        law["obstacle"] = gap(time) if callable(gap) else CF(gap)
    if offset is not None:
        law["offset"] = offset(time)
    solver = ContactSolver(a, GridFunction(X), LACContact(u, lam, **law), inverse=inverse)
    return Motion(TimeStepper(solver, 1.0, time=time, **options), width)


def on_ground(*, size=(1.0, 1.0), divisions=(2, 2), gap=0.0, friction=None, mesh=None, **flags):
    """A block over a rigid plane."""
    width, height = size
    nx, ny = divisions
    mesh = mesh or MakeStructured2DMesh(nx=nx, ny=ny, mapping=lambda s, t: (width * s, height * t))
    return moving(mesh, gap=gap, law={"friction": friction}, width=width, **flags)


def bar(*, n=20, gap=0.1, dt=0.025, **flags):
    """An elastic bar, speed of sound 1 and length 1, thrown at a wall with velocity 1."""
    given = {"size": (0.1, 1.0), "divisions": (2, n), "flags": {"dirichletx": "left|right"}}
    return on_ground(gap=gap, dt=dt, **(given | flags)).throw(0, -1)


def two_bars(h=0.2, *, gap=0.05, dt=0.02, offset=None, **law):
    """Two equal bars on non-matching meshes; the upper one is thrown at the lower one."""
    mesh = TwoBlocks(h, structured=True, width=1.0)
    sides = {"dirichletx": "left_upper|right_upper|left_lower|right_lower"}
    given = {"flags": sides, "law": {"master": "master"} | law, "offset": offset}
    motion = moving(mesh, "slave", dt=dt, **given)
    still, upper = CF((0, 0)), lambda value: mesh.MaterialCF({"upper": value}, default=still)
    motion.gf.components[0].Set(upper(CF((0, gap))))  # no strain
    return motion.throw(where=upper(CF((0, -1))))


def shaken(n, *, friction=None, rho_inf=1.0, end=1.0):
    """A block pressed on the ground, its top pulled by forces that are smooth in time; n steps."""

    def load(u, v, t):
        force = v[1] + 0.3 * (1 - cos(4 * t)) * v[1] - 0.2 * t**3 * v[0]
        return (force + 0.5 * u[0] * v[0]) * ds("top")

    flags = {"modulus": 10.0, "gravity": 1.0, "friction": friction, "rho_inf": rho_inf}
    motion = on_ground(divisions=(2, 1), load=load, dt=end / n, **flags).settle()
    motion.run(end)
    return motion


def sliding(*, speed=1.0, friction=0.3, gravity=1.0, dt=0.02, **flags):
    """A flat block in equilibrium on the ground that is given a horizontal velocity."""
    given = {"size": (1.0, 0.1), "divisions": (4, 1), "modulus": 1e3, "gravity": gravity}
    return on_ground(friction=friction, dt=dt, **(given | flags)).settle().throw(speed, 0)
