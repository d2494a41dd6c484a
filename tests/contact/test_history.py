"""Commit and the slip history: increments since the last step, or since the first touch."""

import numpy as np
import pytest
from blocks import C, block_mesh, contact_form, moved, residual, vector, with_traction
from netgen.meshing import NgException
from ngsolve import CF, BitArray, GridFunction, x, y

ANGLE = 20.0
T = np.array([np.cos(np.radians(ANGLE)), np.sin(np.radians(ANGLE))])  # along the surface
N = np.array([T[1], -T[0]])  # out of the slave


@pytest.fixture(scope="module")
def mesh():
    return block_mesh(ANGLE, h=0.2)


def state(contact, tangential=0.0, approach=0.0, pressure=0.0, shear=0.0):
    """The upper block moved along and towards the lower one, with tractions."""
    gf = moved(contact, upper=tuple(tangential * T + approach * N))
    return with_traction(contact, gf, -pressure * N + shear * T)


def slip(contact, gf):
    """Tangential slip of the paired macro-elements."""
    contact.Evaluate(gf)
    table = contact.Table()
    assert table["slip"] @ N == pytest.approx(0, abs=1e-13)
    return (table["slip"] @ T)[table["area"] > 0]


def test_slip_counts_from_the_last_commit(mesh):
    contact = contact_form(mesh, friction=0.5)
    total = 0.0
    for step in (0.3, -0.1, 0.05):
        total += step
        gf = state(contact, total, 0.01, pressure=1.0)
        assert slip(contact, gf) == pytest.approx(step, rel=1e-12)
        contact.Commit(gf)
        assert slip(contact, gf) == pytest.approx(0, abs=1e-14)


def test_gap_does_not_depend_on_the_history(mesh):
    contact = contact_form(mesh)
    contact.Commit(state(contact, 0.1, 0.2, pressure=1.0))
    contact.Evaluate(state(contact, 0.3, -0.05))
    paired = contact.Table()["area"] > 0
    assert contact.Table()["gap"][paired] == pytest.approx(0.05, rel=1e-12)


def test_residual_uses_the_increment(mesh):
    """Stick rows hold the slip since the commit: zero there, and not before."""
    contact = contact_form(mesh, friction=1e3)
    gf = state(contact, 0.3, 0.0, pressure=2.0, shear=0.1)
    paired = contact.Table()["area"] > 0
    dofs = contact.form.MultiplierDofs().reshape(-1, 2)[paired]
    before = residual(contact, gf.vec.FV().NumPy())[dofs]
    assert np.abs(before).max() > 1e-3
    contact.Commit(gf)
    assert residual(contact, gf.vec.FV().NumPy())[dofs] == pytest.approx(0, abs=1e-14)


def test_residual_of_stick_is_minus_area_times_slip(mesh):
    contact = contact_form(mesh, friction=1e3)
    gf = state(contact, 0.3, 0.02, pressure=5.0)
    rows = residual(contact, gf.vec.FV().NumPy())[contact.form.MultiplierDofs()].reshape(-1, 2)
    table = contact.Table()
    paired = table["area"] > 0
    jump = 0.3 * T + 0.02 * N
    assert rows[paired] == pytest.approx(-np.outer(table["area"], jump)[paired], rel=1e-11)
    # Without a partner the row says that the traction vanishes.
    free = -np.outer(table["fullarea"], -5.0 * N) / C
    assert rows[~paired] == pytest.approx(free[~paired], rel=1e-11)


def test_first_touch_along_the_path(mesh):
    """Open at the commit and approaching: slip counts from where the path meets the master."""
    contact = contact_form(mesh, friction=0.5)
    contact.Commit(state(contact, 0.0, -0.1))  # 0.1 open
    contact.Commit(state(contact, 0.05, -0.06))  # 0.06 open, by 0.04 nearer and 0.05 aside
    touch = 0.05 + 0.05 * 0.06 / 0.04
    assert slip(contact, state(contact, touch, 0.0, pressure=1.0)) == pytest.approx(0, abs=1e-13)
    assert slip(contact, state(contact, touch + 0.02, 0.0, pressure=1)) == pytest.approx(0.02)


def test_a_grazing_path_counts_from_the_commit(mesh):
    """What moves aside or away will not touch soon: no extrapolation."""
    contact = contact_form(mesh, friction=0.5)
    contact.Commit(state(contact, 0.0, -0.1))
    for tangential, approach in ((0.5, -0.1), (0.6, -0.2), (0.9, -0.199)):
        contact.Commit(state(contact, tangential, approach))
        later = state(contact, tangential + 0.1, 0.0, pressure=1.0)
        assert slip(contact, later) == pytest.approx(0.1, rel=1e-12)


def test_closed_macros_keep_their_position(mesh):
    """Closed at the commit: the path does not matter, even if the gap closes further."""
    contact = contact_form(mesh, friction=0.5)
    contact.Commit(state(contact, 0.0, -0.1))
    contact.Commit(state(contact, 0.05, -0.06, pressure=5.0))
    assert slip(contact, state(contact, 0.15, 0.0, pressure=5.0)) == pytest.approx(0.1, rel=1e-12)


def test_update_starts_the_history_anew(mesh):
    contact = contact_form(mesh, friction=0.5)
    contact.Commit(state(contact, 0.3, 0.0, pressure=1.0))
    gf = state(contact, 0.05, 0.0, pressure=1.0)
    contact.Update(gf)
    contact.form.SetConstant(C)
    assert slip(contact, gf) == pytest.approx(0, abs=1e-14)
    assert slip(contact, state(contact, 0.07, 0, pressure=1)) == pytest.approx(0.02, rel=1e-10)


def test_evaluate_fills_the_fields(mesh):
    contact = contact_form(mesh, friction=0.5)
    gf = state(contact, 0.1, 0.03, pressure=4.0, shear=1.0)
    contact.Evaluate(gf)
    table = contact.Table()
    paired = table["area"] > 0
    assert table["pressure"] == pytest.approx(4, rel=1e-13)
    assert table["gap"][paired] == pytest.approx(-0.03, rel=1e-12)
    assert table["traction"] == pytest.approx(np.tile(-4 * N + T, (len(paired), 1)), rel=1e-12)
    assert table["friction"] == pytest.approx(0.5)
    assert set(table["status"][~paired]) == {0}
    for name in ("pressure", "gap", "status"):
        assert np.array_equal(getattr(contact, name).vec.FV().NumPy(), table[name]), name
    for name in ("traction", "slip", "normal"):
        assert np.array_equal(getattr(contact, name).vec.FV().NumPy(), table[name].ravel()), name


def test_status_follows_the_law(mesh):
    """Trial pressure 2 + C/10 and trial shear 1: the three answers of Coulomb's law."""
    for friction, expected in ((0.0, 2), (0.4, 2), (0.5, 1), (None, 2)):
        contact = contact_form(mesh, friction=friction)
        contact.Evaluate(state(contact, 0.0, 0.1, pressure=2.0, shear=1.0))
        table = contact.Table()
        assert set(table["status"][table["area"] > 0]) == {expected}
    contact.Evaluate(state(contact, 0.0, -0.7, pressure=2.0))  # 2 - 0.7 C < 0
    assert set(contact.Table()["status"]) == {0}


@pytest.mark.parametrize(
    ("law", "bound"),
    [
        ({"friction": 0.3}, 0.3 * 2.3),
        ({"tresca": 0.5}, 0.5),
        ({"friction": 0.3, "tresca": 0.5}, 0.5),  # Coulomb's law up to the threshold
        ({"friction": 0.1, "tresca": 0.5}, 0.23),
        ({"friction": 0.0, "tresca": 0.5}, 0.0),
        ({}, 0.0),
    ],
)
def test_bound_of_the_tangential_traction(mesh, law, bound):
    """Trial pressure 2 + 0.1 C = 2.3; the residual says where a sliding traction should be."""
    contact = contact_form(mesh, **law)
    for shear in (4.0, -4.0, 0.9 * bound):
        gf = state(contact, 0.0, 0.1, pressure=2.0, shear=shear)
        rows = residual(contact, gf.vec.FV().NumPy())[contact.form.MultiplierDofs()]
        table = contact.Table()
        paired = table["area"] > 0
        projected = rows.reshape(-1, 2)[paired] * C / table["area"][paired, None]
        projected += -2 * N + shear * T
        expected = -2.3 * N + np.clip(shear, -bound, bound) * T
        assert projected == pytest.approx(np.tile(expected, (paired.sum(), 1)), rel=1e-11)


def test_force_and_moment(mesh):
    contact = contact_form(mesh)
    rng = np.random.default_rng(0)
    gf = GridFunction(contact.form.fes)
    tractions = rng.normal(size=(contact.space.nmacros, 2))
    with_traction(contact, gf, tractions)
    contact.Evaluate(gf)
    table = contact.Table()
    assert contact.Force() == pytest.approx(table["area"] @ tractions, rel=1e-13)
    point = np.array([0.3, -2.0])
    change = contact.Moment(point) - contact.Moment((0, 0))
    force = contact.Force()
    assert change == pytest.approx(-(point[0] * force[1] - point[1] * force[0]), rel=1e-10)
    # The same from the nodal forces: their sum with the lever arms of a linear function.
    forces = residual(contact, gf.vec.FV().NumPy())
    for field, expected in (((1, 0), force[0]), ((0, 1), force[1])):
        work = vector(contact, forces).InnerProduct(moved(contact, upper=field).vec)
        assert -work == pytest.approx(expected, rel=1e-11)
    both = vector(contact, forces).InnerProduct(moved(contact, (1, 2), (1, 2)).vec)
    assert abs(both) < 1e-13  # action and reaction


def test_moment_is_the_work_of_a_rotation(mesh):

    contact = contact_form(mesh)
    gf = GridFunction(contact.form.fes)
    with_traction(contact, gf, np.random.default_rng(1).normal(size=(contact.space.nmacros, 2)))
    contact.Evaluate(gf)
    forces = residual(contact, gf.vec.FV().NumPy())
    turn = moved(contact, upper=CF((-y, x)), lower=(0, 0))
    work = -vector(contact, forces).InnerProduct(turn.vec)
    assert contact.Moment((0, 0)) == pytest.approx(work, rel=1e-10)


@pytest.mark.parametrize("status", [3.0, -1.0, 0.5, np.nan, 1e300])
@pytest.mark.parametrize("name", ["states", "accepted"])
def test_a_status_that_there_is_not(mesh, name, status):
    """Of a damaged file, or of another version: refused before anything is taken over."""
    form = contact_form(mesh).form
    history = form.History()
    wrong = history | {"c": history["c"] + 1, name: history[name].copy()}
    wrong[name][2] = status
    with pytest.raises(NgException, match="status of a macro-element"):
        form.SetHistory(wrong)
    for key, values in form.History().items():
        np.testing.assert_array_equal(values, history[key])
    form.SetHistory(history)


def test_as_many_bits_as_macro_elements(mesh):
    contact = contact_form(mesh)
    vec = vector(contact)
    for bits in (BitArray(0), BitArray(contact.space.nmacros + 1)):
        with pytest.raises(NgException, match=r"bits for .* macro-elements"):
            contact.form.Close(bits, vec)
