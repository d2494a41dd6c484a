"""Coefficients that are functions of the contact's own fields: derivatives, laws, histories."""

import math

import numpy as np
import pytest
from blocks import C, block_mesh, contact_form
from netgen.meshing import NgException
from netgen.occ import OCCGeometry, Rectangle, Y
from ngsolve import (
    CF,
    GridFunction,
    IfPos,
    Mesh,
    Norm,
    Parameter,
    VectorH1,
    ds,
    dx,
    exp,
    sin,
    x,
)
from posed import elastic, posed

from ngslac import (
    ContactConvergenceError,
    Law,
    TimeStepper,
    tools,
)
from ngslac.meshes import TwoBlocks


def falling(fields):
    return 0.2 + 0.2 * exp(-Norm(fields.rate) / 0.3)


def hardening(fields):
    return 0.25 + 0.05 * fields.pressure + 0.3 * fields.gap * fields.gap


def placed(fields):
    return 0.3 + 0.1 * sin(x + fields.slip[0])


def remembering(fields):
    return 0.2 + 0.1 * exp(-fields.History("way", lambda way: way + Norm(fields.slip)))


def worn(fields):
    return fields.History("worn", lambda w: w + 0.02 * fields.pressure * Norm(fields.slip))


def bound(fields):
    return 0.2 + 0.1 * fields.pressure + 0.1 * Norm(fields.slip)


LAWS = {
    "rate": {"friction": falling},
    "pressure": {"friction": hardening},
    "place": {"friction": placed},
    "way": {"friction": remembering},
    "bound": {"tresca": bound, "friction": 0.9},
    "wear": {"offset": worn},
    "wear with friction": {"offset": worn, "friction": falling},
}


def sheared(way=0.1, down=0.02, nu=0.3, order=2, mesh=None, **law):
    """An upper block is pressed down and pushed aside; a LoadStepper up to 1."""
    mesh = TwoBlocks(0.25) if mesh is None else mesh
    V = VectorH1(mesh, order=order, dirichlet="bottom|top")
    problem = posed(V, elastic(100, nu), load=Parameter(0), **law)
    held = {"top": CF((way * problem.load, -down)), "bottom": CF((0, 0))}
    return problem.stepper(prescribe=held)


@pytest.mark.filterwarnings("ignore:the slave has slid")
@pytest.mark.parametrize("finite", [False, True])
def test_the_law_holds_where_it_has_converged(finite):
    """Friction of the slip per load, at the end of each step."""
    law = lambda f: 0.1 + 0.02 * f.pressure + 0.05 * exp(-Norm(f.rate) / 0.2)  # noqa: E731
    stepper = sheared(friction=law, finite=finite)
    contact = stepper.solver.contacts[0]
    for goal in (0.2, 0.5, 1.0):
        before = stepper.load.Get()
        stepper.Integrate(goal, steps=1, printing=False)
        table = contact.Table()
        rate = np.linalg.norm(table["slip"], axis=1) / (goal - before)
        expected = 0.1 + 0.02 * table["pressure"] + 0.05 * np.exp(-rate / 0.2)
        closed = table["status"] > 0
        assert table["friction"][closed] == pytest.approx(expected[closed], rel=1e-7)
        slips = table["status"] == 2
        across = table["traction"] + table["pressure"][:, None] * table["normal"]
        size = np.linalg.norm(across, axis=1)
        assert np.any(slips)
        assert size[slips] == pytest.approx(expected[slips] * table["pressure"][slips], rel=1e-6)


# --- wear ----------------------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore:the slave has slid")
def test_a_step_that_is_cut_wears_once(monkeypatch):
    plain, cut = sheared(offset=worn), sheared(offset=worn)
    solve, fails = cut.solver.Solve, [True]

    def hard(**options):
        last = solve(**options)
        if fails:
            fails.pop()
            raise ContactConvergenceError("hard")
        return last

    monkeypatch.setattr(cut.solver, "Solve", hard)
    steps = cut.Integrate(1, steps=1, printing=False)
    assert sum(step.cuts for step in steps) == 1
    ends = [step.time for step in steps]
    for goal in ends:
        plain.Integrate(goal, steps=1, printing=False)
    found, expected = (s.solver.contacts[0].Table()["worn"] for s in (cut, plain))
    assert found == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("give", [0.1, 10.0, 1e3])
def test_a_surface_that_gives_more_than_the_body(give, finite):
    """A block on a layer that is far softer: pressures on the way are much too large at times."""
    mesh = TwoBlocks(0.5)
    V = VectorH1(mesh, order=2, dirichlet="bottom", dirichletx=".*left.*|.*right.*")
    law = {"finite": finite, "offset": lambda z: give * z.pressure}
    problem = posed(V, elastic(1.0), lambda u, v, load: 1e-3 * v[1] * ds("top"), **law)
    assert problem.solver().Solve(printing=False).number <= 12
    table = problem.contact.Table()
    assert table["pressure"] == pytest.approx(np.full(len(table["gap"]), 1e-3), rel=0.05)
    assert np.abs(table["gap"]).max() < 1e-9 * max(1, give * 1e-3)


@pytest.mark.parametrize("dt", [0.01, pytest.param(0.002, marks=pytest.mark.full)])
@pytest.mark.parametrize("finite", [False, True])
def test_wear_in_time(finite, dt):
    """A block slides on what it wears off, and falls with it: mass/(rate v) dp/dt = weight - p."""
    rate, weight, end = 0.02, 10.0, 0.1
    block = Rectangle(1, 0.5).Face()
    block.edges.name = "side"
    block.edges.Min(Y).name = "slave"
    mesh = Mesh(OCCGeometry(block, dim=2).GenerateMesh(maxh=0.5))
    V = VectorH1(mesh, order=2)

    def worn(z):
        return z.History("worn", lambda w: w + rate * z.pressure * Norm(z.slip))

    floor = tools.Plane((0, 0), (0, 1)) if finite else 0.0
    problem = posed(
        V,
        elastic(1e5),
        lambda u, v, load: 2 * weight * v[1] * dx,
        obstacle=floor,
        finite=finite,
        offset=worn,
    )
    contact = problem.contact
    problem.gf.components[0].Set((0, -1e-5))
    stepper = TimeStepper(problem.solver(), 2.0, dt=dt, rho_inf=0.5)
    stepper.velocity.components[0].Set((1, 0))
    stepper.Integrate(end, printing=False)
    table = contact.Table()
    expected = rate * weight * (end - rate * (1 - math.exp(-end / rate)))
    assert (table["worn"] * table["area"]).sum() == pytest.approx(expected, rel=5e-3)
    assert contact.Force()[1] == pytest.approx(weight, rel=0.01)


# --- what does not fit ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("law", "match"),
    [
        ({"friction": lambda z: 0.1 * z.pressure**0.5}, r"friction\(z\).*exp\(a \* log"),
        ({"friction": lambda z: 0.1 + z.slip}, r"friction\(z\).*a vector and a number"),
        ({"offset": lambda z: z.History("way", lambda w: w + z.slip)}, "History of way.*number"),
        ({"law": Law(lambda z: z.jump + z.gap)}, "traction of a Law"),
        ({"law": Law(lambda z: (0, z.gap))}, "CF of numbers: return it"),
        ({"friction": lambda z: 0.3 if z.pressure > 1 else 0.2}, r"friction\(z\).*IfPos"),
        ({"friction": lambda z: np.exp(z.pressure)}, r"friction\(z\).*those of ngsolve"),
    ],
)
def test_what_cannot_be_differentiated(law, match):
    with pytest.raises(ValueError, match="(?s)" + match):
        contact_form(block_mesh(2), **law)


@pytest.mark.parametrize("finite", [False, True])
def test_an_offset_that_depends_beside_a_law(finite):
    law = Law(lambda z: IfPos(z.gap, 0, z.gap) * z.normal)
    with pytest.raises(ValueError, match=r"law of your own says all.*offset"):
        contact_form(block_mesh(2), finite=finite, law=law, offset=lambda z: 0.1 * z.pressure)


def test_an_offset_that_looks_at_the_gap():
    """The gap holds the offset."""
    with pytest.raises(ValueError, match=r"offset.*z\.gap"):
        contact_form(block_mesh(2), offset=lambda z: 0.1 * z.gap)


@pytest.mark.parametrize(("law", "words"), [
    ({"friction": lambda f: f.slip}, r"friction\(z\) has 2 components"),
    ({"friction": lambda f: "much"}, r"friction\(z\) = 'much' must be a finite number >= 0"),
    ({"friction": lambda f: -1}, r"friction\(z\) = -1 must be a finite number >= 0"),
    ({"friction": lambda f: None}, r"friction\(z\) = None must be"),
    ({"offset": lambda f: f.History("gap", lambda w: w)}, "History has 'gap', which means"),
    ({"offset": lambda f: f.History("worn", 3)}, "update = 3 must be a function of what"),
    ({"offset": lambda f: f.History("w", lambda w: w, start=[1, 2])}, r"start = \[1, 2\] must be"),
    ({"offset": lambda f: f.History("w", lambda w: CF((w, w)))}, "History of w has 2 comp"),
    ({"offset": lambda f: f.History("w", lambda w: w) + f.History("w", lambda w: w)},
     "'w' is kept already"),
    ({"offset": lambda f: f.History("", lambda w: w)}, "name = '' must be a word"),
    ({"friction": falling, "edges": True}, "edges need a friction that is no function"),
    ({"friction": falling, "tied": True}, "tied surfaces do not slide"),
])  # fmt: skip
def test_refused(law, words):
    with pytest.raises((TypeError, ValueError), match=words):
        contact_form(block_mesh(2), **law)


@pytest.mark.parametrize(("law", "words"), [
    (lambda f: f.gap - 100, "friction is -.* must be a number >= 0"),
    (lambda f: 1 / (0 * f.pressure), "friction is (inf|nan)"),
])  # fmt: skip
def test_values_that_are_none(law, words):
    contact = contact_form(block_mesh(2), friction=law)
    with pytest.raises(NgException, match=words):  # at the pairing no field is known
        contact.Evaluate(GridFunction(contact.form.fes))


def test_after_a_refinement_the_fields_fit():
    mesh = block_mesh(2)
    contact = contact_form(mesh, friction=falling, offset=worn)
    mesh.Refine()
    contact.form.fes.Update()
    contact.Update()
    contact.form.SetConstant(C)
    contact.Evaluate(GridFunction(contact.form.fes))
    assert len(contact.Table()["worn"]) == contact.space.nmacros
