"""What the tests of the augmented Lagrangian solver share."""

from contextlib import contextmanager

import numpy as np
from press import numpy

from ngslac._ngslac import MergeMatrices
from ngslac.bodies.bodies import ToCSR
from ngslac.solve.augmented import AugmentedLagrangianSolver


def augmented(problem, **flags):
    return AugmentedLagrangianSolver(problem.a, problem.gf, problem.contact, **flags)


def solved(solver, **flags):
    solver.Solve(printing=False, **flags)
    return solver


def same(gf, other, tolerance=1e-9):
    """Displacements and tractions agree, each in its own size."""
    for one, two in zip(gf.components, other.components, strict=True):
        expected = numpy(two)
        assert np.abs(numpy(one) - expected).max() < tolerance * np.abs(expected).max()


@contextmanager
def scaled(form, factor):
    """The form with another c."""
    history = form.History()
    form.SetHistory(history | {"c": factor * history["c"]})
    yield form
    form.SetHistory(history)


def assembled(solver):
    """The scaled matrix at gf, on the free displacements."""
    vec = solver.gf.vec
    residual = vec.CreateVector()
    residual[:] = 0
    merged = ToCSR(MergeMatrices(solver.a.mat, [], np.ones_like(solver.scale))).toarray()
    for contact in solver.contacts:
        with scaled(contact.form, solver.factor) as form:
            merged += ToCSR(form.AssembleAugmented(vec, residual)).toarray()
    free = solver.linear.free & ~solver.residual.rows
    return (solver.scale[:, None] * merged * solver.scale)[np.ix_(free, free)]
