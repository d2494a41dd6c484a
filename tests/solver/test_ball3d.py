"""A ball that nothing but contact holds: with friction it lies still, without it rolls away."""

import numpy as np
import pytest
from netgen.occ import Box, Compound, OCCGeometry, Pnt, Sphere, Z
from ngsolve import (
    CF,
    BilinearForm,
    Cross,
    GridFunction,
    IfPos,
    InnerProduct,
    Integrate,
    Mesh,
    VectorH1,
    dx,
    specialcf,
    x,
    y,
    z,
)
from press import linear, numpy

from ngslac import ContactSolver, FloatingBodyError, LACContact, LACSpace

# Presses the ball by a quarter of its radius: several macro-elements touch.
FORCE = {"block": 20.0, "plane": 60.0}


def ball_mesh(*, block):
    """The unit ball that touches the origin from above, and a block below it if wanted."""
    ball = Sphere(Pnt(0, 0, 1), 1)
    ball.mat("ball")
    ball.faces.name = "ball"
    parts = [ball]
    if block:
        parts.append(Box(Pnt(-1.2, -1.2, -1), Pnt(1.2, 1.2, 0)).mat("block"))
        parts[1].faces.name = "side"
        parts[1].faces.Max(Z).name, parts[1].faces.Min(Z).name = "master", "bottom"
    return Mesh(OCCGeometry(Compound(parts)).GenerateMesh(maxh=0.5)).Curve(2)


@pytest.fixture(scope="module")
def on_block():
    return ball_mesh(block=True)


@pytest.fixture(scope="module")
def alone():
    return ball_mesh(block=False)


def problem(mesh, side=(0.0, 0.0), couple=(0.0, 0.0, 0.0), direction=-1, friction=None):
    """Solver of a ball under a body force and a couple; without a block on a rigid plane."""
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    X = V * LACSpace(V, slave="ball")
    (u, lam), (v, _) = X.TnT()
    arm = CF((x, y, z - 1))
    ball = mesh.Materials("ball")
    inertia = Integrate(x * x + y * y, ball, order=6)
    volume = Integrate(CF(1), ball, order=6)
    force = FORCE["block" if "master" in mesh.GetBoundaries() else "plane"]
    load = CF((*side, direction * force)) / volume + Cross(CF(couple), arm) / inertia
    a, gf = BilinearForm(X), GridFunction(X)
    a += linear(u, v) - InnerProduct(load, v) * dx("ball", bonus_intorder=2)
    if force == FORCE["block"]:
        contact = LACContact(u, lam, master="master", friction=friction)
    else:  # the gap along the normal; what looks up or aside is far away
        down = -specialcf.normal(3)[2]
        gap = z / IfPos(down - 0.2, down, 0.2)
        contact = LACContact(u, lam, obstacle=gap, friction=friction)
    return ContactSolver(a, gf, contact), contact, gf


@pytest.mark.parametrize("body", ["on_block", "alone"])
@pytest.mark.parametrize("side", [(0.0, 0.0), (0.7, -0.4)])
def test_friction_holds_a_ball(body, side, request):
    """Three macro-elements that are not in a line have to touch before it lies still."""
    mesh = request.getfixturevalue(body)
    solver, contact, _ = problem(mesh, side=side, friction=0.3)
    solver.Solve(printing=False)
    force = np.array([*side, -FORCE["block" if body == "on_block" else "plane"]])
    assert contact.Force() == pytest.approx(-force, abs=1e-8)
    assert np.sum(contact.Table()["status"] > 0) >= 3
    # The force acts at the centroid, which is not quite in the middle of the meshed ball.
    ball = mesh.Materials("ball")
    centroid = np.array(Integrate(CF((x, y, z)), ball)) / Integrate(CF(1), ball)
    assert centroid == pytest.approx([0, 0, 1], abs=1e-3)
    if body == "alone":
        assert contact.Moment(centroid) == pytest.approx([0, 0, 0], abs=1e-4)


def test_friction_holds_against_a_couple(on_block):
    """Spinning about the vertical axis needs the couple of the friction."""
    couple = np.array([0.0, 0.0, 0.2])
    solver, contact, _ = problem(on_block, couple=tuple(couple), friction=0.3)
    solver.Solve(printing=False)
    assert contact.Force() == pytest.approx(
        [0, 0, FORCE["block"]], abs=1e-4
    )  # the ball is not quite round
    assert contact.Moment((0, 0, 1))[2] == pytest.approx(-0.2, rel=0.01)


@pytest.mark.parametrize("loads", [{}, {"side": (0.5, 0.0)}, {"couple": (0.0, 0.0, 0.1)}])
def test_a_ball_without_friction_rolls_away(on_block, loads):
    """A frictionless plane stops the fall only; nothing comes back as if it were a solution."""
    solver, _, gf = problem(on_block, **loads)
    with pytest.raises(FloatingBodyError, match=r"body 'ball' floats \(rotation about z\)"):
        solver.Solve(printing=False)
    assert not np.any(numpy(gf))


def test_six_motions_of_a_ball_in_the_air(on_block):
    solver, contact, gf = problem(on_block, friction=0.3)
    lone = ContactSolver(solver.a, gf, contact, initial="none")
    with pytest.raises(FloatingBodyError) as error:
        lone.Solve(printing=False)
    found = str(error.value).split(":")[0]
    assert found.count("body 'ball' floats") == 6


def test_a_ball_that_is_pulled_up(on_block):
    solver, _, gf = problem(on_block, direction=1, friction=0.3)
    with pytest.raises(FloatingBodyError):
        solver.Solve(printing=False)
    assert not np.any(numpy(gf))
