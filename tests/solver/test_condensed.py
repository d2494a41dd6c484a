"""The condensed system has the solution of the whole one and the condition of the bulk."""

from types import SimpleNamespace

import numpy as np
import pytest
from netgen.meshing import NgException
from ngsolve import (
    BitArray,
    GetNumThreads,
    IdentityMatrix,
    Parameter,
    Projector,
    SetNumThreads,
    TaskManager,
)
from press import mixed_press, mixed_press3d, numpy, press, press3d, same, solved
from refused import calls, check_refused

from ngslac import BubbleVectorH1, _ngslac
from ngslac._ngslac import (
    Condensation,
    MergeMatrices,
    OrthogonalCondensation,
    StarSweeps,
    TwoLevelProduct,
)
from ngslac.arrays import AsBits, AsNumPy, Multiply
from ngslac.bodies.constraints import ToCSR
from ngslac.linear.direct import DirectCondensed
from ngslac.linear.factor import (
    LU,
    Cholesky,
    Factor,
    HasMKL,
    IsSymmetric,
    LinearSolveError,
)
from ngslac.linear.iterative import IterativeCondensed
from ngslac.linear.solver import LinearSolver

TIED = {"tied": True, "friction": None}
CASES = {
    "2D stick": (press, {"friction": 5.0}),
    "2D tied": (press, TIED),
    "2D frictionless": (press, {}),
    "2D mixed": (mixed_press, {}),
    "2D large": (mixed_press, {"finite": True, "nonlinear": True}),
    "2D first order": (mixed_press, {"order": 1}),
    "2D bubbles": (mixed_press, {"order": 1, "space": BubbleVectorH1, "flags": {"slave": "slave"}}),
    "3D stick": (press3d, {"friction": 5.0}),
    "3D tied": (press3d, TIED),
    "3D frictionless": (press3d, {}),
    "3D mixed": (mixed_press3d, {}),
    "3D slip": (press3d, {"friction": 0.1}),
    "3D tets": (mixed_press3d, {"kinds": ("tet", "tet")}),
}


def made(case):
    make, flags = CASES[case]
    return make(**flags)


def system(problem):
    """Arguments of the condensation of the last Newton step of a problem, and its right side."""
    solver, seen = problem.solver(solver="saddle"), []
    solve = solver.linear.Solve

    def Solve(bulk, forms, scale, rhs, *args, **options):
        seen.append((MergeMatrices(bulk, forms, scale), scale * rhs * solver.linear.free))
        return solve(bulk, forms, scale, rhs, *args, **options)

    solver.linear.Solve = Solve
    solver.Solve(printing=False)
    multipliers = problem.contact.form.MultiplierDofs().tolist()
    mat, rhs = seen[-1]
    return (mat, multipliers, problem.mesh.dim, solver.linear.bits), rhs


def dense(mat, dofs=None):
    """The matrix, on the dofs whose bits are set."""
    values = ToCSR(mat).toarray()
    return values if dofs is None else values[np.ix_(AsNumPy(dofs), AsNumPy(dofs))]


def condition(matrix):
    """Of the matrix with unit diagonal."""
    scale = 1 / np.sqrt(np.diag(matrix))
    values = np.linalg.eigvalsh(scale[:, None] * matrix * scale)
    assert values[0] > 0
    return values[-1] / values[0]


@pytest.mark.parametrize(
    ("case", "method"),
    [
        *((case, "direct") for case in CASES),
        *((case, "iterative") for case in CASES if case != "2D large"),
    ],
)
def test_same_solution(case, method):
    reference, condensed = made(case), made(case)
    solved(reference, solver="saddle")
    linear = solved(condensed, solver=method).linear
    assert linear.method == method
    assert (linear.factorisations > 0) == (method == "direct")
    same(condensed, reference, 1e-10 if method == "direct" else 1e-7)


@pytest.mark.parametrize("case", CASES)
def test_reduce_and_expand_are_exact(case):
    """Also for a right hand side that is none of Newton's."""
    given, b = system(made(case))
    mat, *_, free = given
    condensed = Condensation(*given)
    expected, w = np.zeros(len(b)), np.zeros(len(b))
    mask, inner = AsNumPy(free), AsNumPy(condensed.freedofs)
    expected[mask] = np.linalg.solve(dense(mat, free), b[mask])
    part = dense(condensed.Part(), condensed.freedofs)
    w[inner] = np.linalg.solve(part, condensed.Reduce(b)[inner])
    size = np.abs(expected).max()
    assert condensed.Expand(b, w) == pytest.approx(expected, abs=1e-9 * size)


@pytest.mark.parametrize("case", ["2D stick", "2D tied", "3D stick", "3D tied", "3D frictionless"])
def test_condition_number(case):
    """Within a factor of ten of the bulk's, on the free displacements of both bodies."""
    given, _ = system(made(case))
    condensed = Condensation(*given)
    assert IsSymmetric(condensed)
    assert np.sum(condensed.constraints) > 0
    inner = condensed.freedofs
    assert condition(dense(condensed.Part(), inner)) < 10 * condition(dense(given[0], inner))


@pytest.mark.parametrize("case", ["2D mixed", "3D mixed", "3D slip"])
def test_frictionless_variant_is_symmetric_and_positive(case):
    given, _ = system(made(case))
    variant = Condensation(*given, symmetric=True)
    assert not IsSymmetric(Condensation(*given))
    assert IsSymmetric(variant)
    assert np.linalg.eigvalsh(dense(variant.Part(), variant.freedofs))[0] > 0


def test_a_factorisation_serves_again():
    """The friction bound grows: sticking macro-elements stay, the others slip less."""
    bound, results = Parameter(0.2), []
    for method in ("direct", "saddle"):
        bound.Set(0.2)
        problem = press3d(friction=bound, n=(4, 3))
        solver = solved(problem, solver=method)
        before = solver.linear.factorisations
        bound.Set(0.201)
        iterations = solver.Solve(printing=False).number
        assert iterations > 1
        assert method == "saddle" or solver.linear.factorisations - before < iterations
        results.append(numpy(problem.gf))
    assert results[0] == pytest.approx(results[1], abs=1e-9 * np.abs(results[1]).max())


@pytest.mark.parametrize(("changes", "serves"), [(0, True), (2, True), (3, False)])
def test_a_factorisation_serves_while_few_macro_elements_change(changes, serves):
    """A change costs four Krylov iterations, of which it has patience for ten."""

    def system(constraints):
        return SimpleNamespace(height=9, constraints=np.array(constraints))

    direct = DirectCondensed(np.ones(9, dtype=bool), BitArray(9), 2)
    assert not direct._Serves(system([0, 1, 0, 1]))
    direct._kept = SimpleNamespace(system=system([0, 1, 0, 1]), patience=10)
    others = [*([1, 0, 1][:changes]), *[0, 1, 0][changes:], 1]
    assert direct._Serves(system(others)) == serves


def test_without_inner_displacement_the_whole_system_is_solved():
    """Where the inner nodes of a macro-element are held there is nothing to eliminate it with."""
    problem = press(friction=5.0)
    (mat, multipliers, dim, free), _ = system(problem)
    held = AsNumPy(free)
    acts = (dense(mat)[multipliers] != 0).reshape(-1, 2, len(held)).any(axis=1)
    inner = acts[0] & (acts.sum(axis=0) == 1)
    inner[multipliers] = False
    assert inner.any()
    held &= ~inner
    with pytest.raises(NgException, match="no displacement of its own"):
        Condensation(mat, multipliers, dim, AsBits(held))
    scale = solved(problem, solver="direct").system.scale
    linear = LinearSolver(AsBits(held), method="direct", dim=2)
    rhs = np.random.default_rng(0).standard_normal(len(held))
    forms = [problem.contact.form]
    x = linear.Solve(problem.a.mat, forms, scale, rhs)
    left = (rhs - Multiply([problem.a.mat, forms[0].mat], x)) * held
    assert np.abs(scale * left).max() < 1e-9 * np.abs(scale * rhs).max()
    assert np.all(x[~held] == 0)
    assert linear.factorisations == 1


def test_wrong_solutions_are_not_taken(monkeypatch):
    """Another solver gets the system; if there is none the error tells the residuals."""
    problem = press(friction=5.0)
    linear, form = solved(problem, solver="saddle").linear, problem.contact.form
    rhs = np.random.default_rng(0).standard_normal(len(linear.free)) * linear.free
    given = problem.a.mat, [form], np.ones(len(rhs)), rhs
    exact, solve = linear.Solve(*given), linear._Refined

    def Wrong(mat, b, inverse):
        return solve(mat, b, inverse) if inverse == safe else (0 * b, 1.0)

    safe, linear.inverse = "umfpack", "wrong"
    monkeypatch.setattr(linear, "_Refined", Wrong)
    assert linear.Solve(*given) == pytest.approx(exact, abs=1e-12 * np.abs(exact).max())
    assert linear.inverse == safe
    safe = None
    with pytest.raises(LinearSolveError, match=r"umfpack: relative residual 1\.0e\+00"):
        linear.Solve(*given)
    monkeypatch.undo()
    assert not np.any(linear.Solve(*given[:3], 0 * rhs))


def test_what_cannot_be_factored(monkeypatch):
    problem = press(flags={})  # nothing holds the blocks
    problem.a.AssembleLinearization(problem.gf.vec)
    with pytest.raises(LinearSolveError, match="umfpack: "):
        Factor(problem.a.mat, None, "umfpack")
    with pytest.raises(ValueError, match="inverse='mumps' is not available"):
        Factor(problem.a.mat, None, "mumps")
    monkeypatch.setattr("importlib.metadata.version", lambda name: f"{name} 2026.1")
    assert HasMKL()
    assert (LU(), Cholesky(), LU("umfpack")) == ("pardiso", "pardisospd", "umfpack")


# --- the preconditioner --------------------------------------------------------------------------


def two_level(friction=5.0, kinds=("tet", "tet")):
    """Condensed system of the last step, and its preconditioner."""
    problem = press3d(friction=friction, kinds=kinds)
    given, _ = system(problem)
    condensed = OrthogonalCondensation(*given)
    multigrid = problem.solver(solver="iterative").linear._methods[0][1].multigrid
    return condensed, multigrid.Preconditioner(condensed, np.ones(condensed.height))


def random_vectors(system, number):
    """On the free dofs."""
    values = np.random.default_rng(4).standard_normal((number, system.height))
    vectors = [system.CreateRowVector() for _ in values]
    for vec, entries in zip(vectors, values * AsNumPy(system.freedofs), strict=True):
        vec.FV().NumPy()[:] = entries
    return vectors


def test_two_level_preconditioner_is_symmetric_and_positive_in_any_number_of_threads():
    """To single precision, in which it computes."""
    before, images = GetNumThreads(), []
    with TaskManager():
        condensed, inverse = two_level()
        x, y = random_vectors(condensed, 2)
        left, right = (inverse * x).Evaluate(), (inverse * y).Evaluate()
    size = left.Norm() * y.Norm()
    assert left.InnerProduct(y) == pytest.approx(x.InnerProduct(right), abs=1e-6 * size)
    assert left.InnerProduct(x) > 0
    try:
        for threads in (1, 3):
            SetNumThreads(threads)
            with TaskManager():
                images.append(numpy((inverse * x).Evaluate()))
    finally:
        SetNumThreads(before)
    assert np.array_equal(*images)


@pytest.mark.parametrize("friction", [0.0, 0.05, 5.0])
def test_two_level_product(friction):
    """The last sweep leaves the product with the matrix, also where that has slip."""
    with TaskManager():
        condensed, inverse = two_level(friction, ("tet", "hex"))
        assert condensed.has_symmetric_contact == (friction != 0.05)
        (x,) = random_vectors(condensed, 1)
        on_free = Projector(condensed.freedofs, True)
        expected = (on_free * (condensed * (inverse * x))).Evaluate()
        product, moved = x.CreateVector(), x.CreateVector()
        TwoLevelProduct(inverse, condensed).Apply(x, moved, product)
        left = (on_free * (condensed * moved) - expected).Evaluate().Norm()
    assert left < 1e-12 * expected.Norm()  # what breaks the constraints is projected away
    error = (product - expected).Evaluate().Norm()
    assert error < IterativeCondensed.single * expected.Norm()


@pytest.mark.parametrize(("order", "friction"), [(1, 0.05), (2, 0.05), (1, 5.0)])
def test_own_preconditioner(order, friction):
    """Of any order, also with slip; called anew where the matrix changes."""
    given, calls = {"order": order, "friction": friction, "n": (4, 3)}, []

    def smoother(mat, freedofs):
        calls.append(mat)
        return mat.CreateSmoother(freedofs)

    reference, problem = press3d(**given), press3d(**given)
    solved(reference, solver="saddle")
    solver = solved(problem, preconditioner=smoother)
    assert (solver.linear.method, solver.linear.factorisations) == ("iterative", 0)
    assert 1 <= len(calls) <= len(solver.history)
    u, expected = (numpy(p.gf.components[0]) for p in (problem, reference))
    assert u == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())


def test_matrix_is_merged_in_place_where_only_contact_changes():
    """As merged anew, after each change of status; another bulk makes another matrix."""
    problem = press3d(friction=0.05)
    solver, vec = solved(problem, solver="saddle"), problem.gf.vec
    given, linear = (problem.a.mat, [problem.contact.form], solver.system.scale), solver.linear
    first = linear._Merge(*given, None)
    vec.FV().NumPy()[:] = 1e-3 * np.random.default_rng(0).standard_normal(len(vec))
    problem.contact.form.AssembleStep(vec, vec.CreateVector())
    again = linear._Merge(*given, None)
    assert again is first
    assert np.array_equal(dense(again), dense(MergeMatrices(*given)))
    other = *given[:2], 2 * given[2]
    assert np.array_equal(dense(linear._Merge(*other, None)), dense(MergeMatrices(*other)))
    linear.NewBulk()
    assert linear._Merge(*given, None) is not first


def test_what_has_not_changed_is_made_once():
    """Matrix, condensation and preconditioner; a shift on the diagonal makes others."""
    problem, made = press3d(friction=0.05), []

    def smoother(mat, freedofs):
        made.append(mat)
        return mat.CreateSmoother(freedofs)

    solver = solved(problem, preconditioner=smoother)
    linear, rhs = solver.linear, np.random.default_rng(4).standard_normal(len(problem.gf.vec))
    given = problem.a.mat, [problem.contact.form], solver.system.scale, rhs
    first, count = linear.Solve(*given, accuracy=1e-3), len(made)
    assert np.array_equal(linear.Solve(*given, accuracy=1e-3), first)
    assert len(made) == count
    shift = np.where(linear.free, 0.1, 0.0)
    shift[problem.contact.form.MultiplierDofs()] = 0
    shifted = linear.Solve(*given, shift, accuracy=1e-3)
    assert len(made) == count + 1
    assert np.abs(shifted - first).max() > 0.1 * np.abs(first).max()
    again = linear.Solve(*given, accuracy=1e-3)
    assert again == pytest.approx(first, abs=1e-12 * np.abs(first).max())
    assert len(made) == count + 2


def test_one_blas_thread_in_a_linear_solve(monkeypatch):
    """Put back afterwards, also after an error."""
    threads, seen = [4], []
    pair = (lambda: threads[-1], threads.append)
    monkeypatch.setattr("ngslac.linear.factor.BLASThreads", lambda: [pair])

    def smoother(mat, freedofs):
        seen.append(threads[-1])
        if len(seen) > 1:
            raise KeyboardInterrupt
        return mat.CreateSmoother(freedofs)

    with pytest.raises(KeyboardInterrupt):
        solved(press3d(friction=0.05), preconditioner=smoother)
    assert seen == [1, 1]
    assert threads[-1] == 4


# --- what does not fit is refused before anything is read with it --------------------------------


def identity(mat, _):
    return IdentityMatrix(mat.height - 1)


WHOLE = "Condensation(mat, multipliers, 2, free)"
REFUSED = [
    *(
        (
            f"Condensation(mat, [*multipliers[:-1], {n}], 2, free)",
            f"no multiplier {n} ",
            NgException,
        )
        for n in (-1, 2**31 - 1)
    ),
    *(
        (f"Condensation(mat, multipliers, {n}, free)", f"no blocks of {n}", NgException)
        for n in (-2, 0, 5000)
    ),
    ("Condensation(mat, multipliers, 2, BitArray(0))", "bits of free dofs", NgException),
    ("Condensation(mat, multipliers, 2, BitArray(len(free) + 1))", "bits of free dof", NgException),
    (f"{WHOLE}.Part(BitArray(0))", r"bits for .* rows", NgException),
    (f"{WHOLE}.Part(BitArray(len(free) + 1))", r"bits for .* rows", NgException),
    *(
        (f"TwoLevel(whole, sweeps, {coarse}, {rows})", message, error)
        for coarse, rows, message, error in (
            ("part", "[inner], [0], [], []", "does not fit its dofs", NgException),
            ("part", "[inner], [0, 2], [0], [1.0]", "does not fit its dofs", NgException),
            ("part", "[inner, inner], [0, 2, 1], [0], [1.0]", "does not fit its dofs", NgException),
            ("part", "[inner], [1, 1], [0], [1.0]", "does not fit its dofs", NgException),
            ("part", "[inner], [0, 1], [-1], [1.0]", "does not fit the prol", NgException),
            ("part", "[inner], [0, 1], [part.height], [1.0]", "does not fit the prol", NgException),
            ("part", "[-1], [0, 1], [0], [1.0]", "dof -1 .* is not free", NgException),
            ("part", "[multipliers[0]], [0, 1], [0], [1.0]", "is not free", NgException),
            ("None", "[inner], [0, 1], [0], [1.0]", "None", TypeError),
        )
    ),
    ("StarSweeps(whole, BitArray(3), stars, 1)", "3 bits for .* rows", NgException),
    ("StarSweeps(whole, free, stars, 2)", "no dof .* of a star", NgException),
    ("sweeps.Update(other)", "another size", NgException),
    ("whole.NodeBlocks([0, 1])", "a table with a row of dofs for each", NgException),
    ("whole.NodeBlocks([[0, 1], [1, 2]])", "dof 1 .* in two nodes", NgException),
    ("whole.NodeBlocks([[0, whole.height]])", "is not there", NgException),
    ("MergeMatrices(mat, [None], np.ones(mat.height))", "must be sparse", NgException),
    (
        "press3d().solver(preconditioner=identity).Solve()",
        "not an operator of the size",
        ValueError,
    ),
]


@calls(REFUSED)
def test_refused(row):
    problem = press()
    given, _ = system(problem)
    whole = OrthogonalCondensation(*given)
    stars = problem.contact.form.fes.CreateSmoothingBlocks(blocktype=["vertexedge"])
    parts = {
        "whole": whole,
        "other": OrthogonalCondensation(*system(press(h=0.4))[0]),
        "stars": stars,
        "sweeps": StarSweeps(whole, whole.freedofs, stars, 1),
        "part": whole.Part(whole.freedofs),
        "inner": int(np.flatnonzero(AsNumPy(whole.freedofs))[0]),
    }
    names = zip(("mat", "multipliers", "dim", "free"), given, strict=True)
    check_refused(row, **(vars(_ngslac) | globals() | dict(names) | parts))
