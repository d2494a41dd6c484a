"""Finite sliding: the matrix of the contact form against central differences of its residual.

Between two calls of `Follow` quadrature points and master faces stay, and so they do here. Slip
counts from a committed configuration other than the one looked at.
"""

import numpy as np
import pytest
from blocks import contact_form
from finiteform import FiniteForm
from ngsolve import H1

from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D

TOL = 1e-8
LAWS = {
    "frictionless": ({}, 0.5),
    "coulomb": ({"friction": 0.7}, 0.7),
    "tresca": ({"tresca": 0.6}, 0.6),
    "coulomb and tresca": ({"friction": 0.9, "tresca": 0.6}, 0.6),
}


def plane(**flags):
    options = {"structured": True, "height": 0.5, "overhang": -0.2, "aligned": False}
    return TwoBlocks(0.1, **(options | flags))


def solid(*cells, **flags):
    return TwoBlocks3D(*cells, **({"height": 0.5, "aligned": False} | flags))


def finite_form(mesh, space="order 2", law="coulomb", **flags):
    return FiniteForm(contact_form(mesh, space, finite=True, **LAWS[law][0], **flags))


def deformed(form, bound, *, degrees=50.0, size=0.05, shift=0.12, noise=0.004):
    """Committed in one configuration, moved on to another, with every status."""
    form.bend(size, 0.0, degrees=degrees - 20, noise=noise, seed=1)
    form.commit()
    form.bend(1.6 * size, shift, degrees=degrees, noise=noise, seed=2)
    form.follow()
    form.impose(bound)
    return form.table()


def check(form, law="coulomb", columns=None, **motion):
    flags, bound = LAWS[law]
    table = deformed(form, bound, **motion)
    assert set(table["status"][table["area"] > 0]) == ({0, 1, 2} if flags else {0, 2})
    assert form.derivative_error(columns or (40 if form.dim == 2 else 6)) <= TOL
    return table


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("space", ["order 1", "order 2", "order 3"])
def test_laws_and_orders_in_the_plane(space, law):
    check(finite_form(plane(), space, law), law)


CELLS = [
    (("tet", "tet", 4, 3), "order 1", ["coulomb", "tresca"]),
    (("hex", "hex", 4, 3), "order 1", ["coulomb", "frictionless"]),
    (("prism", "hex", 4, 3), "order 1", ["coulomb"]),
    (("tet", "hex", 2, 3), "order 2", ["coulomb"]),
    (("hex", "prism", 2, 3), "order 2", ["coulomb"]),
    (("prism", "tet", 2, 3), "order 2", ["coulomb"]),
    (("hex", "tet", 2, 1), "order 3", ["coulomb"]),
]


@pytest.mark.parametrize(
    ("cells", "space", "law"), [(*case, law) for *case, laws in CELLS for law in laws]
)
def test_cells_and_laws_in_space(cells, space, law):
    check(finite_form(solid(*cells), space, law), law)


@pytest.mark.parametrize("space", ["H1(dim)", "VectorValued", "bubble"])
@pytest.mark.parametrize("dim", [2, 3])
def test_other_spaces(dim, space):
    check(finite_form(plane() if dim == 2 else solid("hex", "tet", 2, 1), space))


@pytest.mark.parametrize("dim", [2, 3])
def test_displacement_is_not_the_first_component(dim):
    mesh = plane() if dim == 2 else solid("hex", "tet", 2, 1)
    check(finite_form(mesh, law="tresca", before=[lambda m: H1(m, order=1)]), "tresca")


OVERHANGS = {
    "trig": lambda overhang: plane(overhang=overhang),
    "quad": lambda overhang: plane(overhang=overhang, quads=True),
    "3D": lambda overhang: solid("hex", "tet", 3, 2, overhang=overhang),
}


@pytest.mark.parametrize("overhang", [0.3, -0.3])
@pytest.mark.parametrize("make", OVERHANGS)
def test_one_surface_reaches_beyond_the_other(overhang, make):
    """Some macro-elements have no partner, or on a part only; some have had none before."""
    table = check(finite_form(OVERHANGS[make](overhang)), columns=6, shift=0.35)
    share = table["area"] / table["fullarea"]
    assert np.any((share > 0) & (share < 0.9))


@pytest.mark.parametrize("make", [plane, lambda **flags: solid("tet", "tet", 5, 4, **flags)])
@pytest.mark.parametrize("overhang", [0.3, -0.3])
def test_newton_matrix_with_moving_points(make, overhang):
    """The surfaces are paired anew for each difference: what overlaps changes at the rim.

    On straight faces quadrature is exact, so that nothing else comes from the points.
    """
    form = finite_form(make(overhang=overhang), "order 1")
    table = deformed(form, 0.7, shift=0.35, noise=0.0)
    share = table["area"] / table["fullarea"]
    assert np.any((share > 0.05) & (share < 0.95))
    assert set(table["status"][share > 0]) == {0, 1, 2}
    assert form.derivative_error(40 if form.dim == 2 else 10, repaired=True) <= 10 * TOL


@pytest.mark.parametrize("kinds", [("hex", "tet"), ("tet", "hex")], ids="-".join)
def test_no_rim_inside_the_master(kinds):
    """Curved faces leave slits between their facets; nothing ends there.

    Where the slave alone dictates the direction, that does not jump there either.
    """
    form = finite_form(solid(*kinds, 2, 5, overhang=0.5))
    history = form.contact.form.History()
    history["share"][:] = 0.0  # as if the master were soft
    form.contact.form.SetHistory(history)
    table = deformed(form, 0.7, shift=0.05, noise=0.0)
    assert table["area"] == pytest.approx(table["fullarea"], rel=1e-6)
    fixed, moving = form.matrix(), form.matrix(of_newton=True)
    assert abs(moving - fixed).max() <= 1e-12 * abs(fixed).max()
