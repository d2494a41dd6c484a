"""Any order, tiny tractions, bodies far from the origin: nothing has a fixed size."""

import numpy as np
import pytest
from blocks import block_mesh, contact_form, random_state, residual, vector
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, VectorH1, dx
from sheets import grid, lower, sheet_mesh, upper

from ngslac import LACContact, LACSpace
from ngslac._ngslac import MergeMatrices
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D

sliding = pytest.mark.parametrize("finite", [False, True])


@sliding
@pytest.mark.parametrize(("dim", "order"), [(2, 16), (3, 10)])
def test_high_order(dim, order, finite):
    mesh = TwoBlocks(0.5, 0.4) if dim == 2 else TwoBlocks3D("hex", n_slave=1, n_master=2)
    V = VectorH1(mesh, order=order)
    u, lam = (V * LACSpace(V, slave="slave")).TrialFunction()
    contact = LACContact(u, lam, master="master", finite=finite)
    contact.Update()
    table = contact.Table()
    np.testing.assert_allclose(table["area"], table["fullarea"], rtol=1e-8)


@sliding
def test_tractions_whose_squares_are_zero(finite):
    contact = contact_form(block_mesh(2), friction=0.2, finite=finite)
    gf, out = GridFunction(contact.form.fes), vector(contact)
    gf.components[1].vec[:] = -1e-170
    contact.form.AssembleStep(gf.vec, out)
    assert np.any(out.FV().NumPy()[: gf.components[0].space.ndof])
    assert np.isfinite(np.asarray(contact.mat.CSR()[0])).all()


@sliding
@pytest.mark.parametrize(("excess", "counts"), [(1e-8, False), (1e-5, True)])
def test_slivers_of_an_overlap_do_not_count(excess, counts, finite):
    """The master ends a little beyond the third of five slave edges."""
    master = lower(grid("edge", 4, ((0, 0), (0.6 + excess, 1))))
    table = contact_form(sheet_mesh(upper(grid("edge", 5)), master), finite=finite).Table()
    overlaps = np.sort(table["area"][table["area"] > 0])
    assert len(overlaps) == 3 + counts
    assert not counts or overlaps[0] == pytest.approx(excess, rel=1e-6)


def far_away(at, finite):
    """A contact translated by `at`, in a motion, and its residual."""
    mesh = block_mesh(2, 0.25, angle=0.0, overhang=0.0)
    for vertex in mesh.ngmesh.Points():
        vertex[0] += at
    contact = contact_form(mesh, finite=finite, friction=0.3)
    state = 1e-6 * random_state(contact)
    contact.form.Evaluate(vector(contact, state))
    return contact, residual(contact, state)


@sliding
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
    u, v = VectorH1(TwoBlocks(0.5, 0.4), order=1).TnT()
    mat = BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx).Assemble().mat
    scale, x = np.linspace(1, 2, mat.height), mat.CreateColVector()
    x.FV().NumPy()[:] = np.cos(np.arange(mat.height))
    y, z = ((MergeMatrices(mat, [], values) * x).Evaluate().FV().NumPy().copy()
            for values in (scale, np.repeat(scale, 2)[::2]))  # fmt: skip
    assert np.array_equal(y, z)
    with pytest.raises(Exception, match="scale has 3 entries, but the matrix has"):
        MergeMatrices(mat, [], np.ones(3))


@sliding
@pytest.mark.parametrize("name", ["AddApply", "AssembleStep"])
def test_vectors_of_another_size_are_refused(name, finite):
    form = contact_form(block_mesh(2), friction=0.2, finite=finite).form
    x, short = (GridFunction(space).vec for space in (form.fes, form.component))
    for given in ((x, short), (short, x)):
        with pytest.raises(Exception, match="entries, but the pairing was made"):
            getattr(form, name)(*given)
