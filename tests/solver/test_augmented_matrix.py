"""The matrix of the augmented Lagrangian solver: positive definite without friction, exact."""

import numpy as np
import pytest
from augmentedpress import assembled, augmented, scaled, solved
from press import mixed_press, mixed_press3d, numpy, press

from ngslac._ngslac import MergeMatrices
from ngslac.bodies.bodies import ToCSR

POSITIVE = {
    "2D": (mixed_press, {"friction": None}),
    "stick": (press, {"friction": 1.0}),
    "tied": (press, {"tied": True}),
    "3D": (mixed_press3d, {"friction": None, "n": (3, 2), "order": 1}),
}


@pytest.mark.parametrize("case", POSITIVE)
def test_matrix_is_symmetric_positive_definite(case):
    make, flags = POSITIVE[case]
    problem = make(**flags)
    solver = augmented(problem)
    factors = []

    def check(_):
        if not hasattr(solver, "scale") or solver.outer == 0:
            return
        mat = assembled(solver)
        assert np.abs(mat - mat.T).max() <= 1e-14 * np.abs(mat).max()
        np.linalg.cholesky(mat)
        factors.append(np.linalg.eigvalsh(mat)[0])

    solved(solver, callback=check)
    assert solver.history[-1].slip + solver.history[-1].stick > 0
    assert min(factors) > 0
    assert solver.linear.symmetric
    # that of ContactSolver is not
    form = problem.contact.form
    form.AssembleLinearization(problem.gf.vec)
    saddle = ToCSR(MergeMatrices(problem.a.mat, [form], solver.scale)).toarray()
    saddle = saddle[np.ix_(solver.linear.free, solver.linear.free)]
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.cholesky(saddle)


def test_friction_that_slips_is_not_symmetric():
    solver = solved(augmented(mixed_press()))
    mat = assembled(solver)
    assert np.abs(mat - mat.T).max() > 1e-3 * np.abs(mat).max()
    assert not solver.linear.symmetric


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("friction", [None, 0.3])
def test_matrix_is_the_derivative(finite, friction):
    problem = mixed_press(finite=finite, friction=friction, nonlinear=True)
    solver = solved(augmented(problem, augmentation=10.0))
    form, vec = problem.contact.form, problem.gf.vec
    values = vec.FV().NumPy()
    values[solver.residual.rows] *= 0.9  # the projection differs from the multipliers
    at = values.copy()
    random = np.random.default_rng(3).normal(size=len(at)) * ~solver.residual.rows

    def forces(shift):
        values[:] = at + shift * random
        problem.contact.Follow(problem.gf)  # the matrix sees where the faces of the master end
        residual = vec.CreateVector()
        residual[:] = 0
        form.BeginSolve()
        with scaled(form, 10.0):
            mat = form.AssembleAugmented(vec, residual)
        return mat, numpy(residual)

    mat, _ = forces(0.0)
    h = 1e-6 * np.abs(at).max()
    difference = (forces(h)[1] - forces(-h)[1]) / (2 * h)
    derivative = ToCSR(mat) @ random
    assert np.abs(derivative).max() > 0
    assert np.abs(difference - derivative).max() < 1e-6 * np.abs(derivative).max()


def test_forces_are_those_of_the_projected_multipliers():
    problem = mixed_press()
    solver = solved(augmented(problem))
    form, vec = problem.contact.form, problem.gf.vec
    vec.FV().NumPy()[solver.residual.rows] *= 0.9
    expected, residual = vec.CreateVector(), vec.CreateVector()
    expected[:], residual[:] = 0, 0
    form.BeginSolve()
    with scaled(form, 7.0):
        form.AssembleAugmented(vec, residual)
        form.UpdateMultipliers(vec)
    form.AddApply(vec, expected)
    displacements = ~solver.residual.rows
    assert numpy(residual)[displacements] == pytest.approx(
        numpy(expected)[displacements], abs=1e-14 * np.abs(numpy(expected)).max()
    )
    assert not np.any(numpy(residual)[solver.residual.rows])
