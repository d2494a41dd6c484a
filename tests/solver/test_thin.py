"""Thin plates in bending, whose contact status Newton's method finds at one end after the other."""

import numpy as np
import pytest
from plates import plates
from press import numpy, same, solved

from ngslac import LoadStepper

MOST = 32  # Newton steps: no other method, no cut


@pytest.mark.parametrize(
    ("kind", "friction", "both"), [("tet", None, False), ("tet", 0.3, True), ("hex", None, True)]
)
def test_plates_over_each_other(kind, friction, both):
    """One is bent by the other, without a gap: less load has the same iterations."""
    problem = plates(kind, friction=friction, both=both, n=(8, 9))
    problem.load.Set(0.0)
    solver = problem.solver()
    (step,) = LoadStepper(solver, problem.load).Integrate(1.0, steps=1, printing=False)
    assert step.cuts == 0
    assert step.iterations <= MOST
    assert solver.system.islinear
    table = problem.contact.Table()
    assert 0 < np.sum(table["status"] > 0) < len(table["status"])
    assert np.min(table["pressure"]) >= -1e-9 * np.max(table["pressure"])
    assert np.all(table["gap"] > -1e-9)


def test_iterative_and_direct_agree_on_plates():
    one, other = plates(n=(6, 7)), plates(n=(6, 7))
    for problem, method in ((one, "iterative"), (other, "direct")):
        assert solved(problem, solver=method).linear.method == method
    same(one, other, 1e-7)


def test_a_start_far_away_leaves_no_rounding_errors_behind():
    """Products with the matrix go on from a residual that a large displacement spoils."""
    problem = plates(n=(8, 9))
    solver = solved(problem)
    expected, residual = numpy(problem.gf), solver.system.residual
    far = 1e6 * expected * ~residual.multipliers
    problem.gf.vec.FV().NumPy()[:] += far
    residual.Measure(solver.system.scale, exact=True)
    problem.gf.vec.FV().NumPy()[:] = expected
    state = residual.Measure(solver.system.scale)
    assert state.exact
    assert state.equilibrium < 1e-10
