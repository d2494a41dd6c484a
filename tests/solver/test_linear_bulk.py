"""A bulk that seems linear: its residual is a product, and convergence is not taken on trust."""

import numpy as np
import pytest
from ngsolve import (
    CF,
    Grad,
    Id,
    IfPos,
    InnerProduct,
    Parameter,
    Sym,
    Trace,
    ds,
    dx,
    sqrt,
)
from press import LAME, MU, mixed_press, numpy, press

from ngslac import AugmentedLagrangianSolver, ContactSolver, LoadStepper
from ngslac.solve.bulk import Bulk
from ngslac.solve.solver import OnBulk


class Watched:
    """The bulk form of a problem; counts how often it is applied and assembled."""

    def __init__(self, a):
        self.a, self.applied, self.assembled = a, 0, 0

    def __getattr__(self, name):
        return getattr(self.a, name)

    def Apply(self, x, y):
        self.applied += 1
        self.a.Apply(x, y)

    def AssembleLinearization(self, x):
        self.assembled += 1
        self.a.AssembleLinearization(x)


def watched(problem, kind=ContactSolver, **flags):
    solver = kind(problem.a, problem.gf, problem.contact, **flags)
    solver.bulk.a = Watched(problem.a)
    return solver


def equilibrium(problem):
    """The residual of bulk and contact on the free dofs over the largest contact force."""
    bulk, contact = problem.gf.vec.CreateVector(), problem.gf.vec.CreateVector()
    problem.a.Apply(problem.gf.vec, bulk)
    problem.contact.Apply(problem.gf.vec, contact)
    free = np.array([bool(b) for b in problem.X.FreeDofs()])
    return np.abs((numpy(bulk) + numpy(contact))[free]).max() / np.abs(numpy(contact)).max()


class Distrustful(Bulk):
    """Never takes a bulk for linear: applies the form to every trial state."""

    def Apply(self, honest):
        return super().Apply(True)


def distrustful(problem):
    return OnBulk(problem.solver(), Distrustful(problem.a, problem.gf, None), None)


def solved(problem):
    distrustful(problem).Solve(printing=False)
    return numpy(problem.gf)


# --- the residual ------------------------------------------------------------------------------


def trust(bulk, mat):
    bulk.Propose(None)
    bulk.Propose(mat)
    assert bulk.product is None  # one step is not enough
    bulk.Propose(mat)
    assert bulk.product is mat


def trusting(problem, step=1e-3):
    """A Residual that takes the bulk for linear, its factors, and gf a random step away."""
    solver = problem.solver()
    solver.Solve(printing=False)
    problem.a.AssembleLinearization(problem.gf.vec)
    solver.residual.Begin(solver.scale, 1e-10)
    trust(solver.bulk, problem.a.mat)
    random = np.random.default_rng(1).standard_normal(len(numpy(problem.gf)))
    problem.gf.vec.FV().NumPy()[:] += step * random * solver.residual.free
    return solver.residual, solver.scale


def test_the_product_is_the_residual():
    residual, scale = trusting(mixed_press())
    product, honest = residual.Measure(scale), residual.Measure(scale, honest=True)
    assert (product.honest, honest.honest) == (False, True)
    assert product.bulk == pytest.approx(honest.bulk, abs=1e-12 * np.abs(honest.bulk).max())
    assert product.merit == pytest.approx(honest.merit, rel=1e-12)
    assert np.array_equal(product.status, honest.status)
    confirmed = residual.Confirm(honest, scale)
    assert confirmed is honest


def test_confirmation_keeps_a_linear_bulk():
    problem = mixed_press()
    residual, scale = trusting(problem)
    before, linear = numpy(problem.gf), residual.bulk.product
    confirmed = residual.Confirm(residual.Measure(scale), scale)
    assert confirmed.honest
    assert residual.bulk.product is linear
    assert np.array_equal(numpy(problem.gf), before)


@pytest.mark.parametrize("step", [1e-4, 1e-2, 10.0])
def test_confirmation_finds_that_a_bulk_is_not_linear(step):
    """Where the step led to nothing better, or where there is no residual, it is taken back."""
    problem = mixed_press(nonlinear=True)
    residual, scale = trusting(problem, step)
    solution = numpy(problem.gf)
    problem.gf.vec.data = residual.bulk.last.vec
    start = numpy(problem.gf)
    problem.gf.vec.FV().NumPy()[:] = solution
    confirmed = residual.Confirm(residual.Measure(scale), scale)
    assert confirmed.honest
    assert confirmed.finite
    assert residual.bulk.product is None
    assert np.array_equal(numpy(problem.gf), start)  # a random step from a solution is worse


def test_a_better_state_is_kept_although_the_bulk_is_not_linear():
    problem = mixed_press(nonlinear=True)
    solver = problem.solver()
    solver.Solve(printing=False)
    problem.load.Set(1.05)
    residual, scale = solver.residual, solver.scale
    problem.a.AssembleLinearization(problem.gf.vec)
    start = residual.Begin(scale, 1e-10)
    trust(solver.bulk, problem.a.mat)
    correction = solver._Correction(solver._Linearize(start))
    problem.gf.vec.FV().NumPy()[:] -= correction
    after = numpy(problem.gf)
    confirmed = residual.Confirm(residual.Measure(scale), scale)
    assert residual.bulk.product is None
    assert np.array_equal(numpy(problem.gf), after)
    assert 0 < confirmed.merit < start.merit


# --- the solver --------------------------------------------------------------------------------


def pushed_aside():
    problem, side = mixed_press(), Parameter(0.0)
    problem.a += side * problem.X.TestFunction()[0][0] * ds("top")
    return problem, side


def test_a_linear_bulk_is_applied_at_the_start_and_in_the_end():
    problem, side = pushed_aside()
    solver = watched(problem)
    assert solver.Solve(printing=False).number >= 3
    assert (solver.a.applied, solver.a.assembled) == (4, 1)  # two steps tell that it is
    side.Set(30.0)
    assert solver.Solve(printing=False).number >= 2
    assert (solver.a.applied, solver.a.assembled) == (6, 1)
    assert equilibrium(problem) < 1e-10
    other, side = pushed_aside()
    side.Set(30.0)
    assert numpy(problem.gf) == pytest.approx(solved(other), abs=1e-11)


def test_a_condensed_bulk_is_always_applied():
    problem = mixed_press(condense=True, order=4, h=0.3)
    solver = watched(problem)
    last = solver.Solve(printing=False)
    assert solver.bulk.product is None
    assert solver.a.applied >= last.number + 1


@pytest.mark.parametrize("kind", [ContactSolver, AugmentedLagrangianSolver])
def test_a_stiffness_that_changes_between_solves(kind):
    """The matrix that was kept is that of another material."""
    results = []
    for factors in ((1.0, 2.0), (2.0,)):
        problem, factor = press(friction=None), Parameter(1.0)
        u, v = problem.X.TrialFunction()[0], problem.X.TestFunction()[0]
        problem.a += factor * InnerProduct(Grad(u), Grad(v)) * dx("lower")
        solver = watched(problem, kind)
        for value in factors:
            factor.Set(100 * value)
            solver.Solve(printing=False)
        assert equilibrium(problem) < 1e-9
        results.append(numpy(problem.gf))
    assert results[0] == pytest.approx(results[1], abs=1e-9)


def with_stop():
    problem = press(friction=None, push=(0.05, -0.02))
    u, v = problem.X.TrialFunction()[0], problem.X.TestFunction()[0]
    problem.a += IfPos(u[0] - 0.02, 1e4 * (u[0] - 0.02), 0) * v[0] * ds("right_upper")
    return problem


def test_a_stop_that_begins_to_act():
    """The side meets a one-sided spring on its way: with small loads nothing tells of it."""
    problem = with_stop()
    solver = watched(problem)
    for load, assembled in ((0.2, 1), (0.3, 1), (1.0, 2)):
        problem.load.Set(load)
        solver.Solve(printing=False)
        assert min(solver.a.assembled, 2) == assembled
        assert equilibrium(problem) < 1e-9
    assert numpy(problem.gf) == pytest.approx(solved(with_stop()), abs=1e-9)


def softening():
    """The lower block softens when it is strained, which begins when the gap of 0.01 is closed."""
    problem = press(friction=None, push=(0, -0.05))
    u, v = problem.X.TrialFunction()[0], problem.X.TestFunction()[0]
    strain = Sym(Grad(u))
    stress = 2 * MU * strain + LAME * Trace(strain) * Id(2)
    loss = 1 - 1 / sqrt(1 + InnerProduct(strain, strain) / 1e-4)
    problem.a += -0.5 * loss * InnerProduct(stress, Sym(Grad(v))) * dx("lower")
    lift = problem.mesh.MaterialCF({"upper": CF((0, 0.01))}, default=CF((0, 0)))
    problem.gf.components[0].Set(lift)
    return problem


def test_a_law_that_yields_in_a_later_iteration():
    """As long as the gap is open the lower block feels nothing, and the bulk is linear."""
    problem = softening()
    solver, trusted = watched(problem), []
    for load in (-0.2, -0.1, 1.0):
        trusted.clear()
        problem.load.Set(load)
        solver.Solve(
            printing=False, callback=lambda _: trusted.append(solver.bulk.product is not None)
        )
    assert trusted[1]
    assert not trusted[-1]
    assert solver.a.assembled > 1
    assert equilibrium(problem) < 1e-9
    assert numpy(problem.gf) == pytest.approx(solved(softening()), abs=1e-9)


def test_prescribed_displacements_of_a_linear_bulk():
    """Values that jump belong to the step: the product starts behind them."""
    problem = press(friction=0.5, spring=0, flags={"dirichlet": "bottom|top"})
    problem.load.Set(0.0)
    solver, applied = watched(problem), []
    motion = {"top": problem.load * CF((0.02, -0.02))}
    stepper = LoadStepper(solver, problem.load, prescribe=motion)
    for end in (0.3, 1.0):
        stepper.Integrate(end, steps=1, printing=False)
        applied.append((solver.a.applied, solver.a.assembled))
        assert equilibrium(problem) < 1e-9
    (first, before), (both, after) = applied
    assert before == after
    assert both - first <= 5  # two to compare starts, at the start, behind the motion, in the end
    other = press(friction=0.5, spring=0, flags={"dirichlet": "bottom|top"})
    other.load.Set(0.0)
    solver = distrustful(other)
    motion = {"top": other.load * CF((0.02, -0.02))}
    stepper = LoadStepper(solver, other.load, prescribe=motion)
    for end in (0.3, 1.0):
        stepper.Integrate(end, steps=1, printing=False)
    assert numpy(problem.gf) == pytest.approx(numpy(other.gf), abs=1e-11)


def test_the_merit_of_a_changed_load():
    """Asked between solves, nothing of the last one may be left in it."""
    problem, other = mixed_press(), mixed_press()
    for each in (problem, other):
        each.solver_ = each.solver()
        each.solver_.Solve(printing=False)
        each.load.Set(1.7)
    other.solver_.residual.bulk.product = None
    assert problem.solver_.residual.bulk.product is not None
    assert problem.solver_.Merit() == pytest.approx(other.solver_.Merit(), rel=1e-10)
    assert problem.solver_.Merit() > 1e-3


def test_no_trust_is_left_after_a_failure():
    problem = mixed_press()
    solver = problem.solver()
    solver.Solve(printing=False)
    problem.load.Set(np.nan)
    with pytest.raises(Exception, match="NaN"):
        solver.Solve(printing=False)
    assert solver.bulk.product is None
    problem.load.Set(1.0)
    solver.Solve(printing=False)
    assert equilibrium(problem) < 1e-10
