"""Which faces of a surface that is slave and master at once see each other."""

import numpy as np
import pytest
from netgen.occ import Box, Circle, MoveTo, OCCGeometry
from ngsolve import GridFunction, Mesh, VectorH1

from ngslac import LACContact, LACSpace


def slit(width=0.05, h=0.2):
    """A square with a slot: its two long sides face each other across the slot."""
    shape = (
        MoveTo(-1, -1).Rectangle(2, 2).Face() - MoveTo(-1.5, -width / 2).Rectangle(2, width).Face()
    )
    shape.edges.name = "outside"
    for edge in shape.edges:
        if abs(abs(edge.center.y) - width / 2) < 1e-9 or abs(edge.center.x - 0.5) < 1e-9:
            edge.name = "slot"
    return Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=h))


def selfcontact(mesh, region="slot", **flags):
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave=region)
    u, lam = X.TrialFunction()
    contact = LACContact(u, lam, master=region, finite=True, **flags)
    contact.Update()
    return contact


def test_one_side_is_the_slave():
    contact = selfcontact(slit())
    table = contact.Table()
    paired = table["area"] > 0
    sides = np.sign(table["x"][paired, 1])
    assert paired.sum() > 4
    assert abs(sides.sum()) == len(sides)  # all on one side
    assert table["gap"][paired] == pytest.approx(0.05, rel=1e-9)
    assert table["area"].sum() == pytest.approx(1.5, rel=1e-9)


def test_both_sides_while_far_apart():
    contact = selfcontact(slit(width=0.9))
    table = contact.Table()
    assert set(np.sign(table["x"][table["area"] > 0, 1])) == {-1, 1}


def test_neighbours_never_pair():
    """In a convex hole every face sees the opposite side, none its neighbours."""
    shape = MoveTo(-2, -2).Rectangle(4, 4).Face() - Circle((0, 0), 1).Face()
    shape.edges.name = "outside"
    for edge in shape.edges:
        if abs(np.hypot(edge.start.x, edge.start.y) - 1) < 1e-9:
            edge.name = "hole"
    mesh = Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.2)).Curve(2)
    contact = selfcontact(mesh, "hole")
    gap = contact.Table()["gap"][contact.Table()["area"] > 0]
    assert gap == pytest.approx(2, rel=0.02)


def test_slave_that_is_closed_stays_the_slave():
    contact = selfcontact(slit())
    table, gf = contact.Table(), GridFunction(contact.form.fes)
    other = np.flatnonzero(table["area"] == 0)
    other = other[np.abs(table["x"][other, 0] + 0.25) < 0.5]
    dofs = contact.form.MultiplierDofs().reshape(-1, 2)
    gf.vec.FV().NumPy()[dofs[other]] = -table["normal"][other]
    contact.Follow(gf)
    contact.Evaluate(gf)
    assert np.all(contact.Table()["area"][other] > 0)


def test_needs_finite_sliding():
    mesh = slit()
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="slot")
    u, lam = X.TrialFunction()
    with pytest.raises(ValueError, match="finite=True"):
        LACContact(u, lam, master="slot")


def test_one_side_is_the_slave_in_3d():
    """A slot in a block: its lower and upper faces are 2 x 1.4 each."""
    block = Box((-1, -1, -1), (1, 1, 1)) - Box((-2, -2, -0.03), (0.4, 2, 0.03))
    for face in block.faces:
        face.name = "slot" if abs(abs(face.center.z) - 0.03) < 1e-9 else "outside"
    contact = selfcontact(Mesh(OCCGeometry(block).GenerateMesh(maxh=0.7)))
    table = contact.Table()
    paired = table["area"] > 0
    assert len(set(np.sign(table["x"][paired, 2]))) == 1
    assert table["gap"][paired] == pytest.approx(0.06, rel=1e-9)
    assert table["area"].sum() == pytest.approx(2.8, rel=1e-9)
