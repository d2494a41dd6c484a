"""Callbacks may look at everything; what they must not do is refused, and changes nothing."""

import copy
import pickle

import numpy as np
import pytest
from ngsolve import Parameter
from press import numpy, press

from ngslac import ContactSolver, FormSum, LoadStepper, TimeStepper


@pytest.fixture
def problem():
    return press(h=0.5, friction=0.3)


def set_nan(problem, solver):
    problem.gf.vec[0] = np.nan


def move(problem, solver):
    problem.gf.vec[0] += 1e-9


def solve_again(problem, solver):
    solver.Solve(printing=False)


def solve_by_another(problem, solver):
    ContactSolver(problem.a, problem.gf, problem.contact).Solve(printing=False)


@pytest.mark.parametrize(
    ("action", "text"),
    [
        (set_nan, "callback has changed gf in the middle of Solve"),
        (move, "callback has changed gf in the middle of Solve"),
        (solve_again, "Solve was called in the middle of Solve"),
        (solve_by_another, "callback has changed gf in the middle of Solve"),
    ],
)
def test_what_a_callback_of_solve_must_not_do(problem, action, text):
    solver, before = problem.solver(), numpy(problem.gf)
    with pytest.raises(ValueError, match=text):
        solver.Solve(printing=False, callback=lambda entry: action(problem, solver))
    assert numpy(problem.gf).tobytes() == before.tobytes()
    solver.Solve(printing=False)  # nothing is left of it


def test_what_a_callback_leaves_between_steps(problem):
    problem.load.Set(0)
    stepper = LoadStepper(problem.solver(), problem.load)
    with pytest.raises(ValueError, match="callback has put NaN or infinite values into gf"):
        stepper.Integrate(
            steps=2, printing=False, callback=lambda step: set_nan(problem, stepper.solver)
        )


def test_states_of_another_size(problem):
    solver, other = problem.solver(), press(h=0.3, friction=0.3).solver()
    with pytest.raises(
        ValueError, match=r"values of gf, which has .* before the space was refined"
    ):
        solver.SetState(other.State())


@pytest.mark.parametrize("key", ["contacts", "history", "residual", "scale"])
def test_states_with_wrong_parts(problem, key):
    solver = problem.solver()
    with pytest.raises(TypeError, match=rf"state\['{key}'\] = 'text' must be what State"):
        solver.SetState(solver.State() | {key: "text"})
    with pytest.raises(ValueError, match="state is that of 0 contacts, the solver has 1"):
        solver.SetState(solver.State() | {"contacts": []})


def test_the_solver_of_a_time_stepper_is_no_solver_for_another(problem):
    stepper = TimeStepper(problem.solver(), 1.0, dt=0.1)
    with pytest.raises(TypeError, match="solver is the one that a TimeStepper works with"):
        TimeStepper(stepper.solver, 1.0, dt=0.1)


def test_copies_are_refused(problem):
    solver = problem.solver()
    things = (
        problem.contact,
        solver,
        FormSum(problem.a, problem.contact),
        LoadStepper(solver, Parameter(0)),
        TimeStepper(solver, 1.0, dt=0.1),
    )
    for thing in things:
        for make in (copy.copy, copy.deepcopy, pickle.dumps):
            with pytest.raises(TypeError, match="can be neither pickled nor copied"):
                make(thing)
