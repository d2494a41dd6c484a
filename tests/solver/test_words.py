"""Mistakes that used to end in words about something else, or in none."""

import numpy as np
import pytest
from netgen.meshing import NgException
from ngsolve import (
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    NumberSpace,
    Sym,
    VectorH1,
    ds,
    dx,
)
from posed import posed
from press import linear, press, stress, two_blocks

from ngslac import (
    AugmentedLagrangianSolver,
    ContactConvergenceError,
    ContactSolver,
    ContactWarning,
    FormSum,
    LACContact,
    LACSpace,
    TimeStepper,
)

# --- forms on another space ----------------------------------------------------------------------


def on(space, problem):
    u, v = (t[0] if isinstance(t, (tuple, list)) else t for t in space.TnT())
    a = BilinearForm(space)
    a += linear(u, v)
    return a


@pytest.mark.parametrize(
    "space", [lambda p: p.X.components[0], lambda p: p.X * NumberSpace(p.mesh)], ids=["V", "more"]
)
@pytest.mark.parametrize("solver", [ContactSolver, AugmentedLagrangianSolver])
def test_the_bulk_form_is_blamed_where_it_is_the_bulk_form(space, solver):
    problem = press(h=0.5)
    a = on(space(problem), problem)
    with pytest.raises(ValueError, match=r"a, the bulk form, lives on another space.*Bilinear"):
        solver(a, problem.gf, problem.contact)
    with pytest.raises(ValueError, match="must live on the same product space"):
        FormSum(a, problem.contact)
    with pytest.raises(ValueError, match="gf lives on another space"):
        solver(problem.a, GridFunction(a.space), problem.contact)


# --- results before there are any ----------------------------------------------------------------

RESULTS = {
    "Force": lambda c: c.Force(),
    "Moment": lambda c: c.Moment(),
    "Table": lambda c: c.Table(),
    "Evaluate": lambda c: c.Restore(),
}
PICTURES = {
    "Draw": lambda c: c.Draw(show=False),
    "Draw recovered": lambda c: c.Draw("recovered traction", show=False),
    "Plot": lambda c: c.Plot("traction"),
    "WriteVTU": lambda c: c.WriteVTU("never"),
    "Recovered": lambda c: c.Recovered(),
}


@pytest.mark.parametrize("what", RESULTS)
def test_numbers_before_a_solution(what):
    with pytest.raises(NgException, match="solve"):
        RESULTS[what](press(h=0.5).contact)


@pytest.mark.parametrize("what", PICTURES)
def test_pictures_before_a_solution(what, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    problem = press(h=0.5)
    with pytest.warns(ContactWarning, match="solve first"):
        PICTURES[what](problem.contact)
    problem.solver().Solve(printing=False)
    PICTURES[what](problem.contact)


def test_pictures_of_what_is_known_before():
    contact = press(h=0.5).contact
    for field in ("gap", "normal", "macros", "segments"):
        contact.Draw(field, show=False)


# --- one slave for two ---------------------------------------------------------------------------


def shared(slaves=("slave", "slave"), masters=("master", "master")):
    mesh = two_blocks(2, h=0.5)
    V = VectorH1(mesh, order=2, dirichlet="bottom|top")
    X = V * LACSpace(V, slave=slaves[0]) * LACSpace(V, slave=slaves[1])
    (u, *lams), (v, *_) = X.TnT()
    a = BilinearForm(X)
    a += linear(u, v) + v[1] * ds("slave")
    contacts = [
        LACContact(u, lam, **({"obstacle": side} if isinstance(side, float) else {"master": side}))
        for lam, side in zip(lams, masters, strict=True)
    ]
    return a, GridFunction(X), contacts


@pytest.mark.parametrize(
    ("slaves", "masters"),
    [
        (("slave", "slave"), ("master", "master")),
        (("slave", "slave"), ("master", 0.1)),
        (("slave|left_upper", "slave"), ("master", "master")),
        (("sla.*", "right_upper|slave"), ("master", "master")),
    ],
)
def test_one_slave_for_two_contacts(slaves, masters):
    a, gf, contacts = shared(slaves, masters)
    with pytest.raises(ValueError, match="two of them have the slave 'slave'"):
        ContactSolver(a, gf, contacts)
    contacts[1].Deactivate()
    solver = ContactSolver(a, gf, contacts)
    solver.Solve(printing=False)
    assert contacts[0].Force()[1] > 0
    contacts[1].Activate()
    with pytest.raises(ValueError, match="two of them have the slave 'slave'"):
        solver.Solve(printing=False)


def test_slaves_beside_each_other():
    a, gf, contacts = shared(("slave", "left_upper"), ("master", 1.0))
    ContactSolver(a, gf, contacts).Solve(printing=False)


# --- bodies without stiffness --------------------------------------------------------------------


def weak(young, *, condense=False, **flags):
    mesh = two_blocks(2, h=0.5)
    V = VectorH1(mesh, order=2, dirichlet="bottom", **flags)
    E = mesh.MaterialCF(young)

    def bulk(u, v, load):
        return E * InnerProduct(stress(u), Sym(Grad(v))) * dx + v[1] * ds("top")

    problem = posed(V, bulk, condense=condense, friction=0.3)
    return problem.a, problem.gf, problem.contact


def test_a_body_whose_stiffness_is_undefined_where_it_was_put():
    a, gf, contact = weak({"upper": np.nan, "lower": 1})
    gf.components[0].vec[:] = 1e-3
    with pytest.raises(ContactConvergenceError, match=r"NaN or .* of a, the bulk .*'upper'"):
        ContactSolver(a, gf, contact).Solve(printing=False)


@pytest.mark.parametrize("solver", ["interface", "direct"])
@pytest.mark.parametrize("condense", [False, True])
@pytest.mark.parametrize(
    ("young", "words"),
    [
        ({"uper": 1, "lower": 1}, "'upper' nothing"),
        ({"upper": 1, "lower": 0}, "'lower' nothing"),
        ({"upper": np.nan, "lower": 1}, "'upper' NaN or infinity"),
        ({"upper": 1, "lower": np.inf}, "'lower' NaN or infinity"),
    ],
)
def test_a_body_without_stiffness_is_named(solver, condense, young, words, capfd):
    a, gf, contact = weak(young, condense=condense)
    with pytest.raises(Exception, match=f"a, the bulk form, gives {words} as stiffness"):
        ContactSolver(a, gf, contact, solver=solver).Solve(printing=False)
    assert capfd.readouterr() == ("", "")


def test_a_body_that_is_held_needs_no_stiffness():
    """Nothing of it is free: it is rigid."""
    a, gf, contact = weak({"upper": 1, "lower": 0})
    free, V = a.space.FreeDofs(), a.space.components[0]
    for dof in np.flatnonzero(list(V.GetDofs(a.space.mesh.Materials("lower")))):
        free[int(dof)] = False
    ContactSolver(a, gf, contact, freedofs=free, solver="direct").Solve(printing=False)
    assert contact.Force()[1] == pytest.approx(1.0)


def test_a_body_with_mass_alone():
    """Its grains fly on as they are."""
    a, gf, contact = weak({"upper": 0, "lower": 1})
    stepper = TimeStepper(ContactSolver(a, gf, contact), density=1.0, dt=1e-3)
    stepper.Integrate(2e-3, printing=False)
