"""The linearized system of a converged state."""

import numpy as np
import pytest
from press import press

from ngslac.analysis.tangent import Tangent


def solved(**flags):
    problem = press(**flags)
    solver = problem.solver()
    solver.Solve(printing=False)
    return problem, solver


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("bulk", ["linear", "neo_hooke"])
def test_tangent_is_the_derivative_of_the_residual(dim, bulk):
    flags = {} if bulk == "linear" else {"finite": True, "nonlinear": True}
    problem, solver = solved(dim=dim, friction=0.1, **flags)
    tangent, vec = Tangent(solver), problem.gf.vec
    start, step = vec.FV().NumPy().copy(), 1e-6

    def Residual(values):
        vec.FV().NumPy()[:] = values
        force, pushed = vec.CreateVector(), vec.CreateVector()
        problem.a.Apply(vec, force)
        problem.contact.Follow(problem.gf)
        problem.contact.Apply(vec, pushed)
        return force.FV().NumPy() + pushed.FV().NumPy()

    move = tangent.scale * np.random.default_rng(3).normal(size=len(start)) * tangent.free
    change = (Residual(start + step * move) - Residual(start - step * move)) / (2 * step)
    expected = tangent.matrix @ move
    error, size = (np.abs(tangent.scale * force).max() for force in (change - expected, expected))
    assert error < (1e-5 if dim == 3 and flags else 1e-6) * size


def test_factors_solve_with_the_matrix_and_its_transpose():
    _, solver = solved(friction=0.1)
    tangent = Tangent(solver)
    factors, forces = tangent.Factors(), np.random.default_rng(5).normal(size=len(tangent.free))
    assert abs(tangent.matrix - tangent.matrix.T).max() > 1e-3  # something slips
    for transposed in (False, True):
        mat = tangent.matrix.T if transposed else tangent.matrix
        found = factors.Solve(forces, transposed=transposed)
        assert np.abs((mat @ found - forces)[tangent.free]).max() < 1e-9
        assert not np.any(found[~tangent.free])


def test_what_has_no_tangent_is_refused():
    problem = press()
    solver = problem.solver()
    with pytest.raises(ValueError, match="has not solved anything"):
        Tangent(solver)
    with pytest.raises(TypeError, match="solver"):
        Tangent(problem.gf)
    solver.Solve(printing=False)
    problem.gf.vec.FV().NumPy()[:] *= 1.1
    with pytest.raises(ValueError, match="has not converged"):
        Tangent(solver)
