"""A stiff body moved far by small forces, on a soft one: rounding errors are no singular matrix."""

import numpy as np
import pytest
from ngsolve import CF, InnerProduct, VectorH1, ds
from posed import elastic, posed
from press import solved
from problems.press import two_blocks

TRACTION = (5, 2, -25)


def pressed(ratio, solver, **law):
    """The solver after pressing the upper block, so many times stiffer, on the lower one."""
    mesh = two_blocks(3)
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    young = mesh.MaterialCF({"upper": 1e3 * ratio, "lower": 1e3})
    problem = posed(
        V, elastic(young, 0.3), lambda u, v, load: -InnerProduct(CF(TRACTION), v) * ds("top"), **law
    )
    return solved(problem, solver=solver), problem.contact


@pytest.mark.parametrize("solver", [None, "iterative", "direct"])
@pytest.mark.parametrize("ratio", [1e3, 1e5, 1e6])
def test_a_tie_is_one_linear_system(solver, ratio):
    made, contact = pressed(ratio, solver, tied=True)
    assert len(made.history) <= 3
    np.testing.assert_allclose(-np.array(contact.Force()), TRACTION, rtol=1e-13 * ratio)


@pytest.mark.parametrize("solver", [None, "iterative"])
def test_friction_takes_few_iterations(solver):
    made, contact = pressed(1e6, solver, friction=0.3)
    assert len(made.history) <= 10
    assert made.linear.method == (solver or "interface")
    np.testing.assert_allclose(-np.array(contact.Force()), TRACTION, rtol=1e-13 * 1e6)
