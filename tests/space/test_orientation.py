"""Boundary elements in mixed directions: the outside is where there is no volume element."""

import numpy as np
import pytest
from flipped import Flipped
from netgen.occ import OCCGeometry, Rectangle
from ngsolve import (
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Mesh,
    Sym,
    VectorH1,
    ds,
    dx,
)
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.meshes import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D

SINGLE = {
    "quad": lambda: MakeStructured2DMesh(quads=True, nx=5, ny=3),
    "trig": lambda: Mesh(OCCGeometry(Named(Rectangle(1, 1).Face()), dim=2).GenerateMesh(maxh=0.2)),
    "hex": lambda: MakeStructured3DMesh(hexes=True, nx=4, ny=4, nz=2),
    "tet": lambda: MakeStructured3DMesh(hexes=False, nx=4, ny=4, nz=2),
}


def Named(face):
    for edge in face.edges:
        edge.name = "bottom" if edge.center.y < 1e-9 else "top"
    return face


@pytest.mark.parametrize("every", [2, 3])
@pytest.mark.parametrize("kind", SINGLE)
def test_same_macro_elements(kind, every):
    mesh = SINGLE[kind]()
    macros = [
        list(LACSpace(VectorH1(m, order=1), slave="bottom").macros)
        for m in (Flipped(mesh, 0), Flipped(mesh, every))
    ]
    assert macros[0] == macros[1]
    assert max(macros[0]) > 0


def Solve(mesh, **law):
    """The upper block pressed down and pushed aside; contact table and displacement."""
    V = VectorH1(
        mesh, order=1, dirichlet="bottom", dirichletx="top", dirichlety="top" * (mesh.dim > 2)
    )
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx - 0.002 * v[0] * dx
    a += 0.02 * v[mesh.dim - 1] * ds("top")
    contact, gf = LACContact(u, lam, master="master", friction=0.3, **law), GridFunction(X)
    ContactSolver(a, gf, contact).Solve(printing=False)
    return contact.Table(), gf.components[0].vec.FV().NumPy()


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("kind", ["2D", "hex", "tet"])
def test_same_contact(kind, finite):
    """Normals, gaps, tractions and displacements are those of boundary elements in one direction.

    The quadrature may start at another corner: equal up to rounding.
    """
    mesh = TwoBlocks(0.2, 0.3) if kind == "2D" else TwoBlocks3D(kind, n_slave=4, n_master=3)
    (one, u), (other, w) = (Solve(Flipped(mesh, every), finite=finite) for every in (0, 2))
    assert np.sum(one["status"] > 0) > 1
    assert np.abs(u - w).max() < 1e-9 * np.abs(u).max()
    for name in ("normal", "gap", "traction", "area"):
        np.testing.assert_allclose(other[name], one[name], rtol=0, atol=1e-9, err_msg=name)
