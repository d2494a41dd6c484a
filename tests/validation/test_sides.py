"""Friction does not depend on which of two bodies is the slave, nor on meshes and frames."""

import math

import numpy as np
import pytest
from ngsolve import CF, Parameter, VectorH1
from posed import posed
from press import linear
from sheets import Motion, Sheet, grid, in_plane, sheet_mesh

from ngslac.meshes import HertzMesh
from ngslac.meshes.geometry import Arc, Body, GenerateMesh, Line, Touching

FRICTION = 0.2
SIDES = [("slave", "master"), ("master", "slave")]


def pressed(mesh, pushes, sides, *, order=2, steps=5, dirichletx="", **flags):
    """Table of two equal bodies that are moved towards each other; `pushes`: by regions."""
    V = VectorH1(mesh, order=order, dirichlet="|".join(pushes), dirichletx=dirichletx)
    law = {"slave": sides[0], "master": sides[1], "friction": FRICTION} | flags
    problem = posed(V, lambda u, v, load: linear(u, v), load=Parameter(0), **law)
    prescribe = {name: problem.load * CF(tuple(push)) for name, push in pushes.items()}
    stepper = problem.stepper(prescribe=prescribe)
    for k in range(1, steps + 1):
        stepper.Integrate((k / steps) ** 1.8, steps=1, printing=False)
    return problem.contact.Table()


def rubbed(table):
    """Norm of the tangential traction over that of friction times pressure."""
    shear = table["traction"] + table["pressure"][:, None] * table["normal"]
    norms = (
        np.sqrt(table["area"] @ f**2) for f in (np.linalg.norm(shear, axis=1), table["pressure"])
    )
    return next(norms) / next(norms) / FRICTION


def bumps(kinds, n, motion, radius=4.0):
    """A bump under its mirror image, meshed with these kinds and numbers of faces."""
    sheets = []
    for up, kind, m, name in zip((1, -1), kinds, n, ("slave", "master"), strict=True):
        points, faces = grid(kind, m, ((-1.0, -1.0), (1.0, 1.0)))
        height = up * np.sum(points**2, axis=1) / (2 * radius)
        depth = np.outer(up * (1.5 - np.abs(height)), np.eye(points.shape[1] + 1)[-1])
        surface = in_plane(points) + height[:, None] * np.eye(points.shape[1] + 1)[-1]
        sheets.append(Sheet(f"{name}body", surface, faces, depth, name, f"{name}rest"))
    return sheet_mesh(*sheets, motion=motion)


@pytest.mark.pairwise
@pytest.mark.parametrize("sides", SIDES)
@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("kind", ["edge", "quad"])
def test_mirrored_bodies_do_not_rub(kind, finite, sides):
    """What is one-sided is of second order in the angle between the normals with small sliding, and
    of first order in that along a face with large sliding, where pressure follows its normals."""
    dim = 2 if kind == "edge" else 3
    motion = Motion(dim, 5, scale=0.3, shift=2.0)
    up, found = 0.3 * motion.R[:, -1], []
    for radius in (4.0, 16.0):
        mesh = bumps((kind, kind), (8, 8) if dim == 2 else (4, 4), motion, radius)
        push = 0.24 / radius * up
        pushes = {"slaverest": -push, "masterrest": push}
        table = pressed(mesh, pushes, sides, finite=finite)
        assert np.sum(table["status"] > 0) >= 4
        found.append(rubbed(table))
    assert found[0] < (0.12 if finite else 5e-3)
    assert found[1] < (found[0] / 3 if finite else 3e-4)


def segments(h=0.05, radius=50.0, zone=0.78, end=6.0, height=6.0):
    """The right half of a segment of a cylinder above its mirror image, with other edges."""
    bodies = []
    for up, edge, name in ((1, h, "slave"), (-1, 1.37 * h, "master")):
        circle, reach = Touching(radius), [math.asin(s / radius) for s in (zone, end)]

        def point(angle, up=up, of=circle):
            return of(angle)[0], up * of(angle)[1]

        corners = [point(reach[1]), (end, up * height), (0, up * height), (0, 0)]
        names = ["side", f"{name}back", "sym"]
        lines = [Line(p, q, n) for p, q, n in zip(corners[:-1], corners[1:], names, strict=True)]
        arcs = [Arc(point, 0, reach[0], name, round(zone / edge)), Arc(point, *reach, "side")]
        bodies.append(Body([*arcs, *lines], f"{name}body"))
    return GenerateMesh(bodies, order=3, maxh=2, grading=0.25)


@pytest.mark.sample(2)
@pytest.mark.parametrize("sides", SIDES)
@pytest.mark.parametrize("finite", [False, True])
def test_equal_bodies_hardly_rub(finite, sides):
    """What is left is the error of the displacements, less by far of third order."""
    pushes = {"slaveback": (0, -0.006), "masterback": (0, 0.006)}
    flags = {"dirichletx": "slaveback|masterback|sym", "finite": finite}
    second, third = (
        rubbed(pressed(segments(), pushes, sides, order=order, **flags)) for order in (2, 3)
    )
    assert second < 0.03
    assert third < 0.25 * second


@pytest.mark.parametrize("slave", ["slave", "master"])
def test_the_weights_do_not_depend_on_the_frame(slave):
    found = []
    for angle in (0.0, 37.0):
        mesh = HertzMesh(2.0, half=False, angle=angle)
        V = VectorH1(mesh, order=2, dirichlet="bottom")
        master = "master" if slave == "slave" else "slave"
        problem = posed(V, lambda u, v, load: linear(u, v), slave=slave, master=master)
        problem.contact.Prepare(problem.a.Assemble().mat)
        found.append(problem.contact.State()["share"][0])
    assert found[0] == pytest.approx(found[1], rel=1e-8)
    assert 0.3 < found[0] < 0.7  # of equal materials
