"""LACSpace: macro-elements from the displacement space's own basis functions."""

import itertools

import numpy as np
import pytest
from bricks import (
    KINDS,
    RIM,
    TRIANGLES,
    ball,
    brick,
    facet,
    flipped,
    mixed,
    slave_faces,
    unstructured,
)
from ngsolve import BND, H1, ORDER_POLICY, NumberSpace, VectorH1, VectorValued
from partitions import SPACES, check_partition, cores, faces_of_macros, sizes

from ngslac import BubbleVectorH1, LACSpace

SIMPLEX = {2: "trig", 3: "tet"}
# Of order 1 on a slave surface four faces wide.
STARS = {"trig": [2, 2], "quad": [2, 2], "tet": [7, 7, 9, 9], "prism": [7, 7, 9, 9]}


def partition(mesh, order, slave="bottom", space="VectorH1", **flags):
    Q = LACSpace(SPACES[space](mesh, order=order, **flags), slave=slave)
    check_partition(Q, slave)
    return Q


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
    Q = partition(brick(kind), order, space=space, dirichlet="top")
    if order >= (3 if kind in TRIANGLES else 2) or space == "Bubble":
        assert sizes(Q) == [1] * len(slave_faces(Q.mesh))
    elif order == 2:
        assert sizes(Q) == [2] * 16
    else:
        assert sizes(Q) == STARS.get(kind, [4, 4, 4, 4])


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("space", SPACES)
def test_blocks_follow_the_displacement(space, dim):
    """The product with the displacement space must exist: same number of components per dof."""
    mesh = brick(SIMPLEX[dim])
    V = SPACES[space](mesh, order=3)
    Q = LACSpace(V, slave="bottom")
    assert Q.displacement == V
    assert Q.dim == V.dim
    u, lam = (V * Q).TrialFunction()
    assert u.dim == lam.dim == dim
    if Q.dim == 1:
        X = H1(mesh, order=1) * V * Q * NumberSpace(mesh)
        check_partition(X.components[2])
        assert X.ndof == mesh.nv + V.ndof + dim * Q.nmacros + 1


@pytest.mark.parametrize("n", range(2, 12))
@pytest.mark.parametrize("kind", ["trig", "tet", "hex"])
def test_order_one_makes_stars_of_inner_vertices(kind, n):
    """Every macro-element holds all faces at each vertex of its core, and little more."""
    mesh = brick(kind, n, 1)
    Q = partition(mesh, 1, dirichlet="" if kind == "trig" else RIM)
    everywhere = vertices_of(mesh, [el.nr for el in slave_faces(mesh)])
    for own, core in zip(faces_of_macros(Q), cores(Q), strict=True):
        vertices = {dof % mesh.nv for dof in core}
        assert core == sorted(v + k * mesh.nv for v in vertices for k in range(mesh.dim))
        for vertex in vertices:
            inside = sum(vertex in face for face in vertices_of(mesh, own))
            assert inside == sum(vertex in face for face in everywhere)
    if kind == "trig":
        assert sizes(Q) == [2] * (n // 2 - n % 2) + [3] * (n % 2)
    elif kind == "hex" and n % 2 == 0:
        assert sizes(Q) == [4] * (n // 2) ** 2
    else:
        assert (4 if kind == "hex" else 6) <= sizes(Q)[0]
        assert sizes(Q)[-1] <= (9 if kind == "tet" or n == 3 else 8)


@pytest.mark.parametrize("make", [lambda: unstructured(3, 0.13), lambda: ball(3, 0.4)])
def test_unstructured_triangles_make_small_stars_and_pairs(make):
    """Nearly all find a partner across an edge for order 2; the few left over make it three."""
    mesh, slave = make(), "bottom|surface"
    stars, Q = (partition(mesh, order, slave) for order in (1, 2))
    assert np.mean(sizes(stars)) < 8.5
    assert max(sizes(stars)) <= 11
    count = np.bincount(sizes(Q))
    assert count[:2].sum() == 0
    assert len(count) <= 4
    assert count[3:].sum() <= 2
    for own in faces_of_macros(Q):
        faces = vertices_of(mesh, own)
        assert any(len(a & b) == 2 for a, b in itertools.combinations(faces, 2))


@pytest.mark.pairwise
@pytest.mark.parametrize("space", ["VectorH1", "Bubble"])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_a_clamped_rim_changes_nothing(kind, order, space):
    """Dofs of the rim are no cores anyway: their supports reach beyond the slave surface."""
    mesh = brick(kind, 5, 1)
    free, clamped = (partition(mesh, order, space=space, dirichlet=d) for d in ("", RIM))
    assert list(free.macros) == list(clamped.macros)


@pytest.mark.parametrize("kind", KINDS)
def test_symmetry_planes_keep_single_faces(kind):
    mesh = brick(kind, 3, 1)
    flags = {"dirichletx": "left|right", "dirichlety": "front|top"}
    flags |= {} if mesh.dim == 2 else {"dirichletz": "top"}
    for space, order in (("Bubble", 1), ("VectorH1", 2 if mesh.dim == 2 else 3)):
        assert partition(mesh, order, space=space, **flags).nmacros == len(slave_faces(mesh))


@pytest.mark.parametrize(
    ("kind", "component"), [("trig", 0), ("trig", 1), ("hex", 0), ("hex", 1), ("hex", 2)]
)
def test_dofs_fixed_by_hand_are_no_cores(kind, component):
    """With one component of a vertex fixed, another star is chosen, if there is one."""
    mesh = brick(kind, 4, 1)
    V = VectorH1(mesh, order=1)
    assert sizes(LACSpace(V, slave="bottom")) == STARS.get(kind, [4, 4, 4, 4])
    corner = next(
        v.nr for v in mesh.vertices if v.point == ((0.25, 0) if kind == "trig" else (0.25, 0.25, 0))
    )
    V.FreeDofs().Clear(component * mesh.nv + corner)
    Q = LACSpace(V, slave="bottom")
    assert not V.FreeDofs()[component * mesh.nv + corner]
    check_partition(Q)
    assert not {corner + k * mesh.nv for k in range(mesh.dim)} <= set().union(*cores(Q))
    assert Q.nmacros == 1 if kind == "trig" else Q.nmacros >= 2


@pytest.mark.pairwise
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("slave", ["bottom|left", "bottom|left|front", ".*"])
def test_no_macro_element_bends_around_an_edge(slave, kind, order):
    """Prisms have triangles on some of these sides and quadrilaterals on others."""
    mesh = brick(kind, 4, 4)
    Q = partition(mesh, order, slave)
    side = {el.nr: el.mat for el in slave_faces(mesh, slave)}
    assert all(len({side[nr] for nr in own}) == 1 for own in faces_of_macros(Q))
    assert max(sizes(Q)) <= 12


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("space", ["VectorH1", "Bubble"])
def test_triangles_and_quadrilaterals_on_one_surface(space, order):
    """Each kind of face by its own rule; stars reach over the line between them."""
    mesh = mixed(4)
    corners = {el.nr: len(el.vertices) for el in slave_faces(mesh)}
    assert sorted(corners.values()) == [3] * 32 + [4] * 16
    shapes = [
        [corners[nr] for nr in own] for own in faces_of_macros(partition(mesh, order, space=space))
    ]
    if space == "Bubble" or order == 3:
        assert all(len(shape) == 1 for shape in shapes)
    elif order == 2:
        assert all(shape in ([4], [3, 3]) for shape in shapes)
    else:
        assert all(4 <= len(shape) <= 9 for shape in shapes)
        assert any(len(set(shape)) == 2 for shape in shapes)


@pytest.mark.parametrize("kind", ["quad", "hex"])
def test_bubbles_on_a_part_of_the_slave(kind):
    """Single faces where there are bubbles, stars where there are none."""
    Q = partition(brick(kind, 4, 4), 1, "bottom|left", space="Bubble")
    assert sizes(Q) == ([1] * 4 + [2] * 2 if kind == "quad" else [1] * 16 + [4] * 4)


@pytest.mark.parametrize(("kind", "n", "stars"), [("trig", 8, [2, 2]), ("hex", 4, [4, 4])])
def test_variable_order(kind, n, stars):
    """Order 1 but for some faces of order 2: those are single, the rest forms stars."""
    mesh = brick(kind, n, 1)
    scalar = H1(mesh, order=1, order_policy=ORDER_POLICY.VARIABLE)
    high = {el.nr: min(mesh[v].point[0] for v in el.vertices) >= 0.5 for el in slave_faces(mesh)}
    for el in slave_faces(mesh):
        if high[el.nr]:
            scalar.SetOrder(facet(el), 2)
    scalar.UpdateDofTables()
    Q = LACSpace(VectorValued(scalar, mesh.dim), slave="bottom")
    check_partition(Q)
    assert sizes(Q) == [1] * sum(high.values()) + stars
    for own in faces_of_macros(Q):
        assert {high[nr] for nr in own} == {len(own) == 1}


@pytest.mark.parametrize("every", [2, 3])
@pytest.mark.parametrize("kind", ["trig", "quad", "tet", "hex"])
def test_boundary_elements_written_backwards(kind, every):
    """The outside is where there is no volume element, however a boundary element runs."""
    mesh = brick(kind, 5)
    macros = [list(partition(flipped(mesh, e), 1).macros) for e in (0, every)]
    assert macros[0] == macros[1]
    assert max(macros[0]) > 0


@pytest.mark.parametrize("kind", ["quad", "tet"])
def test_components_and_regions(kind):
    mesh = brick(kind)
    V = BubbleVectorH1(mesh, slave="bottom|top")
    Q = LACSpace(V, slave="bottom|top")
    assert Q.ndof == mesh.dim * Q.nmacros == mesh.dim * len(slave_faces(mesh, "bottom|top"))
    for one in (Q.WithComponents(1), LACSpace(V, slave="bottom|top", components=1)):
        assert one.ndof == one.nmacros == Q.nmacros
        assert list(one.macros) == list(Q.macros)
    region = mesh.Boundaries("bottom") + mesh.Boundaries("top")
    by_region = LACSpace(V, slave=region)
    assert list(by_region.macros) == list(Q.macros)
    assert list(by_region.slave.Mask()) == list(region.Mask())
