"""Estimates of the error of contact problems."""

import numpy as np
import pytest
from contactedge import Edge, EdgeMesh, Exact
from netgen.occ import Compound, OCCGeometry, Rectangle, Y
from ngsolve import (
    CF,
    BilinearForm,
    Det,
    FESpace,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Integrate,
    Inv,
    LinearForm,
    Mesh,
    Sym,
    Trace,
    VectorH1,
    ds,
    dx,
    exp,
    log,
    x,
    y,
)
from posed import posed, stressed
from press import LAME, MU, PUSH, press, two_blocks
from wavy import Wavy

from ngslac import ContactSolver, LACContact, LACSpace, Law
from ngslac.analysis import (
    Adapt,
    EquilibratedEstimate,
    GoalEstimate,
    ResidualEstimate,
)
from ngslac.analysis.balance import Balance, FaceElements
from ngslac.analysis.equilibrated import Equilibration, Oscillation
from ngslac.analysis.estimate import ErrorEstimate
from ngslac.analysis.shapes import Constants
from ngslac.meshes import TwoBlocks, TwoBlocks3D

BOTH = pytest.mark.parametrize("estimate", [ResidualEstimate, EquilibratedEstimate])
TETS = {"dim": 3, "kinds": ("tet", "tet")}


def linear(H):
    return 2 * MU * Sym(H) + LAME * Trace(H) * Id(H.dims[0])


def solved(**flags):
    """A press, its solver, and its loads: the springs at its top."""
    problem = press(**flags)
    solver = problem.solver()
    solver.Solve(printing=False)
    push = CF(PUSH[problem.mesh.dim])
    return problem, solver, {"top": -1000 * (problem.gf.components[0] - push)}


# --- against exact solutions -------------------------------------------------------------------


@pytest.mark.sample(4)
@pytest.mark.parametrize("nu", [(0.3, 0.2), (0.0, 0.0), (0.45, 0.45), (0.45, 0.0)])
@pytest.mark.parametrize("n", [5, 8])
def test_estimates_are_near_the_error_at_the_end_of_a_contact(n, nu):
    edge = Edge(Exact(nu=nu))
    solver = edge(EdgeMesh(n))
    solver.Solve(printing=False)
    error = edge.Error()
    residual, bound = (f(solver, edge.stress) for f in (ResidualEstimate, EquilibratedEstimate))
    assert 2 < residual.total / error < 8
    assert 1 < bound.total / error < 2
    assert np.sqrt(bound.bulk.sum()) < 1.6 * error


def Against(problem, estimate, mesh, stress, levels=2):
    """Estimate over the distance to the solution on the mesh refined so often."""
    adapt = Adapt(problem, mesh, estimate, tol=1e-12)
    adapt.solver.Solve(printing=False)
    total = estimate(adapt.solver).total
    flags = {"order": 2, "autoupdate": True, "hoprolongation": True}
    coarse = GridFunction(VectorH1(adapt.mesh, **flags), autoupdate=True, nested=True)
    coarse.Set(adapt.solver.gf.components[0])
    for _ in range(levels):
        adapt.Refine(np.ones(adapt.mesh.ne, bool))
    adapt.solver.Solve(printing=False)
    away = Grad(adapt.solver.gf.components[0]) - Grad(coarse)
    return total / np.sqrt(Integrate(InnerProduct(stress(away), away), adapt.mesh))


def Pushed(dim, *, load=None, **law):
    """Two blocks, the upper one pushed down and aside at its top."""

    def Make(mesh):
        V = VectorH1(mesh, order=2, dirichlet="bottom|top")
        loads = [lambda u, v, _: -load * v * dx] if load is not None else []
        problem = posed(V, stressed(linear), *loads, **law)
        problem.gf.components[0].Set(CF(PUSH[dim]), definedon=mesh.Boundaries("top"))
        return problem.solver()

    return Make


@pytest.mark.parametrize(
    "law", [{}, {"friction": 0.2}, {"tresca": 0.1}, {"tied": True}, {"bilateral": True}]
)
def test_the_equilibrated_estimate_bounds_the_error_for_each_law(law):
    mesh = TwoBlocks(0.3, 0.2, overhang=0.2)
    ratio = Against(Pushed(2, **law), lambda s: EquilibratedEstimate(s, linear), mesh, linear)
    assert 1 < ratio < 2


def test_the_equilibrated_estimate_bounds_the_error_in_3d():
    mesh = two_blocks(3, kinds=("tet", "tet"), n=(2, 3))
    problem = Pushed(3, friction=0.2)
    ratio = Against(problem, lambda s: EquilibratedEstimate(s, linear), mesh, linear, levels=1)
    assert 1 < ratio < 3


def test_loads_that_are_no_polynomials_count():
    wavy = Wavy()
    mesh, found = wavy.Mesh(0.2), []
    for share in (CF(1), exp(8 * x - 2)):
        wavy.traction = CF((0, 0.4e-3)) * share
        solver = wavy(mesh)
        solver.Solve(printing=False)
        balance = Balance(solver, wavy.stress, None, {"bottom": wavy.traction})
        added = Oscillation(Equilibration(balance, 3), balance).Surface()
        found.append(np.abs(added[FaceElements(mesh.Boundaries("bottom"))[1]]).max())
    assert found[0] < 1e-9 * found[1]


@pytest.mark.parametrize("dim", [2, 3])
def test_the_stress_is_in_equilibrium_with_body_forces(dim):
    mesh = TwoBlocks(0.3) if dim == 2 else two_blocks(3, kinds=("tet", "tet"), n=(2, 3))
    load = CF((1, x - y, 2)[:dim])
    solver = Pushed(dim, load=load, friction=0.2)(mesh)
    solver.Solve(printing=False)
    balance = Balance(solver, linear, load, None)
    found = Equilibration(balance, 3)
    rows = found.solution.components[:dim]
    left = CF(tuple(Trace(Grad(row)) for row in rows)) + load
    size = Integrate(InnerProduct(load, load), mesh)
    assert Integrate(InnerProduct(left, left), mesh) < 1e-18 * size
    slave = mesh.Boundaries("slave")
    pushed = [Integrate(found.traction[k], slave) for k in range(dim)]
    assert np.allclose(pushed, solver.contacts[0].Force(), rtol=1e-9)


# --- exact properties --------------------------------------------------------------------------


@BOTH
@pytest.mark.parametrize("dim", [2, 3])
def test_a_patch_test_has_no_error(estimate, dim):
    """Both blocks under an even pressure: the solution is in the space."""
    if dim == 2:
        mesh = TwoBlocks(0.3, 0.2, structured=True)
    else:
        mesh = TwoBlocks3D("tet", "tet", 2, 3, overhang=0)
    V = VectorH1(mesh, order=2, **Symmetry(mesh))
    pressure = CF((0,) * (dim - 1) + (-1,))
    solver = posed(V, stressed(linear), lambda u, v, load: -pressure * v * ds("top")).solver()
    solver.Solve(printing=False, tol=1e-13)
    found = estimate(solver, linear, tractions={"top": pressure})
    assert found.relative < 1e-9
    assert found.energy > 1e-3


def Symmetry(mesh):
    """Flags of a space that holds the bottom and all sides along their normals."""
    names = dict.fromkeys(mesh.GetBoundaries())
    sides = [n for n in names if n not in ("top", "bottom", "slave", "master")]
    if mesh.dim == 2:
        return {"dirichletx": "|".join(sides), "dirichlety": "bottom"}
    across = {}
    for name in sides:
        region = mesh.Boundaries(name)
        area = Integrate(CF(1), region)
        spread = [
            Integrate(c * c, region) / area - (Integrate(c, region) / area) ** 2 for c in (x, y)
        ]
        across.setdefault("dirichlet" + "xy"[int(np.argmin(spread))], []).append(name)
    return {flag: "|".join(found) for flag, found in across.items()} | {"dirichletz": "bottom"}


@BOTH
def test_relative_estimates_have_no_units(estimate):
    found = []
    for scale in (1.0, 1e9):
        edge = Edge(Exact(scale=scale))
        solver = edge(EdgeMesh(4))
        solver.Solve(printing=False)
        found.append(estimate(solver, edge.stress))
    assert found[0].relative == pytest.approx(found[1].relative, rel=1e-7)
    assert found[1].total == pytest.approx(found[0].total * np.sqrt(1e9), rel=1e-7)


@BOTH
@pytest.mark.parametrize("length", [1e-6, 1e3])
def test_relative_estimates_have_no_length(estimate, length):
    def Scaled(mesh):
        ng = mesh.ngmesh.Copy()
        for p in ng.Points():
            p[0], p[1] = length * p[0], length * p[1]
        return Mesh(ng)

    found = []
    for size in (1.0, length):
        push = tuple(size * c for c in PUSH[2])
        flags = {"push": push, "spring": 1000 / size, "friction": 0.1}
        problem = press(change=Scaled if size != 1 else None, **flags)
        solver = problem.solver()
        solver.Solve(printing=False)
        pull = -1000 / size * (problem.gf.components[0] - CF(push))
        found.append(estimate(solver, linear, tractions={"top": pull}))
    assert found[1].relative == pytest.approx(found[0].relative, rel=1e-6)


@BOTH
def test_estimates_do_not_depend_on_the_frame(estimate):
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    found = []
    for frame in (np.eye(2), turn):

        def Turned(mesh, frame=frame):
            ng = mesh.ngmesh.Copy()
            points = np.array(ng.Coordinates())[:, :2] @ frame.T
            for p, (a, b) in zip(ng.Points(), points, strict=True):
                p[0], p[1] = a, b
            return Mesh(ng)

        push = tuple(float(c) for c in frame @ PUSH[2])
        problem, solver, _ = solved(friction=0.1, push=push, change=Turned)
        load = {"top": -1000 * (problem.gf.components[0] - CF(push))}
        found.append(estimate(solver, linear, tractions=load))
    for one, other in zip(*(vars(f).values() for f in found), strict=True):
        if not isinstance(one, str):
            assert np.allclose(one, other, rtol=1e-5, atol=1e-8 * np.max(one))


@BOTH
def test_parts_add_up(estimate):
    _, solver, load = solved(friction=0.1)
    found = estimate(solver, linear, tractions=load)
    parts = found.bulk + found.contact + found.consistency
    assert np.allclose(found.indicators**2, parts)
    assert found.total == pytest.approx(np.sqrt(parts.sum()))
    assert all(part.min() >= 0 and part.max() > 0 for part in (found.bulk, found.contact, parts))
    mesh = solver.gf.space.mesh
    assert Integrate(found.Field(mesh) ** 2, mesh) > 0
    assert f"{found.total:.4g}" in str(found)
    with pytest.raises(ValueError, match="elements"):
        found.Field(TwoBlocks(0.5))


@pytest.mark.parametrize("flags", [{"friction": 0.1}, TETS | {"friction": 0.1}])
def test_nothing_changes(flags):
    _, solver, load = solved(**flags)
    contact = solver.contacts[0]

    def State():
        state = contact.State() | {"gf": solver.gf.vec.FV().NumPy()} | contact.Table()
        return {k: np.array(v) for k, v in state.items() if np.asarray(v).dtype.kind in "fi"}

    before, history = State(), list(solver.history)
    for estimate in (ResidualEstimate, EquilibratedEstimate):
        estimate(solver, linear, tractions=load)
    GoalEstimate(solver, linear, "pressure", tractions=load)
    after = State()
    assert before.keys() == after.keys()
    assert solver.history == history
    assert all(np.array_equal(before[k], after[k], equal_nan=True) for k in before)


def test_a_nonlinear_bulk_has_a_residual_estimate_only():
    def piola(H):
        F = Id(2) + H
        return MU * (F - Inv(F).trans) + LAME * log(Det(F)) * Inv(F).trans

    _, solver, load = solved(nonlinear=True)
    found = ResidualEstimate(solver, piola, tractions=load)
    _, other, small = solved()
    assert found.relative == pytest.approx(
        ResidualEstimate(other, linear, tractions=small).relative, rel=0.3
    )
    with pytest.raises(ValueError, match="linear"):
        EquilibratedEstimate(solver, piola, tractions=load)


def test_residual_estimates_fall_with_the_mesh_in_3d_and_for_hexahedra():
    """Slowly: stress is singular at the edges of a block that is pressed on a wider one."""
    found = []
    for n in (2, 4):
        _, solver, load = solved(dim=3, kinds=("hex", "prism"), n=(n, n + 1), friction=0.1)
        found.append(ResidualEstimate(solver, linear, tractions=load).relative)
    assert found[1] < 0.85 * found[0]


@BOTH
def test_estimates_know_a_pairing_of_another_configuration(estimate):
    """Slid far, and paired again: without that the contact tractions would be elsewhere."""
    problem = press(push=(0.1, -0.03), mesh_flags={"structured": False})
    solver, found = problem.solver(), []
    for load in (0.5, 1.0):
        problem.load.Set(load)
        solver.Solve(printing=False)
        pull = problem.gf.components[0] - load * CF((0.1, -0.03))
        found.append(estimate(solver, linear, tractions={"top": -1000 * pull}))
        problem.contact.Update(problem.gf)
    assert found[1].relative == pytest.approx(found[0].relative, rel=0.2)


@BOTH
def test_several_contacts_have_parts_of_their_own(estimate):
    parts = []
    for k, width in enumerate((2, 1.5, 1)):
        body = Rectangle(width, 0.5).Face().Move((-width / 2, 0.5 * k, 0))
        body.edges.name, body.faces.name = "side", f"body{k}"
        body.edges.Min(Y).name, body.edges.Max(Y).name = f"bottom{k}", f"top{k}"
        parts.append(body)
    mesh = Mesh(OCCGeometry(Compound(parts), dim=2).GenerateMesh(maxh=0.3))
    V = VectorH1(mesh, order=2, dirichlet="bottom0")
    X = FESpace([V, LACSpace(V, slave="bottom1"), LACSpace(V, slave="bottom2")])
    (u, one, two), (v, _, _) = X.TnT()
    load = CF((0.1, -1))
    a = BilinearForm(InnerProduct(linear(Grad(u)), Grad(v)) * dx - load * v * ds("top2"))
    contacts = [
        LACContact(u, one, master="top0", friction=0.3),
        LACContact(u, two, master="top1", friction=0.3),
    ]
    solver = ContactSolver(a, GridFunction(X), contacts)
    solver.Solve(printing=False)
    tractions = {"top2": load}
    found = estimate(solver, linear, tractions=tractions)
    for side in ("top0", "bottom1", "top1", "bottom2"):
        elements = FaceElements(mesh.Boundaries(side))[1]
        assert found.contact[elements].max() > 0
        if side[0] == "b":
            assert found.consistency[elements].max() > 0
    peaks = [
        GoalEstimate(solver, linear, "pressure", contact=c, tractions=tractions) for c in contacts
    ]
    assert [p.value for p in peaks] == [c.Table()["pressure"].max() for c in contacts]


@BOTH
def test_laws_of_ones_own_have_balance_and_no_conditions(estimate):
    spring = Law(lambda z: -30.0 * z.jump)
    _, solver, load = solved(tied=True, law=spring)
    found = estimate(solver, linear, tractions=load)
    assert 0 < found.relative < 0.5
    assert not found.consistency.any()


def test_bodies_apart_have_no_stress_and_no_goal():
    problem, solver, load = solved(push=(0, 0.02))
    load = {"top": -1000 * (problem.gf.components[0] - CF((0, 0.02)))}
    found = ResidualEstimate(solver, linear, tractions=load)
    assert found.total < 1e-10
    with pytest.raises(ValueError, match="no pressure"):
        GoalEstimate(solver, linear, "force", tractions=load)


# --- constants of elements ---------------------------------------------------------------------


def test_constants_of_elements_scale():
    corners = np.random.default_rng(1).normal(size=(4, 3, 2))
    one, other = Constants(corners), Constants(3 * corners)
    assert np.allclose(one.Turn(), other.Turn())
    assert np.allclose(3 * one.Inside(1), other.Inside(1))
    assert np.all(one.Inside(2) < one.Inside(1))


def test_constants_bound_fields():
    """A quadratic displacement of the unit triangle, by hand: w = (y^2, 0)."""
    corners = np.array([[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]])
    # Its gradient has the one entry 2 y: strain squared 2 y^2, turn squared 2 (y - 1/3)^2.
    strain, turn = 2 * (1 / 12), 2 * (1 / 12 - 2 / 18 + 1 / 18)
    assert Constants(corners).Turn()[0] >= np.sqrt(turn / strain)


@pytest.mark.parametrize("dim", [2, 3])
def test_elements_carry_loads(dim):
    """Two points pulled apart: the work is that of the strain, and the mean strain is known."""
    rng = np.random.default_rng(2)
    found = Constants(rng.normal(size=(1, dim + 1, dim)))
    places = rng.normal(size=(2, dim))
    way = places[1] - places[0]
    values = found.Values(np.zeros(2, int), places)
    moments = np.einsum("qk,qa->ka", np.array([-way, way]), values)[None]
    taken = found.Carrying(moments)
    count = len(found.points)
    # Any constant strain e does the work way.e way; that of the unit tensor is its trace.
    for tensor in (np.eye(dim), np.outer(way, way)):
        strain = found.StrainMoments(np.broadcast_to(tensor, (1, count, dim, dim)))
        assert np.sum(strain * taken) == pytest.approx(way @ tensor @ way)
    assert np.sum(moments * taken) > 0


# --- goals -------------------------------------------------------------------------------------


def test_the_area_is_that_of_westergaard():
    wavy = Wavy()
    values = []
    for h in (0.1, 0.05):
        solver = wavy(wavy.Mesh(h))
        solver.Solve(printing=False)
        found = GoalEstimate(solver, wavy.stress, "area", tractions=wavy.tractions)
        values.append(found)
        assert abs(found.value / wavy.area - 1) < found.relative
    assert values[1].total < 0.6 * values[0].total
    assert "area" in str(found)


def test_a_force_that_the_load_prescribes_has_a_small_error():
    wavy = Wavy()
    solver = wavy(wavy.Mesh(0.1))
    solver.Solve(printing=False)
    force = GoalEstimate(solver, wavy.stress, "force", tractions=wavy.tractions)
    assert force.value == pytest.approx(0.4e-3 * 0.5)
    area = GoalEstimate(solver, wavy.stress, "area", tractions=wavy.tractions)
    assert force.adjoint.relative < 1e-6 or force.relative < area.relative


def test_a_linear_functional_is_a_goal():
    problem, solver, load = solved(friction=0.1)
    v = problem.X.TestFunction()[0]
    goal = LinearForm(v[0] * ds("top"))
    found = GoalEstimate(solver, linear, goal, tractions=load)
    top = Integrate(problem.gf.components[0][0], problem.mesh.Boundaries("top"))
    assert found.value == pytest.approx(top)
    assert 0 < found.relative < 1


# --- what is refused ---------------------------------------------------------------------------


@BOTH
def test_wrong_data_are_refused(estimate):
    _, solver, load = solved()
    with pytest.raises(ValueError, match="unbalanced"):
        estimate(solver, linear)
    with pytest.raises(ValueError, match="unbalanced"):
        estimate(solver, lambda H: 1.1 * linear(H), tractions=load)
    for bad in (None, 3.0, CF(1)):
        with pytest.raises(TypeError, match="stress"):
            estimate(solver, bad, tractions=load)
    with pytest.raises(ValueError, match="shape"):
        estimate(solver, lambda H: H[0, 0], tractions=load)
    with pytest.raises(TypeError, match="tractions"):
        estimate(solver, linear, tractions=[load])
    with pytest.raises(ValueError, match="components"):
        estimate(solver, linear, force=CF(1), tractions=load)
    with pytest.raises(ValueError, match="boundary"):
        estimate(solver, linear, tractions={"nowhere": CF((0, 1))})
    with pytest.raises(TypeError, match="solver"):
        estimate(solver.gf, linear, tractions=load)


@BOTH
def test_unknown_problems_are_refused(estimate):
    with pytest.raises(ValueError, match="has not solved"):
        estimate(press().solver(), linear)
    _, solver, load = solved(finite=True)
    with pytest.raises(ValueError, match="finite=True"):
        estimate(solver, linear, tractions=load)


def test_what_cannot_be_equilibrated_is_refused():
    _, solver, load = solved(order=1)
    with pytest.raises(ValueError, match="order 1"):
        EquilibratedEstimate(solver, linear, tractions=load)
    _, solver, load = solved(dim=3)
    with pytest.raises(ValueError, match="tetrahedra"):
        EquilibratedEstimate(solver, linear, tractions=load)


def test_wrong_goals_are_refused():
    _, solver, load = solved()
    with pytest.raises(ValueError, match="goal"):
        GoalEstimate(solver, linear, "radius", tractions=load)
    with pytest.raises(TypeError, match="goal"):
        GoalEstimate(solver, linear, 3, tractions=load)
    with pytest.raises(ValueError, match="contact"):
        GoalEstimate(solver, linear, "force", contact=press().contact, tractions=load)
    with pytest.raises(ValueError, match="another space"):
        GoalEstimate(solver, linear, LinearForm(press().X), tractions=load)
    assert isinstance(ResidualEstimate(solver, linear, tractions=load), ErrorEstimate)
