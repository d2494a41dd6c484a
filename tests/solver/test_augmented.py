"""The augmented Lagrangian solver finds what ContactSolver finds."""

from contextlib import contextmanager

import numpy as np
import pytest
from loaded import loaded
from ngsolve import CF, ds
from press import mixed_press, mixed_press3d, numpy, press, same, solved

from ngslac import (
    AugmentedLagrangianSolver,
    ContactConvergenceError,
    ContactSolver,
    FloatingBodyError,
    LoadStepper,
)
from ngslac._ngslac import MergeMatrices
from ngslac.bodies.constraints import ToCSR

SMOOTH = {"friction": None}
CASES = {
    "frictionless": (mixed_press, SMOOTH),
    "friction": (mixed_press, {}),
    "stick": (press, {"friction": 1.0}),
    "tresca": (press, {"tresca": 0.1}),
    "bilateral": (mixed_press, {"bilateral": True}),
    "finite bilateral": (mixed_press, {"nonlinear": True, "finite": True, "bilateral": True}),
    "finite tied": (press, {"nonlinear": True, "finite": True, "tied": True}),
    "tied": (press, {"tied": True}),
    "hyperelastic": (mixed_press, {"nonlinear": True} | SMOOTH),
    "hyperelastic with friction": (mixed_press, {"nonlinear": True}),
    "finite": (mixed_press, {"nonlinear": True, "finite": True} | SMOOTH),
    "finite with friction": (mixed_press, {"nonlinear": True, "finite": True}),
    "condensed": (mixed_press, {"condense": True, "order": 3} | SMOOTH),
    "3D": (mixed_press3d, SMOOTH),
    "3D friction": (mixed_press3d, {"n": (3, 2)}),
}


def made(case, **more):
    make, flags = CASES[case]
    return make(**(flags | more))


def on(problem, kind=AugmentedLagrangianSolver, **flags):
    return kind(problem.a, problem.gf, problem.contact, **flags)


def augmented(problem, *, maxit=100, tol=1e-10, callback=None, **flags):
    """The solver after a solve."""
    solver = on(problem, **flags)
    solver.Solve(printing=False, maxit=maxit, tol=tol, callback=callback)
    return solver


@pytest.mark.parametrize("case", CASES)
def test_solution_of_contact_solver(case):
    problem, other = made(case), made(case)
    solver = augmented(problem, tol=1e-12)
    last = other.solver().Solve(printing=False, tol=1e-12)
    same(problem, other, 1e-9)
    assert (solver.history[-1].open, solver.history[-1].stick) == (last.open, last.stick)
    assert last.slip > 0 or case in ("stick", "tied", "finite tied")
    assert solver.outer > 1


def test_residuals_are_those_of_contact_solver():
    """Converged for one is converged for the other, whatever the augmentation."""
    problem = mixed_press()
    last = augmented(problem, augmentation=300.0).history[-1]
    state = problem.solver().Solve(printing=False, maxit=1)
    assert state.number == 0
    assert state.equilibrium == pytest.approx(last.equilibrium, rel=0.5, abs=1e-13)
    assert state.constraint == pytest.approx(last.constraint, rel=1e-3)


@pytest.mark.parametrize("gap", [0.0, 0.1])
def test_a_body_that_has_to_be_pulled_to_its_partner(gap):
    """Held against x only: contact has to close before anything holds against y."""
    problem = press(spring=0, flags={"dirichlet": "bottom", "dirichletx": "top"})
    problem.a += problem.X.TestFunction()[0][1] * ds("top")
    lift = problem.mesh.MaterialCF({"upper": CF((0, gap))}, default=CF((0, 0)))
    problem.gf.components[0].Set(lift)
    augmented(problem)
    assert problem.contact.Force()[1] == pytest.approx(1.0, abs=1e-9)


# --- iterations ----------------------------------------------------------------------------------


def test_larger_augmentation_needs_fewer_outer_iterations():
    solvers = [augmented(mixed_press(**SMOOTH), augmentation=10.0**k) for k in range(4)]
    outer = [solver.outer for solver in solvers]
    assert [solver.factor for solver in solvers] == [1, 10, 100, 1000]
    assert outer == sorted(outer, reverse=True)
    assert outer[0] > 3 * outer[2]
    assert outer[2] <= 5
    constraints = np.array([entry.constraint for entry in solvers[2].history[-3:]])
    assert np.all(constraints[1:] < 0.02 * constraints[:-1])


@pytest.mark.parametrize("stiffness", [1e-6, 1e5])
@pytest.mark.parametrize("case", ["friction", "stick", "tied", "finite with friction", "3D"])
def test_the_scale_of_the_contact_does_not_matter(case, stiffness):
    problem, other = made(case, stiffness=stiffness), made(case)
    solver = augmented(problem)
    solved(other)
    assert solver.history[-1].number <= 20
    same(problem, other, 1e-6)  # constraints are measured in lengths: soft ones are small


@pytest.mark.parametrize("first", [1e-4, 1e4, 1e7])
@pytest.mark.parametrize(
    "case", ["frictionless", "friction", "stick", "tied", "hyperelastic with friction"]
)
def test_augmentation_finds_its_size(case, first, monkeypatch):
    """As if the bulk's matrix told nothing about the stiffness; in each solve from the start."""
    for name in ("START", "RUBBING"):
        monkeypatch.setattr("ngslac.solve.augmented." + name, first)
    problem, other = made(case), made(case)
    solver = augmented(problem)
    solved(other)
    same(problem, other, 1e-7)
    assert (solver.factor > first) if first < 1 else (solver.factor <= first)
    if case == "frictionless" and first < 1:
        history = [(e.slip, e.constraint) for e in solver.history]
        problem.gf.vec[:] = 0
        solver.system.residual.converged = 0.0
        solver.Solve(printing=False)
        again = [(e.slip, e.constraint) for e in solver.history]
        assert np.array(again) == pytest.approx(np.array(history), rel=1e-6, abs=1e-12)


def test_a_matrix_that_stays_is_factored_once():
    """With a linear bulk the outer iterations change nothing but the right hand side."""
    solver = augmented(mixed_press(**SMOOTH))
    changes = sum(entry.changed > 0 for entry in solver.history)
    assert solver.linear.factorizations <= changes + 1 < solver.history[-1].number


@pytest.mark.parametrize(
    ("problem", "flags", "error", "message"),
    [
        (mixed_press, {"augmentation": 1e-3}, ContactConvergenceError, "augmentation larger than"),
        (mixed_press, {"augmentation": 1e9}, ContactConvergenceError, "augmentation smaller than"),
        (mixed_press, {"maxit": 2}, ContactConvergenceError, "no convergence in 2 iterations"),
        (lambda: loaded(1, 0), {}, FloatingBodyError, "translation in x"),
    ],
)
def test_failure_leaves_everything_as_it_was(problem, flags, error, message):
    problem = problem()
    problem.gf.vec.FV().NumPy()[:] = 1e-3 if "maxit" in flags else 0
    before = numpy(problem.gf)
    with pytest.raises(error, match=message):
        augmented(problem, **flags)
    assert np.array_equal(numpy(problem.gf), before)


# --- as ContactSolver ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "flags",
    [
        SMOOTH,
        {"nonlinear": True, "finite": True},
        {"nonlinear": True, "spring": 0, "flags": {"dirichlet": "bottom|top"}} | SMOOTH,
    ],
)
def test_load_steps(flags):
    solutions = []
    for kind in (AugmentedLagrangianSolver, ContactSolver):
        problem = mixed_press(**flags)
        problem.load.Set(0.0)
        top = {"top": problem.load * CF((0.02, -0.1))} if "spring" in flags else None
        stepper = LoadStepper(on(problem, kind), problem.load, prescribe=top)
        steps = stepper.Integrate(steps=3, printing=False, tol=1e-12)
        assert [step.cuts for step in steps] == [0, 0, 0]
        solutions.append(problem)
    same(*solutions, 1e-9)


@pytest.mark.parametrize("inverse", ["sparsecholesky", "umfpack"])
def test_inverse(inverse):
    problem, other = mixed_press(**SMOOTH), mixed_press(**SMOOTH)
    assert augmented(problem, inverse=inverse).linear.inverse == inverse  # no other had to help
    solved(other)
    same(problem, other, 1e-9)


def test_rows_that_are_condensed_have_a_size_of_their_own():
    """Each as large as those of the matrix, also after inner iterations have been counted."""
    scale = augmented(made("condensed")).system.scale
    assert scale == pytest.approx(solved(made("condensed")).system.scale)


# --- the matrix ----------------------------------------------------------------------------------


@contextmanager
def scaled(form, factor):
    """The form with another c."""
    history = form.History()
    form.SetHistory(history | {"c": factor * history["c"]})
    yield form
    form.SetHistory(history)


def zero(vec):
    made = vec.CreateVector()
    made[:] = 0
    return made


def assembled(solver):
    """The scaled matrix at gf, on the free displacements."""
    vec = solver.gf.vec
    merged = ToCSR(MergeMatrices(solver.a.mat, [], np.ones_like(solver.system.scale))).toarray()
    for contact in solver.contacts:
        with scaled(contact.form, solver.factor) as form:
            merged += ToCSR(form.AssembleAugmented(vec, zero(vec))).toarray()
    free = solver.linear.free & ~solver.system.residual.multipliers
    return (solver.system.scale[:, None] * merged * solver.system.scale)[np.ix_(free, free)]


@pytest.mark.parametrize(
    "problem",
    [
        lambda: mixed_press(**SMOOTH),
        lambda: press(friction=1.0),
        lambda: press(tied=True),
        lambda: mixed_press3d(n=(3, 2), order=1, **SMOOTH),
    ],
)
def test_matrix_is_symmetric_positive_definite(problem):
    problem, factors = problem(), []
    solver = on(problem)

    def check(_):
        if solver.outer == 0:
            return
        mat = assembled(solver)
        assert np.abs(mat - mat.T).max() <= 1e-14 * np.abs(mat).max()
        factors.append(np.linalg.eigvalsh(mat)[0])

    last = solver.Solve(printing=False, callback=check)
    assert last.slip + last.stick > 0
    assert min(factors) > 0
    assert solver.linear.symmetric
    # that of ContactSolver is not
    form = problem.contact.form
    form.AssembleLinearization(problem.gf.vec)
    saddle = ToCSR(MergeMatrices(problem.a.mat, [form], solver.system.scale)).toarray()
    saddle = saddle[np.ix_(solver.linear.free, solver.linear.free)]
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.cholesky(saddle)


def test_friction_that_slips_is_not_symmetric():
    solver = augmented(mixed_press())
    mat = assembled(solver)
    assert np.abs(mat - mat.T).max() > 1e-3 * np.abs(mat).max()
    assert not solver.linear.symmetric


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("friction", [None, 0.3])
def test_matrix_is_the_derivative(finite, friction):
    problem = mixed_press(finite=finite, friction=friction, nonlinear=True)
    rows = augmented(problem, augmentation=10.0).system.residual.multipliers
    form, vec = problem.contact.form, problem.gf.vec
    values = vec.FV().NumPy()
    values[rows] *= 0.9  # the projection differs from the multipliers
    at = values.copy()
    random = np.random.default_rng(3).normal(size=len(at)) * ~rows

    def forces(shift):
        values[:] = at + shift * random
        problem.contact.Follow(problem.gf)  # the matrix sees where the faces of the master end
        residual = zero(vec)
        form.BeginSolve()
        with scaled(form, 10.0):
            mat = form.AssembleAugmented(vec, residual)
        return mat, numpy(residual)

    mat, _ = forces(0.0)
    h = 1e-6 * np.abs(at).max()
    difference = (forces(h)[1] - forces(-h)[1]) / (2 * h)
    derivative = ToCSR(mat) @ random
    assert np.abs(derivative).max() > 0
    assert np.abs(difference - derivative).max() < 1e-6 * np.abs(derivative).max()
