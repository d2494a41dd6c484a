"""ContactSolver: same solution by every route, quadratic convergence, all kinds of input."""

import numpy as np
import pytest
from ngsolve import (
    CF,
    H1,
    BitArray,
    InnerProduct,
    LinearForm,
    Parameter,
    TaskManager,
    ds,
    x,
)
from ngsolve.nonlinearsolvers import NewtonSolver
from press import mixed_press, numpy, press

from ngslac import BubbleVectorH1, ContactSolver, FormSum


def solved(problem, **flags):
    solver = problem.solver(**flags)
    solver.Solve(printing=False)
    return solver


def check_law(contact, tol=1e-9):
    """The contact conditions macro by macro, relative to the largest pressure and size."""
    t = contact.Table()
    p, size = t["pressure"].max(), t["fullarea"].max()
    shear = t["traction"] + t["pressure"][:, None] * t["normal"]
    shear = np.linalg.norm(shear, axis=1)
    is_open, stick, slip = (t["status"] == k for k in range(3))
    assert np.all(t["gap"][is_open] > -tol * size)
    assert np.abs(t["traction"][is_open]).max(initial=0) < tol * p
    assert np.abs(t["gap"][~is_open]).max(initial=0) < tol * size
    assert np.all(t["pressure"][~is_open] > -tol * p)
    bound = t["friction"] * t["pressure"]
    assert np.all(shear <= bound + tol * p)
    assert np.abs(np.linalg.norm(t["slip"], axis=1)[stick]).max(initial=0) < tol * size
    assert shear[slip] == pytest.approx(bound[slip], abs=tol * p)
    # Friction resists the slip of the slave.
    tangential = t["traction"] + t["pressure"][:, None] * t["normal"]
    assert np.all(np.sum(tangential * t["slip"], axis=1)[slip] <= tol * p * size)


@pytest.mark.parametrize("nonlinear", [False, True])
def test_solution_obeys_the_law_with_every_status(nonlinear):
    problem = mixed_press(nonlinear=nonlinear)
    solver = solved(problem)
    assert set(problem.contact.Table()["status"]) == {0, 1, 2}
    check_law(problem.contact)
    last = solver.history[-1]
    assert (last.open, last.stick, last.slip) == tuple(
        np.bincount(problem.contact.Table()["status"], minlength=3)
    )


def test_quadratic_convergence_with_a_nonlinear_bulk():
    """The last residuals square (up to a constant) once the status is settled."""
    problem = mixed_press(nonlinear=True)
    solver = problem.solver()
    solver.Solve(printing=False, tol=1e-12)
    settled = [h for h in solver.history if h.number >= 3 and h.changed == 0]
    errors = np.array([h.equilibrium for h in settled if h.equilibrium > 1e-13])
    assert len(errors) >= 3
    assert np.all(errors[1:] < 10 * errors[:-1] ** 2 + 1e-13)
    assert errors[-1] < 1e-9


def test_linear_bulk_converges_in_the_step_after_the_last_change():
    """Everything is piecewise linear in 2D: the right status gives the solution."""
    problem = mixed_press()
    solver = solved(problem)
    assert solver.history[-1].equilibrium < 1e-12
    assert solver.history[-1].constraint < 1e-12
    assert len(solver.history) <= 6


@pytest.mark.parametrize("law", [{"friction": 0.3}, {}, {"tresca": 0.01}, {"tied": True}])
@pytest.mark.parametrize("nonlinear", [False, True])
def test_stock_newton_finds_the_same(law, nonlinear):
    """FormSum with NGSolve's NewtonSolver, the pairing fixed in the reference configuration."""
    mine, stock = (mixed_press(nonlinear=nonlinear, **({"friction": None} | law)) for _ in range(2))
    solved(mine)
    newton = NewtonSolver(
        FormSum(stock.a, stock.contact), stock.gf, freedofs=stock.X.FreeDofs(), inverse="umfpack"
    )
    newton.Solve(maxerr=1e-12, maxit=20, printing=False)
    difference = numpy(mine.gf) - numpy(stock.gf)
    assert np.abs(difference).max() <= 1e-10 * np.abs(numpy(mine.gf)).max()


def test_form_sum_applies_both():
    problem = mixed_press()
    form = FormSum(problem.a, problem.contact)
    state = problem.gf.vec.CreateVector()
    state.FV().NumPy()[:] = np.random.default_rng(0).normal(size=len(state.FV()))
    form.AssembleLinearization(state)
    y, bulk, contact = (state.CreateVector() for _ in range(3))
    form.Apply(state, y)
    problem.a.Apply(state, bulk)
    problem.contact.Apply(state, contact)
    assert numpy(y) == pytest.approx(numpy(bulk) + numpy(contact), rel=1e-12)
    form.mat.Mult(state, y)
    problem.a.mat.Mult(state, bulk)
    problem.contact.mat.Mult(state, contact)
    assert numpy(y) == pytest.approx(numpy(bulk) + numpy(contact), abs=1e-9)
    assert form.condense is False


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("nonlinear", [False, True])
def test_condensation_changes_nothing(order, nonlinear):
    problems = [
        mixed_press(order=order, nonlinear=nonlinear, condense=c, h=0.25) for c in (False, True)
    ]
    for problem in problems:
        solved(problem)
    full, condensed = (numpy(problem.gf) for problem in problems)
    assert np.abs(full - condensed).max() <= 1e-10 * np.abs(full).max()
    kinds = [len(solver_free(problem)) for problem in problems]
    assert kinds[0] == kinds[1]
    if order == 4:
        free = [sum(solver_free(problem)) for problem in problems]
        assert free[1] < free[0]


def solver_free(problem):
    return [bool(b) for b in problem.X.FreeDofs(problem.a.condense)]


@pytest.mark.parametrize("inverse", ["umfpack", None])
@pytest.mark.parametrize("law", [{}, {"tied": True, "friction": None}])
def test_inverse(inverse, law):
    reference, other = mixed_press(**law), mixed_press(**law)
    solved(reference, inverse="umfpack")
    solved(other, inverse=inverse)
    assert numpy(other.gf) == pytest.approx(numpy(reference.gf), abs=1e-11)


def test_sparsecholesky_or_the_safe_solver():
    """Tied is symmetric; whatever sparsecholesky makes of a saddle point, the result is right."""
    reference, other = press(tied=True), press(tied=True)
    solved(reference)
    solved(other, inverse="sparsecholesky")
    assert numpy(other.gf) == pytest.approx(numpy(reference.gf), abs=1e-11)


def test_a_symmetric_solver_on_an_unsymmetric_matrix_is_noticed():
    reference, other = mixed_press(), mixed_press()
    solved(reference)
    solver = solved(other, inverse="sparsecholesky", solver="saddle")
    assert solver.linear.inverse != "sparsecholesky"
    assert numpy(other.gf) == pytest.approx(numpy(reference.gf), abs=1e-11)


@pytest.mark.parametrize("space", [H1, BubbleVectorH1])
def test_other_displacement_spaces(space):
    flags = {"dim": 2} if space is H1 else {"slave": "slave"}
    order = 2 if space is H1 else 1
    problem = press(space=space, order=order, flags=flags, friction=0.3)
    solved(problem)
    check_law(problem.contact)
    if space is H1:
        reference = press(order=2, friction=0.3)
        solved(reference)
        assert problem.contact.Force() == pytest.approx(reference.contact.Force(), rel=1e-11)


def test_friction_parameter():
    """A Parameter changes the next solve; the limits are frictionless and stick."""
    coefficient = Parameter(0.0)
    problem = press(friction=coefficient)
    force = {}
    for value in (0.0, 0.05, 10.0):
        coefficient.Set(value)
        problem.gf.vec[:] = 0
        solved(problem)
        force[value] = problem.contact.Force()
        fixed = press(friction=value)
        solved(fixed)
        assert force[value] == pytest.approx(fixed.contact.Force(), rel=1e-9, abs=1e-12)
    assert force[0.0][0] == pytest.approx(0, abs=1e-12)
    assert force[0.05][0] == pytest.approx(-0.05 * force[0.05][1], rel=1e-10)
    assert set(problem.contact.Table()["status"]) == {1}


def test_friction_depends_on_the_position():
    """The mean over each macro-element counts."""
    problem = press(friction=0.02 + 0.1 * x, push=(0.05, -0.02))
    solved(problem)
    table = problem.contact.Table()
    assert table["friction"] == pytest.approx(0.02 + 0.1 * table["x"][:, 0], rel=1e-12)
    assert set(table["status"]) == {2}
    check_law(problem.contact)


@pytest.mark.parametrize("kind", ["form", "vector", "callable", "expression"])
def test_right_hand_sides(kind):
    """A traction as rhs does what the same traction does inside of the form."""
    reference, other = mixed_press(), mixed_press()
    traction = CF((0.5, -2.0))
    v = reference.X.TestFunction()[0]
    reference.a += -InnerProduct(traction, v) * ds("top")
    solved(reference)
    v = other.X.TestFunction()[0]
    form = LinearForm(InnerProduct(traction, v) * ds("top")).Assemble()
    half = LinearForm(InnerProduct(0.5 * traction, v) * ds("top")).Assemble()
    rhs = {
        "form": form,
        "vector": form.vec,
        "callable": lambda: form.vec,
        "expression": lambda: 2 * half.vec,
    }
    solved(other, rhs=rhs[kind])
    assert numpy(other.gf) == pytest.approx(numpy(reference.gf), abs=1e-12)


def test_freedofs():
    """Fixing more than the space does."""
    free = press(friction=0.3)
    fixed = press(friction=0.3, flags={"dirichlet": "bottom|top"})
    bits = BitArray(fixed.X.FreeDofs())
    solved(fixed)
    solved(free, freedofs=bits)
    assert numpy(free.gf) == pytest.approx(numpy(fixed.gf), abs=1e-13)


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
    problem = mixed_press()
    problem.solver().Solve()
    first, *lines = capsys.readouterr().out.splitlines()
    assert "linear systems: condensed" in first
    assert len(lines) >= 3
    assert all("equilibrium" in line and "constraint" in line for line in lines)


def test_threads_change_nothing():
    one, many = mixed_press(nonlinear=True), mixed_press(nonlinear=True)
    solved(one)
    with TaskManager():
        solved(many)
    assert numpy(many.gf) == pytest.approx(numpy(one.gf), abs=1e-11)


def test_stiffness_factor_does_not_change_the_solution():
    reference = mixed_press()
    solved(reference)
    for factor in (0.01, 30.0):
        problem = mixed_press(stiffness=factor)
        solver = ContactSolver(problem.a, problem.gf, [problem.contact])
        solver.Solve(printing=False)
        assert numpy(problem.gf) == pytest.approx(numpy(reference.gf), abs=1e-11)
