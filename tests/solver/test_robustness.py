"""What must not be accepted, and what must not be lost."""

import numpy as np
import pytest
from ngsolve import CF, BilinearForm, GridFunction, InnerProduct, Parameter, VectorH1, dx
from press import linear, mixed_press, numpy, press

from ngslac import (
    ContactConvergenceError,
    ContactSolver,
    FormSum,
    LACContact,
    LACSpace,
    LoadStepper,
)


def test_loads_on_condensed_dofs_are_seen():
    """A volume load that only inner dofs feel changes the solution, condensed or not."""
    solutions = []
    for condense in (False, True):
        problem = press(order=4, h=0.5, condense=condense)
        (_, _), (v, _) = problem.X.TnT()
        inner = Parameter(0.0)
        problem.a += -inner * InnerProduct(CF((3.0, -5.0)), v) * dx("upper")
        solver = problem.solver()
        solver.Solve(printing=False)
        before = numpy(problem.gf)
        inner.Set(1.0)
        assert solver.Solve(printing=False).number > 0
        assert np.abs(numpy(problem.gf) - before).max() > 1e-3 * np.abs(before).max()
        solutions.append(numpy(problem.gf.components[0]))
    assert solutions[1] == pytest.approx(solutions[0], abs=1e-9 * np.abs(solutions[0]).max())


class Limit(ContactSolver):
    """A solver that cannot get beyond a limit load."""

    def __init__(self, problem, limit):
        super().__init__(problem.a, problem.gf, problem.contact)
        self.problem, self.limit, self.attempts = problem, limit, 0

    def Solve(self, **_):
        self.attempts += 1
        if self.problem.load.Get() > self.limit:
            raise ContactConvergenceError("beyond the limit")
        return type("Last", (), {"number": 1})


def test_a_limit_load_ends_the_stepping():
    problem = press()
    problem.load.Set(0.0)
    solver = Limit(problem, 0.73)
    with pytest.raises(ContactConvergenceError, match="beyond the limit"):
        LoadStepper(solver, problem.load, maxcuts=5).Integrate(steps=2, printing=False)
    smallest = 0.5 / 2**5
    assert 0.73 - smallest <= problem.load.Get() <= 0.73
    assert solver.attempts < 20


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, ValueError])
def test_any_error_restores_solution_load_and_fields(error):
    problem = mixed_press()
    problem.load.Set(0.0)
    solver = problem.solver()
    stepper = LoadStepper(solver, problem.load)
    stepper.Integrate(0.8, steps=2, printing=False)
    before = numpy(problem.gf)
    table = {k: v.copy() for k, v in problem.contact.Table().items()}
    assert np.abs(table["slip"]).max() > 0
    stepper.prescribe = lambda gf: (_ for _ in ()).throw(error("on purpose"))
    with pytest.raises(error, match="on purpose"):
        stepper.Integrate(1.2, steps=1, printing=False)
    assert problem.load.Get() == pytest.approx(0.8)
    assert np.array_equal(numpy(problem.gf), before)
    for name, values in problem.contact.Table().items():
        assert np.array_equal(values, table[name]), name
    assert np.array_equal(numpy(problem.contact.slip), table["slip"].ravel())


def test_two_contacts_need_multipliers_of_their_own():
    problem = press()
    (u, lam), _ = problem.X.TnT()
    other = LACContact(u, lam, obstacle=CF(0.1))
    with pytest.raises(ValueError, match="two contacts share one lam"):
        ContactSolver(problem.a, problem.gf, [problem.contact, other]).Solve(printing=False)
    with pytest.raises(ValueError, match="two contacts share one lam"):
        FormSum(problem.a, problem.contact, other)


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


def test_a_failed_pairing_leaves_the_old_one():
    problem = press()
    problem.contact.Update()
    report, segments = str(problem.contact.Check()), len(problem.contact.Segments())
    away = GridFunction(problem.X)
    V = problem.X.components[0]
    away.components[0].Set(problem.mesh.MaterialCF({"upper": CF((50, 0))}, default=CF((0, 0))))
    assert V.ndof
    with pytest.raises(Exception, match="never meet"):
        problem.contact.Update(away)
    assert str(problem.contact.Check()) == report
    assert len(problem.contact.Segments()) == segments


def test_ordinary_convergence_is_not_damped():
    solver = mixed_press(nonlinear=True).solver()
    solver.Solve(printing=False)
    assert all(entry.damping == 1 for entry in solver.history)


def test_wrong_vectors_are_refused():
    problem = press()
    problem.contact.Update()
    short = GridFunction(LACSpace(VectorH1(problem.mesh, order=2), slave="slave")).vec
    a = BilinearForm(problem.X)
    (u, _), (v, _) = problem.X.TnT()
    a += linear(u, v)
    a.AssembleLinearization(problem.gf.vec)
    problem.contact.Prepare(a.mat)
    for call in (
        lambda: problem.contact.AddApply(short, problem.gf.vec.CreateVector()),
        lambda: problem.contact.AddApply(problem.gf.vec, short),
        lambda: problem.contact.AssembleLinearization(short),
    ):
        with pytest.raises(Exception, match="entries, the product space"):
            call()
