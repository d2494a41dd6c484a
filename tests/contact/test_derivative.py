"""The matrix of the contact form against central differences of its residual.

Between two calls of `Follow` quadrature points and master faces stay, and so they do here. With
finite sliding slip counts from a committed configuration other than the one looked at.
"""

import numpy as np
import pytest
from blocks import block_mesh, contact_form, matrix, mixed_state, moved, random_state, residual
from form import Form
from netgen.meshing import NgException
from ngsolve import CF, H1, x, y, z
from sheets import grid, lower, sheet_mesh, upper

LAWS = {  # and the bound of the tangential traction over the normal one
    "frictionless": ({}, 0.5),
    "coulomb": ({"friction": 0.7}, 0.7),
    "tresca": ({"tresca": 0.6}, 0.6),
    "coulomb and tresca": ({"friction": 0.9, "tresca": 0.6}, 0.6),
    "bilateral": ({"friction": 0.7, "bilateral": True}, 0.7),
    "bilateral, frictionless": ({"bilateral": True}, 0.5),
    "offset": ({"friction": 0.7, "offset": 0.2 + 0.1 * x}, 0.7),
}
SMALL = {
    **{name: law for name, (law, _) in LAWS.items()},
    "coulomb of place": {"friction": 0.8 + 0.4 * x * y},
    "tied": {"tied": True},
    "obstacle": {"obstacle": 0.1 * x - 0.05 * y},
    "obstacle with friction": {"obstacle": CF(0.1), "friction": 0.5},
    "obstacle with tresca": {"obstacle": CF(0.1), "tresca": 0.5},
}
EVERY = {"frictionless": {0, 2}, "obstacle": {0, 2}}
PAIRED = {"bilateral": {1, 2}, "bilateral, frictionless": {2}}  # of what has a partner
# The cells of the upper and the lower block and their divisions.
SHAPES = [("hex", "hex", 3, 2), ("tet", "tet", 3, 2), ("prism", "prism_side", 3, 2)]
SHAPES += [("prism_side", "pyramid", 3, 2), ("pyramid", "tet", 3, 2)]
SIZES = {(3, "order 1"): ("hex", "tet", 4, 3), (3, "order 3"): ("hex", "tet", 2, 1)}
OTHERS = ["order 1", "order 3", "H1(dim)", "VectorValued", "bubble"]
CASES = [(dim, (), "order 2", law) for dim in (2, 3) for law in SMALL]
CASES += [(3, cells, "order 2", "coulomb") for cells in SHAPES]
CASES += [(d, SIZES.get((d, space), ()), space, "coulomb") for d in (2, 3) for space in OTHERS]


@pytest.mark.parametrize(("dim", "cells", "space", "law"), CASES)
def test_small_sliding(dim, cells, space, law):
    contact = contact_form(block_mesh(dim, *cells), space, **SMALL[law])
    tied, few = {0, 1} if dim == 2 else {1}, dim == 3 and space != "order 2"
    expected = tied if law == "tied" else None if few else EVERY.get(law, {0, 1, 2})
    if law in PAIRED:
        expected = PAIRED[law] | ({0} if dim == 2 else set())
    form = Form(contact)
    form.values[:] = mixed_state(contact, expected)
    assert form.derivative_error(contact.nscalars) <= 1e-7


@pytest.mark.parametrize(("dim", "flags"), [(2, {}), (3, {"rotation": None})])
def test_small_sliding_from_a_deformed_configuration(dim, flags):
    """Pairing, gaps and slips of a configuration other than the reference."""
    contact = contact_form(block_mesh(dim, **flags), friction=0.7)
    field = (0.1 * y + 0.03 * x * x, 0.05 * x * (z if dim == 3 else 1), 0.04 * x * y)[:dim]
    gf, form = moved(contact, field, field), Form(contact)
    contact.Update(gf)
    contact.form.SetConstant(2.0)
    for seed in range(20):
        form.values[:] = gf.vec.FV().NumPy() + random_state(contact, seed)
        if set(form.table()["status"]) == {0, 1, 2}:
            break
    assert set(form.table()["status"]) == {0, 1, 2}
    assert form.derivative_error(contact.nscalars) <= 1e-7


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("dim", [2, 3])
def test_displacement_is_not_the_first_component(dim, finite):
    """The dofs of the displacement do not begin at zero."""
    contact = contact_form(block_mesh(dim), before=[lambda m: H1(m, order=1)], friction=0.7,
                           finite=finite)  # fmt: skip
    form, front = Form(contact), contact.mesh.nv
    form.values[:] = 0.01 * random_state(contact)
    assert contact.form.offset == front
    assert form.derivative_error(40) <= 1e-7
    assert not np.any(matrix(contact, form.values)[:front])
    assert not np.any(residual(contact, form.values)[:front])


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("friction", [0.05, 2.0], ids=["slip", "stick"])
@pytest.mark.parametrize("dim", [2, 3])
def test_one_component_is_prescribed_on_the_slave(dim, friction, finite):
    """Where the slave cannot follow the multiplier is elastic; its normal is no axis."""
    contact = contact_form(block_mesh(dim), "prescribed", friction=friction, finite=finite)
    form, normals = Form(contact), contact.Table()["normal"]
    assert np.all(contact.form.Table()["prescribed"] == 1)
    assert np.all(np.abs(normals[:, 0]) > 0.05)
    noise, shear = np.random.default_rng(1).normal(size=(2, contact.nscalars))
    form.values[:] = 1e-3 * noise
    form.values[form.multipliers] += 0.2 * shear[form.multipliers] - 0.7 * normals
    assert form.derivative_error(40) <= 1e-6


def finite_form(dim, *cells, space="order 2", law="coulomb", **flags):
    solid = {"shape": "flat", "rotation": None, "overhang": 0.0, "height": 0.5}
    mesh = block_mesh(dim, *cells, **(({"angle": 0.0} if dim == 2 else solid) | flags))
    return Form(contact_form(mesh, space, finite=True, **LAWS[law][0]))


def deformed(form, bound=0.7, *, shift=0.12, noise=0.004):
    """Committed in one configuration with slip in advance, moved on to another; every status."""
    form.bend(0.05, 0.0, degrees=30, noise=noise, seed=1)
    form.commit()
    alone, history = form.table()["area"] == 0, form.contact.form.History()
    random = np.random.default_rng(3)
    history["reference"][:] = 0.01 * random.normal(size=len(history["reference"]))
    form.contact.form.SetHistory(history)
    form.bend(0.08, shift, degrees=50, noise=noise, seed=2)
    form.follow()
    form.impose(bound)
    table = form.table()
    table["new"] = alone & (table["area"] > 0)
    return table, set(table["status"][table["area"] > 0])


FINITE = [(2, (), space, law) for space in ("order 1", "order 2", "order 3") for law in LAWS]
FINITE += [(2, (), space, "coulomb") for space in OTHERS[2:]]
FINITE += [(3, ("hex", "tet", 2, 1), space, "coulomb") for space in OTHERS[1:]]
FINITE += [
    (3, (upper, "hex", 4, 3), "order 1", law)
    for upper, law in zip(("tet", "hex", "prism", "hex", "tet", "tet", "hex"), LAWS, strict=True)
]
FINITE += [
    (3, (upper, lower, 2, 3), "order 2", "coulomb")
    for upper, lower in (("tet", "hex"), ("hex", "prism"), ("prism", "tet"))
]


@pytest.mark.parametrize(("dim", "cells", "space", "law"), FINITE)
def test_finite_sliding(dim, cells, space, law):
    form = finite_form(dim, *cells, space=space, law=law)
    _, statuses = deformed(form, LAWS[law][1])
    assert statuses == PAIRED.get(law, EVERY.get(law, {0, 1, 2}))
    assert form.derivative_error(40 if dim == 2 else 6) <= 1e-8


@pytest.mark.parametrize("law", ["frictionless", "coulomb"])
@pytest.mark.parametrize(("dim", "cells"), [(2, ()), (3, ("hex", "tet", 2, 1))])
def test_pressures_that_lean(dim, cells, law):
    """As in dynamics: each pressure p gets -p times a vector in addition."""
    form = finite_form(dim, *cells, law=law)
    form.follow()
    deformed(form, LAWS[law][1])
    table, upright = form.table(), form.contact.Force()
    vectors = 0.2 * np.random.default_rng(5).normal(size=table["normal"].shape)
    form.contact.form.Lean(vectors.ravel())
    added = -(table["area"] * table["pressure"]) @ vectors
    assert form.contact.Force() - upright == pytest.approx(added, abs=1e-12)
    assert form.derivative_error(40 if dim == 2 else 6) <= 1e-8
    form.contact.form.Lean([])
    form.table()
    assert form.contact.Force() == pytest.approx(upright, abs=1e-12)
    with pytest.raises(NgException, match="3 numbers of vectors"):
        form.contact.form.Lean(np.zeros(3))


@pytest.mark.parametrize(("dim", "cells"), [(2, ()), (3, ("hex", "tet", 2, 1))])
def test_rays_that_miss_keep_their_partner(dim, cells):
    """Points that are far beyond their master's face: the gap is what lies between in normal."""
    form = finite_form(dim, *cells, law="frictionless")
    form.follow()
    way = np.eye(dim)[0] * 5 + np.eye(dim)[-1] * 0.1
    form.place(CF((x, y, z)[:dim]) + form.body(1, 0) * CF(tuple(way)))
    table = form.table()
    assert table["gap"][table["area"] > 0] == pytest.approx(0.1, abs=1e-12)
    form.values[:] += 1e-3 * np.random.default_rng(0).normal(size=len(form.values))
    assert form.derivative_error(40 if dim == 2 else 6) <= 1e-8


@pytest.mark.parametrize("overhang", [0.3, -0.3])
@pytest.mark.parametrize(
    ("dim", "cells", "flags"),
    [(2, (), {}), (2, (), {"quads": True}), (3, ("hex", "tet", 3, 2), {})],
)
def test_one_surface_reaches_beyond_the_other(overhang, dim, cells, flags):
    """Some macro-elements have no partner, or on a part only; some have had none before."""
    form = finite_form(dim, *cells, overhang=overhang, **flags)
    table, statuses = deformed(form, shift=0.35)
    share = table["area"] / table["fullarea"]
    assert np.any((share > 0) & (share < 0.9))
    assert statuses == {0, 1, 2}
    assert np.any(table["new"]) or dim == 3 or overhang > 0
    slip = np.linalg.norm(table["slip"], axis=1)
    assert np.all(slip[table["new"]] > 0.1)  # the master came over them
    assert form.derivative_error(6) <= 1e-8


@pytest.mark.parametrize(("dim", "cells"), [(2, ()), (3, ("tet", "tet", 5, 4))])
@pytest.mark.parametrize("overhang", [0.3, -0.3])
def test_newton_matrix_with_moving_points(dim, cells, overhang):
    """The surfaces are paired anew for each difference: what overlaps changes at the rim.

    On straight faces quadrature is exact, so that nothing else comes from the points.
    """
    form = finite_form(dim, *cells, space="order 1", overhang=overhang)
    table, statuses = deformed(form, shift=0.35, noise=0.0)
    share = table["area"] / table["fullarea"]
    assert np.any((share > 0.05) & (share < 0.95))
    assert statuses == {0, 1, 2}
    assert form.derivative_error(40 if dim == 2 else 10, repaired=True) <= 1e-7


def test_newton_matrix_of_a_master_with_a_hole():
    """Which begins and ends in the middle of one slave face."""
    left, right = ((0, 0), (0.52, 1)), ((0.58, 0), (1.1, 1))
    parts = [lower(grid("edge", 4, left)), lower(grid("edge", 3, right))]
    mesh = sheet_mesh(upper(grid("edge", 5)), *parts)
    form = Form(contact_form(mesh, "order 1", finite=True, friction=0.7))
    _, statuses = deformed(form, shift=-0.01, noise=0.0)
    assert len(statuses) > 1
    assert form.derivative_error(40, repaired=True) <= 1e-7


@pytest.mark.parametrize("kinds", [("hex", "tet"), ("tet", "hex")], ids="-".join)
def test_no_rim_inside_the_master(kinds):
    """Curved faces leave slits between their facets; nothing ends there.

    Where the slave alone dictates the direction, that does not jump there either.
    """
    form = finite_form(3, *kinds, 2, 5, overhang=0.5)
    history = form.contact.form.History()
    history["share"][:] = 0.0  # as if the master were soft
    form.contact.form.SetHistory(history)
    table, _ = deformed(form, shift=0.05, noise=0.0)
    assert table["area"] == pytest.approx(table["fullarea"], rel=1e-6)
    fixed, moving = form.matrix(), form.matrix(of_newton=True)
    assert abs(moving - fixed).max() <= 1e-12 * abs(fixed).max()
