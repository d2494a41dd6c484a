"""A flattened rubber cylinder, and a ring that is pressed flat onto itself."""

from __future__ import annotations

import math
from functools import cache

import flatring
import hertz_large
import numpy as np
from hertz_large import YOUNG, CylinderMesh
from ngsolve import (
    BND,
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    IfPos,
    InnerProduct,
    Integrate,
    Variation,
    VectorH1,
    ds,
    dx,
    y,
)
from report_bounds import Both, Extrapolated, Meshes, Neglected, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import FromFolder

from ngslac.materials import NeoHooke


@cache
def Flattened(h, steps, **options):
    """The example."""
    return hertz_large.Run(h, steps=steps, **options)


def Penalty(h, depth, steps, factor):
    """Force by a penalty on the rigid plane y = 0, by NGSolve alone."""
    mesh = CylinderMesh(h)
    V = VectorH1(mesh, order=2, dirichletx="sym", dirichlety="middle")
    u, gf, down = V.TrialFunction(), GridFunction(V), GridFunction(V)
    below = -(y + u[1])
    a = BilinearForm(V)
    a += Variation(NeoHooke(Id(2) + Grad(u), YOUNG, 0.49).Compile() * dx)
    a += Variation(factor / 2 * IfPos(below, below, 0) ** 2 * ds("slave", bonus_intorder=10))
    down.Set(CF((0, -depth / steps)))
    residual, step = gf.vec.CreateVector(), gf.vec.CreateVector()
    for _ in range(steps):
        gf.vec.data += down.vec
        for _ in range(40):
            a.Apply(gf.vec, residual)
            a.AssembleLinearization(gf.vec)
            step.data = a.mat.Inverse(V.FreeDofs()) * residual
            gf.vec.data -= step
            if abs(InnerProduct(step, residual)) < 1e-22:
                break
        else:
            raise RuntimeError("the penalty solution does not converge")
    below = -(y + gf[1])
    pressure = factor * IfPos(below, below, 0)
    return 2 * Integrate(pressure, mesh, BND, definedon=mesh.Boundaries("slave"), order=20)


def EnergyError(approach, force, energy):
    """Error of the work of the force relative to the energy gained.

    By Simpson's rule over pairs of equal steps. The first pair starts at rest, where the slope of
    the force is not smooth: the work is counted from its end on.
    """
    n = (len(force) - 2) // 2 * 2
    d, f, w = (np.asarray(values)[-n - 1 :] for values in (approach, force, energy))
    weights = np.ones(n + 1)
    weights[1:-1:2], weights[2:-1:2] = 4, 2
    work = weights @ f * (d[1] - d[0]) / 3
    return float(work / (w[-1] - w[0]) - 1)


@cache
def PenaltyLimit(h, steps):
    """Force for an infinite penalty (the error is in proportion to its inverse), and the last."""
    soft, stiff = (Penalty(h, 0.3, steps, factor) for factor in (200, 800))
    return stiff + (stiff - soft) / 3, stiff


def _Strain(force, modulus, radius=1.0):
    """Largest strain of a line contact in Hertz' theory, about a/(2 R)."""
    return math.sqrt(4 * force * radius / (math.pi * modulus)) / (2 * radius)


def _OfSteps(curves, error):
    """Change of the work if it is summed over pairs of steps; None if they are too few."""
    half = [curve[-15::2] for curve in curves]
    if len(half[0]) < 8:
        return None
    return Meshes(1 + error, 1 + EnergyError(*half), 2, of="steps")


def Cylinder(quick):
    h = 0.2 if quick else 0.1
    options = {"h": h, "steps": 8 if quick else 15}
    figures = Flattened(**options)
    small = Flattened(0.05 if quick else 0.02, 2, depth=0.02)
    limit, stiff = PenaltyLimit(h, 6 if quick else 10)
    modulus = hertz_large.YOUNG / (1 - 0.49**2)
    strains = [Neglected(_Strain(force, modulus), "strains of a/(2 R)") for force in small["hertz"]]
    curves = [figures[name] for name in ("approach", "force", "energy")]
    error = EnergyError(*curves)
    at, against = "force at an approach of", "against a penalty method by NGSolve alone"
    first, second = zip(small["force"], small["hertz"], strains, strict=True)
    force, penalty = figures["force"][-1], Extrapolated(limit, stiff)
    rows = [
        Row(f"{at} 1 % of the radius", *first, "N/mm"),
        Row(f"{at} 2 %", *second, "N/mm"),
        Row(f"force at 30 %, {against}", force, limit, penalty, "N/mm"),
        Row("work of the plates over strain energy", 1 + error, 1, _OfSteps(curves, error)),
    ]
    caption = "The section at the end, the forces and the pressures."

    draw = FromFolder(lambda folder: hertz_large.Run(**options, out=folder), "hertz_large.png")
    return Outcome(rows, draw, caption)


def FlatRing(quick):
    travel, steps = (1.0, 10) if quick else (1.71, 38)
    options = {"travel": travel, "steps": steps}
    table = [
        {key: np.array(v) for key, v in flatring.Run(h, quarter=quarter, **options).items()}
        for h in (0.12, 0.18)
        for quarter in (False, True)
    ]
    before = table[0]["travel"] < 1.6
    worst = np.abs(table[0]["force"] / table[1]["force"] - 1)[before].argmax()

    def Differ(step):
        force = [figures["force"][step] for figures in table]
        return *force[:2], Both(*(Meshes(force[k], force[k + 2], 1.5) for k in range(2)))

    ends = (table[0][key][-1] for key in ("force_below", "force"))
    rows = [
        Row("force before the inside touches, where it differs most", *Differ(worst), "G R"),
        Row("forces above and below", *ends, Tolerance(kind="relative"), "G R"),
    ]
    if not quick:
        text = "force at the end, where the inside carries most of it"
        rows.append(Row(text, *Differ(-1), "G R"))
    caption = "The ring at the end, and the force over the travel of the plates."

    draw = FromFolder(lambda folder: flatring.Run(**options, out=folder), "flatring.png")
    return Outcome(rows, draw, caption)


CASES = [
    Case(
        "hertz-large",
        "A rubber cylinder is flattened",
        "A neo-Hookean cylinder (Poisson ratio 0.49) between rigid plates, until each has come "
        "nearer to its middle by 30 % of the radius. Small approaches are those of Hertz; the "
        "large one is compared with a penalty method, extrapolated to an infinite penalty, and "
        "the work with the energy.",
        "Johnson (1985), equation 5.56 for the approach; a penalty on the plane, by NGSolve alone "
        "(`tests/validation/case_rubber.py`).",
        "python tutorials/examples/hertz_large.py --h 0.1 --steps 15 --out results",
        Cylinder,
    ),
    Case(
        "flat-ring",
        "Self-contact: a ring is pressed flat",
        "A rubber ring between two plates, until its inside touches itself. By symmetry this is "
        "contact with a rigid plane through the middle, which is a problem of two bodies. At the "
        "end a small difference of the travel makes a large one of the force.",
        "The computation with the plane.",
        "python tutorials/examples/flatring.py --out results",
        FlatRing,
    ),
]
