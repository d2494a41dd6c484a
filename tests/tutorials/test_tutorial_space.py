"""Tutorial 03, three dimensions, runs, and what it computes is right."""

import re

import numpy as np
import pytest
from notebooks import SPACE, Errors, Execute, Pictures

pytestmark = pytest.mark.slow

RECORD = {'print("reaction"': 'partial = contact.Table()\nprint("reaction"'}
VALUES = """
def State(table, force):
    hertz = HertzPoint(force=2 * force, radius1=R, **material)
    radius = sqrt(x * x + y * y) / hertz.contact_radius
    exact = hertz.peak * IfPos(1 - radius, sqrt(IfPos(1 - radius, 1 - radius**2, 0)), 0)
    means = np.bincount(number, Integrate(exact, mesh, BND, element_wise=True).NumPy()[onslave])
    return dict(
        area=table["area"], pressure=table["pressure"], hertz=means / table["fullarea"],
        status=table["status"], gap=table["gap"], force=force, x=table["x"],
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
"""


@pytest.fixture(scope="module")
def space(tmp_path_factory):
    """Values, outputs and the folder the notebook writes to."""
    folder = tmp_path_factory.mktemp("space")
    return *Execute(SPACE, VALUES, RECORD, folder), folder


def test_no_errors_in_space(space):
    _, outputs, _ = space
    assert not Errors(outputs)
    assert Pictures(outputs) == 3


def test_macro_elements(space):
    values, outputs, _ = space
    text = "".join(output.text for output in outputs if output.output_type == "stream")
    assert re.search(r"order 3: \d+ macro-elements of 1 to 1 triangles", text)
    assert "no macro-element can be made" in text  # of single triangles with order 2
    counts = np.bincount(values["faces"])
    assert counts[:2].sum() == 0
    assert counts[2] > 0.9 * counts.sum()  # pairs, and few with a third triangle


@pytest.mark.parametrize("state", ["partial", "sliding", "bubbles"])
def test_contact_conditions(space, state):
    values, state = space[0], space[0][state]
    p, q, status = (state[name] for name in ("pressure", "friction", "status"))
    size, length = p.max(), state["gap"].max()
    assert p.min() > -1e-9 * size
    assert abs(p * state["gap"]).max() < 1e-9 * size * length
    assert abs(p[status == 0]).max() < 1e-9 * size
    bound, tangential = values["F"] * p, np.linalg.norm(q, axis=1)
    np.testing.assert_allclose(tangential[status == 2], bound[status == 2], atol=1e-9 * size)
    assert np.all(tangential[status == 1] < bound[status == 1])


def test_states(space):
    values, *_ = space
    partial, sliding = values["partial"], values["sliding"]
    assert np.bincount(partial["status"], minlength=3).min() > 5
    assert 1 not in sliding["status"]
    r = np.hypot(*partial["x"].T[:2])
    assert r[partial["status"] == 1].max() < r[partial["status"] == 0].min()
    assert partial["friction"][partial["status"] > 0, 0].max() < 0  # against the push


def test_balance(space):
    values, *_ = space
    # The plane of symmetry takes its share of the force in y.
    np.testing.assert_allclose(values["reaction"][::2], -values["resultant"][::2], rtol=1e-10)


@pytest.mark.parametrize(("state", "tol"), [("partial", 0.17), ("bubbles", 0.12)])
def test_pressure(space, state, tol):
    """In the L2 norm: five elements across the radius, a closed macro-element is closed whole."""
    state = space[0][state]
    area, error, exact = state["area"], state["pressure"] - state["hertz"], state["hertz"]
    assert 1.01 < state["pressure"].max() / state["p0"] < 1.025
    assert area @ error**2 < tol**2 * (area @ exact**2)
    inner = np.hypot(*state["x"].T[:2]) < 0.7 * state["radius"]
    assert inner.sum() > 15
    np.testing.assert_allclose(state["pressure"][inner], exact[inner], rtol=0.06)


def test_ways_to_macro_elements(space):
    values, *_ = space
    assert values["bubbles"]["force"] == pytest.approx(values["rows"][0, 2] / 2, rel=0.01)
    assert values["split"] / values["bubbles"]["force"] == pytest.approx(1.2, abs=0.03)
    q, x = (values["bubbles"][name][:, :2] for name in ("friction", "x"))
    assert np.sum(values["bubbles"]["area"] * np.sum(q * x, axis=1)) > 0  # points outwards


def test_friction_force(space):
    """The curve of Mindlin, whose compliance comes from the first step."""
    values, *_ = space
    push, shear, normal, stick, slip = values["rows"].T
    force, shift = values["theory"]
    limit = values["F"] * normal[0]
    assert values["iterations"] == pytest.approx(4, abs=2)
    np.testing.assert_allclose(push, [0, 0.0035, 0.007, 0.0105, 0.014, 0.018, 0.022])
    np.testing.assert_allclose(shear[:-1], np.interp(push[:-1], shift, force), atol=0.01 * limit)
    assert push[-1] > shift[-1]
    assert 1 < shear[-1] / limit < 1.01
    expected = (1 - shear[1:-1] / limit) ** (1 / 3)
    np.testing.assert_allclose(np.sqrt(stick / (stick + slip))[1:-1], expected, atol=0.1)


def test_files(space):
    sizes = {path.name: path.stat().st_size for path in space[2].glob("*.vtu")}
    assert sorted(sizes) == ["punch.vtu", "punch_contact.vtu", "punch_segments.vtu"]
    assert min(sizes.values()) > 5000
