"""Partial overlap (T22), conservation (T21), and bodies that contact alone holds (T23)."""

import numpy as np
import pytest
from elasticity import Displacements, Material, Pair
from ngsolve import CF, GridFunction, InnerProduct, Integrate, ds, x, y

from ngslac import ContactSolver, FloatingBodyError
from ngslac.meshes import TwoBlocks

TOL = 1e-12
KINDS = ["P1", "P1split", "P1bubble", "P2", "P3"]


def Moved(mesh, V, shift):
    """The upper block displaced as a rigid body."""
    gf = GridFunction(V)
    gf.Set(mesh.MaterialCF({"upper": shift, "lower": (0.0, 0.0)}))
    return gf


# ---------------------------------------------------------------- partial overlap


@pytest.mark.parametrize("kind", KINDS)
def test_constant_stress_where_faces_overlap_in_part(kind):
    """The slave is wider than the master, and none of its nodes lies at the master's ends.

    Its free parts carry the load of the constant stress: that of all its faces less that of the
    segments, which the operator D knows. What M then gives to the master must be exact as well.
    """
    pressure = 25.0
    mesh = TwoBlocks(0.23, 0.11, overhang=-0.17, aligned=False)
    V = Displacements(mesh, kind, dirichletx="left.*", dirichlety="bottom")
    mesh = V.mesh
    pair = Pair(V, Material())
    pair.Load(CF((0, -pressure)), "top")
    pair.Load(CF((0, pressure)), "slave")
    pair.load.Assemble()
    D, _ = pair.contact.Mortar()
    table = pair.contact.Table()
    lam = D.CreateColVector()
    lam.FV().NumPy()[:] = np.tile([0.0, pressure], len(table["area"]))
    paired = D.T * lam
    vector = pair.load.vec.CreateVector(copy=True)
    vector.FV().NumPy()[: V.ndof] -= paired.Evaluate().FV().NumPy()
    solver = ContactSolver(pair.a, pair.gf, pair.contact, rhs=vector)
    solver.Solve(tol=1e-13, printing=False)
    table = pair.contact.Table()
    share = table["area"] / table["fullarea"]
    assert np.any((share > 0.01) & (share < 0.99))
    assert pair.StressError(np.diag([0.0, -pressure])) <= TOL
    closed = share > 0
    assert np.abs(table["pressure"][closed] / pressure - 1).max() <= TOL
    assert np.all(table["pressure"][~closed] == 0)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("overhang", [-0.17, 0.17])
def test_operators_integrate_over_the_overlap_only(kind, overhang):
    """Constants and linear fields: areas and first moments of the overlap 0 < x < 1."""
    mesh = TwoBlocks(0.23, 0.11, overhang=overhang, aligned=False)
    V = Displacements(mesh, kind)
    pair = Pair(V, Material())
    field = GridFunction(V)
    for value, exact in [((1.0, 1.0), [1.0, 1.0]), ((x, 2 * x), [0.5, 1.0])]:
        field.Set(CF(value))
        for operator in pair.contact.Mortar():
            means = (operator * field.vec).Evaluate().FV().NumPy().reshape(-1, 2)
            assert means.sum(axis=0) == pytest.approx(exact, abs=1e-13)


def Slid(kind, slave, offset):
    """The upper block pressed down at an offset, solved."""
    master = "master" if slave == "slave" else "slave"
    V = Displacements(TwoBlocks(0.25), kind, slave=slave, dirichlet="bottom|top")
    pair = Pair(V, Material(), slave=slave, master=master)
    pair.displacement.vec.data = Moved(V.mesh, V, (offset, -1e-3)).vec
    pair.contact.Update(pair.gf)
    pair.Solve(tol=1e-10)
    return pair.contact


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("slave", ["slave", "master"])
def test_sliding_off_the_edge(kind, slave):
    """The force decreases to that on a sliver, which is small against that on a macro-element."""
    forces = []
    for offset in [0.0, 0.13, 0.25, 0.5, 0.77, 0.96, 0.9999]:
        contact = Slid(kind, slave, offset)
        table = contact.Table()
        assert table["area"].sum() == pytest.approx(1 - offset, abs=1e-13)
        assert np.all(table["pressure"] >= 0)
        assert np.all(table["pressure"][table["area"] == 0] == 0)
        assert abs(contact.Force()[0]) < 1e-13
        forces.append(np.linalg.norm(contact.Force()))
    assert np.all(np.diff(forces) < 0)
    assert forces[0] > 1.1
    assert forces[-1] < 0.25


@pytest.mark.parametrize("kind", ["P1", "P2"])
@pytest.mark.parametrize("left", [1e-7, 1e-12])
def test_nothing_left_to_touch(kind, left):
    """A sliver below the resolution counts as nothing; the block hangs freely, without stress."""
    contact = Slid(kind, "slave", 1 - left)
    table = contact.Table()
    assert np.all(table["area"] == 0)
    assert np.all(table["status"] == 0)
    assert np.all(contact.Force() == 0)
    assert "without partner" in str(contact.Check())


def test_surfaces_that_never_meet_are_an_error():
    with pytest.raises(Exception, match="slave and master never meet"):
        Slid("P2", "slave", 1.1)


# ---------------------------------------------------------------- conservation


def Unsupported(kind, *, overhang=0.0, load, **law):
    """A block held by contact alone under an uneven load, solved."""
    mesh = TwoBlocks(0.2, 0.11, overhang=overhang, aligned=False)
    V = Displacements(mesh, kind, dirichlet="bottom")
    pair = Pair(V, Material(), **law)
    pair.Load(load, "top")
    last = pair.Solve(tol=1e-13)
    return pair, last


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("overhang", [0.0, -0.17, 0.17])
def test_resultants_balance_the_load(kind, overhang):
    """Force and moment of the contact hold the upper block; the lower one gets the opposite."""
    load = CF((0.05, -(1 + x * x)))
    pair, _ = Unsupported(kind, overhang=overhang, load=load, friction=0.4)
    mesh, contact = pair.mesh, pair.contact
    force = [Integrate(f * ds("top"), mesh) for f in (load[0], load[1])]
    assert np.asarray(contact.Force()) == pytest.approx(-np.array(force), rel=TOL, abs=TOL)
    for px, py in [(0.0, 0.0), (0.4, -3.0)]:
        moment = Integrate(((x - px) * load[1] - (y - py) * load[0]) * ds("top"), mesh)
        assert contact.Moment((px, py)) == pytest.approx(-moment, rel=TOL)
    table, jump = contact.Table(), []
    for operator in contact.Mortar():
        lam = operator.CreateColVector()
        lam.FV().NumPy()[:] = table["traction"].ravel()
        nodal = (operator.T * lam).Evaluate()
        unit = GridFunction(pair.displacement.space)
        jump.append([])
        for field in [(1.0, 0.0), (0.0, 1.0), (-y, x)]:
            unit.Set(CF(field))
            jump[-1].append(InnerProduct(nodal, unit.vec))
    assert jump[0] == pytest.approx(jump[1], rel=TOL, abs=TOL)


# ---------------------------------------------------------------- no Dirichlet condition


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("law", [{"friction": 0.3}, {"tied": True}])
def test_start_without_support(kind, law):
    """Contact alone holds the upper block under a pressure; the exact stress is constant."""
    pair, last = Unsupported(kind, load=CF((0.0, -25.0)), **law)
    assert last.number <= 8
    # The lower block is clamped at its foot, which lets its stress vary: look at the resultant.
    assert pair.contact.Force() == pytest.approx([0.0, 25.0], rel=TOL, abs=25 * TOL)


@pytest.mark.parametrize("kind", KINDS)
def test_start_without_support_frictionless(kind):
    """A symmetry condition stops sliding; contact has to stop falling and turning."""
    V = Displacements(TwoBlocks(0.25), kind, dirichletx="left.*", dirichlety="bottom")
    pair = Pair(V, Material())
    pair.Load(CF((0.0, -25.0)), "top")
    pair.Solve(tol=1e-13)
    assert pair.StressError(np.diag([0.0, -25.0])) <= TOL


def test_frictionless_contact_does_not_stop_sliding():
    with pytest.raises(FloatingBodyError, match=r"'upper' floats \(translation in x\)"):
        Unsupported("P2", load=CF((0.0, -25.0)))


def test_nothing_closed_at_the_start_is_an_error_if_asked_for():
    V = Displacements(TwoBlocks(0.25), "P2", dirichlet="bottom")
    pair = Pair(V, Material(), friction=0.3)
    pair.displacement.vec.data = Moved(V.mesh, V, (0.0, 0.01)).vec
    pair.Load(CF((0.0, -25.0)), "top")
    pair.load.Assemble()
    solver = ContactSolver(pair.a, pair.gf, pair.contact, rhs=pair.load.vec, initial="none")
    with pytest.raises(FloatingBodyError, match="'upper' floats"):
        solver.Solve(printing=False)


@pytest.mark.parametrize("kind", ["P1bubble", "P2"])
def test_block_that_has_to_fall_first(kind):
    """The blocks are apart at the start: the nearest macro-elements close."""
    V = Displacements(TwoBlocks(0.25), kind, dirichletx="left.*", dirichlety="bottom")
    pair = Pair(V, Material())
    pair.displacement.vec.data = Moved(V.mesh, V, (0.0, 0.05)).vec
    pair.Load(CF((0.0, -25.0)), "top")
    pair.Solve(tol=1e-13)
    assert pair.StressError(np.diag([0.0, -25.0])) <= TOL
