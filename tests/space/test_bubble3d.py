"""BubbleVectorH1 in three dimensions, on cells of every shape."""

import pickle

import numpy as np
import pytest
from netgen.occ import Box, Glue, OCCGeometry, Pnt
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
from spaces3d import KINDS, ball, brick, mixed, slave_faces, tetrahedra

from ngslac import BubbleVectorH1

SLAVES = ["bottom", "bottom|left"]  # on prisms the second one has triangles and quadrilaterals


def needed(mesh, slave, order):
    """Slave faces without a dof of their own: triangles below order 3, others below order 2."""
    return [el for el in slave_faces(mesh, slave) if order < (3 if len(el.vertices) == 3 else 2)]


def is_consistent(space):
    """Every element has as many dofs as shape functions."""
    return all(len(el.dofs) == el.GetFE().ndof for vb in (VOL, BND) for el in space.Elements(vb))


def scalar_solution(space, condense=False):
    """Of a vector problem with a load on the lower side."""
    u, v = space.TnT()
    a = BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx + u * v * dx, condense=condense)
    f = LinearForm(CF((1, x, y)) * v * ds("bottom") + CF((z, 1, 0)) * v * dx).Assemble()
    a.Assemble()
    rhs, solution = f.vec.CreateVector(), GridFunction(space)
    rhs.data = f.vec
    if condense:
        rhs.data += a.harmonic_extension_trans * rhs
    inverse = a.mat.Inverse(space.FreeDofs(condense), inverse="sparsecholesky")
    solution.vec.data = inverse * rhs
    if condense:
        solution.vec.data += a.harmonic_extension * solution.vec + a.inner_solve * f.vec
    return solution


@pytest.mark.pairwise
@pytest.mark.parametrize("slave", SLAVES)
@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", KINDS)
def test_one_bubble_where_there_is_none(kind, order, slave):
    mesh = brick(2, kind)
    space, plain = BubbleVectorH1(mesh, order=order, slave=slave), VectorH1(mesh, order=order)
    added = needed(mesh, slave, order)
    assert space.ndof - plain.ndof == 3 * len(added)
    assert is_consistent(space)
    own = {el.faces[0] for el in added}
    for face in mesh.faces:
        number = len(plain.GetDofNrs(face)) + 3 * (face in own)
        assert len(space.GetDofNrs(face)) == number
    for edge in mesh.edges:
        assert len(space.GetDofNrs(edge)) == len(plain.GetDofNrs(edge))


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_bubbles_live_on_their_face(kind, order):
    """The trace of a bubble has a mean of its own and ends at the rim of its face."""
    mesh, slave = brick(2, kind, perturb=0.15), "bottom|left"
    space = BubbleVectorH1(mesh, order=order, slave=slave)
    area = np.array(Integrate(CF(1), mesh, BND, element_wise=True))
    gf = GridFunction(space)
    for el in needed(mesh, slave, order):
        for component, dof in enumerate(space.GetDofNrs(el.faces[0])):
            gf.vec[:] = 0
            gf.vec[dof] = 1
            mean = np.array(Integrate(gf[component], mesh, BND, element_wise=True))
            size = np.array(Integrate(InnerProduct(gf, gf), mesh, BND, element_wise=True))
            assert mean[el.nr] ** 2 > 0.6 * area[el.nr] * size[el.nr]  # both shapes have 0.7
            assert np.flatnonzero(size > 1e-20).tolist() == [el.nr]
            inside = np.array(Integrate(InnerProduct(gf, gf), mesh, VOL, element_wise=True))
            assert np.count_nonzero(inside > 1e-20) == 1  # the one cell at the face


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_reproduces_polynomials(kind, order):
    mesh = brick(2, kind, perturb=0.0 if kind == "hex" else 0.1)
    exact = CF((x**order - y, 2 * y**order + z, z**order + x))
    gf = GridFunction(BubbleVectorH1(mesh, order=order, slave="bottom|left|top"))
    gf.Set(exact)
    assert Integrate(Norm(gf - exact) * dx(bonus_intorder=2), mesh) < 1e-12
    slope = CF(tuple(c.Diff(v) for c in (exact[0], exact[1], exact[2]) for v in (x, y, z)))
    difference = Grad(gf) - slope.Reshape((3, 3))
    assert Integrate(Norm(difference) * dx, mesh) < 1e-11


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("make", [lambda: ball(1.5), mixed])
def test_trace_from_volume_and_boundary_agree(make, order):
    mesh, slave = make(), "surface|bottom"
    space = BubbleVectorH1(mesh, order=order, slave=slave)
    v, weight = space.TestFunction(), CF((1 + x, y, z - 2))
    boundary = LinearForm(InnerProduct(weight, v.Trace()) * ds(slave, bonus_intorder=6))
    volume = LinearForm(InnerProduct(weight, v) * dx(element_boundary=True, bonus_intorder=6))
    bubbles = [dof for el in needed(mesh, slave, order) for dof in space.GetDofNrs(el.faces[0])]
    expected = boundary.Assemble().vec.FV().NumPy()[bubbles]
    values = volume.Assemble().vec.FV().NumPy()[bubbles]
    np.testing.assert_allclose(values, expected, rtol=1e-7, atol=1e-12)
    assert abs(expected).max() > 1e-3


@pytest.mark.parametrize("kind", ["hex", "prism_side", "pyramid"])
def test_equals_vectorh1_of_order_two_on_quadrilaterals(kind):
    mesh = brick(2, kind)
    values = [
        scalar_solution(space).vec.FV().NumPy()
        for space in (VectorH1(mesh, order=2), BubbleVectorH1(mesh, order=2, slave="bottom"))
    ]
    np.testing.assert_allclose(*values, atol=1e-11 * abs(values[0]).max())


@pytest.mark.parametrize("order", [1, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_static_condensation(kind, order):
    space = BubbleVectorH1(brick(2, kind, 1), order=order, slave="bottom|left", dirichlet="top")
    values = [scalar_solution(space, condense).vec.FV().NumPy() for condense in (False, True)]
    np.testing.assert_allclose(*values, atol=1e-11 * abs(values[0]).max())


@pytest.mark.parametrize("kind", ["tet", "hex", "prism"])
def test_bubbles_improve_the_solution(kind):
    """The energy of a loaded slave face grows: the bubbles take part."""
    mesh = brick(3, kind)
    energies = []
    for space in (VectorH1(mesh), BubbleVectorH1(mesh, slave="bottom"), VectorH1(mesh, order=3)):
        gf = scalar_solution(space)
        energies.append(Integrate(InnerProduct(Grad(gf), Grad(gf)) + gf * gf, mesh))
    assert energies[0] < energies[1] < energies[2]


def test_dirichlet_flags():
    mesh = brick(2, "prism")
    flags = {"dirichlet": "top", "dirichletx": "left", "dirichletz": "bottom"}
    space = BubbleVectorH1(mesh, order=1, slave="bottom|left", **flags)
    plain = VectorH1(mesh, order=1, **flags)
    bottom, left = (len(slave_faces(mesh, name)) for name in ("bottom", "left"))
    assert sum(space.FreeDofs()) - sum(plain.FreeDofs()) == 2 * bottom + 2 * left
    number = space.GetDofNrs(slave_faces(mesh, "left")[0].faces[0])
    assert [space.FreeDofs()[dof] for dof in number] == [False, True, True]


def test_interface_between_two_materials():
    """A face between two bodies has one bubble, which both share, or that of the body given."""
    lower, upper = Box(Pnt(0, 0, 0), Pnt(1, 1, 0.5)), Box(Pnt(0, 0, 0.5), Pnt(1, 1, 1))
    lower.mat("A")
    upper.mat("B")
    for body in (lower, upper):
        body.faces.name = "side"
    max(lower.faces, key=lambda f: f.center.z).name = "interface"
    max(upper.faces, key=lambda f: f.center.z).name = "end"
    mesh = Mesh(OCCGeometry(Glue([lower, upper])).GenerateMesh(maxh=0.5))
    n = len(slave_faces(mesh, "interface"))
    assert n > 3
    for flags, slave, faces in (
        ({}, "interface", n),
        ({"definedon": "A"}, "interface", n),
        ({"definedon": "A"}, "end", 0),
        ({"definedon": mesh.Materials("A")}, "interface|end", n),
    ):
        space = BubbleVectorH1(mesh, slave=slave, **flags)
        assert space.ndof - VectorH1(mesh, **flags).ndof == 3 * faces
        assert is_consistent(space)


@pytest.mark.parametrize("flags", [{}, {"wb_withedges": True}, {"low_order_space": True}])
def test_other_flags(flags):
    mesh = brick(2, "prism")
    space = BubbleVectorH1(mesh, order=1, slave="top", dirichlet="bottom", **flags)
    assert space.ndof == 3 * (mesh.nv + len(slave_faces(mesh, "top")))
    u, v = space.TnT()
    a = BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx).Assemble()
    f = LinearForm(v[0] * ds("top")).Assemble()
    gf = GridFunction(space)
    gf.vec.data = a.mat.Inverse(space.FreeDofs(), inverse="sparsecholesky") * f.vec
    assert Integrate(Norm(gf - CF((z, 0, 0))) * dx, mesh) < 1e-12


@pytest.mark.parametrize("autoupdate", [True, False])
@pytest.mark.parametrize("order", [1, 2])
def test_refine_keeps_bubbles(order, autoupdate):
    mesh = tetrahedra(0.6)
    space = BubbleVectorH1(mesh, order=order, slave="left|top", autoupdate=autoupdate)
    gf = GridFunction(space, autoupdate=autoupdate)
    exact = CF((x, 2 * y - z, z))
    gf.Set(exact)
    for _ in range(2):
        mesh.Refine()
        if not autoupdate:
            space.Update()
            gf.Update()
        number = 3 * len(slave_faces(mesh, "left|top"))
        assert space.ndof == VectorH1(mesh, order=order).ndof + number
        assert len(gf.vec) == space.ndof
        assert is_consistent(space)
        if order == 1:  # NGSolve prolongates no more than that
            assert Integrate(Norm(gf - exact) * dx, mesh) < 1e-13


@pytest.mark.parametrize("by_region", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_pickling(kind, by_region):
    mesh = brick(2, kind)
    slave = mesh.Boundaries("left|top") if by_region else "left|top"
    space = BubbleVectorH1(mesh, order=1, slave=slave, dirichlet="bottom", dirichletx="left")
    gf = GridFunction(space)
    gf.vec.FV().NumPy()[:] = np.arange(space.ndof)
    gf2, space2 = pickle.loads(pickle.dumps([gf, space]))
    assert isinstance(space2, BubbleVectorH1)
    assert (space2.ndof, gf2.space.ndof) == (space.ndof, space.ndof)
    assert list(space2.FreeDofs()) == list(space.FreeDofs())
    np.testing.assert_array_equal(gf2.vec.FV().NumPy(), gf.vec.FV().NumPy())
    both = pickle.loads(pickle.dumps(space * NumberSpace(mesh)))
    assert both.ndof == space.ndof + 1


def test_output(tmp_path):
    mesh = mixed(2)
    gf = GridFunction(BubbleVectorH1(mesh, order=1, slave="top"))
    gf.Set((x * x, y * y, z))
    VTKOutput(mesh, coefs=[gf], names=["u"], filename=str(tmp_path / "u")).Do()
    assert (tmp_path / "u.vtu").stat().st_size > 0
