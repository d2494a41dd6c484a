"""A strain-free start: gaps and overlaps of the meshes that count as zero."""

import numpy as np
import pytest
from blocks import C, block_mesh, contact_form, moved, residual
from form import Form
from ngsolve import x

LIMIT = 0.06


def gaps(contact, gf):
    contact.Evaluate(gf)
    return contact.Table()["gap"].copy()


def pair(dim, up, **law):
    """A contact that is paired with the upper block moved by `up` along the interface's normal."""
    mesh = block_mesh(dim, **({"angle": 0.0} if dim == 2 else {"shape": "flat", "rotation": None}))
    contact = contact_form(mesh, **law)
    way = lambda size: tuple(size * np.eye(dim)[-1])  # noqa: E731
    contact.Update(moved(contact, way(up)))
    contact.form.SetConstant(C)
    return contact, lambda size: moved(contact, way(size))


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("up", [0.05, -0.05])
@pytest.mark.parametrize("dim", [2, 3])
def test_small_gaps_and_overlaps_count_as_zero(dim, up, finite):
    contact, at = pair(dim, up, adjust=LIMIT, finite=finite)
    paired = contact.Table()["area"] > 0
    assert np.any(paired)
    assert np.nan_to_num(contact.Table()["gap"]) == pytest.approx(0, abs=1e-14)
    for more in (0.03, -0.04):
        gf = at(up + more)
        contact.Follow(gf)
        assert gaps(contact, gf)[paired] == pytest.approx(more, abs=1e-13)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("up", [0.07, -0.07])
def test_larger_ones_stay(up, finite):
    contact, at = pair(2, up, adjust=LIMIT, finite=finite)
    assert gaps(contact, at(up))[contact.Table()["area"] > 0] == pytest.approx(up, abs=1e-14)


@pytest.mark.parametrize("finite", [False, True])
def test_each_macro_element_on_its_own(finite):
    """A wedge: what is near is adjusted; the offset is added to that."""
    contact = contact_form(block_mesh(2, 0.1, angle=0.0), adjust=LIMIT, offset=0.01, finite=finite)
    plain = contact_form(block_mesh(2, 0.1, angle=0.0), finite=finite)
    wedge = (0.0, 0.2 * x - 0.05)
    for one in (contact, plain):
        one.Update(moved(one, wedge))
    found, initial = (one.Table()["gap"] for one in (contact, plain))
    paired, near = plain.Table()["area"] > 0, np.abs(initial) <= LIMIT
    assert np.any(near & paired)
    assert np.any(~near)
    expected = np.where(near, 0.01, initial + 0.01)
    assert found[paired] == pytest.approx(expected[paired], abs=1e-13)


def test_on_an_obstacle():
    contact = contact_form(block_mesh(2), obstacle=0.1 * x, adjust=0.03)
    plain = contact_form(block_mesh(2), obstacle=0.1 * x)
    initial = plain.Table()["gap"]
    near = np.abs(initial) <= 0.03
    assert np.any(near)
    assert np.any(~near)
    assert contact.Table()["gap"] == pytest.approx(
        np.where(near, 0, initial), abs=1e-14, nan_ok=True
    )


@pytest.mark.parametrize("finite", [False, True])
def test_overlaps_are_found_as_deep_as_they_are_adjusted(finite):
    contact, _ = pair(2, -0.05, adjust=LIMIT, penetration=0.001, finite=finite)
    assert np.any(contact.Table()["area"] > 0)
    with pytest.raises(Exception, match=r"penetration = 0\.001"):
        pair(2, -0.05, penetration=0.001, finite=finite)


@pytest.mark.parametrize("finite", [False, True])
def test_a_saved_state_remembers_what_was_adjusted(finite):
    """Also where bodies have slid on since: the start is not that of the saved step."""
    law = {"adjust": LIMIT, "finite": finite, "friction": 0.3}
    contact, at = pair(2, 0.05, **law)
    gf = at(0.04)
    contact.Commit(gf)
    other, _ = pair(2, 0.05, **law)
    other.SetState(contact.State())
    state = 0.01 * np.random.default_rng(0).normal(size=contact.nscalars) + gf.vec.FV().NumPy()
    assert residual(other, state) == pytest.approx(residual(contact, state), abs=1e-13)
    assert other.Table()["gap"] == pytest.approx(contact.Table()["gap"], abs=1e-13, nan_ok=True)


def test_derivative():
    form = Form(contact_form(block_mesh(2), finite=True, adjust=0.5, friction=0.7))
    form.bend(0.05, 0.0, degrees=30)
    form.contact.Update(form.gf)
    form.contact.form.SetConstant(C)
    form.bend(0.08, 0.1, degrees=50)
    form.follow()
    form.impose(0.7)
    assert form.derivative_error(40) <= 1e-8
