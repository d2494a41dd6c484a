"""The operators D and M: integrals of basis functions of both sides over macro-elements."""

import numpy as np
import pytest
from curved import spheres
from ngsolve import BND, CF, GridFunction, Integrate, VectorH1, specialcf, x, y, z
from sheets import (
    PAIRS,
    SHIFTED,
    WIDER,
    Motion,
    contact_on,
    dimension,
    faces_of,
    flat,
    flat_box,
    sheet_mesh,
    two_sheets,
)

from ngslac import LACContact, LACSpace


def two(kinds, box=WIDER, gap=0.0, n=(3, 3), **flags):
    return sheet_mesh(*two_sheets(np.random.default_rng(1), kinds, box, gap, n=n), **flags)


def product(operator, gf):
    """Rows of an operator times a displacement, (n, dim)."""
    values = (operator * gf.vec).Evaluate().FV().NumPy()
    return values.reshape(-1, gf.space.mesh.dim).copy()


def dense(operator):
    return operator.ToDense().NumPy()


def monomials(order, frame):
    """All products of powers of coordinates in the interface of total degree `order`."""
    a, *b = (sum(float(c) * v for c, v in zip(axis, (x, y, z), strict=False))
             for axis in frame.T[:-1])  # fmt: skip
    return [a**i * b[0] ** (order - i) for i in range(order + 1)] if b else [a**order]


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
@pytest.mark.parametrize("order", [1, 2, 3])
def test_polynomials_do_not_jump(kinds, order):
    """A polynomial of the order of the space is the same on both sides: D u = M u, mean by mean."""
    motion = Motion(dimension(kinds), 3)
    contact = contact_on(two(kinds, motion=motion), order=order)
    D, M = contact.Mortar()
    gf = GridFunction(contact.form.component)
    for k, p in enumerate(monomials(order, motion.R)):
        gf.Set(CF((p, (k + 1) * p, 1 - p)[: len(motion.R)]))
        assert product(D, gf) - product(M, gf) == pytest.approx(0, abs=2e-13 * (k + 2))


def moment(shape, k):
    """The integral of x^k over a polygon: that of x^(k + 1) / (k + 1) around it along y."""
    corners = np.array(shape.exterior.coords)
    s, w = np.polynomial.legendre.leggauss(4)
    steps = np.diff(corners, axis=0)
    x = corners[:-1, :1] + np.outer(steps[:, 0], (s + 1) / 2)
    return abs(steps[:, 1] @ (x ** (k + 1) @ w) / (2 * k + 2)) if shape.area else 0.0


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("kinds", [PAIRS[0], ("trig", "trig"), ("trig", "quad"), ("quad", "trig")])
def test_exact_for_polynomials_of_the_order_of_the_space(kinds, order):
    """Different ones on both sides, against integrals over the exact overlaps."""
    d, ones = dimension(kinds), {"upper": (2, 3), "lower": (-1, 4)}
    mesh = two(kinds, ((0.2, 0.1), (0.8, 1.1)), 0.01, (2, 2))
    contact = contact_on(mesh, order=order)
    gf = GridFunction(contact.form.component)
    gf.Set(mesh.MaterialCF({k: CF((a * x**order + b * x, 1, 0)[:d]) for k, (a, b) in ones.items()}))
    overlap = flat_box(*(np.array(((0.2, 0.1), (0.8, 1.1)))[:, : d - 1]))
    macros, (numbers, corners) = np.array(contact.space.macros), faces_of(mesh, "slave")
    common = [flat(face[:, :-1]).intersection(overlap) for face in corners]
    for operator, (a, b) in zip(contact.Mortar(), ones.values(), strict=True):
        expected = np.zeros((contact.space.nmacros, d))
        for number, shape in zip(numbers, common, strict=True):
            exact = a * moment(shape, order) + b * moment(shape, 1)
            expected[macros[number], :2] += exact, shape.area
        assert product(operator, gf) == pytest.approx(expected, abs=2e-13)


@pytest.mark.parametrize("space", ["bubble", "plain"])
@pytest.mark.parametrize("kinds", [PAIRS[0], ("mixed", "mixed")])
def test_partition_of_unity(space, kinds):
    """Constants: D c = M c = paired areas times c, row by row; no other column is used."""
    d = dimension(kinds)
    mesh = two(kinds, SHIFTED, 0.02, motion=Motion(d, 2))
    if space == "bubble":
        contact = contact_on(mesh)
    else:
        V = VectorH1(mesh, order=3)
        u, lam = (V * LACSpace(V, slave="slave")).TrialFunction()
        contact = LACContact(u, lam, master="master")
        contact.Update()
    V, constant = contact.form.component, (2.0, -3.0, 0.5)[:d]
    gf = GridFunction(V)
    gf.Set(CF(constant))
    expected = np.outer(contact.Table()["area"], constant)
    for operator, face in zip(contact.Mortar(), ("slave", "master"), strict=True):
        assert operator.shape == (d * contact.space.nmacros, V.ndof)
        assert product(operator, gf) == pytest.approx(expected, abs=1e-13)
        used = np.any(dense(operator) != 0, axis=0)
        allowed = np.array([bool(b) for b in V.GetDofs(mesh.Boundaries(face))])
        assert np.any(used)
        assert not np.any(used & ~allowed)


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize(("slave", "master"), [("ball", "shell"), ("shell", "ball")])
@pytest.mark.parametrize("kind", ["edge", "trig", "quad"])
def test_partition_of_unity_on_curved_surfaces(kind, order, slave, master):
    contact = contact_on(spheres(kind, 2, 3, order, 0.1), slave=slave, master=master)
    constant = (1.0, -2.0, 3.0)[: contact.mesh.dim]
    gf = GridFunction(contact.form.component)
    gf.Set(CF(constant))
    expected = np.outer(contact.Table()["area"], constant)
    for operator in contact.Mortar():
        assert product(operator, gf) == pytest.approx(expected, abs=1e-12)


def test_slave_operator_is_the_surface_integral():
    """D against NGSolve's own integration, on a curved surface that pairs completely.

    The flux through it only up to the mean normal of a face against its normals.
    """
    mesh = spheres("edge", 3, 4, 4, 0.1)
    contact = contact_on(mesh, slave="ball", master="shell", order=3)
    D, _ = contact.Mortar()
    gf = GridFunction(contact.form.component)
    disc, macros = mesh.Boundaries("ball"), np.array(contact.space.macros)
    faces = np.flatnonzero(macros >= 0)
    for field in ((x * x - y, x * y * y), (x, y)):
        gf.Set(CF(field))
        mine = product(D, gf)[macros[faces]]
        exact = [Integrate(g, disc, BND, element_wise=True, order=16).NumPy()[faces] for g in gf]
        assert mine == pytest.approx(np.transpose(exact), abs=1e-10)
    flux = np.sum(mine * contact.Table()["normal"][macros[faces]])
    assert flux == pytest.approx(Integrate(gf * specialcf.normal(2), disc, BND), rel=5e-3)


@pytest.mark.parametrize("kinds", [PAIRS[0], ("mixed", "quad")])
def test_overhanging_faces_have_empty_rows(kinds):
    contact = contact_on(two(kinds, ((0.3, 0.3), (0.6, 0.5))))
    area = np.repeat(contact.Table()["area"], contact.mesh.dim)
    assert np.any(area == 0)
    for operator in contact.Mortar():
        rows = np.abs(dense(operator)).sum(axis=1)
        assert not np.any(rows[area == 0])
        assert np.all(rows[area > 0] > 0)


@pytest.mark.parametrize("kinds", [PAIRS[0], ("trig", "mixed")])
def test_rotation_and_scaling(kinds):
    """D and M act componentwise: the same numbers in every frame and unit."""
    d = dimension(kinds)

    def entries(*motion):
        mesh = two(kinds, SHIFTED, 0.01, motion=Motion(d, *motion))
        return [dense(op).copy() for op in contact_on(mesh, order=2).Mortar()]

    for a, b in zip(entries(), entries(6, 1e3, (5.0, 0, 0)), strict=True):
        assert b / 1e3 ** (d - 1) == pytest.approx(a, abs=1e-13)
