# SPDX-License-Identifier: LGPL-2.1-or-later
"""Condensed Newton systems by sparse factorisations, which are kept while they serve."""

from dataclasses import dataclass

import numpy as np
from ngsolve import BaseMatrix
from ngsolve.krylovspace import CGSolver

from ngslac._ngslac import Condensation, PreconditionedProduct
from ngslac.linear.condensed import Condensed, Krylov, RightGMRes
from ngslac.linear.factor import CHOLESKY, LU, Cholesky, Factor, IsSymmetric, LinearSolveError

__all__ = ["DirectCondensed"]

# Systems to factor at once after a kept factorisation did not serve.
WAIT = 2


@dataclass
class Kept:
    """A factorisation that may serve for later matrices.

    Attributes
    ----------
    inverse : BaseMatrix
    mat : BaseMatrix
        Whose factorisation it is; keeps it alive.
    system : Condensation
        Whose matrix that is.
    patience : int
        Krylov iterations that cost half as much as another factorisation.
    """

    inverse: BaseMatrix
    mat: BaseMatrix
    system: Condensation
    patience: int


def Patience(count, dim):
    """Krylov iterations that cost about half as much as a factorisation with `count` free dofs.

    The ratio grows like n^(2/3) in 3D and n^(1/2) in 2D (nested dissection). A rule that looked at
    the clock would give other results each time.
    """
    ratio = 35 * (count / 1e5) ** (2 / 3) if dim == 3 else 12 * (count / 1e5) ** 0.5
    return int(np.clip(0.5 * ratio, 4, 40))


class DirectCondensed(Condensed):
    """With a sparse factorisation, kept for later systems while few macro-elements change.

    With slip that of the system in which slip is frictionless preconditions GMRES.

    Each macro-element that opens or closes costs about two Krylov iterations per direction; where
    these would cost more than half of a factorisation the new matrix is factored.
    """

    most_iterations = 60

    def Forget(self):
        """Keep no factorisation for the next system."""
        super().Forget()
        self._wait = 0

    def _Accuracy(self, _):
        return self.exact

    def NewBulk(self):
        """The bulk matrix has got other values."""
        super().NewBulk()
        self._bulk_is_symmetric = None

    def _Systems(self, *given):
        """The system, and that in which slip is frictionless if this serves and is symmetric."""
        system = Condensation(*given)
        # In 2D LU costs less than Cholesky and the iterations with it.
        lu = self.inverse not in CHOLESKY if self.inverse else self.dim == 2
        if self._IsSymmetric(system):
            return system, system
        frictionless = None if lu else Condensation(*given, symmetric=True)
        return system, frictionless if frictionless and self._IsSymmetric(frictionless) else None

    def _IsSymmetric(self, system):
        if not system.has_symmetric_contact:
            return False
        if self._bulk_is_symmetric is None:
            self._bulk_is_symmetric = IsSymmetric(system)
        return self._bulk_is_symmetric

    def _Preconditioners(self, rhs, system, frictionless):
        """Inverses to try, with the most iterations for each."""
        near = frictionless or system
        if self._kept is None or not IsNear(near, self._kept.system):
            if self._Serves(near):
                yield self._kept.inverse, self._kept.patience
                self._wait = WAIT
            self._Factor(system, frictionless, rhs)
        yield self._kept.inverse, self.most_iterations

    def _Iterate(self, inverse, rhs, tol, iterations, system, frictionless):
        if system is not frictionless:
            product = PreconditionedProduct(system, inverse)
            return RightGMRes(product, rhs, system.freedofs, tol=tol, maxiter=iterations)
        # Conjugate gradients look at another norm of the residual, whose size is adapted.
        krylov = CGSolver(mat=system, pre=inverse, tol=0.3 * tol, maxiter=iterations)
        solution = krylov.Solve(rhs=rhs)
        return Krylov(krylov.iterations, krylov.iterations < iterations), solution

    def _Serves(self, near):
        if self._wait:
            self._wait -= 1
            return False
        if self._kept is None or self._kept.system.height != near.height:
            return False
        changes = np.abs(self._kept.system.constraints - near.constraints).sum()
        return 4 * changes <= self._kept.patience

    def _Factor(self, system, frictionless, rhs):
        self._kept = None  # two of them would need twice the memory
        lu = self.inverse and self.inverse not in CHOLESKY
        symmetric = frictionless is not None and not lu
        near = frictionless if symmetric else system
        solver = (Cholesky if symmetric else LU)(self.inverse)
        mat = near.Part()
        inverse = Factor(mat, near.freedofs, solver)
        self.factorisations += 1
        if not np.isfinite((inverse * rhs).Evaluate().Norm()):
            raise LinearSolveError("the matrix is singular")
        self._kept = Kept(inverse, mat, near, Patience(int(self.free.sum()), self.dim))


def IsNear(system, other):
    """Do two systems differ by rounding only? Told by the images of a random vector."""
    if system is other or system.height != other.height:
        return system is other
    if np.any(system.constraints != other.constraints):
        return False
    x = system.CreateRowVector()
    x.FV().NumPy()[:] = np.random.default_rng(2).standard_normal(system.height)
    image = (system * x).Evaluate()
    return (image - other * x).Evaluate().Norm() <= 1e-10 * image.Norm()
