"""Singular systems: an error, and nothing on the screen from the libraries below."""

import os
import subprocess
import sys

import numpy as np
import pytest
from ngsolve import Grad, InnerProduct, VectorH1, ds, dx
from ngsolve.la import SparseMatrixd
from posed import posed
from press import press, two_blocks

from ngslac import ContactConvergenceError, ContactSolver
from ngslac.errors import LinearSolveError
from ngslac.linear.factor import Factor
from ngslac.linear.quiet import Quiet

SINGULAR = [
    [1.0, 1.0, 1.0, 1.0],
    [0.0, 0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0, 0.0],
    [np.nan, 1.0, 1.0, 1.0],
    [1e-320, 0.0, 0.0, 1e-320],
]


def two(values):
    return SparseMatrixd.CreateFromCOO([0, 0, 1, 1], [0, 1, 0, 1], values, 2, 2)


@pytest.mark.parametrize("values", SINGULAR)
def test_a_singular_matrix_is_an_error_and_nothing_else(values, capfd):
    for _ in range(3):
        with pytest.raises(LinearSolveError, match="umfpack"):
            Factor(two(values), None, "umfpack")
    assert capfd.readouterr() == ("", "")


def test_a_regular_matrix():
    factors = Factor(two([2.0, 1.0, 0.0, 4.0]), None, "umfpack")
    x = factors.CreateRowVector()
    x.FV().NumPy()[:] = 4.0, 8.0
    assert list((factors * x).Evaluate()) == pytest.approx([1.0, 2.0])


@pytest.mark.parametrize("solver", ["interface", "direct", "iterative"])
def test_a_mechanism_in_the_bulk(solver, capfd):
    """No stiffness against shear: no linear system has a solution."""
    mesh = two_blocks(2, h=0.5)
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    stiff = mesh.MaterialCF({"upper": 0.0, "lower": 1.0})

    def bulk(u, v, load):
        loads = u[1] * v[1] * dx + v[1] * ds("top") + v[0] * ds("top")
        return stiff * InnerProduct(Grad(u), Grad(v)) * dx + loads

    made = posed(V, bulk).solver(solver=solver)
    with pytest.raises((ContactConvergenceError, ValueError)):
        made.Solve(printing=False)
    assert capfd.readouterr() == ("", "")


def test_what_is_printed_inside_and_outside(capfd):
    os.write(1, b"before\n")
    with Quiet() as quiet:
        os.write(1, b"inside\n")
        os.write(2, b"below\n")
    os.write(1, b"after\n")
    assert capfd.readouterr() == ("before\nafter\n", "")
    assert quiet.text == "inside\nbelow\n"


def test_an_error_inside(capfd):
    with pytest.raises(ValueError, match="as it was"), Quiet():
        raise ValueError("as it was")
    print("after")
    assert capfd.readouterr().out == "after\n"


def test_without_streams():
    code = "import os\nfrom ngslac.linear.quiet import Quiet\nos.close(1), os.close(2)\n"
    code += "with Quiet(): pass\nos._exit(7)"
    assert subprocess.run([sys.executable, "-c", code], check=False, timeout=120).returncode == 7


def test_solved_all_the_same():
    problem = press(h=0.5)
    ContactSolver(problem.a, problem.gf, problem.contact, inverse="umfpack").Solve(printing=False)
    assert problem.contact.Force()[1] > 0
