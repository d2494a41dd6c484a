"""A clearance or an interference that is added to the gap, without moving the meshes."""

import numpy as np
import pytest
from blocks import C, block_mesh, contact_form, matrix, moved, random_state, residual
from form import Form
from ngsolve import CF, H1, BitArray, GridFunction, Parameter, x
from press import press

FINITE = {"offset": 0.1, "finite": True}


@pytest.fixture(scope="module")
def mesh():
    return block_mesh(2, 0.25)


def gap(contact, gf):
    contact.Evaluate(gf)
    return contact.Table()["gap"].copy()


@pytest.mark.parametrize("finite", [False, True])
def test_it_is_added_to_the_gap_and_to_nothing_else(mesh, finite):
    law = {"friction": 0.3, "finite": finite}
    plain, open_ = contact_form(mesh, **law), contact_form(mesh, offset=0.1 + x, **law)
    gf = moved(plain, (0.01, -0.02), (0.0, 0.01))
    other = moved(open_, (0.01, -0.02), (0.0, 0.01))
    added = np.where(plain.Table()["area"] > 0, gap(open_, other) - gap(plain, gf), 0)
    expected = 0.1 + plain.Table()["x"][:, 0]
    assert added == pytest.approx(np.where(plain.Table()["area"] > 0, expected, 0), abs=1e-13)
    for name in ("slip", "normal", "area"):
        assert open_.Table()[name] == pytest.approx(plain.Table()[name], abs=1e-14)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("function", [lambda t: 0.1 * x - t, lambda t: -t])
def test_it_follows_its_parameter(mesh, finite, function):
    t = Parameter(0.0)
    driven = contact_form(mesh, offset=function(t), friction=0.3, finite=finite)
    state = 0.01 * random_state(driven)
    for value in (0.0, 0.03, -0.02):
        t.Set(value)
        still = contact_form(mesh, offset=function(CF(value)), friction=0.3, finite=finite)
        for f in (residual, matrix):
            assert np.array_equal(f(driven, state), f(still, state))


def test_it_follows_a_gridfunction(mesh):
    field = GridFunction(H1(mesh, order=1))
    contact = contact_form(mesh, offset=field)
    gf = GridFunction(contact.form.fes)
    before = gap(contact, gf)
    field.vec[:] = 0.25
    assert gap(contact, gf) - before == pytest.approx(0.25)


def test_on_an_obstacle_it_is_a_part_of_its_gap(mesh):
    one = contact_form(mesh, obstacle=0.1 * x - 0.3, friction=0.2)
    two = contact_form(mesh, obstacle=0.1 * x, offset=-0.3, friction=0.2)
    state = random_state(one)
    assert residual(two, state) == pytest.approx(residual(one, state), abs=1e-14)


@pytest.mark.parametrize("law", [{}, {"friction": 0.3}])
@pytest.mark.parametrize("dim", [2, 3])
def test_bodies_moved_apart_by_it_press_each_other_as_before(dim, law):
    """Flat surfaces, of which the upper one starts nearer by a clearance, or farther away."""
    plain, up = press(dim=dim, **law), np.eye(dim)[-1]
    plain.solver().Solve(printing=False)
    for offset in (0.3, -0.2):
        push = np.array({2: (0.02, -0.02), 3: (0.02, 0.01, -0.02)}[dim]) - offset * up
        other = press(dim=dim, push=tuple(map(float, push)), offset=offset, **law)
        other.solver().Solve(printing=False)
        lowered = moved(other.contact, tuple(-offset * up))
        u = other.gf.components[0].vec.FV().NumPy() - lowered.components[0].vec.FV().NumPy()
        expected = plain.gf.components[0].vec.FV().NumPy()
        assert u == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
        pressures = other.contact.Table()["pressure"], plain.contact.Table()["pressure"]
        assert pressures[0] == pytest.approx(pressures[1], abs=1e-8 * pressures[1].max())


@pytest.mark.parametrize(("dim", "cells"), [(2, ()), (3, ("hex", "tet", 2, 1))])
def test_search_reaches_as_far_as_the_offset(dim, cells):
    """The limits count from where the surfaces touch, an overlap of the meshes included."""
    mesh = block_mesh(dim, *cells, **({"angle": 0.0} if dim == 2 else {"rotation": None}))
    for offset, limits in ((0.3, {"penetration": 0.01}), (-0.3, {"maxdist": 0.01})):
        form = Form(contact_form(mesh, finite=True, offset=offset, **limits))
        plain = Form(contact_form(mesh, finite=True, **limits))
        way = offset * form.table()["normal"][0]  # to where they touch
        form.lead(way)
        table = form.table()
        paired = table["area"] > 0
        assert np.any(paired)
        assert table["gap"][paired] == pytest.approx(0, abs=1e-12)
        if offset < 0:  # the bodies are apart
            for one, far in ((plain, way), (form, 1.1 * way)):
                one.lead(far)
                assert not np.any(one.table()["area"])
            continue
        with pytest.raises(Exception, match="never meet"):
            plain.lead(way)
        with pytest.raises(Exception, match=r"penetration = 0\.01"):
            form.lead(1.1 * way)


def test_the_search_follows_a_parameter_where_nothing_moves():
    t = Parameter(0.0)
    mesh = block_mesh(2, angle=0.0)
    form = Form(contact_form(mesh, finite=True, offset=t, penetration=0.01))
    form.lead((0, -0.009))
    assert np.any(form.table()["area"] > 0)
    t.Set(-0.1)
    form.follow()
    with pytest.raises(Exception, match="never meet"):
        form.lead((0, -0.3))
    t.Set(0.3)
    form.lead((0, -0.3))
    assert np.any(form.table()["area"] > 0)


def test_a_press_fit_counts_as_approach_before_the_first_touch(mesh):
    """Slip in the step of the touch counts fully where the offset closes the gap."""
    t = Parameter(0.3)
    contact = contact_form(mesh, offset=t, friction=0.5)
    obstacle = contact_form(mesh, obstacle=t, friction=0.5)
    for value, way in ((0.2, 0.0), (0.1, 0.0), (0.05, 0.1)):
        t.Set(value)
        for one in (contact, obstacle):
            one.Commit(moved(one, (way, 0.0)))
    found, expected = (c.form.Table()["reference"] for c in (contact, obstacle))
    paired = contact.Table()["area"] > 0
    normal = contact.Table()["normal"]
    across = [v - np.sum(v * normal, axis=1)[:, None] * normal for v in (found, expected)]
    assert across[0][paired] == pytest.approx(across[1][paired], abs=1e-13)


def test_closing_takes_it_into_account(mesh):
    contact = contact_form(mesh, offset=-0.1)
    gf = GridFunction(contact.form.fes)
    contact.form.Close(BitArray(contact.space.nmacros * [True]), gf.vec)
    contact.Evaluate(gf)
    paired = contact.Table()["area"] > 0
    assert contact.Table()["pressure"][paired] == pytest.approx(0.1 * C, rel=1e-4)


def test_a_wrong_value_names_the_place(mesh):
    t = Parameter(0.0)
    contact = contact_form(mesh, offset=t * x)
    t.Set(np.inf)
    with pytest.raises(Exception, match=r"offset is -?inf at \(.*must be a finite number"):
        residual(contact, 0.0)
    t.Set(-1.0)
    assert np.all(np.isfinite(residual(contact, 0.0)))
