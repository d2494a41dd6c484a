"""Boundary elements in mixed directions give the contact of those in one direction."""

import numpy as np
import pytest
from bricks import flipped
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, Sym, VectorH1, ds, dx

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.meshes import TwoBlocks, TwoBlocks3D


def solve(mesh, **law):
    """The upper block pressed down and pushed aside; contact table and displacement."""
    held = {"dirichletx": "top", "dirichlety": "top" * (mesh.dim > 2)}
    V = VectorH1(mesh, order=1, dirichlet="bottom", **held)
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx - 0.002 * v[0] * dx
    a += 0.02 * v[mesh.dim - 1] * ds("top")
    contact, gf = LACContact(u, lam, master="master", friction=0.3, **law), GridFunction(X)
    ContactSolver(a, gf, contact).Solve(printing=False)
    return contact.Table(), gf.components[0].vec.FV().NumPy()


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("kind", ["2D", "hex", "tet"])
def test_same_contact(kind, finite):
    """The quadrature may start at another corner: equal up to rounding."""
    mesh = TwoBlocks(0.2, 0.3) if kind == "2D" else TwoBlocks3D(kind, n_slave=4, n_master=3)
    (one, u), (other, w) = (solve(flipped(mesh, every), finite=finite) for every in (0, 2))
    assert np.sum(one["status"] > 0) > 1
    assert np.abs(u - w).max() < 1e-9 * np.abs(u).max()
    for name in ("normal", "gap", "traction", "area"):
        np.testing.assert_allclose(other[name], one[name], rtol=0, atol=1e-9, err_msg=name)
