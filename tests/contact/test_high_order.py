"""Any order pairs: nothing has a fixed size. Arrays may have any strides."""

import numpy as np
import pytest
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, VectorH1, dx

from ngslac import LACContact, LACSpace
from ngslac._ngslac import MergeMatrices
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize(("dim", "order"), [(2, 16), (3, 10)])
def test_high_order(dim, order, finite):
    mesh = TwoBlocks(0.5, 0.4) if dim == 2 else TwoBlocks3D("hex", n_slave=1, n_master=2)
    X = VectorH1(mesh, order=order) * LACSpace(VectorH1(mesh, order=order), slave="slave")
    (u, lam), _ = X.TnT()
    contact = LACContact(u, lam, master="master", finite=finite)
    contact.Update()
    table = contact.Table()
    np.testing.assert_allclose(table["area"], table["fullarea"], rtol=1e-8)


def test_scale_of_merged_matrices():
    mesh = TwoBlocks(0.5, 0.4)
    V = VectorH1(mesh, order=1, dirichlet="bottom")
    X = V * LACSpace(VectorH1(mesh, order=2), slave="slave")
    (u, _), (v, _) = X.TnT()
    a = BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx).Assemble()
    scale = np.linspace(1, 2, X.ndof)
    x, y, z = (GridFunction(X).vec for _ in range(3))
    x.FV().NumPy()[:] = np.cos(np.arange(X.ndof))
    y.data = MergeMatrices(a.mat, [], scale) * x
    z.data = MergeMatrices(a.mat, [], np.repeat(scale, 2)[::2]) * x
    assert np.array_equal(y.FV().NumPy(), z.FV().NumPy())
    with pytest.raises(Exception, match="scale has 3 entries, but the matrix has"):
        MergeMatrices(a.mat, [], np.ones(3))
