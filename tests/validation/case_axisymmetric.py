"""Bodies of revolution: indenters of a half-space, press fits, NAFEMS' punch, plates and balls.

The half-space ends on a square of 20 contact radii, where the displacement is that of Boussinesq's
point load with the exact force; its error falls with the square of the distance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from case_punch import LINEAR, LOAD, PUBLISHED, YOUNG, HalfSection
from elasticity import Sorted
from netgen.occ import Axes, Compound, Glue, MoveTo, OCCGeometry, WorkPlane, X, Y, Z
from ngsolve import (
    CF,
    BilinearForm,
    FESpace,
    GridFunction,
    Id,
    InnerProduct,
    LinearForm,
    Mesh,
    Parameter,
    Sym,
    Variation,
    VectorH1,
    ds,
    dx,
    pi,
    sqrt,
    x,
    y,
)
from report_bounds import Both, Meshes, Neglected, Spread, Stated, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import BLUE, INK, ORANGE, Figure

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import AxisymmetricGrad, NeoHooke, Stress

NU = 0.3
MODULUS = 1 / (1 - NU**2)  # E* for E = 1 and a rigid indenter
FAR = 20.0  # contact radii
HERTZ = "K. L. Johnson, Contact Mechanics, sections 3.4, 4.2 and 5.2."


class Pair:
    """Bulk, contact and solution of bodies of revolution on V."""

    def __init__(self, V, young, nu, *, finite=False, slave="slave", **law):
        self.mesh, fes = V.mesh, V * LACSpace(V, slave=slave, axisymmetric=True)
        (u, lam), (self.v, _) = fes.TnT()
        self.a, self.load = BilinearForm(fes), LinearForm(fes)
        strain, virtual = AxisymmetricGrad(u), AxisymmetricGrad(self.v)
        if finite:
            self.a += Variation(2 * pi * x * NeoHooke(Id(3) + strain, young, nu) * dx)
        else:
            stress = Stress(Sym(strain), young, nu)
            self.a += 2 * pi * x * InnerProduct(stress, Sym(virtual)) * dx
        self.contact = LACContact(u, lam, finite=finite, **law)
        self.gf = GridFunction(fes)

    def Solve(self, **options):
        solver = ContactSolver(self.a, self.gf, self.contact, rhs=self.load.Assemble().vec)
        solver.Solve(printing=False, **options)
        self.table = Sorted(self.contact.Table())
        return self


# --- rigid indenters -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Indenter:
    """A rigid body of revolution on the half-space with E = 1, and what is known of it."""

    name: str
    radius: float
    force: float
    shape: callable
    inside: callable  # force within r <= radius

    def Mean(self, ends):
        """Means of the pressure between radii (n + 1,)."""
        total = self.inside(np.minimum(ends, self.radius))
        return np.diff(total) / (np.pi * np.diff(ends**2))


def Sphere(force=1e-3):
    a = (3 * force / (4 * MODULUS)) ** (1 / 3)
    inside = lambda r: force * (1 - (1 - (r / a) ** 2) ** 1.5)  # noqa: E731
    return Indenter("sphere", a, force, lambda r: r * r / 2 - a * a, inside)


def Cone(degrees=80.0, depth=0.01):
    angle = np.radians(degrees)
    a = 2 / np.pi * depth * np.tan(angle)
    force = 2 / np.pi * MODULUS * depth**2 * np.tan(angle)

    def inside(r):
        s = np.clip(r / a, 1e-12, 1 - 1e-15)
        return force * (s**2 * np.arccosh(1 / s) + 1 - np.sqrt(1 - s**2))

    return Indenter("cone", a, force, lambda r: r / np.tan(angle) - depth, inside)


def Punch(radius=0.1, depth=1e-3):
    force = 2 * MODULUS * radius * depth
    inside = lambda r: force * (1 - np.sqrt(1 - (r / radius) ** 2))  # noqa: E731
    return Indenter("flat punch", radius, force, lambda r: 0 * r - depth, inside)


INDENTERS = [Sphere(), Cone(), Punch()]


def Boussinesq(force):
    """Displacement under a point load, which pushes towards -y."""
    shear, depth = 1 / (2 * (1 + NU)), -y
    far = sqrt(x * x + y * y)
    radial = x * depth / far**3 - (1 - 2 * NU) * x / (far * (far + depth))
    down = depth**2 / far**3 + 2 * (1 - NU) / far
    return force / (4 * np.pi * shear) * CF((radial, -down))


def HalfSpace(indenter, faces):
    """A section with so many faces along the contact radius."""
    a = indenter.radius
    far, end = FAR * a, a * (1 if indenter.name == "flat punch" else 1.5)
    fine = MoveTo(0, -end).Rectangle(end, end).Face()
    fine.edges.Max(Y).name, fine.edges.Max(Y).maxh = "slave", a / faces
    body = Glue([fine, MoveTo(0, -far).Rectangle(far, far).Face() - fine])
    for edge in body.edges:
        if edge.name != "slave":
            outside = edge.center.x > far * (1 - 1e-6) or edge.center.y < -far * (1 - 1e-6)
            edge.name = "far" if outside else "axis" if abs(edge.center.x) < 1e-9 * a else "free"
    return Mesh(OCCGeometry(body, dim=2).GenerateMesh(maxh=far / 6, grading=0.15))


@dataclass(frozen=True)
class Indented:
    """Force, and means of the pressure between radii."""

    force: float
    ends: np.ndarray
    pressure: np.ndarray
    dofs: int


@cache
def Indent(number, faces):
    indenter = INDENTERS[number]
    V = VectorH1(HalfSpace(indenter, faces), order=2, dirichlet="far", dirichletx="axis")
    pair = Pair(V, 1.0, NU, obstacle=indenter.shape(x))
    far = V.mesh.Boundaries("far")
    pair.gf.components[0].Set(Boussinesq(indenter.force), definedon=far)
    table = pair.Solve().table
    ends = np.sqrt(np.concatenate([[0], np.cumsum(table["fullarea"])]) / np.pi)
    return Indented(-pair.contact.Force()[1], ends, table["pressure"], V.ndof)


def Indenters(quick):
    faces, rows, shown = (5 if quick else 10), [], []
    for number, indenter in enumerate(INDENTERS):
        coarse, found = Indent(number, faces // 2), Indent(number, faces)
        exact = indenter.Mean(found.ends)
        bound = Meshes(found.force, coarse.force, 2)
        rows.append(Row(f"{indenter.name}: force", found.force, indenter.force, bound))
        middle = found.ends[1:] < 0.8 * indenter.radius
        off = found.pressure[middle] / exact[middle] - 1
        off_coarse = Meshes(found.pressure[0], coarse.pressure[0], 2)
        rows.append(
            Row(f"{indenter.name}: mean on the axis", found.pressure[0], exact[0], off_coarse)
        )
        text = f"{indenter.name}: largest error up to .8 a over that on the axis, {faces} faces"
        rows.append(Row(text, np.abs(off).max(), abs(off[0])))
        shown.append((indenter, found, exact))

    def Draw(*axes):
        for ax, (indenter, found, exact) in zip(axes, shown, strict=True):
            for values, colour, label in (
                (exact, INK, "exact means"),
                (found.pressure, ORANGE, "computed"),
            ):
                ax.stairs(values, found.ends / indenter.radius, color=colour, label=label)
            ax.set(title=indenter.name, xlabel="r/a", ylabel="pressure over E")
        axes[0].legend()

    caption = "Pressures of the macro-elements and means of the exact ones over them."
    return Outcome(rows, Figure(Draw, columns=3), caption)


# --- press fit -----------------------------------------------------------------------------------


@cache
def Fit(maxh, finite):
    """Two rings, 10 to 20 and 20 to 30, of which the inner one is .01 too large: table, force."""
    inner = MoveTo(10, 0).Rectangle(10, 2).Face()
    outer = MoveTo(20, 3).Rectangle(10, 2).Face()
    inner.edges.name = outer.edges.name = "ends"
    inner.edges.Max(X).name, outer.edges.Min(X).name = "slave", "master"
    inner.edges.Min(X).name = outer.edges.Max(X).name = "free"
    inner.edges["slave"].maxh = 0.7 * maxh
    ngmesh = OCCGeometry(Compound([inner, outer]), dim=2).GenerateMesh(maxh=maxh)
    for vertex in ngmesh.Points():  # meshed apart, or both would have the same nodes
        vertex[1] -= 3 * (vertex[1] > 2.5)
    V = VectorH1(Mesh(ngmesh), order=3, dirichlety="ends")
    pair = Pair(V, 210e3, NU, finite=finite, master="master", offset=-0.01)
    return Sorted(pair.Solve().table, lambda x: x[:, 1]), pair.contact.Force()


def Fits(quick):
    rows, exact, drawn = [], 24.609375 / (1 - NU**2), {}
    for finite in (False, True):
        (table, force), (other, _) = (Fit(maxh, finite) for maxh in (1.0, 2.0))
        fine, coarse = table["pressure"], other["pressure"]
        name = "large sliding" if finite else "small sliding"
        strains = Neglected(3e-3, "strains of .001 beside 1")
        bound = strains if finite else Meshes(fine.mean(), coarse.mean(), 2)
        rows.append(Row(f"{name}: mean pressure [MPa]", fine.mean(), exact, bound))
        rows.append(Row(f"{name}: largest difference of pressures [MPa]", np.ptp(fine), 0))
        all_around = -2 * np.pi * 20 * 2 * fine.mean()  # pushes the slave inwards
        even = Neglected(1e-6, "pressures that differ a little along the fit")
        rows.append(Row(f"{name}: radial force [N]", force[0], all_around, even))
        drawn[name] = table

    def Draw(ax):
        ax.axhline(exact, color=INK, lw=0.8, label="Lame")
        for colour, (name, table) in zip((BLUE, ORANGE), drawn.items(), strict=True):
            ax.plot(table["x"][:, 1], table["pressure"], "o", ms=4, color=colour, label=name)
        ax.set(xlabel="z [mm]", ylabel="pressure [MPa]", ylim=(26.5, 27.5))
        ax.legend()

    return Outcome(rows, Figure(Draw, size=(5, 3.2)), "Pressures along the fit.")


# --- NAFEMS' punch -------------------------------------------------------------------------------


@cache
def Rounded(h, friction):
    """The displacement of the middle, and the pressures."""
    mesh = HalfSection(h)
    V = VectorH1(mesh, order=2, dirichlet="bottom", dirichletx="axis")
    pair = Pair(V, mesh.MaterialCF(YOUNG), NU, master="master", friction=friction or None)
    pair.load += -2 * pi * x * LOAD * pair.v[1] * ds("top")
    pair.Solve()
    return pair.gf.components[0](mesh(0, -1e-9))[1], pair.table


def Benchmark(quick):
    h, rows = (1.0 if quick else 0.4), []
    found = {friction: Rounded(h, friction) for friction in PUBLISHED}
    for friction, (middle, _) in found.items():
        exact = PUBLISHED[friction]
        bound = Spread(exact, [LINEAR[friction]], f"linear {LINEAR[friction]}")
        text = f"friction {friction:g}: displacement of the middle"
        rows.append(Row(text, middle, exact, bound, "mm"))

    def Draw(ax):
        for colour, (friction, (_, table)) in zip((BLUE, ORANGE), found.items(), strict=True):
            label = f"friction {friction:g}"
            ax.plot(table["x"][:, 0], table["pressure"], "o", ms=3, color=colour, label=label)
        ax.set(xlabel="distance from the axis [mm]", ylabel="pressure [MPa]")
        ax.legend(loc="upper left")

    return Outcome(rows, Figure(Draw, size=(6, 3.4)), "Pressures of the macro-elements.")


# --- a stack of plates and balls -----------------------------------------------------------------

# Displacement of the lower plate's middle [mm] and reaction [N per radian] of code_aster, and means
# of Abaqus, Systus and Samcef with their accuracy.
ASTER = {"middle": -0.841259653998, "reaction": 17496.6104063}
MEANS = {"middle": (-0.81, 0.04), "reaction": (17229.58, 0.016)}


def Ball(name, y0, radius, h):
    """Half a disc, of which the lower and the upper half have names of their own."""
    disc = WorkPlane(Axes((0, y0, 0), Z, X)).Circle(radius).Face()
    corners = MoveTo(0, y0 - 2 * radius), MoveTo(0, y0)
    ball = Glue([disc * corner.Rectangle(2 * radius, 2 * radius).Face() for corner in corners])
    for edge in ball.edges:
        half = "low" if edge.center.y < y0 else "high"
        inside = abs(edge.start.y - edge.end.y) < 1e-9
        edge.name = "inside" if inside else f"{name}_{half}"
    Finer(ball, h, (y0 - radius, y0 + radius))
    return ball


def Plate(low, width, height, h, touches):
    """A section of a plate, with small edges where its middle touches a ball."""
    plate = MoveTo(0, low).Rectangle(width, height).Face()
    plate.edges.name = "free"
    Finer(plate, h, (low + height * (touches > low),))
    return plate


def Finer(body, h, heights):
    """Name the axis; elements have the size h at these places on it."""
    for edge in body.edges:
        if abs(edge.center.x) < 1e-9:
            edge.name = "axis"
    for vertex in body.vertices:
        if abs(vertex.p.x) < 1e-9 and np.abs(np.subtract(heights, vertex.p.y)).min() < 1e-9:
            vertex.maxh = h


@cache
def Stacked(h, order):
    """Middle of the lower plate and reaction per radian where the upper plate has come down."""
    lower, upper = Plate(0, 20, 4, h, 4), Plate(34, 10, 2, h, 34)
    lower.edges.Max(X).name, lower.edges.Max(Y).name = "rim", "seat"
    upper.edges.Max(Y).name, upper.edges.Min(Y).name = "top", "lid"
    balls = Ball("big", 14, 10, 0.7 * h), Ball("small", 29, 5, 0.7 * h)
    geometry = OCCGeometry(Compound([lower, *balls, upper]), dim=2)
    mesh = Mesh(geometry.GenerateMesh(maxh=1.5, grading=0.25)).Curve(order)
    V = VectorH1(mesh, order=order, dirichlet="rim|top", dirichletx="axis")
    pairs = {"big_low": "seat", "small_low": "big_high", "small_high": "lid"}
    fes = FESpace([V, *(LACSpace(V, slave=slave, axisymmetric=True) for slave in pairs)])
    (u, *lams), (v, *_) = fes.TnT()
    stress = Stress(Sym(AxisymmetricGrad(u)), 2e5, NU)
    a = BilinearForm(fes)
    a += 2 * pi * x * InnerProduct(stress, Sym(AxisymmetricGrad(v))) * dx
    contacts = [
        LACContact(u, lam, master=master, finite=True)
        for lam, master in zip(lams, pairs.values(), strict=True)
    ]
    gf, way = GridFunction(fes), Parameter(0)
    solver = ContactSolver(a, gf, contacts)
    stepper = LoadStepper(solver, way, prescribe={"top": CF((0, -way))})
    stepper.Integrate(2.0, steps=4, printing=False)
    forces = [abs(contact.Force()[1]) / (2 * np.pi) for contact in contacts]
    return gf.components[0](mesh(1e-9, 1e-9))[1], forces, stepper.Table()


def Stack(quick):
    fine, coarse = (0.05, 0.1) if quick else (0.02, 0.05)
    middle, forces, table = Stacked(fine, 2 if quick else 3)
    other, other_forces, _ = Stacked(coarse, 2 if quick else 3)
    rows, found = [], {"middle": (middle, other), "reaction": (forces[0], other_forces[0])}
    for name, unit in ("middle", "mm"), ("reaction", "N"):
        mean, accuracy = MEANS[name]
        meshes = Meshes(*found[name], coarse / fine)
        source = f"mean of three programs, code_aster {ASTER[name]:.5g}"
        text = {
            "middle": "displacement of the lower plate's middle",
            "reaction": "force per radian",
        }
        bound = Both(Stated(accuracy, source), meshes)
        rows.append(Row(text[name], found[name][0], mean, bound, unit))
    text = "difference of the forces in the three contacts"
    rows.append(Row(text, np.ptp(forces) / forces[0], 0, Tolerance(1e-8)))

    def Draw(ax):
        ax.plot([0, *table["load"]], [0, *(-table["force"][:, 2, 1] / 2e3 / np.pi)], "o-", ms=4)
        ax.plot(2, MEANS["reaction"][0] / 1e3, "x", color=ORANGE, label="mean of three programs")
        ax.set(xlabel="way of the upper plate [mm]", ylabel="force per radian [kN]")
        ax.legend()

    return Outcome(rows, Figure(Draw, size=(5, 3.2)), "Force over the way of the upper plate.")


CASES = [
    Case(
        "axisym-indenters",
        "Rigid indenters in a section",
        "A sphere, a cone of 80 degrees and a flat punch are pressed into a half-space, "
        "axisymmetric, with ten faces along the contact radius. Pressures are compared with means "
        "of the exact ones over the macro-elements, of which one lies on the axis.",
        HERTZ,
        "pytest tests/validation/test_cases.py -k axisym",
        Indenters,
    ),
    Case(
        "axisym-fit",
        "Press fit in a section",
        "A ring of radii 10 and 20 in one of 20 and 30, with a radial interference of .01 between "
        "planes that hold both along the axis, axisymmetric, in small and in large sliding.",
        "Lame's thick cylinders.",
        "pytest tests/validation/test_cases.py -k axisym",
        Fits,
    ),
    Case(
        "axisym-nafems2",
        "NAFEMS contact benchmark 2 in a section",
        "The rounded punch of [the sector in 3D](nafems2.md), axisymmetric.",
        "A. Konter, NAFEMS (2006); values of code_aster, test SSNA122.",
        "pytest tests/validation/test_cases.py -k axisym",
        Benchmark,
    ),
    Case(
        "axisym-stack",
        "Two balls between two plates",
        "A plate is pressed 2 mm onto a ball of radius 5, which lies on one of radius 10, and that "
        "on a plate that is held on its rim: three contacts, elastic, axisymmetric.",
        "Validation manual of code_aster, V6.01.102 (test SSNA102).",
        "pytest tests/validation/test_cases.py -k axisym",
        Stack,
    ),
]
