"""Derivatives by the stiffness of one body, on which contacts depend in more than one way."""

from types import SimpleNamespace

import numpy as np
import pytest
from ngsolve import (
    CF,
    L2,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Integrate,
    Parameter,
    Sym,
    VectorH1,
    ds,
    dx,
    sin,
    x,
    y,
)
from press import press, stress, two_blocks
from varied import TOL, close, differences

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.analysis import Record, Sensitivity, Shape


def upper(young, mesh):
    """The modulus of the upper body alone is a variable."""
    E = mesh.MaterialCF({"upper": young}, default=2.0)
    return lambda u, v, load: [E * InnerProduct(stress(u), Sym(Grad(v))) * dx]


def solved(young, mesh, **law):
    """By a new contact and a new solver."""
    problem = press(change=lambda _: mesh, bulk=upper(young, mesh), **law)
    solver = problem.solver()
    solver.Solve(printing=False, tol=TOL)
    return problem, solver


def numbers(problem):
    return lambda: np.array(
        [
            *problem.contact.Force(),
            *problem.contact.Table()["pressure"],
            Integrate(problem.gf.components[0][0] * x * ds("top"), problem.mesh),
        ]
    )


LAWS = {
    "edges": {"edges": True, "friction": 0.3},
    "finite": {"finite": True, "offset": 0.02 * x},
    "friction": {"finite": True, "friction": 0.3},
    "held": {"flags": {"dirichlet": "bottom", "dirichletx": "slave"}, "friction": 2.0},
}


@pytest.mark.sample(4)
@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("dim", [2, 3])
def test_what_a_new_contact_learns_follows(name, dim):
    young, mesh = Parameter(1.0), two_blocks(dim)
    problem, solver = solved(young, mesh, dim=dim, **LAWS[name])
    found = Sensitivity(solver, numbers(problem)).By(young)
    integral = Sensitivity(solver, problem.X.TrialFunction()[0][0] * x * ds("top")).By(young)

    def Look():
        return numbers(solved(young, mesh, dim=dim, **LAWS[name])[0])()

    expected = differences(young, Look, 1e-4)
    close(found, expected)
    close(integral, expected[-1])


def test_a_contact_that_is_kept_keeps_what_it_knows():
    young, mesh = Parameter(1.0), two_blocks(2)
    problem, solver = solved(young, mesh, finite=True, friction=0.3)

    def Look():
        solver.Solve(printing=False, tol=TOL)
        return numbers(problem)()

    young.Set(3.0)
    Look()
    kept = Sensitivity(solver, numbers(problem)).By(young)
    close(kept, differences(young, Look, 1e-4))
    Look()
    problem.contact.Update()
    Look()
    follows = Sensitivity(solver, numbers(problem)).By(young)
    assert np.abs(kept - follows).max() > 1e-3 * np.abs(kept).max()


@pytest.mark.parametrize("finite", [False, True])
def test_the_scale_of_a_held_slave_follows_the_shape(finite):
    mesh, young = two_blocks(2), Parameter(1.0)
    shape = Shape(mesh, CF((0.1 * x * (1 + y), 0.1 * sin(3 * x) * (1 + y))))
    law = LAWS["held"] | {"finite": finite}
    problem, solver = solved(young, mesh, **law)
    found = Sensitivity(solver, lambda: problem.contact.Force()[0]).By(shape)
    forces = []
    for way in (1e-4, -1e-4):
        shape.Move(way)
        forces.append(solved(young, mesh, **law)[0].contact.Force()[0])
        shape.Move(-way)
    close(found, (forces[0] - forces[1]) / 2e-4)


@pytest.mark.parametrize("law", ["edges", "finite"])
def test_fields_of_moduli(law, monkeypatch):
    mesh = two_blocks(2)
    young = GridFunction(L2(mesh, order=0))
    young.Set(1 + 0.1 * x)
    bulk = lambda u, v, load: [young * InnerProduct(stress(u), Sym(Grad(v))) * dx]  # noqa: E731
    flags = {"change": lambda _: mesh, "bulk": bulk} | LAWS[law]

    def Solved():
        problem = press(**flags)
        solver = problem.solver()
        solver.Solve(printing=False, tol=TOL)
        return Sensitivity(solver, problem.X.TrialFunction()[0][0] * x * ds("top"))

    s, values = Solved(), young.vec.FV().NumPy()
    together = s.By(young)
    way, start = np.random.default_rng(3).normal(size=len(values)), values.copy()

    class Along:
        def Get(self):
            return 0.0

        def Set(self, part):
            values[:] = start + part * way

    close(together @ way, differences(Along(), lambda: Solved().value, 1e-4))
    monkeypatch.setattr(Sensitivity, "_Together", lambda *_: None)
    close(together, s.By(young), 1e-7)


@pytest.mark.parametrize("friction", [None, 0.3])
def test_stiffness_that_the_bulk_remembers(friction):
    """The first step begins with that of the start, not with that of the end."""
    depth, mesh = Parameter(0.03), two_blocks(2)

    def Make():
        load = Parameter(0.0)
        V = VectorH1(mesh, order=2, dirichlet="bottom|top")
        X = V * LACSpace(V, slave="slave")
        (u, lam), (v, _) = X.TnT()
        damage, gf = GridFunction(L2(mesh, order=1)), GridFunction(X)
        a = BilinearForm((1 - damage) * InnerProduct(stress(u), Sym(Grad(v))) * dx)
        contact = LACContact(u, lam, master="master", friction=friction, finite=True)
        path = {"top": CF((0.3 * depth * load, -depth * load))}
        stepper = LoadStepper(ContactSolver(a, gf, contact), load, prescribe=path)

        def Commit(step):
            strain = Grad(gf.components[0])
            damage.Set(damage + 50 * InnerProduct(strain, strain))

        record = Record(stepper, commit=Commit, memory=[damage])
        made = SimpleNamespace(contact=contact, forces=[], record=record)

        def Note(step):
            record(step)
            made.forces.append(contact.Force())

        stepper.Integrate(steps=3, callback=Note, printing=False, tol=TOL)
        return made

    made = Make()
    s = Sensitivity(made.record, made.contact.Force)
    close(s.value, made.forces, 1e-9)
    close(s.By(depth), differences(depth, lambda: Make().forces, 1e-6))
