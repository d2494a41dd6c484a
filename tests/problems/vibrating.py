"""Elastic bodies in contact whose frequencies are known: bars, a beam, a ball."""

from functools import cache

import numpy as np
from netgen.occ import (
    Box,
    Circle,
    Compound,
    Cylinder,
    Glue,
    OCCGeometry,
    Rectangle,
    Sphere,
    X,
    Z,
)
from ngsolve import (
    BilinearForm,
    FESpace,
    Grad,
    GridFunction,
    IfPos,
    InnerProduct,
    Mesh,
    Sym,
    VectorH1,
    dx,
    pi,
    x,
)
from ngsolve.meshes import MakeStructured2DMesh

from ngslac import ContactSolver, LACContact, LACSpace, tools
from ngslac.analysis import Modes
from ngslac.materials import AxisymmetricGrad, Stress

SPEED, LENGTHS = 5000.0, (0.1, 0.05)  # of sound, of the bars
RADIUS, DENSITY, NU = 0.01, 7800.0, 0.3  # of the ball
# Of ball and half-space of steel: here the half-space is rigid and the ball as soft as both.
MODULUS = 210e9 / (2 * (1 - NU**2))
MASS = DENSITY * 4 / 3 * np.pi * RADIUS**3


def solved(V, parts, slaves=("slave",), axisymmetric=False, **law):
    """The solver of a problem; `parts` of u and v are the integrals of its bulk."""
    spaces = [LACSpace(V, slave=slave, axisymmetric=axisymmetric) for slave in slaves]
    fes = FESpace([V, *spaces])
    (u, *tractions), (v, *_) = fes.TnT()
    a = BilinearForm(fes)
    for part in parts(u, v):
        a += part
    masters = law.pop("masters", None)
    laws = [law | {"master": master} for master in masters] if masters else [law]
    contacts = [LACContact(u, lam, **own) for lam, own in zip(tractions, laws, strict=True)]
    solver = ContactSolver(a, GridFunction(fes), contacts)
    solver.Solve(printing=False)
    return solver


def bars(offset, lengths=LENGTHS, **law):
    """Bars of density 1 in a row between fixed ends; offset < 0 presses them on each other."""
    starts, bodies = np.cumsum((0, *lengths)), []
    for k, (start, length) in enumerate(zip(starts[:-1], lengths, strict=True)):
        body = Rectangle(length, 0.01).Face().Move((float(start), 0, 0))
        body.edges.name = "side"
        body.edges.Max(X).name = f"slave{k}" if k + 1 < len(lengths) else "end"
        body.edges.Min(X).name = f"master{k - 1}" if k else "end"
        bodies.append(body)
    mesh = Mesh(OCCGeometry(Compound(bodies), dim=2).GenerateMesh(maxh=0.01))
    V = VectorH1(mesh, order=4, dirichletx="end", dirichlety="side|end")
    bulk = lambda u, v: [SPEED**2 * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx]  # noqa: E731
    pairs = range(len(lengths) - 1)
    sides = {"masters": [f"master{k}" for k in pairs], "offset": offset}
    return solved(V, bulk, [f"slave{k}" for k in pairs], **sides, **law)


def cantilever(supported, *, length=1.0, thickness=0.01, n=12):
    """A beam of density 1; its end rests with the middle of a short face on a rigid support."""
    rest = thickness
    length = length + supported * rest / 2
    ends = np.append(np.linspace(0, length - rest, n), length)
    place = lambda s, t: (float(np.interp(n * s, range(n + 1), ends)), thickness * t)  # noqa: E731
    mesh = MakeStructured2DMesh(nx=n, ny=1, mapping=place)
    V = VectorH1(mesh, order=4, dirichlet="left")

    def bulk(u, v):
        return [InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx, 1e-12 * v[1] * dx]

    gap = IfPos(x - length + rest, 0, 1) if supported else 1.0
    return solved(V, bulk, ["bottom"], obstacle=gap)


def radius(force):
    """Of Hertz' contact of the ball."""
    return (3 * force * RADIUS / (4 * MODULUS)) ** (1 / 3)


def resonance(force):
    """Frequency of the ball on the spring dF/d delta = 2 E* a."""
    return np.sqrt(2 * MODULUS * radius(force) / MASS) / (2 * np.pi)


@cache
def ball(force, faces=16, friction=None):
    """A ball on a rigid plane, pressed by its weight; so many faces along the contact radius."""
    a = radius(force)
    half = Circle((0, RADIUS), RADIUS).Face() * Rectangle(RADIUS, 2 * RADIUS).Face()
    near = half * Rectangle(1.6 * a, 1.5 * a).Face()
    body = Glue([near, half - near])
    for edge in body.edges:
        edge.name = "axis" if edge.center.x < 1e-6 * RADIUS else "free"
    slave = min((e for e in body.edges if e.name == "free"), key=lambda e: e.center.y)
    slave.name, slave.maxh = "slave", a / faces
    geometry = OCCGeometry(body, dim=2)
    mesh = Mesh(geometry.GenerateMesh(maxh=RADIUS / 4, grading=0.2)).Curve(2)

    def bulk(u, v):
        stress = Stress(Sym(AxisymmetricGrad(u)), MODULUS * (1 - NU**2), NU)
        weight = force * DENSITY / MASS * v[1]
        return [2 * pi * x * (InnerProduct(stress, Sym(AxisymmetricGrad(v))) + weight) * dx]

    plane = {"obstacle": tools.Plane((0, 0), (0, 1)), "finite": True, "friction": friction}
    return solved(VectorH1(mesh, order=2, dirichletx="axis"), bulk, axisymmetric=True, **plane)


def half_ball(sign, far, h):
    """Half of a ball of radius `far` with a circle of radius 1 in its flat face, and a shell."""
    box = Box((-far, -far, min(0, sign * far)), (far, far, max(0, sign * far)))
    ball, core = Sphere((0, 0, 0), far) * box, Sphere((0, 0, 0), 0.9 * far) * box
    spot = Cylinder((0, 0, 0), sign * Z, r=1, h=0.5)
    body = Glue([ball - core, core - spot, spot])
    wide = lambda shape: shape.bounding_box[1].x  # noqa: E731
    for solid in body.solids:
        solid.mat("rigid" if sign > 0 and wide(solid) > 0.95 * far else "soft")
    for face in body.faces:
        low, high = face.bounding_box
        flat = max(abs(low.z), abs(high.z)) < 1e-6
        face.name = "far" if sign < 0 and not flat and wide(face) > 0.95 * far else "free"
        if flat and wide(face) < 1.1:
            face.name, face.maxh = ("slave", h) if sign > 0 else ("master", 1.15 * h)
    return body


def stick_ratio(far, h=0.5):
    """Stiffness along over that across a circle that sticks, between equal bodies of radius `far`.

    By the frequencies of the upper one, whose mass is in its shell.
    """
    bodies = Compound([half_ball(sign, far, h) for sign in (1, -1)])
    mesh = Mesh(OCCGeometry(bodies).GenerateMesh(maxh=far / 2, grading=0.4)).Curve(2)

    def bulk(u, v):
        yield InnerProduct(Stress(Sym(Grad(u)), 1, NU), Sym(Grad(v))) * dx("soft")
        yield 1e3 * InnerProduct(Grad(u), Grad(v)) * dx("rigid")
        yield 1e-6 * v[2] * dx("rigid")

    solver = solved(VectorH1(mesh, order=2, dirichlet="far"), bulk, master="master", friction=10)
    found = Modes(solver, mesh.MaterialCF({"rigid": 1}, default=1e-8), count=3)
    one, other, across = found.frequencies**2
    return (one + other) / 2 / across
