"""Systems of one bulk, solved on the interface: the same solution, with one factorisation."""

import numpy as np
import pytest
from netgen.meshing import NgException
from ngsolve import Grad, dx
from press import linear, mixed_press, press, same, solved
from scipy.sparse import csc_matrix, random

from ngslac._ngslac import EquilibrationScale, MergeMatrices, SchurComplement
from ngslac.arrays import AddToDiagonal, AsBits, ToCSR
from ngslac.bodies.rigidmotions import MotionsOf
from ngslac.linear.factor import Factor
from ngslac.linear.grounded import Grounded


def seen(problem, **flags):
    """The solver of a problem, and the iterations of three steps of its load."""
    solver, iterations = problem.solver(**flags), []
    for load in (0.4, 0.7, 1.0):
        problem.load.Set(load)
        iterations.append(solver.Solve(printing=False).number)
    return solver, iterations


@pytest.mark.parametrize("dim", [2, 3])
def test_steps_share_a_factorisation(dim):
    """And each of them takes one system: the status is found on the surfaces."""
    reference, problem = (mixed_press(dim=dim, n=(3, 2)) for _ in range(2))
    seen(reference, solver="direct")
    solver, iterations = seen(problem)
    assert solver.linear.method == "interface"
    assert solver.linear.factorisations == 1
    assert iterations == [1, 1, 1]
    same(problem, reference, 1e-11)


@pytest.mark.usefixtures("whole_systems")
def test_a_nonlinear_bulk_is_solved_as_before():
    """Its first matrix apart, before it is known to be nonlinear."""
    problem, reference = mixed_press(nonlinear=True), mixed_press(nonlinear=True)
    solver = solved(problem)
    expected = solved(reference, solver="direct")
    interface, direct = (link.method for link in solver.linear._links)
    assert interface.factorisations == 1
    assert direct.factorisations == expected.linear.factorisations - 1 > 0
    same(problem, reference)


def test_next_method_takes_over(monkeypatch):
    """Also where the interface fails each time: it is not tried with the same matrix again."""
    problem, reference = mixed_press(), mixed_press()
    calls = []

    def fail(*given):
        calls.append(given)
        raise NgException("SchurComplement: the interface is too large")

    monkeypatch.setattr("ngslac.linear.grounded.SchurComplement", fail)
    solver = solved(problem)
    assert len(calls) <= 2 < len(solver.history)  # the bulk is assembled twice
    solved(reference, solver="direct")
    same(problem, reference)


def test_large_interfaces_are_solved_as_before(monkeypatch):
    """A dense matrix of so many multipliers is not even tried."""
    monkeypatch.setattr("ngslac.linear.interface.Interface.most", 3)
    problem, reference = mixed_press(), mixed_press()
    interface, direct = (link.method for link in solved(problem).linear._links)
    expected = solved(reference, solver="direct").linear.factorisations
    assert (interface.factorisations, direct.factorisations) == (0, expected)
    same(problem, reference, 1e-12)


def test_unsymmetric_bulk_is_solved_as_before():
    def bulk(u, v, _):
        return [linear(u, v), 5 * Grad(u)[0, 1] * v[0] * dx]

    problem, reference = mixed_press(bulk=bulk), mixed_press(bulk=bulk)
    assert solved(problem).linear.factorisations > 1
    solved(reference, solver="direct")
    same(problem, reference)


@pytest.mark.parametrize("dim", [2, 3])
def test_grounded(dim):
    """As many springs on each body as it has rigid motions, and no more; far from each other."""
    problem = press(dim=dim, flags={"dirichlet": ""}, spring=0)
    problem.contact.Update()
    problem.a.AssembleLinearization(problem.gf.vec)
    free = problem.solver().linear.free.copy()
    free[problem.contact.form.MultiplierDofs()] = False
    scale = EquilibrationScale(problem.a.mat, [problem.contact.form])
    mat = MergeMatrices(problem.a.mat, [], scale)
    chosen = Grounded(mat, free, MotionsOf(problem.contact))
    assert len(chosen) == 2 * (3 if dim == 2 else 6)
    AddToDiagonal(mat, np.isin(np.arange(len(free)), chosen).astype(float))
    values = np.linalg.eigvalsh(ToCSR(mat).toarray()[np.ix_(free, free)])
    assert values[0] > 1e-6 * values[-1]


# --- the Schur complement ------------------------------------------------------------------------


def factored():
    """A matrix, its free dofs, its factors, random columns on these, and the same dense."""
    problem = press()
    problem.contact.Update()
    problem.a.AssembleLinearization(problem.gf.vec)
    bits = problem.solver().linear.free.copy()
    bits[problem.contact.form.MultiplierDofs()] = False
    mat = MergeMatrices(problem.a.mat, [], np.ones(len(bits)))
    columns = csc_matrix(random(len(bits), 7, 0.01, random_state=3).multiply(bits[:, None]))
    columns.eliminate_zeros()
    inverse = Factor(mat, AsBits(bits), "sparsecholesky")
    return mat, bits, inverse, columns, ToCSR(mat).toarray()[np.ix_(bits, bits)]


def test_schur_complement():
    _, bits, inverse, columns, matrix = factored()
    schur = SchurComplement(inverse, columns.indptr, columns.indices, columns.data)
    given, rhs = columns.toarray()[bits], np.random.default_rng(1).standard_normal(len(bits))
    expected = given.T @ np.linalg.solve(matrix, given)
    assert schur.complement == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())
    start, x = schur.Forward(rhs), np.arange(7.0)
    expected = given.T @ np.linalg.solve(matrix, rhs[bits])
    assert schur.Trace(start) == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())
    expected = np.linalg.solve(matrix, rhs[bits] - given @ x)
    found = schur.Solve(start, x)
    assert found[bits] == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())
    assert not np.any(found[~bits])


REFUSED = [
    ("SchurComplement(mat, *given)", "must be a real scalar 'sparsecholesky'"),
    ("SchurComplement(inverse, [0, 1], [10**6], [1.0])", "no sparse columns"),
    ("SchurComplement(inverse, [0, 1], [-1], [1.0])", "no sparse columns"),
    ("SchurComplement(inverse, [0, 2], [0], [1.0])", "no sparse columns"),
    ("SchurComplement(inverse, [1, 0], [0], [1.0])", "no sparse columns"),
    ("SchurComplement(inverse, [], [], [])", "no sparse columns"),
    ("SchurComplement(inverse, [0, 1], [held], [1.0])", "where nothing is free"),
    ("schur.Forward([1.0])", "a vector has 1 entries, not "),
    ("schur.Trace([1.0])", "a vector has 1 entries, not "),
    ("schur.Solve([1.0], [1.0])", "a vector has 1 entries, not "),
]


@pytest.mark.parametrize(("call", "words"), REFUSED)
def test_refused(call, words):
    mat, bits, inverse, columns, _ = factored()
    given = columns.indptr, columns.indices, columns.data
    names = {"mat": mat, "inverse": inverse, "given": given, "held": np.flatnonzero(~bits)[0]}
    names |= {"SchurComplement": SchurComplement, "schur": SchurComplement(inverse, *given)}
    with pytest.raises(NgException, match=words):
        eval(call, names)


def test_a_dense_part_larger_than_the_factors_is_refused():
    _, bits, inverse, _, _ = factored()
    many = np.resize(np.flatnonzero(bits), 1001)
    with pytest.raises(NgException, match="the interface is too large"):
        SchurComplement(inverse, np.arange(1002), many, np.ones(1001))
