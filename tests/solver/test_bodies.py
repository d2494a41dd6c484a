"""Rigid motions that nothing prevents: how they are found, in every kind of space and coupling."""

from functools import reduce
from operator import mul

import numpy as np
import pytest
from netgen.occ import Compound, OCCGeometry, Pnt, Rectangle, Sphere
from netgen.occ import X as EAST
from netgen.occ import Y as NORTH
from ngsolve import (
    BND,
    CF,
    H1,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
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
from ngsolve.la import SparseMatrixd
from press import brick, linear, press, press3d

from ngslac import BubbleVectorH1, LACContact, LACSpace
from ngslac.arrays import AsBits, AsNumPy, ScalarDofs
from ngslac.bodies.bodies import AreApart, Bodies, ConnectedParts, Forces, LikelyParts, ToCSR
from ngslac.bodies.rigidmotions import RigidMotions

PLANE = ["translation in x", "translation in y", "rotation"]
BODIES = ["block", "base", "free", "fixed", "guided", "hung"]


# --- the motions themselves --------------------------------------------------------------------


def ball():
    sphere = Sphere(Pnt(0, 0, 0), 1)
    sphere.faces.name = "slave"
    return Mesh(OCCGeometry(sphere).GenerateMesh(maxh=1)).Curve(2)


def moved_mesh():
    mesh = brick(2, "tet")
    shift = GridFunction(VectorH1(mesh, order=1))
    shift.Set(CF((0.2 * y, 0.1 * x * z, 0)))
    mesh.SetDeformation(shift)
    mesh.shift = shift  # keep it
    return mesh


SPACES = {
    "P1": lambda: VectorH1(press().mesh, order=1),
    "P3": lambda: VectorH1(press().mesh, order=3),
    "blocks": lambda: H1(press().mesh, order=2, dim=2),
    "bubbles": lambda: BubbleVectorH1(press().mesh, order=1, slave="slave"),
    "bricks": lambda: VectorH1(brick(2), order=2),
    "prisms": lambda: H1(brick(2, "prism"), order=3, dim=3),
    "pyramids": lambda: VectorH1(brick(1, "pyramid"), order=2),
    "curved": lambda: VectorH1(ball(), order=2),
    "part": lambda: VectorH1(press().mesh, order=2, definedon="upper"),
}
OTHERS = {
    "discontinuous": lambda: VectorL2(press().mesh, order=2),
    "deformed": lambda: VectorH1(moved_mesh(), order=2),
}


@pytest.mark.parametrize("kind", [*SPACES, *OTHERS])
def test_motions_are_rigid(kind, monkeypatch):
    """Those of common spaces without setting a GridFunction on the volume."""
    space, sets, Set = (SPACES | OTHERS)[kind](), [], GridFunction.Set
    d, gf = space.mesh.dim, GridFunction(space)
    watched = {"Set": lambda gf, *args, **where: (sets.append(where), Set(gf, *args, **where))}
    monkeypatch.setattr(GridFunction, "Set", watched["Set"])
    motions, names, _ = RigidMotions(space)
    monkeypatch.undo()
    assert sum(not where for where in sets) == (0 if kind in SPACES else len(names))
    assert motions.shape[1] == len(names) == len(set(names)) == d * (d + 1) // 2
    where, place = space.mesh.Materials("upper" if kind == "part" else ".*"), CF((x, y, z)[:d])
    volume, middle = (np.array(Integrate(c, where, order=6)) for c in (CF(1), place))
    for k, motion in enumerate(motions.T):
        gf.vec.FV().NumPy()[:] = motion
        spin = np.array(Integrate(Grad(gf), where, order=6)).reshape(d, d) / volume
        mean = np.array(Integrate(gf, where, order=6)) / volume
        affine = CF(tuple(spin.ravel()), dims=(d, d)) * (place - CF(tuple(middle / volume)))
        error = gf - affine - CF(tuple(mean))
        assert Integrate(InnerProduct(error, error), where, order=6) < 1e-20
        assert spin == pytest.approx(-spin.T, abs=1e-10)
        if k < d:
            assert mean == pytest.approx(np.eye(d)[k], abs=1e-10)
            assert np.abs(spin).max() < 1e-10
        else:
            i, j = (0, 1) if d == 2 else [(1, 2), (2, 0), (0, 1)][k - d]
            assert spin[j, i] > 0.2
            assert np.linalg.norm(spin) == pytest.approx(np.sqrt(2) * spin[j, i], rel=1e-10)


# --- connected parts of a matrix ---------------------------------------------------------------


def sparse(n, pairs):
    """A symmetric matrix with diagonal n + 1 that connects the pairs."""
    i, j = np.array(pairs).T
    rows = np.concatenate([np.arange(n), i, j])
    columns = np.concatenate([np.arange(n), j, i])
    values = np.concatenate([np.full(n, n + 1.0), np.full(2 * len(i), -1.0)])
    return SparseMatrixd.CreateFromCOO(list(rows), list(columns), list(values), n, n)


def test_parts_of_a_matrix():
    """0 to 3 hang together through what is neither the first nor the last of their rows."""
    mat = sparse(9, [(0, 1), (2, 3), (1, 2), (4, 6), (0, 7), (3, 7), (2, 8)])
    part = ConnectedParts(mat, 0, 7)
    assert [int(p) for p in part == part[0]] == [1, 1, 1, 1, 0, 0, 0]
    assert part[4] == part[6] != part[5]
    whole = ConnectedParts(mat, 0, 9)
    assert len(set(whole[[0, 1, 2, 3, 7, 8]])) == 1
    apart = ConnectedParts(sparse(9, [(0, 8), (1, 8), (6, 7)]), 5, 4)  # rows 5 to 8
    assert apart[1] == apart[2]
    assert len(set(apart)) == 3


def test_likely_parts_are_checked():
    """A middle entry of a row is overseen at first, and found by a product."""
    pairs = [(0, 1), (1, 2), (0, 2), (3, 4), (4, 5), (3, 5)]
    values = np.random.default_rng(3).standard_normal(6)
    for extra, joined in (([], False), ([(1, 3)], True), ([(0, 5)], True)):
        mat = sparse(6, pairs + extra)
        forces, part = Forces(mat, 0, 6), np.array([0, 0, 0, 1, 1, 1])
        assert AreApart(part, forces, values, forces(values)) is not joined
        assert len(set(ConnectedParts(mat, 0, 6))) == 2 - joined
    chain = sparse(7, [(0, 6), (1, 6), (2, 6), (0, 1), (3, 5), (0, 2)])
    assert len(set(LikelyParts(chain, 0, 7))) == len(set(ConnectedParts(chain, 0, 7))) == 3


# --- bodies ------------------------------------------------------------------------------------


def row_of_bodies():
    """A block above its base, and further unit squares beside it; edges: material and side."""
    faces = []
    for k, name in enumerate(BODIES):
        width = 1.5 if name == "base" else 1  # of the same width the meshes would match
        place = (-0.2, -1, 0) if name == "base" else (2 * k, 0, 0)
        face = Rectangle(width, 1).Face().Move(place)
        face.faces.name, face.faces.maxh = name, 0.3
        face.edges.Min(EAST).name, face.edges.Max(EAST).name = f"{name}_left", f"{name}_right"
        face.edges.Min(NORTH).name, face.edges.Max(NORTH).name = f"{name}_bottom", f"{name}_top"
        faces.append(face)
    mesh = Mesh(OCCGeometry(Compound(faces), dim=2).GenerateMesh())
    names = [mesh.GetBoundaries()[e.index] for e in mesh.Elements(BND)]
    assert names.count("block_bottom") != names.count("base_top")
    return mesh


FLAGS = {"dirichlet": "base_bottom|fixed_left", "dirichletx": "guided_left"}


def parts(V, before=(), **options):
    """Bulk form, solution, contact, trial and test functions; `before` are spaces in front of V."""
    k, fes = len(before), reduce(mul, [*before, V, LACSpace(V, slave="block_bottom")])
    trial, test = fes.TnT()
    a = BilinearForm(fes, **options)
    a += linear(trial[k], test[k]) + 20 * trial[k][0] * test[k][0] * ds("hung_top")
    contact = LACContact(trial[k], trial[k + 1], master="base_top", friction=0.3)
    return a, GridFunction(fes), contact, trial, test


def floating(a, gf, contact, change=None, status=None):
    """What is said to float; `change` makes another matrix, `status` closes macro-elements."""
    a.AssembleLinearization(gf.vec)
    contact.Prepare(a.mat)
    contact.Evaluate(gf)
    if status:
        contact.form.Close(AsBits(np.full(contact.space.nmacros, True)), gf.vec)
        contact.Evaluate(gf)
        assert set(contact.Table()["status"]) == {status}
    free = AsNumPy(ScalarDofs(gf.space.FreeDofs(a.condense), gf.space))
    return Bodies(change(a.mat) if change else a.mat, contact, free).Floating([contact])


def said(body, motions):
    return [f"body '{body}' floats ({motion})" for motion in motions]


# A block that hangs on springs along x turns about its top.
BLOCK, OTHER = said("block", PLANE), said("guided", PLANE[1:2]) + said("hung", PLANE[1:])
FREE = said("free", PLANE)


@pytest.fixture(scope="module")
def mesh():
    return row_of_bodies()


def lifted(gf, k=0):
    gf.components[k].Set(gf.space.mesh.MaterialCF({"block": CF((0, 0.1))}, default=CF((0, 0))))


@pytest.mark.parametrize("order", [2, 3])
def test_each_body_by_itself(mesh, order):
    a, gf, contact, *_ = parts(VectorH1(mesh, order=order, **FLAGS))
    assert floating(a, gf, contact, status=1) == FREE + OTHER
    lifted(gf)
    assert floating(a, gf, contact) == BLOCK + FREE + OTHER


def test_blocks_of_dofs_and_condensed_dofs(mesh):
    for V, options in (
        (H1(mesh, order=2, dim=2, dirichlet="base_bottom|fixed_left|guided_left"), {}),
        (VectorH1(mesh, order=4, **FLAGS), {"condense": True}),
    ):
        a, gf, contact, *_ = parts(V, **options)
        lifted(gf)
        expected = BLOCK + FREE + (OTHER if V.dim == 1 else OTHER[1:])
        assert floating(a, gf, contact) == expected


def test_a_displacement_among_other_fields(mesh):
    """Heat, and a number that all bodies feel: what only they connect stays apart."""
    heat, number = H1(mesh, order=1, dirichlet=".*"), NumberSpace(mesh)
    a, gf, contact, trial, test = parts(VectorH1(mesh, order=2, **FLAGS), (heat, number))
    a += grad(trial[0]) * grad(test[0]) * dx - trial[0] * div(test[2]) * dx
    a += (trial[1] * test[2][0] + test[1] * trial[2][0]) * dx
    lifted(gf, 2)
    assert floating(a, gf, contact) == BLOCK + FREE + OTHER


def test_a_displacement_of_some_bodies(mesh):
    a, gf, contact, *_ = parts(VectorH1(mesh, order=2, definedon="b.*|guided", **FLAGS))
    lifted(gf)
    assert floating(a, gf, contact) == BLOCK + OTHER[:1]


def test_springs_between_bodies_that_share_no_node(mesh):
    """Three springs in different directions, along lines that do not meet, make one body of two."""
    V = VectorH1(mesh, order=2, **FLAGS)
    a, gf, contact, *_ = parts(V)
    lifted(gf)
    join = lambda *pair: lambda mat: with_springs(mat, V, *pair)  # noqa: E731
    assert floating(a, gf, contact, join("free", "fixed")) == BLOCK + OTHER
    assert floating(a, gf, contact, join("block", "free")) == BLOCK + OTHER
    # What hangs on a body that can do what it likes is not held by it.
    assert len(floating(a, gf, contact, join("free", "hung"))) == len(BLOCK + OTHER)


def with_springs(mat, V, first, second):
    """The bulk matrix and springs between the corners of two bodies, which keep their distance."""
    mesh, corners = V.mesh, []
    for name in (first, second):
        dofs = AsNumPy(H1(mesh, order=1).GetDofs(mesh.Materials(name)))
        corners.append(np.flatnonzero(dofs)[:2])
    points, n = np.array([v.point for v in mesh.vertices]), V.ndof // 2
    total = ToCSR(mat).tocoo()
    rows, columns, values = list(total.row), list(total.col), list(total.data)
    for i, j in ((0, 0), (0, 1), (1, 0)):
        p, q = corners[0][i], corners[1][j]
        along = (points[q] - points[p]) / np.linalg.norm(points[q] - points[p])
        dofs, direction = [p, p + n, q, q + n], np.concatenate([along, -along])
        for r, f in zip(dofs, direction, strict=True):
            for c, g in zip(dofs, direction, strict=True):
                rows.append(r), columns.append(c), values.append(100 * f * g)
    return SparseMatrixd.CreateFromCOO(rows, columns, values, mat.height, mat.height)


def test_bodies_that_float_together_are_named_after_the_first():
    """Rounding does not choose between two that are as good."""
    problem = press3d(spring=0, friction=0.5, flags={"dirichlet": ""})
    found = floating(problem.a, problem.gf, problem.contact, status=1)
    motions = ("translation in", "rotation about")
    assert found == said("upper", [f"{motion} {c}" for motion in motions for c in "xyz"])


def test_a_body_that_repeats_itself_cannot_turn():
    """The left and the right side are one: a space whose dofs tell no positions."""
    face = Rectangle(1, 1).Face()
    face.edges.Min(EAST).Identify(face.edges.Max(EAST), "sides")
    face.faces.name, face.edges.Min(NORTH).name = "block", "block_bottom"
    mesh = Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=0.3))
    V = Periodic(VectorH1(mesh, order=2))
    fes = V * LACSpace(V, slave="block_bottom")
    (u, lam), (v, _) = fes.TnT()
    a = BilinearForm(fes)
    a += linear(u, v)
    contact = LACContact(u, lam, obstacle=y + 1)
    assert floating(a, GridFunction(fes), contact) == said("block", PLANE[:2])
