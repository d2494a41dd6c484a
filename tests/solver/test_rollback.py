"""What fails leaves no trace: rollback of a Solve, detection of cycles, bodies that float."""

import numpy as np
import pytest
from ngsolve import CF, InnerProduct, ds, x
from press import mixed_press, numpy, press

from ngslac import ContactConvergenceError, FloatingBodyError

# Tresca's bound is there or not: closed, it lifts the macro-element off, and open, it is missed.
CYCLING = {"tresca": 2.0, "push": (0.2, -0.02 + 0.1 * x)}


def test_a_failed_solve_restores_everything():
    problem = mixed_press(nonlinear=True)
    solver = problem.solver()
    solver.Solve(printing=False)
    before, status = numpy(problem.gf), problem.contact.Table()["status"].copy()
    table = {k: v.copy() for k, v in problem.contact.Table().items()}
    problem.load.Set(1.7)
    with pytest.raises(ContactConvergenceError) as error:
        solver.Solve(maxit=1, printing=False)
    assert np.array_equal(numpy(problem.gf), before)
    assert np.array_equal(problem.contact.Table()["status"], status)
    for name, values in problem.contact.Table().items():
        assert np.array_equal(values, table[name]), name
    assert np.array_equal(numpy(problem.contact.status), status)
    assert len(error.value.history) == 2
    assert "no convergence in 1 iterations" in str(error.value)
    solver.Solve(printing=False)  # nothing is broken: more iterations do it
    assert not np.array_equal(numpy(problem.gf), before)


def test_a_failed_solve_leaves_the_slip_history():
    problem = mixed_press(nonlinear=True)
    solver = problem.solver()
    solver.Solve(printing=False)
    problem.contact.Commit(problem.gf)
    problem.contact.Evaluate(problem.gf)
    assert problem.contact.Table()["slip"] == pytest.approx(0, abs=1e-15)
    problem.load.Set(1.5)
    with pytest.raises(ContactConvergenceError):
        solver.Solve(maxit=1, printing=False)
    assert problem.contact.Table()["slip"] == pytest.approx(0, abs=1e-15)


def test_an_exception_of_the_callback_is_passed_on():
    problem = press()

    def callback(entry):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        problem.solver().Solve(printing=False, callback=callback)


def test_a_cycle_is_noticed_and_damped():
    problem = press(**CYCLING)
    solver = problem.solver()
    with pytest.raises(ContactConvergenceError, match="the contact status cycles; take smaller"):
        solver.Solve(printing=False)
    assert min(h.damping for h in solver.history) < 1
    assert "damped" in str(next(h for h in solver.history if h.damping < 1))
    assert not np.any(numpy(problem.gf))
    statuses = [(h.open, h.stick, h.slip) for h in solver.history]
    assert len(set(statuses)) < len(statuses)


def test_nan_in_the_residual_of_the_start():
    """A bulk that is not defined at the state: an error that says so, and a rollback."""
    problem = mixed_press(nonlinear=True)
    problem.gf.components[0].Set(CF((-2 * x, 0)))  # inside out: the logarithm has no value
    before = numpy(problem.gf)
    with pytest.raises(
        ContactConvergenceError, match="NaN or infinite values of a, the bulk form, at the"
    ):
        problem.solver().Solve(printing=False)
    assert np.array_equal(numpy(problem.gf), before)


def test_newton_steps_without_a_residual_are_damped():
    """The full step turns elements inside out; shortened ones lead to the solution."""
    problem = press(friction=2.0, nonlinear=True, push=(0.3, -0.05))
    solver = problem.solver()
    solver.Solve(printing=False)
    assert min(h.damping for h in solver.history) < 1
    assert solver.history[-1].damping == 1  # and the end is quadratic
    assert solver.history[-1].equilibrium < 10 * solver.history[-2].equilibrium ** 2 + 1e-13


def test_a_load_that_no_part_of_a_step_bears():
    """What has no solution nearby ends with an error, not with NaN."""
    problem = mixed_press(nonlinear=True)
    problem.load.Set(-400.0)
    with pytest.raises(ContactConvergenceError):
        problem.solver().Solve(printing=False)
    assert not np.any(numpy(problem.gf))


# --- bodies that only contact holds ------------------------------------------------------------


def floating(traction=(0.0, -1.0), **flags):
    """The upper block is loaded by a traction and held by nothing else."""
    problem = press(spring=0, **flags)
    v = problem.X.TestFunction()[0]
    problem.a += -InnerProduct(CF(traction), v) * ds("top")
    return problem


@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_friction_holds_a_body_that_starts_from_the_gap(gap):
    problem = floating(friction=0.5)
    lift(problem, gap)
    problem.solver(initial="gap").Solve(printing=False)
    assert problem.contact.Force() == pytest.approx([0, 1], abs=1e-10)
    assert np.all(problem.contact.Table()["status"] == 1)


def lift(problem, gap):
    """Start with the upper block above the lower one."""
    shape = problem.gf.components[0]
    shape.Set(problem.mesh.MaterialCF({"upper": CF((0, gap)), "lower": CF((0, 0))}))


def test_frictionless_contact_holds_what_is_guided():
    problem = floating(flags={"dirichletx": "left_upper", "dirichlet": "bottom"})
    problem.solver().Solve(printing=False)
    assert problem.contact.Force()[1] == pytest.approx(1, rel=1e-10)


def test_frictionless_contact_cannot_hold_sideways():
    problem = floating()
    with pytest.raises(FloatingBodyError, match=r"body 'upper' floats \(translation in x\)"):
        problem.solver().Solve(printing=False)


def test_initial_none_names_body_and_motion():
    problem = floating(flags={"dirichletx": "left_upper", "dirichlet": "bottom"})
    with pytest.raises(FloatingBodyError, match=r"'upper' floats \(translation in y\)") as error:
        problem.solver(initial="none").Solve(printing=False)
    assert "start in contact" in str(error.value)
    assert not np.any(numpy(problem.gf))


@pytest.mark.parametrize(
    ("dirichlet", "motions"),
    [
        ({"dirichlet": "bottom"}, ["translation in x", "translation in y", "rotation"]),
        ({"dirichlety": "top", "dirichlet": "bottom"}, ["translation in x"]),
        ({"dirichletx": "top", "dirichlet": "bottom"}, ["translation in y", "rotation"]),
    ],
)
def test_every_free_motion_is_named(dirichlet, motions):
    problem = floating(flags=dirichlet)
    with pytest.raises(FloatingBodyError) as error:
        problem.solver(initial="none").Solve(printing=False)
    found = str(error.value).split(":")[0]
    assert found.count("floats") == len(motions)
    for motion in motions:
        assert f"body 'upper' floats ({motion})" in found


def test_the_slave_may_hold_a_floating_master():
    """The lower block floats, the upper one is held by springs."""
    problem = press(friction=0.5, flags={"dirichlet": ""})
    v = problem.X.TestFunction()[0]
    problem.a += -InnerProduct(CF((0, 1.0)), v) * ds("bottom")
    problem.load.Set(0.0)
    problem.solver().Solve(printing=False)
    # 1.4 is the length of the lower block with its overhang
    assert problem.contact.Force() == pytest.approx([0, 1.4], abs=1e-9)


def test_a_pulled_body_flies_away():
    """Pulled apart, no contact can hold it: an error after contact has opened."""
    problem = floating(traction=(0.0, 1.0), friction=0.5)
    with pytest.raises(ContactConvergenceError) as error:
        problem.solver().Solve(printing=False)
    expected = "body 'upper' is pulled away (translation in y, towards +y): contact can only push"
    assert expected in str(error.value)
    assert not np.any(numpy(problem.gf))


def test_friction_below_tresca_keeps_the_law_continuous():
    """What cycles with Tresca's bound alone converges with Coulomb's law up to that bound."""
    problem = press(**CYCLING, friction=1.0)
    problem.solver().Solve(printing=False)
    table = problem.contact.Table()
    shear = table["traction"] + table["pressure"][:, None] * table["normal"]
    bound = np.minimum(table["pressure"], 2.0)
    assert np.all(np.linalg.norm(shear, axis=1) <= bound + 1e-9)
    assert 0 in table["status"]
