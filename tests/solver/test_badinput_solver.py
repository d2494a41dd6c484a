"""Wrong input to ContactSolver and FormSum."""

import numpy as np
import pytest
from ngsolve import BilinearForm, GridFunction, InnerProduct, ds, dx
from press import linear, numpy, press

from ngslac import ContactSolver, FormSum


def raises(text, kind=ValueError):
    return pytest.raises(kind, match=text)


def test_spaces_that_do_not_match():
    problem, other = press(), press()
    text = "a, gf and the contacts must live on the same product space"
    with raises(text):
        ContactSolver(problem.a, problem.gf, other.contact)
    wrong = GridFunction(problem.X.components[0])
    with raises(f"gf lives on another space than u and lam, with {wrong.space.ndof} dofs"):
        ContactSolver(problem.a, wrong, problem.contact)
    with raises("gf lives on another space"):
        ContactSolver(other.a, problem.gf, [problem.contact])
    with raises(r"contacts = \[\] is empty: give at least one LACContact"):
        ContactSolver(problem.a, problem.gf, [])


def test_nan_in_the_start_value():
    problem = press()
    problem.gf.vec.FV().NumPy()[3] = np.nan
    with raises("the start value gf holds NaN"):
        problem.solver()


@pytest.mark.parametrize(
    ("flags", "text"),
    [
        ({"tol": 0}, "tol = 0 must be a number > 0 and < 1"),
        ({"tol": -1e-8}, "tol = -1e-08 must be"),
        ({"tol": float("nan")}, "tol = nan must be"),
        ({"tol": float("inf")}, "tol = inf must be"),
        ({"tol": 1.0}, "tol = 1.0 must be"),
        ({"maxit": 0}, "maxit = 0 must be a whole number, at least 1"),
    ],
)
def test_tolerance_and_number_of_iterations(flags, text):
    with raises(text):
        press().solver().Solve(printing=False, **flags)


def test_initial():
    with raises("initial = 'all' must be one of 'gap', 'none'"):
        press().solver(initial="all")


@pytest.mark.parametrize("inverse", ["nosuchsolver", "mumps"])
def test_solvers_that_do_not_exist(inverse):
    problem = press()
    with raises(f"inverse='{inverse}' is not available"):
        problem.solver(inverse=inverse).Solve(printing=False)


def test_symmetric_storage():
    problem = press()
    (u, _), (v, _) = problem.X.TnT()
    a = BilinearForm(problem.X, symmetric_storage=True)
    a += linear(u, v)
    with raises("symmetric_storage=True: it keeps one triangle only.*without"):
        ContactSolver(a, problem.gf, problem.contact).Solve(printing=False)
    with raises("symmetric_storage=True"):
        FormSum(a, problem.contact)


def test_a_load_of_the_wrong_size():
    problem = press()
    wrong = GridFunction(problem.X.components[0]).vec
    with raises("rhs", Exception):
        problem.solver(rhs=wrong).Solve(printing=False)


def test_a_load_with_nan():
    problem = press()
    load = problem.gf.vec.CreateVector()
    load[:] = 0
    load.FV().NumPy()[10] = np.nan
    with raises("NaN", Exception):
        problem.solver(rhs=load).Solve(printing=False)
    assert not np.any(numpy(problem.gf))


def test_a_bulk_without_stiffness():
    """Bodies of nothing: no result."""
    problem = press()
    (u, _), (v, _) = problem.X.TnT()
    a = BilinearForm(problem.X, check_unused=False)
    a += 0 * InnerProduct(u, v) * dx - v[1] * ds("top")
    with raises("a, the bulk form, has no stiffness: add that of the bodies"):
        ContactSolver(a, problem.gf, problem.contact).Solve(printing=False)
    assert not np.any(numpy(problem.gf))
