"""Ties of finite motions: the form."""

import numpy as np
import pytest
from blocks import C, block_mesh, contact_form, residual
from form import POSITIONS, Form
from ngsolve import CF

APART = 0.1
SOLID = ("hex", "tet", 2, 1)
CASES = [(2, (), space) for space in ("order 1", "order 2", "H1(dim)", "bubble", "prescribed")]
CASES += [(3, SOLID, "order 2"), (3, ("prism", "hex", 2, 3), "order 1")]


def tie(dim, cells=(), space="order 2", apart=APART):
    """Tied where the upper block is apart from the lower one."""
    form = Form(contact_form(block_mesh(dim, *cells), space, tied=True, finite=True))
    way = apart * np.eye(dim)[-1]
    form.place(CF(POSITIONS[:dim]) + form.body(1, 0) * CF(tuple(way)))
    form.contact.Update(form.gf)
    form.contact.form.SetConstant(C)
    return form


def deformed(form, seed=0):
    form.bend(0.08, 0.1, degrees=50, noise=0.004)
    tractions = np.random.default_rng(seed).normal(size=form.multipliers.shape)
    form.values[form.multipliers] = tractions
    return tractions


def forces(form):
    """Nodal forces on all of it, (n, d), and the positions of now; of spaces by components."""
    u = form.u.vec.FV().NumPy().reshape(form.dim, -1)
    rows = residual(form.contact, form.values)[: u.size].reshape(form.dim, -1)
    places = Form(form.contact)
    places.u.Set(CF(POSITIONS[: form.dim]))
    return rows, places.u.vec.FV().NumPy().reshape(form.dim, -1) + u


@pytest.mark.parametrize(("dim", "cells", "space"), CASES)
def test_derivative_is_exact_and_symmetric(dim, cells, space):
    form = tie(dim, cells, space)
    deformed(form)
    assert form.derivative_error(40) <= 1e-8
    matrix = form.matrix()
    displacements = np.setdiff1d(np.arange(len(form.values)), form.multipliers)
    bulk = matrix[displacements][:, displacements]
    assert abs(bulk).max() > 1e-3
    assert abs(bulk - bulk.T).max() <= 1e-13 * abs(matrix).max()
    columns = matrix[displacements][:, form.multipliers.ravel()]
    rows = matrix[form.multipliers.ravel()][:, displacements]
    assert abs(columns - rows.T).max() <= 1e-13 * abs(matrix).max()


@pytest.mark.parametrize("degrees", [0, 30, 90, 215])
@pytest.mark.parametrize(("dim", "cells"), [(2, ()), (3, SOLID)])
def test_rigid_motions_change_nothing(dim, cells, degrees):
    """The surfaces are apart; both bodies turn, and forces turn with the tractions."""
    form = tie(dim, cells)
    table = form.table()
    paired = table["area"] > 0
    tractions = np.random.default_rng(1).normal(size=table["normal"].shape) * paired[:, None]
    form.values[form.multipliers] = tractions
    before, _ = forces(form)
    way = APART * np.eye(dim)[-1]
    R = form.place(CF(POSITIONS[:dim]) + form.body(1, 0) * CF(tuple(way)), degrees)
    form.values[form.multipliers] = tractions @ R.T
    turned = form.table()
    assert turned["gap"] == pytest.approx(table["gap"], abs=1e-13, nan_ok=True)
    assert turned["normal"][paired] == pytest.approx(table["normal"][paired] @ R.T, abs=1e-13)
    assert turned["slip"] == pytest.approx(0, abs=1e-13)
    assert residual(form.contact, form.values)[form.multipliers] == pytest.approx(0, abs=1e-13)
    assert forces(form)[0] == pytest.approx(R @ before, abs=1e-13)


@pytest.mark.parametrize(("dim", "cells"), [(2, ()), (3, SOLID)])
def test_forces_balance_and_moments_where_the_constraints_hold(dim, cells):
    """What is left of the moments is the traction times what the surfaces have come apart."""
    form = tie(dim, cells)
    tractions = deformed(form)
    rows, places = forces(form)
    constant = Form(form.contact)
    constant.u.Set(CF((1,) * dim))
    ones = constant.u.vec.FV().NumPy().reshape(dim, -1)
    assert np.sum(rows * ones, axis=1) == pytest.approx(0, abs=1e-13)
    table = form.table()
    tractions = tractions * (table["area"] > 0)[:, None]
    form.values[form.multipliers] = 0.0
    apart = -residual(form.contact, form.values)[form.multipliers]  # times the area
    assert np.abs(apart).max() > 1e-3
    found, expected = places @ rows.T, -apart.T @ tractions
    assert found - found.T == pytest.approx(expected - expected.T, abs=1e-13)


@pytest.mark.parametrize(("dim", "cells"), [(2, ()), (3, SOLID)])
def test_resultants_are_those_of_the_forces_on_the_slave(dim, cells):
    form = tie(dim, cells)
    deformed(form)
    form.table()
    rows, places = forces(form)
    space = form.u.space
    upper = np.array(list(space.GetDofs(form.contact.mesh.Materials("upper")))).reshape(dim, -1)
    constant = Form(form.contact)
    constant.u.Set(CF((1,) * dim))
    ones = constant.u.vec.FV().NumPy().reshape(dim, -1)
    assert form.contact.Force() == pytest.approx(-np.sum(rows * ones * upper, axis=1), abs=1e-12)
    moment = -places @ (rows * upper).T
    axial = [moment[i - 2, i - 1] - moment[i - 1, i - 2] for i in range(3 if dim == 3 else 0)]
    assert form.contact.Moment() == pytest.approx(axial or moment[0, 1] - moment[1, 0], abs=1e-12)


def test_partners_stay():
    """Whatever the motion is; also in a contact that takes over the state."""
    form = tie(2)
    before = form.contact.Segments().gap
    form.bend(0.08, 0.4, degrees=50)
    form.commit()
    assert np.array_equal(form.contact.Segments().gap, before)
    other = tie(2)
    other.contact.SetState(form.contact.State())
    state = 0.1 * np.random.default_rng(0).normal(size=len(form.values))
    expected = residual(form.contact, state)
    assert residual(other.contact, state) == pytest.approx(expected, abs=1e-15)


def test_moments_come_back_with_the_state():
    """They are those of the configuration of the last commit, or of the solution given."""
    form = tie(2)
    deformed(form)
    form.commit()
    committed, state, solution = form.contact.Moment(), form.contact.State(), form.values.copy()
    form.bend(0.03, 0.3, degrees=80)
    form.table()
    assert abs(form.contact.Moment() - committed) > 1e-3
    form.contact.Restore()
    assert form.contact.Moment() == pytest.approx(committed, rel=1e-12)
    form.commit()
    form.values[:] = solution
    form.contact.SetState(state, form.gf)
    assert form.contact.Moment() == pytest.approx(committed, rel=1e-12)
    form.contact.Restore()
    assert form.contact.Moment() == pytest.approx(committed, rel=1e-12)
