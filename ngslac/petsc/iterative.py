# SPDX-License-Identifier: LGPL-2.1-or-later
"""Condensed Newton systems by GMRES and multigrid."""

from functools import partial

import numpy as np
from ngsolve import CreateVVector

from ngslac._ngslac import GMRes, PreconditionedProduct
from ngslac.arrays import AsBits
from ngslac.errors import LinearSolveError
from ngslac.linear.refine import EXACT, Refine
from ngslac.petsc.condensation import CondensedSystem
from ngslac.petsc.library import Checked

__all__ = ["PetscIterative"]


class PetscIterative:
    """Solves one system after the other; collective."""

    best = 1e-12  # relative residual that GMRES can reach
    most, patience = 150, 60

    def __init__(self, numbering, mat, contact, preconditioner):
        self.numbering, self.krylov = numbering, 0
        self._system = CondensedSystem(numbering, mat, contact)
        self._preconditioner = preconditioner

    def Solve(self, b, accuracy):
        """The solution, a new vector, and its relative residual."""
        exact, size = max(accuracy, EXACT), b.norm()

        def Step(left):
            return self._Step(left, 0.9 * exact * size)

        def Residual(x):
            return self._system.Residual(b, x)

        return Refine(Step, Residual, b, exact=exact, norm=lambda vec: vec.norm())

    def _Step(self, b, residual):
        """A solution up to a residual, a new vector."""
        reduced = self._system.Reduce(b)
        size, w = reduced.norm(), b.duplicate()
        tol = min(max(residual / size, self.best), 0.1) if size else 1.0
        work = b.duplicate(), b.duplicate(), b.duplicate()
        product = PreconditionedProduct(
            b.local_size, partial(self._Apply, *work), self.numbering.Total
        )
        rhs, every = CreateVVector(b.local_size), AsBits(np.ones(b.local_size))
        rhs.FV().NumPy()[:] = reduced.array
        found, residuals, converged = GMRes(product, rhs, every, tol, self.most, self.patience)
        self.krylov += len(residuals) - 1
        if not converged:
            left = residuals[-1] / residuals[0]
            raise LinearSolveError(f"no convergence in {len(residuals) - 1} iterations: {left:.1e}")
        w.array[:] = found.FV().NumPy()
        return self._system.Expand(b, w)

    def _Apply(self, before, moved, product, x, z, image):
        """Fill arrays: z = M^-1 x and image = A z, with the work of three vectors."""
        before.array[:] = x
        with Checked():
            self._preconditioner.apply(before, moved)
        self._system.Mult(moved, product)
        z[:], image[:] = moved.array, product.array
