"""Finite sliding: the matrix of the contact form against central differences of its residual.

Between two calls of `Follow` quadrature points and master faces stay, and so they do here. Slip
counts from a committed configuration other than the one looked at.
"""

import numpy as np
import pytest
from blocks3d import SPACES as SPACES3D
from finiteform import FiniteForm
from ngsolve import H1, VectorH1, VectorValued

from ngslac import BubbleVectorH1, LACContact, LACSpace
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D

TOL = 1e-8
LAWS = {
    "frictionless": ({}, 0.5),
    "coulomb": ({"friction": 0.7}, 0.7),
    "tresca": ({"tresca": 0.6}, 0.6),
    "coulomb and tresca": ({"friction": 0.9, "tresca": 0.6}, 0.6),
}
SPACES2D = {
    "order 1": lambda mesh: VectorH1(mesh, order=1),
    "order 2": lambda mesh: VectorH1(mesh, order=2),
    "order 3": lambda mesh: VectorH1(mesh, order=3),
    "H1(dim=2)": lambda mesh: H1(mesh, order=2, dim=2),
    "VectorValued": lambda mesh: VectorValued(H1(mesh, order=2), 2),
    "bubble": lambda mesh: BubbleVectorH1(mesh, order=1, slave="slave"),
}
SPACES = {2: SPACES2D, 3: SPACES3D}


def finite_form(mesh, space, product=None, **law):
    V = SPACES[mesh.dim][space](mesh)
    Q = LACSpace(V, slave="slave")
    X = product(V, Q) if product else V * Q
    *_, u, lam = X.TrialFunction()
    return FiniteForm(LACContact(u, lam, master="master", finite=True, **law))


def deformed(form, bound, *, degrees=50.0, size=0.05, shift=0.12, noise=0.004):
    """Committed in one configuration, moved on to another, with every status."""
    form.bend(size, 0.0, degrees=degrees - 20, noise=noise, seed=1)
    form.commit()
    form.bend(1.6 * size, shift, degrees=degrees, noise=noise, seed=2)
    form.follow()
    form.impose(bound)
    return form


def stiff_slave(form):
    """The direction of the contact is that of the slave's normals, as if its master were soft."""
    history = form.contact.form.History()
    history["share"][:] = 0.0
    form.contact.form.SetHistory(history)


def statuses(form):
    table = form.table()
    return set(table["status"][table["area"] > 0])


def check(form, law):
    flags, bound = LAWS[law]
    deformed(form, bound)
    assert statuses(form) == ({0, 1, 2} if flags else {0, 2})
    assert form.derivative_error(40 if form.dim == 2 else 6) <= TOL


def blocks2d(h=0.1, **flags):
    options = {"height": 0.5, "structured": True, "overhang": -0.2, "aligned": False}
    return TwoBlocks(h, **(options | flags))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("space", ["order 1", "order 2", "order 3"])
def test_two_dimensions(space, law):
    check(finite_form(blocks2d(), space, **LAWS[law][0]), law)


@pytest.mark.parametrize("space", ["H1(dim=2)", "VectorValued", "bubble"])
def test_other_spaces(space):
    check(finite_form(blocks2d(), space, friction=0.7), "coulomb")


def three_fields(V, Q):
    return H1(V.mesh, order=1) * V * Q


def test_displacement_is_not_the_first_component():
    check(finite_form(blocks2d(), "order 2", three_fields, friction=0.7), "coulomb")


@pytest.mark.parametrize("overhang", [0.3, -0.3])
@pytest.mark.parametrize("quads", [False, True])
def test_one_surface_reaches_beyond_the_other(overhang, quads):
    """Some macro-elements have no partner, or on a part only; some have had none before."""
    form = finite_form(blocks2d(overhang=overhang, quads=quads), "order 2", friction=0.7)
    deformed(form, 0.7, shift=0.35)
    table = form.table()
    share = table["area"] / table["fullarea"]
    assert np.any((share > 0) & (share < 0.9))
    assert statuses(form) == {0, 1, 2}
    assert form.derivative_error(6) <= TOL


CELLS = [
    ("tet", "tet", "order 1", 4, 3),
    ("hex", "hex", "order 1", 4, 3),
    ("prism", "hex", "order 1", 4, 3),
    ("tet", "hex", "VectorH1", 2, 3),
    ("hex", "prism", "VectorH1", 2, 3),
    ("prism", "tet", "VectorH1", 2, 3),
    ("hex", "tet", "order 3", 2, 1),
]


def check3d(cells, law):
    upper, lower, space, *n = cells
    mesh = TwoBlocks3D(upper, lower, *n, height=0.5)
    check(finite_form(mesh, space, **LAWS[law][0]), law)


@pytest.mark.parametrize("cells", CELLS, ids=lambda c: "-".join(map(str, c)))
def test_three_dimensions(cells):
    check3d(cells, "coulomb")


@pytest.mark.parametrize("cells", CELLS[:3], ids=lambda c: "-".join(map(str, c)))
@pytest.mark.parametrize("law", ["frictionless", "tresca"])
def test_other_laws_in_three_dimensions(cells, law):
    check3d(cells, law)


@pytest.mark.parametrize("space", ["H1(dim=3)", "VectorValued", "bubble"])
def test_other_spaces3d(space):
    check(finite_form(TwoBlocks3D("hex", "tet", 2, 1), space, friction=0.7), "coulomb")


def test_tresca_and_three_fields_in_3d():
    mesh = TwoBlocks3D("hex", "tet", 2, 1)
    check(finite_form(mesh, "VectorH1", three_fields, tresca=0.6), "tresca")


@pytest.mark.parametrize("overhang", [0.3, -0.3])
def test_overhang_in_3d(overhang):
    mesh = TwoBlocks3D("hex", "tet", 3, 2, overhang=overhang, aligned=False, height=0.5)
    form = finite_form(mesh, "VectorH1", friction=0.7)
    deformed(form, 0.7, shift=0.35)
    assert statuses(form) == {0, 1, 2}
    assert form.derivative_error(6) <= TOL


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("overhang", [0.3, -0.3])
def test_newton_matrix_with_moving_points(dim, overhang):
    """The surfaces are paired anew for each difference: what overlaps changes at the rim.

    On straight faces quadrature is exact, so that nothing else comes from the points.
    """
    options = {"overhang": overhang, "aligned": False, "height": 0.5}
    mesh = blocks2d(**options) if dim == 2 else TwoBlocks3D("tet", "tet", 5, 4, **options)
    form = finite_form(mesh, "order 1", friction=0.7)
    deformed(form, 0.7, shift=0.35, noise=0.0)
    table = form.table()
    share = table["area"] / table["fullarea"]
    assert np.any((share > 0.05) & (share < 0.95))
    assert statuses(form) == {0, 1, 2}
    assert form.derivative_error(40 if dim == 2 else 10, repaired=True) <= 10 * TOL


@pytest.mark.parametrize("kinds", [("hex", "tet"), ("tet", "hex")], ids="-".join)
def test_no_rim_inside_the_master(kinds):
    """Curved faces leave slits between their facets; nothing ends there.

    Where the slave alone dictates the direction, that does not jump there either.
    """
    mesh = TwoBlocks3D(*kinds, 2, 5, overhang=0.5, aligned=False, height=0.5)
    form = finite_form(mesh, "VectorH1", friction=0.7)
    stiff_slave(form)
    deformed(form, 0.7, shift=0.05, noise=0.0)
    table = form.table()
    assert table["area"] == pytest.approx(table["fullarea"], rel=1e-6)
    fixed, moving = form.matrix(), form.matrix(of_newton=True)
    assert abs(moving - fixed).max() <= 1e-12 * abs(fixed).max()
