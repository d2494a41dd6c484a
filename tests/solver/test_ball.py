"""A ball that only contact holds: it lies still with friction, and rolls away without friction."""

from functools import cache

import numpy as np
import pytest
from netgen.occ import Box, Compound, OCCGeometry, Pnt, Sphere, Z
from ngsolve import (
    CF,
    Cross,
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
from posed import posed
from press import linear, numpy

from ngslac import ContactWarning, FloatingBodyError

# These forces press the ball by a quarter of its radius: several macro-elements touch.
FORCE = {"block": 20.0, "plane": 60.0}


@cache
def ball_mesh(under):
    """The unit ball, which touches the origin from above, and with "block" a block below it."""
    ball = Sphere(Pnt(0, 0, 1), 1)
    ball.mat("ball")
    ball.faces.name = "ball"
    parts = [ball]
    if under == "block":
        parts.append(Box(Pnt(-1.2, -1.2, -1), Pnt(1.2, 1.2, 0)).mat("block"))
        parts[1].faces.name = "side"
        parts[1].faces.Max(Z).name, parts[1].faces.Min(Z).name = "master", "bottom"
    return Mesh(OCCGeometry(Compound(parts)).GenerateMesh(maxh=0.5)).Curve(2)


def problem(
    under="block", *, side=(0.0, 0.0), couple=(0.0, 0.0, 0.0), up=-1, friction=0.3, **options
):
    """Solver of a ball under a body force and a couple, on a block or a rigid plane."""
    mesh = ball_mesh(under)
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    ball = mesh.Materials("ball")
    inertia, volume = (Integrate(f, ball, order=6) for f in (x * x + y * y, CF(1)))
    load = CF((*side, up * FORCE[under])) / volume + Cross(CF(couple), CF((x, y, z - 1))) / inertia
    down = -specialcf.normal(3)[2]
    # The gap along the normal; where the surface faces up or aside it is large.
    law = {} if under == "block" else {"obstacle": z / IfPos(down - 0.2, down, 0.2)}

    def bulk(u, v, _):
        return linear(u, v) - InnerProduct(load, v) * dx("ball", bonus_intorder=2)

    made = posed(V, bulk, slave="ball", friction=friction, **law)
    return made.solver(**options), made.contact, made.gf


@pytest.mark.parametrize("under", FORCE)
@pytest.mark.parametrize("side", [(0.0, 0.0), (0.7, -0.4)])
def test_friction_holds_a_ball(under, side):
    """Three macro-elements that are not in a line have to touch before the ball lies still."""
    solver, contact, gf = problem(under, side=side)
    solver.Solve(printing=False)
    assert contact.Force() == pytest.approx([-side[0], -side[1], FORCE[under]], abs=1e-8)
    assert np.sum(contact.Table()["status"] > 0) >= 3
    # The force acts at the centroid, which is not quite in the middle of the meshed ball.
    ball = gf.space.mesh.Materials("ball")
    centroid = np.array(Integrate(CF((x, y, z)), ball)) / Integrate(CF(1), ball)
    assert centroid == pytest.approx([0, 0, 1], abs=1e-3)
    if under == "plane":
        assert contact.Moment(centroid) == pytest.approx([0, 0, 0], abs=1e-4)


def test_friction_holds_against_a_couple():
    """Friction balances a couple about the vertical axis."""
    solver, contact, _ = problem(couple=(0.0, 0.0, 0.2))
    solver.Solve(printing=False)
    # The ball is not quite round.
    assert contact.Force() == pytest.approx([0, 0, FORCE["block"]], abs=1e-4)
    assert contact.Moment((0, 0, 1))[2] == pytest.approx(-0.2, rel=0.01)


def test_a_ball_on_a_plane_without_friction_is_free_to_turn():
    solver, contact, _ = problem(friction=None)
    with pytest.warns(ContactWarning, match=r"body 'ball' is free \(rotation about z\)"):
        solver.Solve(printing=False)
    # Facets of the ball are tilted: the hold of its rotation carries up to 1e-4 of its weight.
    assert contact.Force() == pytest.approx([0, 0, FORCE["block"]], abs=1e-4 * FORCE["block"])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"friction": None, "side": (0.5, 0.0)}, r"'ball' turns \(rotation about y\): there is no"),
        (
            {"friction": None, "couple": (0.0, 0.0, 0.1)},
            r"'ball' (turns|floats) \(rotation about z",
        ),
        ({"initial": "none"}, r"(body 'ball' floats [^:]*){6}:"),  # in the air: six motions
        ({"up": 1}, "ball"),
    ],
)
def test_a_ball_that_nothing_holds(given, message):
    """A frictionless plane only stops the fall; the failed solve leaves the GridFunction at 0."""
    solver, _, gf = problem(**given)
    with pytest.raises(FloatingBodyError, match=message):
        solver.Solve(printing=False)
    assert not np.any(numpy(gf))
