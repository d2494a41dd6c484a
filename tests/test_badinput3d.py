"""Wrong input in 3D: errors that say what is wrong, where, and what to do."""

import math

import pytest
from netgen.occ import Box, Glue, OCCGeometry, Z
from netgen.occ import Pnt as Point
from ngsolve import (
    CF,
    H1,
    GridFunction,
    Mesh,
    Parameter,
    TaskManager,
    VectorH1,
    VectorL2,
    VectorValued,
    sqrt,
    x,
)

from ngslac import BubbleVectorH1, LACContact, LACSpace, SplitSlaveFaces
from ngslac.meshes.blocks3d import TwoBlocks3D

NAMES = "left_upper.*master|master.*left_upper"  # messages about patterns list the boundaries
REMEDY = r"Remedy: SplitSlaveFaces\(mesh, slave\), BubbleVectorH1\(mesh, slave=...\)"


@pytest.fixture(scope="module")
def mesh():
    return TwoBlocks3D("hex", "tet", 3, 2)


@pytest.fixture(scope="module")
def X(mesh):
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    return V * LACSpace(V, slave="slave")


def contact(X, **flags):
    u, lam = X.TrialFunction()
    return LACContact(u, lam, **({"master": "master"} | flags))


def contact_on(mesh, order=2, slave="slave", **flags):
    V = VectorH1(mesh, order=order)
    return contact(V * LACSpace(V, slave=slave), **flags)


def raises(text, kind=Exception):
    return pytest.raises(kind, match=text)


# --- regions -----------------------------------------------------------------------------------


@pytest.mark.parametrize("slave", ["nowhere", "", "Slave"])
def test_slave_pattern_without_faces_in_3d(mesh, slave):
    V = VectorH1(mesh, order=2)
    with raises(f"slave='{slave}' matches no boundary face; the boundaries are: .*({NAMES})"):
        LACSpace(V, slave=slave)


def test_master_without_faces_in_3d(X, mesh):
    with raises(f"master='nowhere' matches no boundary face.*({NAMES})", ValueError):
        contact(X, master="nowhere")
    for wrong in (mesh.Materials("lower"), 3):
        with raises("master = .* must be a pattern of boundary names", TypeError):
            contact(X, master=wrong)
    with raises("must be a boundary region"):
        LACSpace(X.components[0], slave=mesh.Materials("upper"))


def test_edges_are_no_surface(mesh):
    """A region of edges (BBND) is neither a slave nor a master."""
    edges = mesh.BBoundaries(".*")
    V = VectorH1(mesh, order=2)
    with raises("must be a boundary region"):
        LACSpace(V, slave=edges)
    with raises("boundary region", TypeError):
        contact_on(mesh, master=edges)


def test_slave_is_also_master_in_3d(X):
    with raises("boundaries slave are both slave and master", ValueError):
        contact(X, master="slave|master")


def test_glued_bodies_in_3d():
    """Bodies that share nodes have no surfaces that could separate."""
    lower, upper = Box(Point(0, 0, -1), Point(1, 1, 0)), Box(Point(0, 0, 0), Point(1, 1, 1))
    lower.faces.name = upper.faces.name = "outside"
    upper.faces.Min(Z).name = lower.faces.Max(Z).name = "interface"
    mesh = Mesh(OCCGeometry(Glue([lower, upper])).GenerateMesh(maxh=0.6))
    with raises("'interface' has material on both sides.*share no nodes"):
        contact_on(mesh, slave="interface", master="outside").Update()


def test_bodies_that_never_meet(X):
    with raises("slave and master never meet.*regions.*maxdist"):
        contact(X, master="bottom", maxdist=0.1).Update()
    for master in ("left_lower", "left_upper"):  # at right angles
        with raises("never meet"):
            contact(X, master=master, maxdist=0.1).Update()


def test_maxdist_below_the_gap_in_3d(X, mesh):
    gf = GridFunction(X)
    gf.components[0].Set(mesh.MaterialCF({"upper": CF((0, 0, 0.2)), "lower": CF((0, 0, 0))}))
    contact(X, maxdist=0.21).Update(gf)
    with raises("never meet: .*within maxdist = 0.19"):
        contact(X, maxdist=0.19).Update(gf)


def test_two_meshes_in_3d(X):
    other = TwoBlocks3D("hex", "tet", 3, 2)
    with raises("another mesh"):
        contact(X, master=other.Boundaries("master")).Update()
    with raises("another mesh"):
        LACSpace(X.components[0], slave=other.Boundaries("slave"))


# --- spaces ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("space", "text"),
    [
        (lambda m: H1(m, order=2), "has 1 component.*give a vector-valued space such as VectorH1"),
        (lambda m: H1(m, order=2, dim=2), "has 2 component.*in 3D"),
        (lambda m: VectorValued(H1(m, order=2), 2), "has 2 component.*in 3D"),
        (lambda m: VectorH1(m, order=2, complex=True), "is complex; contact needs real"),
        (lambda m: VectorL2(m, order=2), "boundary|no macro-element"),
    ],
)
def test_spaces_that_are_no_displacements_in_3d(mesh, space, text):
    with raises(text):
        LACSpace(space(mesh), slave="slave")


@pytest.mark.parametrize("components", [1, 2])
def test_multiplier_with_too_few_components(mesh, components):
    V = VectorH1(mesh, order=2)
    u, lam = (V * LACSpace(V, slave="slave", components=components)).TrialFunction()
    with raises("need 3 components each"):
        LACContact(u, lam, master="master")


def test_linear_displacements_with_one_face_per_multiplier(mesh):
    """P1 and Q1 with one face each, and P2 triangles: refused with the remedies."""
    V = VectorH1(mesh, order=1)
    with raises(rf"1 face\(s\) of boundary 'slave'.*unstable.*{REMEDY}"):
        LACSpace(V, slave="slave", macros=range(9))
    triangles = TwoBlocks3D("tet", "hex", 3, 2)
    with raises(rf"1 face\(s\) of boundary 'slave'.*unstable.*{REMEDY}"):
        LACSpace(VectorH1(triangles, order=2), slave="slave", macros=range(18))
    assert LACSpace(VectorH1(mesh, order=2), slave="slave", macros=range(9)).nmacros == 9
    assert LACSpace(VectorH1(triangles, order=3), slave="slave", macros=range(18)).nmacros == 18


@pytest.mark.parametrize("kind", ["tet", "hex", "prism"])
def test_too_few_faces_for_a_stable_partition_in_3d(kind):
    mesh = TwoBlocks3D(kind, "hex", 1, 2)
    faces = 1 if kind == "hex" else 2
    text = rf"no macro-element can be made of {faces} face\(s\) of boundary 'slave'.*{REMEDY}"
    with raises(text):
        LACSpace(VectorH1(mesh, order=1), slave="slave")
    bubble = BubbleVectorH1(mesh, order=1, slave="slave")
    assert LACSpace(bubble, slave="slave").nmacros == faces
    assert LACSpace(VectorH1(SplitSlaveFaces(mesh, "slave"), order=1), slave="slave").nmacros > 0


def test_clamped_slave_in_3d(mesh):
    for flags in ({"dirichlet": "slave"}, {"dirichletz": "slave"}):
        with raises(r"of boundary 'slave'.*no Dirichlet condition on the slave faces"):
            LACSpace(VectorH1(mesh, order=2, **flags), slave="slave")


# --- coefficients and states -------------------------------------------------------------------


@pytest.mark.parametrize("name", ["friction", "tresca"])
@pytest.mark.parametrize("value", [-0.1, float("nan"), float("inf")])
def test_wrong_numbers_in_3d(X, name, value):
    with raises(f"{name} = {value} must be a finite number >= 0", ValueError):
        contact(X, **{name: value})


@pytest.mark.parametrize("threads", [False, True])
@pytest.mark.parametrize(
    ("value", "text"),
    [(0.5 - x, "-0"), (sqrt(x - 0.5), "nan"), (Parameter(-0.1), "-0.1")],
)
def test_wrong_functions_in_3d(X, value, text, threads):
    """Found where they are wrong: position (three coordinates) and boundary are named."""
    number = r"[^,)]+"
    expected = rf"friction is -?{text}.* at \({number}, {number}, {number}\) on boundary 'slave'"
    with raises(expected):
        if threads:
            with TaskManager():
                contact(X, friction=value).Update()
        else:
            contact(X, friction=value).Update()


def test_obstacle_with_nan_in_3d(X):
    with raises("gap to the obstacle is -?nan at \\("):
        contact(X, master=None, obstacle=sqrt(x - 0.5)).Update()


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_configuration_that_is_not_finite(X, value):
    gf = GridFunction(X)
    gf.components[0].vec.FV().NumPy()[:] = value
    with raises("the configuration to pair in holds NaN or infinite coordinates"):
        contact(X).Update(gf)


def test_use_before_the_pairing_in_3d(X):
    gf = GridFunction(X)
    vec = gf.vec.CreateVector()
    for use in (
        lambda c: c.Apply(gf.vec, vec),
        lambda c: c.AssembleLinearization(gf.vec),
        lambda c: c.Evaluate(gf),
        lambda c: c.Commit(gf),
        lambda c: c.Table(),
        lambda c: c.Force(),
        lambda c: c.Moment((0, 0, 0)),
    ):
        with raises(r"no pairing yet; call Update\(\) first"):
            use(contact(X))
