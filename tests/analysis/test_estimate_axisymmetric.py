"""Estimates of the error of bodies of revolution."""

import numpy as np
import pytest
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry, Rectangle, X, Y
from ngsolve import (
    CF,
    InnerProduct,
    Integrate,
    Mesh,
    Sym,
    VectorH1,
    ds,
    dx,
    pi,
    x,
)
from posed import posed
from press import solved

from ngslac.analysis import Adapt, EquilibratedEstimate, GoalEstimate, ResidualEstimate
from ngslac.materials import AxisymmetricGrad, Stress


def stress(H):
    return Stress(Sym(H), 1.0, 0.3)


def sections(upper, lower, h):
    """Half of the sections of two bodies, which touch at the height 0."""
    for face, names in ((upper, ("slave", "top")), (lower, ("bottom", "master"))):
        face.edges.name = "free"
        face.edges.Min(Y).name, face.edges.Max(Y).name = names
        for edge in face.edges:
            if edge.center.x < 1e-6:
                edge.name = "axis"
    return Mesh(OCCGeometry(Compound([upper, lower]), dim=2).GenerateMesh(maxh=h)).Curve(2)


def cylinders(h):
    return sections(Rectangle(1, 1).Face(), MoveTo(0, -1).Rectangle(1, 1).Face(), h)


def inside(u, v, load):
    return 2 * pi * x * InnerProduct(stress(AxisymmetricGrad(u)), AxisymmetricGrad(v)) * dx


def solver_of(mesh, pressure, **flags):
    V = VectorH1(mesh, order=2, dirichlety="bottom", dirichletx="axis")
    return posed(
        V,
        inside,
        lambda u, v, load: 2 * pi * x * pressure * v[1] * ds("top"),
        axisymmetric=True,
        **flags,
    ).solver()


def test_an_even_pressure_has_no_error():
    solver = solver_of(cylinders(0.4), 0.01)
    solver.Solve(printing=False)
    found = ResidualEstimate(solver, stress, tractions={"top": CF((0, -0.01))})
    assert found.relative < 1e-9


@pytest.mark.parametrize("h", [0.3, 0.15])
def test_the_estimate_is_near_the_error(h):
    """Of a tube in a tube under internal pressure, by the solution of Lame in plane strain."""
    inner, middle, outer, pressure, nu = 0.5, 0.8, 1.5, 0.01, 0.3
    tubes = []
    for name, first, last in (("slave", inner, middle), ("master", middle, outer)):
        face = MoveTo(first, 0).Rectangle(last - first, 0.5).Face()
        face.edges.name, face.edges.Min(X).name, face.edges.Max(X).name = "held", "in", "out"
        (face.edges.Max(X) if name == "slave" else face.edges.Min(X)).name = name
        tubes.append(face)
    tubes[0].edges.maxh = 0.7 * h
    mesh = Mesh(OCCGeometry(Compound(tubes), dim=2).GenerateMesh(maxh=h))
    V = VectorH1(mesh, order=2, dirichlety="held")
    problem = posed(
        V, inside, lambda u, v, load: -2 * pi * x * pressure * v[0] * ds("in"), axisymmetric=True
    )
    solver, gf = solved(problem), problem.gf
    factor = (1 + nu) * pressure * inner**2 / (outer**2 - inner**2)
    along, across = (factor * ((1 - 2 * nu) + sign * (outer / x) ** 2) for sign in (-1, 1))
    exact = CF((along, 0, 0, 0, 0, 0, 0, 0, across), dims=(3, 3))
    away = AxisymmetricGrad(gf.components[0]) - exact
    error = np.sqrt(Integrate(2 * pi * x * InnerProduct(stress(away), away), mesh))
    found = ResidualEstimate(solver, stress, tractions={"in": CF((pressure, 0))})
    assert 1.5 < found.total / error < 10


def test_the_radius_of_hertz():
    pressure = 0.003
    ball = Circle((0, 1), 1).Face() * Rectangle(1, 1).Face()
    mesh = sections(ball, MoveTo(0, -4).Rectangle(4, 4).Face(), 0.5)
    loads = {"tractions": {"top": CF((0, -pressure))}}

    def Estimate(solver):
        return ResidualEstimate(solver, stress, **loads)

    adapt = Adapt(lambda m: solver_of(m, pressure), mesh, Estimate, tol=0.02)
    with pytest.warns(UserWarning, match="slid"):
        adapt.Solve(printing=False)
    goal = GoalEstimate(adapt.solver, stress, "area", **loads)
    modulus = 1 / (2 * (1 - 0.3**2))
    radius = (3 * pressure * np.pi / (4 * modulus)) ** (1 / 3)
    assert np.sqrt(goal.value * 9 / 8 / np.pi) == pytest.approx(radius, rel=5e-3)
    assert goal.relative < 0.01
    assert adapt.steps[-1].dofs < 20_000


def test_the_equilibrated_estimate_is_refused():
    solver = solver_of(cylinders(0.4), 0.01)
    solver.Solve(printing=False)
    with pytest.raises(ValueError, match="around an axis"):
        EquilibratedEstimate(solver, stress, tractions={"top": CF((0, -0.01))})
