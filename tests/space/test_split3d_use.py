"""SplitSlaveFaces in use in 3D: macro-elements, finite elements, wrong arguments."""

import numpy as np
import pytest
from ngsolve import (
    H1,
    BilinearForm,
    GridFunction,
    InnerProduct,
    LinearForm,
    Mesh,
    VectorH1,
    ds,
    dx,
    grad,
)
from scipy.linalg import eigh
from splitmeshes3d import (
    brick,
    csg_hemisphere,
    cube,
    elements,
    occ_ball,
    occ_cylinder,
    parents,
    poisson_error,
)

from ngslac import LACSpace, SplitSlaveFaces

KINDS = ["tet", "prism", "hex", "hexes", "unstructured"]


def unsplit(kind, n):
    return cube(1 / n) if kind == "unstructured" else brick("hex" if kind == "hexes" else kind, n)


def split_of(mesh, kind, slave="top"):
    return SplitSlaveFaces(mesh, slave, hexes="hexes" if kind == "hexes" else "pyramids")


def macros_of_parents(mesh, split, slave):
    """One macro-element per parent face, as LACSpace takes it: one number per slave face."""
    numbers = parents(mesh, split, slave)
    dense = {parent: m for m, parent in enumerate(sorted(set(numbers.values())))}
    return [dense[numbers[el.nr]] for el in split.Boundaries(slave).Elements()]


@pytest.mark.parametrize("clamped", [False, True])
@pytest.mark.parametrize("kind", ["tet", "prism", "hex", "unstructured", "round"])
def test_order_one_gives_the_parent_faces(kind, clamped):
    """The published condition, one multiplier per parent face, found by the space itself."""
    mesh, slave = (csg_hemisphere(), "round") if kind == "round" else (unsplit(kind, 3), "top")
    split = split_of(mesh, kind, slave)
    others = "|".join(set(mesh.GetBoundaries()) - {slave})
    Q = LACSpace(VectorH1(split, order=1, dirichlet=others if clamped else ""), slave=slave)
    numbers = parents(mesh, split, slave)
    pairs = {(Q.macros[nr], parent) for nr, parent in numbers.items()}
    assert len(pairs) == Q.nmacros == len(set(numbers.values()))


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_parent_faces_can_be_given(kind, order):
    """Order 2 as published for quadratic tetrahedra, and the five quadrilaterals of "hexes"."""
    mesh = unsplit(kind, 3)
    split = split_of(mesh, kind)
    V = VectorH1(split, order=order, dirichlet="|".join(set(mesh.GetBoundaries()) - {"top"}))
    macros = macros_of_parents(mesh, split, "top")
    Q = LACSpace(V, slave="top", macros=macros)
    n = sum(1 for _ in mesh.Boundaries("top").Elements())
    assert Q.nmacros == n
    inner = {1: 4 if kind == "hexes" else 1}.get(order)
    for m in range(n if inner else 0):
        assert len(Q.CoreDofs(m)) == 3 * inner


@pytest.mark.parametrize("kind", ["tet", "prism", "hex"])
def test_order_two_holds_its_own_pairs(kind):
    """Edge functions live on two triangles: fewer faces than a parent has are enough."""
    mesh = unsplit(kind, 4)
    split = split_of(mesh, kind)
    Q = LACSpace(VectorH1(split, order=2), slave="top")
    sizes = np.bincount([Q.macros[el.nr] for el in split.Boundaries("top").Elements()])
    assert set(sizes) == {2}


def contact_operator(fes, macros):
    """S = B A^-1 B^T: B the mean trace per macro-element, A the inner product of H1."""
    u, v = fes.TnT()
    a = BilinearForm((grad(u) * grad(v) + u * v) * dx).Assemble()
    inv = a.mat.Inverse(fes.FreeDofs(), inverse="sparsecholesky")
    marks = GridFunction(LACSpace(VectorH1(fes.mesh, order=4), slave="top", macros=macros))
    columns = []
    for m in range(max(macros) + 1):
        marks.vec[:] = 0
        marks.vec.FV().NumPy()[3 * m] = 1
        columns.append(LinearForm(marks[0] * v * ds("top")).Assemble().vec)
    solutions = [(inv * b).Evaluate() for b in columns]
    return np.array([[InnerProduct(b, s) for s in solutions] for b in columns])


@pytest.mark.parametrize("kind", ["tet", "prism", "hex", "hexes"])
def test_parent_faces_are_stable_macro_elements(kind):
    """The inf-sup constant of one multiplier per parent face does not fall with the mesh size."""
    betas = []
    for n in (4, 6):
        half = lambda s, t, r: (s, t, r / 2)  # noqa: E731
        mesh = brick("hex" if kind == "hexes" else kind, n, nz=n // 2, mapping=half)
        split = split_of(mesh, kind)
        macros = macros_of_parents(mesh, split, "top")
        lowest, fine = (
            contact_operator(H1(split, order=p, dirichlet="left|right|front|back"), macros)
            for p in (1, 3)
        )
        betas.append(eigh(lowest, fine, eigvals_only=True)[0] ** 0.5)
    assert betas[0] > {"tet": 0.28, "prism": 0.22, "hex": 0.36, "hexes": 0.58}[kind]
    assert betas[1] > 0.96 * betas[0]


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", ["tet", "prism", "hex", "hexes"])
def test_poisson(kind, order):
    errors = []
    for n in (4, 8):
        mesh = brick("hex" if kind == "hexes" else kind, n, nz=n)
        errors.append(poisson_error(split_of(mesh, kind, "left|top"), order))
        assert errors[-1] < 1.1 * poisson_error(mesh, order)
    assert np.log2(errors[0] / errors[1]) > order + 0.85


@pytest.mark.parametrize("order", [2, 3])
def test_poisson_on_curved_split(order):
    mesh = occ_cylinder().Curve(order)
    split = SplitSlaveFaces(mesh, "round")
    assert poisson_error(split, order) < poisson_error(mesh, order)


def test_region_argument():
    mesh = cube()
    by_name = SplitSlaveFaces(mesh, "left|top")
    by_region = SplitSlaveFaces(mesh, mesh.Boundaries("left") + mesh.Boundaries("top"))
    assert elements(by_region) == elements(by_name)


def test_wrong_arguments():
    mesh, other = cube(), cube()
    with pytest.raises(
        ValueError, match=r"slave='rim' matches no boundary face; the boundaries are: back"
    ):
        SplitSlaveFaces(mesh, "rim")
    with pytest.raises(Exception, match="slave is a region of another mesh"):
        SplitSlaveFaces(mesh, other.Boundaries("left"))
    for region in (mesh.Materials(".*"), mesh.BBoundaries(".*")):
        with pytest.raises(Exception, match=r"slave = .* must be a pattern of boundary names"):
            SplitSlaveFaces(mesh, region)
    with pytest.raises(ValueError, match="hexes = 'cubes' must be one of 'pyramids', 'hexes'"):
        SplitSlaveFaces(mesh, "top", hexes="cubes")
    quadratic = cube().ngmesh
    quadratic.SecondOrder()
    with pytest.raises(Exception, match="second order"):
        SplitSlaveFaces(Mesh(quadratic), "top")


def test_boundary_too_coarse_to_split():
    """Tetrahedra with two faces on the sphere: no centre of one sees the other."""
    with pytest.raises(Exception, match="fold over"):
        SplitSlaveFaces(occ_ball(0.6), "round")
