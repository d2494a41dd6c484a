"""Several loose bodies that only contact with friction holds come to rest in few iterations."""

from math import cos, pi, sin

import numpy as np
import pytest
from netgen.occ import Compound, OCCGeometry, WorkPlane
from ngsolve import (
    BilinearForm,
    FESpace,
    GridFunction,
    InnerProduct,
    Mesh,
    Parameter,
    Sym,
    Trace,
    VectorH1,
    ds,
    dx,
    grad,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper

FORCE = 500.0


def bearing(rollers, play, h):
    """Two rings, and rollers between them with a clearance, as shapes that are meshed at once."""
    inner = WorkPlane().Circle(3.0).Face() - WorkPlane().Circle(1.5).Face()
    outer = WorkPlane().Circle(6.5).Face() - WorkPlane().Circle(5.0).Face()
    for edge in inner.edges:
        edge.name = "race_in" if edge.bounding_box[1].x > 2.5 else "bore"
    for edge in outer.edges:
        edge.name = "race_out" if edge.bounding_box[1].x < 5.5 else "fixed"
    parts = [inner, outer]
    for angle in 2 * pi / rollers * np.arange(rollers):
        center = 4 * cos(angle), 4 * sin(angle)
        parts.append(WorkPlane().MoveTo(*center).Circle(1 - play / 2).Face())
        parts[-1].edges.name = "rollers"
    return Mesh(OCCGeometry(Compound(parts), dim=2).GenerateMesh(maxh=h)).Curve(2)


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("slave", "rollers", "play", "friction", "first"),
    [
        ("rings", 8, 0.01, 0.1, 25),
        ("rings", 8, 0.02, 0.3, 35),
        ("rollers", 8, 0.01, 0.1, 30),
        ("rings", 12, 0.01, 0.1, 30),
        ("rollers", 12, 0.01, 0.3, 30),
    ],
)
def test_rollers_of_a_bearing_come_to_rest(slave, rollers, play, friction, first):
    """Newton's method alone took 59 to 114 iterations: the loose rollers fly about."""
    mesh = bearing(rollers, play, 0.7 if rollers == 8 else 0.5)
    V = VectorH1(mesh, order=2, dirichlet="fixed")
    pairs = {"race_in": "rollers", "race_out": "rollers"}
    pairs = pairs if slave == "rings" else {"rollers": "race_in|race_out"}
    fes = FESpace([V, *(LACSpace(V, slave=name) for name in pairs)])
    u, *lams = fes.TrialFunction()
    v = fes.TestFunction()[0]
    load, gf = Parameter(0), GridFunction(fes)
    strain = Sym(grad(u))
    a = BilinearForm(fes)
    a += (
        80e3 * 2 * InnerProduct(strain, Sym(grad(v))) + 120e3 * Trace(strain) * Trace(grad(v))
    ) * dx
    a += load * FORCE * v[1] * ds("bore")
    contacts = [
        LACContact(u, lam, master=master, friction=friction)
        for lam, master in zip(lams, pairs.values(), strict=True)
    ]
    solver = ContactSolver(a, gf, contacts)
    stepper = LoadStepper(solver, load)
    steps = stepper.Integrate(1, steps=1, printing=False)
    assert len(steps) == 1
    assert steps[0].iterations <= first
    down = FORCE * 2 * pi * 1.5
    assert solver.Reaction("fixed")[1] == pytest.approx(down, rel=2e-3)
    assert np.abs(solver.Reaction("fixed")[0]) < 1e-3 * down
