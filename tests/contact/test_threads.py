"""The order in which threads arrive leaves no trace, not even in the last bits."""

import numpy as np
import pytest
from blocks3d import block_mesh, contact_form, random_state, residual
from ngsolve import GridFunction, SetNumThreads, TaskManager, x


@pytest.fixture(scope="module")
def mesh():
    return block_mesh(n_slave=4, n_master=3)


def in_threads(n, f):
    SetNumThreads(n)
    with TaskManager():
        return f()


@pytest.mark.parametrize("flags", [{}, {"finite": True}])
def test_results_are_the_same_to_the_last_bit(mesh, flags):
    def run():
        contact = contact_form(mesh, friction=0.3 + 0.01 * x, **flags)
        state = 0.01 * random_state(contact)
        contact.AssembleLinearization(GridFunction(contact.form.fes).vec)
        return contact.Table()["friction"].tobytes(), residual(contact, state).tobytes()

    threads = [1, 2, 2, 2, 3]
    try:
        results = {in_threads(n, run) for n in threads}
    finally:
        SetNumThreads(1)
    assert len(results) == 1


def test_the_mean_of_a_constant_is_it(mesh):
    contact = contact_form(mesh, friction=0.3)
    assert contact.Table()["friction"] == pytest.approx(np.full(contact.space.nmacros, 0.3))
