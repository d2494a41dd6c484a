"""BubbleVectorH1: VectorH1 with a bubble on every slave face."""

import pickle

import numpy as np
import pytest
from netgen.csg import unit_cube
from netgen.occ import Circle, Glue, MoveTo, OCCGeometry, Rectangle, X
from ngsolve import (
    BND,
    CF,
    VOL,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    LinearForm,
    Mesh,
    Norm,
    NumberSpace,
    VectorH1,
    VTKOutput,
    ds,
    dx,
    x,
    y,
    z,
)
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh
from ngsolve.webgui import Draw
from splitmeshes import square

from ngslac import BubbleVectorH1


def number_of_faces(mesh, slave):
    return sum(1 for _ in mesh.Boundaries(slave).Elements())


def is_consistent(space):
    """Every element has as many dofs as shape functions."""
    return all(len(el.dofs) == el.GetFE().ndof for vb in (VOL, BND) for el in space.Elements(vb))


def bubbles(mesh, slave, **flags):
    return BubbleVectorH1(mesh, slave=slave, **flags).ndof - VectorH1(mesh, **flags).ndof


@pytest.mark.parametrize("quads", [False, True])
@pytest.mark.parametrize("slave", ["top", "left|top"])
def test_dofs_2d(quads, slave):
    mesh = MakeStructured2DMesh(quads=quads, nx=4, ny=3)
    n = number_of_faces(mesh, slave)
    assert [bubbles(mesh, slave, order=p) for p in (1, 2, 3)] == [2 * n, 0, 0]
    for order in (1, 2, 3):
        assert is_consistent(BubbleVectorH1(mesh, order=order, slave=slave))


@pytest.mark.parametrize(
    ("mesh", "expected"),
    [
        (Mesh(unit_cube.GenerateMesh(maxh=0.6)), [3, 3, 0]),
        (MakeStructured3DMesh(hexes=True, nx=2), [3, 0, 0]),
    ],
)
def test_dofs_3d(mesh, expected):
    """Triangles have a bubble of order 3, quadrilaterals one of order 2."""
    n = number_of_faces(mesh, "top")
    for order, per_face in zip((1, 2, 3), expected, strict=True):
        space = BubbleVectorH1(mesh, order=order, slave="top")
        assert space.ndof - VectorH1(mesh, order=order).ndof == n * per_face
        assert is_consistent(space)
        gf = GridFunction(space)
        gf.Set((x + y, y - z, z))
        assert Integrate(Norm(gf - CF((x + y, y - z, z))) * dx, mesh) < 1e-13


def test_only_slave_edges_have_bubbles():
    mesh = square()
    space = BubbleVectorH1(mesh, order=1, slave="top")
    slave = {edge for el in mesh.Boundaries("top").Elements() for edge in el.edges}
    for edge in mesh.edges:
        assert len(space.GetDofNrs(edge)) == (2 if edge in slave else 0)
    for el in space.Elements(VOL):
        assert len(el.dofs) == 6 + 2 * len(slave & set(el.edges))


def test_bubble_has_a_mean_of_its_own():
    """Each bubble lives on one slave edge, vanishes at its ends, and its mean does not vanish."""
    mesh = square()
    space = BubbleVectorH1(mesh, order=1, slave="top")
    gf = GridFunction(space)
    for el in mesh.Boundaries("top").Elements():
        for component, dof in enumerate(space.GetDofNrs(el.edges[0])):
            gf.vec[:] = 0
            gf.vec[dof] = 1
            mean = np.array(Integrate(gf[component], mesh, VOL_or_BND=BND, element_wise=True))
            size = Integrate(CF(1), mesh, VOL_or_BND=BND, element_wise=True)[el.nr]
            assert abs(mean[el.nr]) > 0.05 * size
            assert np.flatnonzero(abs(mean) > 1e-14).tolist() == [el.nr]
            assert Integrate(Norm(gf[1 - component]) * dx, mesh) == 0
            for v in el.vertices:
                assert np.linalg.norm(gf(mesh(*mesh[v].point))) < 1e-14


def test_trace_from_volume_and_boundary_agree():
    mesh = Mesh(OCCGeometry(Circle((0, 0), 1).Face(), dim=2).GenerateMesh(maxh=0.4)).Curve(3)
    space = BubbleVectorH1(mesh, order=1, slave=".*")
    v = space.TestFunction()
    weight = CF((1 + x, y))
    boundary = LinearForm(InnerProduct(weight, v.Trace()) * ds).Assemble().vec.FV().NumPy()
    volume = LinearForm(InnerProduct(weight, v) * dx(element_boundary=True)).Assemble()
    bubbles = [dof for el in mesh.Elements(BND) for dof in space.GetDofNrs(el.edges[0])]
    np.testing.assert_allclose(boundary[bubbles], volume.vec.FV().NumPy()[bubbles], rtol=1e-12)
    assert abs(boundary[bubbles]).max() > 1e-3


@pytest.mark.parametrize("order", [1, 2, 3])
def test_reproduces_polynomials(order):
    mesh = square()
    exact = CF((x**order - y, 2 * y**order + x))
    gf = GridFunction(BubbleVectorH1(mesh, order=order, slave="left|top"))
    gf.Set(exact)
    assert Integrate(Norm(gf - exact) * dx, mesh) < 1e-13
    difference = Grad(gf) - CF((exact[0].Diff(x), -1, 1, exact[1].Diff(y)), dims=(2, 2))
    assert Integrate(Norm(difference) * dx, mesh) < 1e-12


def test_equals_vectorh1_from_order_two():
    mesh = square()
    solutions = []
    for space in (VectorH1(mesh, order=2), BubbleVectorH1(mesh, order=2, slave="top")):
        u, v = space.TnT()
        a = BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx + u * v * dx).Assemble()
        f = LinearForm(CF((1, x)) * v * ds("top")).Assemble()
        solutions.append((a.mat.Inverse(inverse="sparsecholesky") * f.vec).Evaluate())
    np.testing.assert_allclose(solutions[0].FV().NumPy(), solutions[1].FV().NumPy(), atol=1e-13)


def test_dirichlet_flags():
    mesh = square()
    n = number_of_faces(mesh, "left|top")
    flags = {"dirichlet": "bottom", "dirichletx": "left", "dirichlety": "top|right"}
    space = BubbleVectorH1(mesh, order=1, slave="left|top", **flags)
    plain = VectorH1(mesh, order=1, **flags)
    fixed = number_of_faces(mesh, "left") + number_of_faces(mesh, "top")
    assert sum(space.FreeDofs()) - sum(plain.FreeDofs()) == 2 * n - fixed
    by_region = BubbleVectorH1(
        mesh, slave="left", dirichlet=mesh.Boundaries("bottom"), dirichlet_bbnd="default"
    )
    assert sum(by_region.FreeDofs()) < by_region.ndof


def test_definedon():
    left, right = Rectangle(1, 1).Face(), MoveTo(1, 0).Rectangle(1, 1).Face()
    left.faces.name, right.faces.name = "A", "B"
    left.edges.Max(X).name, right.edges.Max(X).name = "interface", "end"
    mesh = Mesh(OCCGeometry(Glue([left, right]), dim=2).GenerateMesh(maxh=0.3))
    n = number_of_faces(mesh, "interface")
    assert bubbles(mesh, "interface", definedon="A") == 2 * n
    assert bubbles(mesh, "end", definedon="A") == 0
    assert bubbles(mesh, "interface|end", definedon=mesh.Materials("A")) == 2 * n
    assert is_consistent(BubbleVectorH1(mesh, slave="interface|end", definedon="A"))


@pytest.mark.parametrize("flags", [{}, {"wb_withedges": True}, {"low_order_space": True}])
def test_other_flags(flags):
    mesh = square()
    space = BubbleVectorH1(mesh, order=1, slave="top", dirichlet="bottom", **flags)
    assert space.ndof == 2 * (mesh.nv + number_of_faces(mesh, "top"))
    assert is_consistent(space)
    u, v = space.TnT()
    a = BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx).Assemble()
    f = LinearForm(v[0] * ds("top")).Assemble()
    gf = GridFunction(space)
    gf.vec.data = a.mat.Inverse(space.FreeDofs(), inverse="sparsecholesky") * f.vec
    assert Integrate(Norm(gf - CF((y, 0))) * dx, mesh) < 1e-12


@pytest.mark.parametrize("order", [1, 3])
def test_static_condensation(order):
    mesh = square()
    space = BubbleVectorH1(mesh, order=order, slave="left|top", dirichlet="bottom")
    u, v = space.TnT()
    vectors = []
    f = LinearForm(CF((x, 1 + y)) * v * dx).Assemble()
    for condense in (False, True):
        a = BilinearForm(space, condense=condense)
        a += (InnerProduct(Grad(u), Grad(v)) + u * v) * dx
        a.Assemble()
        rhs, sol = f.vec.CreateVector(), f.vec.CreateVector()
        rhs.data = f.vec
        if condense:
            rhs.data += a.harmonic_extension_trans * rhs
        sol.data = a.mat.Inverse(space.FreeDofs(condense), inverse="sparsecholesky") * rhs
        if condense:
            sol.data += a.harmonic_extension * sol + a.inner_solve * f.vec
        vectors.append(sol.FV().NumPy().copy())
    np.testing.assert_allclose(vectors[0], vectors[1], atol=1e-12)


def test_product_space():
    mesh = square()
    X = BubbleVectorH1(mesh, order=1, slave="top", dirichlet="bottom") * NumberSpace(mesh)
    (u, lam), (v, mu) = X.TnT()
    a = BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx + (lam * v[1] + mu * u[1]) * ds("top"))
    f = LinearForm(mu * ds("top"))
    a.Assemble()
    f.Assemble()
    gf = GridFunction(X)
    gf.vec.data = a.mat.Inverse(X.FreeDofs(), inverse="umfpack") * f.vec
    assert Integrate(gf.components[0][1] * ds("top"), mesh) == pytest.approx(1, rel=1e-10)


@pytest.mark.parametrize("autoupdate", [True, False])
def test_refine_keeps_bubbles(autoupdate):
    mesh = square()
    space = BubbleVectorH1(mesh, order=1, slave="left|top", autoupdate=autoupdate)
    gf = GridFunction(space, autoupdate=autoupdate)
    gf.Set((x, 2 * y))
    for _ in range(2):
        mesh.Refine()
        if not autoupdate:
            space.Update()
            gf.Update()
        assert space.ndof == 2 * (mesh.nv + number_of_faces(mesh, "left|top"))
        assert len(gf.vec) == space.ndof
        assert is_consistent(space)
        assert Integrate(Norm(gf - CF((x, 2 * y))) * dx, mesh) < 1e-13


def test_repeated_update_changes_nothing():
    mesh = square()
    space = BubbleVectorH1(mesh, order=1, slave="left", dirichlet="bottom")
    ndof, free = space.ndof, sum(space.FreeDofs())
    space.Update()
    space.components[0].Update()
    assert (space.ndof, sum(space.FreeDofs())) == (ndof, free)


@pytest.mark.parametrize("by_region", [False, True])
def test_pickling(by_region):
    mesh = square()
    slave = mesh.Boundaries("left|top") if by_region else "left|top"
    space = BubbleVectorH1(mesh, order=1, slave=slave, dirichlet="bottom", dirichletx="left")
    gf = GridFunction(space)
    gf.vec.FV().NumPy()[:] = np.arange(space.ndof)
    gf2, space2 = pickle.loads(pickle.dumps([gf, space]))
    assert isinstance(space2, BubbleVectorH1)
    assert space2.ndof == space.ndof
    assert list(space2.FreeDofs()) == list(space.FreeDofs())
    assert gf2.space.ndof == space.ndof
    np.testing.assert_array_equal(gf2.vec.FV().NumPy(), gf.vec.FV().NumPy())
    space2.mesh.Refine()
    space2.Update()
    assert space2.ndof == 2 * (space2.mesh.nv + number_of_faces(space2.mesh, "left|top"))
    both = pickle.loads(pickle.dumps(space * NumberSpace(mesh)))
    assert both.ndof == space.ndof + 1
    assert pickle.loads(pickle.dumps(space.components[1])).ndof == space.components[1].ndof


def test_output(tmp_path):
    mesh = square()
    gf = GridFunction(BubbleVectorH1(mesh, order=1, slave="top"))
    gf.Set((x * x, y * y))
    VTKOutput(mesh, coefs=[gf], names=["u"], filename=str(tmp_path / "u")).Do()
    assert (tmp_path / "u.vtu").stat().st_size > 0
    Draw(gf, mesh, show=False, filename=str(tmp_path / "u.html"))
    assert (tmp_path / "u.html").stat().st_size > 0
