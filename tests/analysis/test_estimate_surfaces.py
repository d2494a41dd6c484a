"""Estimates of problems with inner boundaries, offsets, forgotten loads and odd names."""

from itertools import pairwise
from re import escape

import numpy as np
import pytest
from netgen.occ import Compound, Glue, MoveTo, OCCGeometry, Y
from ngsolve import (
    CF,
    Compress,
    Id,
    Mesh,
    Parameter,
    Sym,
    VectorH1,
    ds,
    dx,
)
from posed import posed, stressed

from ngslac.analysis import Adapt, EquilibratedEstimate, ResidualEstimate
from ngslac.materials import Stress

BOTH = pytest.mark.parametrize("estimate", [ResidualEstimate, EquilibratedEstimate])
PUSH = 0.01
LOADS = {"tractions": {"top": CF((0, -PUSH))}}


def stress(H):
    return Stress(Sym(H), 1.0, 0.3)


def mesh_of(*, glued=False, support="bottom", gap=0.0, h=0.3):
    """A punch above a wider block, which may be made of two parts."""
    punch = MoveTo(0.31, gap).Rectangle(0.4, 0.5).Face()
    cuts = [0, 0.52, 1] if glued else [0, 1]
    parts = [MoveTo(first, -1).Rectangle(last - first, 1).Face() for first, last in pairwise(cuts)]
    block = Glue(parts)
    punch.edges.name = block.edges.name = "free"
    punch.edges.Min(Y).name, punch.edges.Max(Y).name = "slave", "top"
    for edge in block.edges:
        if abs(edge.center.y) < 1e-9:
            edge.name = "master"
        elif abs(edge.center.y + 1) < 1e-9:
            edge.name = support
    punch.edges.Min(Y).maxh = 0.11
    return Mesh(OCCGeometry(Compound([punch, block]), dim=2).GenerateMesh(maxh=h))


def solved(mesh, *, held="bottom", weight=0.0, space=lambda V: V, **law):
    V = space(VectorH1(mesh, order=2, dirichlet=escape(held), dirichletx="top"))
    solver = posed(
        V, stressed(stress), lambda u, v, load: PUSH * v[1] * ds("top") + weight * v[1] * dx, **law
    ).solver()
    solver.Solve(printing=False)
    return solver


@BOTH
def test_a_boundary_inside_of_a_body_is_no_surface(estimate):
    whole, glued = (estimate(solved(mesh_of(glued=g)), stress, **LOADS) for g in (False, True))
    assert glued.relative == pytest.approx(whole.relative, rel=0.25)  # the meshes differ


@BOTH
def test_clearances_count_as_gaps_of_the_meshes_do(estimate):
    for gap, offset in ((0.0, 0.05), (0.05, CF(-0.05))):
        mesh = mesh_of(gap=gap)
        plain, moved = (estimate(solved(mesh, offset=o), stress, **LOADS) for o in (None, offset))
        assert moved.relative == pytest.approx(plain.relative, rel=1e-6)
        assert moved.consistency.sum() == pytest.approx(plain.consistency.sum(), rel=1e-6)


@BOTH
def test_names_of_supports_are_no_patterns(estimate):
    mesh = mesh_of(support="fix(1)")
    found = estimate(solved(mesh, held="fix(1)"), stress, **LOADS)
    plain = estimate(solved(mesh_of()), stress, **LOADS)
    assert found.relative == pytest.approx(plain.relative, rel=1e-9)


@pytest.mark.parametrize("h", [0.3, 0.1])
def test_a_forgotten_weight_is_seen_on_any_mesh(h):
    weight = 0.05 * PUSH * 0.4
    solver = solved(mesh_of(h=h), weight=weight)
    with pytest.raises(ValueError, match="unbalanced"):
        ResidualEstimate(solver, stress, **LOADS)
    assert ResidualEstimate(solver, stress, force=CF((0, -weight)), **LOADS).relative < 0.6


def test_what_is_not_estimated_is_refused():
    solver = solved(mesh_of())
    with pytest.raises(ValueError, match="without a displacement"):
        ResidualEstimate(solver, lambda H: stress(H) - 0.01 * Id(2), **LOADS)
    compressed = solved(mesh_of(), space=Compress)
    with pytest.raises(ValueError, match="take the space in it"):
        ResidualEstimate(compressed, stress, **LOADS)


def driven(depth):
    """A problem whose load is a prescribed displacement."""

    def Problem(mesh):
        V = VectorH1(mesh, order=2, dirichlet="bottom|top")
        problem = posed(V, stressed(stress))
        problem.gf.components[0].Set(CF((0, -depth)), definedon=mesh.Boundaries("top"))
        return problem.solver()

    return Problem


def test_prescribed_values_are_those_of_the_problem_each_time():
    depth = Parameter(0.005)
    adapt = Adapt(driven(depth), mesh_of(), lambda s: ResidualEstimate(s, stress), tol=1.0)
    adapt.Solve(printing=False)
    before = adapt.solver.contacts[0].Force()[1]
    depth.Set(0.01)
    adapt.Solve(printing=False)
    assert adapt.solver.contacts[0].Force()[1] == pytest.approx(2 * before, rel=1e-9)


def test_a_problem_that_fails_is_named():
    calls = []

    def Problem(mesh):
        calls.append(mesh.ne)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return driven(0.005)(mesh)

    adapt = Adapt(Problem, mesh_of(), lambda s: ResidualEstimate(s, stress), tol=1e-3)
    with pytest.raises(KeyboardInterrupt):
        adapt.Solve(printing=False)
    for call in (adapt.Solve, adapt.Commit, lambda: adapt.Refine(np.ones(adapt.mesh.ne, bool))):
        with pytest.raises(ValueError, match="make another Adapt"):
            call()
