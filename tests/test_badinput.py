"""Wrong input to LACSpace, LACContact and the mesh tools: errors that say what and where."""

import numpy as np
import pytest
from netgen.occ import Glue, MoveTo, OCCGeometry, Rectangle
from ngsolve import (
    CF,
    H1,
    GridFunction,
    Mesh,
    Parameter,
    TaskManager,
    VectorH1,
    sqrt,
    x,
)

from ngslac import LACContact, LACSpace, SplitSlaveFaces
from ngslac.meshes import TwoBlocks

NAMES = "top"  # one of the boundaries, which the messages about patterns list


@pytest.fixture(scope="module")
def mesh():
    return TwoBlocks(0.34, structured=True)


@pytest.fixture(scope="module")
def X(mesh):
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    return V * LACSpace(V, slave="slave")


def contact(X, **flags):
    u, lam = X.TrialFunction()
    return LACContact(u, lam, **({"master": "master"} | flags))


def raises(text, kind=Exception):
    return pytest.raises(kind, match=text)


# --- regions -----------------------------------------------------------------------------------


@pytest.mark.parametrize("slave", ["nowhere", "", "Slave"])
def test_slave_pattern_without_faces(mesh, slave):
    V = VectorH1(mesh, order=2)
    with raises(f"slave='{slave}' matches no boundary face; the boundaries are: .*{NAMES}"):
        LACSpace(V, slave=slave)


def test_slave_region_without_faces(mesh):
    V = VectorH1(mesh, order=2)
    with raises("slave=Region matches no boundary face"):
        LACSpace(V, slave=mesh.Boundaries("nowhere"))
    with raises("must be a boundary region"):
        LACSpace(V, slave=mesh.Materials("upper"))


def test_master_without_faces(X, mesh):
    with raises(f"master='nowhere' matches no boundary face.*{NAMES}", ValueError):
        contact(X, master="nowhere")
    with raises("matches no boundary face", ValueError):
        contact(X, master=mesh.Boundaries("nowhere"))
    for wrong in (mesh.Materials("lower"), 3):
        with raises("master = .* must be a pattern of boundary names", TypeError):
            contact(X, master=wrong)


def test_split_without_faces(mesh):
    words = f"slave='nowhere' matches no boundary face; the boundaries are: .*{NAMES}"
    with raises(words, ValueError):
        SplitSlaveFaces(mesh, "nowhere")


def test_slave_is_also_master(X):
    with raises("boundaries slave are both slave and master", ValueError):
        contact(X, master="slave|master")


def test_glued_bodies():
    """Bodies that share nodes have no surfaces that could separate."""
    lower, upper = MoveTo(0, -1).Rectangle(1, 1).Face(), Rectangle(1, 1).Face()
    upper.edges.Min(MoveTo(0, 0).Rectangle(1, 1).Face().edges[0].center - (0, 9, 0))
    shape = Glue([lower, upper])
    for edge in shape.edges:
        edge.name = "interface" if abs(edge.center.y) < 1e-9 else "outside"
    mesh = Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.4))
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="interface")
    with raises("'interface' has material on both sides.*share no nodes"):
        contact(X, master="outside").Update()


def test_each_body_with_a_space_of_its_own():
    """The master would count as a body at rest, and nothing would tell."""
    mesh = TwoBlocks(0.5)
    upper = VectorH1(mesh, order=2, definedon="upper")
    lower = VectorH1(mesh, order=2, definedon="lower", dirichlet="bottom")
    for X in (
        upper * lower * LACSpace(upper, slave="slave"),
        (upper * lower) * LACSpace(upper, slave="slave"),
    ):
        trials = X.TrialFunction()
        u = trials[0][0] if isinstance(trials[0], (list, tuple)) else trials[0]
        with pytest.raises(ValueError, match="master = 'master' has no degrees of freedom of u"):
            LACContact(u, trials[-1], master="master")


@pytest.mark.parametrize("finite", [False, True])
def test_a_master_without_unknowns_is_a_rigid_body(finite):
    mesh = TwoBlocks(0.5)
    V = VectorH1(mesh, order=2, definedon="upper")
    X = V * H1(mesh) * LACSpace(V, slave="slave")  # a temperature is no displacement
    u, _, lam = X.TrialFunction()
    LACContact(u, lam, master="master", finite=finite).Update()


def test_surfaces_that_never_meet(X, mesh):
    with raises("slave and master never meet.*maxdist"):
        contact(X, master="bottom", maxdist=0.1).Update()
    with raises("never meet"):  # they look the same way
        contact(X, master="left_lower").Update()


def test_maxdist_below_the_gap():
    mesh = TwoBlocks(0.34, structured=True)
    V = VectorH1(mesh, order=2)
    X = V * LACSpace(V, slave="slave")
    gf = GridFunction(X)
    gf.components[0].Set(mesh.MaterialCF({"upper": CF((0, 0.2)), "lower": CF((0, 0))}))
    contact(X, maxdist=0.21).Update(gf)
    with raises("never meet: .*within maxdist = 0.19"):
        contact(X, maxdist=0.19).Update(gf)


def test_two_meshes(X):
    other = TwoBlocks(0.34, structured=True)
    with raises("another mesh"):
        contact(X, master=other.Boundaries("master")).Update()
    with raises("another mesh"):
        LACSpace(X.components[0], slave=other.Boundaries("slave"))


# --- coefficients ------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["friction", "tresca"])
@pytest.mark.parametrize("value", [-0.1, float("nan"), float("inf")])
def test_wrong_numbers(X, name, value):
    with raises(f"{name} = {value} must be a finite number >= 0", ValueError):
        contact(X, **{name: value})


@pytest.mark.parametrize("threads", [False, True])
@pytest.mark.parametrize(
    ("value", "text"),
    [(0.5 - x, "-0"), (sqrt(x - 0.5), "nan"), (Parameter(-0.1), "-0.1")],
)
def test_wrong_functions(X, value, text, threads):
    """Found where they are wrong: position and boundary are named."""
    expected = rf"friction is -?{text}.* at \(.*\) on boundary 'slave'; it must be a number >= 0"
    with raises(expected):
        if threads:
            with TaskManager():
                contact(X, friction=value).Update()
        else:
            contact(X, friction=value).Update()


def test_a_parameter_that_becomes_negative(X):
    parameter = Parameter(0.3)
    c = contact(X, friction=parameter)
    c.Update()
    c.form.SetConstant(1.0)
    gf = GridFunction(X)
    residual = gf.vec.CreateVector()
    c.Apply(gf.vec, residual)
    parameter.Set(-0.3)
    with raises("friction is -0.3"):
        c.Apply(gf.vec, residual)


def test_obstacle_with_nan(X):
    with raises("gap to the obstacle is -?nan at \\("):
        contact(X, master=None, obstacle=sqrt(x - 0.5)).Update()


@pytest.mark.parametrize("name", ["maxdist", "penetration"])
@pytest.mark.parametrize("value", [0, -1.0, float("nan"), float("inf")])
def test_wrong_lengths(X, name, value):
    with raises(f"{name} = {value} must be a positive length", ValueError):
        contact(X, **{name: value})


@pytest.mark.parametrize("value", [0, -1.0, float("nan")])
def test_wrong_stiffness(X, value):
    with raises(f"stiffness = {value} must be a positive factor", ValueError):
        contact(X, stiffness=value)


def test_contradictions(X):
    with raises("either master= or obstacle=, not both and not none", ValueError):
        contact(X, obstacle=CF(0.1))
    with raises("either master= or obstacle=, not both and not none", ValueError):
        contact(X, master=None)
    for law in ("friction", "tresca"):
        with raises("tied surfaces do not slide: drop friction and tresca", ValueError):
            contact(X, tied=True, **{law: 0.3})


# --- fields ------------------------------------------------------------------------------------


def test_multiplier_of_another_space(mesh):
    V = VectorH1(mesh, order=2)
    u, lam = (V * VectorH1(mesh, order=1)).TrialFunction()
    with raises("lam must belong to a LACSpace, not to VectorH1"):
        LACContact(u, lam, master="master")


def test_multiplier_with_one_component(mesh):
    V = VectorH1(mesh, order=2)
    u, lam = (V * LACSpace(V, slave="slave", components=1)).TrialFunction()
    with raises("need 2 components each"):
        LACContact(u, lam, master="master")


def test_functions_that_are_no_trial_functions(X):
    (u, lam), (v, mu) = X.TnT()
    with raises("u .*must be a trial function"):
        LACContact(v, lam, master="master")
    with raises("lam .*must be a trial function"):
        LACContact(u, mu, master="master")
    with raises("trial function"):
        LACContact(2 * u, lam, master="master")
    with raises("trial function"):
        LACContact(GridFunction(X).components[0], lam, master="master")


def test_functions_of_different_products(mesh, X):
    V = VectorH1(mesh, order=2)
    other = V * LACSpace(V, slave="slave")
    with raises("u and lam belong to different product spaces"):
        LACContact(X.TrialFunction()[0], other.TrialFunction()[1], master="master")
    with raises("u and lam belong to different product spaces"):
        LACContact(V.TrialFunction(), X.TrialFunction()[1], master="master")


def test_use_before_the_pairing(X):
    u, lam = X.TrialFunction()
    gf = GridFunction(X)
    vec = gf.vec.CreateVector()
    for use in (
        lambda c: c.Apply(gf.vec, vec),
        lambda c: c.AssembleLinearization(gf.vec),
        lambda c: c.Evaluate(gf),
        lambda c: c.Commit(gf),
        lambda c: c.Table(),
        lambda c: c.Force(),
        lambda c: c.Moment((0, 0)),
    ):
        with raises(r"no pairing yet; call Update\(\) first"):
            use(LACContact(u, lam, master="master"))


def test_use_without_a_scale(X):
    c = contact(X)
    c.Update()
    gf = GridFunction(X)
    with raises("the scale c is not set; call SetStiffness"):
        c.Apply(gf.vec, gf.vec.CreateVector())


def test_configuration_with_nan(X, mesh):
    gf = GridFunction(X)
    gf.vec.FV().NumPy()[:] = np.nan
    with raises("the configuration to pair in holds NaN or infinite coordinates"):
        contact(X).Update(gf)


def test_update_with_a_function_of_another_space(X, mesh):
    with raises("gf lives on another space than u and lam"):
        contact(X).Update(GridFunction(VectorH1(mesh, order=2)))
    c = contact(X)
    c.Update()
    with raises(f"gf lives on another space than u and lam.* in place of {X.ndof}"):
        c.Evaluate(GridFunction(VectorH1(mesh, order=2)))
