"""LACSpace: macro-elements from the displacement space's own basis functions."""

import numpy as np
import pytest
from netgen.geom2d import unit_square
from ngsolve import (
    BND,
    EDGE,
    H1,
    ORDER_POLICY,
    VOL,
    Mesh,
    NodeId,
    NumberSpace,
    VectorH1,
    VectorValued,
)
from ngsolve.meshes import MakeStructured2DMesh

from ngslac import BubbleVectorH1, LACSpace, SplitSlaveFaces


def square(maxh=0.2):
    return Mesh(unit_square.GenerateMesh(maxh=maxh))


def slave_faces(mesh, slave="bottom"):
    return [el.nr for el in mesh.Boundaries(slave).Elements()]


def faces_of_macros(Q):
    """The boundary elements of each macro-element."""
    macros = np.array(Q.macros)
    return [np.flatnonzero(macros == m) for m in range(Q.nmacros)]


def check_partition(Q, mesh, slave="bottom"):
    """What holds for every space: no unused dofs, all faces taken, connected, cores inside."""
    macros, faces = np.array(Q.macros), slave_faces(mesh, slave)
    assert len(macros) == mesh.GetNE(BND)
    assert np.flatnonzero(macros >= 0).tolist() == sorted(faces)
    assert set(macros[faces]) == set(range(Q.nmacros))
    assert Q.ndof * Q.dim == 2 * Q.nmacros
    assert all(Q.FreeDofs())
    supports = traces(Q.displacement, mesh, slave)
    for m, own in enumerate(faces_of_macros(Q)):
        check_connected(mesh, own)
        core = list(Q.CoreDofs(m))
        assert core
        assert all(supports[dof] <= set(own.tolist()) for dof in core)
        assert not any(fixed(Q.displacement, dof) for dof in core)


def fixed(V, dof):
    return not V.FreeDofs()[dof // V.dim]


def traces(V, mesh, slave):
    """Slave faces on which each scalar displacement dof lives (by the space's dof numbers)."""
    supports = {}
    for nr in slave_faces(mesh, slave):
        el = mesh[next(e for e in mesh.Elements(BND) if e.nr == nr)]
        for dof in V.GetDofNrs(el):
            for k in range(V.dim):
                supports.setdefault(V.dim * dof + k, set()).add(nr)
    return supports


def check_connected(mesh, faces):
    vertices = [{v.nr for v in e.vertices} for e in mesh.Elements(BND) if e.nr in faces]
    reached, rest = vertices[0], vertices[1:]
    while touching := [v for v in rest if v & reached]:
        reached = reached.union(*touching)
        rest = [v for v in rest if v not in touching]
    assert not rest


SPACES = {
    "VectorH1": lambda mesh, order, **flags: VectorH1(mesh, order=order, **flags),
    "H1(dim=2)": lambda mesh, order, **flags: H1(mesh, order=order, dim=2, **flags),
    "VectorValued": lambda mesh, order, **flags: VectorValued(H1(mesh, order=order, **flags)),
    "component": lambda mesh, order, **flags: (
        VectorH1(mesh, order=order, **flags) * H1(mesh, order=1)
    ).components[0],
    "Bubble": lambda mesh, order, **flags: BubbleVectorH1(
        mesh, order=order, slave="bottom", **flags
    ),
}


@pytest.mark.pairwise
@pytest.mark.parametrize("quads", [False, True])
@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("space", SPACES)
def test_partition_of_every_space(space, order, quads):
    mesh = MakeStructured2DMesh(quads=quads, nx=7, ny=2)
    V = SPACES[space](mesh, order, dirichlet="top")
    Q = LACSpace(V, slave="bottom")
    check_partition(Q, mesh)
    assert Q.displacement is V or Q.displacement == V
    # One face each where faces have dofs of their own, else the star of every second vertex.
    assert Q.nmacros == (3 if order == 1 and space != "Bubble" else 7)


@pytest.mark.parametrize("space", SPACES)
def test_blocks_follow_the_displacement(space):
    """The product with the displacement space must exist: same number of components per dof."""
    mesh = square()
    V = SPACES[space](mesh, 2)
    Q = LACSpace(V, slave="bottom")
    assert Q.dim == V.dim
    X = V * Q
    assert X.ndof == V.ndof + Q.ndof
    u, lam = X.TrialFunction()
    assert u.dim == lam.dim == 2


@pytest.mark.parametrize("n", range(2, 13))
def test_p1_macros_are_stars_of_vertices(n):
    """n faces give floor(n / 2) macro-elements of two faces, one of them with a third."""
    mesh = MakeStructured2DMesh(quads=False, nx=n, ny=2)
    Q = LACSpace(VectorH1(mesh, order=1), slave="bottom")
    check_partition(Q, mesh)
    sizes = sorted(map(len, faces_of_macros(Q)))
    assert Q.nmacros == n // 2
    assert sizes == [2] * (n // 2 - n % 2) + [3] * (n % 2)


def test_p1_cores_are_the_middle_vertices():
    mesh = MakeStructured2DMesh(quads=False, nx=6, ny=2)
    Q = LACSpace(VectorH1(mesh, order=1), slave="bottom")
    xs = {v.nr: v.point[0] for v in mesh.vertices if v.point[1] == 0}
    cores = [sorted(Q.CoreDofs(m)) for m in range(3)]
    assert all(len(core) == 2 and core[1] == core[0] + mesh.nv for core in cores)
    assert sorted(xs[core[0]] for core in cores) == pytest.approx([1 / 6, 3 / 6, 5 / 6])


@pytest.mark.parametrize(("dirichlet", "count"), [("left", 3), ("left|right", 3), ("top", 3)])
def test_dirichlet_at_the_end_of_the_slave(dirichlet, count):
    """End vertices are no cores anyway: their supports reach beyond the slave."""
    mesh = MakeStructured2DMesh(quads=False, nx=6, ny=2)
    Q = LACSpace(VectorH1(mesh, order=1, dirichlet=dirichlet), slave="bottom")
    check_partition(Q, mesh)
    assert Q.nmacros == count


def test_dofs_fixed_by_hand_are_no_cores():
    """Four faces have two stars; with a vertex of one fixed, one star in the middle is left."""
    mesh = MakeStructured2DMesh(quads=False, nx=4, ny=2)
    V = VectorH1(mesh, order=1)
    assert LACSpace(V, slave="bottom").nmacros == 2
    first = next(v.nr for v in mesh.vertices if v.point == (0.25, 0))
    V.FreeDofs().Clear(first)  # one component is enough: all directions are needed
    Q = LACSpace(V, slave="bottom")
    assert not V.FreeDofs()[first]
    check_partition(Q, mesh)
    assert Q.nmacros == 1
    assert first not in Q.CoreDofs(0)


def test_symmetry_line_next_to_the_slave_keeps_order_two_single():
    mesh = square()
    Q = LACSpace(VectorH1(mesh, order=2, dirichletx="left|right"), slave="bottom")
    check_partition(Q, mesh)
    assert Q.nmacros == len(slave_faces(mesh))


@pytest.mark.parametrize("curve", [1, 2])
def test_split_meshes_give_the_parent_edges(curve):
    coarse = square(0.3)
    coarse.Curve(curve)
    fine = SplitSlaveFaces(coarse, "bottom")
    Q = LACSpace(VectorH1(fine, order=1, dirichlet="left|right|top"), slave="bottom")
    check_partition(Q, fine)

    def ends(mesh, faces):
        xs = [v.point[0] for f in faces for v in f.vertices for v in [mesh[v]]]
        return round(min(xs), 12), round(max(xs), 12)

    parents = {ends(coarse, [e]) for e in coarse.Boundaries("bottom").Elements()}
    elements = {e.nr: e for e in fine.Elements(BND)}
    mine = {ends(fine, [elements[f] for f in own]) for own in faces_of_macros(Q)}
    assert mine == parents
    assert all(len(own) == 2 for own in faces_of_macros(Q))


def test_split_quadrilaterals_give_the_parent_edges():
    mesh = SplitSlaveFaces(MakeStructured2DMesh(quads=True, nx=5, ny=2), "bottom")
    Q = LACSpace(VectorH1(mesh, order=1), slave="bottom")
    check_partition(Q, mesh)
    assert len(slave_faces(mesh)) == 15
    assert Q.nmacros == 7  # stars of two faces, one of three


def test_variable_order():
    """Order 1 but for some edges of order 2: those are single, the rest forms stars."""
    mesh = MakeStructured2DMesh(quads=False, nx=8, ny=2)
    scalar = H1(mesh, order=1, order_policy=ORDER_POLICY.VARIABLE)
    edges = {}
    for el in mesh.Boundaries("bottom").Elements():
        x = np.mean([mesh[v].point[0] for v in el.vertices])
        edges[el.nr] = x
        if x > 0.5:
            scalar.SetOrder(NodeId(EDGE, el.edges[0].nr), 2)
    scalar.UpdateDofTables()
    V = VectorValued(scalar)
    Q = LACSpace(V, slave="bottom")
    check_partition(Q, mesh)
    sizes = {m: len(own) for m, own in enumerate(faces_of_macros(Q))}
    for nr, x in edges.items():
        assert sizes[Q.macros[nr]] == (1 if x > 0.5 else 2)


def test_components_and_number_of_dofs():
    mesh = square()
    Q = LACSpace(VectorH1(mesh, order=2), slave="bottom|top")
    assert Q.ndof == 2 * Q.nmacros == 2 * len(slave_faces(mesh, "bottom|top"))
    one = Q.WithComponents(1)
    assert one.ndof == one.nmacros == Q.nmacros
    assert list(one.macros) == list(Q.macros)
    assert LACSpace(VectorH1(mesh, order=2), slave="bottom", components=1).ndof == 5


def test_region_and_pattern_are_the_same():
    mesh = square()
    V = VectorH1(mesh, order=2)
    by_name, by_region = LACSpace(V, slave="bottom"), LACSpace(V, slave=mesh.Boundaries("bottom"))
    assert list(by_name.macros) == list(by_region.macros)
    assert list(by_region.slave.Mask()) == list(mesh.Boundaries("bottom").Mask())


def test_given_macros():
    mesh = MakeStructured2DMesh(quads=False, nx=6, ny=2)
    V = VectorH1(mesh, order=2)
    Q = LACSpace(V, slave="bottom", macros=[0, 0, 1, 1, 1, 2])
    check_partition(Q, mesh)
    assert Q.nmacros == 3
    assert sorted(map(len, faces_of_macros(Q))) == [1, 2, 3]
    by_hand = [Q.macros[f] for f in slave_faces(mesh)]
    assert by_hand == [0, 0, 1, 1, 1, 2]


def test_no_dofs_inside_of_bodies_or_elsewhere():
    mesh = square()
    Q = LACSpace(VectorH1(mesh, order=2), slave="bottom")
    assert all(len(el.dofs) == 0 for el in Q.Elements(VOL))
    on_slave = set(slave_faces(mesh))
    for el in Q.Elements(BND):
        assert len(el.dofs) == (2 if el.nr in on_slave else 0)
        assert el.GetFE().ndof == len(el.dofs)


def test_product_with_other_unknowns():
    mesh = square()
    V = VectorH1(mesh, order=2)
    X = H1(mesh, order=1) * V * LACSpace(V, slave="bottom") * NumberSpace(mesh)
    Q = X.components[2]
    check_partition(Q, mesh)
    assert X.ndof == mesh.nv + V.ndof + 2 * Q.nmacros + 1
