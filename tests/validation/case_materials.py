"""Materials under contact, of the examples: plasticity, rubber, thermal strain."""

from __future__ import annotations

from functools import cache

import heateddisc
import hertz_large
import indentation
import numpy as np
from indentation import PRANDTL, Depths, Indenter
from netgen.occ import Glue, MoveTo, OCCGeometry, Y
from ngsolve import (
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    IfPos,
    Integrate,
    Mesh,
    Parameter,
    Sym,
    Variation,
    VectorH1,
    dx,
    pi,
    sqrt,
    x,
)
from plasticity import J2Plasticity
from report_bounds import Both, Element, Meshes, Neglected, Stated, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import INK, Figure, FromFolder

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import AxisymmetricGrad


def Indentation(quick):
    h, steps = (0.4, 8) if quick else (0.2, 16)
    cycles = [indentation.Cycle(Indenter(h=size), 0.08, steps, steps) for size in (h, 2 * h)]
    figures, coarser = (
        cycle.figures | {"onset_pressure": indentation.Onset(h=cycle.indenter.h)}
        for cycle in cycles
    )

    names = ("onset_pressure", "imprint_depth")
    onset, imprint = (Meshes(figures[name], coarser[name], 2) for name in names)
    peak, hertz = figures["onset_pressure"], figures["onset_pressure_hertz"]
    mean, where = figures["mean_pressure_ratio"], "where the cylinder leaves, and at the middle"
    depths = figures["permanent_depth"], figures["imprint_depth"]
    rows = [
        Row("peak pressure over yield stress at onset", peak, hertz, onset),
        Row("mean pressure over yield stress, fully plastic", mean, PRANDTL),
        Row(f"depth left: {where}", *depths, imprint, "mm"),
        Row("force at the end of the second loading", figures["reloading_force_ratio"], 1),
        Row("reaction against contact force", figures["balance"], 0, Tolerance()),
    ]
    if not quick:
        rows.append(Row("mean pressure over yield stress, soft block", *RigidPlastic()))
    caption = "Force over depth, mean pressure over the width, plastic strain and imprint."
    draw = FromFolder(lambda folder: indentation.Draw(cycles[0], folder), "indentation.png")
    return Outcome(rows, draw, caption)


def RigidPlastic():
    """Mean pressure where elasticity plays no role, and Prandtl's."""
    problem = Indenter(h=0.4, yield_stress=8.0, hardening=1.6)
    last = problem.Advance(Depths(steps=8)[0])[-1]
    return last["mean_pressure"] / problem.yield_stress, PRANDTL


# Force [N per radian] of a rigid sphere on a rigid plastic half-space, per depth [mm]: a mean
# pressure of three times the yield stress, and a depth of .368 a^2/R (Johnson, pages 171, 200).
RADIUS, YIELD, DEEPEST = 500.0, 50.0, 100.0
FULLY_PLASTIC = 3 * np.pi * RADIUS * YIELD / 0.368 / (2 * np.pi)
# At each fifth of the depth: what code_aster computes, and the accuracy that it states.
ASTER = (2.0680562649761e6, 4.0469773379688e6, 5.8272986321138e6, 7.6663171661817e6, 9.1189947e6)
STATED = (0.05, 0.05, 0.05, 0.1, 0.15)


@cache
def Dent(h, steps):
    """Depths and forces per radian of a rigid sphere on a block that yields without hardening."""
    fine = MoveTo(0, -360).Rectangle(540, 360).Face()
    fine.edges.Max(Y).name, fine.edges.Max(Y).maxh = "slave", h
    body = Glue([fine, MoveTo(0, -1920).Rectangle(1620, 1920).Face() - fine])
    for edge in body.edges:
        if edge.name != "slave":
            low = edge.center.y < -1919
            edge.name = "axis" if edge.center.x < 1e-6 else "bottom" if low else "free"
    mesh = Mesh(OCCGeometry(body, dim=2).GenerateMesh(maxh=200, grading=0.2))
    V = VectorH1(mesh, order=2, dirichlet="bottom", dirichletx="axis")
    fes = V * LACSpace(V, slave="slave", axisymmetric=True)
    u, lam = fes.TrialFunction()
    block = J2Plasticity(mesh, young=210e3, poisson=0.3, yield_stress=YIELD)
    a = BilinearForm(fes)
    energy = 2 * pi * x * block.Energy(Sym(AxisymmetricGrad(u)))
    a += Variation(energy * dx(intrules=block.rules))
    gf, depth = GridFunction(fes), Parameter(0)
    strain = Sym(AxisymmetricGrad(gf.components[0]))
    sphere = RADIUS - sqrt(IfPos(RADIUS - x, RADIUS**2 - x**2, 0))
    contact = LACContact(u, lam, obstacle=sphere - depth)
    stepper = LoadStepper(ContactSolver(a, gf, contact), depth)
    first = [1, 2] if steps < 50 else [1]
    depths, forces = [*first, *DEEPEST * np.arange(1, steps + 1) / steps], []
    for end in depths:
        stepper.Integrate(end, steps=1, printing=False, callback=lambda _: block.Commit(strain))
        forces.append(-contact.Force()[1] / (2 * np.pi))
    return np.array(depths), np.array(forces)


def Dented(quick):
    h, steps = (30.0, 10) if quick else (10.0, 40)
    depths, forces = Dent(h, steps)
    rows = []
    for k, (aster, stated) in enumerate(zip(ASTER, STATED, strict=True), 1):
        depth = k * DEEPEST / 5
        exact, width = FULLY_PLASTIC * depth, np.sqrt(RADIUS * depth / 0.368)
        source = f"for small depths, code_aster {aster:.5g}"
        # The force grows with the square of the radius, by a face at once.
        bound = Both(Stated(stated, source), Element(h / width, "half of one", kind="relative"))
        found = forces[np.isclose(depths, depth)][0]
        rows.append(Row(f"force per radian at a depth of {depth:g}", found, exact, bound, "N"))

    def Draw(ax):
        ax.plot([0, DEEPEST], [0, FULLY_PLASTIC * DEEPEST / 1e6], color=INK, label="rigid plastic")
        ax.plot(depths, forces / 1e6, ".-", label="computed")
        ax.plot(DEEPEST * np.arange(1, 6) / 5, np.array(ASTER) / 1e6, "x", label="code_aster")
        ax.set(xlabel="depth [mm]", ylabel="force per radian [MN]")
        ax.legend()

    return Outcome(rows, Figure(Draw, size=(5, 3.4)), "Force over the depth.")


def Squeezed(h=0.08, depth=0.25, steps=5, order=2):
    """Figures of a cord that is squeezed by a part of its diameter, and its largest pressure."""
    how = {"nu": 0.4999, "mixed": True, "order": order}
    figures = hertz_large.Run(h, depth=depth, steps=steps, **how)
    peak = figures["solution"].contact.Table()["pressure"].max()
    return figures | {"force": figures["force"][-1], "peak_pressure": peak}


def Rubber(quick):
    rubber, small = Squeezed(), Squeezed(0.04 if quick else 0.02, 0.005, 1)["force"]
    thermal, hot = heateddisc.Run(), heateddisc.Run(h=3.0)
    exact, moved = hertz_large.HertzForce(0.005, 0.5), rubber["solution"].gf.components[0]
    # Half of the contact over the radius of the cord, with the modulus 4 G: Hertz.
    strain = Neglected(np.sqrt(0.75 * exact / np.pi), "strains of a/(2 R)")
    meshes = Meshes(hot["pressure"], thermal["pressure"], 2)
    mesh = moved.space.mesh
    change = Integrate(Det(Grad(moved) + Id(2)), mesh, order=6) / Integrate(1, mesh) - 1
    rows = [
        Row("cord: force at half a percent", small, exact, strain, "N/mm"),
        Row("cord: change of the volume at a quarter", change, 0),
        Row("heated disc: pressure over E, faces of 6", thermal["pressure"], thermal["lame"]),
        Row("heated disc: the same, finer", hot["pressure"], hot["lame"], meshes),
    ]
    if not quick:
        fine = Squeezed(0.05, order=3, steps=3)
        for key in ("force", "peak_pressure"):
            text = f"cord: {key.replace('_', ' ')} at a quarter, against order 3"
            rows.append(Row(text, rubber[key], fine[key]))
    draw = FromFolder(lambda folder: heateddisc.Run(out=folder), "heateddisc.png")
    return Outcome(rows, draw, "Hoop stress of the disc and of the ring around it.")


CASES = [
    Case(
        "indentation",
        "Elastoplastic indentation",
        "A rigid cylinder is pressed into a block that yields (von Mises, a little hardening), "
        "withdrawn, and pressed again. The mean pressure rises from Hertz' at the onset of yield "
        "to Prandtl's of the rigid plastic body, which a block reaches only if it is soft enough.",
        "Johnson (1985), sections 6.1, 6.2 and 6.4: 1.79 Y at the onset, (2 + pi) k when fully "
        "plastic.",
        "python tutorials/examples/indentation.py --out results",
        Indentation,
    ),
    Case(
        "dent",
        "A sphere on a block that yields",
        "A rigid sphere of radius 500 is pressed by 100 mm into a block of perfect plasticity, "
        "with small strains and small sliding, axisymmetric. The slope of the sphere grows up to "
        ".9, far beyond the small depths of the theory.",
        "Johnson (1985), pages 171 and 200, as in the validation manual of code_aster, V6.04.506.",
        "pytest tests/validation/test_cases.py -k dent",
        Dented,
    ),
    Case(
        "materials",
        "Rubber and thermal strain",
        "A cord of nearly incompressible rubber is squeezed by a quarter of its diameter, with "
        "displacement and hydrostatic pressure as unknowns; a heated disc presses against the "
        "cold ring around it.",
        "Johnson (1985), equation 5.57, for small squeezes; Lamé's thick-walled cylinders; order "
        "3 on a finer mesh.",
        "python tutorials/examples/heateddisc.py --out results",
        Rubber,
    ),
]
