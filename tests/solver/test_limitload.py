"""Limit loads: a bar that softens when it is compressed, whose largest force is known."""

import re

import numpy as np
import pytest
from ngsolve import Grad, Id, InnerProduct, Parameter, Variation, ds, dx
from press import linear, numpy, press

from ngslac import ContactConvergenceError, LoadStepper
from ngslac.errors import LinearSolveError
from ngslac.steps.limitload import LimitLoad

LIMIT = 2 / (3 * np.sqrt(3))  # of F - F^3, a stress over mu, where F^2 = 1/3


def saint_venant(u, v, load):
    """Above, Saint Venant and Kirchhoff's material, nu 0, mu 1."""
    F = Id(2) + Grad(u)
    strain = 0.5 * (F.trans * F - Id(2))
    softens = Variation(InnerProduct(strain, strain).Compile() * dx("upper"))
    return softens, linear(u, v, dx("lower")) + load * v[1] * ds("top")


def bar(**law):
    """A stepper that presses a block on another one of the same width."""
    held = {"dirichlet": "bottom", "dirichletx": "top"}
    flat = {"overhang": 0.0, "aligned": True, "structured": False}
    problem = press(h=0.4, spring=0, flags=held, mesh_flags=flat, bulk=saint_venant, **law)
    problem.load.Set(0)
    return LoadStepper(problem.solver(), problem.load)


@pytest.mark.parametrize("law", [{}, {"bilateral": True}, {"offset": 0.01}], ids=str)
def test_a_limit_load_is_named_with_bounds(law):
    stepper, systems = bar(**law), []
    solve = stepper.solver.Solve

    def counted(**flags):
        try:
            return solve(**flags)
        finally:
            systems.append(len(stepper.solver.history) - 1)

    stepper.solver.Solve = counted
    with pytest.raises(ContactConvergenceError, match="body 'upper' snaps or collapses") as error:
        stepper.Integrate(steps=1, printing=False)
    least, most = map(float, re.search(r"between (\S+) and (\S+),", str(error.value)).groups())
    assert least == pytest.approx(stepper.load.Get(), abs=1e-4)
    assert least < LIMIT < most
    assert most - least < 0.1
    assert sum(systems) < 150


def test_below_the_limit_all_is_well():
    stepper = bar()
    stepper.Integrate(0.97 * LIMIT, steps=1, printing=False)
    assert stepper.load.Get() == 0.97 * LIMIT


@pytest.mark.parametrize(("share", "accuracy"), [(0.5, 0.1), (0.9, 0.01), (0.98, 0.002)])
def test_the_estimate_gets_better_near_the_limit(share, accuracy):
    stepper = bar()
    stepper.Integrate(share * LIMIT, steps=3, printing=False)
    limit, before = LimitLoad(stepper.solver, stepper.load, 1.0), numpy(stepper.solver.gf)
    limit.Estimate(0.5, failed=False)
    assert limit.expected == pytest.approx(LIMIT, rel=accuracy)
    limit.Estimate(min(0.99, 0.2 + 0.8 * share) * LIMIT, failed=False)  # short of the limit
    assert limit.expected is None
    assert np.all(numpy(stepper.solver.gf) == before)
    assert stepper.load.Get() == pytest.approx(share * LIMIT, rel=1e-12)


def test_a_load_that_moves_nothing_has_no_limit():
    stepper = bar()
    stepper.Integrate(0.5 * LIMIT, steps=1, printing=False)
    limit = LimitLoad(stepper.solver, Parameter(0.0), 1.0)
    limit.Estimate(1.0, failed=False)
    assert limit.expected is None


def test_an_estimate_that_fails_tells_nothing_and_leaves_no_trace(monkeypatch):
    def Correction(*_):
        raise LinearSolveError("singular")

    stepper = bar()
    stepper.Integrate(0.5 * LIMIT, steps=1, printing=False)
    limit, before = LimitLoad(stepper.solver, stepper.load, 1.0), numpy(stepper.solver.gf)
    monkeypatch.setattr(stepper.solver.system, "Correction", Correction)
    limit.Estimate(2 * LIMIT, failed=False)
    assert not limit.suspected
    assert np.all(numpy(stepper.solver.gf) == before)
    assert stepper.load.Get() == 0.5 * LIMIT


def test_a_motion_that_pushes_nothing_has_no_limit():
    none = np.zeros(3)
    assert LimitLoad._Peak(None, none, none, np.ones(3)) == np.inf
