"""The condensed system has the solution of the whole one and the condition of the bulk."""

from dataclasses import replace

import numpy as np
import pytest
from netgen.meshing import NgException
from ngsolve import (
    GetNumThreads,
    IdentityMatrix,
    Projector,
    SetNumThreads,
    TaskManager,
)
from ngsolve.la import SparseMatrixd
from press import numpy, press, press3d, solved
from refused import calls, check_refused

from ngslac import _ngslac
from ngslac._ngslac import (
    Condensation,
    MergeMatrices,
    StarSweeps,
    TwoLevel,
    TwoLevelProduct,
)
from ngslac.arrays import AsNumPy, Multiply, ToCSR
from ngslac.errors import LinearSolveError
from ngslac.linear.factor import LU, Cholesky, Factor, HasMKL
from ngslac.linear.iterative import SINGLE
from ngslac.linear.multigrid import Stars
from ngslac.linear.system import LinearSystem, Merged


def system(problem):
    """Arguments of the condensation of the last Newton step of a problem, and its right side."""
    solver, seen = problem.solver(solver="direct"), []
    solve = solver.linear.Solve

    def Solve(system):
        mat = MergeMatrices(system.mat, system.contacts, system.scale)
        seen.append((mat, system.scale * system.rhs * solver.linear.free))
        return solve(system)

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


def systems(problem, **changes):
    """The LinearSystem of a problem that is solved, for a random right hand side."""
    system, form = problem.made.system, problem.contact.form
    rhs = np.random.default_rng(0).standard_normal(len(system.scale)) * system.linear.free
    return replace(system.MakeLinearSystem([form.mat], rhs), **changes)


def test_wrong_solutions_are_not_taken(monkeypatch):
    """Another solver gets the system; if there is none the error tells the residuals."""
    problem = press(friction=5.0)
    problem.made = solved(problem, solver="direct")
    linear, system = problem.made.linear, systems(problem)
    direct = linear._links[0].method
    exact, factor, safe = linear.Solve(system), direct._Factors, "umfpack"

    def Wrong(system, inverse, symmetric):
        right = inverse == safe
        return factor(system, inverse, symmetric) if right else IdentityMatrix(len(system.rhs))

    direct.inverse = "wrong"
    monkeypatch.setattr(direct, "_Factors", Wrong)
    assert linear.Solve(system) == pytest.approx(exact, abs=1e-12 * np.abs(exact).max())
    assert linear.inverse == safe
    safe = None
    with pytest.raises(LinearSolveError, match=r"umfpack: relative residual [1-9]\.\de\+00"):
        linear.Solve(system)
    monkeypatch.undo()
    assert not np.any(linear.Solve(replace(system, rhs=0 * system.rhs)))


def test_the_same_matrix_is_factored_once():
    """Also the displacements alone; a shift makes another matrix."""
    problem = press(friction=5.0)
    problem.made = solved(problem, solver="direct")
    linear, system = problem.made.linear, systems(problem)
    first, before = linear.Solve(system), linear.factorisations
    assert np.array_equal(linear.Solve(system), first)
    assert linear.factorisations == before
    linear.Solve(replace(system, shift=np.ones(len(first))))
    alone = replace(system, contacts=[], alone=True)
    u = linear.Solve(alone)
    assert np.array_equal(linear.Solve(alone), u)
    assert linear.factorisations == before + 2
    left = (system.rhs - Multiply([system.mat], u)) * linear.free
    left[system.multipliers] = 0
    assert not np.any(u[system.multipliers])
    assert np.abs(system.scale * left).max() < 1e-9 * np.abs(system.scale * system.rhs).max()


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
    condensed = Condensation(*given)
    multigrid = problem.solver(solver="iterative").linear._links[0].method.multigrid
    return condensed, multigrid.Preconditioner(condensed, np.ones(condensed.height))


def random_vectors(system, number):
    """On the free dofs."""
    values = np.random.default_rng(4).standard_normal((number, system.height))
    vectors = [system.CreateRowVector() for _ in values]
    for vec, entries in zip(vectors, values * AsNumPy(system.freedofs), strict=True):
        vec.FV().NumPy()[:] = entries
    return vectors


def ErrorLeft(condensed, inverse):
    """Energy of the error that one application leaves of one, over that of this."""
    error, force = condensed.CreateRowVector(), condensed.CreateRowVector()
    error.FV().NumPy()[:] = AsNumPy(condensed.freedofs)
    force.data = Projector(condensed.freedofs, True) * (condensed * error).Evaluate()
    left = (error - inverse * force).Evaluate()
    energies = [e.InnerProduct((condensed * e).Evaluate()) for e in (left, error)]
    return energies[0] / energies[1]


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


def test_an_exact_coarse_correction_leaves_no_error():
    """Where contact is open, so that nothing but the matrix of the bulk is left."""
    problem = press3d()
    solver, vec = solved(problem, solver="direct"), problem.gf.vec
    vec.FV().NumPy()[:] *= -1  # apart
    form = problem.contact.form
    form.AssembleStep(vec, vec.CreateVector())
    mat = MergeMatrices(problem.a.mat, [form.mat], solver.system.scale)
    condensed = Condensation(mat, form.MultiplierDofs().tolist(), 3, solver.linear.bits)
    dofs = np.flatnonzero(AsNumPy(condensed.freedofs))
    part = ToCSR(condensed.Part(dofs)).tocoo()
    entries = part.row, part.col, part.data, *part.shape
    exact = SparseMatrixd.CreateFromCOO(*entries).Inverse(inverse="umfpack")
    space = problem.a.space
    sweeps = StarSweeps(condensed, condensed.freedofs, Stars(space), space.dim)
    left = ErrorLeft(condensed, TwoLevel(condensed, sweeps, exact, dofs))
    assert left < 1e-9


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
    assert error < SINGLE * expected.Norm()


def test_matrix_is_merged_in_place_where_only_contact_changes():
    """As merged anew, after each change of status; another bulk makes another matrix."""
    problem = press3d(friction=0.05)
    scale, vec = solved(problem, solver="direct").system.scale, problem.gf.vec
    form, merged, rhs = problem.contact.form, Merged(), 0 * scale
    system = LinearSystem(problem.a.mat, [form.mat], form.MultiplierDofs(), scale, rhs)
    first = merged.Of(system)
    vec.FV().NumPy()[:] = 1e-3 * np.random.default_rng(0).standard_normal(len(vec))
    form.AssembleStep(vec, vec.CreateVector())
    for changed in (replace(system, contacts=[form.mat]), replace(system, scale=2 * scale)):
        number, mat = merged.number, merged.Of(changed)
        assert merged.number == number + 1
        assert (mat is first) == (changed.scale is scale)
        new = MergeMatrices(changed.mat, changed.contacts, changed.scale)
        assert np.array_equal(dense(mat), dense(new))
        assert merged.Of(changed) is mat
        assert merged.number == number + 1
    merged.Forget()
    assert merged.Of(system) is not first


def test_what_has_not_changed_is_made_once():
    """Matrix, condensation and preconditioner; a shift on the diagonal makes others."""
    problem, made = press3d(friction=0.05), []

    def smoother(mat, freedofs):
        made.append(mat)
        return mat.CreateSmoother(freedofs)

    problem.made = solved(problem, preconditioner=smoother)
    linear, system = problem.made.linear, systems(problem, accuracy=1e-3)
    first, count = linear.Solve(system), len(made)
    assert np.array_equal(linear.Solve(system), first)
    assert len(made) == count
    shift = np.where(linear.free, 0.1, 0.0)
    shift[system.multipliers] = 0
    shifted = linear.Solve(replace(system, shift=shift))
    assert len(made) == count + 1
    assert np.abs(shifted - first).max() > 0.1 * np.abs(first).max()
    assert linear.Solve(system) == pytest.approx(first, abs=1e-12 * np.abs(first).max())
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
    (f"{WHOLE}.Part([0, 1, 0])", "dof 0 is not there, or listed twice", NgException),
    (f"{WHOLE}.Part([len(free)])", "is not there", NgException),
    (f"{WHOLE}.Part([2**31 - 1])", "is not there", NgException),
    *(
        (f"TwoLevel(whole, sweeps, {coarse}, {dofs})", message, error)
        for coarse, dofs, message, error in (
            ("part", "[inner]", "1 dofs for a coarse operator", NgException),
            ("IdentityMatrix(1)", "[-2]", "dof -2 .* is not free", NgException),
            ("IdentityMatrix(1)", "[multipliers[0]]", "is not free", NgException),
            ("IdentityMatrix(1)", "[2**31 - 1]", "is not free", NgException),
            ("None", "[inner]", "None", TypeError),
        )
    ),
    ("StarSweeps(whole, BitArray(3), stars, 1)", "3 bits for .* rows", NgException),
    ("StarSweeps(whole, free, stars, 2)", "no dof .* of a star", NgException),
    ("sweeps.Update(other)", "another size", NgException),
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
    whole = Condensation(*given)
    stars = problem.contact.form.fes.CreateSmoothingBlocks(blocktype=["vertexedge"])
    parts = {
        "whole": whole,
        "other": Condensation(*system(press(h=0.4))[0]),
        "stars": stars,
        "sweeps": StarSweeps(whole, whole.freedofs, stars, 1),
        "part": whole.Part(np.flatnonzero(AsNumPy(whole.freedofs))),
        "inner": int(np.flatnonzero(AsNumPy(whole.freedofs))[0]),
    }
    names = zip(("mat", "multipliers", "dim", "free"), given, strict=True)
    check_refused(row, **(vars(_ngslac) | globals() | dict(names) | parts))
