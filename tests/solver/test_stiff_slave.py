"""A stiff body moved far by small forces, on a soft one: rounding errors are no singular matrix."""

import numpy as np
import pytest
from ngsolve import CF, BilinearForm, Grad, GridFunction, InnerProduct, Sym, VectorH1, ds, dx
from problems.press import two_blocks

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.materials import Stress

TRACTION = (5, 2, -25)


def pressed(ratio, solver, **law):
    """The solver after pressing the upper block, so many times stiffer, on the lower one."""
    mesh = two_blocks(3)
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    fes = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    young = mesh.MaterialCF({"upper": 1e3 * ratio, "lower": 1e3})
    a = BilinearForm(fes)
    a += InnerProduct(Stress(Sym(Grad(u)), young, 0.3), Sym(Grad(v))) * dx
    a += -InnerProduct(CF(TRACTION), v) * ds("top")
    contact = LACContact(u, lam, master="master", **law)
    made = ContactSolver(a, GridFunction(fes), contact, solver=solver)
    made.Solve(printing=False)
    return made, contact


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
