"""Where the slave cannot follow the multiplier is elastic: matrices against differences."""

import numpy as np
import pytest
from blocks import C, residual, vector, with_traction
from ngsolve import CF, GridFunction, VectorH1, x, y

from ngslac import LACContact, LACSpace
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D


@pytest.mark.pairwise
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("friction", [0.05, 2.0], ids=["slip", "stick"])
@pytest.mark.parametrize("dim", [2, 3])
def test_derivative(dim, friction, finite):
    """One component is prescribed on a slave whose normal is no axis."""
    mesh = TwoBlocks(0.3, 0.4) if dim == 2 else TwoBlocks3D("tet", n_slave=2, n_master=3)
    V = VectorH1(mesh, order=2 if dim == 2 else 3, dirichlet="bottom", dirichletx="slave")
    X = V * LACSpace(V, slave="slave")
    contact = LACContact(*X.TrialFunction(), master="master", friction=friction, finite=finite)
    gf = GridFunction(X)
    turned = [0.3 * x + 0.01 * y, 0.25 * x - 0.05 * y, 0.1 * x][:dim]
    gf.components[0].Set(CF((*turned[:-1], turned[1])))  # all of it is inclined
    contact.form.Update(gf)
    contact.form.SetConstant(C)
    normals = contact.Table()["normal"]
    assert np.all(contact.form.Scalars("prescribed") == 1)
    if finite:
        assert np.all(np.abs(normals[:, 0]) > 0.05)
    random, noise, d = np.random.default_rng(1).normal(size=(3, contact.nscalars))
    shear = random[: normals.size].reshape(normals.shape)
    with_traction(contact, gf, -0.7 * normals + 0.2 * shear)
    state = gf.vec.FV().NumPy() + 1e-3 * noise
    contact.AssembleLinearization(vector(contact, state))
    exact = (contact.mat * vector(contact, d)).Evaluate().FV().NumPy()
    step = 1e-6
    difference = residual(contact, state + step * d) - residual(contact, state - step * d)
    assert np.abs(difference / (2 * step) - exact).max() < 1e-6 * np.abs(exact).max()
