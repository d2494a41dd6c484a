"""Corners and edges that are smaller than macro-elements, and inside of the other body."""

import numpy as np
import pytest
from netgen.occ import Axis, Box, Circle, MoveTo, Pnt, Sphere, X, Y, Z
from ngsolve import CF, Parameter, sqrt, x
from pressed import body, meshed, pressed

from ngslac import tools
from ngslac.contact.certificate import PointsInside

SIDES = [("up", "low"), ("low", "up")]


def below(dim, h=0.15):
    """A block with its upper side in the plane 0."""
    shape = MoveTo(-1, -1).Rectangle(2, 1).Face() if dim == 2 else Box((-1, -1, -1), (1, 1, 0))
    return body(shape, dim, "low", h, lambda at: at[-1] > -1e-9, "below")


def on_its_corner(h=0.15, turn=45):
    """A square of side 0.8."""
    shape = MoveTo(0, 0).Rectangle(0.8, 0.8).Face().Rotate(Axis(Pnt(0, 0, 0), Z), turn)
    lowest = lambda at: np.linalg.norm(at) < 0.45  # noqa: E731
    return body(shape, 2, "up", h, lowest, "above")


def roof(dim, slope, h):
    """Its lower sides meet at an edge, or a corner, at the origin."""
    face = MoveTo(0, 0).LineTo(0.6, 0.6 * slope).LineTo(0.6, 0.8).LineTo(-0.6, 0.8)
    face = face.LineTo(-0.6, 0.6 * slope).Close().Face()
    if dim == 3:
        face = face.Rotate(Axis(Pnt(0, 0, 0), X), 90).Extrude(0.8 * Y).Move((0, -0.4, 0))
    low = lambda at: abs(at[0]) < 0.5 and at[-1] < 0.5  # noqa: E731
    return body(face, dim, "up", h, low, "above")


@pytest.mark.pairwise
@pytest.mark.parametrize(("slave", "master"), SIDES)
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("down", [0.005, 0.03])
@pytest.mark.parametrize("turn", [45, 30])
def test_a_square_on_its_corner(slave, master, finite, down, turn):
    mesh = meshed(2, below(2), on_its_corner(turn=turn))
    p = pressed(mesh, down, slave=slave, master=master, finite=finite)
    assert np.all(p.contact.Force() == 0)
    depth, place, size = PointsInside(p.contact)
    assert 0.7 * down < depth < 2.1 * down  # along normals that are inclined
    assert np.linalg.norm(place) < 0.1
    assert 0.1 < size < 0.4


@pytest.mark.parametrize(("slave", "master"), SIDES)
@pytest.mark.parametrize(("dim", "slope", "h"), [(2, 0.7, 0.2), (3, 1.0, 0.4)])
def test_a_roof(slave, master, dim, slope, h):
    mesh = meshed(dim, below(dim, h), roof(dim, slope, h))
    p = pressed(mesh, 0.01, slave=slave, master=master, order=1 if dim == 3 else 2)
    assert np.all(p.contact.Force() == 0)
    depth, place, _ = PointsInside(p.contact)
    assert 0.006 < depth < 0.012
    assert abs(place[0]) < 0.05


@pytest.mark.parametrize("kind", ["function", "polygon"])
def test_a_rigid_corner(kind):
    """It comes from below, where faces meet: their ends and quadrature points are looked at."""
    shape = MoveTo(-1, 0).Rectangle(2, 1).Face()
    mesh = meshed(2, body(shape, 2, "up", 0.25, lambda at: at[1] < 1e-9, "above"))
    if kind == "function":
        options = {"obstacle": sqrt(x**2)}
    else:
        options = {"obstacle": tools.Polygon([(0, 0), (-1, -1), (1, -1)]), "finite": True}
    p = pressed(mesh, 0.01, held="up_held", **options)
    assert np.all(p.contact.Force() == 0)
    depth, place, _ = PointsInside(p.contact)
    assert 0.006 < depth < 0.011
    assert abs(place[0]) < 1e-9


@pytest.mark.parametrize("h", [0.4, 0.15, pytest.param(0.05, marks=pytest.mark.full)])
@pytest.mark.parametrize(("slave", "master"), SIDES)
def test_discs_touch_without_alarm(h, slave, master):
    """From the first touch of coarse meshes on."""
    shape = MoveTo(-0.5, 0).Rectangle(1, 1).Face() * Circle((0, 1), 1).Face()
    low = lambda at: at[1] < 0.5 and abs(at[0]) < 0.45  # noqa: E731
    mesh = meshed(2, below(2, 0.8 * h), body(shape, 2, "up", h, low, "above"), curve=2)
    for down in (-0.1, 1e-6, 1e-4, 1e-3, 0.01, 0.05):
        p = pressed(mesh, down, slave=slave, master=master)
        assert PointsInside(p.contact) is None


@pytest.mark.parametrize("h", [0.2, pytest.param(0.12, marks=pytest.mark.full)])
@pytest.mark.parametrize("down", [1e-3, 0.05])
def test_balls_touch_without_alarm(h, down):
    shape = Sphere((0, 0, 1), 1) * Box((-0.7, -0.7, 0), (0.7, 0.7, 1))
    low = lambda at: at[2] < 0.3 and np.hypot(*at[:2]) < 0.3  # noqa: E731
    mesh = meshed(3, below(3, 0.8 * h), body(shape, 3, "up", h, low, "above"))
    p = pressed(mesh, down, order=1)
    assert PointsInside(p.contact) is None


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize(("slave", "master"), SIDES)
@pytest.mark.parametrize("down", [-0.1, 1e-4, 0.02, 0.1])
def test_blocks_touch_without_alarm(down, slave, master, finite):
    """All sides of the upper block are of contact but the held one; the lower one is wider."""
    shape = MoveTo(-0.5, 0).Rectangle(1, 0.7).Face()
    up = body(shape, 2, "up", 0.2, lambda at: at[1] < 0.69, "above")
    p = pressed(meshed(2, below(2, 0.27), up), down, slave=slave, master=master, finite=finite)
    assert (np.linalg.norm(p.contact.Force()) > 0) == (down > 0)
    assert PointsInside(p.contact) is None


def test_a_tilted_block_touches_without_alarm():
    shape = MoveTo(-0.5, 0).Rectangle(1, 0.7).Face().Rotate(Axis(Pnt(0, 0, 0), Z), 2)
    shape = shape.Move((0, 0.5 * np.sin(np.radians(2)), 0))
    up = body(shape, 2, "up", 0.1, lambda at: at[1] < 0.2 and abs(at[0]) < 0.45, "above")
    for down in (0.005, 0.02, 0.05):
        p = pressed(meshed(2, below(2, 0.13), up), down)
        assert np.linalg.norm(p.contact.Force()) > 0
        assert PointsInside(p.contact) is None


def test_nothing_is_looked_at_where_contact_cannot_open():
    mesh = meshed(2, below(2), on_its_corner())
    assert PointsInside(pressed(mesh, 0.03, bilateral=True).contact) is None
    p = pressed(mesh, 0.03)
    assert PointsInside(p.contact, p.gf)[0] == PointsInside(p.contact)[0]
    p.contact.Deactivate()
    assert PointsInside(p.contact) is None


def test_a_clearance_counts():
    """The corner is inside of the meshes, not of contact; and the other way round."""
    mesh, offset = meshed(2, below(2), on_its_corner()), Parameter(0.05)
    assert PointsInside(pressed(mesh, 0.03, offset=offset).contact) is None
    found = pressed(mesh, 0.01, offset=CF(-0.02))
    assert PointsInside(found.contact)[0] == pytest.approx(0.03, rel=0.5)
