"""The part of the contact force that acts on some faces, and the forces of supports."""

import numpy as np
import pytest
from netgen.occ import Compound, OCCGeometry, Rectangle, Y
from ngsolve import (
    CF,
    Mesh,
    Parameter,
    VectorH1,
    ds,
    x,
    y,
)
from posed import elastic, posed

from ngslac import LoadStepper


def Bench(finite=False):
    """A block on two others of different heights, pressed down on its left half."""
    left = Rectangle(1, 1).Face().Move((-0.1, -1, 0))
    right = Rectangle(1, 0.5).Face().Move((1.1, -0.5, 0))
    top = Rectangle(2, 0.5).Face()
    for name, face in {"left": left, "right": right}.items():
        face.edges.name = "free"
        face.edges.Max(Y).name, face.edges.Min(Y).name = name, f"{name} foot"
    top.edges.name = "free"
    top.edges.Min(Y).name, top.edges.Max(Y).name = "slave", "top"
    top.faces.maxh, left.faces.maxh, right.faces.maxh = 0.1, 0.23, 0.17
    geometry = OCCGeometry(Compound([left, right, top]), dim=2)
    mesh = Mesh(geometry.GenerateMesh())
    V = VectorH1(mesh, order=2, dirichlet="left foot|right foot", dirichletx="top")
    law = {"master": "left|right", "friction": 0.2, "finite": finite}
    problem = posed(
        V,
        elastic(210e3, 0.3),
        lambda u, v, load: load * CF((0, 30 - 10 * x)) * v * ds("top"),
        load=Parameter(0),
        **law,
    )
    return problem.solver(), problem.contact, problem.load


@pytest.fixture(scope="module", params=[False, True], ids=["small", "finite"])
def bench(request):
    solver, contact, load = Bench(request.param)
    stepper = LoadStepper(solver, load)
    stepper.Integrate(steps=2, printing=False)
    return solver, contact, stepper


def test_masters_share_the_force(bench):
    solver, contact, _ = bench
    left, right = contact.Force(on="left"), contact.Force(on="right")
    assert left + right == pytest.approx(-contact.Force(), rel=1e-12)
    assert left[1] < right[1] < 0  # pressed down, and more so on the left
    assert contact.Force(on="left") == pytest.approx(-solver.Reaction("left foot"), rel=2e-2)
    assert contact.Force(on="slave") == pytest.approx(contact.Force(), rel=1e-12)
    assert contact.Force(on="slave|left|right") == pytest.approx([0, 0], abs=1e-12)
    region = contact.mesh.Boundaries("left")
    assert contact.Force(on=region) == pytest.approx(left, rel=1e-15)


def test_wrong_faces_are_named(bench):
    contact = bench[1]
    with pytest.raises(ValueError, match=r"on = 'top' has no face in contact.*'left\|right'"):
        contact.Force(on="top")
    with pytest.raises(ValueError, match="'nothing'"):
        contact.Force(on="nothing")
    with pytest.raises(TypeError, match="on"):
        contact.Force(on=3)


def test_supports_carry_the_load(bench):
    solver, contact, _ = bench
    feet = [solver.Reaction(name) for name in ("left foot", "right foot")]
    assert sum(feet)[1] == pytest.approx(40, rel=1e-8)
    assert solver.Reaction("left foot|right foot") == pytest.approx(sum(feet), rel=1e-12)
    turn = CF((-y, x))
    moment = solver.Reaction("left foot|right foot", motion=turn)
    assert moment == pytest.approx(contact.Moment(), rel=1e-8 if not contact.finite else 1e-4)
    with pytest.raises(ValueError, match="region"):
        solver.Reaction("nothing")
    with pytest.raises(ValueError, match="motion"):
        solver.Reaction("left foot", motion=x)


def test_steps_are_a_table(bench):
    _, contact, stepper = bench
    table = stepper.Table()
    assert table["load"].tolist() == [0.5, 1.0]
    assert table["force"].shape == (2, 1, 2)
    assert table["force"][-1, 0] == pytest.approx(contact.Force(), rel=1e-12)
    lines = str(stepper).splitlines()
    assert lines[0] == repr(stepper)
    assert lines[1].split() == ["step", "load", "iterations", "cuts", "force"]
    assert len(lines) == 4
    assert str(stepper.steps[-1]).startswith("step 2  load 1  ")


def test_steps_and_iterations_are_logged(caplog):
    solver, _, load = Bench()
    with caplog.at_level("DEBUG", logger="ngslac"):
        (step,) = LoadStepper(solver, load).Integrate(steps=1, printing=False)
    texts = {level: [] for level in ("DEBUG", "INFO")}
    for record in caplog.records:
        texts[record.levelname].append(record.getMessage())
    assert texts["INFO"] == [str(step)]
    assert texts["DEBUG"][-1] == str(solver.history[-1])


def test_no_steps_are_a_table_too():
    solver, _, load = Bench()
    stepper = LoadStepper(solver, load)
    assert {name: len(values) for name, values in stepper.Table().items()} == {
        name: 0 for name in ("step", "load", "iterations", "cuts", "force")
    }
    assert str(stepper) == repr(stepper)
    assert "force" in str(stepper.Table())
    assert np.shape(stepper.Table()["force"]) == (0, 1, 2)
