"""Heat through contact: by pressure, over a gap that closes, through a spot, and of friction."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
from netgen.occ import Compound, Glue, MoveTo, OCCGeometry, WorkPlane, Y
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Integrate,
    Mesh,
    Parameter,
    Sym,
    VectorH1,
    ds,
    dx,
    grad,
    pi,
    x,
)
from report_bounds import Neglected, Rounding
from report_case import Case, Outcome, Row
from report_pictures import INK, ORANGE, Figure

from ngslac import ContactSolver, Flux, LACContact, LACSpace, LoadStepper
from ngslac.materials import Stress


def Bars(length, *, gap=0.0, width=0.5, sizes=(0.15, 0.21), lower=None):
    """Two upright bars, whose meshes differ; they are meshed apart."""
    bodies, apart = [], 0.5 * length
    for name, start, height, h in (
        ("lower", -(lower or length), lower or length, sizes[1]),
        ("upper", apart, length, sizes[0]),
    ):
        face = MoveTo(0, start).Rectangle(width, height).Face()
        face.faces.name, face.edges.name = name, f"side_{name}"
        ends = ("bottom", "master") if name == "lower" else ("slave", "top")
        face.edges.Min(Y).name, face.edges.Max(Y).name = ends
        face.edges["master" if name == "lower" else "slave"].maxh = h * length
        bodies.append(face)
    ngmesh = OCCGeometry(Compound(bodies), dim=2).GenerateMesh(maxh=0.3 * length)
    for vertex in ngmesh.Points():
        vertex[1] -= (apart - gap) * (vertex[1] > apart / 2)
    return Mesh(ngmesh)


def ByPressure(T, scale):
    """A conductance that is proportional to the pressure."""
    return Flux(T, lambda z: scale * z.pressure * (z.Slave(T) - z.Master(T)))


# --- two bars, a conductance that grows with the pressure ----------------------------------------


def Pressed(finite, pressure, hardness):
    """Flow per area, and the temperatures of both faces."""
    k1, k2 = 16.2, 210.0
    mesh = Bars(1.0)
    V = VectorH1(mesh, order=2, dirichlety="bottom", dirichletx=".*")
    W = H1(mesh, order=2, dirichlet="bottom|top")
    fes = V * W * LACSpace(V, slave="slave")
    (u, T, lam), (v, S, _) = fes.TnT()
    a = BilinearForm(fes)
    a += InnerProduct(Stress(Sym(Grad(u)), 1e7, 0.0), Sym(Grad(v))) * dx
    a += pressure * v[1] * ds("top")
    a += mesh.MaterialCF({"upper": k1, "lower": k2}) * grad(T) * grad(S) * dx
    flux = ByPressure(T, 2 * k1 * k2 / (k1 + k2) / hardness)
    contact = LACContact(u, lam, master="master", finite=finite, flux=flux)
    gf = GridFunction(fes)
    given = mesh.BoundaryCF({"top": 800.0, "bottom": 250.0})
    gf.components[1].Set(given, definedon=mesh.Boundaries("top|bottom"))
    ContactSolver(a, gf, contact).Solve(printing=False)
    faces = [Integrate(gf.components[1], mesh.Boundaries(n)) / 0.5 for n in ("slave", "master")]
    return contact.Table()["flux_out"].mean(), *faces


def Conductance(quick):
    rows, k1, k2 = [], 16.2, 210.0
    for pressure, hardness in ((1.0, 1.0), (100.0, 26.875)):
        resistance = 1 / (2 * k1 * k2 / (k1 + k2) * pressure / hardness)
        flow = 550 / (1 / k1 + resistance + 1 / k2)
        exact = flow, 800 - flow / k1, 250 + flow / k2
        for finite in (False, True):
            found = Pressed(finite, pressure, hardness)
            for name, ours, reference in zip(
                ("flow [W/m2]", "upper face [K]", "lower face [K]"), found, exact, strict=True
            ):
                words = f"{name}, {pressure:g} Pa, {'large' if finite else 'small'} sliding"
                rows.append(Row(words, ours, reference, Rounding(kind="relative")))

    def Draw(ax):
        pressures = np.geomspace(0.01, 100, 30)
        some = np.geomspace(0.01, 100, 5)
        h = 2 * k1 * k2 / (k1 + k2)
        ax.semilogx(pressures, 550 / (1 / k1 + 1 / k2 + 1 / (h * pressures)), color=INK, lw=0.8)
        ax.semilogx(some, [Pressed(False, p, 1.0)[0] for p in some], "o", ms=4, color=ORANGE)
        ax.set(xlabel="pressure over hardness", ylabel="flow [W/m2]")

    caption = "Flow over the pressure: the line is that of three resistances in a row."
    return Outcome(rows, Figure(Draw, size=(6, 3.2)), caption)


# --- a heated rod closes a gap -------------------------------------------------------------------


def Grown(finite, hot, gap=0.05):
    """Pressure and flow per area as a rod of 100 mm, hot on top, has grown down to a cold base."""
    young, expansion, conductivity = 200e3, 12e-6, 0.05
    mesh = Bars(100.0, gap=gap, lower=10.0, width=20.0)
    V = VectorH1(mesh, order=2, dirichlety="bottom|top|master", dirichletx=".*")
    W = H1(mesh, order=2, dirichlet="bottom|top|master|side_lower")
    fes = V * W * LACSpace(V, slave="slave")
    (u, T, lam), (v, S, _) = fes.TnT()
    a = BilinearForm(fes)
    strain = Sym(Grad(u)) - expansion * T * Id(2)
    a += InnerProduct(Stress(strain, young, 0.0), Sym(Grad(v))) * dx
    a += conductivity * grad(T) * grad(S) * dx
    contact = LACContact(u, lam, master="master", finite=finite, flux=ByPressure(T, 1e-5))
    gf = GridFunction(fes)
    gf.components[1].Set(hot, definedon=mesh.Boundaries("top"))
    ContactSolver(a, gf, contact).Solve(printing=False)
    table = contact.Table()
    return table["pressure"].mean(), table["flux_out"].mean()


def PressureOf(hot, gap=0.05):
    """The root of  p = E (alpha (T1 + T2)/2 - g/L),  with  q = T1/(L/k + 1/(h p)), T2 = q/(h p)."""
    young, expansion, k, length, h = 200e3, 12e-6, 0.05, 100.0, 1e-5
    low, high = 0.0, young * expansion * hot
    for _ in range(200):
        p = (low + high) / 2
        end = hot / (1 + h * p * length / k)
        low, high = (
            (p, high) if young * (expansion * (hot + end) / 2 - gap / length) > p else (low, p)
        )
    return p, (hot - end) * k / length


def Rod(quick):
    rows = []
    for finite in (False, True):
        words = f", {'large' if finite else 'small'} sliding"
        pressure, flow = Grown(finite, 200.0)
        # With large sliding pressures count per area of the reference, and gaps are as exact.
        bound = Neglected(2e-6, "gaps and strains of 5e-4 beside lengths") if finite else None
        bound = bound or Rounding(kind="relative")
        rows.append(Row("pressure [MPa]" + words, pressure, 190.0, bound))
        rows.append(Row("flow [W/mm2]" + words, flow, 0.0791667, Neglected(1e-6, "its digits")))

    def Draw(ax):
        some, many = np.linspace(20, 200, 7), np.linspace(42, 200, 50)
        ax.plot([0, 41.67, *many], [0, 0, *(PressureOf(t)[0] for t in many)], color=INK, lw=0.8)
        ax.plot(some, [Grown(False, t)[0] for t in some], "o", ms=4, color=ORANGE)
        ax.set(xlabel="temperature on top [K]", ylabel="pressure [MPa]")

    caption = "Pressure over the temperature: the gap is closed from 42 K on."
    return Outcome(rows, Figure(Draw, size=(6, 3.2)), caption)


# --- constriction --------------------------------------------------------------------------------

SPOT, FAR = 1.0, 5.0  # mm; the outer surface is an ellipsoid with the spot's edge as focal ring


def Half(name, sign, n):
    """Half of half a section: a quarter of an ellipse, n edges on the spot on its straight side."""
    wide, deep = SPOT * np.sqrt(1 + FAR**2), SPOT * FAR
    ellipse = WorkPlane().Ellipse(wide, deep).Face()
    parts = []
    for start, width in ((0.0, SPOT), (SPOT, 2 * wide)):
        corner = (start, 0 if sign > 0 else -2 * wide)
        parts.append(ellipse * MoveTo(*corner).Rectangle(width, 2 * wide).Face())
    body = Glue(parts)
    body.faces.name = name
    narrow = 1 - (1 - np.arange(1, n) / n) ** 2  # towards the edge of the spot
    for edge in body.edges:
        xs, ys = np.array([(v.p.x, v.p.y) for v in edge.vertices]).T
        edge.name = f"far_{name}"
        if np.ptp(ys) < 1e-9 and xs.max() < SPOT + 1e-9:
            edge.name = "slave" if sign > 0 else "master"
            edge.partition = list(narrow if edge.start.x < edge.end.x else 1 - narrow[::-1])
        elif np.ptp(ys) < 1e-9:
            edge.name = f"free_{name}"
        elif np.abs(xs).max() < 1e-9:
            edge.name = f"axis_{name}"
        elif np.ptp(xs) < 1e-9:
            edge.name = f"inside_{name}"
    for vertex in body.vertices:
        if abs(vertex.p.x - SPOT) < 1e-9 and abs(vertex.p.y) < 1e-9:
            vertex.hpref, vertex.maxh = 1, 0.08 / n
    return body


@cache
def Spot(n, conductivity=(50.0, 50.0)):
    """Resistance of the spot [K/W] with n edges on it, and where how much flows there."""
    lower, upper = Half("lower", -1, round(0.7 * n)), Half("upper", 1, n).Move((0, 1, 0))
    geometry = OCCGeometry(Compound([lower, upper]), dim=2)
    mesh = Mesh(geometry.GenerateMesh(maxh=0.5, grading=0.3))
    mesh.RefineHP(10, 0.3)
    mesh.Curve(5)
    W = H1(mesh, order=5, dirichlet="far_.*")
    fes = W * LACSpace(W, slave="slave", axisymmetric=True)
    (T, q), (S, _) = fes.TnT()
    k = mesh.MaterialCF(dict(zip(("upper", "lower"), conductivity, strict=True)))
    a = BilinearForm(2 * pi * x * 1e-3 * k * grad(T) * grad(S) * dx)  # W/(mm K)
    contact = LACContact(T, q, master="master", tied=True)
    gf = GridFunction(fes)
    gf.components[0].Set(1, definedon=mesh.Boundaries("far_upper"))
    ContactSolver(a, gf, contact).Solve(printing=False)
    table = contact.Table()
    return 1 / contact.Flow()[0], table["x"][:, 0], table["flux"]


def Constriction(quick):
    rows, exact = [], np.arctan(FAR) / (2 * pi * SPOT * 1e-3)
    n = 40 if quick else 160
    for k in ((50.0, 50.0), (50.0, 200.0)):
        found = Spot(n, k)[0]
        reference = exact * (1 / k[0] + 1 / k[1])
        bound = Neglected(2e-5 if quick else 1e-6, "flows that are constant on faces")
        rows.append(Row(f"{k[0]:g} on {k[1]:g} W/(m K) [K/W]", found, reference, bound))

    def Draw(ax):
        resistance, radius, flow = Spot(40)
        rs = np.linspace(0, 0.995, 200)
        ax.plot(rs, 1 / (2 * pi * SPOT**2 * np.sqrt(1 - rs**2)), color=INK, lw=0.8)
        ax.plot(radius, flow * resistance, "o", ms=4, color=ORANGE)
        ax.set(
            xlabel="radius over that of the spot", ylabel="flow over its sum [1/mm2]", ylim=(0, 1)
        )

    caption = "Flow in the spot (dots), and that of an isothermal disc (line)."
    return Outcome(rows, Figure(Draw, size=(6, 3.2)), caption)


# --- heat of friction ----------------------------------------------------------------------------

STEEL, ALUMINIUM = (50.0, 7800 * 500.0), (200.0, 2700 * 900.0)  # W/(m K), J/(m3 K)


def Rubbing(steps, share=0.5):
    """A steel bar on one of aluminium: temperatures, and parts of the power that bars get."""
    pressure, speed, friction = 1e9, 1e-3, 0.2
    face = (
        MoveTo(0, -0.09).Rectangle(0.02, 0.09).Face(),
        MoveTo(0, 0.1).Rectangle(0.02, 0.045).Face(),
    )
    for body, name, ends in (
        (face[0], "lower", ("bottom", "master")),
        (face[1], "upper", ("slave", "top")),
    ):
        body.faces.name, body.edges.name = name, f"side_{name}"
        body.edges.Min(Y).name, body.edges.Max(Y).name = ends
    face[0].edges["master"].maxh, face[1].edges["slave"].maxh = 0.0031, 0.0025
    ngmesh = OCCGeometry(Compound(face), dim=2).GenerateMesh(maxh=0.008, grading=0.2)
    for vertex in ngmesh.Points():
        vertex[1] -= 0.1 * (vertex[1] > 0.05)
    mesh = Mesh(ngmesh)
    V = VectorH1(mesh, order=2, dirichlety="bottom", dirichletx="bottom|top|side_.*")
    W = H1(mesh, order=4)
    fes = V * W * LACSpace(V, slave="slave")
    (u, T, lam), (v, S, _) = fes.TnT()
    gf, before, time = GridFunction(fes), GridFunction(W), Parameter(0)
    joint = Flux(
        T, lambda z: 1e10 * (z.Slave(T) - z.Master(T)), heat=lambda z: z.power, share=share
    )
    contact = LACContact(u, lam, master="master", friction=friction, flux=joint)
    k, capacity = (
        mesh.MaterialCF({"upper": one, "lower": other})
        for one, other in zip(STEEL, ALUMINIUM, strict=True)
    )
    a = BilinearForm(fes)
    a += InnerProduct(Stress(Sym(Grad(u)), 1e16, 0.0), Sym(Grad(v))) * dx + pressure * v[1] * ds(
        "top"
    )
    a += (k * grad(T) * grad(S) + capacity * (T - before) / contact.dt * S) * dx

    def Remember(_):
        before.vec.data = gf.components[1].vec

    moved = {"top|side_upper": CF((speed * time, 0)), "bottom|side_lower": CF((0, 0))}
    stepper = LoadStepper(ContactSolver(a, gf, contact), time, prescribe=moved)
    for part in np.arange(1, steps + 1) / steps:  # the temperature grows with the root of time
        stepper.Integrate(part**2, steps=1, printing=False, callback=Remember)
    out, into = contact.Flow()
    faces = [Integrate(gf.components[1], mesh.Boundaries(n)) / 0.02 for n in ("slave", "master")]
    return np.array([*faces, -out / (into - out), (into - out) / 0.02])


def Friction(quick):
    effusivity = [np.sqrt(k * c) for k, c in (STEEL, ALUMINIUM)]
    steps = 10 if quick else 20
    found = [Rubbing(steps * many) for many in (1, 2, 4)]
    coarse, fine = (2 * more - less for less, more in pairwise(found))  # of first order
    steel, aluminium, share, power = (4 * fine - coarse) / 3
    exact = 2 * 2e5 / (np.sqrt(pi) * sum(effusivity))
    time = Neglected(4e-4 / steps**2, "third order of the steps; a joint and bars that give way")
    rows = [
        Row("power of friction [W/m2]", power, 2e5, Rounding(kind="relative")),
        Row("part that steel gets", share, effusivity[0] / sum(effusivity), time),
        Row("steel after 1 s [K]", steel, exact, time),
        Row("aluminium after 1 s [K]", aluminium, exact, time),
    ]

    def Draw(ax):
        counts = (5, 10, 20, 40)
        errors = [abs(Rubbing(n)[0] / exact - 1) for n in counts]
        ax.loglog(counts, errors, "o-", ms=4, color=ORANGE)
        ax.loglog(counts, 0.165 / np.array(counts), color=INK, lw=0.8)
        ax.set(xlabel="steps", ylabel="error of the temperature")

    caption = "Error of the implicit Euler method over the number of steps (line: first order)."
    return Outcome(rows, Figure(Draw, size=(6, 3.2)), caption)


CASES = [
    Case(
        "conductance",
        "Heat flows the better the harder bodies are pressed",
        "Two bars, hot on top and cold at the bottom, are pressed together; the conductance of "
        "the contact grows with the pressure. Displacement and temperature in one system.",
        "Three resistances in a row; data of a test of MOOSE (closed_gap_pressure_dependent).",
        "pytest tests/validation/test_cases.py -k conductance",
        Conductance,
    ),
    Case(
        "heated-rod",
        "A heated rod closes a gap",
        "A rod, hot on top, grows down to a cold base; the harder it presses, the more heat gets "
        "out, and the less it grows.",
        "The root of p = E (alpha (T1 + T2)/2 - g/L) with q = T1/(L/k + 1/(h p)), T2 = q/(h p).",
        "pytest tests/validation/test_cases.py -k heated-rod",
        Rod,
    ),
    Case(
        "constriction",
        "Heat squeezes through a spot",
        "Two bodies touch in a spot, with perfect conductance there; the flow has no bound at its "
        "edge. Their outer surfaces are ellipsoids with the spot's edge as focal ring. "
        "Axisymmetric.",
        "Potential of a disc: R = arctan(b/a) (1/k1 + 1/k2)/(2 pi a), b the short half axis.",
        "pytest tests/validation/test_cases.py -k constriction",
        Constriction,
    ),
    Case(
        "frictional-heat",
        "Friction heats two bars",
        "A bar of steel slides on one of aluminium; the heat of friction goes into both. The "
        "joint conducts well, so that the temperatures are equal.",
        "Half-spaces: T = 2 q sqrt(t/pi)/(b1 + b2), b the roots of conductivity times capacity.",
        "pytest tests/validation/test_cases.py -k frictional-heat",
        Friction,
    ),
]
