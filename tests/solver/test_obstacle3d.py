"""A rigid obstacle in place of a master in 3D: a plane, a slope, a ball."""

import numpy as np
import pytest
from ngsolve import (
    BND,
    CF,
    BilinearForm,
    GridFunction,
    InnerProduct,
    Integrate,
    Parameter,
    VectorH1,
    ds,
    specialcf,
    sqrt,
    x,
    y,
)
from press import LAME, MU, brick, linear

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace

RIM = {"dirichletx": "left|right", "dirichlety": "front|back"}


def block_on_obstacle(
    gap, *, kind="hex", order=2, traction=(0, 0, -1.0), n=4, flags=RIM, space=VectorH1, **law
):
    """The unit cube pressed onto an obstacle below it, gap over x and y."""
    V = space(brick(n, kind), order=order, **flags)
    X = V * LACSpace(V, slave="bottom")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += linear(u, v) - InnerProduct(CF(traction), v) * ds("top")
    return a, GridFunction(X), LACContact(u, lam, obstacle=CF(gap), **law)


def solve(a, gf, contact, **flags):
    solver = ContactSolver(a, gf, contact, **flags)
    solver.Solve(printing=False)
    return solver


@pytest.mark.parametrize("kind", ["tet", "hex", "prism", "prism_side", "pyramid"])
@pytest.mark.parametrize("gap", [0.01, -0.02])
def test_constant_stress_on_a_plane(kind, gap):
    """Uniaxial strain: constant pressure, and the block stands on the obstacle."""
    order = 1 if kind == "hex" else 2
    a, gf, contact = block_on_obstacle(gap, kind=kind, order=order, n=3 if order == 2 else 4)
    solve(a, gf, contact)
    table = contact.Table()
    assert table["pressure"] == pytest.approx(1, rel=1e-10)
    assert table["gap"] == pytest.approx(0, abs=1e-12)
    assert contact.Force() == pytest.approx([0, 0, 1], abs=1e-10)
    for at in ((0.3, 0.4, 0.0), (0.7, 0.1, 1.0)):
        expected = -gap - at[2] / (2 * MU + LAME)
        assert gf.components[0](gf.space.mesh(*at))[2] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("kind", ["tet", "hex"])
@pytest.mark.parametrize("space", [VectorH1, BubbleVectorH1])
def test_partial_contact_on_a_slope_obeys_signorini(kind, space):
    """A wedge-shaped gap: closed at one corner, open at the other."""
    flags = {"dirichletx": "left", "dirichlety": "front"}
    if space is BubbleVectorH1:
        flags["slave"] = "bottom"
    gap = 0.1 * x + 0.05 * y
    a, gf, contact = block_on_obstacle(gap, kind=kind, space=space, order=1, n=5, flags=flags)
    solve(a, gf, contact)
    table = contact.Table()
    closed = table["status"] > 0
    assert 0 < closed.sum() < len(closed)
    assert np.all(table["pressure"][closed] > 0)
    assert np.all(table["gap"][~closed] > 0)
    assert table["pressure"] * table["gap"] == pytest.approx(0, abs=1e-12)
    assert contact.Force()[2] == pytest.approx(1, rel=1e-10)
    # The gap of the table is that of the function plus the displacement, on average.
    region = gf.space.mesh.Boundaries("bottom")
    exact = Integrate(gap - gf.components[0] * specialcf.normal(3), region, BND, order=6)
    assert table["area"] @ table["gap"] == pytest.approx(exact, rel=1e-10)


def test_a_ball_pressed_into_a_block():
    """Rigid ball of radius 2 under the middle: a round contact, and no resultant sideways."""
    radius, depth = 2.0, 0.02
    r2 = (x - 0.5) ** 2 + (y - 0.5) ** 2
    gap = radius - depth - sqrt(radius**2 - r2)
    V = VectorH1(brick(8, "hex"), order=2, dirichlet="top")
    X = V * LACSpace(V, slave="bottom")
    (u, lam), (v, _) = X.TnT()
    a, gf = BilinearForm(X), GridFunction(X)
    a += linear(u, v)
    contact = LACContact(u, lam, obstacle=gap)
    solve(a, gf, contact)
    table = contact.Table()
    r = np.hypot(*(table["x"][:, :2] - 0.5).T)
    closed = table["status"] > 0
    assert 0.1 < r[closed].max() < np.sqrt(2 * radius * depth)
    assert r[closed].max() < r[~closed].min() + 1e-9  # round
    pressure = table["pressure"]
    assert pressure.argmax() in np.argsort(r)[:4]
    assert contact.Force()[:2] == pytest.approx(0, abs=1e-11)
    # Hertz gives the right size only: the block is small and held at its far side.
    modulus = 4 * MU * (MU + LAME) / (2 * MU + LAME)
    hertz = 4 / 3 * modulus * np.sqrt(radius) * depth**1.5
    assert hertz < contact.Force()[2] < 2 * hertz
    # Mirror images have equal pressures.
    order = [
        np.lexsort(np.round([s * (table["x"][:, 0] - 0.5), table["x"][:, 1]], 9)) for s in (1, -1)
    ]
    assert pressure[order[0]] == pytest.approx(pressure[order[1]], abs=1e-10)


@pytest.mark.parametrize("friction", [0.3, 5.0])
def test_friction_on_a_plane(friction):
    """Pushed sideways by half of the load against soft springs: slides, or stays."""
    push = np.array([0.3, 0.4])
    a, gf, contact = block_on_obstacle(
        0.0, n=3, flags={}, traction=(*push, -1.0), friction=friction
    )
    (u, _), (v, _) = gf.space.TnT()
    a += 3.0 * (u[0] * v[0] + u[1] * v[1]) * ds("top")
    solve(a, gf, contact)
    status, force = contact.Table()["status"], contact.Force()
    top = gf.space.mesh.Boundaries("top")
    spring = np.array(Integrate(3.0 * gf.components[0], top, BND))[:2]
    assert force[2] == pytest.approx(1, rel=1e-10)
    assert force[:2] == pytest.approx(spring - push, abs=1e-10)
    if friction < 0.5:
        assert set(status) <= {0, 2}
        # The slip directions differ a little over the surface.
        assert force[:2] == pytest.approx(-friction * push / 0.5, rel=0.02)
        assert np.linalg.norm(force[:2]) <= friction
    else:
        assert set(status) <= {0, 1}


def test_a_moving_plane():
    """A Parameter in the gap moves the obstacle; Update takes its present value."""
    shift = Parameter(0.1)
    a, gf, contact = block_on_obstacle(0.01 + shift, n=2)
    for value in (0.1, -0.05):
        shift.Set(value)
        contact.Update()
        gf.vec[:] = 0
        solve(a, gf, contact)
        at = gf.components[0](gf.space.mesh(0.5, 0.5, 0))
        assert at[2] == pytest.approx(-0.01 - value, abs=1e-12)


def test_gap_is_read_in_the_reference_configuration_in_3d():
    a, gf, contact = block_on_obstacle(0.02, n=2)
    solve(a, gf, contact)
    contact.Update(gf)
    solve(a, gf, contact)
    assert gf.components[0](gf.space.mesh(0.5, 0.5, 0))[2] == pytest.approx(-0.02, abs=1e-12)
    assert contact.Table()["pressure"] == pytest.approx(1, rel=1e-10)


def test_obstacle_has_no_mortar_on_the_other_side_in_3d():
    _, _, contact = block_on_obstacle(0.01, n=2)
    D, M = contact.Mortar()
    assert not np.any(M.ToDense().NumPy())
    assert np.any(D.ToDense().NumPy())
    assert "100.0 %" in str(contact.Check())
