# SPDX-License-Identifier: LGPL-2.1-or-later
"""Tools whose center, apex or point is far away: distances are as exact as the positions."""

from decimal import Decimal, getcontext

import numpy as np
import pytest
from ngsolve import CF, BilinearForm, Grad, GridFunction, Id, InnerProduct, Sym, Trace, VectorH1, dx
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ngslac import ContactSolver, LACContact, LACSpace, tools

getcontext().prec = 60
RNG = np.random.default_rng(3)
FAR = [1e3, 1e5, 1e7, 1e8]


def norm(v):
    return sum((a * a for a in v), Decimal(0)).sqrt()


def exact(name, far, p):
    """The distance with 60 digits; all surfaces pass near the origin."""
    p, far = [Decimal(float(c)) for c in p], Decimal(far)
    up = p[-1] + far
    if name in ("disc", "sphere"):
        return norm([*p[:-1], up]) - far
    if name == "cylinder":
        return norm([p[0], up]) - far
    if name == "torus":
        ring = norm([p[0], p[1] + far]) - far
        return norm([ring, p[2] + 1]) - 1
    if name == "cone":
        return norm([p[0], p[1]]) * Decimal(np.cos(0.5)) - up * Decimal(np.sin(0.5))
    raise ValueError(name)


def tool(name, far):
    return {
        "disc": lambda: tools.Sphere((0, -far), far),
        "sphere": lambda: tools.Sphere((0, 0, -far), far),
        "cylinder": lambda: tools.Cylinder((0, 0, -far), (0, 2, 0), far),
        "torus": lambda: tools.Torus((0, -far, -1), (0, 0, 1), far, 1),
        "cone": lambda: tools.Cone((0, 0, -far), (0, 0, 1), 0.5),
    }[name]()


@pytest.mark.parametrize("far", FAR)
@pytest.mark.parametrize("name", ["disc", "sphere", "cylinder", "torus", "cone"])
def test_distances_have_all_digits(name, far):
    dim = 2 if name == "disc" else 3
    points = RNG.uniform(-0.1, 0.1, (50, dim))
    if name == "cone":  # near its flank
        points[:, 0] += far * np.tan(0.5)
    distances = tool(name, far).Distance(points)
    wanted = np.array([float(exact(name, far, p)) for p in points])
    # The point itself is known to so many digits.
    known = 4e-16 * (np.abs(points).max() if name == "cone" else 1)
    np.testing.assert_allclose(distances, wanted, rtol=0, atol=known)


@pytest.mark.parametrize("far", FAR)
def test_a_half_space_and_a_polygon_with_far_corners(far):
    points = RNG.uniform(-0.1, 0.1, (50, 2))
    plane = tools.Plane((far, 2 * far), (-2, 1))
    polygon = tools.Polygon([(far, 2 * far), (-far, -2 * far)], closed=False)
    wanted = (points @ (-2, 1)) / np.sqrt(5)
    for one in (plane, polygon):
        np.testing.assert_allclose(one.Distance(points), wanted, rtol=0, atol=3e-16)


def pressed(obstacle, dim, friction=None):
    """The force on a block that is pressed on a tool below it."""
    mesh = MakeStructured2DMesh(nx=4, ny=4) if dim == 2 else MakeStructured3DMesh(True, 2, 2, 2)
    V = VectorH1(mesh, order=2, dirichlet="top")
    X = V * LACSpace(V, slave="bottom")
    (u, lam), (v, _) = X.TnT()
    strain = Sym(Grad(u))
    a = BilinearForm(X)
    a += InnerProduct(strain + Trace(strain) * Id(dim), Sym(Grad(v))) * dx
    contact = LACContact(u, lam, obstacle=obstacle, friction=friction, finite=True)
    gf = GridFunction(X)
    gf.components[0].Set(CF((0,) * (dim - 1) + (-0.02,)), definedon=mesh.Boundaries("top"))
    ContactSolver(a, gf, contact).Solve(printing=False)
    return np.array(contact.Force())


@pytest.mark.parametrize("friction", [None, 0.3])
@pytest.mark.parametrize("radius", [1e4, 1e5, 1e6, 1e7])
def test_a_large_disc_presses_as_a_line(radius, friction):
    force, flat = (
        pressed(tool, 2, friction)
        for tool in (tools.Sphere((0.5, -radius), radius), tools.Plane((0, 0), (0, 1)))
    )
    assert force == pytest.approx(flat, abs=10 * flat[1] / radius + 1e-9)


@pytest.mark.parametrize("name", ["sphere", "cylinder", "moved", "turned"])
def test_large_tools_press_as_a_plane(name):
    """Also where a large radius comes from a motion."""
    far = 1e6
    obstacle = {
        "sphere": tools.Sphere((0.5, 0.5, -far), far),
        "cylinder": tools.Cylinder((0.5, 0, -far), (0, 1, 0), far),
        "moved": tools.Sphere((0.5, 0.5, 0), far).Moved(shift=CF((0, 0, -far))),
        "turned": tools.Sphere((0.5, 0.5, -far), far).Moved(
            angle=CF(0.3), center=(0.5, 0.5, -far), axis=(1, 2, 3)
        ),
    }[name]
    force, flat = (pressed(one, 3) for one in (obstacle, tools.Plane((0, 0, 0), (0, 0, 1))))
    assert force == pytest.approx(flat, abs=1e-5 * flat[2])
