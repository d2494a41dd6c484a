"""What is taken for granted of a linear bulk is what the form says, whatever changes between."""

import numpy as np
import pytest
from motions import on_ground, values
from netgen.meshing import NgException
from ngsolve import (
    CF,
    L2,
    BilinearForm,
    Grad,
    GridFunction,
    IfPos,
    InnerProduct,
    Parameter,
    Sym,
    VectorH1,
    div,
    ds,
    dx,
    log,
    sin,
    sqrt,
    x,
)
from press import linear, neo_hooke, numpy, press, stress, two_blocks

from ngslac import ContactSolver, LACContact, LACSpace, TimeStepper
from ngslac.linear import parts
from ngslac.parallel.layout import LayoutOf
from ngslac.solve import bulk as bulks
from ngslac.solve.bulk import Bulk
from ngslac.solve.probe import AssembleLinear, Probe
from ngslac.solve.problem import AssembleBulk
from ngslac.steps import forces

PRESTRESS = CF((3, 1, 1, -2), dims=(2, 2))


def thermal(u, v, _):
    return [InnerProduct(stress(u) - x * PRESTRESS, Sym(Grad(v))) * dx]


def separate(u, v, load):
    return [linear(u, v), -InnerProduct(PRESTRESS, Grad(v)) * dx, load * v[0] * ds("top")]


def yielding(u, v, _):
    """Elastic and ideally plastic from a strain of 0.01 on, from a plastic strain on."""
    strain = Sym(Grad(u)) - 1e-3 * PRESTRESS
    size = sqrt(InnerProduct(strain, strain) + 1e-30)
    return [40 * InnerProduct(IfPos(size - 0.01, 0.01 / size, 1) * strain, Sym(Grad(v))) * dx]


def stopped(u, v, _):
    return [linear(u, v), IfPos(u[0] - 0.02, 1e4 * (u[0] - 0.02), 0) * v[0] * ds("right_upper")]


def squared(u, v, _):
    return [linear(u, v), 1e-3 * u[0] * u[0] * v[0] * dx]


def finite(u, v, _):
    return [neo_hooke(u)]


@pytest.mark.parametrize(
    ("law", "once", "affine"),
    [
        (lambda u, v, _: [linear(u, v)], True, True),
        (separate, True, True),
        (thermal, False, True),
        (yielding, False, False),
        (stopped, False, False),
        (squared, False, False),
        (finite, False, False),
    ],
)
def test_the_matrix_is_the_derivative(law, once, affine):
    """Assembled at once only where that is right, and linear is only what is."""
    problem = press(bulk=law, spring=0)
    random = np.random.default_rng(3).standard_normal(len(numpy(problem.gf)))
    problem.gf.vec.FV().NumPy()[:] = 1e-3 * random
    problem.a.AssembleLinearization(problem.gf.vec)
    expected = problem.a.mat.AsVector().FV().NumPy().copy()
    bulk = Bulk(problem.a, problem.gf, None)
    probe = Probe.At(bulk)
    assert bool(probe and probe.Agrees(bulk)) is affine
    assert AssembleLinear(problem.a, bulk.layout)
    assert bool(probe and probe.Agrees(bulk)) is once
    bulk.Assemble()
    assert bulk.islinear is affine
    given = bulk.mat.AsVector().FV().NumPy()
    assert given == pytest.approx(expected, abs=1e-13 * np.abs(expected).max())


def test_a_form_without_a_value_there_is_not_asked():
    problem = press(bulk=lambda u, v, _: [linear(u, v), log(1e-3 + u[0]) * v[0] * dx], spring=0)
    assert Probe.At(Bulk(problem.a, problem.gf, None)) is None


def test_a_prestress_that_changes_between_solves():
    """By a GridFunction in the form, as a history of the material; then the stiffness changes."""
    results = []
    for trusts in (True, False):
        past, young = [], Parameter(1.0)

        def law(u, v, _, past=past, young=young):
            past.append(GridFunction(L2(u.space.mesh, order=0)))
            return [
                young * InnerProduct(stress(u), Sym(Grad(v))) * dx,
                past[0] * InnerProduct(PRESTRESS, Grad(v)) * dx,
            ]

        problem = press(bulk=law, friction=0.5)
        solver = problem.solver()
        for size, stiffness in ((0.0, 1.0), (0.1, 1.0), (-0.2, 1.0), (0.1, 3.0), (0.1, 3.0)):
            past[0].Set(size * (1 + x))
            young.Set(stiffness)
            if not trusts:
                solver.system.StartAfresh()
            solver.Solve(printing=False)
        results.append(numpy(problem.gf))
    assert results[0] == pytest.approx(results[1], abs=1e-9 * np.abs(results[1]).max())


def steady(u, v, t):
    return -0.2 * v[0] * ds("right")


def swinging(u, v, t):
    return -0.2 * sin(7 * t) * v[0] * ds("right")


def switched(u, v, t):
    return -IfPos(t - 0.42, 0.2, 0) * v[0] * ds("right")


def pulled(u, v, t):
    """By what follows the side: a stiffness that is another one in each step."""
    return (1 + t) * u[0] * v[0] * ds("right")


def hardened(u, v, t):
    stiffer = 20 * sin(5 * t) ** 2 * InnerProduct(Sym(Grad(u)), Sym(Grad(v)))
    return stiffer * dx - 0.2 * v[0] * ds("right")


def bumped(u, v, t):
    """A spring with a gap beside the ground: linear before and behind it."""
    return IfPos(u[0] - 0.02, 50 * (u[0] - 0.02), 0) * v[0] * ds("right")


def flight(load, **flags):
    motion = on_ground(gap=0.02, dt=0.05, load=load, modulus=10.0, friction=0.3, **flags)
    return motion.throw(0.1, -0.5)


def distrust(patch):
    """Every residual and every load comes from the form."""
    apply = Bulk.Apply
    patch.setattr(Bulk, "Apply", lambda self, exact: apply(self, True))
    patch.setattr(bulks.Probe, "At", lambda *_: None)
    patch.setattr(forces, "STEADY", -1.0)
    patch.setattr(parts, "MOST_ROWS", 0)


IN_TURN = [  # by default each load is condensed or not
    pytest.param(load, condense, marks=() if (i + condense) % 2 == 0 else pytest.mark.full)
    for i, load in enumerate((steady, swinging, switched, pulled, hardened, bumped))
    for condense in (False, True)
]


@pytest.mark.parametrize(("load", "condense"), IN_TURN)
def test_loads_that_change_on_the_way(load, condense, monkeypatch):
    motions = [flight(load, condense=condense, order=3)]
    motions[0].run(0.6)
    with monkeypatch.context() as patch:
        distrust(patch)
        motions.append(flight(load, condense=condense, order=3))
        motions[1].run(0.6)
    (mine, its), tables = motions, [motion.stepper.Table() for motion in motions]
    assert values(mine.gf) == pytest.approx(values(its.gf), abs=1e-9 * np.abs(values(its.gf)).max())
    for name in tables[0]:
        assert tables[0][name] == pytest.approx(tables[1][name], abs=1e-10)
    assert np.any(tables[0]["friction"] > 0)
    # The matrix of the step before is tried in vain where the stiffness has changed.
    tries = load in (pulled, hardened, bumped)
    for mine, its in zip(*(motion.steps for motion in motions), strict=True):
        assert mine.iterations <= its.iterations + tries


@pytest.mark.parametrize(("load", "most"), [(steady, 2), (swinging, 3)])
def test_how_often_dynamics_asks_the_form(load, most):
    """At the start and in the end of each step, and without a displacement if loads change."""
    motion, asked = flight(load), []
    motion.run(0.2)
    form = motion.stepper.form
    apply = form.elastic.Apply

    class Counted:
        def __getattr__(self, name):
            return getattr(motion.stepper.static.a, name)

        def Apply(self, x, y):
            asked.append(len(motion.steps))
            apply(x, y)

    form.elastic = counted = Counted()
    motion.stepper._end._forces._Apply = lambda vec: asked.append(0) or applied(apply, vec)
    assert counted.space == motion.gf.space
    motion.run(0.7)
    count = len(motion.steps)
    assert len(asked) <= most * count + 4
    assert np.all([step.iterations > 0 for step in motion.steps])


def applied(apply, vec):
    result = vec.CreateVector()
    apply(vec, result)
    return result.FV().NumPy()


def test_a_load_that_changes_between_flights(monkeypatch):
    """A Parameter of the user, between two calls."""
    results = []
    for trusts in (True, False):
        with monkeypatch.context() as patch:
            if not trusts:
                distrust(patch)
            side = Parameter(0.0)
            motion = flight(lambda u, v, t, side=side: side * v[0] * ds("right"))
            motion.run(0.3)
            side.Set(-0.3)
            motion.run(0.6)
        results.append((values(motion.gf), motion.stepper.balance.external))
    assert results[0][0] == pytest.approx(results[1][0], abs=1e-10)
    assert results[0][1] == pytest.approx(results[1][1], abs=1e-11)
    assert abs(results[1][1]) > 1e-3


def thrown_with_pressure():
    """A block in mixed form, its pressure condensed, thrown at another one; a stop over its top."""
    mesh = two_blocks(2, h=0.5)
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    X = V * LACSpace(V, slave="slave") * L2(mesh, order=0)
    (u, lam, p), (v, _, q) = X.TnT()
    time = Parameter(0.0)
    a = BilinearForm(X, condense=True)
    a += 20 * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx
    a += (-p * div(v) - (div(u) + 0.01 * p) * q) * dx
    past = u[0] - 0.02 - 0.02 * time
    a += IfPos(past, 5000 * past, 0) * v[0] * ds("top")
    contact = LACContact(u, lam, master="master", friction=0.4)
    solver = ContactSolver(a, GridFunction(X), contact)
    stepper = TimeStepper(solver, 1.0, dt=0.03, time=time)
    down = mesh.MaterialCF({"upper": CF((0.1, -0.5))}, default=CF((0, 0)))
    stepper.velocity.components[0].Set(down)
    stepper.Integrate(0.4, printing=False)
    return stepper


def test_a_stop_that_newtons_steps_do_not_see(monkeypatch):
    """Where it acts at the begin of a step alone, the step is not that of a linear bulk."""
    mine = thrown_with_pressure()
    with monkeypatch.context() as patch:
        distrust(patch)
        patch.setattr(Bulk, "Assemble", assemble)
        its = thrown_with_pressure()
    expected = values(its.gf.components[0])
    assert values(mine.gf.components[0]) == pytest.approx(expected, abs=1e-9)
    assert mine.Table()["algorithmic"] == pytest.approx(its.Table()["algorithmic"], abs=1e-9)


def assemble(bulk):
    """A new matrix in each iteration."""
    bulk.islinear = False
    AssembleBulk(bulk.a, bulk.gf.vec, bulk.layout)
    return True


def test_a_form_that_cannot_be_assembled_is_not_taken_for_linear():
    class Form:
        def Assemble(self):
            raise NgException("no matrix")

    assert not AssembleLinear(Form(), LayoutOf(press().X))
