"""Refinement where the error is, with what contacts know of the past."""

import warnings

import numpy as np
import pytest
from contactedge import Edge, EdgeMesh
from netgen.occ import Box, Circle, Cylinder, Glue, MoveTo, OCCGeometry, Pnt, Rectangle, X, Y, Z
from ngsolve import (
    CF,
    InnerProduct,
    Integrate,
    Mesh,
    Parameter,
    VectorH1,
    ds,
    dx,
    pi,
    sqrt,
    x,
    y,
)
from posed import posed, stressed
from press import solved, two_blocks
from test_estimate import linear
from wavy import Wavy

from ngslac import ContactWarning, LoadStepper
from ngslac.analysis import Adapt, EquilibratedEstimate, GoalEstimate, ResidualEstimate
from ngslac.analysis.adapt import Doerfler
from ngslac.materials import AxisymmetricGrad
from ngslac.meshes import TwoBlocks


def Rate(dofs, errors):
    return np.polyfit(np.log(dofs), np.log(errors), 1)[0]


def Adapted(adapt, measure, **flags):
    """Dofs and what is measured on each mesh; `tol` is not reached."""
    rows = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ContactWarning)
        adapt.Solve(printing=False, callback=lambda s: rows.append((s.dofs, measure())), **flags)
    return np.array(rows).T


# --- convergence -------------------------------------------------------------------------------


def test_adaptive_meshes_converge_as_if_the_solution_were_smooth():
    edge = Edge()
    estimate = lambda solver: ResidualEstimate(solver, edge.stress)  # noqa: E731
    adapt = Adapt(edge, EdgeMesh(4), estimate, tol=1e-9, maxdofs=6000)
    dofs, errors = Adapted(adapt, edge.Error)
    assert Rate(dofs[2:], errors[2:]) < -0.95
    uniform = []
    for n in (6, 12, 24):
        solver = edge(EdgeMesh(n))
        solver.Solve(printing=False)
        uniform.append((solver.gf.space.ndof, edge.Error()))
    dofs_uniform, errors_uniform = np.array(uniform).T
    assert -0.9 < Rate(dofs_uniform, errors_uniform) < -0.6
    assert errors[-1] < errors_uniform[-1] / 3
    assert dofs[-1] < 1.2 * dofs_uniform[-1]


@pytest.mark.parametrize("goal", ["area", "pressure"])
def test_the_size_of_a_contact_takes_few_dofs(goal):
    wavy = Wavy()

    def Estimate(solver, goal=goal):
        return GoalEstimate(solver, wavy.stress, goal, tractions=wavy.tractions)

    adapt = Adapt(wavy, wavy.Mesh(), Estimate, tol=1e-9, maxdofs=1500)
    dofs, areas = Adapted(adapt, lambda: Estimate(adapt.solver, "area").value)
    assert abs(areas[-1] / wavy.area - 1) < 1e-3
    assert dofs[-1] < 2500
    solver = wavy(wavy.Mesh(0.05))  # as many dofs, evenly
    solver.Solve(printing=False)
    assert abs(Estimate(solver, "area").value / wavy.area - 1) > 1e-2


def Participating(solver):
    table = solver.contacts[0].Table()
    return (table["area"] @ table["pressure"]) ** 2 / (table["area"] @ table["pressure"] ** 2)


def Axisymmetric(traction):
    """The size of the contact of a cylinder with a ball of radius 1, by a mesh of a section."""
    top = MoveTo(0, 0.94).Rectangle(0.25, 0.06).Face()
    whole = Glue([Rectangle(1, 1).Face(), top])
    for edge in whole.edges:
        at = edge.center
        edge.name = {(True, False): "axis", (False, True): "bottom"}.get(
            (abs(at.x) < 1e-9, abs(at.y) < 1e-9), "top" if abs(at.y - 1) < 1e-9 else "side"
        )
        if at.y > 0.93 and at.x < 0.26:
            edge.maxh = 0.008
    mesh = Mesh(OCCGeometry(whole, dim=2).GenerateMesh(maxh=0.1))
    V = VectorH1(mesh, order=3, dirichletx="axis")

    def bulk(u, v, load):
        strain, test = AxisymmetricGrad(u), AxisymmetricGrad(v)
        inside = 2 * pi * x * InnerProduct(Wavy.stress(strain), test) * dx(bonus_intorder=2)
        return inside - 2 * pi * x * traction * v[1] * ds("bottom")

    return Participating(solved(posed(V, bulk, slave="top", axisymmetric=True, obstacle=x * x / 2)))


@pytest.mark.full
def test_a_circular_contact_in_3d():
    """A quarter of the cylinder: the radius, by the size of the contact."""
    traction = 2e-3
    exact = Axisymmetric(traction) / 4
    body = Cylinder(Pnt(0, 0, 0), Z, r=1, h=1) * Box(Pnt(0, 0, 0), Pnt(2, 2, 2))
    body.faces.name = "side"
    for axis, names in ((X, ("left", "")), (Y, ("front", "")), (Z, ("bottom", "top"))):
        body.faces.Min(axis).name = names[0]
        if names[1]:
            body.faces.Max(axis).name = names[1]
    load = {"tractions": {"bottom": CF((0, 0, traction))}}

    def Problem(mesh):
        V = VectorH1(mesh, order=2, dirichletx="left", dirichlety="front")
        ball = (x * x + y * y) / 2
        return posed(
            V,
            stressed(Wavy.stress),
            lambda u, v, load: -traction * v[2] * ds("bottom"),
            slave="top",
            obstacle=ball,
        ).solver()

    def Radius(solver):
        return np.sqrt(Participating(solver) / exact)

    def Block(maxh):
        return Mesh(OCCGeometry(body).GenerateMesh(maxh=maxh)).Curve(2)

    estimate = lambda s: GoalEstimate(s, Wavy.stress, "area", **load)  # noqa: E731
    adapt = Adapt(Problem, Block(0.5), estimate, tol=1e-9, maxdofs=1500)
    dofs, radii = Adapted(adapt, lambda: Radius(adapt.solver))
    assert dofs[-1] < 3000
    assert abs(radii[-1] - 1) < 0.04
    even = Problem(Block(0.12))
    even.Solve(printing=False)
    assert even.gf.space.ndof > 3 * dofs[-1]
    assert abs(Radius(even) - 1) > 0.1


def test_a_tolerance_is_reached():
    wavy = Wavy()
    estimate = lambda s: EquilibratedEstimate(s, wavy.stress, tractions=wavy.tractions)  # noqa: E731
    adapt = Adapt(wavy, wavy.Mesh(), estimate, tol=0.04)
    steps = adapt.Solve(printing=False)
    assert steps == adapt.steps
    assert steps[-1].relative <= 0.04 < steps[-2].relative
    assert adapt.estimate.relative == steps[-1].relative
    again = adapt.Solve(printing=False)
    assert len(again) == 1
    assert again[0].elements == steps[-1].elements
    assert again[0].iterations <= 1


# --- the mesh ----------------------------------------------------------------------------------


def test_new_points_lie_on_the_geometry_and_the_first_mesh_stays():
    disc = Circle((0, 0), 1).Face() * Rectangle(1, 1).Face().Move((0, -1, 0))
    disc.edges.name = "arc"
    disc.edges.Min(X).name, disc.edges.Max(Y).name = "left", "top"
    mesh = Mesh(OCCGeometry(disc, dim=2).GenerateMesh(maxh=0.4)).Curve(2)
    count, traction = mesh.ne, CF((0, -0.002))

    def Problem(mesh):
        V = VectorH1(mesh, order=2, dirichletx="left")
        return posed(
            V,
            stressed(Wavy.stress),
            lambda u, v, load: -traction * v * ds("top"),
            slave="arc",
            obstacle=y + 1,
        ).solver()

    def Estimate(solver):
        return ResidualEstimate(solver, Wavy.stress, tractions={"top": traction})

    adapt = Adapt(Problem, mesh, Estimate, tol=1e-9, maxdofs=800)
    Off = lambda m: sqrt(Integrate((sqrt(x * x + y * y) - 1) ** 2, m.Boundaries("arc")))  # noqa: E731
    first = Off(mesh)
    Adapted(adapt, lambda: 0)
    assert adapt.mesh.ne > 2 * count
    assert mesh.ne == count
    assert Off(adapt.mesh) < first
    # Curved boundaries have new points where contact is: there they are hundred times nearer.
    for _ in range(2):
        adapt.Refine(np.ones(adapt.mesh.ne, bool))
    assert Off(adapt.mesh) < 1e-2 * first


def test_doerfler_marks_the_fewest():
    squares = np.array([4.0, 1.0, 3.0, 0.0, 2.0])
    assert Doerfler(squares, 0.7).tolist() == [True, False, True, False, False]
    assert Doerfler(squares, 1.0).tolist() == [True, True, True, False, True]
    assert not Doerfler(np.zeros(3), 0.5).any()


# --- the past ----------------------------------------------------------------------------------


class Pulled:
    """Two blocks, pressed and then pulled aside by `load`, with friction."""

    def __init__(self, dim, **law):
        self.dim, self.load, self.law = dim, Parameter(0.0), {"friction": 0.15} | law

    def Mesh(self):
        if self.dim == 2:
            return TwoBlocks(0.3, 0.2, overhang=0.2)
        return two_blocks(3, kinds=("tet", "tet"), n=(2, 3))

    def __call__(self, mesh):
        V = VectorH1(mesh, order=2, dirichlet="bottom")
        self.push = push = CF((self.load,) + (0,) * (self.dim - 2) + (-0.02,))
        return posed(
            V, stressed(linear), lambda u, v, load: 1000 * (u - push) * v * ds("top"), **self.law
        ).solver()

    def Estimate(self, solver):
        load = {"top": -1000 * (solver.gf.components[0] - self.push)}
        return ResidualEstimate(solver, linear, tractions=load)


def Path(pulled, solver, loads):
    """The forces after each load."""
    forces = []
    for load in loads:
        pulled.load.Set(load)
        solver.Solve(printing=False)
        solver.contacts[0].Commit(solver.gf)
        forces.append(solver.contacts[0].Force())
    return np.array(forces)


@pytest.mark.parametrize("dim", [2, 3])
def test_friction_goes_on_after_a_refinement(dim):
    pulled = Pulled(dim)
    adapt = Adapt(pulled, pulled.Mesh(), pulled.Estimate, tol=1e-9)
    there = Path(pulled, adapt.solver, [0.0, 0.01, 0.03])
    status = adapt.solver.contacts[0].Table()["status"]
    assert 2 in status  # something slipped
    squares = pulled.Estimate(adapt.solver).squares
    adapt.Refine(Doerfler(squares, 1.0 if dim == 2 else 0.5))
    adapt.solver.Solve(printing=False)
    contact = adapt.solver.contacts[0]
    # The load is the same: nothing slips far, and the forces are those of before.
    assert np.abs(contact.Table()["slip"]).max() < 0.05 * 0.03
    assert np.allclose(contact.Force(), there[-1], atol=0.03 * np.abs(there[-1]).max())
    # Back again: the same as if all had happened on the fine mesh, but for its error.
    back = Path(pulled, adapt.solver, [0.02, -0.02])
    whole = Path(pulled, pulled(adapt.mesh), [0.0, 0.01, 0.03, 0.02, -0.02])
    assert np.allclose(back, whole[-2:], atol=0.03 * np.abs(whole).max())
    # Without the past it would stick where it never was pulled.
    fresh = pulled(adapt.mesh)
    lost = Path(pulled, fresh, [0.02])
    assert np.abs(lost[0] - whole[-2])[0] > 0.06 * np.abs(whole).max()


def test_what_laws_remember_is_carried_by_areas():
    way = lambda z: 0.3 + 0 * z.History("way", lambda w: w + sqrt(z.slip * z.slip))  # noqa: E731
    pulled = Pulled(2, friction=way)
    adapt = Adapt(pulled, pulled.Mesh(), pulled.Estimate, tol=1e-9)
    Path(pulled, adapt.solver, [0.0, 0.01, 0.03])
    before = adapt.solver.contacts[0].Table()
    assert before["way"].max() > 1e-4
    adapt.Refine(np.ones(adapt.mesh.ne, bool))
    contact = adapt.solver.contacts[0]
    contact.Evaluate(adapt.solver.gf)
    after = contact.form.History()["law: way"]
    assert len(after) == 2 * len(before["way"])
    kept = before["way"] @ before["fullarea"]
    assert after @ contact.Table()["fullarea"] == pytest.approx(kept, rel=1e-9)
    assert after.max() == pytest.approx(before["way"].max())
    adapt.solver.Solve(printing=False)
    assert np.all(contact.Table()["way"] > after - 1e-12)


def test_load_steps_go_on():
    pulled = Pulled(2)
    adapt = Adapt(pulled, pulled.Mesh(), pulled.Estimate, tol=0.2)
    for load in (0.0, 0.01, 0.02):
        pulled.load.Set(load)
        adapt.Solve(printing=False)
        adapt.Commit()
    steps = LoadStepper(adapt.solver, pulled.load).Integrate(0.03, steps=2, printing=False)
    assert steps[-1].time == pytest.approx(0.03)
    assert adapt.Solve(printing=False)[-1].relative <= 0.2


# --- what is refused ---------------------------------------------------------------------------


def test_wrong_arguments():
    wavy, mesh = Wavy(), Wavy.Mesh()
    estimate = lambda s: ResidualEstimate(s, wavy.stress, tractions=wavy.tractions)  # noqa: E731
    for name, bad in {"tol": 0, "maxdofs": 0, "maxmeshes": -1, "marking": 1.5}.items():
        with pytest.raises(ValueError, match=name):
            Adapt(wavy, mesh, estimate, **({"tol": 0.1} | {name: bad}))
    with pytest.raises(TypeError, match="problem"):
        Adapt(None, mesh, estimate, tol=0.1)
    with pytest.raises(TypeError, match="mesh"):
        Adapt(wavy, mesh.ngmesh, estimate, tol=0.1)
    with pytest.raises(TypeError, match="a solver"):
        Adapt(lambda m: m, mesh, estimate, tol=0.1)
    with pytest.raises(ValueError, match="another mesh"):
        Adapt(lambda m: wavy(mesh), mesh, estimate, tol=0.1)
    with pytest.raises(ValueError, match="triangles"):
        Adapt(wavy, two_blocks(3), estimate, tol=0.1)
    with pytest.raises(TypeError, match="ErrorEstimate"):
        Adapt(wavy, mesh, lambda s: 1.0, tol=0.1).Solve(printing=False)
    adapt = Adapt(wavy, mesh, estimate, tol=0.1)
    for bad in (np.ones(3, bool), np.ones(mesh.ne), np.zeros(mesh.ne, bool)):
        with pytest.raises(ValueError, match="marked"):
            adapt.Refine(bad)
    assert adapt.mesh.ne == mesh.ne
    with pytest.warns(ContactWarning, match="maxdofs"):
        Adapt(wavy, mesh, estimate, tol=1e-3, maxmeshes=2).Solve(printing=False)


def test_lines_are_printed(capsys):
    wavy = Wavy()
    estimate = lambda s: ResidualEstimate(s, wavy.stress, tractions=wavy.tractions)  # noqa: E731
    adapt = Adapt(wavy, wavy.Mesh(), estimate, tol=0.3)
    steps = adapt.Solve()
    lines = capsys.readouterr().out.splitlines()
    assert lines == [str(step) for step in steps]
    assert "elements" in repr(adapt)
