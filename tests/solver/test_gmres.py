"""GMRES: residuals, ends, and what does not fit."""

import signal

import numpy as np
import pytest
import scipy.sparse.linalg as sla
from netgen.meshing import NgException
from ngsolve import BaseMatrix, BitArray, GetNumThreads, SetNumThreads, TaskManager
from ngsolve.la import SparseMatrixd

from ngslac._ngslac import GMRes, PreconditionedProduct
from ngslac.arrays import AsBits

N = 40


def matrix(values):
    n = len(values)
    rows, columns = np.indices(values.shape).reshape(2, -1).tolist()
    return SparseMatrixd.CreateFromCOO(rows, columns, values.ravel().tolist(), n, n)


def vector(mat, values):
    vec = mat.CreateColVector()
    vec.FV().NumPy()[:] = values
    return vec


def every(n=N):
    bits = BitArray(n)
    bits.Set()
    return bits


def given(seed=0, shift=6.0):
    random = np.random.default_rng(seed)
    values = random.standard_normal((N, N)) + shift * np.eye(N)
    return values, random.standard_normal(N)


def run(values, rhs, tol=1e-10, maxiter=100, free=None, inverse=None, **options):
    mat = matrix(values)
    given = PreconditionedProduct(mat, inverse), vector(mat, rhs), free or every(len(values))
    x, *found = GMRes(*given, tol, maxiter, **options)
    return x.FV().NumPy().copy(), *found


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("shift", [3.0, 20.0])
def test_residuals_are_those_of_scipy(seed, shift):
    values, rhs = given(seed, shift)
    theirs, size = [], np.linalg.norm(rhs)
    options = {"callback": theirs.append, "callback_type": "pr_norm", "restart": N, "maxiter": 1}
    expected, _ = sla.gmres(values, rhs, rtol=1e-10, **options)
    x, residuals, converged = run(values, rhs)
    assert converged
    assert residuals[0] == pytest.approx(size)
    assert residuals[1:] / size == pytest.approx(theirs, rel=1e-6, abs=1e-12)
    assert np.linalg.norm(values @ x - rhs) == pytest.approx(residuals[-1], rel=1e-4)
    assert x == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())


def test_basis_of_nearly_dependent_vectors():
    """A matrix near the identity: what is new in each product is rounding but for a part."""
    values, rhs = given(shift=0)
    values = np.eye(N) + 1e-7 * values
    x, residuals, converged = run(values, rhs, tol=1e-14)
    assert converged
    assert len(residuals) <= 4
    assert np.linalg.norm(values @ x - rhs) < 1e-13 * residuals[0]


def test_only_free_dofs_count():
    values, rhs = given()
    free = np.arange(N) % 3 > 0
    x, _, converged = run(values, rhs, free=AsBits(free))
    assert converged
    assert np.all(x[~free] == 0)
    part = np.linalg.solve(values[np.ix_(free, free)], rhs[free])
    assert x[free] == pytest.approx(part, abs=1e-8 * np.abs(part).max())


def test_zero_right_hand_side():
    x, residuals, converged = run(given()[0], np.zeros(N))
    assert converged
    assert (np.abs(x).max(), *residuals) == (0, 0)


def test_exact_preconditioner_takes_one_product():
    rhs = given()[1]
    x, residuals, converged = run(np.eye(N), rhs)
    assert converged
    assert len(residuals) == 2
    assert x == pytest.approx(rhs, rel=1e-14)


@pytest.mark.parametrize("rank", [1, 3])
def test_invariant_subspace_ends_the_iteration(rank):
    """With so many eigenvalues the solution is found in as many products, to rounding."""
    eigenvalues = np.resize(np.arange(1.0, 1 + rank), N)
    x, residuals, converged = run(np.diag(eigenvalues), np.ones(N), tol=0.0)
    assert len(residuals) <= rank + 2
    assert residuals[-1] < 1e-13 * residuals[0]
    assert converged == (residuals[-1] == 0)
    assert x == pytest.approx(1 / eigenvalues, rel=1e-12)


def test_singular_matrix_gives_least_squares():
    values = np.diag(np.r_[np.arange(1.0, 4), np.zeros(N - 3)])
    x, residuals, converged = run(values, np.ones(N))
    assert not converged
    assert residuals[-1] == pytest.approx(np.sqrt(N - 3))
    assert values @ x == pytest.approx(1.0 * (np.diag(values) > 0), abs=1e-10)


def test_shift_makes_no_progress_until_the_end():
    """Of the cyclic permutation, the worst case."""
    values, rhs = np.roll(np.eye(N), 1, axis=0), np.eye(N)[0]
    x, residuals, converged = run(values, rhs, maxiter=N - 1)
    assert not converged
    assert residuals == pytest.approx(np.ones(N))
    assert x == pytest.approx(np.zeros(N), abs=1e-14)
    x, residuals, converged = run(values, rhs)
    assert converged
    assert len(residuals) == N + 1
    assert values @ x == pytest.approx(rhs, abs=1e-14)


def test_most_iterations_and_patience():
    values, rhs = given(shift=3.0)
    *_, residuals, converged = run(values, rhs, maxiter=7)
    assert (len(residuals), converged) == (8, False)
    slow = np.roll(np.eye(N), 1, axis=0)
    *_, residuals, converged = run(slow, np.eye(N)[0], patience=5)
    assert (len(residuals), converged) == (6, False)
    *_, residuals, converged = run(values + 20 * np.eye(N), rhs, patience=5)
    assert converged


@pytest.mark.parametrize("wrong", ["rhs", "matrix"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_not_finite_ends_the_iteration(wrong, value):
    values, rhs = given()
    if wrong == "rhs":
        rhs[3] = value
    else:
        values[3, 4] = value
    x, residuals, converged = run(values, rhs)
    assert not converged
    assert len(residuals) == 1
    assert np.all(x == 0)


class Product(BaseMatrix):
    """In Python, as a preconditioner may be."""

    def __init__(self, values, act=lambda: None, digits=None):
        super().__init__()
        self.mat, self.act, self.digits = matrix(values), act, digits

    def Mult(self, x, y):
        self.act()
        y.data = self.mat * x
        if self.digits:
            y.FV().NumPy()[:] = np.round(y.FV().NumPy(), self.digits)

    def CreateVector(self, col):
        return self.mat.CreateColVector() if col else self.mat.CreateRowVector()

    def Height(self):
        return self.mat.height

    def Width(self):
        return self.mat.width

    def IsComplex(self):
        return False


def test_preconditioner_from_the_right():
    """The residuals of the product; a preconditioner that rounds does not limit them."""
    values, rhs = given(shift=3.0)
    pre = np.linalg.inv(values + np.diag(np.linspace(0, 5, N)))
    expected = run(values @ pre, rhs)[1]
    x, residuals, converged = run(values, rhs, inverse=matrix(pre))
    assert converged
    assert residuals == pytest.approx(expected, rel=1e-6, abs=1e-12 * residuals[0])
    assert np.linalg.norm(values @ x - rhs) <= 1.01e-10 * residuals[0]
    rounded = Product(pre, digits=3)
    x, residuals, converged = run(values, rhs, tol=1e-12, inverse=rounded)
    assert converged
    assert np.linalg.norm(values @ x - rhs) <= 1.01e-12 * residuals[0]


@pytest.mark.parametrize("threads", [1, 2])
def test_matrix_in_python(threads):
    values, rhs = given()
    mat, before = Product(values), GetNumThreads()
    try:
        SetNumThreads(threads)
        with TaskManager():
            options = vector(mat.mat, rhs), every(), 1e-10, 100
            x, residuals, converged = GMRes(PreconditionedProduct(mat), *options)
    finally:
        SetNumThreads(before)
    expected, *history = run(values, rhs)
    assert converged
    assert np.array_equal(residuals, history[0])
    assert np.array_equal(x.FV().NumPy(), expected)


def test_products_of_functions_on_parts_of_vectors():
    """Where another process has the same all sums are twice as large, and the way the same."""
    values, rhs = given(shift=3.0)

    def apply(x, z, image):
        z[:] = 0.5 * x
        image[:] = values @ z

    product = PreconditionedProduct(N, apply, lambda sums: 2 * sums)
    x, residuals, converged = GMRes(product, vector(matrix(values), rhs), every(), 1e-10, 100)
    expected, history, _ = run(values, rhs)
    assert converged
    assert residuals == pytest.approx(np.sqrt(2) * history, rel=1e-6, abs=1e-12 * history[0])
    assert x.FV().NumPy() == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())


def test_interruption():
    values, rhs = given()
    mat = Product(values, act=lambda: signal.raise_signal(signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        GMRes(PreconditionedProduct(mat), vector(mat.mat, rhs), every(), 1e-10, 100)


def test_error_in_a_matrix_in_python():
    def act():
        raise ValueError("no such product")

    values, rhs = given()
    mat = Product(values, act)
    with pytest.raises((ValueError, NgException), match="no such product"):
        GMRes(PreconditionedProduct(mat), vector(mat.mat, rhs), every(), 1e-10, 100)


@pytest.mark.parametrize(("rows", "bits"), [(N - 1, N), (N, N - 1)])
def test_sizes_must_fit(rows, bits):
    mat, other = matrix(given()[0]), matrix(np.eye(rows))
    with pytest.raises(NgException, match="differ in size"):
        GMRes(PreconditionedProduct(mat), vector(other, 1.0), every(bits), 1e-10, 100)
