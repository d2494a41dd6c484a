"""What public objects say of themselves."""

import continued
import pytest
from ngsolve import CF

from ngslac import FormSum, LACContact


@pytest.fixture(scope="module")
def stepper():
    return continued.half(continued.loading(finite=True), 1)


def test_a_contact(stepper):
    (contact,) = stepper.solver.contacts
    said = f"<LACContact: {contact.space.nmacros} macro-elements of 'slave' against 'master', "
    assert repr(contact) == said + "Coulomb friction, large sliding>"


@pytest.mark.parametrize(
    ("law", "words"),
    [({}, "frictionless"), ({"tied": True}, "tied"), ({"tresca": CF(2)}, "Tresca friction")],
)
def test_a_contact_that_is_not_paired(stepper, law, words):
    (u, lam), _ = stepper.solver.gf.space.TnT()
    said = repr(LACContact(u, lam, obstacle=CF(1), **law))
    assert said.endswith(f" against an obstacle, {words}, not paired yet>")


def test_a_solver_says_what_it_solves_and_how(stepper):
    said = repr(stepper.solver)
    assert said.startswith("<ContactSolver: <LACContact: ")
    assert str(stepper.solver.linear) in said
    form = FormSum(stepper.solver.a, stepper.solver.contacts[0])
    assert repr(form).endswith(f" and {stepper.solver.contacts[0]!r}>")


def test_steppers_say_where_they_are(stepper):
    assert repr(stepper) == "<LoadStepper: load 0.5 after 3 steps>"
    motion = continued.half(continued.bouncing(), 1)
    assert repr(motion) == f"<TimeStepper: time 0.5 after {len(motion.steps)} steps, dt = 0.04>"


def test_what_is_known_of_a_contact(stepper):
    (contact,) = stepper.solver.contacts
    assert repr(contact.Check()) == str(contact.Check())
    segments = contact.Segments()
    assert repr(segments) == f"<Segments: {len(segments)} with the area {segments.area.sum():g}>"
