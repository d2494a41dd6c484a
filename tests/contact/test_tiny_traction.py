"""Tractions so small that their squares are zero are tractions all the same."""

import numpy as np
import pytest
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, VectorH1, dx

from ngslac import LACContact, LACSpace
from ngslac.meshes import TwoBlocks


@pytest.mark.parametrize("finite", [False, True])
def test_matrix_of_tiny_tractions(finite):
    space = VectorH1(TwoBlocks(0.4, 0.5), order=2, dirichlet="bottom|top")
    fes = space * LACSpace(space, slave="slave")
    (u, lam), (v, _) = fes.TnT()
    a = BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx).Assemble()
    contact, gf = (
        LACContact(u, lam, master="master", friction=0.2, finite=finite),
        GridFunction(fes),
    )
    contact.Prepare(a.mat)
    gf.components[1].vec[:] = -1e-170
    residual = gf.vec.CreateVector()
    residual[:] = 0
    contact.form.AssembleStep(gf.vec, residual)
    assert np.any(residual.FV().NumPy()[: space.ndof])
    assert np.isfinite(np.asarray(contact.mat.CSR()[0])).all()
