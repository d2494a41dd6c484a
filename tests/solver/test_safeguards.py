"""Newton's method far from a solution: cycles, damping, values that do not exist, overlaps."""

from types import SimpleNamespace

import numpy as np
import pytest
from law import shear
from netgen.libngpy._meshing import _GetStatus
from ngsolve import CF, InnerProduct, ds, dx, x
from press import mixed_press, numpy, press, same

from ngslac import (
    AugmentedLagrangianSolver,
    ContactConvergenceError,
    ContactSolver,
    LoadStepper,
)
from ngslac.solve.newton import Newton
from ngslac.solve.residual import Measurement, Residual

# Tresca's bound is there or not: closed, it lifts the macro-element off, and open, it is missed.
CYCLING = {"tresca": 2.0, "push": (0.2, -0.02 + 0.1 * x)}


def test_a_cycle_is_noticed_and_damped():
    problem = press(**CYCLING)
    solver = problem.solver()
    with pytest.raises(ContactConvergenceError, match="the contact status cycles; take smaller"):
        solver.Solve(printing=False)
    assert "damped" in str(next(h for h in solver.history if h.damping < 1))
    assert not np.any(numpy(problem.gf))
    statuses = [(h.open, h.stick, h.slip) for h in solver.history]
    assert len(set(statuses)) < len(statuses)


def test_friction_below_tresca_keeps_the_law_continuous():
    """What cycles with Tresca's bound alone converges with Coulomb's law up to that bound."""
    problem = press(**CYCLING, friction=1.0)
    problem.solver().Solve(printing=False)
    table = problem.contact.Table()
    bound = np.minimum(table["pressure"], 2.0)
    assert np.all(np.linalg.norm(shear(table), axis=1) <= bound + 1e-9)
    assert 0 in table["status"]


@pytest.mark.usefixtures("whole_systems")
def test_newton_steps_without_a_residual_are_damped():
    """The full step turns elements inside out; shortened ones lead to the solution."""
    solver = press(friction=2.0, nonlinear=True, push=(0.3, -0.05)).solver()
    solver.Solve(printing=False)
    assert min(h.damping for h in solver.history) < 1
    assert solver.history[-1].damping == 1  # and the end is quadratic
    assert solver.history[-1].equilibrium < 10 * solver.history[-2].equilibrium ** 2 + 1e-13


NAN = "NaN or infinite values of a, the bulk form, at the"


@pytest.mark.parametrize(
    ("start", "load", "said"),
    [((-2 * x, 0), 1, NAN), ((0, 0), -400, ".")],  # inside out; no part of a step is borne
)
def test_what_has_no_solution_nearby_leaves_no_nan(start, load, said):
    problem = mixed_press(nonlinear=True)
    problem.gf.components[0].Set(CF(start))
    problem.load.Set(load)
    before, line = numpy(problem.gf), _GetStatus()
    with pytest.raises(ContactConvergenceError, match=said):
        problem.solver().Solve(printing=False)
    assert np.array_equal(numpy(problem.gf), before)
    assert _GetStatus() == line


@pytest.mark.parametrize("friction", [None, 0.4])
@pytest.mark.parametrize("finite", [False, True])
def test_an_initial_penetration_is_resolved(friction, finite):
    """The bodies overlap at the start: contact drives them apart, as from any start value."""
    flags = {"friction": friction, "push": (0, -0.05), "finite": finite}
    problem, reference = press(**flags), press(**flags)
    overlap = {"upper": CF((0, -0.05))}
    problem.gf.components[0].Set(problem.mesh.MaterialCF(overlap, default=CF((0, 0))))
    for made in (problem, reference):
        made.solver().Solve(printing=False)
    assert np.all(problem.contact.Table()["gap"] > -1e-9)
    assert problem.contact.Force()[1] == pytest.approx(reference.contact.Force()[1], rel=1e-8)


def test_a_traction_without_weight_lifts_off():
    """Pulled off, a block on a soft spring opens everywhere, and closes again."""
    problem = press(spring=0, friction=0.5)
    u, v = problem.X.TrialFunction()[0], problem.X.TestFunction()[0]
    problem.a += 1e-2 * InnerProduct(u, v) * dx("upper") + problem.load * v[1] * ds("top")
    problem.load.Set(0.0)
    stepper = LoadStepper(problem.solver(), problem.load)
    for load in (1.0, -1.0, 1.0):
        stepper.Integrate(load, steps=1, printing=False)
        assert np.all((problem.contact.Table()["status"] > 0) == (load > 0))


def test_the_status_line_follows_newtons_method():
    seen, solver = [], press(friction=0.2, nonlinear=True).solver()
    solver.Solve(printing=False, callback=lambda entry: seen.append(_GetStatus()))
    names, shares = zip(*seen, strict=True)
    assert set(names) == {"contact: Newton's method"}
    assert 0 == shares[0] < shares[-2] <= 100


def test_a_solution_whose_exact_residual_has_no_value_is_none(monkeypatch):
    nothing = Measurement.Nothing("the form has no value there")
    monkeypatch.setattr(Residual, "Confirm", lambda *_: nothing)
    problem = mixed_press()
    with pytest.raises(ContactConvergenceError, match="the form has no value there"):
        problem.solver().Solve(printing=False)
    assert not np.any(numpy(problem.gf))


def test_no_slip_turns_round_where_a_step_has_no_residual():
    log = SimpleNamespace(tol=1e-10, history=[])
    problem = press(friction=0.2)
    solver = problem.solver()
    solver.Solve(printing=False)
    newton = Newton(solver.system, log, initial="gap", path=False)
    assert newton._Stick(None, lambda part: Measurement.Nothing("far off")) is None


@pytest.mark.parametrize("kind", [ContactSolver, AugmentedLagrangianSolver])
def test_what_was_found_stays_where_no_other_method_finds_more(kind, monkeypatch):
    """Rounding errors of a far motion look like a solution, which is looked at twice."""
    problem, plain = mixed_press(friction=None), mixed_press(friction=None)
    plain.solver().Solve(printing=False)
    monkeypatch.setattr(Residual, "drowned", True)
    monkeypatch.setattr(Newton, "_Strays", lambda self: True)
    solver = kind(problem.a, problem.gf, problem.contact)
    last = solver.Solve(printing=False)
    assert last is solver.history[-1]
    same(problem, plain, 1e-8)
