"""LACSpace in three dimensions as an NGSolve space, and what it refuses."""

import pickle

import numpy as np
import pytest
from ngsolve import (
    BND,
    CF,
    H1,
    BilinearForm,
    GridFunction,
    InnerProduct,
    Integrate,
    LinearForm,
    VectorH1,
    VTKOutput,
    ds,
    specialcf,
    x,
)
from ngsolve.webgui import Draw
from spaces3d import (
    KINDS,
    RIM,
    SPACES,
    ball,
    brick,
    check_partition,
    faces_of_macros,
    mixed,
    sizes,
    slave_faces,
    tetrahedra,
)

from ngslac import BubbleVectorH1, LACSpace

REMEDY = r"Remedy: SplitSlaveFaces\(mesh, slave\), BubbleVectorH1\(mesh, slave=...\)"
RULES = 1e-9  # two quadrature rules of order 10 on a curved surface


@pytest.mark.parametrize("make", [lambda: brick(4, "tet", 1), mixed, lambda: ball(1.5)])
@pytest.mark.parametrize("order", [1, 2])
def test_area_and_mean_values(make, order):
    """The mass matrix holds the areas; a form with a displacement gives its mean values."""
    mesh, slave = make(), "bottom|surface"
    Q = LACSpace(VectorH1(mesh, order=order), slave=slave)
    one = Q.WithComponents(1)
    assert one.ndof == one.nmacros == Q.nmacros
    area = np.array(Integrate(CF(1), mesh, BND, element_wise=True, order=10))
    expected = [area[own].sum() for own in faces_of_macros(Q)]
    lam, mu = one.TnT()
    mass = BilinearForm(lam * mu * ds(slave, bonus_intorder=10), check_unused=False).Assemble().mat
    values = GridFunction(one)
    values.vec.FV().NumPy()[:] = 1
    product = (mass * values.vec).Evaluate().FV().NumPy()
    assert product == pytest.approx(expected, rel=RULES)
    u = GridFunction(Q.displacement)
    u.Set(CF((x, 1, 2)))
    nu = Q.TestFunction()
    means = (
        LinearForm(InnerProduct(u, nu) * ds(slave, bonus_intorder=10)).Assemble().vec.FV().NumPy()
    )
    assert means[1::3] == pytest.approx(expected, rel=RULES)
    assert means[2::3] == pytest.approx(2 * np.array(expected), rel=RULES)
    first = np.array(Integrate(u[0], mesh, BND, element_wise=True, order=10))
    assert means[::3] == pytest.approx([first[own].sum() for own in faces_of_macros(Q)], abs=RULES)


def test_functions_are_constant_on_macro_elements_and_drawn(tmp_path):
    mesh = brick(4, "hex", 1)
    Q = LACSpace(VectorH1(mesh, order=1), slave="bottom")
    gf = GridFunction(Q)
    gf.vec.FV().NumPy()[:] = np.arange(12)
    for macro, own in enumerate(faces_of_macros(Q)):
        for el in slave_faces(mesh):
            if el.nr in own:
                middle = np.mean([mesh[v].point for v in el.vertices], axis=0)
                value = gf(mesh(*middle[:2], 0, BND))
                assert value == pytest.approx([3 * macro, 3 * macro + 1, 3 * macro + 2])
    normal = specialcf.normal(3)
    assert Integrate(InnerProduct(gf, gf), mesh.Boundaries(f"{RIM}|top"), BND) == 0
    Draw(-gf * normal, mesh.Boundaries("bottom"), "pressure", filename=str(tmp_path / "p.html"))
    assert (tmp_path / "p.html").stat().st_size > 1000
    VTKOutput(mesh, [gf], ["traction"], filename=str(tmp_path / "t")).Do(vb=BND)
    assert (tmp_path / "t.vtu").stat().st_size > 1000


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("space", SPACES)
def test_pickle(space, kind):
    V = SPACES[space](brick(3, kind, 1), order=1)
    gf = GridFunction(LACSpace(V, slave="bottom"))
    gf.vec.FV().NumPy()[:] = np.arange(len(gf.vec.FV().NumPy()))
    again = pickle.loads(pickle.dumps(gf))
    Q = again.space
    assert type(Q) is LACSpace
    check_partition(Q)
    assert list(Q.macros) == list(gf.space.macros)
    assert [list(Q.CoreDofs(m)) for m in range(Q.nmacros)] == [
        list(gf.space.CoreDofs(m)) for m in range(Q.nmacros)
    ]
    assert np.array_equal(again.vec.FV().NumPy(), gf.vec.FV().NumPy())


@pytest.mark.parametrize("space", ["VectorH1", "H1(dim=3)", "Bubble"])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_refinement(order, space):
    """A refined mesh gets macro-elements of its own, in the space and in a product."""
    mesh = tetrahedra(0.4)
    V = SPACES[space](mesh, order=order, autoupdate=True)
    X = V * LACSpace(V, slave="bottom")
    n, gf = len(slave_faces(mesh)), GridFunction(X, autoupdate=True)
    mesh.Refine()
    X.Update()
    gf.Update()
    Q = X.components[1]
    check_partition(Q)
    assert len(slave_faces(mesh)) > n
    assert (sizes(Q) == [1] * len(slave_faces(mesh))) == (order == 3 or space == "Bubble")
    assert len(gf.vec) == X.ndof == X.components[0].ndof + Q.ndof


def test_a_single_quadrilateral():
    """One clamped face has no vertex inside: refused, unless it has a dof of its own."""
    mesh = brick(1, "hex", 1)
    with pytest.raises(Exception, match=rf"of 1 face\(s\) of boundary 'bottom'.*0\.5.*{REMEDY}"):
        LACSpace(VectorH1(mesh, order=1, dirichlet=RIM), slave="bottom")
    for V in (VectorH1(mesh, order=2, dirichlet=RIM), SPACES["Bubble"](mesh, dirichlet=RIM)):
        Q = LACSpace(V, slave="bottom")
        check_partition(Q)
        assert Q.nmacros == 1


def test_two_triangles():
    """Order 2 has the dof of the diagonal, and no more; order 1 has nothing."""
    mesh = brick(1, "tet", 1)
    with pytest.raises(Exception, match=rf"of 2 face\(s\) of boundary 'bottom'.*{REMEDY}"):
        LACSpace(VectorH1(mesh, order=1), slave="bottom")
    Q = LACSpace(VectorH1(mesh, order=2, dirichlet=RIM), slave="bottom")
    check_partition(Q)
    assert Q.nmacros == 1
    assert len(Q.CoreDofs(0)) == 3
    assert LACSpace(SPACES["Bubble"](mesh, order=1, dirichlet=RIM), slave="bottom").nmacros == 2


@pytest.mark.parametrize("flags", [{"dirichlet": "bottom"}, {"dirichletz": "bottom"}])
@pytest.mark.parametrize("kind", KINDS)
def test_clamped_slave(kind, flags):
    V = BubbleVectorH1(brick(2, kind, 1), order=1, slave="bottom", **flags)
    with pytest.raises(Exception, match="no Dirichlet condition on the slave faces"):
        LACSpace(V, slave="bottom")


@pytest.mark.parametrize(
    ("kind", "order", "per_face"),
    [
        ("tet", 1, False), ("tet", 2, False), ("tet", 3, True), ("hex", 1, False), ("hex", 2, True),
        ("prism", 2, False), ("prism_side", 2, True), ("pyramid", 1, False), ("pyramid", 2, True),
    ],
)  # fmt: skip
def test_one_macro_element_per_face_only_where_that_is_stable(kind, order, per_face):
    """The classical failures are refused: order 1, and order 2 on triangles."""
    mesh = brick(2, kind, 1)
    numbers = list(range(len(slave_faces(mesh))))
    for V in (VectorH1(mesh, order=order), SPACES["Bubble"](mesh, order=order)):
        if per_face or isinstance(V, BubbleVectorH1):
            assert LACSpace(V, slave="bottom", macros=numbers).nmacros == len(numbers)
        else:
            with pytest.raises(Exception, match=rf"1 face\(s\) of boundary 'bottom'.*{REMEDY}"):
                LACSpace(V, slave="bottom", macros=numbers)


def test_pairs_of_order_one_are_refused():
    """Two triangles hold no vertex inside, whatever their number on the surface."""
    mesh = brick(4, "tet", 1)
    pairs = np.arange(len(slave_faces(mesh))) // 2
    with pytest.raises(Exception, match=r"2 face\(s\) of boundary 'bottom'"):
        LACSpace(VectorH1(mesh, order=1), slave="bottom", macros=pairs)


def test_given_macro_elements():
    mesh = brick(4, "hex", 1)
    faces = slave_faces(mesh)
    middle = [np.mean([mesh[v].point for v in el.vertices], axis=0) for el in faces]
    given = [2 * int(p[0] > 0.5) + int(p[1] > 0.5) for p in middle]
    Q = LACSpace(VectorH1(mesh, order=1), slave="bottom", macros=given)
    check_partition(Q)
    assert [Q.macros[el.nr] for el in faces] == given
    for wrong, text in (
        (given[1:], "macros has 15 entries, but there are 16 slave faces"),
        ([-1, *given[1:]], "negative number -1"),
        ([m + (m == 3) for m in given], "macro-element 3 has no face"),
    ):
        with pytest.raises(Exception, match=text):
            LACSpace(VectorH1(mesh, order=1), slave="bottom", macros=wrong)
    for wrong in ([float("nan")] * 16, [0.5] * 16, "0" * 16):
        with pytest.raises(TypeError):
            LACSpace(VectorH1(mesh, order=2), slave="bottom", macros=wrong)


@pytest.mark.parametrize(
    ("space", "text"),
    [
        (lambda m: H1(m, order=2), "has 1 component.*3D; give a vector-valued space"),
        (lambda m: H1(m, order=2, dim=2), "has 2 component.*3D"),
        (lambda m: VectorH1(m, order=2, complex=True), "is complex; contact needs real"),
    ],
)
def test_spaces_that_are_no_displacements(space, text):
    with pytest.raises(Exception, match=text):
        LACSpace(space(brick(2, "hex", 1)), slave="bottom")


@pytest.mark.parametrize("order", [1, 2, 3])
def test_points_that_are_no_numbers(order):
    """Nothing is made of a surface with a lost vertex."""
    mesh = brick(2, "tet", 1, mapping=lambda p: np.where(p[:, [0]] == 0.5, np.nan, p))
    with pytest.raises(Exception, match="boundary 'bottom'"):
        LACSpace(VectorH1(mesh, order=order), slave="bottom")
