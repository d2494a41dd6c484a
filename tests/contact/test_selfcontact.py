"""Which faces of a surface that is slave and master at once see each other."""

import numpy as np
import pytest
from blocks import macro_dofs
from netgen.occ import Box, Circle, MoveTo, OCCGeometry
from ngsolve import GridFunction, Mesh, VectorH1

from ngslac import LACContact, LACSpace


def named(shape, parts, inside, h):
    """The mesh of a shape whose `parts` that are `inside` are its slot."""
    for part in parts:
        part.name = "slot" if inside(part.center) else "outside"
    dim = 2 if len(list(shape.solids)) == 0 else 3
    return Mesh(OCCGeometry(shape, dim=dim).GenerateMesh(maxh=h))


def slit(width=0.05):
    """A square with a slot: its two long sides face each other across the slot."""
    cut = MoveTo(-1.5, -width / 2).Rectangle(2, width).Face()
    shape = MoveTo(-1, -1).Rectangle(2, 2).Face() - cut
    return named(shape, shape.edges, lambda c: abs(c.y) < width / 2 + 1e-9 and c.x > -0.9, 0.2)


def slit3d():
    """A slot in a block: its lower and upper faces are 2 x 1.4 each."""
    block = Box((-1, -1, -1), (1, 1, 1)) - Box((-2, -2, -0.03), (0.4, 2, 0.03))
    return named(block, block.faces, lambda c: abs(abs(c.z) - 0.03) < 1e-9, 0.7)


def selfcontact(mesh, **law):
    V = VectorH1(mesh, order=2)
    u, lam = (V * LACSpace(V, slave="slot")).TrialFunction()
    contact = LACContact(u, lam, master="slot", finite=True, **law)
    contact.Update()
    return contact


@pytest.mark.parametrize(("make", "gap", "area"), [(slit, 0.05, 1.5), (slit3d, 0.06, 2.8)])
def test_one_side_is_the_slave(make, gap, area):
    table = selfcontact(make()).Table()
    paired = table["area"] > 0
    assert paired.sum() > 4
    assert len(set(np.sign(table["x"][paired, -1]))) == 1
    assert table["gap"][paired] == pytest.approx(gap, rel=1e-9)
    assert table["area"].sum() == pytest.approx(area, rel=1e-9)


def test_both_sides_while_far_apart():
    table = selfcontact(slit(width=0.9)).Table()
    assert set(np.sign(table["x"][table["area"] > 0, 1])) == {-1, 1}


def test_neighbours_never_pair():
    """In a convex hole every face sees the opposite side, none its neighbours."""
    shape = MoveTo(-2, -2).Rectangle(4, 4).Face() - Circle((0, 0), 1).Face()
    mesh = named(shape, shape.edges, lambda c: np.hypot(c.x, c.y) < 1.5, 0.2).Curve(2)
    table = selfcontact(mesh).Table()
    assert table["gap"][table["area"] > 0] == pytest.approx(2, rel=0.02)


def test_slave_that_is_closed_stays_the_slave():
    contact = selfcontact(slit())
    table, gf = contact.Table(), GridFunction(contact.form.fes)
    other = np.flatnonzero(table["area"] == 0)
    other = other[np.abs(table["x"][other, 0] + 0.25) < 0.5]
    gf.vec.FV().NumPy()[macro_dofs(contact)[other]] = -table["normal"][other]
    contact.Follow(gf)
    contact.Evaluate(gf)
    assert np.all(contact.Table()["area"][other] > 0)


def test_an_offset_counts_in_its_gap():
    """A sheet's thickness on one side of the slot, say; the same faces see each other."""
    plain, thick = (selfcontact(slit(), **law).Table() for law in ({}, {"offset": -0.07}))
    paired = plain["area"] > 0
    assert np.array_equal(paired, thick["area"] > 0)
    assert thick["gap"][paired] == pytest.approx(plain["gap"][paired] - 0.07, abs=1e-14)
