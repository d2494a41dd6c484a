"""The condensed system has the solution of the whole one and the condition of the bulk."""

import numpy as np
import pytest
from netgen.meshing import NgException
from ngsolve import GetNumThreads, IdentityMatrix, Parameter, Projector, SetNumThreads, TaskManager
from press import mixed_press, mixed_press3d, numpy, press, press3d, solved
from scipy.sparse import csr_matrix

from ngslac import BubbleVectorH1
from ngslac._ngslac import Condensation, MergeMatrices, TwoLevelProduct
from ngslac.arrays import AsBits, AsNumPy, Multiply
from ngslac.linear.factor import IsSymmetric, OnVertices
from ngslac.linear.iterative import IterativeCondensed
from ngslac.linear.solver import LinearSolver

TIED = {"tied": True, "friction": None}
PLANE = {
    "stick": (press, {"friction": 5.0}),
    "tied": (press, TIED),
    "frictionless": (press, {"friction": None}),
    "mixed": (mixed_press, {}),
    "large": (mixed_press, {"finite": True, "nonlinear": True}),
    "first order": (mixed_press, {"order": 1}),
    "bubbles": (mixed_press, {"order": 1, "space": BubbleVectorH1, "flags": {"slave": "slave"}}),
}
SPACE = {
    "stick": (press3d, {"friction": 5.0}),
    "tied": (press3d, TIED),
    "frictionless": (press3d, {"friction": None}),
    "mixed": (mixed_press3d, {}),
    "slip": (press3d, {"push": (0.02, 0.01, -0.02), "friction": 0.1}),
    "tets": (mixed_press3d, {"kinds": ("tet", "tet")}),
}
CASES = {f"2D {k}": v for k, v in PLANE.items()} | {f"3D {k}": v for k, v in SPACE.items()}


def system(problem, number=-1):
    """Matrix, right hand side, multipliers and free dofs of a Newton step of a problem."""
    solver, seen = problem.solver(solver="saddle"), []
    solve = solver.linear.Solve

    def Solve(bulk, forms, scale, rhs, *args, **options):
        seen.append((MergeMatrices(bulk, forms, scale), scale * rhs * solver.linear.free))
        return solve(bulk, forms, scale, rhs, *args, **options)

    solver.linear.Solve = Solve
    solver.Solve(printing=False)
    return *seen[number], problem.contact.form.MultiplierDofs(), solver.linear.bits


def dense(mat):
    values, columns, starts = (np.array(part) for part in mat.CSR())
    return csr_matrix((values, columns, starts), shape=mat.shape).toarray()


def condition(matrix):
    """Of the matrix with unit diagonal."""
    scale = 1 / np.sqrt(np.diag(matrix))
    values = np.linalg.eigvalsh(scale[:, None] * matrix * scale)
    assert values[0] > 0
    return values[-1] / values[0]


@pytest.mark.parametrize("case", CASES)
def test_same_solution(case):
    make, flags = CASES[case]
    reference, condensed = make(**flags), make(**flags)
    solved(reference, solver="saddle")
    solver = solved(condensed, solver="direct")
    assert solver.linear.method == "direct"
    assert solver.linear.factorisations > 0
    size = np.abs(numpy(reference.gf)).max()
    assert numpy(condensed.gf) == pytest.approx(numpy(reference.gf), abs=1e-10 * size)


@pytest.mark.parametrize("case", SPACE)
def test_same_iterative_solution(case):
    make, flags = SPACE[case]
    reference, iterative = make(**flags), make(**flags)
    solved(reference, solver="saddle")
    solver = solved(iterative, solver="iterative")
    assert solver.linear.method == "iterative"
    assert solver.linear.factorisations == 0
    for part, expected in zip(iterative.gf.components, reference.gf.components, strict=True):
        size = np.abs(numpy(expected)).max()
        assert numpy(part) == pytest.approx(numpy(expected), abs=1e-7 * size)


@pytest.mark.parametrize("case", CASES)
def test_reduce_and_expand_are_exact(case):
    make, flags = CASES[case]
    mat, b, multipliers, free = system(make(**flags))
    given = mat, multipliers.tolist(), 2 if case.startswith("2D") else 3, free
    condensed = Condensation(*given)
    mask, inner = AsNumPy(free), AsNumPy(condensed.freedofs)
    whole, part = dense(mat)[np.ix_(mask, mask)], dense(condensed.Part())[np.ix_(inner, inner)]
    expected, w = np.zeros(len(b)), np.zeros(len(b))
    expected[mask] = np.linalg.solve(whole, b[mask])
    w[inner] = np.linalg.solve(part, condensed.Reduce(b)[inner])
    # Also for a right hand side that is none of Newton's.
    size = np.abs(expected).max()
    assert condensed.Expand(b, w) == pytest.approx(expected, abs=1e-9 * size)


@pytest.mark.parametrize("case", ["2D stick", "2D tied", "3D stick", "3D tied", "3D frictionless"])
def test_condition_number(case):
    """Within a factor of ten of the bulk's, on the free displacements of both bodies."""
    make, flags = CASES[case]
    mat, _, multipliers, free = system(make(**flags))
    condensed = Condensation(mat, multipliers.tolist(), 2 if case.startswith("2D") else 3, free)
    assert IsSymmetric(condensed)
    inner = np.flatnonzero(AsNumPy(condensed.freedofs))
    rows = np.ix_(inner, inner)
    assert np.sum(condensed.constraints) > 0
    assert condition(dense(condensed.Part())[rows]) < 10 * condition(dense(mat)[rows])


@pytest.mark.parametrize("case", ["2D mixed", "3D mixed", "3D slip"])
def test_frictionless_variant_is_symmetric_and_positive(case):
    make, flags = CASES[case]
    mat, _, multipliers, free = system(make(**flags))
    given = mat, multipliers.tolist(), 2 if case.startswith("2D") else 3, free
    exact, variant = Condensation(*given), Condensation(*given, symmetric=True)
    assert not IsSymmetric(exact)
    assert IsSymmetric(variant)
    inner = np.flatnonzero(AsNumPy(variant.freedofs))
    assert np.linalg.eigvalsh(dense(variant.Part())[np.ix_(inner, inner)])[0] > 0


def test_a_factorisation_serves_again():
    """The friction bound grows: sticking macro-elements stay, the others slip less."""
    bound, problems = Parameter(0.2), []
    for method in ("direct", "saddle"):
        bound.Set(0.2)
        problem = press3d(friction=bound, n=(4, 3))
        solver = problem.solver(solver=method)
        solver.Solve(printing=False)
        before = solver.linear.factorisations
        bound.Set(0.201)
        iterations = solver.Solve(printing=False).number
        assert iterations > 1
        if method == "direct":
            assert solver.linear.factorisations - before < iterations
        problems.append(numpy(problem.gf).copy())
    one, other = problems
    assert one == pytest.approx(other, abs=1e-9 * np.abs(other).max())


def test_without_inner_displacement_the_whole_system_is_solved():
    """Where the inner nodes of a macro-element are held there is nothing to eliminate it with."""
    problem = press(friction=5.0)
    mat, _, multipliers, free = system(problem)
    held = AsNumPy(free)
    acts = (dense(mat)[multipliers] != 0).reshape(-1, 2, len(held)).any(axis=1)
    inner = acts[0] & (acts.sum(axis=0) == 1)
    inner[multipliers] = False
    assert inner.any()
    held &= ~inner
    with pytest.raises(NgException, match="no displacement of its own"):
        Condensation(mat, multipliers.tolist(), 2, AsBits(held))
    solver = problem.solver(solver="direct")
    solver._Assemble()
    linear = LinearSolver(AsBits(held), method="direct", dim=2)
    rhs = np.random.default_rng(0).standard_normal(len(held))
    x = linear.Solve(problem.a.mat, [problem.contact.form], solver.scale, rhs)
    left = (rhs - Multiply([problem.a.mat, problem.contact.form.mat], x)) * held
    assert np.abs(solver.scale * left).max() < 1e-9 * np.abs(solver.scale * rhs).max()
    assert np.all(x[~held] == 0)
    assert linear._factorisations == 1


def two_level(problem):
    """Condensed system of the last step, and its preconditioner."""
    mat, _, multipliers, free = system(problem)
    condensed = Condensation(mat, multipliers.tolist(), 3, free)
    coarse = problem.solver(solver="iterative").linear._methods[0][1].coarse
    return condensed, OnVertices(condensed, coarse, "umfpack")


def random_vectors(system, number):
    """On the free dofs."""
    values = np.random.default_rng(4).standard_normal((number, system.height))
    vectors = [system.CreateRowVector() for _ in values]
    for vec, entries in zip(vectors, values * AsNumPy(system.freedofs), strict=True):
        vec.FV().NumPy()[:] = entries
    return vectors


def test_two_level_preconditioner_is_symmetric_and_positive():
    """To single precision, in which it computes."""
    with TaskManager():
        condensed, inverse = two_level(press3d(friction=5.0, kinds=("tet", "tet")))
        x, y = random_vectors(condensed, 2)
        left, right = (inverse * x).Evaluate(), (inverse * y).Evaluate()
    size = left.Norm() * y.Norm()
    assert left.InnerProduct(y) == pytest.approx(x.InnerProduct(right), abs=1e-6 * size)
    assert left.InnerProduct(x) > 0


@pytest.mark.parametrize("friction", [0.0, 0.05, 5.0])
def test_two_level_product(friction):
    """The last sweep leaves the product with the matrix, also where that has slip."""
    with TaskManager():
        condensed, inverse = two_level(press3d(friction=friction, kinds=("tet", "hex")))
        assert condensed.has_symmetric_contact == (friction != 0.05)
        (x,) = random_vectors(condensed, 1)
        on_free = Projector(condensed.freedofs, True)
        expected = (on_free * (condensed * (inverse * x))).Evaluate()
        product = (TwoLevelProduct(inverse) * x).Evaluate()
    error = (product - expected).Evaluate().Norm()
    assert error < IterativeCondensed.best * expected.Norm()


def test_threads_do_not_change_the_preconditioner():
    before, images = GetNumThreads(), []
    with TaskManager():
        condensed, inverse = two_level(press3d(friction=5.0, kinds=("tet", "tet")))
        (x,) = random_vectors(condensed, 1)
    try:
        for threads in (1, 3):
            SetNumThreads(threads)
            with TaskManager():
                images.append(numpy((inverse * x).Evaluate()))
    finally:
        SetNumThreads(before)
    assert np.array_equal(*images)


def test_matrix_is_merged_in_place_where_only_contact_changes():
    """As merged anew, after each change of status; another bulk makes another matrix."""
    problem = press3d(friction=0.05)
    solver = problem.solver(solver="saddle")
    solver._Assemble()
    form, linear = problem.contact.form, solver.linear
    first = linear._Merge(problem.a.mat, [form], solver.scale, None)
    numpy(problem.gf)[:] = 1e-3 * np.random.default_rng(0).standard_normal(len(numpy(problem.gf)))
    form.AssembleStep(problem.gf.vec, problem.gf.vec.CreateVector())
    again = linear._Merge(problem.a.mat, [form], solver.scale, None)
    assert again is first
    assert np.array_equal(dense(again), dense(MergeMatrices(problem.a.mat, [form], solver.scale)))
    linear.NewBulk()
    assert linear._Merge(problem.a.mat, [form], solver.scale, None) is not first


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("friction", [0.05, 5.0])
def test_own_preconditioner(order, friction):
    """Of any order, also with slip; called anew where the matrix changes."""
    given, calls = {"order": order, "friction": friction, "n": (4, 3)}, []

    def smoother(mat, freedofs):
        calls.append(mat)
        return mat.CreateSmoother(freedofs)

    reference, problem = press3d(**given), press3d(**given)
    solved(reference, solver="saddle")
    solver = solved(problem, preconditioner=smoother)
    assert solver.linear.method == "iterative"
    assert solver.linear.factorisations == 0
    assert 1 <= len(calls) <= len(solver.history)
    size = np.abs(numpy(reference.gf.components[0])).max()
    u, expected = (numpy(p.gf.components[0]) for p in (problem, reference))
    assert u == pytest.approx(expected, abs=1e-7 * size)


def test_preconditioner_has_to_fit():
    def identity(mat, freedofs):
        return IdentityMatrix(mat.height - 1)

    with pytest.raises(ValueError, match="not an operator of the size"):
        press3d().solver(preconditioner=identity).Solve(printing=False)
    with pytest.raises(ValueError, match="preconditioner= goes with solver='iterative'"):
        press3d().solver(solver="direct", preconditioner=identity)
    with pytest.raises(TypeError, match="preconditioner = 'amg' must be a function"):
        press3d().solver(preconditioner="amg")


@pytest.mark.parametrize(("wanted", "kind"), [("fast", ValueError), (3, TypeError)])
def test_unknown_solver(wanted, kind):
    with pytest.raises(kind, match="must be one of 'direct', 'iterative', 'saddle'"):
        press().solver(solver=wanted)


def test_iterative_wants_second_order():
    with pytest.raises(ValueError, match="take a displacement of order 2"):
        press(order=1).solver(solver="iterative")
