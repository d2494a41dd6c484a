"""A bulk that seems linear: its residual is a product, and convergence is not taken on trust."""

import numpy as np
import pytest
from ngsolve import CF, Grad, IfPos, InnerProduct, Parameter, Sym, ds, dx, sqrt
from press import mixed_press, numpy, press, solved, stress

from ngslac import AugmentedLagrangianSolver, ContactSolver, LoadStepper
from ngslac.solve.bulk import Bulk


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


def watched(problem, kind=ContactSolver):
    solver = kind(problem.a, problem.gf, problem.contact)
    solver.system.bulk.a = Watched(problem.a)
    return solver


class Distrustful(Bulk):
    """Never takes a product for the form: applies that to every trial state."""

    def Apply(self, exact):
        return super().Apply(True)


def distrustful(problem):
    solver = problem.solver()
    solver.system.bulk = solver.system.residual.bulk = Distrustful(problem.a, problem.gf, None)
    return solver


def exact(problem):
    """The solution without trust."""
    distrustful(problem).Solve(printing=False)
    return numpy(problem.gf)


def equilibrium(problem):
    """The residual of bulk and contact on the free dofs over the largest contact force."""
    bulk, contact = problem.gf.vec.CreateVector(), problem.gf.vec.CreateVector()
    problem.a.Apply(problem.gf.vec, bulk)
    problem.contact.Apply(problem.gf.vec, contact)
    free = np.array([bool(b) for b in problem.X.FreeDofs()])
    return np.abs((numpy(bulk) + numpy(contact))[free]).max() / np.abs(numpy(contact)).max()


def trusting(problem, step=1e-3):
    """A solver that takes the bulk for linear, and gf a random step away from its solution."""
    solver = solved(problem)
    problem.a.AssembleLinearization(problem.gf.vec)
    solver.system.residual.Begin(solver.system.scale, 1e-10)
    solver.system.bulk.islinear = True
    random = np.random.default_rng(1).standard_normal(len(problem.gf.vec))
    problem.gf.vec.FV().NumPy()[:] += step * random * solver.system.residual.free
    return solver


@pytest.mark.parametrize("step", [1e-4, 1e-2, 10.0])
def test_confirmation_finds_that_a_bulk_is_not_linear(step):
    """Where the step led to nothing better, or where there is no residual, it is taken back."""
    problem = mixed_press(nonlinear=True)
    solver = trusting(problem, step)
    start = numpy(solver.system.bulk.last.vec)
    confirmed = solver.system.residual.Confirm(
        solver.system.residual.Measure(solver.system.scale), solver.system.scale
    )
    assert confirmed.exact
    assert confirmed.finite
    assert solver.system.bulk.product is None
    assert np.array_equal(numpy(problem.gf), start)  # a random step from a solution is worse


def pushed_aside():
    problem, side = mixed_press(), Parameter(0.0)
    problem.a += side * problem.X.TestFunction()[0][0] * ds("top")
    return problem, side


def test_a_linear_bulk_is_applied_at_the_start_and_in_the_end():
    problem, side = pushed_aside()
    solver = watched(problem)
    assert solver.Solve(printing=False).number == 1
    assert (solver.a.applied, solver.a.assembled) == (
        3,
        1,
    )  # one of them at random tells that it is
    side.Set(30.0)
    assert solver.Solve(printing=False).number == 1
    assert (solver.a.applied, solver.a.assembled) == (5, 1)
    assert equilibrium(problem) < 1e-10
    other, side = pushed_aside()
    side.Set(30.0)
    assert numpy(problem.gf) == pytest.approx(exact(other), abs=1e-11)


@pytest.mark.parametrize("nonlinear", [False, True])
def test_a_condensed_bulk_is_always_applied_and_assembled_once_where_it_is_linear(nonlinear):
    problem = mixed_press(condense=True, order=4, h=0.3, nonlinear=nonlinear)
    solver = watched(problem)
    last = solver.Solve(printing=False)
    assert solver.system.bulk.product is None
    assert solver.a.applied >= last.number + 1
    assert solver.system.bulk.islinear is not nonlinear
    assert solver.a.assembled == (last.number if nonlinear else 1)
    whole = mixed_press(order=4, h=0.3, nonlinear=nonlinear)
    solved(whole)
    assert numpy(problem.gf) == pytest.approx(
        numpy(whole.gf), abs=1e-8 * np.abs(numpy(whole.gf)).max()
    )


def test_what_is_condensed_counts_where_a_bulk_seems_to_be_linear():
    """A law that is nonlinear for functions inside of elements alone: they vanish at their rim."""
    problem = mixed_press(condense=True, order=4, h=0.3)
    solver = solved(problem)
    bulk, scale = solver.system.bulk, solver.system.scale
    assert np.any(bulk.inner)
    motion = np.random.default_rng(5).standard_normal(len(scale)) * solver.system.residual.free
    whole = mixed_press(order=4, h=0.3)
    whole.a.AssembleLinearization(whole.gf.vec)
    change, moved = problem.gf.vec.CreateVector(), whole.gf.vec.CreateVector()
    moved.FV().NumPy()[:] = motion
    change.data = whole.a.mat * moved

    def moves_inside():
        deviation, expected = bulk.Deviation(numpy(change), motion)
        return np.all(np.abs(deviation)[bulk.inner] <= 1e-8 * expected[bulk.inner])

    assert moves_inside()
    change.FV().NumPy()[np.flatnonzero(bulk.inner)[0]] *= 1.001
    assert not moves_inside()


@pytest.mark.parametrize("kind", [ContactSolver, AugmentedLagrangianSolver])
def test_a_stiffness_that_changes_between_solves(kind):
    """The matrix that was kept is that of another material."""
    results = []
    for factors in ((1.0, 2.0), (2.0,)):
        problem, factor = press(), Parameter(1.0)
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
    """The side meets a one-sided spring on its way."""
    problem = press(push=(0.05, -0.02))
    u, v = problem.X.TrialFunction()[0], problem.X.TestFunction()[0]
    problem.a += IfPos(u[0] - 0.02, 1e4 * (u[0] - 0.02), 0) * v[0] * ds("right_upper")
    return problem


def softening():
    """The lower block softens when it is strained, which begins when the gap of 0.01 is closed."""
    problem = press(push=(0, -0.05))
    u, v = problem.X.TrialFunction()[0], problem.X.TestFunction()[0]
    strain = Sym(Grad(u))
    loss = 1 - 1 / sqrt(1 + InnerProduct(strain, strain) / 1e-4)
    problem.a += -0.5 * loss * InnerProduct(stress(u), Sym(Grad(v))) * dx("lower")
    lift = problem.mesh.MaterialCF({"upper": CF((0, 0.01))}, default=CF((0, 0)))
    problem.gf.components[0].Set(lift)
    return problem


@pytest.mark.parametrize(
    ("make", "loads"), [(with_stop, (0.2, 0.3, 1.0)), (softening, (-0.2, -0.1, 1.0))]
)
def test_a_law_that_begins_to_act(make, loads):
    """The first loads do not reach it: the form is known not to be linear all the same."""
    problem = make()
    solver, trusted = watched(problem), []
    for load in loads:
        problem.load.Set(load)
        solver.Solve(
            printing=False,
            callback=lambda _: trusted.append(solver.system.bulk.product is not None),
        )
        assert load < 0 or equilibrium(problem) < 1e-9
    assert not any(trusted)
    assert solver.a.assembled > 1
    assert numpy(problem.gf) == pytest.approx(exact(make()), abs=1e-9)


def test_prescribed_displacements_of_a_linear_bulk():
    """Values that jump belong to the step: the product starts behind them."""
    results, counts = [], []
    for make in (watched, distrustful):
        problem = press(friction=0.5, spring=0, flags={"dirichlet": "bottom|top"})
        problem.load.Set(0.0)
        solver, motion = make(problem), {"top": problem.load * CF((0.02, -0.02))}
        stepper = LoadStepper(solver, problem.load, prescribe=motion)
        for end in (0.3, 1.0):
            stepper.Integrate(end, steps=1, printing=False)
            assert equilibrium(problem) < 1e-9
            if make is watched:
                counts.append((solver.a.applied, solver.a.assembled))
        results.append(numpy(problem.gf))
    (first, before), (both, after) = counts
    assert before == after
    assert both - first <= 5  # two to compare starts, at the start, behind the motion, in the end
    assert results[0] == pytest.approx(results[1], abs=1e-11)


def test_the_merit_of_a_changed_load():
    """Asked between solves, nothing of the last one may be left in it."""
    problems = mixed_press(), mixed_press()
    solver, other = (solved(problem) for problem in problems)
    for problem in problems:
        problem.load.Set(1.7)
    assert solver.system.bulk.product is not None
    other.system.bulk.islinear = False
    assert solver.Merit() == pytest.approx(other.Merit(), rel=1e-10)
    assert solver.Merit() > 1e-3


def test_the_merit_of_a_state_that_was_put_back():
    """Under the load of then, of which nothing but the state is left."""
    problem = mixed_press()
    problem.load.Set(0.5)
    solver = solved(problem)
    state = solver.State()
    problem.load.Set(1.0)
    solver.Solve(printing=False)
    assert solver.system.bulk.product is not None
    solver.SetState(state)
    problem.load.Set(0.5)
    assert solver.Merit(same_load=True) == pytest.approx(solver.Merit(), abs=1e-12)


def test_no_trust_is_left_after_a_failure():
    problem = mixed_press()
    solver = solved(problem)
    problem.load.Set(np.nan)
    with pytest.raises(Exception, match="NaN"):
        solver.Solve(printing=False)
    assert solver.system.bulk.product is None
    problem.load.Set(1.0)
    solver.Solve(printing=False)
    assert equilibrium(problem) < 1e-10
