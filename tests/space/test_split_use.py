"""SplitSlaveFaces in use: macro-elements, their stability, finite elements."""

import numpy as np
import pytest
from bricks import RIM, ball, slave_faces
from ngsolve import (
    H1,
    BilinearForm,
    GridFunction,
    InnerProduct,
    Integrate,
    LinearForm,
    VectorH1,
    cos,
    ds,
    dx,
    exp,
    grad,
    sin,
    x,
    y,
    z,
)
from partitions import check_partition, cores, faces_of_macros, sizes
from scipy.linalg import eigh
from splits import block, csg_hemisphere, cylinder, parents, split_of

from ngslac import LACSpace, SplitSlaveFaces


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


def contact_operator(fes, macros):
    """S = B A^-1 B^T: B the mean trace per macro-element, A the inner product of H1."""
    u, v = fes.TnT()
    a = BilinearForm((grad(u) * grad(v) + u * v) * dx).Assemble()
    inv = a.mat.Inverse(fes.FreeDofs(), inverse="sparsecholesky")
    marks = GridFunction(LACSpace(VectorH1(fes.mesh, order=4), slave="top", macros=macros))
    columns = []
    for m in range(max(macros) + 1):
        marks.vec[:] = 0
        marks.vec.FV().NumPy()[fes.mesh.dim * m] = 1
        columns.append(LinearForm(marks[0] * v * ds("top")).Assemble().vec)
    solutions = [(inv * b).Evaluate() for b in columns]
    return np.array([[InnerProduct(b, s) for s in solutions] for b in columns])


LEAST = {"trig": 0.5, "quad": 0.5, "tet": 0.28, "prism": 0.22, "hex": 0.36, "hexes": 0.58}


@pytest.mark.parametrize(
    ("kind", "clamped"), [("trig", ""), ("quad", ""), *((kind, RIM) for kind in LEAST)]
)
def test_parent_faces_are_stable_macro_elements(kind, clamped):
    """The inf-sup constant of one multiplier per parent face does not fall with the mesh size."""
    betas, plane = [], kind in ("trig", "quad")
    for n in (4, 8, 16) if plane else (4, 6):
        mesh = block(kind, n, layers=n) if plane else block(kind, n, layers=n // 2, mapping=Halve)
        split = split_of(mesh, kind)
        macros = parent_macros(mesh, split)
        lowest, fine = (
            contact_operator(H1(split, order=p, dirichlet=clamped), macros)
            for p in (1, 4 if plane else 3)
        )
        betas.append(eigh(lowest, fine, eigvals_only=True)[0] ** 0.5)
    assert min(betas[:-1]) > LEAST[kind]
    assert betas[-1] > (0.95 if plane else 0.96) * betas[-2]


def Halve(points):
    return points * (1, 1, 0.5)


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


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", ["trig", "quad", "tet", "prism", "hex", "hexes"])
def test_poisson(kind, order):
    errors, plane = [], kind in ("trig", "quad")
    for n in (4, 8, 16) if plane else (4, 8):
        mesh = block(kind, n, layers=n)
        errors.append(poisson_error(split_of(mesh, kind, "left|top"), order))
        assert errors[-1] < 1.1 * poisson_error(mesh, order)
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert rates.min() > order + (0.8 if plane else 0.85)


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("make", [lambda: ball(2, 0.3, 1), cylinder])
def test_poisson_on_curved_split(make, order):
    mesh = make().Curve(order)
    assert poisson_error(SplitSlaveFaces(mesh, "surface"), order) < poisson_error(mesh, order)
