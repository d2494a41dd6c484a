"""Wrong input to LACSpace: partitions that are unstable, spaces that do not fit."""

import pytest
from ngsolve import H1, VectorH1, VectorL2
from ngsolve.meshes import MakeStructured2DMesh

from ngslac import BubbleVectorH1, LACSpace, SplitSlaveFaces

REMEDY = r"Remedy: SplitSlaveFaces\(mesh, slave\), BubbleVectorH1\(mesh, slave=...\)"


@pytest.fixture
def mesh():
    return MakeStructured2DMesh(quads=False, nx=6, ny=2)


def raises(text, kind=Exception):
    return pytest.raises(kind, match=text)


@pytest.mark.parametrize("n", [1, 2])
def test_too_few_faces_for_a_stable_partition(n):
    """One face has no vertex inside, two clamped at it have none that is free."""
    mesh = MakeStructured2DMesh(quads=False, nx=n, ny=2)
    V = VectorH1(mesh, order=1)
    if n == 2:
        middle = next(v.nr for v in mesh.vertices if v.point == (0.5, 0))
        V.FreeDofs().Clear(middle)
        V.FreeDofs().Clear(middle + mesh.nv)
    with raises(rf"no macro-element can be made of {n} face\(s\) of boundary 'bottom'.*{REMEDY}"):
        LACSpace(V, slave="bottom")
    assert LACSpace(BubbleVectorH1(mesh, order=1, slave="bottom"), slave="bottom").nmacros == n
    split = SplitSlaveFaces(mesh, "bottom")
    assert LACSpace(VectorH1(split, order=1), slave="bottom").nmacros == n


@pytest.mark.parametrize("order", [1, 2, 3])
def test_clamped_slave(mesh, order):
    with raises(r"6 face\(s\) of boundary 'bottom'.*no Dirichlet condition on the slave faces"):
        LACSpace(VectorH1(mesh, order=order, dirichlet="bottom"), slave="bottom")


def test_clamped_in_one_direction(mesh):
    """A slave that cannot move along y has no stable multiplier for it."""
    with raises("no macro-element can be made"):
        LACSpace(VectorH1(mesh, order=2, dirichlety="bottom"), slave="bottom")


@pytest.mark.parametrize(
    ("space", "text"),
    [
        (lambda m: H1(m, order=2), "has 1 component.*give a vector-valued space such as VectorH1"),
        (lambda m: H1(m, order=2, dim=3), "has 3 component.*in 2D"),
        (lambda m: VectorH1(m, order=2, complex=True), "is complex; contact needs real"),
        (lambda m: VectorL2(m, order=2), "boundary|no macro-element"),
    ],
)
def test_spaces_that_are_no_displacements(mesh, space, text):
    with raises(text):
        LACSpace(space(mesh), slave="bottom")


@pytest.mark.parametrize(
    ("macros", "text"),
    [
        ([0, 0, 1], "macros has 3 entries, but there are 6 slave faces; give one number per face"),
        ([], "macros has 0 entries"),
        ([0, 0, 1, 1, -1, 2], "macros holds the negative number -1"),
        ([0, 0, 1, 1, 3, 3], "macro-element 2 has no face; number them densely"),
        ([5] * 6, "macro-element 0 has no face"),
    ],
)
def test_macros_that_are_no_partition(mesh, macros, text):
    with raises(text):
        LACSpace(VectorH1(mesh, order=2), slave="bottom", macros=macros)


def test_macros_that_are_unstable(mesh):
    """P1 with one face per multiplier: the classical failure is refused."""
    with raises(rf"1 face\(s\) of boundary 'bottom'.*unstable.*{REMEDY}"):
        LACSpace(VectorH1(mesh, order=1), slave="bottom", macros=range(6))
    assert LACSpace(VectorH1(mesh, order=2), slave="bottom", macros=range(6)).nmacros == 6


def test_macros_do_not_survive_refinement(mesh):
    V = VectorH1(mesh, order=2)
    Q = LACSpace(V, slave="bottom", macros=[0, 0, 1, 1, 2, 2])
    assert Q.nmacros == 3
    with raises("does not fit the refined mesh; make a new space"):
        mesh.Refine()
        V.Update()
        Q.Update()


@pytest.mark.parametrize("components", [0, -1])
def test_components(mesh, components):
    with raises("components"):
        LACSpace(VectorH1(mesh, order=2), slave="bottom", components=components)


def test_core_dofs_of_a_macro_that_does_not_exist(mesh):
    Q = LACSpace(VectorH1(mesh, order=2), slave="bottom")
    with raises("there is no macro-element 6", IndexError):
        Q.CoreDofs(6)


def test_arguments(mesh):
    V = VectorH1(mesh, order=2)
    with pytest.raises(TypeError):
        LACSpace(V)
    with pytest.raises(TypeError):
        LACSpace(V, "bottom")
    with pytest.raises(TypeError):
        LACSpace(V, slave=3)
