"""Derivatives of solutions: Hertz' exponents, a press fit and wear by hand, and differences."""

from __future__ import annotations

from functools import cache

import numpy as np
from case_axisymmetric import FAR, HERTZ, HalfSpace, Sphere
from netgen.occ import MoveTo, OCCGeometry, Y
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Mesh,
    Parameter,
    Sym,
    VectorH1,
    dx,
    pi,
    sqrt,
    x,
    y,
)
from report_bounds import Element, Neglected, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import INK, ORANGE, Figure
from rings import COMMON, INNER, OUTER, YOUNG, rings_mesh
from rings import NU as RINGS_NU
from varied import Slide, differences

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.analysis import Record, Sensitivity, Shape
from ngslac.materials import AxisymmetricGrad, Stress

TOL = 1e-12
COMMAND = "pytest tests/validation/test_cases.py -k "

# --- Hertz ---------------------------------------------------------------------------------------

CAUSES = "load", "modulus", "radius"
# Of the largest pressure, the half-width and the approach, at a constant load.
POINT = {
    "largest pressure": (1 / 3, 2 / 3, -2 / 3),
    "contact radius": (1 / 3, -1 / 3, 1 / 3),
    "approach": (2 / 3, -2 / 3, -1 / 3),
}
LINE = {"largest pressure": (1 / 2, 1 / 2, -1 / 2), "half-width": (1 / 2, -1 / 2, 1 / 2)}


# Macro-elements that contact grows by, on either side of the middle; depths in between.
ACROSS, SAMPLES = 3, 40


@cache
def Indented(faces, *, line):
    """Logarithmic derivatives (3, 3) of p0, a and approach by load, modulus and radius.

    A half-space, or a half-plane, under a rigid parabola. As contact grows by whole macro-elements,
    the slopes swing with each of them: they are means over some, with weights that end smoothly.
    """
    sphere = Sphere()
    mesh = HalfSpace(sphere, faces)
    V = VectorH1(mesh, order=2, dirichletx="axis|far", dirichlety="far")
    fes = V * LACSpace(V, slave="slave", axisymmetric=not line)
    (u, lam), (v, _) = fes.TnT()
    depth, young, radius = Parameter(sphere.radius**2), Parameter(1.0), Parameter(1.0)
    grad, turn = (Grad, 1.0) if line else (AxisymmetricGrad, 2 * pi * x)
    a = BilinearForm(fes)
    a += turn * InnerProduct(Stress(Sym(grad(u)), young, 0.3), Sym(grad(v))) * dx
    contact = LACContact(u, lam, obstacle=x**2 / (2 * radius) - depth)
    solver = ContactSolver(a, GridFunction(fes), contact)

    def Logarithms():
        """Of the load, and of p0 and a by the moments of Hertz' profile."""
        table = contact.Table()
        pressure, area, r = table["pressure"], table["area"], table["x"][:, 0]
        load, squares, spread = (area @ f for f in (pressure, pressure**2, pressure * r**2))
        return np.log([load, squares / load, np.sqrt(spread / load)])

    found = np.zeros((3, 3))
    parts = (np.arange(SAMPLES) + 0.5) / SAMPLES
    for part in parts:
        depth.Set(sphere.radius**2 * (1 + (2 * part - 1) * ACROSS / faces) ** 2)
        solver.Solve(printing=False, tol=TOL)
        s = Sensitivity(solver, Logarithms)
        slopes = [s.By(p) * p.Get() for p in (depth, young, radius)]
        found += (1 - np.cos(2 * np.pi * part)) / SAMPLES * np.array(slopes)
    by_depth, by_young, by_radius = found
    # The depth follows from a constant load.
    ways = np.array([1, -by_young[0], -by_radius[0]]) / by_depth[0]
    rest = [np.zeros(3), by_young, by_radius]
    found = [part + way * by_depth for part, way in zip(rest, ways, strict=True)]
    return np.array([*np.array(found)[:, 1:].T, ways])


def Exponents(quick):
    rows, faces = [], 16 if quick else 48
    swing = Element(1 / faces, f"{faces} on the contact radius", kind="relative")
    far = Neglected(1 / FAR, "contact radius over the size of the half-space")
    for line, known in ((False, POINT), (True, LINE)):
        found, body = Indented(faces, line=line), "cylinder" if line else "sphere"
        for values, (name, exponents) in zip(found, known.items(), strict=False):
            bound = far if name == "approach" else swing
            for value, cause, exponent in zip(values, CAUSES, exponents, strict=True):
                rows.append(Row(f"{body}: {name} by {cause}", value, exponent, bound))

    def Draw(ax):
        names = [row.quantity for row in rows]
        ax.barh(names, [row.reference for row in rows], color=INK, height=0.2, label="Hertz")
        ax.plot([row.ours for row in rows], names, "o", color=ORANGE, label="computed")
        ax.legend()
        ax.set(xlabel="exponent")

    caption = "Exponents of largest pressure, size of the contact and approach at a constant load."
    return Outcome(rows, Figure(Draw, size=(6.4, 4)), caption)


# --- by hand -------------------------------------------------------------------------------------

INTERFERENCE = 0.01


def Rings(n):
    """Rows of derivatives of the pressure of a press fit: by interference, modulus and radii."""
    mesh = rings_mesh(n, 4)
    V = VectorH1(mesh, order=2, dirichletx="symx", dirichlety="symy")
    fes = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    young, overlap = Parameter(YOUNG), Parameter(INTERFERENCE)
    a = BilinearForm(InnerProduct(Stress(Sym(Grad(u)), young, RINGS_NU), Sym(Grad(v))) * dx)
    contact = LACContact(u, lam, master="master", offset=-overlap, adjust=COMMON)
    solver = ContactSolver(a, GridFunction(fes), contact)
    solver.Solve(printing=False, tol=TOL)
    s = Sensitivity(solver, lambda: np.log(contact.Table()["pressure"]).mean())
    r, outwards = sqrt(x * x + y * y), CF((x, y)) / sqrt(x * x + y * y)
    inner, outer = ({"inner": k, "outer": 1 - k} for k in (1, 0))
    bore = Shape(mesh, mesh.MaterialCF(inner) * (COMMON - r) / (COMMON - INNER) * outwards)
    rim = Shape(mesh, mesh.MaterialCF(outer) * (r - COMMON) / (OUTER - COMMON) * outwards)
    whole = 2 / (OUTER**2 - INNER**2)
    known = {
        "interference": (overlap, INTERFERENCE, 1.0),
        "modulus": (young, YOUNG, 1.0),
        "inner radius": (bore, INNER, INNER**2 * (whole - 2 / (COMMON**2 - INNER**2))),
        "outer radius": (rim, OUTER, OUTER**2 * (2 / (OUTER**2 - COMMON**2) - whole)),
    }
    size = np.pi / 2 * COMMON / n / COMMON
    chord = Neglected(size**2, "the square of the angle of an edge: how far it bends stays")
    exact = Tolerance(1e-7, why=", of differences of the residual")
    for name, (variable, value, exponent) in known.items():
        bound = chord if "radius" in name else exact
        yield Row(f"press fit: pressure by {name}", s.By(variable) * value, exponent, bound)


LENGTH, MODULUS, RATE, WAY = 10.0, 100.0, 1e-4, 1000.0


def WornRod(steps):
    """Rows of a rod between fixed ends that wears at one of them; steps are implicit."""
    rod = MoveTo(0, 0).Rectangle(1, LENGTH).Face()
    rod.edges.name = "side"
    rod.edges.Min(Y).name, rod.edges.Max(Y).name = "slave", "top"
    mesh = Mesh(OCCGeometry(rod, dim=2).GenerateMesh(maxh=1))
    V = VectorH1(mesh, order=2, dirichletx="side", dirichlety="top")
    fes = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    young, rate, way = Parameter(MODULUS), Parameter(RATE), Parameter(0)
    a = BilinearForm(young * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx)

    def Worn(z):
        return z.History("worn", lambda worn: worn + rate * z.pressure * z.dt)

    contact, gf = LACContact(u, lam, obstacle=CF(0), offset=Worn), GridFunction(fes)
    gf.components[0].Set((0, -LENGTH / MODULUS), definedon=mesh.Boundaries("top"))
    solver = ContactSolver(a, gf, contact)
    solver.Solve(printing=False, tol=TOL)
    stepper = LoadStepper(solver, way)
    record = Record(stepper)
    stepper.Integrate(WAY, steps=steps, callback=record, printing=False, tol=TOL)
    s = Sensitivity(record, lambda: contact.Table()["pressure"].mean())
    worn = MODULUS * RATE * WAY / LENGTH  # p = (E d / L) exp(-worn), with the depth d at the top
    first = Neglected(worn / steps, f"the first order of {steps} steps")
    pressure = np.exp(-worn)
    known = {"wear rate": (rate, RATE, -worn), "modulus": (young, MODULUS, 1 - worn)}
    for name, (variable, value, exponent) in known.items():
        found = s.By(variable)[-1] * value
        scale = Neglected(worn / steps, first.why, kind="absolute")
        yield Row(f"worn rod: pressure by {name}", found, exponent * pressure, scale)


def Differences(dims):
    """Rows of the largest relative difference to central differences of whole computations."""
    accurate = Tolerance(1e-6, why=", of differences of whole computations")
    for dim in dims:
        for finite in (False, True):
            slide = Slide(dim, finite=finite, nonlinear=finite)
            record = Record(slide.stepper)
            slide.Run(record)
            found = Sensitivity(record, slide.contact.Force).By(slide.mu)
            other = Slide(dim, finite=finite, nonlinear=finite)

            def Look(other=other):
                other.contact.Update()
                other.problem.gf.vec[:] = 0
                other.load.Set(0)
                return other.Run()[0]

            expected = differences(other.mu, Look, 1e-5)
            error = np.abs(found - expected).max() / np.abs(expected).max()
            sliding = "large" if finite else "small"
            yield Row(f"{dim}D, {sliding} sliding: forces by friction", error, 0.0, accurate)


def ByHand(quick):
    rows = [
        *Rings(12 if quick else 48),
        *WornRod(20 if quick else 160),
        *Differences((2,) if quick else (2, 3)),
    ]
    slide = Slide()
    record = Record(slide.stepper)
    forces, _ = slide.Run(record)
    slopes = Sensitivity(record, slide.contact.Force).By(slide.mu)
    steps = np.arange(1, slide.steps + 1)

    def Draw(ax):
        ax.plot(steps, -forces[:, 0], "o-", color=INK, label="force along")
        ax.plot(steps, -slopes[:, 0], "s-", color=ORANGE, label="its derivative by friction")
        ax.set(xlabel="step", xticks=steps)
        ax.legend()

    caption = "The block that is pushed down and aside: force along, and its derivative."
    return Outcome(rows, Figure(Draw, size=(6, 3.4)), caption)


CASES = [
    Case(
        "hertz-exponents",
        "Hertz' exponents as derivatives",
        "A rigid parabola on a half-space and on a half-plane. Derivatives of load, largest "
        "pressure and size of the contact by depth, modulus and radius, and from them those at a "
        "constant load: means while some macro-elements come into contact.",
        HERTZ,
        COMMAND + "hertz-exponents",
        Exponents,
    ),
    Case(
        "derivatives",
        "Derivatives by hand and by differences",
        "A press fit by its interference, modulus and radii, the latter as changes of shape; a rod "
        "between fixed ends that wears off, through its steps; and a block that is pushed down and "
        "aside, which sticks and then slips, against differences of whole computations.",
        "Timoshenko and Goodier, Theory of Elasticity, art. 28; p = p0 exp(-E k s/L); differences.",
        COMMAND + "derivatives",
        ByHand,
    ),
]
