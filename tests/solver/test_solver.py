"""ContactSolver in 2D and 3D: the law, quadratic convergence, the same solution by every route."""

import gc
import weakref
from functools import partial

import numpy as np
import pytest
from law import check_law, shear
from ngsolve import (
    CF,
    H1,
    BitArray,
    InnerProduct,
    LinearForm,
    Parameter,
    SetNumThreads,
    TaskManager,
    VectorValued,
    ds,
    x,
    y,
)
from ngsolve.nonlinearsolvers import NewtonSolver
from obstacles import block_on_obstacle
from press import PUSH, mixed_press, numpy, press, same, solved

from ngslac import BubbleVectorH1, FormSum, SplitSlaveFaces

KINDS = [("hex", "hex"), ("tet", "hex"), ("prism", "tet"), ("prism_side", "pyramid")]
TIED = {"tied": True, "friction": None}


@pytest.fixture(params=[2, 3])
def dim(request):
    return request.param


@pytest.mark.parametrize("nonlinear", [False, True])
def test_solution_obeys_the_law_with_every_status(dim, nonlinear):
    problem = mixed_press(dim=dim, nonlinear=nonlinear)
    last = solved(problem).history[-1]
    table = problem.contact.Table()
    assert set(table["status"]) == {0, 1, 2}
    check_law(problem.contact)
    assert (last.open, last.stick, last.slip) == tuple(np.bincount(table["status"], minlength=3))
    # The traction of a slipping macro-element points against its slip.
    traction, slip = (values[table["status"] == 2] for values in (shear(table), table["slip"]))
    sizes = np.linalg.norm(traction, axis=1) * np.linalg.norm(slip, axis=1)
    assert np.sum(traction * slip, axis=1) == pytest.approx(-sizes, rel=1e-8)
    turns = np.degrees(np.arctan2(traction[:, 1], traction[:, 0]))
    assert dim == 2 or np.ptp(turns) > 1  # the directions differ


@pytest.mark.parametrize("kinds", KINDS)
def test_solution_obeys_the_law_for_all_shapes(kinds):
    problem = mixed_press(dim=3, kinds=kinds, n=(3, 2))
    solved(problem)
    check_law(problem.contact)
    assert len(set(problem.contact.Table()["status"])) >= 2


@pytest.mark.parametrize(
    ("dim", "nonlinear", "least", "best"),
    [(2, True, 3, 1e-9), (3, False, 2, 1e-7), (3, True, 2, 1e-7)],
)
def test_quadratic_convergence(dim, nonlinear, least, best):
    """The last residuals square (up to a constant) once the status is settled.

    In 3D also with a linear bulk: there the direction of slip is nonlinear.
    """
    size = 3 if nonlinear else 1
    flat = {"push": tuple(size * p for p in (0.005, 0.003, -0.02 + 0.02 * x + 0.005 * y))}
    problem = mixed_press(dim=dim, nonlinear=nonlinear, **(flat if dim == 3 else {}))
    solver = problem.solver(solver="direct")
    solver.Solve(printing=False, tol=1e-12)
    settled = [h for h in solver.history if h.number >= 2 and h.changed == 0]
    errors = np.array([max(h.equilibrium, h.constraint) for h in settled])
    errors = errors[errors > 1e-13]
    assert set(problem.contact.Table()["status"]) >= {1, 2}
    assert len(errors) >= least
    assert errors[0] > 1e-6
    assert np.all(errors[1:] < 10 * errors[:-1] ** 2 + 1e-13)
    assert errors[-1] < best
    assert all(h.damping == 1 for h in solver.history)
    assert len(solver.history) <= 9


def test_linear_bulk_converges_in_the_step_after_the_last_change():
    """Everything is piecewise linear in 2D: the right status gives the solution."""
    solver = solved(mixed_press())
    assert solver.history[-1].equilibrium < 1e-12
    assert solver.history[-1].constraint < 1e-12
    assert len(solver.history) <= 6


def test_what_has_no_partner_has_the_scale_of_what_has_one():
    problem = press(mesh_flags={"overhang": -0.3})
    solved(problem)
    scale, alone = problem.contact.form.History()["c"], problem.contact.Table()["area"] == 0
    assert np.any(alone)
    assert scale[alone] == pytest.approx(np.mean(scale[~alone]), rel=1e-12)


# --- the same by other routes --------------------------------------------------------------------


LAWS = [{"friction": 0.3}, {}, {"tresca": 0.01}, {"tied": True}, {"condense": True, "order": 3}]


@pytest.mark.parametrize("law", LAWS)
def test_stock_newton_finds_the_same(dim, law):
    """FormSum with NGSolve's NewtonSolver, the pairing fixed in the reference configuration."""
    flags = {"dim": dim, "nonlinear": True, "n": (2, 1), "friction": None} | law
    mine, stock = (mixed_press(**flags) for _ in range(2))
    solved(mine)
    freedofs = stock.X.FreeDofs(stock.a.condense)
    given = {"freedofs": freedofs, "inverse": "umfpack"}
    newton = NewtonSolver(FormSum(stock.a, stock.contact), stock.gf, **given)
    newton.Solve(maxerr=1e-12, maxit=20, printing=False)
    same(stock, mine)


COARSE = {"h": 0.25, "n": (2, 1)}
ROUTES = [  # what both have, what the other one has, how it is solved, accuracy
    *(
        (COARSE | {"dim": d, "order": order, "nonlinear": bulk}, {"condense": True}, {}, 1e-10)
        for d, order, bulk in (
            (2, 2, True),
            (2, 4, False),
            (2, 4, True),
            (3, 2, False),
            (3, 3, True),
        )
    ),
    *(
        (COARSE | {"dim": d}, {"stiffness": factor}, {}, tol)
        for d in (2, 3)
        for factor, tol in ((0.01, 1e-10), (30.0, 1e-10), (1e-6, 1e-9), (1e6, 1e-9))
    ),
    ({}, {}, {"inverse": "umfpack"}, 1e-10),
    ({}, {}, {"inverse": "sparsecholesky", "solver": "direct"}, 1e-10),  # not made for that
    (TIED, {}, {"inverse": "umfpack"}, 1e-10),
    (TIED, {}, {"inverse": "sparsecholesky"}, 1e-10),
    ({"dim": 3, "n": (3, 2)}, {}, {"inverse": "umfpack"}, 1e-10),
]


@pytest.mark.parametrize(("given", "change", "route", "tol"), ROUTES)
def test_the_same_by_another_route(given, change, route, tol):
    reference, other = mixed_press(**given), mixed_press(**given, **change)
    solved(reference)
    solver = solved(other, **route)
    same(other, reference, tol)
    assert "solver" not in route or solver.linear.inverse != "sparsecholesky"


@pytest.mark.parametrize(
    ("dim", "space"),
    [
        (2, lambda m, **f: H1(m, dim=2, **f)),
        (3, lambda m, **f: H1(m, dim=3, **f)),
        (3, lambda m, **f: VectorValued(H1(m, **f), 3)),
    ],
)
def test_other_spaces_of_the_same_functions(dim, space):
    reference, other = (press(dim=dim, n=(2, 1), friction=0.3, **s) for s in ({}, {"space": space}))
    solved(reference)
    solved(other)
    assert other.contact.Force() == pytest.approx(reference.contact.Force(), rel=1e-10)
    check_law(other.contact)


@pytest.mark.parametrize("kinds", [None, *KINDS])
def test_bubbles_and_split_faces(kinds):
    """Order 1 with either remedy: the law holds, and both find about the same force."""
    make = partial(press, dim=3, kinds=kinds) if kinds else press
    split = {"change": lambda mesh: SplitSlaveFaces(mesh, "slave")}
    bubble = {"space": BubbleVectorH1, "flags": {"slave": "slave"}}
    forces = []
    for remedy in (bubble, split):
        problem = make(order=1, friction=0.3, **remedy)
        solved(problem)
        check_law(problem.contact)
        forces.append(problem.contact.Force())
        if remedy is bubble:
            faces = len([*problem.mesh.Boundaries("slave").Elements()])
        assert problem.contact.space.nmacros == faces
    assert forces[0] == pytest.approx(forces[1], rel=0.05)


# --- what is given -------------------------------------------------------------------------------


def test_friction_parameter(dim):
    """A Parameter changes the next solve; the limits are frictionless and stick."""
    coefficient = Parameter(0.0)
    problem, fixed = (press(dim=dim, friction=f, kinds=("hex", "hex")) for f in (coefficient, 0.05))
    force, tangential = {}, {}
    for value in (0.0, 0.05, 10.0):
        coefficient.Set(value)
        problem.gf.vec[:] = 0
        solved(problem)
        force[value] = problem.contact.Force()
        table = problem.contact.Table()
        tangential[value] = table["area"] @ np.linalg.norm(shear(table), axis=1)
    solved(fixed)
    assert force[0.05] == pytest.approx(fixed.contact.Force(), rel=1e-9, abs=1e-12)
    assert force[0.0][:-1] == pytest.approx(0, abs=1e-12)
    # The directions of slip differ: the bound holds for the sum of sizes, not for the resultant.
    assert tangential[0.05] == pytest.approx(0.05 * force[0.05][-1], rel=1e-10)
    along = np.array(PUSH[dim][:-1]) / np.linalg.norm(PUSH[dim][:-1])
    assert -force[0.05][:-1] == pytest.approx(tangential[0.05] * along, rel=0.02)
    assert np.linalg.norm(force[0.05][:-1]) == pytest.approx(
        tangential[0.05], rel=1e-10 if dim == 2 else 5e-3
    )
    assert set(problem.contact.Table()["status"]) == {1}
    check_law(problem.contact)


def test_right_hand_sides(dim):
    """A traction as rhs does what the same traction does inside of the form."""
    reference, *others = (press(dim=dim, friction=0.2, n=(2, 1)) for _ in range(5))
    traction = CF((0.5, 0.2, -2.0)[3 - dim :])
    reference.a += -InnerProduct(traction, reference.X.TestFunction()[0]) * ds("top")
    solved(reference)
    kinds = lambda f: f, lambda f: f.vec, lambda f: lambda: f.vec, lambda f: lambda: 1.0 * f.vec
    for other, kind in zip(others, kinds, strict=True):
        form = LinearForm(InnerProduct(traction, other.X.TestFunction()[0]) * ds("top")).Assemble()
        solved(other, rhs=kind(form))
        same(other, reference, 1e-11)


def test_freedofs(dim):
    """Fixing more than the space does."""
    free = press(dim=dim, friction=0.3)
    fixed = press(dim=dim, friction=0.3, flags={"dirichlet": "bottom|top"})
    solved(fixed)
    solved(free, freedofs=BitArray(fixed.X.FreeDofs()))
    assert numpy(free.gf) == pytest.approx(numpy(fixed.gf), abs=1e-13)


@pytest.mark.parametrize(
    ("make", "flags"),
    [
        (mixed_press, {"h": 0.5, "finite": True, "nonlinear": True}),
        pytest.param(mixed_press, {"h": 0.5}, marks=pytest.mark.full),
        pytest.param(mixed_press, {"dim": 3, "n": (2, 1)}, marks=pytest.mark.full),
        (block_on_obstacle, {"gap": 0.001 * x * x, "friction": 0.2}),
    ],
)
def test_threads_change_nothing_but_rounding(make, flags):
    """In one thread a solution is the same to the last bit."""

    def solution(threads):
        SetNumThreads(threads)
        with TaskManager():
            problem = make(**flags)
            solved(problem)
        return numpy(problem.gf)

    try:
        one, again, three = [solution(threads) for threads in (1, 1, 3)]
    finally:
        SetNumThreads(1)
    assert one.tobytes() == again.tobytes()
    assert np.abs(three - one).max() < 1e-13 * np.abs(one).max()


# --- what is told --------------------------------------------------------------------------------


def test_callback_and_history():
    problem, seen = mixed_press(), []
    solver = problem.solver()
    last = solver.Solve(printing=False, callback=seen.append)
    assert seen == solver.history
    assert last is solver.history[-1]
    assert [h.number for h in seen] == list(range(len(seen)))
    assert all(h.open + h.stick + h.slip == problem.contact.space.nmacros for h in seen)
    assert solver.Solve(printing=False).number == 0  # solved already


def test_printing(capsys):
    mixed_press().solver(solver="direct").Solve()
    first, *lines = capsys.readouterr().out.splitlines()
    assert "linear systems: factors of the whole" in first
    assert len(lines) >= 3
    assert all("equilibrium" in line and "constraint" in line for line in lines)


# --- paths in 3D ---------------------------------------------------------------------------------


def test_a_path_in_two_directions_leaves_its_trace():
    """Slid along x, then along y: friction follows the last motion, not the whole way."""
    direction = Parameter(0.0)
    push = (0.05 - 0.05 * direction, 0.05 * direction, -0.02)
    problem = press(dim=3, friction=0.05, push=push, kinds=("hex", "hex"))
    solver, forces = problem.solver(), []
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


def test_a_solver_that_nobody_holds_is_freed_at_once():
    """With its factors: nothing in it refers back to it."""
    problem = press(friction=0.1)
    solver = solved(problem)
    parts = [weakref.ref(part) for part in (solver, solver.system, solver.linear)]
    gc.collect()
    gc.disable()
    try:
        del solver
        assert [part() for part in parts] == [None] * 3
    finally:
        gc.enable()
