"""Macro-elements stay small, whole and flat: leftovers, partitions by hand, what Check() says."""

from functools import partial

import numpy as np
import pytest
from bricks import RIM, ball, brick, flipped, middle, slave_faces
from netgen.occ import Box, Circle, Compound, MoveTo, OCCGeometry, Y, Z
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, Mesh, Sym, VectorH1, dx
from partitions import SPACES, check_partition, cores, faces_of_macros, sizes
from press import press, solved

from ngslac import ContactSolver, LACContact, LACSpace


def overhanging(h=0.1):
    """A block of length 2 on a wider one; the second half of its lower side is clamped."""
    upper = MoveTo(0, 0).LineTo(1, 0, "free").LineTo(2, 0, "clamped").LineTo(2, 1)
    upper = upper.LineTo(0, 1, "top").LineTo(0, 0).Face()
    lower = MoveTo(-0.5, -1).Rectangle(3, 1).Face()
    lower.edges.Max(Y).name, lower.edges.Min(Y).name = "master", "bottom"
    lower.edges.Max(Y).maxh = 0.8 * h
    return Mesh(OCCGeometry(Compound([upper, lower]), dim=2).GenerateMesh(maxh=h))


@pytest.mark.parametrize("order", [1, 2, 3])
def test_half_of_a_slave_clamped(order):
    mesh = overhanging()
    V = VectorH1(mesh, order=order, dirichlet="bottom|clamped")
    many = sizes(LACSpace(V, slave="free|clamped"))
    assert sum(many) == len(slave_faces(mesh, "free|clamped"))
    assert many[-1] <= 4 * np.median(many)


@pytest.mark.parametrize("kind", ["tet", "hex"])
@pytest.mark.parametrize("space", ["VectorH1", "Bubble"])
def test_half_of_a_slave_clamped_in_3d(space, kind):
    """Clamped are the vertices beyond the middle: boundaries of the mesh need not show it."""
    mesh = brick(kind, 6, 1)
    V = SPACES[space](mesh, order=2)
    for el in slave_faces(mesh):
        if min(mesh[v].point[0] for v in el.vertices) > 0.4:
            for dof in V.GetDofNrs(el):
                V.FreeDofs().Clear(dof)
    assert sizes(LACSpace(V, slave="bottom"))[-1] <= 7


@pytest.mark.parametrize("kind", ["tet", "hex", "prism"])
@pytest.mark.parametrize("n", [3, 4, 5, 7])
def test_faces_join_macro_elements_that_move_as_they_do(kind, n):
    """Beyond x = 1/2 nothing moves along x: where a face does, its macro-element does."""
    mesh = brick(kind, n, 1)
    V = VectorH1(mesh, order=1, dirichlet="top")
    for v in mesh.vertices:
        if v.point[0] > 0.5:
            V.FreeDofs().Clear(v.nr)
    X = V * LACSpace(V, slave="bottom")
    check_partition(X.components[1])
    moves = {v.nr for v in mesh.vertices if v.point[0] <= 0.5}
    for own, core in zip(faces_of_macros(X.components[1]), cores(X.components[1]), strict=True):
        faces = [el for el in slave_faces(mesh) if el.nr in own]
        if moves & {v.nr for el in faces for v in el.vertices}:
            assert any(dof < mesh.nv for dof in core)


@pytest.mark.parametrize("h", [0.3, 0.35, 0.25, 0.2])
def test_corners_and_edges_join_a_neighbour(h):
    """Faces at corners hold no vertex that is free, and are more than a layer away from one."""
    box = Box((0, 0, 0), (1, 1, 1))
    box.faces.name, box.faces.Max(Z).name = "free", "slave"
    mesh = Mesh(OCCGeometry(box).GenerateMesh(maxh=h))
    check_partition(LACSpace(VectorH1(mesh, order=1, dirichlet="free"), slave="slave"), "slave")


def test_clamped_part_of_a_slave_presses():
    """The clamped half is a rigid punch: it holds off the master, and Check() names it."""
    mesh = overhanging(0.2)
    V = VectorH1(mesh, order=2, dirichlet="bottom|clamped")
    X = V * LACSpace(V, slave="free|clamped")
    (u, lam), (v, _) = X.TnT()
    a = BilinearForm(X)
    a += InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx
    gf, contact = GridFunction(X), LACContact(u, lam, master="master")
    gf.components[0].Set((0, -0.01), definedon=mesh.Boundaries("clamped"))
    ContactSolver(a, gf, contact).Solve(printing=False)
    table = contact.Table()
    clamped = table["x"][:, 0] > 1.3
    assert np.all(table["pressure"][clamped] > 0)
    # What is carried elastically goes in by a hundredth of what the surface gives.
    assert np.all(table["gap"][clamped] < 0)
    assert np.all(table["gap"][clamped] > -3e-4)
    report = contact.Check()
    assert set(report.prescribed) == set(np.flatnonzero(contact.form.Table()["prescribed"]))
    assert len(report.prescribed) >= 2
    assert "prescribed       " in str(report)


@pytest.mark.parametrize(("kind", "faces"), [("hex", 1), ("tet", 2)])
def test_a_clamped_surface_of_one_square(kind, faces):
    """Order 2 has the dof inside or of the diagonal, and no more."""
    mesh = brick(kind, 1, 1)
    for V, number in (
        (VectorH1(mesh, order=2, dirichlet=RIM), 1),
        (SPACES["Bubble"](mesh, order=1, dirichlet=RIM), faces),
    ):
        Q = LACSpace(V, slave="bottom")
        check_partition(Q)
        assert [len(core) for core in cores(Q)] == [3] * number


@pytest.mark.parametrize("kind", ["trig", "hex"])
def test_given_macro_elements(kind):
    mesh = brick(kind, 4, 1)
    faces = slave_faces(mesh)
    quarters = [middle(mesh, el)[:-1] > 0.5 for el in faces]
    given = np.array([sum(2**i * int(far) for i, far in enumerate(q)) for q in quarters])
    for macros in (given.tolist(), tuple(given), given, given.astype(np.uint8)):
        Q = LACSpace(VectorH1(mesh, order=1), slave="bottom", macros=macros)
        check_partition(Q)
        assert [Q.macros[el.nr] for el in faces] == given.tolist()


@pytest.mark.parametrize(
    ("macros", "error", "text"),
    [
        ([2**31 - 1] * 6, ValueError, "macros holds the number 2147483647, but 6 slave faces"),
        ([2**70] * 6, ValueError, "macros.*out of range|macros holds"),
        ([0.5] * 6, TypeError, "macros.*0.5"),
        ([float("nan")] * 6, TypeError, "macros.*nan"),
        (["a"] * 6, TypeError, "macros.*'a'"),
        ("000000", TypeError, "macros.*'000000'"),
        (7, TypeError, "macros = 7"),
        ([0, 0, 1, 1, 0, 0], ValueError, "macro-element 0 of 4 faces that do not hang together"),
    ],
)
def test_macros_that_are_none(macros, error, text):
    with pytest.raises(error, match=text):
        LACSpace(VectorH1(brick("trig", 6), order=2), slave="bottom", macros=macros)


@pytest.mark.parametrize("parts", [1, 2, 3])
def test_macros_that_bend(parts):
    """Arcs of 120 degrees and more have no normal that stands for them."""
    mesh = ball(2, 0.4, order=1)
    points = [middle(mesh, el) for el in slave_faces(mesh, "surface")]
    macros = (np.arctan2(*np.transpose(points)[::-1]) + np.pi) * parts // (2 * np.pi)
    with pytest.raises(ValueError, match=r"faces that bend by more than 60 degrees"):
        LACSpace(VectorH1(mesh, order=2), slave="surface", macros=macros.astype(int).tolist())


@pytest.mark.parametrize("order", [1, 2, 3])
def test_points_that_are_no_numbers(order):
    """Nothing is made of a surface with a lost vertex."""
    mesh = brick("tet", 2, 1, mapping=lambda p: np.where(p[:, [0]] == 0.5, np.nan, p))
    with pytest.raises(Exception, match="boundary 'bottom'"):
        LACSpace(VectorH1(mesh, order=order), slave="bottom")


def test_check_names_large_and_bent_macro_elements():
    disk = Circle((0, 0), 1).Face()
    disk.edges.name = "rim"
    ring = Circle((0, 0), 2).Face() - Circle((0, 0), 1).Face()
    ring.edges.name = "ring"
    mesh = Mesh(OCCGeometry(Compound([disk, ring]), dim=2).GenerateMesh(maxh=0.1))
    n = len(slave_faces(mesh, "rim"))
    macros = [0] * (n // 7) + list(range(1, n - n // 7 + 1))
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="rim", macros=macros)
    (u, lam), _ = X.TnT()
    report = LACContact(u, lam, master="ring").Check()
    assert report.large.tolist() == [0]
    assert "of many faces    1 macro-elements: 0 at" in str(report)
    assert not len(report.undefined)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("kind", ["quad", "hex", "tet"])
def test_same_contact_of_backward_boundary_elements(kind, finite):
    """The quadrature may start at another corner: equal up to rounding."""
    flags = (
        {"dim": 2, "h": 0.2} if kind == "quad" else {"dim": 3, "kinds": (kind, kind), "n": (4, 3)}
    )

    def Outcome(every):
        change = partial(flipped, every=every)
        problem = press(order=1, friction=0.3, finite=finite, change=change, **flags)
        solved(problem)
        return problem.contact.Table(), problem.gf.components[0].vec.FV().NumPy()

    (one, u), (other, w) = map(Outcome, (0, 2))
    assert np.sum(one["status"] > 0) > 1
    assert np.abs(u - w).max() < 1e-9 * np.abs(u).max()
    for name in ("normal", "gap", "traction", "area"):
        size = np.abs(one[name]).max() if name == "traction" else 1
        np.testing.assert_allclose(other[name], one[name], rtol=0, atol=1e-9 * size, err_msg=name)
