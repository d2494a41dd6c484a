"""BubbleVectorH1: VectorH1 with a bubble on every slave face that has no dof of its own."""

import pickle
from itertools import product

import numpy as np
import pytest
from bricks import (
    KINDS,
    TRIANGLES,
    ball,
    brick,
    dimension,
    facet,
    glued,
    mixed,
    slave_faces,
    unstructured,
)
from netgen.meshing import NgException
from ngsolve import (
    BND,
    CF,
    VOL,
    BilinearForm,
    FESpace,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    LinearForm,
    Norm,
    NumberSpace,
    Sym,
    VectorH1,
    VTKOutput,
    div,
    ds,
    dx,
    x,
    y,
    z,
)
from ngsolve.webgui import Draw
from scipy.linalg import eigvalsh
from scipy.sparse import csr_matrix

from ngslac import BubbleVectorH1, SplitSlaveFaces

FIELDS = {2: (x, 2 * y), 3: (x, 2 * y - z, z)}


def needed(mesh, slave, order):
    """Slave faces without a dof of their own: triangles below order 3, others below order 2."""
    return [el for el in slave_faces(mesh, slave) if order < (3 if len(el.vertices) == 3 else 2)]


def is_consistent(space):
    """Every element has as many dofs as shape functions."""
    return all(len(el.dofs) == el.GetFE().ndof for vb in (VOL, BND) for el in space.Elements(vb))


def solution(space, condense=False):
    """Of a vector problem with a load on the lower side."""
    u, v = space.TnT()
    dim = space.mesh.dim
    a = BilinearForm(InnerProduct(Grad(u), Grad(v)) * dx + u * v * dx, condense=condense)
    f = LinearForm(CF((1, x, y)[:dim]) * v * ds("bottom") + CF((z + y, 1, 0)[:dim]) * v * dx)
    f.Assemble()
    a.Assemble()
    rhs, gf = f.vec.CreateVector(), GridFunction(space)
    rhs.data = f.vec
    if condense:
        rhs.data += a.harmonic_extension_trans * rhs
    gf.vec.data = a.mat.Inverse(space.FreeDofs(condense), inverse="sparsecholesky") * rhs
    if condense:
        gf.vec.data += a.harmonic_extension * gf.vec + a.inner_solve * f.vec
    return gf


def assert_same(one, other, tol):
    one, other = (gf.vec.FV().NumPy() for gf in (one, other))
    np.testing.assert_allclose(one, other, rtol=0, atol=tol)


@pytest.mark.pairwise
@pytest.mark.parametrize("slave", ["bottom", "bottom|left"])  # of prisms both shapes of faces
@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", KINDS)
def test_one_bubble_where_there_is_none(kind, order, slave):
    mesh = brick(kind, 2)
    space, plain = BubbleVectorH1(mesh, order=order, slave=slave), VectorH1(mesh, order=order)
    added = needed(mesh, slave, order)
    assert space.ndof - plain.ndof == mesh.dim * len(added)
    assert is_consistent(space)
    own = {facet(el) for el in added}
    for node in [*mesh.vertices, *mesh.edges, *mesh.faces]:
        number = len(plain.GetDofNrs(node)) + mesh.dim * (node in own)
        assert len(space.GetDofNrs(node)) == number


@pytest.mark.parametrize(
    ("kind", "order"), [*((kind, 1) for kind in KINDS), ("tet", 2), ("prism", 2), ("prism_side", 2)]
)
def test_bubbles_live_on_their_face(kind, order):
    """The trace of a bubble has a mean of its own and ends at the rim of its face."""
    mesh, slave = brick(kind, 2, perturb=0.15), "bottom|left"
    space = BubbleVectorH1(mesh, order=order, slave=slave)
    area = np.array(Integrate(CF(1), mesh, BND, element_wise=True))
    gf = GridFunction(space)
    added = needed(mesh, slave, order)
    assert added
    for el in added:
        for component, dof in enumerate(space.GetDofNrs(facet(el))):
            gf.vec[:] = 0
            gf.vec[dof] = 1
            mean = np.array(Integrate(gf[component], mesh, BND, element_wise=True))
            size = np.array(Integrate(InnerProduct(gf, gf), mesh, BND, element_wise=True))
            assert mean[el.nr] ** 2 > 0.6 * area[el.nr] * size[el.nr]  # all shapes have 0.7
            assert np.flatnonzero(size > 1e-20).tolist() == [el.nr]
            inside = np.array(Integrate(InnerProduct(gf, gf), mesh, VOL, element_wise=True))
            assert np.count_nonzero(inside > 1e-20) == 1  # the one cell at the face
            assert Integrate(gf[component] ** 2, mesh) == pytest.approx(inside.sum(), rel=1e-14)


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_reproduces_polynomials(kind, order):
    mesh = brick(kind, 2, perturb=0.0 if kind == "hex" else 0.1)
    where = (x, y, z)[: mesh.dim]
    exact = CF(tuple(a**order - b for a, b in zip(where, where[1:] + where[:1], strict=True)))
    gf = GridFunction(BubbleVectorH1(mesh, order=order, slave="bottom|left|top"))
    gf.Set(exact)
    assert Integrate(Norm(gf - exact) * dx(bonus_intorder=2), mesh) < 1e-12
    slope = CF(tuple(exact[i].Diff(v) for i in range(mesh.dim) for v in where))
    difference = Grad(gf) - slope.Reshape((mesh.dim, mesh.dim))
    assert Integrate(Norm(difference) * dx, mesh) < (1e-12 if mesh.dim == 2 else 1e-11)


@pytest.mark.parametrize(
    ("make", "order"),
    [(lambda: ball(2, 0.4, 3), 1), *product((lambda: ball(3, 1.5), mixed), (1, 2))],
)
def test_trace_from_volume_and_boundary_agree(make, order):
    mesh, slave = make(), "surface|bottom"
    space = BubbleVectorH1(mesh, order=order, slave=slave)
    v, weight = space.TestFunction(), CF((1 + x, y, z - 2)[: mesh.dim])
    boundary = LinearForm(InnerProduct(weight, v.Trace()) * ds(slave, bonus_intorder=6))
    volume = LinearForm(InnerProduct(weight, v) * dx(element_boundary=True, bonus_intorder=6))
    bubbles = [dof for el in needed(mesh, slave, order) for dof in space.GetDofNrs(facet(el))]
    expected = boundary.Assemble().vec.FV().NumPy()[bubbles]
    values = volume.Assemble().vec.FV().NumPy()[bubbles]
    np.testing.assert_allclose(values, expected, rtol=(1e-12, 1e-7)[mesh.dim - 2], atol=1e-12)
    assert abs(expected).max() > 1e-3


@pytest.mark.parametrize("kind", sorted(set(KINDS) - TRIANGLES))
def test_equals_vectorh1_of_order_two_without_triangles(kind):
    mesh = brick(kind, 2)
    spaces = VectorH1(mesh, order=2), BubbleVectorH1(mesh, order=2, slave="bottom")
    assert_same(*map(solution, spaces), tol=1e-12)  # values of up to 2, from two orders of dofs


@pytest.mark.parametrize("order", [1, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_static_condensation(kind, order):
    space = BubbleVectorH1(brick(kind, 2, 1), order=order, slave="bottom|left", dirichlet="top")
    tol = 1e-12 if dimension(kind) == 2 else 1e-11
    assert_same(*(solution(space, condense) for condense in (False, True)), tol=tol)


@pytest.mark.parametrize("kind", ["trig", "prism"])
def test_dirichlet_flags(kind):
    mesh = brick(kind, 2)
    last = "dirichlety" if mesh.dim == 2 else "dirichletz"
    flags = {"dirichlet": "top", "dirichletx": "left", last: "bottom"}
    space = BubbleVectorH1(mesh, order=1, slave="bottom|left", **flags)
    plain = VectorH1(mesh, order=1, **flags)
    n = len(slave_faces(mesh, "bottom|left"))
    assert sum(space.FreeDofs()) - sum(plain.FreeDofs()) == (mesh.dim - 1) * n
    number = space.GetDofNrs(facet(slave_faces(mesh, "left")[0]))
    assert [space.FreeDofs()[dof] for dof in number] == [False, True, True][: mesh.dim]
    by_name, by_region = (
        BubbleVectorH1(mesh, slave="left", dirichlet=d, dirichlet_bbnd="default").FreeDofs()
        for d in ("bottom", mesh.Boundaries("bottom"))
    )
    assert list(by_name) == list(by_region)
    assert not all(by_region)


@pytest.mark.parametrize("dim", [2, 3])
def test_interface_between_two_materials(dim):
    """A face between two bodies has one bubble, which both share, or that of the body given."""
    mesh = glued(dim, 0.4)
    n = len(slave_faces(mesh, "interface"))
    assert n > 2
    for flags, slave, faces in (
        ({}, "interface", n),
        ({"definedon": "A"}, "interface", n),
        ({"definedon": "A"}, "end", 0),
        ({"definedon": mesh.Materials("A")}, "interface|end", n),
    ):
        space = BubbleVectorH1(mesh, slave=slave, **flags)
        assert space.ndof - VectorH1(mesh, **flags).ndof == dim * faces
        assert is_consistent(space)


@pytest.mark.parametrize("flags", [{"wb_withedges": True}, {"low_order_space": True}])
@pytest.mark.parametrize("kind", ["trig", "prism"])
def test_other_flags(kind, flags):
    mesh = brick(kind, 2)
    spaces = (BubbleVectorH1(mesh, order=1, slave="bottom", **f) for f in ({}, flags))
    assert_same(*map(solution, spaces), tol=1e-13)


@pytest.mark.parametrize("autoupdate", [True, False])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("dim", [2, 3])
def test_refine_keeps_bubbles(dim, order, autoupdate):
    mesh = unstructured(dim, 0.6)
    space = BubbleVectorH1(mesh, order=order, slave="left|top", autoupdate=autoupdate)
    gf = GridFunction(space, autoupdate=autoupdate)
    exact = CF(FIELDS[dim])
    gf.Set(exact)
    for _ in range(2):
        mesh.Refine()
        if not autoupdate:
            space.Update()
            gf.Update()
        number = dim * len(needed(mesh, "left|top", order))
        assert space.ndof == VectorH1(mesh, order=order).ndof + number
        assert len(gf.vec) == space.ndof
        assert is_consistent(space)
        space.components[0].Update()
        assert sum(space.FreeDofs()) == space.ndof
        if order == 1:  # NGSolve prolongates no more than that
            assert Integrate(Norm(gf - exact) * dx, mesh) < 1e-13


@pytest.mark.parametrize("by_region", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_pickling(kind, by_region):
    mesh = brick(kind, 2)
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
    assert pickle.loads(pickle.dumps(space.components[1])).ndof == space.components[1].ndof
    if kind in ("trig", "tet"):
        space2.mesh.Refine()
        space2.Update()
        n = len(slave_faces(space2.mesh, "left|top"))
        assert space2.ndof == mesh.dim * (space2.mesh.nv + n)


@pytest.mark.parametrize("make", [lambda: brick("trig"), lambda: mixed(2)])
def test_output(make, tmp_path):
    mesh = make()
    gf = GridFunction(BubbleVectorH1(mesh, order=1, slave="top"))
    gf.Set(FIELDS[mesh.dim])
    VTKOutput(mesh, coefs=[gf], names=["u"], filename=str(tmp_path / "u")).Do()
    Draw(gf, mesh, show=False, filename=str(tmp_path / "u.html"))
    assert all((tmp_path / name).stat().st_size > 0 for name in ("u.vtu", "u.html"))


def condition(space, mesh, order, **flags):
    """Of elasticity with both Lame constants 1, scaled to a diagonal of ones."""
    V = space(mesh, order=order, dirichlet="top", **flags)
    u, v = V.TnT()
    a = BilinearForm(InnerProduct(Sym(Grad(u)), 2 * Sym(Grad(v))) * dx + div(u) * div(v) * dx)
    values, columns, starts = (np.array(part) for part in a.Assemble().mat.CSR())
    free = np.flatnonzero(list(V.FreeDofs()))
    matrix = csr_matrix((values, columns, starts))[free][:, free].toarray()
    scale = 1 / np.sqrt(matrix.diagonal())
    eigenvalues = eigvalsh(matrix * np.outer(scale, scale))
    return eigenvalues[-1] / eigenvalues[0]


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_bubbles_keep_the_condition_number_and_split_faces_raise_it(kind, order):
    """Bubbles are nearly orthogonal to the rest: 13 % at most.

    Split high cells have eight times the number: bubbles are better for iterative solvers.
    """
    mesh = brick(kind, 3, 3) if order == 1 else brick(kind, 2, 1)
    plain = condition(VectorH1, mesh, order)
    assert condition(BubbleVectorH1, mesh, order, slave="bottom") < 1.15 * plain
    limits = {"pyramids": {"quad": 9, "prism": 8, "prism_side": 3, "pyramid": 2}.get(kind, 4)}
    if kind == "hex":
        limits["hexes"] = 6
    for hexes, factor in limits.items():
        split = SplitSlaveFaces(mesh, "bottom", hexes=hexes)
        assert condition(VectorH1, split, order) < factor * plain


def test_by_its_name_among_the_spaces():
    """As NGSolve makes spaces by name: a pattern, or the numbers of boundaries, counted from 1."""
    mesh = brick("tet", 2)
    wanted = BubbleVectorH1(mesh, order=1, slave="bottom|top")
    numbers = [k for k, name in enumerate(mesh.GetBoundaries(), 1) if name in ("bottom", "top")]
    for slave in ("bottom|top", numbers):
        space = FESpace("bubblevectorh1", mesh, order=1, slave=slave)
        assert space.ndof == wanted.ndof > VectorH1(mesh, order=1).ndof
        assert is_consistent(space)


@pytest.mark.parametrize(
    ("slave", "words"),
    [
        ({}, "say which boundaries get bubbles"),
        ({"slave": "nowhere"}, "pattern 'nowhere' matches none of the boundaries"),
        ({"slave": [99]}, "given region matches none of the boundaries .*'bottom'"),
    ],
)
def test_by_name_without_a_slave(slave, words):
    with pytest.raises(NgException, match=words):
        FESpace("bubblevectorh1", brick("tet", 2), order=1, **slave)
