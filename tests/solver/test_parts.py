"""Inverse of matrices that fall into parts."""

import numpy as np
import pytest
from netgen.meshing import NgException
from scipy.sparse import block_diag, csr_matrix, diags

from ngslac.errors import LinearSolveError
from ngslac.linear import parts
from ngslac.linear.parts import AreNear, PartsInverse


def banded(n, seed=0):
    """Symmetric and positive definite, its dofs in any order."""
    random = np.random.default_rng(seed)
    off = random.uniform(-1, 1, n - 1)
    mat = diags([off, random.uniform(2.1, 3, n), off], [-1, 0, 1]).tocsr()
    order = random.permutation(n)
    return mat[order][:, order]


def expected(mat, free, rhs):
    inner = np.linalg.solve(mat.toarray()[np.ix_(free, free)], rhs[free])
    solution = np.zeros(len(rhs))
    solution[free] = inner
    return solution


@pytest.mark.parametrize("copies", [1, 3])
@pytest.mark.parametrize("fixed", [False, True])
def test_solution_and_equal_parts(copies, fixed):
    mat = block_diag([banded(30)] * copies + [banded(20, 1)]).tocsr()
    free = np.arange(mat.shape[0]) % 7 > 0 if fixed else np.ones(mat.shape[0], dtype=bool)
    inverse, rhs = PartsInverse(mat, free), np.random.default_rng(5).standard_normal(len(free))
    assert inverse.Solve(rhs) == pytest.approx(expected(mat, free, rhs), rel=1e-12, abs=1e-13)
    if not fixed:
        assert len(inverse._groups) == 2


@pytest.mark.parametrize("change", [1e-17, 1e-9])
def test_what_is_a_little_different_is_factored_apart(change):
    one, other = banded(30), banded(30)
    other.data[7] *= 1 + change
    mat, free = block_diag([one, other]).tocsr(), np.ones(60, dtype=bool)
    inverse, rhs = PartsInverse(mat, free), np.ones(60)
    assert len(inverse._groups) == (2 if change > 1e-14 else 1)
    assert inverse.Solve(rhs) == pytest.approx(expected(mat, free, rhs), rel=1e-13)


def test_many_parts_are_solved_together(monkeypatch):
    monkeypatch.setattr(parts, "MOST", 2)
    mat, free = block_diag([banded(9, k) for k in range(4)]).tocsr(), np.ones(36, dtype=bool)
    inverse, rhs = PartsInverse(mat, free), np.ones(36)
    assert len(inverse._groups) == 1
    assert inverse.Solve(rhs) == pytest.approx(expected(mat, free, rhs), rel=1e-12)


def test_dofs_that_nothing_uses_stay_zero():
    mat = block_diag([banded(10), csr_matrix((3, 3))]).tocsr()
    solution = PartsInverse(mat, np.ones(13, dtype=bool)).Solve(np.ones(13))
    assert np.all(solution[10:] == 0)
    assert mat @ solution == pytest.approx(np.r_[np.ones(10), np.zeros(3)], rel=1e-12)


def test_nothing_free():
    inverse = PartsInverse(banded(10), np.zeros(10, dtype=bool))
    assert np.all(inverse.Solve(np.ones(10)) == 0)


def test_singular_matrix():
    ones = csr_matrix(np.ones((4, 4)))
    with pytest.raises(LinearSolveError, match="singular"):
        PartsInverse(ones, np.ones(4, dtype=bool))


@pytest.mark.parametrize("copies", [1, 3])
def test_complement(copies):
    """Of rows that touch some of the parts, and dofs that are not free."""
    mat = block_diag([banded(30)] * copies + [banded(20, 1), banded(9, 2)]).tocsr()
    n = mat.shape[0]
    free, random = np.arange(n) % 7 > 0, np.random.default_rng(2)
    rows = random.standard_normal((5, n)) * (random.uniform(size=(5, n)) < 0.3)
    rows[:, -9:], rows[3], rows[4, :-10] = 0, rows[1], 0
    inner = np.linalg.inv(mat.toarray()[np.ix_(free, free)])
    complement = PartsInverse(mat, free).Complement(csr_matrix(rows))
    assert complement == pytest.approx(rows[:, free] @ inner @ rows[:, free].T, abs=1e-12)


def test_a_complement_that_is_too_large_is_not_made(monkeypatch):
    inverse = PartsInverse(banded(30), np.ones(30, dtype=bool))
    rows = csr_matrix(np.eye(30))
    assert inverse.Complement(rows) is not None
    monkeypatch.setattr(parts, "MOST_ROWS", 29)
    assert inverse.Complement(rows) is None


def test_other_places_are_other_parts():
    one, other = ([[1, 1, 0], [0, 1, 0], [0, 0, 1]], [[1, 0, 1], [0, 1, 0], [0, 0, 1]])
    assert not AreNear(csr_matrix(one), csr_matrix(other))


def test_no_complement_where_it_cannot_be_made(monkeypatch):
    def Fails(*_):
        raise NgException("no memory")

    inverse = PartsInverse(banded(10), np.ones(10, dtype=bool))
    rows = csr_matrix(np.eye(10)[:2])
    assert inverse.Complement(rows) is not None
    monkeypatch.setattr(parts, "SchurComplement", Fails)
    assert inverse.Complement(rows) is None
