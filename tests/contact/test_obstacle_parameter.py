"""Rigid obstacles that move with a Parameter, or with another function."""

import numpy as np
import pytest
from blocks import C, block_mesh, contact_form, matrix, moved, random_state, residual, vector
from ngsolve import CF, H1, BitArray, GridFunction, Parameter, x


def gaps(contact, state):
    contact.form.Evaluate(vector(contact, state))
    return contact.Table()["gap"]


@pytest.fixture(scope="module")
def mesh():
    return block_mesh(2, 0.25)


def test_a_moving_obstacle_is_where_its_parameter_says(mesh):
    t = Parameter(0.0)
    contact = contact_form(mesh, obstacle=0.1 * x - t, friction=0.3)
    state = random_state(contact)
    for value in (0.0, 0.3, -0.2):
        t.Set(value)
        still = contact_form(mesh, obstacle=0.1 * x - CF(value), friction=0.3)
        for f in (residual, gaps, matrix):
            assert np.array_equal(f(contact, state), f(still, state))
        assert np.array_equal(contact.Segments().gap, still.Segments().gap)


def test_a_constant_function_of_a_gridfunction_follows_it(mesh):
    field = GridFunction(H1(mesh, order=1))
    contact = contact_form(mesh, obstacle=field)
    before = gaps(contact, 0.0)
    field.vec[:] = 0.25
    assert gaps(contact, 0.0) - before == pytest.approx(0.25)


def test_restore_takes_back_the_obstacle(mesh):
    t = Parameter(0.1)
    contact = contact_form(mesh, obstacle=-t)
    gf = GridFunction(contact.form.fes)
    contact.Evaluate(gf)
    contact.Commit(gf)
    t.Set(0.3)
    assert gaps(contact, 0.0) == pytest.approx(-0.3)
    t.Set(0.1)
    contact.Restore()
    assert contact.Table()["gap"] == pytest.approx(-0.1)
    assert contact.Segments().gap == pytest.approx(-0.1)
    contact.form.Close(BitArray(contact.space.nmacros * [True]), gf.vec)  # it uses the restored gap
    normals = contact.Table()["normal"]
    pressure = -np.sum(gf.components[1].vec.FV().NumPy().reshape(-1, 2) * normals, axis=1)
    assert pressure == pytest.approx(0.1 * C, rel=1e-4)
    t.Set(0.3)
    assert gaps(contact, 0.0) == pytest.approx(-0.3)


def first_touch(contact):
    """Tangential parts of the points from which slip counts."""
    reference = contact.form.Table()["reference"]
    normal = contact.Table()["normal"]
    return reference - np.sum(reference * normal, axis=1)[:, None] * normal


def test_the_approach_of_the_obstacle_counts_for_the_first_touch(mesh):
    """After a block rests above a rising obstacle, slip in the step of the touch counts fully."""
    t = Parameter(-0.3)
    contact = contact_form(mesh, obstacle=-t, friction=0.5)
    for value in (-0.2, -0.1):
        t.Set(value)
        contact.Commit(GridFunction(contact.form.fes))
    assert first_touch(contact) == pytest.approx(0, abs=1e-14)
    t.Set(-0.05)  # the obstacle comes nearer while the block moves aside
    contact.Commit(moved(contact, (0.1, 0.0), (0.1, 0.0)))
    normal = contact.Table()["normal"]
    aside = np.array([0.1, 0]) - normal[:, :1] * 0.1 * normal
    # The gap of 0.1 closes by 0.05 plus the approach of the block; `left` is the rest of it.
    left = 0.05 - 0.1 * normal[:, :1]
    assert first_touch(contact) == pytest.approx(aside * (1 + left / (0.05 + 0.1 * normal[:, :1])))


def test_a_wrong_value_of_the_parameter_names_the_place(mesh):
    t = Parameter(0.0)
    contact = contact_form(mesh, obstacle=t * x)
    t.Set(np.inf)
    with pytest.raises(Exception, match=r"the gap to the obstacle is -?inf at \("):
        residual(contact, 0.0)
    t.Set(0.0)
    assert np.all(np.isfinite(residual(contact, 0.0)))
