"""Macro-elements stay small, whole and flat: leftovers, partitions by hand, what Check() says."""

import numpy as np
import pytest
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry, Y
from ngsolve import (
    BND,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Mesh,
    Sym,
    VectorH1,
    dx,
)
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace


def Overhanging(h=0.1):
    """A block of length 2 on a wider one; the second half of its lower side is clamped."""
    upper = MoveTo(0, 0).LineTo(1, 0, "free").LineTo(2, 0, "clamped").LineTo(2, 1)
    upper = upper.LineTo(0, 1, "top").LineTo(0, 0).Face()
    lower = MoveTo(-0.5, -1).Rectangle(3, 1).Face()
    lower.edges.Max(Y).name, lower.edges.Min(Y).name = "master", "bottom"
    lower.edges.Max(Y).maxh = 0.8 * h
    return Mesh(OCCGeometry(Compound([upper, lower]), dim=2).GenerateMesh(maxh=h))


def Sizes(space):
    macros = np.array(space.macros)
    return np.bincount(macros[macros >= 0])


@pytest.mark.parametrize("order", [1, 2, 3])
def test_half_of_a_slave_clamped(order):
    mesh = Overhanging()
    V = VectorH1(mesh, order=order, dirichlet="bottom|clamped")
    sizes = Sizes(LACSpace(V, slave="free|clamped"))
    assert sizes.sum() == sum(e.mat in ("free", "clamped") for e in mesh.Elements(BND))
    assert sizes.max() <= 4 * np.median(sizes)


@pytest.mark.parametrize("hexes", [True, False])
@pytest.mark.parametrize("space", [VectorH1, BubbleVectorH1], ids=["plain", "bubble"])
def test_half_of_a_slave_clamped_in_3d(space, hexes):
    """Clamped are the vertices beyond the middle: boundaries of the mesh need not show it."""
    mesh = MakeStructured3DMesh(hexes=hexes, nx=8, ny=4, nz=1)
    flags = {"slave": "bottom"} if space is BubbleVectorH1 else {}
    V = space(mesh, order=2, **flags)
    for el in mesh.Boundaries("bottom").Elements():
        if min(mesh[v].point[0] for v in el.vertices) > 0.4:
            for dof in V.GetDofNrs(el):
                V.FreeDofs().Clear(dof)
    sizes = Sizes(LACSpace(V, slave="bottom"))
    assert sizes.max() <= 7


def test_clamped_part_of_a_slave_presses():
    """The clamped half is a rigid punch: it holds off the master, and Check() names it."""
    mesh = Overhanging(0.2)
    V = VectorH1(mesh, order=2, dirichlet="bottom|clamped")
    X = V * LACSpace(V, slave="free|clamped")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx
    gf, contact = GridFunction(X), LACContact(u, lam, master="master")
    gf.components[0].Set((0, -0.01), definedon=mesh.Boundaries("clamped"))
    ContactSolver(a, gf, contact).Solve(printing=False)
    table = contact.Table()
    clamped = table["x"][:, 0] > 1.3
    assert np.all(table["pressure"][clamped] > 0)
    # What is carried elastically goes in by a hundredth of what the surface gives.
    assert np.all(table["gap"][clamped] < 0)
    assert np.all(table["gap"][clamped] > -3e-4)
    report = contact.Check()
    assert set(report.prescribed) == set(np.flatnonzero(contact.form.Scalars("prescribed")))
    assert len(report.prescribed) >= 2
    assert "prescribed       " in str(report)


@pytest.fixture
def mesh():
    return MakeStructured2DMesh(nx=6, ny=2)


@pytest.mark.parametrize(
    ("macros", "error", "text"),
    [
        ([2**31 - 1] * 6, ValueError, "macros holds the number 2147483647, but 6 slave faces"),
        ([2**70] * 6, ValueError, "macros.*out of range|macros holds"),
        ([-1] * 6, ValueError, "negative number -1"),
        ([0.5] * 6, TypeError, "macros.*0.5"),
        (["a"] * 6, TypeError, "macros.*'a'"),
        ("000000", TypeError, "macros.*'000000'"),
        (7, TypeError, "macros = 7"),
        ([0, 0, 1, 1, 0, 0], ValueError, "macro-element 0 of 4 faces that do not hang together"),
    ],
)
def test_macros_that_are_none(mesh, macros, error, text):
    with pytest.raises(error, match=text):
        LACSpace(VectorH1(mesh, order=2), slave="bottom", macros=macros)


def test_macros_of_any_integers(mesh):
    for macros in (np.arange(6) // 2, np.arange(6, dtype=np.uint8) // 2, (0, 0, 1, 1, 2, 2)):
        assert LACSpace(VectorH1(mesh, order=2), slave="bottom", macros=macros).nmacros == 3


@pytest.mark.parametrize("parts", [1, 2, 3])
def test_macros_that_bend(parts):
    """Arcs of 120 degrees and more have no normal that stands for them."""
    disk = Circle((0, 0), 1).Face()
    disk.edges.name = "rim"
    mesh = Mesh(OCCGeometry(disk, dim=2).GenerateMesh(maxh=0.4))
    angles = [
        np.arctan2(*sum(np.array(mesh[v].point) for v in el.vertices)[::-1])
        for el in mesh.Boundaries("rim").Elements()
    ]
    macros = (np.array(angles) + np.pi) * parts // (2 * np.pi)
    with pytest.raises(ValueError, match=r"faces that bend by more than 60 degrees"):
        LACSpace(VectorH1(mesh, order=2), slave="rim", macros=macros.astype(int).tolist())


def test_check_names_large_and_bent_macro_elements():
    disk = Circle((0, 0), 1).Face()
    disk.edges.name = "rim"
    ring = Circle((0, 0), 2).Face() - Circle((0, 0), 1).Face()
    ring.edges.name = "ring"
    mesh = Mesh(OCCGeometry(Compound([disk, ring]), dim=2).GenerateMesh(maxh=0.1))
    n = sum(e.mat == "rim" for e in mesh.Elements(BND))
    macros = [0] * (n // 7) + list(range(1, n - n // 7 + 1))
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="rim", macros=macros)
    (u, lam), _ = X.TnT()
    report = LACContact(u, lam, master="ring").Check()
    assert report.large.tolist() == [0]
    assert "of many faces    1 macro-elements: 0 at" in str(report)
    assert not len(report.undefined)
