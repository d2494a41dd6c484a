"""Tutorial 03, three dimensions, runs, and what it computes is right."""

import re

import numpy as np
import pytest
from notebooks import SPACE, Files, Tutorial

RECORD = {'print("reaction"': 'partial = contact.Table()\nprint("reaction"'}
space = Tutorial(SPACE, """
def State(table, force):
    hertz = HertzPoint(force=2 * force, radius1=R, **material)
    radius = sqrt(x * x + y * y) / hertz.contact_radius
    exact = hertz.peak * IfPos(1 - radius, sqrt(IfPos(1 - radius, 1 - radius**2, 0)), 0)
    means = np.bincount(number, Integrate(exact, mesh, BND, element_wise=True).NumPy()[onslave])
    return dict(
        area=table["area"], pressure=table["pressure"], hertz=means / table["fullarea"],
        status=table["status"], force=force, x=table["x"],
        friction=table["traction"] + table["pressure"][:, None] * table["normal"],
        p0=hertz.peak, radius=hertz.contact_radius,
    )


def Pressed(name):
    contact = states[name][1]
    return State(contact.Table(), contact.Force()[2])


def OnSlave(contact):
    macros = np.array(contact.space.macros)
    return macros >= 0, macros[macros >= 0]


onslave, number = OnSlave(states["order 2, bubbles"][1])
bubbles = Pressed("order 2, bubbles")
onslave, number = OnSlave(contact)
VALUES = dict(
    F=F, rows=np.array(rows), resultant=resultant, reaction=np.array(reaction), bubbles=bubbles,
    partial=State(partial, resultant[2]), sliding=State(contact.Table(), contact.Force()[2]),
    split=states["order 1, split mesh"][1].Force()[2], theory=[force, shift],
    faces=np.bincount(number), iterations=[step.iterations for step in stepper.steps],
)
""", pictures=3, replace=RECORD)  # fmt: skip


def test_macro_elements(space):
    assert re.search(r"order 3: \d+ macro-elements of 1 to 1 triangles", space.text)
    assert "no macro-element can be made" in space.text  # of single triangles with order 2
    counts = np.bincount(space.faces)
    assert counts[:2].sum() == 0
    assert counts[2] > 0.9 * counts.sum()  # pairs, and few with a third triangle


def test_states(space):
    partial, sliding = space.partial, space.sliding
    assert np.bincount(partial["status"], minlength=3).min() > 5
    assert 1 not in sliding["status"]
    r = np.hypot(*partial["x"].T[:2])
    assert r[partial["status"] == 1].max() < r[partial["status"] == 0].min()
    assert partial["friction"][partial["status"] > 0, 0].max() < 0  # against the push
    # The plane of symmetry takes its share of the force in y.
    np.testing.assert_allclose(space.reaction[::2], -space.resultant[::2], rtol=1e-10)


@pytest.mark.parametrize(("name", "tol"), [("partial", 0.17), ("bubbles", 0.12)])
def test_pressure(space, name, tol):
    """In the L2 norm: five elements across the radius, a closed macro-element is closed whole."""
    state = getattr(space, name)
    area, error, exact = state["area"], state["pressure"] - state["hertz"], state["hertz"]
    assert 1.01 < state["pressure"].max() / state["p0"] < 1.025
    assert area @ error**2 < tol**2 * (area @ exact**2)
    inner = np.hypot(*state["x"].T[:2]) < 0.7 * state["radius"]
    assert inner.sum() > 15
    np.testing.assert_allclose(state["pressure"][inner], exact[inner], rtol=0.06)


def test_ways_to_macro_elements(space):
    bubbles = space.bubbles
    assert bubbles["force"] == pytest.approx(space.rows[0, 2] / 2, rel=0.01)
    assert space.split / bubbles["force"] == pytest.approx(1.2, abs=0.03)
    q, x = (bubbles[name][:, :2] for name in ("friction", "x"))
    assert np.sum(bubbles["area"] * np.sum(q * x, axis=1)) > 0  # points outwards


def test_friction_force(space):
    """The curve of Mindlin, whose compliance comes from the first step."""
    push, shear, normal, stick, slip = space.rows.T
    (force, shift), limit = space.theory, space.F * normal[0]
    assert space.iterations.max() <= 6
    np.testing.assert_allclose(push, [0, 0.0035, 0.007, 0.0105, 0.014, 0.018, 0.022])
    np.testing.assert_allclose(shear[:-1], np.interp(push[:-1], shift, force), atol=0.01 * limit)
    assert push[-1] > shift[-1]
    assert 1 < shear[-1] / limit < 1.01
    expected = (1 - shear[1:-1] / limit) ** (1 / 3)
    np.testing.assert_allclose(np.sqrt(stick / (stick + slip))[1:-1], expected, atol=0.1)


def test_files(space):
    names = ["punch.vtu", "punch_contact.vtu", "punch_segments.vtu"]
    assert Files(space.folder, "*.vtu") == names
