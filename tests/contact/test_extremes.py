"""Any order, tiny tractions, bodies far from the origin: nothing has a fixed size."""

import numpy as np
import pytest
from blocks import C, vector
from netgen.occ import Compound, MoveTo, OCCGeometry, Y
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, Mesh, VectorH1, dx

from ngslac import LACContact, LACSpace
from ngslac._ngslac import MergeMatrices
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D

finite = pytest.mark.parametrize("finite", [False, True])


def contact_on(mesh, order, **flags):
    """A contact that is not paired, and an elastic bulk."""
    V = VectorH1(mesh, order=order, dirichlet="bottom|top")
    (u, lam), (v, _) = (V * LACSpace(V, slave="slave")).TnT()
    contact = LACContact(u, lam, master="master", **flags)
    return contact, lambda: BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx).Assemble().mat


@finite
@pytest.mark.parametrize(("dim", "order"), [(2, 16), (3, 10)])
def test_high_order(dim, order, finite):
    mesh = TwoBlocks(0.5, 0.4) if dim == 2 else TwoBlocks3D("hex", n_slave=1, n_master=2)
    contact, _ = contact_on(mesh, order, finite=finite)
    contact.Update()
    table = contact.Table()
    np.testing.assert_allclose(table["area"], table["fullarea"], rtol=1e-8)


@finite
def test_tractions_whose_squares_are_zero(finite):
    contact, stiffness = contact_on(TwoBlocks(0.4, 0.5), 2, friction=0.2, finite=finite)
    contact.Prepare(stiffness())
    gf, residual = GridFunction(contact.form.fes), vector(contact)
    gf.components[1].vec[:] = -1e-170
    contact.form.AssembleStep(gf.vec, residual)
    assert np.any(residual.FV().NumPy()[: gf.components[0].space.ndof])
    assert np.isfinite(np.asarray(contact.mat.CSR()[0])).all()


def far_away(at, finite):
    """Two blocks, their meshes translated by `at`, in a smooth motion; contact and its residual."""
    lower, upper = (MoveTo(0, y).Rectangle(1, 1).Face() for y in (-1, 0))
    lower.edges.Max(Y).name, upper.edges.Min(Y).name = "master", "slave"
    lower.edges.Max(Y).maxh, upper.edges.Min(Y).maxh = 0.3, 0.25
    mesh = Mesh(OCCGeometry(Compound([lower, upper]), dim=2).GenerateMesh(maxh=0.5))
    for vertex in mesh.ngmesh.Points():
        vertex[0] += at
    contact, _ = contact_on(mesh, 2, finite=finite, friction=0.3)
    contact.Update()
    contact.form.SetConstant(C)
    gf = GridFunction(contact.form.fes)
    gf.vec.FV().NumPy()[:] = 1e-6 * np.random.default_rng(0).normal(size=gf.vec.size)
    residual = gf.vec.CreateVector()
    contact.Evaluate(gf)
    contact.Apply(gf.vec, residual)
    return contact, residual.FV().NumPy()


@finite
def test_gaps_and_residuals_are_those_at_the_origin(finite):
    """A power of two leaves coordinates their digits to 1e-9: gaps of 1e-6 must not feel it."""
    (near, expected), (far, found) = (far_away(at, finite) for at in (0.0, 2.0**23))
    assert found == pytest.approx(expected, abs=1e-8 * np.abs(expected).max() + 1e-14)
    tables = near.Table(), far.Table()
    assert tables[1]["gap"] == pytest.approx(tables[0]["gap"], abs=1e-13)
    assert tables[1]["x"][:, 0] - 2.0**23 == pytest.approx(tables[0]["x"][:, 0], abs=1e-8)
    points = [contact.Segments().slave_points[..., 0] for contact in (near, far)]
    assert points[1] - 2.0**23 == pytest.approx(points[0], abs=1e-8)


def test_scales_of_merged_matrices_have_any_stride():
    _, stiffness = contact_on(TwoBlocks(0.5, 0.4), 1)
    mat = stiffness()
    scale, x = np.linspace(1, 2, mat.height), mat.CreateColVector()
    x.FV().NumPy()[:] = np.cos(np.arange(mat.height))
    y, z = ((MergeMatrices(mat, [], values) * x).Evaluate().FV().NumPy().copy()
            for values in (scale, np.repeat(scale, 2)[::2]))  # fmt: skip
    assert np.array_equal(y, z)
    with pytest.raises(Exception, match="scale has 3 entries, but the matrix has"):
        MergeMatrices(mat, [], np.ones(3))
