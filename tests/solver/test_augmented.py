"""The augmented Lagrangian solver finds what ContactSolver finds."""

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
from ngslac.arrays import ToCSR
from ngslac.solve.augmented import Soften

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
    "hyperelastic with friction": (mixed_press, {"nonlinear": True}),
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


def augmented(problem, *, maxit=100, tol=1e-10, **flags):
    """The solver after a solve."""
    solver = on(problem, **flags)
    solver.Solve(printing=False, maxit=maxit, tol=tol)
    return solver


@pytest.mark.parametrize("case", CASES)
def test_solution_of_contact_solver(case):
    problem, other = made(case), made(case)
    solver = augmented(problem, tol=1e-12)
    last = other.solver().Solve(printing=False, tol=1e-12)
    same(problem, other, 1e-9)
    assert (solver.history[-1].open, solver.history[-1].stick) == (last.open, last.stick)
    assert last.slip > 0 or case in ("stick", "tied", "finite tied")
    assert solver.outer == solver.history[-1].number > last.number  # less than Newton's method


@pytest.mark.parametrize("solver", ["direct", "iterative"])
@pytest.mark.parametrize("case", ["3D", "3D friction"])
def test_all_linear_solvers(case, solver):
    """Those of ContactSolver, and none has to help another one."""
    problem, other = made(case), made(case)
    assert augmented(problem, solver=solver).linear.method == solver
    solved(other)
    same(problem, other, 1e-8)


@pytest.mark.parametrize("gap", [0.0, 0.1])
def test_a_body_that_has_to_be_pulled_to_its_partner(gap):
    """Held against x only: contact has to close before anything holds against y."""
    problem = press(spring=0, flags={"dirichlet": "bottom", "dirichletx": "top"})
    problem.a += problem.X.TestFunction()[0][1] * ds("top")
    lift = problem.mesh.MaterialCF({"upper": CF((0, gap))}, default=CF((0, 0)))
    problem.gf.components[0].Set(lift)
    augmented(problem)
    assert problem.contact.Force()[1] == pytest.approx(1.0, abs=1e-9)


def test_each_update_brings_the_constraints_closer_by_the_augmentation():
    """Once the status is settled; so a larger one needs fewer."""
    solvers = [augmented(mixed_press(**SMOOTH), augmentation=10.0**k) for k in range(4)]
    outer = [solver.outer for solver in solvers]
    assert [solver.factor for solver in solvers] == [1, 10, 100, 1000]
    assert outer == sorted(outer, reverse=True)
    assert outer[0] > 3 * outer[2]
    for solver in solvers[1:3]:
        one, two = (entry.constraint for entry in solver.history[-2:])
        assert 0.1 < solver.factor * two / one < 2


@pytest.mark.parametrize("stiffness", [1e-6, 1e5])
@pytest.mark.parametrize("case", ["friction", "stick", "tied", "3D"])
def test_the_scale_of_the_contact_does_not_matter(case, stiffness):
    problem, other = made(case, stiffness=stiffness), made(case)
    solver = augmented(problem)
    solved(other)
    assert solver.history[-1].number <= 20
    same(problem, other, 1e-6)  # constraints are measured in lengths: soft ones are small


@pytest.mark.parametrize("first", [1e-4, 1e4, 1e9])
@pytest.mark.parametrize("case", ["friction", "tied", "hyperelastic with friction"])
def test_augmentation_finds_its_size(case, first, monkeypatch):
    """As if the bulk's matrix told nothing about the stiffness; in each solve from the start."""
    monkeypatch.setattr("ngslac.solve.augmented.START", first)
    problem, other = made(case), made(case)
    solver = augmented(problem)
    solved(other)
    same(problem, other, 1e-7)
    assert (solver.factor > first) if first < 1 else (solver.factor <= first)
    assert solver.augmentation is None
    outer = solver.outer
    problem.gf.vec[:] = 0
    solver.system.residual.converged = 0.0
    solver.Solve(printing=False)
    assert solver.outer == outer


@pytest.mark.parametrize(
    ("problem", "flags", "error", "message"),
    [
        (mixed_press, {"augmentation": 1e-3}, ContactConvergenceError, "augmentation larger than"),
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


# --- the matrix ----------------------------------------------------------------------------------


def parts(solver):
    """Scaled: matrix of the displacements, and what multipliers add to it, and do (G)."""
    system = solver.system
    system.Assemble()
    system.Linearize(system.Measure())
    forms = [contact.form for contact in solver.contacts]
    mat = ToCSR(MergeMatrices(solver.a.mat, forms, system.scale)).toarray()
    rows = system.residual.multipliers
    free = solver.linear.free & ~rows
    told = np.linalg.solve(mat[np.ix_(rows, rows)], mat[np.ix_(rows, free)])
    return mat[np.ix_(free, free)], -mat[np.ix_(free, rows)] @ told, mat[np.ix_(free, rows)]


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
    solver = augmented(problem())
    bulk, penalty, _ = parts(solver)
    assert np.abs(penalty - penalty.T).max() <= 1e-13 * np.abs(penalty).max()
    assert np.linalg.eigvalsh(penalty)[0] > -1e-12
    assert np.linalg.eigvalsh(penalty)[-1] > 1
    assert np.linalg.eigvalsh(bulk + penalty)[0] > 0


def test_penalty_is_that_of_the_augmentation():
    """c/A B^T B where the surfaces are tied, with c in multiples of the stiffness."""
    solver = augmented(press(tied=True, stiffness=0.01, n=(3, 2)), augmentation=40.0)
    _, penalty, G = parts(solver)
    assert penalty == pytest.approx(40.0 / 0.01 * G @ G.T, abs=1e-10)


def test_multipliers_follow_the_projection_but_for_the_penalty():
    """Their block is 1 - 1/c of what it was, less the compliance of the penalty."""
    problem = mixed_press()
    solver, form = solved(problem), problem.contact.form
    scale, dofs = solver.system.scale, np.asarray(form.MultiplierDofs())
    form.AssembleStep(problem.gf.vec, problem.gf.vec.CreateVector())
    before = ToCSR(form.mat)[dofs][:, dofs].toarray()
    Soften(form, 5.0, scale)
    after = ToCSR(form.mat)[dofs][:, dofs].toarray()
    assert np.abs(before).max() > 0
    expected = 0.8 * before - np.diag(scale[dofs] ** -2 / 5.0)
    assert after == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


def test_friction_that_slips_is_not_symmetric():
    _, penalty, _ = parts(augmented(mixed_press()))
    assert np.abs(penalty - penalty.T).max() > 1e-3 * np.abs(penalty).max()
