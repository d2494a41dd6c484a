"""The operators D and M: integrals of basis functions of both sides over macro-elements."""

import numpy as np
import pytest
from circles import disc_in_ring
from ngsolve import BND, CF, GridFunction, Integrate, specialcf, x, y
from numpy.polynomial import Polynomial
from strips import Strip, contact_on, moved, on_line, strip_mesh

rng = np.random.default_rng(2)
SLAVE = np.sort(np.concatenate([[0, 1], rng.uniform(0, 1, 6)]))
MASTER = np.sort(np.concatenate([[-0.1, 0.83], rng.uniform(-0.1, 0.83, 8)]))


def two_strips(y0=0.0, master=MASTER, **motion):
    upper = Strip("upper", on_line(SLAVE, y0), (0, 0.5), "slave")
    lower = Strip("lower", on_line(master), (0, -0.5), "master")
    return strip_mesh(upper, lower, **motion)


def dense(operator):
    return operator.ToDense().NumPy()


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_partition_of_unity(order, angle):
    """Constants: D c = M c = paired areas times c, row by row."""
    contact = contact_on(two_strips(0.02, angle=angle), order=order)
    D, M = (dense(op) for op in contact.Mortar())
    V = contact.form.component
    assert D.shape == M.shape == (2 * contact.space.nmacros, V.ndof)
    gf = GridFunction(V)
    gf.Set(CF((2.0, -3.0)))
    values = gf.vec.FV().NumPy()
    expected = np.outer(contact.Table()["area"], [2.0, -3.0]).ravel()
    assert D @ values == pytest.approx(expected, abs=1e-13)
    assert M @ values == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize(("slave", "master"), [("disc", "ring"), ("ring", "disc")])
def test_partition_of_unity_on_curved_surfaces(order, slave, master):
    mesh = disc_in_ring(order=order)
    contact = contact_on(mesh, slave=slave, master=master, order=order)
    D, M = (dense(op) for op in contact.Mortar())
    gf = GridFunction(contact.form.component)
    gf.Set(CF((1.0, 1.0)))
    expected = np.repeat(contact.Table()["area"], 2)
    assert D @ gf.vec.FV().NumPy() == pytest.approx(expected, rel=1e-12)
    assert M @ gf.vec.FV().NumPy() == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("angle", [0.0, 2.1])
@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
def test_exact_for_polynomials_of_the_order_of_the_trace(order, angle):
    """Different polynomials on both sides, integrated by hand over the overlap of each macro."""
    mesh = two_strips(angle=angle)
    contact = contact_on(mesh, order=order)
    D, M = (dense(op) for op in contact.Mortar())
    c, s = np.cos(angle), np.sin(angle)
    along = c * x + s * y  # coordinate along the surface
    coefficients = np.random.default_rng(order).normal(size=(2, 2, order + 1))
    fields = {
        body: CF(tuple(sum(a * along**k for k, a in enumerate(row)) for row in rows))
        for body, rows in zip(("upper", "lower"), coefficients, strict=True)
    }
    gf = GridFunction(contact.form.component)
    gf.Set(mesh.MaterialCF(fields))
    values = gf.vec.FV().NumPy()
    macros = np.array(contact.space.macros)
    macros = macros[macros >= 0]
    for operator, rows in zip((D, M), coefficients, strict=True):
        expected = np.zeros((contact.space.nmacros, 2))
        for k, row in enumerate(rows):
            primitive = Polynomial(row).integ()
            ends = np.clip(SLAVE, MASTER[0], MASTER[-1])
            np.add.at(expected[:, k], macros, np.diff(primitive(ends)))
        assert operator @ values == pytest.approx(expected.ravel(), abs=2e-13)


def test_slave_operator_is_the_surface_integral():
    """D against NGSolve's own integration, on a curved surface that pairs completely."""
    mesh = disc_in_ring(order=3)
    contact = contact_on(mesh, slave="disc", master="ring", order=3)
    D, _ = contact.Mortar()
    gf = GridFunction(contact.form.component)
    gf.Set(CF((x * x - y, x * y * y)))
    mine = (dense(D) @ gf.vec.FV().NumPy()).reshape(-1, 2)
    disc = mesh.Boundaries("disc")
    by_face = np.stack(
        [Integrate(g, disc, BND, element_wise=True, order=16).NumPy() for g in (gf[0], gf[1])],
        axis=1,
    )
    for face, macro in enumerate(contact.space.macros):
        if macro >= 0:
            assert mine[macro] == pytest.approx(by_face[face], abs=1e-10)


def test_overhanging_faces_have_empty_rows():
    contact = contact_on(two_strips(master=0.5 * MASTER))
    D, M = (dense(op) for op in contact.Mortar())
    area = np.repeat(contact.Table()["area"], 2)
    assert np.any(area == 0)
    assert not np.any(D[area == 0])
    assert not np.any(M[area == 0])
    assert np.all(np.abs(D[area > 0]).sum(axis=1) > 0)


def test_columns_belong_to_the_right_side():
    mesh = two_strips()
    contact = contact_on(mesh)
    V = contact.form.component
    for operator, face in zip(contact.Mortar(), ("slave", "master"), strict=True):
        used = np.any(dense(operator) != 0, axis=0)
        allowed = np.array([bool(b) for b in V.GetDofs(mesh.Boundaries(face))])
        assert not np.any(used & ~allowed)
        assert np.any(used)


def test_rotation_rotates_and_scaling_scales():
    """D and M act componentwise, so that the same numbers appear in every frame and unit."""
    reference = [dense(op) for op in contact_on(two_strips(0.01)).Mortar()]
    there = contact_on(two_strips(0.01, angle=0.6457718232379019, scale=1e-3, shift=(5, 7)))
    for a, b in zip(reference, there.Mortar(), strict=True):
        assert 1e3 * dense(b) == pytest.approx(a, abs=1e-10)
    normal = moved([[0.0, -1.0]], 0.6457718232379019)
    assert there.Table()["normal"] == pytest.approx(np.tile(normal, (7, 1)), abs=1e-10)


def test_quadrature_follows_the_mesh_order_on_both_sides():
    """u.n over the paired parts of a curved slave: divergence of the disc, by both operators."""
    mesh = disc_in_ring(order=4, n_inner=24, n_outer=33)
    contact = contact_on(mesh, slave="disc", master="ring", order=2)
    D, _ = contact.Mortar()
    gf = GridFunction(contact.form.component)
    gf.Set(CF((x, y)))
    jumps = (dense(D) @ gf.vec.FV().NumPy()).reshape(-1, 2)
    normal = contact.Table()["normal"]
    flux = np.sum(jumps * normal, axis=1).sum()
    n = specialcf.normal(2)
    exact = Integrate(gf * n, mesh.Boundaries("disc"), BND, order=12)
    assert flux == pytest.approx(exact, rel=5e-3)  # mean normal of a face against its normals
