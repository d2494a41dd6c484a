# SPDX-License-Identifier: LGPL-2.1-or-later
"""Newton systems without multipliers by a preconditioned iteration, which needs little memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from ngslac._ngslac import (
    Condensation,
    GMRes,
    PreconditionedProduct,
    TwoLevel,
    TwoLevelProduct,
)
from ngslac.arrays import Multiply
from ngslac.errors import LinearSolveError
from ngslac.linear.refine import EXACT, Refine
from ngslac.linear.system import LinearSystem, Method

if TYPE_CHECKING:
    from ngsolve import BaseMatrix, BaseVector, BitArray

    from ngslac.linear.multigrid import Multigrid

__all__ = ["Iterative"]

# Residual of a round, in units of what was asked for, that rounding errors have left.
ROUGH = 5
# Most iterations; those that have to halve the residual: else it stalls.
MOST, PATIENCE = 250, 60
# Relative residuals that a Krylov method, and products in single precision, can reach.
BEST, SINGLE = 1e-14, 1e-5


class Iterative(Method):
    """Eliminates multipliers, and iterates by GMRES with multigrid, made for each system.

    What is left (``Z^T K Z`` with the columns Z of the displacements that keep the constraints) is
    symmetric and positive definite where the bulk is, as long as nothing slips. Slip is in it: a
    frictionless one costs up to twice the iterations.
    """

    is_iteration = True

    def __init__(
        self,
        dim: int,
        multigrid: Multigrid,
        preconditioner: Callable[[BaseMatrix, BitArray], BaseMatrix] | None = None,
    ):
        self.dim, self.multigrid, self.preconditioner = dim, multigrid, preconditioner
        self.krylov, self._single = 0, True  # do products in single precision serve?
        self.NewBulk()

    def __str__(self) -> str:
        return "iterative, " + ("as given" if self.preconditioner else "multigrid")

    def NewBulk(self) -> None:
        """The bulk matrix has got other values."""
        self._number = self._condensed = self._inverse = None
        if self.multigrid:
            self.multigrid.Forget()

    def Solve(self, system: LinearSystem, b: np.ndarray) -> tuple[np.ndarray, float]:
        """See Method."""
        mat, free = system.matrix, system.free
        if self._number != system.number:
            self._number = self._inverse = None
            dofs = np.asarray(system.multipliers).tolist()
            self._condensed = Condensation(mat, dofs, self.dim, system.bits)
            self._number = system.number
        exact, size = max(system.accuracy, EXACT), np.linalg.norm(b)

        def Residual(x: np.ndarray) -> np.ndarray:
            left = (b - Multiply([mat], x)) * free
            if np.linalg.norm(left) > ROUGH * exact * size:
                self._single = False
            return left

        def Step(left: np.ndarray) -> np.ndarray:
            return self._Step(left, 0.9 * exact * size, system.scale)

        return Refine(Step, Residual, b, exact=exact)

    def _Step(self, rhs: np.ndarray, residual: float, scale: np.ndarray) -> np.ndarray:
        """Solution of the whole system, up to a residual, from that of the condensed one."""
        system = self._condensed
        u = system.Displacements(rhs, 0 * rhs)
        reduced = system.CreateColVector()
        reduced.FV().NumPy()[:] = system.Reduce(rhs, u)
        size = reduced.Norm()
        tol = min(max(residual / size, BEST), 0.1) if size else 1.0
        for inverse in self._Preconditioners(scale):
            found, converged = self._Iterate(inverse, reduced, tol)
            if converged:
                u = system.Displacements(rhs, found.FV().NumPy())
                return system.Complete(rhs, u)
        raise LinearSolveError("the condensed system could not be solved")

    def _Preconditioners(self, scale: np.ndarray) -> Iterator[BaseMatrix]:
        """The one at hand, then others, where the iteration fails with those before."""
        if self._inverse is None:
            self._Make(scale)
        yield self._inverse
        if self.preconditioner is None and not self.multigrid.learnt:
            self.multigrid.Relearn()
            self._inverse = None
            self._Make(scale)
            yield self._inverse
        if self._single and isinstance(self._inverse, TwoLevel):
            self._single = False  # a stiff body is moved far by what is next to nothing
            yield self._inverse

    def _Make(self, scale: np.ndarray) -> None:
        """Make the preconditioner, and keep what has to live as long."""
        system = self._condensed
        if self.preconditioner is None:
            self._inverse = self.multigrid.Preconditioner(system, scale)
            return
        self._part = system.Part(np.arange(system.height))
        inverse = self.preconditioner(self._part, system.freedofs)
        if getattr(inverse, "shape", None) != self._part.shape:
            raise ValueError(
                f"preconditioner= returned {inverse}, not an operator of the size "
                f"{self._part.shape}"
            )
        self._inverse = inverse

    def _Iterate(self, inverse: BaseMatrix, rhs: BaseVector, tol: float) -> tuple[BaseVector, bool]:
        """A solution of the condensed system, preconditioned from the right, and is it one?"""
        system, own = self._condensed, isinstance(inverse, TwoLevel)
        fused = own and tol >= SINGLE and self._single
        product = (
            TwoLevelProduct(inverse, system) if fused else PreconditionedProduct(system, inverse)
        )
        found, residuals, converged = GMRes(product, rhs, system.freedofs, tol, MOST, PATIENCE)
        self.krylov += len(residuals) - 1
        if own:
            self.multigrid.Watch((len(residuals) - 1) / -np.log10(tol))
        return found, converged
