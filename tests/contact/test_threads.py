"""The order in which threads arrive leaves no trace, not even in the last bits."""

import numpy as np
import pytest
from blocks import random_state, residual, vector
from blocks3d import block_mesh, contact_form
from ngsolve import GridFunction, SetNumThreads, TaskManager, x


@pytest.fixture(scope="module")
def mesh():
    """One master face has several macro-elements: threads meet in the rows of its dofs."""
    return block_mesh(n_slave=3, n_master=1)


def in_threads(n, f):
    SetNumThreads(n)
    with TaskManager():
        return f()


def matrix(contact):
    return contact.form.mat.AsVector().FV().NumPy().tobytes()


@pytest.mark.parametrize("flags", [{}, {"finite": True}])
def test_results_are_the_same_to_the_last_bit(mesh, flags):
    def run():
        contact = contact_form(mesh, friction=0.3 + 0.01 * x, **flags)
        state = 0.01 * random_state(contact)
        contact.AssembleLinearization(GridFunction(contact.form.fes).vec)  # makes the matrix
        at, forces = vector(contact, state), vector(contact)
        contact.AssembleLinearization(at)
        derivative = matrix(contact)
        contact.form.AssembleStep(at, forces)
        parts = contact.Table()["friction"], residual(contact, state), forces.FV().NumPy()
        return [derivative, matrix(contact), *(part.tobytes() for part in parts)]

    try:
        results = [in_threads(n, run) for n in (1, 2, 4)]
    finally:
        SetNumThreads(1)
    for other in results[1:]:
        assert results[0] == other


def test_the_mean_of_a_constant_is_it(mesh):
    contact = contact_form(mesh, friction=0.3)
    assert contact.Table()["friction"] == pytest.approx(np.full(contact.space.nmacros, 0.3))
