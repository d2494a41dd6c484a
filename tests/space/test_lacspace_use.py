"""LACSpace as an NGSolve space: functions, pictures, files, pickles, refinement."""

import pickle

import numpy as np
import pytest
from netgen.occ import Circle, OCCGeometry
from ngsolve import (
    BND,
    CF,
    H1,
    BilinearForm,
    GridFunction,
    InnerProduct,
    Integrate,
    LinearForm,
    Mesh,
    VectorH1,
    VTKOutput,
    ds,
    x,
)
from ngsolve.meshes import MakeStructured2DMesh
from ngsolve.webgui import Draw

from ngslac import BubbleVectorH1, LACContact, LACSpace
from ngslac.meshes import TwoBlocks


@pytest.fixture
def mesh():
    return MakeStructured2DMesh(quads=False, nx=8, ny=2)


@pytest.fixture
def Q(mesh):
    return LACSpace(VectorH1(mesh, order=2), slave="bottom", macros=[0, 0, 0, 1, 1, 2, 2, 3])


def disc(order=3):
    face = Circle((0, 0), 1).Face()
    face.edges.name = "rim"
    mesh = Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=0.5))
    mesh.Curve(order)
    return mesh


def values(gf):
    return gf.vec.FV().NumPy()


def test_functions_are_constant_on_macros(Q, mesh):
    gf = GridFunction(Q)
    values(gf)[:] = np.arange(8)
    for k, at in enumerate([0.05, 0.3, 0.4, 0.6, 0.7, 0.8, 0.95]):
        macro = [0, 0, 1, 1, 2, 2, 3][k]
        assert gf(mesh(at, 0, 0, BND)) == pytest.approx((2 * macro, 2 * macro + 1))


def test_integrals_over_the_slave_region(Q, mesh):
    gf = GridFunction(Q.WithComponents(1))
    values(gf)[:] = 1
    assert Integrate(gf, mesh.Boundaries("bottom"), BND) == pytest.approx(1, rel=1e-14)
    values(gf)[:] = [1, 10, 100, 1000]
    expected = (3 * 1 + 2 * 10 + 2 * 100 + 1000) / 8
    assert Integrate(gf, mesh.Boundaries("bottom"), BND) == pytest.approx(expected, rel=1e-14)
    vector = GridFunction(Q)
    values(vector)[:] = 1
    both = Integrate(vector, mesh.Boundaries("bottom"), BND)
    assert list(both) == pytest.approx([1, 1], rel=1e-14)


def test_no_values_off_the_slave(Q, mesh):
    gf = GridFunction(Q)
    values(gf)[:] = 1
    others = mesh.Boundaries("bottom")
    assert Integrate(InnerProduct(gf, gf), ~others, BND) == 0


@pytest.mark.parametrize("block", [False, True])
def test_trial_and_test_functions(mesh, block):
    """The mass matrix on the slave is the area of each macro, twice; the coupling is the trace."""
    V = H1(mesh, order=2, dim=2) if block else VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="bottom", macros=[0, 0, 0, 1, 1, 2, 2, 3])
    (u, lam), mu = X.TrialFunction(), X.TestFunction()[1]
    a = BilinearForm(InnerProduct(lam, mu) * ds("bottom"), check_unused=False).Assemble()
    gf = GridFunction(X)
    values(gf.components[1])[:] = np.arange(1, 9)
    product = gf.vec.CreateVector()
    product.data = a.mat * gf.vec
    area = np.repeat([3, 2, 2, 1], 2) / 8
    assert product.FV().NumPy()[-8:] == pytest.approx(area * np.arange(1, 9), rel=1e-13)
    assert not np.any(product.FV().NumPy()[:-8])
    b = BilinearForm(InnerProduct(u, mu) * ds("bottom"), check_unused=False).Assemble()
    gf.components[0].Set(CF((x, 1)))
    product.data = b.mat * gf.vec
    expected = [(b * b - a * a) / 2 / 64 for a, b in ((0, 3), (3, 5), (5, 7), (7, 8))]
    assert product.FV().NumPy()[-8::2] == pytest.approx(expected, rel=1e-12)
    assert product.FV().NumPy()[-7::2] == pytest.approx(area[::2], rel=1e-12)


def test_linear_forms(Q):
    mu = Q.TestFunction()
    f = LinearForm(InnerProduct(CF((x, 2)), mu) * ds("bottom")).Assemble()
    expected = [(b * b - a * a) / 2 / 64 for a, b in ((0, 3), (3, 5), (5, 7), (7, 8))]
    assert f.vec.FV().NumPy()[::2] == pytest.approx(expected, rel=1e-13)
    assert f.vec.FV().NumPy()[1::2] == pytest.approx(np.array([3, 2, 2, 1]) / 4, rel=1e-13)


def test_set_reproduces_what_the_space_holds():
    mesh = disc()
    Q = LACSpace(VectorH1(mesh, order=2), slave="rim")
    gf = GridFunction(Q)
    gf.Set(CF((3, -4)), definedon=mesh.Boundaries("rim"))
    assert values(gf)[::2] == pytest.approx(3)
    assert values(gf)[1::2] == pytest.approx(-4)


def test_area_of_curved_macros():
    mesh = disc()
    gf = GridFunction(LACSpace(VectorH1(mesh, order=2), slave="rim", components=1))
    values(gf)[:] = 1
    length = Integrate(CF(1), mesh, BND, order=10)
    assert Integrate(gf, mesh.Boundaries("rim"), BND, order=10) == pytest.approx(length, rel=1e-14)


def test_draw(Q, mesh, tmp_path):
    for k, gf in enumerate((GridFunction(Q.WithComponents(1)), GridFunction(Q)[1])):
        path = tmp_path / f"{k}.html"
        Draw(gf, mesh.Boundaries("bottom"), "pressure", filename=str(path))
        assert path.stat().st_size > 1000


def test_vtk_output_on_the_slave(Q, mesh, tmp_path):
    gf = GridFunction(Q.WithComponents(1))
    values(gf)[:] = [1, 10, 100, 1000]
    out = VTKOutput(mesh, [gf], ["pressure"], filename=str(tmp_path / "out"), floatsize="double",
                    legacy=True)  # fmt: skip
    out.Do(vb=BND)
    text = (tmp_path / "out.vtk").read_text()
    points = np.array(text.split("POINTS 40 float\n")[1].split()[:120], dtype=float)
    written = np.array(text.split("LOOKUP_TABLE default\n")[1].split(), dtype=float)
    points = points.reshape(-1, 2, 3).mean(axis=1)  # of each face
    below = points[:, 1] == 0
    order = np.argsort(points[below, 0])
    faces = written.reshape(-1, 2)
    assert faces[below][order, 0] == pytest.approx([1, 1, 1, 10, 10, 100, 100, 1000])
    assert np.array_equal(faces[:, 0], faces[:, 1])
    assert not np.any(faces[~below])


@pytest.mark.parametrize("make", [VectorH1, lambda m, order: H1(m, order=order, dim=2)])
def test_pickle_space_and_function(mesh, make):
    Q = LACSpace(make(mesh, order=2), slave="bottom", macros=[0, 0, 0, 1, 1, 2, 2, 3])
    gf = GridFunction(Q)
    values(gf)[:] = np.arange(8) ** 2
    again = pickle.loads(pickle.dumps(Q))
    assert type(again) is LACSpace
    assert (again.ndof, again.dim, again.nmacros) == (Q.ndof, Q.dim, Q.nmacros)
    assert list(again.macros) == list(Q.macros)
    assert [list(again.CoreDofs(m)) for m in range(4)] == [list(Q.CoreDofs(m)) for m in range(4)]
    function = pickle.loads(pickle.dumps(gf))
    assert np.array_equal(values(function), values(gf))
    assert list(function.space.macros) == list(Q.macros)
    there = function.space.mesh(0.6, 0, 0, BND)
    assert function(there) == gf(mesh(0.6, 0, 0, BND))


def test_pickle_on_a_bubble_space():
    mesh = MakeStructured2DMesh(quads=True, nx=5, ny=2)
    Q = LACSpace(BubbleVectorH1(mesh, order=1, slave="bottom"), slave="bottom")
    again = pickle.loads(pickle.dumps(Q))
    assert again.nmacros == Q.nmacros == 5
    assert isinstance(again.displacement, BubbleVectorH1)


def test_pickle_product_space_and_function(mesh):
    V = VectorH1(mesh, order=1)
    X = V * LACSpace(V, slave="bottom")
    gf = GridFunction(X)
    values(gf)[:] = np.arange(X.ndof)
    again = pickle.loads(pickle.dumps(gf))
    assert again.space.ndof == X.ndof
    assert list(again.space.components[1].macros) == list(X.components[1].macros)
    assert np.array_equal(values(again.components[1]), values(gf.components[1]))


def test_refinement_updates_space_and_function(mesh):
    V = VectorH1(mesh, order=2, autoupdate=True)
    Q = LACSpace(V, slave="bottom", autoupdate=True)
    gf = GridFunction(Q, autoupdate=True)
    assert Q.nmacros == 8
    mesh.Refine()
    assert Q.nmacros == 16
    assert len(gf.vec) == Q.ndof == 32
    assert len(Q.macros) == mesh.GetNE(BND)


def test_macros_follow_the_displacement_without_asking(mesh):
    """Who wants the displacement updated wants its multipliers updated too."""
    V = VectorH1(mesh, order=1, autoupdate=True)
    Q = LACSpace(V, slave="bottom")
    mesh.Refine()
    assert Q.nmacros == 8
    assert V.ndof == 2 * mesh.nv


@pytest.mark.parametrize("block", [False, True])
def test_refinement_in_a_product_space(block):
    """A contact on the refined product space pairs anew and has fields of the new size."""
    mesh = TwoBlocks(0.34, structured=True)
    make = (lambda **f: H1(mesh, dim=2, **f)) if block else (lambda **f: VectorH1(mesh, **f))
    V = make(order=2, autoupdate=True)
    X = V * LACSpace(V, slave="slave")
    gf = GridFunction(X, autoupdate=True)
    u, lam = X.TrialFunction()
    contact = LACContact(u, lam, master="master")
    contact.Update()
    n = contact.space.nmacros
    area = contact.Check().paired_area
    mesh.Refine()
    X.Update()
    assert X.components[1].nmacros == contact.space.nmacros == 2 * n
    assert X.ndof == X.components[0].ndof + X.components[1].ndof
    gf.Update()
    assert len(gf.vec) == X.ndof
    contact.Update(gf)
    assert contact.Check().paired_area == pytest.approx(area, rel=1e-12)
    assert len(contact.Table()["area"]) == contact.pressure.space.nmacros == 2 * n
    assert len(contact.normal.vec) * contact.normal.space.dim == 4 * n
    assert contact.form.mat.height == X.ndof * X.dim


def test_manual_update_after_refinement(mesh):
    V = VectorH1(mesh, order=2)
    Q = LACSpace(V, slave="bottom")
    mesh.Refine()
    V.Update()
    Q.Update()
    assert Q.nmacros == 16
    assert Q.FreeDofs().NumSet() == Q.ndof == 32
