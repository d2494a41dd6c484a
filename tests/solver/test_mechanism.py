"""Loads that do work on a motion which curved contact leaves free: the body is named.

Frames, units, solvers and the size of what drives do not matter; without it the body stays.
"""

import warnings

import numpy as np
import pytest
from netgen.occ import Box as Cuboid
from netgen.occ import Circle, Compound, OCCGeometry, Pnt, Rectangle, Sphere
from netgen.occ import Z as UP
from ngsolve import (
    CF,
    Grad,
    InnerProduct,
    Integrate,
    Mesh,
    VectorH1,
    dx,
    x,
    y,
    z,
)
from posed import posed
from press import linear

from ngslac import FloatingBodyError

LOW = 0.04  # play between disc, or ball, and hole


def disc_in_hole(angle=0.0, length=1.0, h=0.25):
    """A disc that touches a hole in a square plate at its bottom, as turned by the angle."""
    r = length * (1 - LOW)
    down = length * LOW * np.array((np.sin(angle), -np.cos(angle)))
    disc = Circle(tuple(down), r).Face()
    plate = Rectangle(4 * length, 4 * length).Face().Move((-2 * length, -2 * length, 0))
    plate -= Circle((0, 0), length).Face()
    for face, name, size in (disc, "disc", h), (plate, "plate", 3 * h):
        face.faces.name, face.edges.name, face.faces.maxh = name, name, size * length
    plate.edges.Nearest(Pnt(length, 0, 0)).name = "hole"
    plate.edges.Nearest(Pnt(length, 0, 0)).maxh = 1.3 * h * length
    ngmesh = OCCGeometry(Compound([disc, plate]), dim=2).GenerateMesh()
    return Mesh(ngmesh).Curve(3), down


def ball_in_hollow(length=1.0, h=0.7):
    """A ball that touches the bottom of a hollow in a block."""
    r = length * (1 - LOW)
    ball = Sphere(Pnt(0, 0, -length * LOW), r)
    low, high = -1.6 * length, 1.6 * length
    block = Cuboid(Pnt(low, low, low), Pnt(high, high, 0)) - Sphere(Pnt(0, 0, 0), length)
    for body, name, size in (ball, "disc", h), (block, "plate", 2 * h):
        body.mat(name)
        body.faces.name, body.maxh = name, size * length
    block.faces.Nearest(Pnt(0, 0, -length)).name = "hole"
    block.faces.Min(UP).name = "far"
    block.faces["hole"].maxh = 1.2 * h * length
    return Mesh(OCCGeometry(Compound([ball, block])).GenerateMesh(grading=0.8)).Curve(2)


def problem(mesh, load, solver=None, held="plate", friction=None):
    """A body force on the disc; returns solver, solution and contact."""
    V = VectorH1(mesh, order=2, dirichlet=held)
    made = posed(
        V,
        lambda u, v, _: linear(u, v) - InnerProduct(CF(load), v) * dx("disc"),
        slave="disc",
        master="hole",
        friction=friction,
    )
    return made.solver(**({"solver": solver} if solver else {})), made.gf, made.contact


def in_plane(torque=0.0, angle=0.0, length=1.0, **options):
    """A disc under a weight along `angle` and a torque, relative to weight and length."""
    mesh, middle = disc_in_hole(angle, length)
    ax, ay = x - middle[0], y - middle[1]
    weight = np.array((np.sin(angle), -np.cos(angle)))
    load = tuple(
        0.5 * (w + torque / length * t) / length for w, t in zip(weight, (-ay, ax), strict=True)
    )
    return problem(mesh, load, **options), weight


def solve(made):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        made.Solve(printing=False)


def spin(gf):
    G, disc = Grad(gf.components[0]), gf.space.mesh.Materials("disc")
    return Integrate(G[1, 0] - G[0, 1], disc) / 2 / Integrate(1.0, disc)


@pytest.mark.parametrize("angle", [0.0, 0.7, -2.0])
@pytest.mark.parametrize("solver", ["interface", "direct"])
def test_a_disc_in_a_hole_carries_its_weight_and_does_not_spin(solver, angle):
    (made, gf, contact), weight = in_plane(angle=angle, solver=solver)
    solve(made)
    expected = -0.5 * np.pi * (1 - LOW) ** 2 * weight
    assert contact.Force() == pytest.approx(expected, abs=0.01)
    assert abs(spin(gf)) < 1e-4


@pytest.mark.parametrize(
    ("angle", "torque"),
    [
        *((angle, torque) for angle in (0.0, -2.0) for torque in (1.0, 0.1, 0.01)),
        (0.7, 1.0),
        (0.7, 0.1),
        (0.7, 0.01),
    ],
)
def test_a_torque_on_it_is_an_error_in_any_frame(angle, torque):
    (made, *_), _ = in_plane(torque, angle=angle)
    with pytest.raises(FloatingBodyError, match=r"'disc'.*rotation"):
        solve(made)


@pytest.mark.parametrize("length", [1e-6, 1e-3, 1e3, 1e5])
def test_a_torque_on_it_is_an_error_in_any_units(length):
    (made, *_), _ = in_plane(0.05, length=length)
    with pytest.raises(FloatingBodyError, match=r"'disc'.*rotation"):
        solve(made)


@pytest.mark.parametrize("solver", ["interface", "direct", "iterative"])
def test_a_torque_on_it_is_an_error_for_each_solver(solver):
    (made, *_), _ = in_plane(0.05, solver=solver)
    with pytest.raises(FloatingBodyError, match=r"'disc'.*rotation"):
        solve(made)


def test_friction_carries_a_small_torque():
    (made, _, contact), _ = in_plane(0.05, friction=0.5)
    solve(made)
    assert contact.Force()[1] == pytest.approx(0.5 * np.pi * (1 - LOW) ** 2, rel=0.01)


@pytest.mark.parametrize("axis", [0, 2])
def test_a_torque_on_a_ball_in_a_hollow_is_an_error(axis):
    ax, ay, az = x, y, z + LOW
    torque = [(0, -az, ay), (az, 0, -ax), (-ay, ax, 0)][axis]
    load = tuple(0.5 * (w + 0.1 * t) for w, t in zip((0, 0, -1), torque, strict=True))
    made, *_ = problem(ball_in_hollow(), load, held="far")
    with pytest.raises(FloatingBodyError, match="'disc'"):
        solve(made)
