"""ContactSolver in 3D: the law, quadratic convergence, every route to the same solution."""

import numpy as np
import pytest
from ngsolve import (
    BND,
    CF,
    H1,
    BitArray,
    GridFunction,
    InnerProduct,
    Integrate,
    LinearForm,
    Parameter,
    TaskManager,
    VectorH1,
    VectorValued,
    ds,
    x,
    y,
)
from ngsolve.nonlinearsolvers import NewtonSolver
from press import mixed_press3d, numpy, press3d, solved
from test_solver import check_law

from ngslac import BubbleVectorH1, FormSum, LoadStepper, SplitSlaveFaces

KINDS = [("hex", "hex"), ("tet", "hex"), ("prism", "tet"), ("prism_side", "pyramid")]


@pytest.mark.parametrize("nonlinear", [False, True])
def test_solution_obeys_the_law_with_every_status_in_3d(nonlinear):
    problem = mixed_press3d(nonlinear=nonlinear)
    last = solved(problem).history[-1]
    table = problem.contact.Table()
    assert set(table["status"]) == {0, 1, 2}
    check_law(problem.contact)
    assert (last.open, last.stick, last.slip) == tuple(np.bincount(table["status"], minlength=3))
    # In 3D the traction of a slipping macro-element points against its slip.
    slips = table["status"] == 2
    shear = (table["traction"] + table["pressure"][:, None] * table["normal"])[slips]
    sizes = np.linalg.norm(shear, axis=1) * np.linalg.norm(table["slip"][slips], axis=1)
    assert np.sum(shear * table["slip"][slips], axis=1) == pytest.approx(-sizes, rel=1e-8)
    turns = np.degrees(np.arctan2(shear[:, 1], shear[:, 0]))
    assert np.ptp(turns) > 1  # the directions differ


@pytest.mark.parametrize("kinds", KINDS)
def test_solution_obeys_the_law_for_all_shapes(kinds):
    problem = mixed_press3d(kinds=kinds, n=(3, 2))
    solved(problem)
    check_law(problem.contact)
    assert len(set(problem.contact.Table()["status"])) >= 2


@pytest.mark.parametrize("nonlinear", [False, True])
def test_quadratic_convergence_with_friction_in_3d(nonlinear):
    """The last residuals square (up to a constant) once the status is settled.

    Also with a linear bulk: the direction of slip is nonlinear in 3D.
    """
    size = 3 if nonlinear else 1
    push = (0.005 * size, 0.003 * size, (-0.02 + 0.02 * x + 0.005 * y) * size)
    problem = mixed_press3d(nonlinear=nonlinear, push=push)
    solver = problem.solver()
    solver.Solve(printing=False, tol=1e-12)
    settled = [h for h in solver.history if h.number >= 2 and h.changed == 0]
    errors = np.array([max(h.equilibrium, h.constraint) for h in settled])
    errors = errors[errors > 1e-13]
    assert set(problem.contact.Table()["status"]) >= {1, 2}
    assert len(errors) >= 2
    assert errors[0] > 1e-6
    assert np.all(errors[1:] < 10 * errors[:-1] ** 2 + 1e-13)
    assert errors[-1] < 1e-7
    assert all(h.damping == 1 for h in solver.history)
    assert len(solver.history) <= 9


@pytest.mark.parametrize("law", [{"friction": 0.3}, {}, {"tresca": 0.01}, {"tied": True}])
def test_stock_newton_finds_the_same_in_3d(law):
    """FormSum with NGSolve's NewtonSolver, the pairing fixed in the reference configuration."""
    flags = {"nonlinear": True, "n": (2, 1), "friction": None} | law
    mine, stock = (mixed_press3d(**flags) for _ in range(2))
    solved(mine)
    newton = NewtonSolver(
        FormSum(stock.a, stock.contact), stock.gf, freedofs=stock.X.FreeDofs(), inverse="umfpack"
    )
    newton.Solve(maxerr=1e-12, maxit=20, printing=False)
    difference = numpy(mine.gf) - numpy(stock.gf)
    assert np.abs(difference).max() <= 1e-10 * np.abs(numpy(mine.gf)).max()


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("nonlinear", [False, True])
def test_condensation_changes_nothing_in_3d(order, nonlinear):
    n = (3, 2) if order == 2 else (2, 1)
    problems = [
        mixed_press3d(order=order, kinds=("hex", "hex"), n=n, nonlinear=nonlinear, condense=c)
        for c in (False, True)
    ]
    for problem in problems:
        solved(problem)
    full, condensed = (numpy(problem.gf) for problem in problems)
    assert np.abs(full - condensed).max() <= 1e-10 * np.abs(full).max()
    free = [sum(map(bool, p.X.FreeDofs(p.a.condense))) for p in problems]
    inside = 3 * (order - 1) ** 3 * problems[0].mesh.ne
    assert free[0] - free[1] == inside


def test_the_safe_solver_finds_the_same_in_3d():
    reference, other = mixed_press3d(n=(3, 2)), mixed_press3d(n=(3, 2))
    solved(reference)
    solved(other, inverse="umfpack")
    assert numpy(other.gf) == pytest.approx(numpy(reference.gf), abs=1e-11)


@pytest.mark.parametrize(
    "space",
    [
        lambda m, **f: H1(m, dim=3, **f),
        lambda m, **f: VectorValued(H1(m, **f), 3),
    ],
    ids=["H1(dim=3)", "VectorValued"],
)
def test_other_spaces_of_the_same_functions(space):
    reference, other = (press3d(space=s, n=(2, 1), friction=0.3) for s in (VectorH1, space))
    solved(reference)
    solved(other)
    assert other.contact.Force() == pytest.approx(reference.contact.Force(), rel=1e-10)
    check_law(other.contact)


def split_slave(mesh):
    return SplitSlaveFaces(mesh, "slave")


@pytest.mark.parametrize("kinds", KINDS)
def test_bubbles_and_split_faces(kinds):
    """Order 1 with either remedy: the law holds, and both find about the same force."""
    bubble = press3d(
        kinds=kinds, space=BubbleVectorH1, order=1, flags={"slave": "slave"}, friction=0.3
    )
    split = press3d(
        kinds=kinds, order=1, friction=0.3, change=lambda m: SplitSlaveFaces(m, "slave")
    )
    for problem in (bubble, split):
        solved(problem)
        check_law(problem.contact)
        assert problem.contact.space.nmacros == 9 * (2 if kinds[0] in ("tet", "prism") else 1)
    assert bubble.contact.Force() == pytest.approx(split.contact.Force(), rel=0.05)


def test_friction_parameter_in_3d():
    """A Parameter changes the next solve; the limits are frictionless and stick."""
    coefficient = Parameter(0.0)
    problem = press3d(friction=coefficient, kinds=("hex", "hex"))
    force, tangential = {}, {}
    for value in (0.0, 0.05, 10.0):
        coefficient.Set(value)
        problem.gf.vec[:] = 0
        solved(problem)
        force[value] = problem.contact.Force()
        table = problem.contact.Table()
        tangential[value] = table["area"] @ np.linalg.norm(table["traction"][:, :2], axis=1)
    assert force[0.0][:2] == pytest.approx(0, abs=1e-12)
    # The directions of slip differ: the bound holds for the sum of sizes, not for the resultant.
    assert tangential[0.05] == pytest.approx(0.05 * force[0.05][2], rel=1e-10)
    assert np.linalg.norm(force[0.05][:2]) == pytest.approx(tangential[0.05], rel=5e-3)
    assert force[0.05][1] / force[0.05][0] == pytest.approx(0.5, rel=0.02)  # along the push
    assert set(problem.contact.Table()["status"]) == {1}
    check_law(problem.contact)


def test_friction_depends_on_the_position_in_3d():
    problem = press3d(friction=0.02 + 0.05 * x + 0.03 * y, push=(0.05, 0.03, -0.02))
    solved(problem)
    table = problem.contact.Table()
    expected = 0.02 + table["x"] @ (0.05, 0.03, 0)
    assert table["friction"] == pytest.approx(expected, rel=1e-12)
    assert set(table["status"]) == {2}
    check_law(problem.contact)


def test_right_hand_sides_in_3d():
    reference, form_rhs, callable_rhs = (press3d(friction=0.2, n=(2, 1)) for _ in range(3))
    traction = CF((0.5, 0.2, -2.0))
    v = reference.X.TestFunction()[0]
    reference.a += -InnerProduct(traction, v) * ds("top")
    solved(reference)
    for other, make in ((form_rhs, lambda f: f), (callable_rhs, lambda f: lambda: f.vec)):
        v = other.X.TestFunction()[0]
        form = LinearForm(InnerProduct(traction, v) * ds("top")).Assemble()
        solved(other, rhs=make(form))
        assert numpy(other.gf) == pytest.approx(numpy(reference.gf), abs=1e-12)


def test_freedofs_in_3d():
    """Fixing more than the space does."""
    free = press3d(friction=0.3)
    fixed = press3d(friction=0.3, flags={"dirichlet": "bottom|top"})
    solved(fixed)
    solved(free, freedofs=BitArray(fixed.X.FreeDofs()))
    assert numpy(free.gf) == pytest.approx(numpy(fixed.gf), abs=1e-13)


def test_threads_change_nothing_in_3d():
    one, many = (mixed_press3d(nonlinear=True, n=(3, 2)) for _ in range(2))
    solved(one)
    with TaskManager():
        solved(many)
    assert numpy(many.gf) == pytest.approx(numpy(one.gf), abs=1e-11)


def test_stiffness_factor_does_not_change_the_solution_in_3d():
    reference = mixed_press3d(n=(2, 1))
    solved(reference)
    for factor in (0.01, 30.0):
        problem = mixed_press3d(n=(2, 1), stiffness=factor)
        solved(problem)
        assert numpy(problem.gf) == pytest.approx(numpy(reference.gf), abs=1e-11)


def test_reaction_of_the_springs_is_the_contact_force():
    problem = mixed_press3d()
    solved(problem)
    u = problem.gf.components[0]
    push = CF((0.005, 0.003, -0.02 + 0.02 * x + 0.01 * y))
    springs = Integrate(1000 * (u - push), problem.mesh.Boundaries("top"), BND, order=6)
    assert problem.contact.Force() == pytest.approx(np.array(springs), abs=1e-9)


# --- load steps --------------------------------------------------------------------------------


def test_steps_reach_the_end_in_3d():
    problem, seen = mixed_press3d(n=(3, 2), nonlinear=True), []
    problem.load.Set(0.0)
    steps = LoadStepper(problem.solver(), problem.load).Integrate(
        steps=3, printing=False, callback=seen.append
    )
    assert seen == steps
    assert [s.time for s in steps] == pytest.approx([1 / 3, 2 / 3, 1.0])
    assert all(s.cuts == 0 for s in steps)
    check_law(problem.contact)


def test_a_path_in_two_directions_leaves_its_trace():
    """Slid along x, then along y: friction follows the last motion, not the whole way."""
    direction = Parameter(0.0)
    push = (0.05 - 0.05 * direction, 0.05 * direction, -0.02)
    problem = press3d(friction=0.05, push=push, kinds=("hex", "hex"))
    solver = problem.solver()
    forces = []
    for value in (0.0, 0.5, 1.0):
        direction.Set(value)
        solver.Solve(printing=False)
        forces.append(problem.contact.Force())
        problem.contact.Commit(problem.gf)
    assert forces[0][0] < 0
    assert abs(forces[0][1]) < 1e-3 * abs(forces[0][0])
    for force in forces[1:]:
        assert force[0] > 0  # x goes back
        assert force[1] < 0
        assert np.linalg.norm(force[:2]) == pytest.approx(0.05 * force[2], rel=1e-2)


def test_prescribed_displacements_in_3d():
    problem = press3d(spring=0, flags={"dirichlet": "bottom|top"}, friction=0.4)
    problem.load.Set(0.0)
    V = problem.X.components[0]
    top = np.array([bool(b) for b in V.GetDofs(problem.mesh.Boundaries("top"))])
    wanted = GridFunction(V)
    wanted.Set(CF((0.01, 0.005, -0.02)), definedon=problem.mesh.Boundaries("top"))

    def prescribe(gf):
        values = gf.components[0].vec.FV().NumPy()
        values[top] = problem.load.Get() * numpy(wanted)[top]

    stepper = LoadStepper(problem.solver(), problem.load, prescribe=prescribe)
    stepper.Integrate(steps=2, printing=False)
    at_top = problem.gf.components[0](problem.mesh(0.5, 0.5, 1))
    assert at_top == pytest.approx((0.01, 0.005, -0.02), rel=1e-12)
    assert problem.contact.Force()[2] > 0.5
