"""What must not be accepted, what must not be lost, and bodies in 3D that only contact holds."""

from types import SimpleNamespace

import numpy as np
import pytest
from loaded import loaded
from ngsolve import CF, BilinearForm, GridFunction, InnerProduct, Parameter, VectorH1, dx, x, y
from press import linear, numpy, press, solved

from ngslac import (
    ContactConvergenceError,
    ContactSolver,
    ContactWarning,
    FloatingBodyError,
    LACSpace,
    LoadStepper,
)
from ngslac.bodies.messages import FloatingMessage

MOTIONS = [f"{kind} {c}" for kind in ("translation in", "rotation about") for c in "xyz"]
GUIDED = {"dirichletx": "left_upper", "dirichlety": "front_upper"}


def test_loads_on_condensed_dofs_are_seen():
    """A volume load that only inner dofs feel changes the solution, condensed or not."""
    solutions = []
    for condense in (False, True):
        problem, inner = press(order=4, h=0.5, condense=condense), Parameter(0.0)
        v = problem.X.TestFunction()[0]
        problem.a += -inner * InnerProduct(CF((3.0, -5.0)), v) * dx("upper")
        solver = solved(problem)
        before = numpy(problem.gf)
        inner.Set(1.0)
        assert solver.Solve(printing=False).number > 0
        assert np.abs(numpy(problem.gf) - before).max() > 1e-3 * np.abs(before).max()
        solutions.append(numpy(problem.gf.components[0]))
    assert solutions[1] == pytest.approx(solutions[0], abs=1e-9 * np.abs(solutions[0]).max())


def test_a_limit_load_ends_the_stepping():
    problem, attempts = press(), []
    problem.load.Set(0.0)
    solver = problem.solver()

    def Solve(**_):
        attempts.append(problem.load.Get())
        if attempts[-1] > 0.73:
            raise ContactConvergenceError("beyond the limit")
        return SimpleNamespace(number=1)

    solver.Solve = Solve
    with pytest.raises(ContactConvergenceError, match="beyond the limit; all macro-elements are"):
        LoadStepper(solver, problem.load, maxcuts=5).Integrate(steps=2, printing=False)
    assert 0.73 - 0.5 / 2**5 <= problem.load.Get() <= 0.73
    assert len(attempts) < 20


@pytest.mark.usefixtures("whole_systems")
def test_a_step_that_is_too_large_is_cut():
    """In one step six iterations do not do; in two they do."""
    problem = press(dim=3, friction=2.0, nonlinear=True, push=(0.5, 0.2, -0.1))
    problem.load.Set(0.0)
    stepper = LoadStepper(problem.solver(), problem.load)
    steps = stepper.Integrate(steps=1, maxit=6, printing=False)
    assert sum(s.cuts for s in steps) >= 1
    assert len(steps) >= 2
    assert steps[-1].time == problem.load.Get() == 1.0


def test_after_a_refinement_the_old_solver_is_refused():
    problem = press(h=0.5, mesh_flags={"structured": False}, flags={"autoupdate": True})
    gf = GridFunction(problem.X, autoupdate=True)
    solver = ContactSolver(problem.a, gf, problem.contact)
    solver.Solve(printing=False)
    problem.mesh.Refine()
    with pytest.raises(ValueError, match="refined: make a new ContactSolver"):
        solver.Solve(printing=False)
    with pytest.raises(Exception, match="after a refinement call Update"):
        problem.contact.Evaluate(gf)


def test_wrong_vectors_are_refused():
    problem = press()
    problem.contact.Update()
    short = GridFunction(LACSpace(VectorH1(problem.mesh, order=2), slave="slave")).vec
    a, vec = BilinearForm(linear(*(f[0] for f in problem.X.TnT()))), problem.gf.vec
    a.AssembleLinearization(vec)
    problem.contact.Prepare(a.mat)
    for call in (
        lambda: problem.contact.AddApply(short, vec.CreateVector()),
        lambda: problem.contact.AddApply(vec, short),
        lambda: problem.contact.AssembleLinearization(short),
    ):
        with pytest.raises(Exception, match="entries, the product space"):
            call()


# --- bodies that only contact holds --------------------------------------------------------------


@pytest.mark.parametrize("kinds", [("hex", "hex"), ("tet", "prism_side"), ("pyramid", "tet")])
def test_a_tilted_body_falls_flat(kinds):
    """It touches with one edge first; frictionless, guided sideways and against turning."""
    problem = loaded(0, 0, -1, dim=3, kinds=kinds, flags=GUIDED)
    tilted = {"upper": CF((0, 0, 0.01 + 0.02 * x))}
    problem.gf.components[0].Set(problem.mesh.MaterialCF(tilted, default=CF((0, 0, 0))))
    solved(problem)
    assert problem.contact.Force() == pytest.approx([0, 0, 1], abs=1e-9)
    assert np.all(problem.contact.Table()["status"] == 2)


@pytest.mark.parametrize(
    ("initial", "flags", "free"),
    [
        ("none", {}, range(6)),
        ("none", {"dirichletz": "top"}, [0, 1, 5]),
        ("none", {"dirichletx": "left_upper"}, [1, 2, 3]),
        ("none", GUIDED, [2]),
    ],
)
def test_every_free_motion_is_named(initial, flags, free):
    problem = loaded(0, 0, -1, dim=3, flags=flags)
    with pytest.raises(FloatingBodyError) as error:
        solved(problem, initial=initial)
    found = str(error.value).split(":")[0].split("; ")
    assert found == [f"body 'upper' floats ({MOTIONS[k]})" for k in free]
    assert initial == "gap" or "start in contact" in str(error.value)
    assert not np.any(numpy(problem.gf))


def test_what_a_plane_without_friction_leaves_free_is_said():
    """It stops three of six motions, and nothing drives the others."""
    problem = loaded(0, 0, -1, dim=3)
    with pytest.warns(ContactWarning) as said:
        solved(problem)
    (message,) = (str(one.message).split(":")[0] for one in said)
    assert message.split("; ") == [f"body 'upper' is free ({MOTIONS[k]})" for k in (0, 1, 5)]
    assert problem.contact.Force() == pytest.approx([0, 0, 1], abs=1e-9)


def test_the_first_of_many_motions_are_named():
    motions = [f"body {k} floats (rotation)" for k in range(40)]
    for count, rest in ((6, 0), (7, 1), (40, 34)):
        found = FloatingMessage(motions[:count]).split(":")[0].split("; ")
        assert found == motions[:6] + [f"and {rest} motions more"] * (rest > 0)


def test_both_bodies_may_float():
    """The clamp is missing: twelve motions, of which a frictional contact stops six."""
    with pytest.raises(FloatingBodyError) as error:
        solved(loaded(0, 0, -1, dim=3, friction=0.5, flags={"dirichlet": ""}))
    found = str(error.value).split(":")[0].split("; ")
    assert len(found) == 6
    assert {text.split("'")[1] for text in found} <= {"upper", "lower"}


def test_friction_stops_the_turning_about_the_normal():
    """A couple about z, within friction and beyond it."""
    for size in (0.2, 2.0):
        # moment of a unit of this traction on the unit square: 1/6
        problem = loaded(size * (0.5 - y), size * (x - 0.5), -1, dim=3, friction=0.5)
        if size > 1:
            with pytest.raises(ContactConvergenceError):
                solved(problem)
        else:
            solved(problem)
            moment = problem.contact.Moment((0.5, 0.5, 0.0))
            assert moment == pytest.approx([0, 0, -size / 6], abs=1e-10)
