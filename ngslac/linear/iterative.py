# SPDX-License-Identifier: LGPL-2.1-or-later
"""Condensed Newton systems by a preconditioned iteration, which needs little memory."""

import numpy as np

from ngslac._ngslac import (
    OrthogonalCondensation,
    PreconditionedProduct,
    TwoLevel,
    TwoLevelProduct,
)
from ngslac.linear.condensed import Condensed, RightGMRes

__all__ = ["IterativeCondensed"]

# Residual of a round, in units of what was asked for, that rounding errors have left.
ROUGH = 5
# Iterations that have to halve the residual: else it stalls.
PATIENCE = 60


class IterativeCondensed(Condensed):
    """With multigrid, which needs little memory, made for each system.

    Slip is in it: a frictionless one costs up to twice the iterations.

    Parameters
    ----------
    freedofs, bits, dim, inverse :
        As above.
    multigrid : Multigrid
    preconditioner : callable, optional
        Takes the place of the multigrid method: see ContactSolver.
    """

    most_iterations = 250
    single = 1e-5  # relative residual that products in single precision reach

    def __init__(self, freedofs, bits, dim, inverse, multigrid, preconditioner=None):
        self.multigrid, self.preconditioner = multigrid, preconditioner
        super().__init__(freedofs, bits, dim, inverse)
        self._rounds_off = False  # are products in single precision too rough?

    def Forget(self):
        """Keep no preconditioner for the next system."""
        super().Forget()
        if self.multigrid:
            self.multigrid.Forget()

    def NewBulk(self):
        """The bulk matrix has got other values."""
        super().NewBulk()
        if self.multigrid:
            self.multigrid.Forget()

    def NewMatrix(self):
        """The merged matrix has got other values."""
        super().NewMatrix()
        self._kept = None

    def _Accuracy(self, wanted):
        return max(wanted, self.exact)

    def _Learn(self, error, accuracy):
        if error > ROUGH * accuracy:
            self._rounds_off = True

    def _Systems(self, *given):
        return (OrthogonalCondensation(*given),)

    def _Preconditioners(self, _, system):
        if self._kept is None:
            self._kept = self._Make(system)
        yield self._kept[0], self.most_iterations
        if self.preconditioner is None and not self.multigrid.learnt:
            self.multigrid.Relearn()
            self._kept = None
            self._kept = self._Make(system)
            yield self._kept[0], self.most_iterations
        if not self._rounds_off and self._IsOwn(self._kept[0]):
            self._rounds_off = True  # a stiff body is moved far by what is next to nothing
            yield self._kept[0], self.most_iterations

    def _Make(self, system):
        """The preconditioner, and what has to live as long."""
        if self.preconditioner is None:
            return self.multigrid.Preconditioner(system, self.scale), None
        mat = system.Part()
        inverse = self.preconditioner(mat, system.freedofs)
        if getattr(inverse, "shape", None) != mat.shape:
            raise ValueError(
                f"preconditioner= returned {inverse}, not an operator of the size {mat.shape}"
            )
        return inverse, mat

    @staticmethod
    def _IsOwn(inverse):
        """Has it products with the system of its own?"""
        return isinstance(inverse, TwoLevel)

    def _Iterate(self, inverse, rhs, tol, iterations, system):
        own = self._IsOwn(inverse)
        fused = own and tol >= self.single and not self._rounds_off
        product = (
            TwoLevelProduct(inverse, system) if fused else PreconditionedProduct(system, inverse)
        )
        limits = {"tol": tol, "maxiter": iterations, "patience": PATIENCE}
        krylov, solution = RightGMRes(product, rhs, system.freedofs, **limits)
        if own:
            self.multigrid.Watch(krylov.iterations / -np.log10(tol))
        return krylov, solution
