"""Units and the place of the bodies do not show in a solution, from pairing to forces."""

import numpy as np
import pytest
from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Mesh,
    Sym,
    Trace,
    VectorH1,
    ds,
    dx,
)

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.meshes import TwoBlocks, TwoBlocks3D

BLOCKS = {
    2: lambda: TwoBlocks(0.5, shape="oblique", overhang=0.1, aligned=False, structured=True),
    3: lambda: TwoBlocks3D("hex", "hex", 2, 1, shape="oblique", overhang=0.1, aligned=False),
}


def solved(dim, finite, scale=1.0, at=0.0):
    """Pressed and pushed: areas, tractions and displacements, in the units of the unit blocks."""
    ngmesh = BLOCKS[dim]().ngmesh
    shift = at * np.array((1, -0.7, 0.3))
    for point in ngmesh.Points():
        for k in range(dim):
            point[k] = scale * (point[k] + shift[k])
    mesh = Mesh(ngmesh)
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    a, strain = BilinearForm(X), Sym(Grad(u))
    a += InnerProduct(80 * strain + 60 * Trace(strain) * Id(dim), Sym(Grad(v))) * dx
    push = CF((0.003, 0.002, -0.02)[3 - dim :])
    a += 1000 * InnerProduct(u / scale - push, v) * ds("top")
    gf = GridFunction(X)
    contact = LACContact(u, lam, master="master", friction=0.3, finite=finite)
    ContactSolver(a, gf, contact).Solve(printing=False)
    table = contact.Table()
    displacement = gf.components[0].vec.FV().NumPy() / scale
    return table["area"] / scale ** (dim - 1), table["traction"], displacement, table["status"]


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("dim", [2, 3])
def test_solution_is_that_of_the_unit_blocks(dim, finite):
    expected = solved(dim, finite)
    for scale, at in ((1e-6, 0), (1e6, 1e4)):
        *found, status = solved(dim, finite, scale, at)
        assert (status == expected[-1]).all()
        for values, others in zip(found, expected, strict=False):
            assert values == pytest.approx(others, abs=1e-9 * np.abs(others).max())
