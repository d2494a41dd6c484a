"""NGSolve's status line and percentage follow a computation, and are as before after it."""

import pytest
from netgen.libngpy._meshing import _GetStatus, _PushStatus
from press import press

from ngslac import ContactConvergenceError, LoadStepper
from ngslac.progress import Progress


def test_load_steps():
    problem, seen = press(friction=0.2), []
    before = _GetStatus()
    problem.load.Set(0)
    stepper = LoadStepper(problem.solver(), problem.load)
    stepper.Integrate(steps=4, printing=False, callback=lambda step: seen.append(_GetStatus()))
    assert seen == [("contact: load steps", pytest.approx(share)) for share in (25, 50, 75, 100)]
    assert _GetStatus() == before


def test_newton_iterations():
    problem, seen = press(friction=0.2, nonlinear=True), []
    problem.load.Set(1)
    problem.solver().Solve(printing=False, callback=lambda entry: seen.append(_GetStatus()))
    names, shares = zip(*seen, strict=True)
    assert set(names) == {"contact: Newton's method"}
    assert 0 == shares[0] < shares[-2] <= 100


def test_after_an_error():
    problem, before = press(friction=0.2, nonlinear=True), _GetStatus()
    problem.load.Set(1)
    with pytest.raises(ContactConvergenceError):
        problem.solver().Solve(maxit=1, printing=False)
    assert _GetStatus() == before


def test_one_that_was_never_left_is_forgotten():
    before, names = _GetStatus(), set()

    def interrupted():
        left = Progress("contact: interrupted")
        left.__enter__()
        return left

    left = interrupted()
    problem = press(friction=0.2)
    problem.solver().Solve(printing=False, callback=lambda _: names.add(_GetStatus()[0]))
    assert names == {"contact: Newton's method"}
    assert left._outermost
    _PushStatus(before[0])
