"""LACSpace in three dimensions: macro-elements on triangles, quadrilaterals and both."""

import itertools
from functools import lru_cache

import numpy as np
import pytest
from ngsolve import BND, FACE, H1, ORDER_POLICY, NodeId, VectorH1, VectorValued
from spaces3d import (
    KINDS,
    RIM,
    SPACES,
    TRIANGLES,
    ball,
    brick,
    check_partition,
    faces_of_macros,
    mixed,
    sizes,
    slave_faces,
    tetrahedra,
)

from ngslac import BubbleVectorH1, LACSpace, SplitSlaveFaces


def vertices_of(mesh, faces):
    """For every face given by its number, the set of its vertices."""
    elements = {el.nr: {v.nr for v in el.vertices} for el in mesh.Elements(BND)}
    return [elements[nr] for nr in faces]


@pytest.mark.pairwise
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("space", SPACES)
def test_partition_of_every_space(space, order, kind):
    """One face each where faces have dofs of their own, else pairs (order 2) or stars (order 1)."""
    Q = LACSpace(SPACES[space](brick(4, kind), order=order, dirichlet="top"), slave="bottom")
    check_partition(Q)
    least = 3 if kind in TRIANGLES else 2
    if order >= least or space == "Bubble":
        assert sizes(Q) == [1] * len(slave_faces(Q.mesh))
    elif order == 2:
        assert sizes(Q) == [2] * 16
    else:
        assert sizes(Q) == ([7, 7, 9, 9] if kind in TRIANGLES else [4, 4, 4, 4])


@pytest.mark.parametrize("n", range(2, 10))
@pytest.mark.parametrize("kind", ["tet", "hex"])
def test_order_one_makes_stars_of_inner_vertices(kind, n):
    """Every macro-element holds all faces at one of its vertices, and little more than those."""
    mesh = brick(n, kind, 1)
    Q = LACSpace(VectorH1(mesh, order=1, dirichlet=RIM), slave="bottom")
    check_partition(Q)
    everywhere = vertices_of(mesh, [el.nr for el in slave_faces(mesh)])
    for m, own in enumerate(faces_of_macros(Q)):
        for vertex in {dof % mesh.nv for dof in Q.CoreDofs(m)}:
            inside = sum(vertex in face for face in vertices_of(mesh, own))
            assert inside == sum(vertex in face for face in everywhere)
    assert max(sizes(Q)) <= (9 if kind == "tet" or n == 3 else 8)
    assert min(sizes(Q)) >= (6 if kind == "tet" else 4)
    assert n % 2 or kind == "tet" or sizes(Q) == [4] * (n // 2) ** 2


@lru_cache
def unstructured(shape):
    return tetrahedra(0.15) if shape == "box" else ball(0.4)


@pytest.mark.parametrize("shape", ["box", "ball"])
def test_order_two_makes_pairs_of_unstructured_triangles(shape):
    """Nearly all triangles find a partner across an edge; the few left over make it three."""
    mesh, slave = unstructured(shape), "bottom|surface"
    Q = LACSpace(VectorH1(mesh, order=2), slave=slave)
    check_partition(Q, slave)
    count = np.bincount(sizes(Q))
    assert count[:2].sum() == 0
    assert len(count) <= 4
    assert count[3:].sum() <= 2
    for own in faces_of_macros(Q):
        faces = vertices_of(mesh, own)
        assert any(len(a & b) == 2 for a, b in itertools.combinations(faces, 2))


@pytest.mark.parametrize("shape", ["box", "ball"])
def test_order_one_makes_small_stars_of_unstructured_triangles(shape):
    slave = "bottom|surface"
    Q = LACSpace(VectorH1(unstructured(shape), order=1), slave=slave)
    check_partition(Q, slave)
    assert np.mean(sizes(Q)) < 8.5
    assert max(sizes(Q)) <= 11


@pytest.mark.pairwise
@pytest.mark.parametrize("space", ["VectorH1", "Bubble"])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_a_clamped_rim_changes_nothing(kind, order, space):
    """Dofs of the rim are no cores anyway: their supports reach beyond the slave surface."""
    mesh = brick(5, kind, 1)
    free, clamped = (
        LACSpace(SPACES[space](mesh, order=order, **flags), slave="bottom")
        for flags in ({}, {"dirichlet": RIM})
    )
    check_partition(clamped)
    assert list(free.macros) == list(clamped.macros)


@pytest.mark.parametrize("kind", KINDS)
def test_symmetry_planes_keep_single_faces(kind):
    mesh = brick(3, kind, 1)
    flags = {"dirichletx": "left|right", "dirichlety": "front", "dirichletz": "top"}
    Q = LACSpace(BubbleVectorH1(mesh, order=1, slave="bottom", **flags), slave="bottom")
    check_partition(Q)
    assert Q.nmacros == len(slave_faces(mesh))


@pytest.mark.parametrize("component", [0, 1, 2])
def test_dofs_fixed_by_hand_are_no_cores(component):
    """Four stars of quadrilaterals; with one component of a vertex fixed, another one is chosen."""
    mesh = brick(4, "hex", 1)
    V = VectorH1(mesh, order=1)
    assert sizes(LACSpace(V, slave="bottom")) == [4] * 4
    corner = next(v.nr for v in mesh.vertices if v.point == (0.25, 0.25, 0))
    V.FreeDofs().Clear(component * mesh.nv + corner)
    Q = LACSpace(V, slave="bottom")
    check_partition(Q)
    assert not {corner + k * mesh.nv for k in range(3)} <= {
        dof for m in range(Q.nmacros) for dof in Q.CoreDofs(m)
    }
    assert Q.nmacros >= 2


@pytest.mark.pairwise
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("slave", ["bottom|left", "bottom|left|front", ".*"])
def test_no_macro_element_bends_around_an_edge(slave, kind, order):
    """Prisms have triangles on some of these sides and quadrilaterals on others."""
    mesh = brick(4, kind, 4)
    Q = LACSpace(VectorH1(mesh, order=order), slave=slave)
    check_partition(Q, slave)
    side = {el.nr: el.mat for el in slave_faces(mesh, slave)}
    assert all(len({side[nr] for nr in own}) == 1 for own in faces_of_macros(Q))
    assert max(sizes(Q)) <= 12


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("bubble", [False, True])
def test_triangles_and_quadrilaterals_on_one_surface(bubble, order):
    """Each kind of face by its own rule; stars reach over the line between them."""
    mesh = mixed(4)
    space = SPACES["Bubble"] if bubble else VectorH1
    Q = LACSpace(space(mesh, order=order), slave="bottom")
    check_partition(Q)
    corners = {el.nr: len(el.vertices) for el in slave_faces(mesh)}
    assert sorted(corners.values()) == [3] * 32 + [4] * 16
    for own in faces_of_macros(Q):
        if bubble or order == 3:
            assert len(own) == 1
        elif order == 2:
            assert [corners[nr] for nr in own] in ([4], [3, 3])
        else:
            assert 4 <= len(own) <= 9
    if order == 1 and not bubble:
        assert any(len({corners[nr] for nr in own}) == 2 for own in faces_of_macros(Q))


def test_bubbles_on_a_part_of_the_slave():
    """Single faces where there are bubbles, stars where there are none."""
    mesh = brick(4, "hex", 4)
    Q = LACSpace(BubbleVectorH1(mesh, order=1, slave="bottom"), slave="bottom|left")
    check_partition(Q, "bottom|left")
    assert sizes(Q) == [1] * 16 + [4] * 4


def test_variable_order():
    """Order 1 but for some faces of order 2: those are single, the rest forms stars."""
    mesh = brick(4, "hex", 1)
    scalar = H1(mesh, order=1, order_policy=ORDER_POLICY.VARIABLE)
    high = {}
    for el in slave_faces(mesh):
        high[el.nr] = all(mesh[v].point[0] >= 0.5 for v in el.vertices)
        if high[el.nr]:
            scalar.SetOrder(NodeId(FACE, el.faces[0].nr), 2)
    scalar.UpdateDofTables()
    Q = LACSpace(VectorValued(scalar, 3), slave="bottom")
    check_partition(Q)
    assert sizes(Q) == [1] * 8 + [4] * 2
    for own in faces_of_macros(Q):
        assert {high[nr] for nr in own} == {len(own) == 1}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("clamped", [False, True])
def test_split_meshes_give_the_former_faces(clamped, kind):
    """Of order 1: each former face is the star of the vertex within."""
    coarse = brick(3, kind, 1)
    mesh = SplitSlaveFaces(coarse, "bottom")
    Q = LACSpace(VectorH1(mesh, order=1, **({"dirichlet": RIM} if clamped else {})), slave="bottom")
    check_partition(Q)
    assert Q.nmacros == len(slave_faces(coarse))
    new = {el.nr: max(v.nr for v in el.vertices) for el in slave_faces(mesh)}
    assert min(new.values()) >= coarse.nv
    for macro, own in enumerate(faces_of_macros(Q)):
        (vertex,) = {new[nr] for nr in own}
        assert sorted(Q.CoreDofs(macro)) == [vertex + k * mesh.nv for k in range(3)]
        assert len(own) == (3 if kind in TRIANGLES else 4)


def test_hexahedra_split_into_hexahedra():
    """Five quadrilaterals per former face: three make the star of a vertex, two join a star."""
    mesh = SplitSlaveFaces(brick(3, "hex", 1), "bottom", hexes="hexes")
    assert len(slave_faces(mesh)) == 45
    Q = LACSpace(VectorH1(mesh, order=1), slave="bottom")
    check_partition(Q)
    assert min(sizes(Q)) >= 3
    assert max(sizes(Q)) <= 9
