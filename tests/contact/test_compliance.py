"""Where the slave cannot follow the multiplier is elastic: matrices against differences."""

import numpy as np
import pytest
from ngsolve import CF, GridFunction, VectorH1, x, y

from ngslac import LACContact, LACSpace
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D


def Residual(contact, gf):
    out = gf.vec.CreateVector()
    contact.Apply(gf.vec, out)
    return out.FV().NumPy().copy()


def Random(gf, seed):
    values = np.random.default_rng(seed).standard_normal(gf.vec.FV().NumPy().size)
    vec = gf.vec.CreateVector()
    vec.FV().NumPy()[:] = values
    return vec


@pytest.mark.pairwise
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("friction", [0.05, 2.0], ids=["slip", "stick"])
@pytest.mark.parametrize("dim", [2, 3])
def test_derivative(dim, friction, finite):
    """One component is prescribed on a slave whose normal is no axis."""
    mesh = TwoBlocks(0.3, 0.4) if dim == 2 else TwoBlocks3D("tet", n_slave=2, n_master=3)
    V = VectorH1(mesh, order=2 if dim == 2 else 3, dirichlet="bottom", dirichletx="slave")
    X = V * LACSpace(V, slave="slave")
    (u, lam), _ = X.TnT()
    contact, gf = LACContact(u, lam, master="master", friction=friction, finite=finite), None
    gf = GridFunction(X)
    turned = [0.3 * x + 0.01 * y, 0.25 * x - 0.05 * y, 0.1 * x][:dim]
    gf.components[0].Set(CF((*turned[:-1], turned[1])))  # all of it is inclined
    contact.form.Update(gf)
    contact.form.SetConstant(3.0)
    normals = contact.Table()["normal"]
    assert np.all(contact.form.Scalars("prescribed") == 1)
    if finite:
        assert np.all(np.abs(normals[:, 0]) > 0.05)
    random = Random(gf, 1).FV().NumPy()
    gf.components[1].vec.FV().NumPy()[:] = (
        -normals * 0.7 + 0.2 * random[: normals.size].reshape(normals.shape)
    ).ravel()
    gf.vec.data += 1e-3 * Random(gf, 2)
    contact.AssembleLinearization(gf.vec)
    direction, change = Random(gf, 3), gf.vec.CreateVector()
    change.data = contact.mat * direction
    moved, step = GridFunction(X), 1e-6
    sides = []
    for sign in (1, -1):
        moved.vec.data = gf.vec + sign * step * direction
        sides.append(Residual(contact, moved))
    difference = (sides[0] - sides[1]) / (2 * step)
    exact = change.FV().NumPy()
    assert np.abs(difference - exact).max() < 1e-6 * np.abs(exact).max()
