"""What public objects say of themselves; none of them can be copied or pickled."""

import copy
import pickle

import continued
import pytest
from ngsolve import CF

from ngslac import BubbleVectorH1, FormSum, LACContact, TimeStepper


@pytest.fixture(scope="module")
def stepper():
    return continued.half(continued.loading(finite=True))


@pytest.mark.parametrize(
    ("law", "words"),
    [
        ({}, "frictionless"),
        ({"tied": True}, "tied"),
        ({"bilateral": True}, "bilateral"),
        ({"tresca": CF(2)}, "Tresca friction"),
    ],
)
def test_a_contact_that_is_not_paired(stepper, law, words):
    u, lam = stepper.solver.gf.space.TrialFunction()
    said = repr(LACContact(u, lam, obstacle=CF(1), **law))
    assert said.endswith(f" against an obstacle, {words}, not paired yet>")


def test_what_objects_say(stepper):
    solver = stepper.solver
    (contact,) = solver.contacts
    said = f"<LACContact: {contact.space.nmacros} macro-elements of 'slave' against 'master', "
    assert repr(contact) == said + "Coulomb friction, large sliding>"
    assert repr(solver).startswith("<ContactSolver: <LACContact: ")
    assert str(solver.linear) in repr(solver)
    assert repr(FormSum(solver.a, contact)).endswith(f" and {contact!r}>")
    assert repr(stepper) == "<LoadStepper: load 0.5 after 3 steps>"
    motion = continued.half(continued.bouncing())
    assert repr(motion) == f"<TimeStepper: time 0.5 after {len(motion.steps)} steps, dt = 0.04>"
    assert repr(contact.Check()) == str(contact.Check())
    assert repr(contact.space) == f"<LACSpace: {contact.space.nmacros} macro-elements of 'slave'>"
    V = BubbleVectorH1(contact.space.mesh, order=1, slave="slave|master")
    assert repr(V) == f"<BubbleVectorH1: {V.ndof} dofs, with bubbles on 'master', 'slave'>"
    segments = contact.Segments()
    assert repr(segments) == f"<Segments: {len(segments)} with the area {segments.area.sum():g}>"


def test_copies_are_refused():
    stepper = continued.loading()
    solver = stepper.solver
    moving = TimeStepper(solver, 1.0, dt=0.1)
    for thing in (*solver.contacts, solver, FormSum(solver.a, *solver.contacts), stepper, moving):
        for make in (copy.copy, copy.deepcopy, pickle.dumps):
            with pytest.raises(TypeError, match="can be neither pickled nor copied"):
                make(thing)
    with pytest.raises(TypeError, match="a ContactSolver, of the static problem"):
        TimeStepper(moving.solver, 1.0, dt=0.1)
