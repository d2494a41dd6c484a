"""LoadStepper: steps, cuts, commits, and what it leaves when it gives up."""

import numpy as np
import pytest
from ngsolve import CF, GridFunction
from press import mixed_press, numpy, press

from ngslac import ContactConvergenceError, LoadStepper


def stepper(problem, **flags):
    return LoadStepper(problem.solver(), problem.load, **flags)


def unloaded(**flags):
    problem = mixed_press(**flags)
    problem.load.Set(0.0)
    return problem


def test_steps_reach_the_end_and_call_back():
    problem, seen = unloaded(nonlinear=True), []
    steps = stepper(problem).Integrate(steps=4, printing=False, callback=seen.append)
    assert seen == steps
    assert [s.time for s in steps] == pytest.approx([0.25, 0.5, 0.75, 1.0])
    assert [s.number for s in steps] == [1, 2, 3, 4]
    assert all(s.iterations >= 1 and s.cuts == 0 for s in steps)
    assert problem.load.Get() == 1.0


def test_the_callback_sees_the_committed_state():
    problem = unloaded()
    forces = []

    def callback(step):
        problem.contact.Evaluate(problem.gf)
        assert problem.contact.Table()["slip"][problem.contact.Table()["status"] > 0] == (
            pytest.approx(0, abs=1e-14)
        )
        forces.append(problem.contact.Force()[1])

    stepper(problem).Integrate(steps=3, printing=False, callback=callback)
    assert np.all(np.diff(forces) > 0)


def test_continues_where_it_stopped():
    problem = unloaded()
    tool = stepper(problem)
    tool.Integrate(0.5, steps=2, printing=False)
    tool.Integrate(1.0, steps=2, printing=False)
    other = unloaded()
    stepper(other).Integrate(1.0, steps=4, printing=False)
    assert numpy(problem.gf) == pytest.approx(numpy(other.gf), abs=1e-12)
    assert [s.number for s in tool.steps] == [1, 2, 3, 4]


def test_unloading_goes_back():
    """Frictionless contact has no memory: back at zero nothing is left."""
    problem = unloaded(friction=None)
    tool = stepper(problem)
    tool.Integrate(1.0, steps=2, printing=False)
    assert np.abs(numpy(problem.gf)).max() > 1e-3
    tool.Integrate(0.0, steps=2, printing=False)
    assert np.abs(numpy(problem.gf.components[0])).max() < 1e-12


@pytest.mark.parametrize("predict", [False, True])
def test_prediction_does_not_change_the_solution(predict):
    problem, reference = unloaded(nonlinear=True), unloaded(nonlinear=True)
    stepper(problem, predict=predict).Integrate(steps=3, printing=False)
    for load in (1 / 3, 2 / 3, 1.0):
        reference.load.Set(load)
        reference.solver().Solve(printing=False)
        reference.contact.Commit(reference.gf)
    assert numpy(problem.gf) == pytest.approx(numpy(reference.gf), abs=1e-8)


def test_prescribed_displacements():
    problem = press(spring=0, flags={"dirichlet": "bottom|top"}, friction=0.4)
    problem.load.Set(0.0)
    V = problem.X.components[0]
    top = np.array([bool(b) for b in V.GetDofs(problem.mesh.Boundaries("top"))])
    wanted = GridFunction(V)
    wanted.Set(CF((0.01, -0.02)), definedon=problem.mesh.Boundaries("top"))

    def prescribe(gf):
        values = gf.components[0].vec.FV().NumPy()
        values[top] = problem.load.Get() * numpy(wanted)[top]

    stepper(problem, prescribe=prescribe).Integrate(steps=3, printing=False)
    at_top = problem.gf.components[0](problem.mesh(0.5, 1))
    assert at_top == pytest.approx((0.01, -0.02), rel=1e-12)
    assert problem.contact.Force()[1] > 0.5


# The full Newton step turns elements inside out, where the bulk's energy has no value.
HARD = {"friction": 2.0, "nonlinear": True, "push": (0.3, -0.05)}


def test_a_failing_step_is_cut(capsys):
    problem = press(**HARD)
    problem.load.Set(0.0)
    steps = stepper(problem).Integrate(steps=1, maxit=5)
    assert len(steps) > 1
    assert sum(s.cuts for s in steps) >= 1
    assert steps[-1].time == problem.load.Get() == 1.0
    assert np.all(np.diff([s.time for s in steps]) > 0)
    assert "halved" in capsys.readouterr().out


def test_steps_grow_again_after_a_cut():
    """After a step that had to be cut the next one is twice as long."""
    problem = unloaded(nonlinear=True)
    steps = stepper(problem).Integrate(steps=1, maxit=4, printing=False)
    sizes = np.diff([0, *(s.time for s in steps)])
    assert steps[0].cuts > 0
    assert sizes.max() > 1.5 * sizes[0]


def test_giving_up_leaves_the_last_converged_step():
    problem = unloaded(nonlinear=True)
    tool = stepper(problem, maxcuts=2)
    tool.Integrate(0.5, steps=2, printing=False)
    before, committed = numpy(problem.gf), problem.contact.form.Vectors("reference")
    with pytest.raises(ContactConvergenceError):
        tool.Integrate(1.0, steps=1, maxit=1, tol=1e-14, printing=False)
    assert problem.load.Get() == 0.5
    assert np.array_equal(numpy(problem.gf), before)
    assert np.array_equal(problem.contact.form.Vectors("reference"), committed)
    assert len(tool.steps) == 2
    tool.Integrate(1.0, steps=2, printing=False)
    assert problem.load.Get() == 1.0


def test_cut_steps_reach_the_same_solution():
    """Without friction the path does not matter."""
    problem, fine = (unloaded(nonlinear=True, friction=None) for _ in range(2))
    steps = stepper(problem).Integrate(steps=1, maxit=4, printing=False)
    stepper(fine).Integrate(steps=8, printing=False)
    assert sum(s.cuts for s in steps) > 0
    assert numpy(problem.gf) == pytest.approx(numpy(fine.gf), abs=1e-8)
