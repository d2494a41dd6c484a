"""Rigid motions that nothing prevents: how they are found, in every kind of space and coupling."""

from functools import reduce
from operator import mul

import numpy as np
import pytest
from bricks import brick
from netgen.occ import Compound, OCCGeometry, Rectangle
from netgen.occ import X as EAST
from netgen.occ import Y as NORTH
from ngsolve import (
    CF,
    H1,
    BilinearForm,
    GridFunction,
    Mesh,
    NumberSpace,
    Periodic,
    VectorH1,
    VectorL2,
    div,
    ds,
    dx,
    grad,
    x,
    y,
    z,
)
from posed import posed
from press import linear, numpy, press

from ngslac import BubbleVectorH1, LACContact, LACSpace
from ngslac.arrays import AsBits, AsNumPy, ScalarDofs, ToCSR
from ngslac.bodies.bodies import Bodies
from ngslac.bodies.rigidmotions import RigidMotions, Turned

PLANE = ["translation in x", "translation in y", "rotation"]


# --- the motions themselves --------------------------------------------------------------------


def fields(mesh, u):
    """Translations, and rotations of what is displaced by u, about the middle, over the size."""
    d, points = mesh.dim, np.asarray(mesh.ngmesh.Coordinates())[: mesh.nv, : mesh.dim]
    size, middle = np.ptp(points, axis=0).max(), points.mean(axis=0)
    arms = [(c + u[k] - middle[k]) / size for k, c in enumerate((x, y, z)[:d])]
    planes = [(0, 1)] if d == 2 else [(1, 2), (2, 0), (0, 1)]
    turns = [{i: -arms[j], j: arms[i]} for i, j in planes]
    motions = [{k: 1} for k in range(d)] + turns
    return size, [CF(tuple(motion.get(k, 0) for k in range(d))) for motion in motions]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    "make",
    [
        lambda: VectorH1(press().mesh, order=1),
        lambda: H1(press().mesh, order=2, dim=2),
        lambda: BubbleVectorH1(press().mesh, order=1, slave="slave"),
        lambda: VectorH1(brick("hex", 2), order=3),
        lambda: H1(brick("prism", 2), order=3, dim=3),
        lambda: VectorH1(brick("pyramid", 1), order=2),
        lambda: VectorH1(press().mesh, order=2, definedon="upper"),
        lambda: VectorL2(press().mesh, order=2),
    ],
)
def test_motions_are_those_of_a_rigid_body(make, turned):
    """Also after a displacement, about the same point."""
    space = make()
    d, u, gf = space.mesh.dim, GridFunction(space), GridFunction(space)
    if turned:
        u.Set(CF((0.3 * x - y, 0.1 * x, 0.2 * y + x)[:d]))
    motions, names, size = RigidMotions(space)
    assert motions.shape[1] == len(names) == len(set(names)) == d * (d + 1) // 2
    expected_size, expected = fields(space.mesh, u if turned else (0,) * d)
    assert size == pytest.approx(expected_size)
    found = motions + Turned(space, numpy(u), size)
    used = AsNumPy(ScalarDofs(space.FreeDofs(), space))
    for motion, field in zip(found.T, expected, strict=True):
        gf.Set(field)
        assert motion[used] == pytest.approx(numpy(gf)[used], abs=1e-9)


# --- bodies ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def mesh():
    """A block above its base, and further unit squares beside it; edges: material and side."""
    faces = []
    for k, name in enumerate(["block", "base", "free", "fixed", "free", "guided", "hung"]):
        width = 1.5 if name == "base" else 1  # of the same width the meshes would match
        face = Rectangle(width, 1).Face().Move((-0.2, -1, 0) if name == "base" else (2 * k, 0, 0))
        face.faces.name, face.faces.maxh = name, 0.3
        face.edges.Min(EAST).name, face.edges.Max(EAST).name = f"{name}_left", f"{name}_right"
        face.edges.Min(NORTH).name, face.edges.Max(NORTH).name = f"{name}_bottom", f"{name}_top"
        faces.append(face)
    return Mesh(OCCGeometry(Compound(faces), dim=2).GenerateMesh())


FLAGS = {"dirichlet": "base_bottom|fixed_left", "dirichletx": "guided_left"}
BLOCKS = {"dirichlet": "base_bottom|fixed_left|guided_left"}


def parts(V, before=(), **options):
    """Bulk form, solution, contact, trial and test functions; `before` are spaces in front of V."""
    k, fes = len(before), reduce(mul, [*before, V, LACSpace(V, slave="block_bottom")])
    trial, test = fes.TnT()
    a = BilinearForm(fes, **options)
    a += linear(trial[k], test[k]) + 20 * trial[k][0] * test[k][0] * ds("hung_top")
    contact = LACContact(trial[k], trial[k + 1], master="base_top", friction=0.3)
    return a, GridFunction(fes), contact, trial, test


def floating(a, gf, contact, *_, lift=None, closed=False):
    """What is said to float.

    `lift` is the component of a displacement that is lifted, `closed`: all macro-elements stick.
    """
    if lift is not None:
        up = gf.space.mesh.MaterialCF({"block": CF((0, 0.1))}, default=CF((0, 0)))
        gf.components[lift].Set(up)
    a.AssembleLinearization(gf.vec)
    contact.Prepare(a.mat)
    contact.Evaluate(gf)
    if closed:
        contact.form.Close(AsBits(np.full(contact.space.nmacros, True)), gf.vec)
        contact.Evaluate(gf)
        assert set(contact.Table()["status"]) == {1}
    free = AsNumPy(ScalarDofs(gf.space.FreeDofs(a.condense), gf.space))
    bodies = Bodies(a.mat, contact, free)
    return bodies.Names(bodies.Freedom([contact]).weights)


def said(body, motions):
    return [f"body {body} floats ({motion})" for motion in motions]


# A block that hangs on springs along x turns about its top.
BLOCK, GUIDED = said("'block'", PLANE), said("'guided'", PLANE[1:2])
HUNG = said("'hung'", PLANE[1:])
FREE = [
    line
    for k, middle in ((1, "(4.5, 0.5)"), (2, "(8.5, 0.5)"))
    for line in said(f"'free' ({k} of 2, around {middle})", PLANE)
]


@pytest.mark.parametrize(
    ("make", "options", "expected"),
    [
        (lambda m: VectorH1(m, order=2, **FLAGS), {}, FREE + GUIDED + HUNG),
        (lambda m: VectorH1(m, order=3, **FLAGS), {}, FREE + GUIDED + HUNG),
        (lambda m: VectorH1(m, order=4, **FLAGS), {"condense": True}, FREE + GUIDED + HUNG),
        (lambda m: H1(m, order=2, dim=2, **BLOCKS), {}, FREE + HUNG),
        (lambda m: VectorH1(m, order=2, definedon="b.*|guided", **FLAGS), {}, GUIDED),
    ],
)
def test_each_body_by_itself(make, options, expected, mesh):
    made = parts(make(mesh), **options)
    assert floating(*made, closed=True) == expected
    assert floating(*made, lift=0) == BLOCK + expected


def test_a_displacement_among_other_fields(mesh):
    """Heat, and a number that all bodies feel: what only they connect stays apart."""
    heat, number = H1(mesh, order=1, dirichlet=".*"), NumberSpace(mesh)
    a, gf, contact, trial, test = parts(VectorH1(mesh, order=2, **FLAGS), (heat, number))
    a += grad(trial[0]) * grad(test[0]) * dx - trial[0] * div(test[2]) * dx
    a += (trial[1] * test[2][0] + test[1] * trial[2][0]) * dx
    assert floating(a, gf, contact, lift=2) == BLOCK + FREE + GUIDED + HUNG


def test_a_body_that_repeats_itself_cannot_turn():
    """The left and the right side are one: a space whose dofs tell no positions."""
    face = Rectangle(1, 1).Face()
    face.edges.Min(EAST).Identify(face.edges.Max(EAST), "sides")
    face.faces.name, face.edges.Min(NORTH).name = "block", "block_bottom"
    V = Periodic(VectorH1(Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=0.3)), order=2))
    made = posed(V, lambda u, v, load: linear(u, v), slave="block_bottom", obstacle=y + 1)
    assert floating(made.a, made.gf, made.contact) == said("'block'", PLANE[:2])


def test_matrices_of_blocks_as_scipy_has_them(mesh):
    V = H1(mesh, order=2, dim=2)
    u, v = V.TnT()
    mat = BilinearForm(linear(u, v) + u[0] * v[1] * dx).Assemble().mat
    x = np.random.default_rng(0).normal(size=2 * V.ndof)
    vec = mat.CreateColVector()
    vec.FV().NumPy()[:] = x
    assert ToCSR(mat) @ x == pytest.approx((mat * vec).Evaluate().FV().NumPy(), abs=1e-12)
