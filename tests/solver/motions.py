"""Bodies that move and meet: small problems for the time stepper."""

from dataclasses import dataclass, field

import numpy as np
from ngsolve import (
    CF,
    BilinearForm,
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

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.meshes import TwoBlocks
from ngslac.steps.time import TimeStepper


def values(gf):
    return gf.vec.FV().NumPy().copy()


def elastic(u, v, modulus=1.0):
    """Plane strain with Poisson's ratio 0: Young's modulus is twice the shear modulus."""
    return modulus * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx


def neo_hooke(u, modulus=1.0):
    F = Id(2) + Grad(u)
    det = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]
    return modulus * (InnerProduct(F, F) - 2 - 2 * log(det)) / 4


@dataclass
class Motion:
    """A stepper with what belongs to it, and a record of its steps."""

    mesh: object
    stepper: TimeStepper
    contact: LACContact
    time: Parameter
    width: float = 1.0
    record: list = field(default_factory=list)
    path: list = field(default_factory=list)  # displacements

    @property
    def gf(self):
        return self.stepper.gf

    def throw(self, *velocity, where=None):
        self.stepper.velocity.components[0].Set(where or CF(velocity))
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


def on_ground(
    *,
    size=(1.0, 1.0),
    divisions=(2, 2),
    quads=True,
    order=2,
    gap=0.0,
    modulus=1.0,
    gravity=0.0,
    load=None,
    friction=None,
    nonlinear=False,
    condense=False,
    flags=None,
    mesh=None,
    inverse=None,
    **options,
):
    """A block of density 1 over a rigid plane at a distance, a number or a function of time.

    `load(u, v, t)` adds forms.
    """
    width, height = size
    nx, ny = divisions
    mesh = mesh or MakeStructured2DMesh(
        quads=quads, nx=nx, ny=ny, mapping=lambda s, t: (width * s, height * t)
    )
    V = VectorH1(mesh, order=order, **(flags or {}))
    X = V * LACSpace(V, slave="bottom")
    (u, lam), (v, _) = X.TnT()
    time = Parameter(0.0)
    a = BilinearForm(X, condense=condense)
    a += Variation(neo_hooke(u, modulus).Compile() * dx) if nonlinear else elastic(u, v, modulus)
    if gravity:
        a += gravity * v[1] * dx
    if load:
        a += load(u, v, time)
    gf = GridFunction(X)
    far = gap(time) if callable(gap) else CF(gap)
    contact = LACContact(u, lam, obstacle=far, friction=friction)
    solver = ContactSolver(a, gf, contact, inverse=inverse)
    stepper = TimeStepper(solver, 1.0, time=time, **options)
    return Motion(mesh, stepper, contact, time, width)


def bar(*, n=20, gap=0.1, rho_inf=1.0, dt=0.025, order=2, **flags):
    """An elastic bar, speed of sound 1 and length 1, thrown at a wall with velocity 1."""
    motion = on_ground(
        size=(0.1, 1.0),
        divisions=(2, n),
        order=order,
        gap=gap,
        dt=dt,
        rho_inf=rho_inf,
        flags={"dirichletx": "left|right"},
        **flags,
    )
    return motion.throw(0, -1)


def two_bars(h=0.2, *, gap=0.05, dt=0.02, **law):
    """Two equal bars on non-matching meshes; the upper one is thrown at the lower one."""
    mesh = TwoBlocks(h, structured=True, width=1.0)
    V = VectorH1(mesh, order=2, dirichletx="left_upper|right_upper|left_lower|right_lower")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += elastic(u, v)
    gf = GridFunction(X)
    # A translation is no strain: the bodies start apart.
    apart = mesh.MaterialCF({"upper": CF((0, gap))}, default=CF((0, 0)))
    gf.components[0].Set(apart)
    contact = LACContact(u, lam, master="master", **law)
    stepper = TimeStepper(ContactSolver(a, gf, contact), 1.0, dt=dt)
    motion = Motion(mesh, stepper, contact, stepper.time)
    return motion.throw(where=mesh.MaterialCF({"upper": CF((0, -1))}, default=CF((0, 0))))


def shaken(n, *, friction=None, rho_inf=1.0, end=1.0):
    """A block pressed on the ground, its top pulled by forces that are smooth in time; n steps."""

    def load(u, v, t):
        force = v[1] + 0.3 * (1 - cos(4 * t)) * v[1] - 0.2 * t**3 * v[0]
        return (force + 0.5 * u[0] * v[0]) * ds("top")

    motion = on_ground(
        divisions=(2, 1),
        modulus=10.0,
        gravity=1.0,
        load=load,
        friction=friction,
        dt=end / n,
        rho_inf=rho_inf,
    )
    motion.stepper.static.Solve(printing=False)
    motion.contact.Commit(motion.gf)
    motion.run(end)
    return motion


def sliding(*, speed=1.0, friction=0.3, gravity=1.0, dt=0.02, **flags):
    """A flat block in equilibrium on the ground that is given a horizontal velocity."""
    motion = on_ground(
        size=(1.0, 0.1),
        divisions=(4, 1),
        modulus=1e3,
        gravity=gravity,
        friction=friction,
        dt=dt,
        **flags,
    )
    motion.stepper.static.Solve(printing=False)
    motion.contact.Commit(motion.gf)
    return motion.throw(speed, 0)
