"""Slaves of which some displacement components are prescribed: macro-elements carry the others."""

import numpy as np
import pytest
from netgen.occ import Compound, MoveTo, OCCGeometry
from ngsolve import (
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Mesh,
    Sym,
    Trace,
    Variation,
    VectorH1,
    ds,
    dx,
    log,
)

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D

PUSH = 0.02
SOLVERS = ["direct", "saddle"]


def linear(u, v):
    return (2 * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) + Trace(Grad(u)) * Trace(Grad(v))) * dx


def neo_hooke(u):
    F = Id(u.dim) + Grad(u)
    return Variation((InnerProduct(F, F) - 2 * log(Det(F)) + log(Det(F)) ** 2 / 2) * dx)


def problem(V, slave="slave", push=PUSH, **law):
    """Pressed down by `push`: contact, solution and a solver of each kind."""
    X = V * LACSpace(V, slave=slave)
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += neo_hooke(u) if law.get("finite") else linear(u, v)
    a += push * v[V.mesh.dim - 1] * ds("top")
    gf, contact = GridFunction(X), LACContact(u, lam, master="master", **law)
    return contact, gf, lambda solver=None: ContactSolver(a, gf, contact, solver=solver)


def inclined(slope):
    """Two blocks that meet in a line of this slope, of height 1 over it."""
    lower = MoveTo(0, -1).LineTo(1, -1, "bottom").LineTo(1, slope).LineTo(0, 0, "master").Close()
    upper = MoveTo(0, 0).LineTo(1, slope, "slave").LineTo(1, 1 + slope, "side")
    upper = upper.LineTo(0, 1 + slope, "top").LineTo(0, 0, "side")
    shapes = lower.Face(), upper.Face()
    for shape, name, h in zip(shapes, ("master", "slave"), (0.3, 0.21), strict=True):
        for edge in shape.edges:
            if edge.name == name:
                edge.maxh = h
    return Mesh(OCCGeometry(Compound(shapes), dim=2).GenerateMesh(maxh=0.35))


@pytest.mark.pairwise
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("law", [{}, {"friction": 0.3}, {"tied": True}], ids=str)
@pytest.mark.parametrize(
    "space",
    [
        lambda m, **fixed: VectorH1(m, order=1, **fixed),
        lambda m, **fixed: VectorH1(m, order=2, **fixed),
        lambda m, **fixed: BubbleVectorH1(m, order=1, slave="slave", **fixed),
    ],
    ids=["P1", "P2", "bubble"],
)
def test_tangent_prescribed_in_2d(space, law, solver):
    V = space(TwoBlocks(0.2, 0.3), dirichlet="bottom", dirichletx="slave|top")
    contact, _, make = problem(V, **law)
    make(solver).Solve(printing=False)
    assert contact.Force()[1] == pytest.approx(PUSH, rel=1e-9)
    assert np.all(contact.Table()["pressure"] > 0)
    assert np.abs(contact.Table()["gap"]).max() < 1e-12


@pytest.mark.pairwise
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("kind", ["hex", "tet"])
@pytest.mark.parametrize("fixed", ["x", "xy"])
def test_tangents_prescribed_in_3d(fixed, kind, solver):
    flags = {f"dirichlet{c}": "slave|top" if c in fixed else "top" for c in "xy"}
    V = VectorH1(TwoBlocks3D(kind, n_slave=4, n_master=3), order=1, dirichlet="bottom", **flags)
    contact, _, make = problem(V, friction=0.3)
    make(solver).Solve(printing=False)
    assert contact.Force()[2] == pytest.approx(PUSH, rel=1e-9)


def test_plane_strain_in_3d_is_that_of_2d():
    """u_y = 0 everywhere on a slab of hexahedra: pressures and frictions are those of quads."""
    flags = {"dirichlet": "bottom", "dirichletx": "top"}
    quads = TwoBlocks(1 / 4, 1 / 3, quads=True, structured=True)
    slab = TwoBlocks3D(n_slave=4, n_master=3, layers=(4, 3))
    tables = []
    for V in VectorH1(quads, order=2, **flags), VectorH1(slab, order=2, dirichlety=".*", **flags):
        contact, _, make = problem(V, friction=0.1)
        make().Solve(printing=False)
        table = contact.Table()
        assert np.abs(table["traction"][:, 1:-1]).max(initial=0) < 1e-12
        order = np.argsort(table["x"][:, 0].round(6), kind="stable")
        tables.append([table[name][order] for name in ("pressure", "traction", "status")])
    for flat, deep in zip(*tables, strict=True):
        columns = [0, -1] if flat.ndim > 1 else slice(None)
        deep = deep[:, columns] if flat.ndim > 1 else deep
        np.testing.assert_allclose(deep, np.repeat(flat, 4, axis=0), atol=1e-9)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("solver", SOLVERS)
def test_inclined_slave(solver, finite):
    """The normal is no axis: without friction no shear, with friction its bound."""
    slope = 0.6
    V = VectorH1(inclined(slope), order=2, dirichlet="bottom", dirichletx="slave|side|top")
    n = np.array([slope, -1]) / np.hypot(slope, 1)
    for friction, ratio in (None, 0), (0.3, 0.3):
        contact, _, make = problem(V, push=0.005, friction=friction, finite=finite)
        make(solver).Solve(printing=False)
        force = contact.Force()
        shear = abs(force @ [n[1], -n[0]] / (force @ n))
        # Slave faces tilt a little where everything turns with the deformation.
        assert shear == pytest.approx(ratio, abs=5e-3 if finite else 1e-9)
        assert force @ n < 0


@pytest.mark.parametrize("angle", [90, 88])
def test_normal_that_cannot_be_reached(angle):
    mesh = inclined(1.0) if angle == 90 else inclined(np.tan(np.radians(angle)))
    flags = {"dirichlet": "slave"} if angle == 90 else {"dirichletx": "slave"}
    with pytest.raises(Exception, match=r"no displacement is free there along the normal.*Remedy"):
        LACSpace(VectorH1(mesh, order=2, **flags), slave="slave")


def test_dragged_slave_rubs():
    """A slave that is moved along the master carries friction, though it cannot follow it."""
    mesh = TwoBlocks(0.2, 0.3)
    V = VectorH1(mesh, order=2, dirichlet="bottom", dirichletx="slave|right_upper|left_upper|top")
    contact, gf, make = problem(V, friction=0.3)
    make().Solve(printing=False)
    contact.Commit(gf)
    gf.components[0].components[0].Set(0.1, definedon=mesh.Materials("upper"))
    solver = make()
    solver.Solve(printing=False)
    contact.Commit(gf)
    assert contact.Force() == pytest.approx([-0.3 * PUSH, PUSH], rel=1e-9)
    table = contact.Table()
    assert np.all(table["status"] == 2)
    solver.Solve(printing=False)  # nothing moves: the traction stays
    assert contact.Force() == pytest.approx([-0.3 * PUSH, PUSH], rel=1e-9)
    assert np.abs(contact.Table()["traction"] - table["traction"]).max() < 1e-9


def test_sticking_traction_is_kept_over_steps():
    V = VectorH1(TwoBlocks(0.2, 0.3), order=2, dirichlet="bottom", dirichletx="slave|top")
    contact, gf, make = problem(V, friction=0.9)
    solver = make()
    solver.Solve(printing=False)
    before = contact.Table()
    contact.Commit(gf)
    solver.Solve(printing=False)
    assert np.all(before["status"] == 1)
    assert np.abs(before["traction"][:, 0]).max() > 1e-4 * PUSH
    np.testing.assert_allclose(contact.Table()["traction"], before["traction"], atol=1e-10)


def test_tied_slave_follows_the_master_in_its_free_direction():
    V = VectorH1(TwoBlocks(0.2, 0.3), order=2, dirichlet="bottom", dirichletx=".*")
    contact, _, make = problem(V, tied=True, push=-PUSH)  # pulled
    make().Solve(printing=False)
    assert contact.Force() == pytest.approx([0, -PUSH], abs=1e-12)
    assert contact.Table()["pressure"] == pytest.approx(-PUSH, rel=1e-9)  # uniform
