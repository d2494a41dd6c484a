"""Laws as expressions of the contact's fields; their derivatives: test_laws.py."""

import numpy as np
import pytest
from blocks import block_mesh, contact_form
from ngsolve import (
    CF,
    IfPos,
    InnerProduct,
    Norm,
    Parameter,
    VectorH1,
    exp,
    x,
)
from posed import elastic, posed

from ngslac import (
    Law,
)
from ngslac.meshes import TwoBlocks


def soft(fields):
    """A pressure by the square of the overlap, and a drag by the speed."""
    return -IfPos(fields.gap, 0, 30 * fields.gap**2) * fields.normal - 2 * fields.rate


def by_the_trial(fields):
    size = InnerProduct(fields.jump, fields.jump)
    return 0.3 * fields.trial - (5 + size) * fields.jump


def coulomb(fields):
    pressure = -InnerProduct(fields.trial, fields.normal)
    along = fields.trial + pressure * fields.normal
    slides = 0.3 * pressure / Norm(along) * along - pressure * fields.normal
    held = IfPos(0.3 * pressure - Norm(along), fields.trial, slides)
    return IfPos(pressure, held, 0 * fields.normal)


def torn(fields):
    """Glue that has the larger part of its stiffness lost where it was far apart once."""
    size = Norm(fields.jump)
    farthest = fields.History("farthest", lambda f: IfPos(size - f, size, f), start=1e-3)
    return -50 * exp(-(farthest - 1e-3) / 0.05) * fields.jump


def pulled(law, *, down=-5e-3, aside=0.0, tied=True, **options):
    """Two blocks with nu = 0, of which the upper one is moved by a load up to 1; a stepper."""
    mesh = TwoBlocks(0.3)
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    load = Parameter(0)
    held = {"top": CF((aside * load, -down * load)), "bottom": CF((0, 0))}
    problem = posed(V, elastic(100), load=load, tied=tied, law=Law(law), **options)
    return problem.stepper(prescribe=held)


@pytest.mark.parametrize("finite", [False, True])
def test_springs_in_series(finite):
    """A soft layer between two blocks of stiffness 100 each: closed form, few iterations."""
    stepper = pulled(lambda z: -20 * z.gap * z.normal * -1, down=5e-3, tied=False, finite=finite)
    steps = stepper.Integrate(1, steps=1, printing=False)
    contact = stepper.solver.contacts[0]
    force = 5e-3 / (2 / 100 + 1 / 20)
    assert contact.Force()[1] == pytest.approx(force, rel=2e-4 if finite else 1e-9)
    assert steps[0].iterations <= (4 if finite else 2)


def test_glue_softens_and_goes_back_on_a_line():
    """Beyond its strength; what is unloaded knows how far apart it was."""
    stepper = pulled(torn, down=-0.08)
    stepper.Integrate(1, steps=20, printing=False)
    contact = stepper.solver.contacts[0]
    table = contact.Table()
    far = table["farthest"]
    stiffness = 50 * np.exp(-(far - 1e-3) / 0.05)
    assert np.abs(table["traction"][:, 1]) == pytest.approx(stiffness * far, rel=1e-6)
    half = stepper.Integrate(0.5, steps=1, printing=False)
    assert half[-1].iterations <= 2  # linear
    after = contact.Table()
    assert np.array_equal(after["farthest"], far)
    jump = np.abs(after["traction"][:, 1]) / stiffness
    assert np.all(jump < far)


def test_the_tail_of_newtons_method_is_quadratic():
    stepper = pulled(soft, down=0.02, aside=0.01, tied=False)
    stepper.Integrate(1, steps=1, printing=False)
    errors = [max(e.equilibrium, e.constraint) for e in stepper.solver.history]
    errors = [e for e in errors if e > 1e-13]
    rates = [np.log(b) / np.log(a) for a, b in zip(errors[-3:], errors[-2:], strict=False)]
    assert max(rates) > 1.5


def test_a_law_knows_the_place_and_parameters():
    stiffness = Parameter(10.0)
    stepper = pulled(lambda z: stiffness * (1 + x) * z.gap * z.normal, down=5e-3, tied=False)
    stepper.Integrate(1, steps=1, printing=False)
    contact = stepper.solver.contacts[0]
    first = contact.Table()
    expected = 10 * (1 + first["x"][:, 0]) * -first["gap"]
    assert first["pressure"] == pytest.approx(expected, rel=1e-2)  # the law is evaluated in middles
    stiffness.Set(20.0)
    stepper.solver.Solve(printing=False)
    assert contact.Force()[1] > 1.2 * (first["pressure"] * first["area"]).sum()


@pytest.mark.parametrize(("law", "words"), [
    (3, "traction = 3 must be a function of fields"),
    (None, "traction = None must be a function of fields"),
    (lambda z: z.gap, "the traction of a Law must have 2 components"),
    (lambda z: None, "the traction of a Law must have 2 components"),
    (lambda z: z.pressure * z.normal, "there is no field 'pressure' here: there are slip, gap"),
])  # fmt: skip
def test_refused(law, words):
    with pytest.raises((TypeError, ValueError, AttributeError), match=words):
        contact_form(block_mesh(2), law=Law(law))


def test_the_class_is_no_law():
    with pytest.raises(TypeError, match="not a class: give an object of it"):
        contact_form(block_mesh(2), law=Law)


def test_glue_has_no_gap():
    with pytest.raises(AttributeError, match="there is no field 'gap' here: there are jump"):
        contact_form(block_mesh(2), tied=True, law=Law(soft))
