"""A slave that sees past the end of one master to another one behind it.

The mean gap follows the image of that end, and what is far behind is left out.
"""

import numpy as np
import pytest
from netgen.occ import Box, Compound, MoveTo, OCCGeometry, Pnt, Y, Z
from ngsolve import CF, GridFunction, Mesh, VectorH1, x, y, z

from ngslac import LACContact, LACSpace

H = 0.25  # size of the slave's faces


def stairs(dim, depth):
    """A block above a shelf that ends below it, and a floor lower by `depth` that goes on."""
    thick = depth / 2
    if dim == 2:
        block = MoveTo(0, 0.02).Rectangle(1, 0.5).Face()
        shelf = MoveTo(-0.5, -thick).Rectangle(1.13, thick).Face()
        floor = MoveTo(-0.5, -2).Rectangle(2, 2 - depth).Face()
        block.edges.name, shelf.edges.name, floor.edges.name = "side", "floor", "floor"
        block.edges.Min(Y).name, block.edges.Min(Y).maxh = "slave", H
    else:
        block = Box(Pnt(0, 0, 0.02), Pnt(1, 0.6, 0.4))
        shelf = Box(Pnt(-0.5, -0.5, -thick), Pnt(0.63, 1.2, 0))
        floor = Box(Pnt(-0.5, -0.5, -2), Pnt(1.5, 1.2, -depth))
        block.faces.name, shelf.faces.name, floor.faces.name = "side", "floor", "floor"
        block.faces.Min(Z).name, block.faces.Min(Z).maxh = "slave", H
    for body, name in (block, "block"), (shelf, "shelf"), (floor, "ground"):
        for part in body.faces if dim == 2 else body.solids:
            part.name = name
    return Mesh(OCCGeometry(Compound([block, shelf, floor]), dim=dim).GenerateMesh(maxh=0.5))


def contact_on(mesh):
    """The contact of large sliding, and the solution of its space."""
    V = VectorH1(mesh, order=2)
    fes = V * LACSpace(V, slave="slave")
    (u, lam), _ = fes.TnT()
    contact, gf = LACContact(u, lam, master="floor", finite=True), GridFunction(fes)
    contact.Update()
    contact.form.SetConstant(1.0)
    return contact, gf


def table(contact, gf):
    contact.Follow(gf)
    contact.Evaluate(gf)
    return contact.Table()


@pytest.mark.parametrize("depth", [0.02, 0.1, 0.2])
@pytest.mark.parametrize("dim", [2, 3])
def test_gaps_follow_the_end_of_a_step(dim, depth):
    mesh = stairs(dim, depth)
    contact, gf = contact_on(mesh)
    motion, across = GridFunction(gf.space), (z if dim == 3 else y)
    field = (1 + 0.3 * x - 0.2 * across, 0.2 * x, 0.1 + 0.1 * x)[:dim]
    motion.components[0].Set(CF(field), definedon=mesh.Materials("block"))
    eps = 1e-6

    def gaps(part):
        gf.vec.data = part * motion.vec
        now = table(contact, gf)
        return now["gap"]

    slope = (gaps(eps) - gaps(-eps)) / (2 * eps)
    gf.vec[:] = 0
    now = table(contact, gf)
    gf.vec.FV().NumPy()[contact.form.MultiplierDofs()] = (-now["normal"]).ravel()  # all is closed
    contact.Evaluate(gf)
    residual = gf.vec.CreateVector()
    contact.form.AssembleStep(gf.vec, residual)
    rows = (contact.form.mat * motion.vec).Evaluate().FV().NumPy()
    rows = rows[contact.form.MultiplierDofs()].reshape(-1, dim)
    found, slope = -np.sum(rows * now["normal"], axis=1), slope * now["area"]
    assert np.ptp(slope) > 0.01 * np.abs(slope).max()
    assert np.allclose(np.abs(found), np.abs(slope), atol=1e-5 * np.abs(slope).max())


@pytest.mark.parametrize("depth", [0.6, 1.5])
@pytest.mark.parametrize("dim", [2, 3])
def test_what_is_far_behind_the_end_is_left_out(dim, depth):
    contact, gf = contact_on(stairs(dim, depth))
    assert np.any(table(contact, gf)["area"] < 0.999 * contact.Table()["fullarea"])
    seen = contact.Segments()
    gaps = [seen.gap[seen.slave == face] for face in np.unique(seen.slave)]
    levels = [np.unique(np.round(own, 6)) for own in gaps]
    assert all(len(level) == 1 for level in levels)
    assert {float(level[0]) for level in levels} == {0.02, round(0.02 + depth, 6)}
