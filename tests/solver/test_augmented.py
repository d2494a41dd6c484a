"""The augmented Lagrangian solver finds what ContactSolver finds."""

import numpy as np
import pytest
from augmentedpress import augmented, same, solved
from ngsolve import CF, BilinearForm, Grad, GridFunction, InnerProduct, Variation, VectorH1, ds, dx
from plasticity import J2Plasticity, PlaneStrain
from press import linear, mixed_press, mixed_press3d, numpy, press

from ngslac import ContactConvergenceError, FloatingBodyError, LACContact, LACSpace, LoadStepper
from ngslac.meshes import TwoBlocks
from ngslac.solve.augmented import AugmentedLagrangianSolver

# --- the same solution ---------------------------------------------------------------------------

CASES = {
    "frictionless": (mixed_press, {"friction": None}),
    "friction": (mixed_press, {}),
    "stick": (press, {"friction": 1.0}),
    "tresca": (press, {"tresca": 0.1}),
    "tied": (press, {"tied": True}),
    "hyperelastic": (mixed_press, {"nonlinear": True, "friction": None}),
    "hyperelastic with friction": (mixed_press, {"nonlinear": True}),
    "finite": (mixed_press, {"nonlinear": True, "finite": True, "friction": None}),
    "finite with friction": (mixed_press, {"nonlinear": True, "finite": True}),
    "condensed": (mixed_press, {"friction": None, "condense": True, "order": 3}),
    "3D": (mixed_press3d, {"friction": None}),
    "3D friction": (mixed_press3d, {"n": (3, 2)}),
}


@pytest.mark.parametrize("case", CASES)
def test_solution_of_contact_solver(case):
    make, flags = CASES[case]
    problem, other = make(**flags), make(**flags)
    solver = solved(augmented(problem), tol=1e-12)
    last = solved(other.solver(), tol=1e-12).history[-1]
    same(problem.gf, other.gf)
    assert (solver.history[-1].open, solver.history[-1].stick) == (last.open, last.stick)
    assert last.slip > 0 or case in ("stick", "tied")
    assert solver.outer > 1


def test_residuals_are_those_of_contact_solver():
    """Converged for one is converged for the other, whatever the augmentation."""
    problem = mixed_press()
    last = solved(augmented(problem, augmentation=300.0)).history[-1]
    state = problem.solver().Solve(printing=False, maxit=1)
    assert state.number == 0
    assert state.equilibrium == pytest.approx(last.equilibrium, rel=0.5, abs=1e-13)
    assert state.constraint == pytest.approx(last.constraint, rel=1e-3)


def test_two_contacts_hold_a_pile():
    """Block on block on a rigid floor, held by friction alone: all is open at the start."""
    mesh = TwoBlocks(0.34, overhang=0.2, aligned=False, structured=True)
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="slave") * LACSpace(V, slave="bottom")
    (u, upper, floor), (v, *_) = X.TnT()
    a = BilinearForm(X)
    a += linear(u, v) - InnerProduct(CF((0.1, -1.0)), v) * ds("top")
    between = LACContact(u, upper, master="master", friction=0.5)
    below = LACContact(u, floor, obstacle=CF(0.0), friction=0.5)
    solved(AugmentedLagrangianSolver(a, GridFunction(X), [between, below]))
    assert between.Force() == pytest.approx([-0.1, 1.0], abs=1e-9)
    assert below.Force() == pytest.approx([-0.1, 1.0], abs=1e-9)


@pytest.mark.parametrize("gap", [0.0, 0.01, 0.1])
def test_a_body_that_has_to_be_pulled_to_its_partner(gap):
    """Held against x only: contact has to close before anything holds against y."""
    mesh = TwoBlocks(0.34, overhang=0.2, aligned=False, structured=True)
    V = VectorH1(mesh, order=2, dirichlet="bottom", dirichletx="top")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += linear(u, v) + v[1] * ds("top")
    gf = GridFunction(X)
    gf.components[0].Set(mesh.MaterialCF({"upper": CF((0, gap))}, default=CF((0, 0))))
    contact = LACContact(u, lam, master="master")
    solved(AugmentedLagrangianSolver(a, gf, contact))
    assert contact.Force()[1] == pytest.approx(1.0, abs=1e-9)


def test_a_body_that_nothing_holds():
    problem = press(spring=0.0, friction=None)
    (_, _), (v, _) = problem.X.TnT()
    problem.a += -v[0] * ds("top")
    before = numpy(problem.gf)
    with pytest.raises(FloatingBodyError, match="translation in x"):
        augmented(problem).Solve(printing=False)
    assert np.array_equal(numpy(problem.gf), before)


# --- iterations ----------------------------------------------------------------------------------


def test_larger_augmentation_needs_fewer_outer_iterations():
    outer = []
    for augmentation in (1.0, 10.0, 100.0, 1000.0):
        solver = solved(augmented(mixed_press(friction=None), augmentation=augmentation))
        outer.append(solver.outer)
        assert solver.factor == augmentation
    assert outer == sorted(outer, reverse=True)
    assert outer[0] > 3 * outer[2]
    assert outer[2] <= 5


def test_constraints_fall_by_the_augmentation():
    solver = solved(augmented(mixed_press(friction=None), augmentation=100.0))
    constraints = [entry.constraint for entry in solver.history[-3:]]
    assert constraints[1] < 0.02 * constraints[0]
    assert constraints[2] < 0.02 * constraints[1]


@pytest.mark.parametrize("stiffness", [1e-6, 1e5])
@pytest.mark.parametrize("case", ["friction", "stick", "tied", "finite with friction", "3D"])
def test_the_scale_of_the_contact_does_not_matter(case, stiffness):
    make, flags = CASES[case]
    problem, other = make(**flags, stiffness=stiffness), make(**flags)
    solver = solved(augmented(problem))
    solved(other.solver())
    assert solver.history[-1].number <= 20
    same(problem.gf, other.gf, 1e-6)  # constraints are measured in lengths: soft ones are small


@pytest.mark.parametrize("first", [1e-4, 1e-2, 1e4, 1e7])
@pytest.mark.parametrize("case", ["friction", "stick", "tied", "hyperelastic with friction"])
def test_augmentation_finds_its_size(case, first, monkeypatch):
    """As if the bulk's matrix told nothing about the stiffness of the surface."""
    for name in ("START", "RUBBING"):
        monkeypatch.setattr("ngslac.solve.augmented." + name, first)
    make, flags = CASES[case]
    problem, other = make(**flags), make(**flags)
    solver = augmented(problem)
    solver.Solve(printing=False, maxit=100)
    solved(other.solver())
    same(problem.gf, other.gf, 1e-7)
    assert (solver.factor > first) if first < 1 else (solver.factor <= first)


@pytest.mark.parametrize(("given", "remedy"), [(1e-3, "larger"), (1e9, "smaller")])
def test_an_augmentation_that_does_not_do_is_told(given, remedy):
    problem = mixed_press()
    before = numpy(problem.gf)
    with pytest.raises(ContactConvergenceError, match=f"augmentation {remedy} than"):
        augmented(problem, augmentation=given).Solve(printing=False)
    assert np.array_equal(numpy(problem.gf), before)


def test_augmentation_grows_where_the_contact_is_too_soft(monkeypatch):
    monkeypatch.setattr("ngslac.solve.augmented.START", 1e-2)
    problem, other = (mixed_press(friction=None) for _ in range(2))
    solver = solved(augmented(problem))
    assert solver.factor >= 10
    assert solver.history[-1].number < 30
    solved(other.solver())
    same(problem.gf, other.gf, 1e-7)


def test_a_matrix_that_stays_is_factored_once():
    """With a linear bulk the outer iterations change nothing but the right hand side."""
    solver = solved(augmented(mixed_press(friction=None)))
    changes = sum(entry.changed > 0 for entry in solver.history)
    assert solver.linear.factorizations <= changes + 1 < solver.history[-1].number


def test_each_solve_starts_with_the_same_augmentation(monkeypatch):
    monkeypatch.setattr("ngslac.solve.augmented.START", 1e-2)
    problem = mixed_press(friction=None)
    solver = solved(augmented(problem))
    first = solver.history
    problem.gf.vec[:] = 0
    solver.residual.converged = 0.0
    again = solved(solver).history
    assert [e.slip for e in again] == [e.slip for e in first]
    expected = [e.constraint for e in first]
    assert [e.constraint for e in again] == pytest.approx(expected, rel=1e-6, abs=1e-12)


# --- as ContactSolver ----------------------------------------------------------------------------


@pytest.mark.parametrize("flags", [{"friction": None}, {"nonlinear": True, "finite": True}])
def test_load_stepper(flags):
    solutions = []
    for kind in (augmented, lambda problem: problem.solver()):
        problem = mixed_press(**flags)
        problem.load.Set(0.0)
        steps = LoadStepper(kind(problem), problem.load).Integrate(
            steps=3, printing=False, tol=1e-12
        )
        assert [step.cuts for step in steps] == [0, 0, 0]
        solutions.append(problem.gf)
    same(*solutions)


def test_plasticity():
    solutions = []
    for kind in (augmented, lambda problem: problem.solver()):
        problem = press(friction=None, push=(0.0, -0.03))
        material = J2Plasticity(
            problem.mesh, young=100.0, poisson=0.3, yield_stress=1.0, hardening=10.0
        )
        (u, _), (v, _) = problem.X.TnT()
        strain = PlaneStrain(Grad(u))
        a = BilinearForm(problem.X)
        a += Variation(material.Energy(strain) * dx(intrules=material.rules))
        a += 1000 * InnerProduct(u - problem.load * CF((0.0, -0.03)), v) * ds("top")
        problem.a = a
        problem.load.Set(0.0)
        now = PlaneStrain(Grad(problem.gf.components[0]))
        LoadStepper(kind(problem), problem.load).Integrate(
            steps=3, printing=False, tol=1e-12, callback=lambda _, c=material, e=now: c.Commit(e)
        )
        assert numpy(material.accumulated).max() > 1e-3
        solutions.append(problem.gf)
    same(*solutions, 1e-8)


def test_prescribed_displacements_are_carried():
    solutions = []
    for kind in (augmented, lambda problem: problem.solver()):
        problem = press(
            friction=None, nonlinear=True, spring=0.0, flags={"dirichlet": "bottom|top"}
        )
        problem.load.Set(0.0)
        motion = {"top": problem.load * CF((0.02, -0.1))}
        LoadStepper(kind(problem), problem.load, prescribe=motion).Integrate(
            steps=1, printing=False, tol=1e-12
        )
        solutions.append(problem.gf)
    same(*solutions)


@pytest.mark.parametrize("inverse", ["sparsecholesky", "umfpack", None])
def test_inverse(inverse):
    problem, other = mixed_press(friction=None), mixed_press(friction=None)
    solver = solved(augmented(problem, inverse=inverse))
    assert inverse is None or solver.linear.inverse == inverse  # no other one had to help
    solved(other.solver())
    same(problem.gf, other.gf)


def test_failure_leaves_everything_as_it_was():
    problem = mixed_press()
    problem.gf.vec.FV().NumPy()[:] = 1e-3
    before = numpy(problem.gf)
    solver = augmented(problem)
    with pytest.raises(ContactConvergenceError, match="no convergence in 2 iterations"):
        solver.Solve(maxit=2, printing=False)
    assert np.array_equal(numpy(problem.gf), before)
    assert len(solver.history) == 3


@pytest.mark.parametrize("augmentation", [0.0, -1.0, float("nan"), float("inf")])
def test_wrong_augmentation(augmentation):
    with pytest.raises(ValueError, match=r"augmentation = .* must be a positive factor"):
        augmented(press(), augmentation=augmentation)


def test_unknown_inverse():
    with pytest.raises((ValueError, ContactConvergenceError)):
        augmented(press(), inverse="nothing").Solve(printing=False)


def test_rows_that_are_condensed_have_a_size_of_their_own():
    """Each as large as those of the matrix, also after inner iterations have been counted."""
    problem = mixed_press(friction=None, condense=True, order=3)
    scale = solved(augmented(problem)).scale
    alone = mixed_press(friction=None, condense=True, order=3)
    assert scale == pytest.approx(solved(alone.solver()).scale)
