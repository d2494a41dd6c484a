"""Rubber bodies that are thrown at each other: large sliding for the time stepper."""

import numpy as np
from netgen.occ import Axis, Box, Circle, Compound, MoveTo, OCCGeometry, Pnt, Sphere, Y, Z
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Integrate,
    Mesh,
    Variation,
    VectorH1,
    dx,
    x,
    y,
    z,
)

from ngslac import ContactSolver, LACContact, LACSpace, TimeStepper
from ngslac.materials import NeoHooke

NU, UPWARDS = 0.3, Axis((0, 0, 0), Z)


class Flight:
    """Bodies of density 1 and what is noted of them after each step.

    Parameters
    ----------
    mesh : Mesh
    pairs : dict
        Slave -> master.
    throw : dict
        Material -> velocity, the only bodies whose momenta count.
    young : float or dict
        Of each material.
    options :
        For TimeStepper.

    Attributes
    ----------
    total : list of float
        Kinetic and strain energy over those of the start.
    """

    def __init__(
        self,
        mesh,
        pairs,
        throw,
        *,
        young=1e3,
        dirichlet="",
        friction=None,
        order=2,
        inverse=None,
        **options,
    ):
        self.mesh, self.dim, d = mesh, mesh.dim, mesh.dim
        self.points = 2 * order  # of quadrature: as in forms
        self.bodies = mesh.Materials("|".join(throw))
        V = VectorH1(mesh, order=order, dirichlet=dirichlet)
        space = V
        for slave in pairs:
            space = space * LACSpace(V, slave=slave)
        u, *lams = space.TrialFunction()
        modulus = mesh.MaterialCF(young) if isinstance(young, dict) else young
        self.bulk, self.gf = BilinearForm(space), GridFunction(space)
        self.bulk += Variation(NeoHooke(Id(d) + Grad(u), modulus, NU).Compile() * dx)
        law, masters = (
            {"friction": friction, "finite": True},
            zip(lams, pairs.values(), strict=True),
        )
        contacts = [LACContact(u, lam, master=master, **law) for lam, master in masters]
        self.u = self.gf.components[0]
        solver = ContactSolver(self.bulk, self.gf, contacts, inverse=inverse)
        self.stepper = TimeStepper(solver, 1.0, **options)
        self.contacts, self.velocity = contacts, self.stepper.velocity.components[0]
        self.velocity.Set(mesh.MaterialCF(throw), definedon=self.bodies)
        self.start, self.total, self.closed, self.path = self.energy(), [], [], []

    def energy(self):
        """Kinetic and strain energy, at the points where the forms are summed up."""
        kinetic = InnerProduct(self.velocity, self.velocity) / 2
        return Integrate(kinetic, self.mesh, order=self.points) + self.bulk.Energy(self.gf.vec)

    def momentum(self):
        """Linear, and angular about the origin."""
        v, at = self.velocity, CF((x, y, z)[: self.dim]) + self.u
        planes = ((0, 1), (1, 2), (2, 0))[: 1 if self.dim == 2 else 3]
        turn = [at[i] * v[j] - at[j] * v[i] for i, j in planes]
        parts = [v[i] for i in range(self.dim)] + turn
        return np.array([Integrate(part, self.bodies, order=self.points) for part in parts])

    def direction(self):
        """Degrees by which the mean velocity is off the upward direction."""
        right, up = self.momentum()[:2]
        return np.degrees(np.arctan2(right, up))

    def run(self, end, **flags):
        def note(step):
            self.total.append(self.energy() / self.start)
            self.closed.append(sum(int(np.sum(c.Table()["status"] > 0)) for c in self.contacts))
            self.path.append(self.momentum())

        self.stepper.Integrate(end, **({"printing": False, "callback": note} | flags))
        return self


def meshed(*faces):
    return Mesh(OCCGeometry(Compound(faces), dim=2).GenerateMesh()).Curve(2)


def disc(name, at, radius, h, turn=0.0):
    """A boundary and a material of that name."""
    face = Circle((0, 0), radius).Face().Rotate(UPWARDS, turn).Move((*at, 0))
    face.faces.name = face.edges.name = name
    face.faces.maxh = h
    return face


def slab(low, high, h, top="top"):
    face = MoveTo(*low).Rectangle(high[0] - low[0], high[1] - low[1]).Face()
    face.faces.name, face.edges.name = "slab", "fixed"
    face.edges.Max(Y).name = top
    face.faces.maxh = h
    return face


def hollow(radius, h, half, depth):
    """A block with a round bowl about the origin."""
    face = MoveTo(-half, -depth).Rectangle(2 * half, depth).Face()
    face = face - Circle((0, 0), radius).Face()
    face.faces.name, face.edges.name = "slab", "fixed"
    for edge in face.edges:
        if all(abs(np.hypot(v.p.x, v.p.y) - radius) < 1e-6 * radius for v in edge.vertices):
            edge.name, edge.maxh = "top", h
    face.faces.maxh = 4 * h
    return face


def on_slab(velocity=(0, -1), *, mesh=None, turn=0.0, h=0.5, rigid=False, swap=False, **flags):
    """A disc thrown at a slab."""
    mesh = mesh or meshed(disc("ball", (0, 1.02), 1, h, turn), slab((-2, -0.5), (3, 0), 0.4))
    pairs = {"top": "ball"} if swap else {"ball": "top"}
    return Flight(
        mesh, pairs, {"ball": CF(velocity)}, dirichlet="fixed|top" if rigid else "fixed", **flags
    )


def in_bowl(offset, *, h=0.12, swap=False, **flags):
    """A disc of half the radius falls into a stiff bowl, with the speed 1."""
    low = np.array((offset, -np.sqrt(1 - offset**2) + 0.03))
    mesh = meshed(disc("ball", low, 1, h), hollow(2, h, 1.6, 2.6))
    pairs = {"top": "ball"} if swap else {"ball": "top"}
    young = {"ball": 1e4, "slab": 1e6}
    return Flight(mesh, pairs, {"ball": CF((0, -1))}, young=young, dirichlet="fixed", **flags)


def three_in_bowl(**flags):
    """Three discs thrown into a bowl hit it and each other."""
    thrown = {"a": (-1.1, -0.8, 1, -1), "b": (0, -1.8, 0, -1.5), "c": (1.2, -0.6, -1, -0.7)}
    discs = [disc(name, at[:2], 0.5, 0.25) for name, at in thrown.items()]
    mesh = meshed(hollow(3, 0.4, 3.3, 3.3), *discs)
    pairs = {"a": "top|b|c", "b": "top|c", "c": "top"}
    young = {"slab": 1e4} | dict.fromkeys(thrown, 1e3)
    throw = {name: CF(at[2:]) for name, at in thrown.items()}
    return Flight(mesh, pairs, throw, young=young, dirichlet="fixed", **flags)


def two_discs(*, spin=0.0, aside=0.3, h=0.25, **flags):
    """Two free discs meet off centre; one turns."""
    mesh = meshed(disc("a", (-0.55, 0), 0.5, h), disc("b", (0.55, aside), 0.5, 1.2 * h))
    throw = {"a": CF((1 - spin * y, spin * (x + 0.55))), "b": CF((-0.5, 0))}
    return Flight(mesh, {"a": "b"}, throw, **flags)


def ball_on_plate(velocity=(0.5, 0.2, -1), **flags):
    """In 3D, first-order geometry."""
    ball, plate = Sphere(Pnt(0, 0, 0.52), 0.5), Box(Pnt(-0.8, -0.8, -0.3), Pnt(0.8, 0.8, 0))
    ball.mat("ball").faces.name = "ball"
    plate.mat("slab").faces.name = "fixed"
    plate.faces.Max(Z).name = "top"
    ball.maxh, plate.maxh = 0.35, 0.5
    mesh = Mesh(OCCGeometry(Compound([ball, plate])).GenerateMesh())
    throw = {"ball": CF(velocity)}
    return Flight(mesh, {"ball": "top"}, throw, dirichlet="fixed", **flags)
