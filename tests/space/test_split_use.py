"""SplitSlaveFaces in use: macro-elements and finite elements."""

import pytest
from bricks import slave_faces
from ngsolve import (
    H1,
    BilinearForm,
    GridFunction,
    Integrate,
    LinearForm,
    VectorH1,
    cos,
    dx,
    exp,
    grad,
    sin,
    x,
    y,
    z,
)
from partitions import check_partition, cores, faces_of_macros, sizes
from splits import ROUND, block, csg_hemisphere, parents, split_of

from ngslac import LACSpace


def parent_macros(mesh, split, slave="top"):
    """One macro-element per parent face, as LACSpace takes it: one number per slave face."""
    numbers = parents(mesh, split, slave)
    dense = {parent: m for m, parent in enumerate(sorted(set(numbers.values())))}
    return [dense[numbers[el.nr]] for el in slave_faces(split, slave)]


@pytest.mark.parametrize("clamped", [False, True])
@pytest.mark.parametrize(
    "kind", ["trig", "square", "tet", "prism", "hex", "prism_side", "pyramid", "cube", "round"]
)
def test_order_one_gives_the_parent_faces(kind, clamped):
    """The published condition, one multiplier per parent face, found by the space itself."""
    mesh, slave = (csg_hemisphere(), "surface") if kind == "round" else (block(kind, 3), "top")
    split = split_of(mesh, kind, slave)
    others = "|".join(set(mesh.GetBoundaries()) - {slave})
    Q = LACSpace(VectorH1(split, order=1, dirichlet=others if clamped else ""), slave=slave)
    check_partition(Q, slave)
    pairs = {(Q.macros[nr], parent) for nr, parent in parents(mesh, split, slave).items()}
    assert len(pairs) == Q.nmacros == len(slave_faces(mesh, slave))
    new = {el.nr: max(v.nr for v in el.vertices) for el in slave_faces(split, slave)}
    assert min(new.values()) >= mesh.nv
    for own, core in zip(faces_of_macros(Q), cores(Q), strict=True):
        (vertex,) = {new[nr] for nr in own}
        assert core == [vertex + k * split.nv for k in range(mesh.dim)]


@pytest.mark.parametrize(
    ("kind", "faces", "few", "many"), [("quad", 15, 2, 3), ("hexes", 45, 3, 9)]
)
def test_cells_split_into_their_own_shape(kind, faces, few, many):
    """Five quadrilaterals per former one: three make the star of a vertex, two join a star."""
    split = split_of(block(kind, 5 if kind == "quad" else 3), kind)
    assert len(slave_faces(split, "top")) == faces
    Q = LACSpace(VectorH1(split, order=1), slave="top")
    check_partition(Q, "top")
    assert few <= sizes(Q)[0] <= sizes(Q)[-1] <= many
    assert kind == "hexes" or sizes(Q) == [2] * 6 + [3]


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", ["trig", "quad", "tet", "prism", "hex", "hexes", "cube"])
def test_parent_faces_can_be_given(kind, order):
    """Order 2 as published for quadratic tetrahedra, and the five quadrilaterals of "hexes"."""
    mesh = block(kind, 3)
    split = split_of(mesh, kind)
    others = "|".join(set(mesh.GetBoundaries()) - {"top"})
    V = VectorH1(split, order=order, dirichlet=others)
    Q = LACSpace(V, slave="top", macros=parent_macros(mesh, split))
    assert Q.nmacros == len(slave_faces(mesh, "top"))
    inner = {"quad": 2, "hexes": 4}.get(kind, 1)
    assert order == 2 or {len(core) for core in cores(Q)} == {mesh.dim * inner}


@pytest.mark.parametrize("kind", ["tet", "prism", "hex"])
def test_order_two_holds_its_own_pairs(kind):
    """Edge functions live on two triangles: fewer faces than a parent has are enough."""
    V = VectorH1(split_of(block(kind, 4), kind), order=2)
    assert set(sizes(LACSpace(V, slave="top"))) == {2}


def poisson_error(mesh, order):
    far = (y, z)[mesh.dim - 2]
    exact = exp(x) * cos(y) + sin(x * far)
    fes = H1(mesh, order=order, dirichlet=".*")
    u, v = fes.TnT()
    a = BilinearForm(grad(u) * grad(v) * dx).Assemble()
    f = LinearForm((x * x + far * far) * sin(x * far) * v * dx).Assemble()
    gf = GridFunction(fes)
    gf.Set(exact, definedon=mesh.Boundaries(".*"))
    f.vec.data -= a.mat * gf.vec
    gf.vec.data += a.mat.Inverse(fes.FreeDofs(), inverse="sparsecholesky") * f.vec
    return Integrate((gf - exact) ** 2 * dx(bonus_intorder=6), mesh) ** 0.5


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize(
    "kind", ["trig", "quad", "tet", "prism", "hex", "hexes", "disk", "cylinder"]
)
def test_poisson(kind, order):
    """A split mesh is at least as good as the one before: convergence is the same."""
    curved = kind in ROUND
    mesh = ROUND[kind][0]().Curve(order) if curved else block(kind, 6, layers=6)
    split = split_of(mesh, kind, "surface" if curved else "left|top")
    factor = 1.0 if curved and order > 1 else 1.1
    assert poisson_error(split, order) < factor * poisson_error(mesh, order)
