"""States of a contact: put back as they were, whatever their layout, or refused as a whole."""

import continued
import numpy as np
import pytest
from interrupts import same, seen
from netgen.meshing import NgException

from ngslac import LACContact


@pytest.fixture(params=[False, True], ids=["small", "finite"])
def stepper(request):
    return continued.half(continued.loading(finite=request.param), 1)


def test_an_unpaired_state(stepper):
    """Back before the first pairing: nothing of it is left."""
    (contact,) = stepper.solver.contacts
    contact.SetState({"paired": None, "scaled": False})
    assert not contact.form.paired
    assert not np.any(contact.pressure.vec.FV().NumPy())
    with pytest.raises(NgException, match="no pairing yet"):
        contact.Force()
    stepper.solver.Solve(printing=False)
    assert contact.Force()[1] > 0


def test_a_strided_state(stepper):
    (contact,) = stepper.solver.contacts
    before = seen(stepper)
    strided = {
        name: np.repeat(value, 2)[::2] if isinstance(value, np.ndarray) else value
        for name, value in contact.State().items()
    }
    contact.SetState(strided, stepper.solver.gf)
    assert same(before, seen(stepper)) == set(before)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"memory": np.zeros(1)}, "memory"),
        ({"c": np.zeros(0)}, "'c'"),
        ({"paired": np.ones(3)}, r"state\['paired'\] has 3 entries"),
        ({"accepted": None}, "."),
        ({"states": "text"}, r"state\['states'\] = 'text' must be what State\(\) returned there"),
        ({"scaled": None}, r"state\['scaled'\] = None must be what State"),
    ],
)
def test_a_state_that_does_not_fit_changes_nothing(stepper, wrong, message):
    (contact,) = stepper.solver.contacts
    before = seen(stepper)
    with pytest.raises((TypeError, ValueError, NgException), match=message):
        contact.SetState(contact.State() | wrong, stepper.solver.gf)
    assert same(before, seen(stepper)) == set(before)


def test_a_state_of_a_solver_that_does_not_fit_changes_nothing(stepper):
    """Not even the solution, which comes first."""
    solver, before = stepper.solver, seen(stepper)
    state = solver.State()
    parts = [state["contacts"][0] | {"memory": np.zeros(1)}]
    with pytest.raises((ValueError, NgException), match="memory"):
        solver.SetState(state | {"gf": 2 * state["gf"], "contacts": parts})
    assert same(before, seen(stepper)) == set(before)


def test_a_state_without_its_keys(stepper):
    (contact,) = stepper.solver.contacts
    for state in ({}, {"paired": None}, 3):
        with pytest.raises((TypeError, ValueError), match="state"):
            LACContact.SetState(contact, state)


def test_the_step_before_the_space_was_refined(stepper):
    """The stepper is of no use then, and says so; nothing crashes."""
    space = stepper.solver.gf.space
    space.mesh.Refine()
    space.Update()
    stepper.solver.gf.Update()
    with pytest.raises((ValueError, NgException), match="refine"):
        stepper.Integrate(0.6, printing=False)
    assert stepper.load.Get() == 0.5
