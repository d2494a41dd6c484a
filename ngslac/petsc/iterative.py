# SPDX-License-Identifier: LGPL-2.1-or-later
"""Condensed Newton systems by FGMRES and multigrid."""

import numpy as np

from ngslac.linear.factor import LinearSolveError
from ngslac.petsc.condensed import CondensedSystem
from ngslac.petsc.fgmres import FGMRES
from ngslac.petsc.library import Checked

__all__ = ["PetscIterative"]


class PetscIterative:
    """Solves one system after the other; collective.

    Parameters
    ----------
    numbering : Numbering
    mat : PETSc.Mat
        Of bulk and terms, see CondensedSystem.
    contact : LocalContact or NoContact
    preconditioner : PETSc.PC

    Attributes
    ----------
    krylov : int
        Iterations so far.
    """

    rounds = 3
    exact = 1e-13  # where nothing less is asked for
    best = 1e-12  # relative residual that FGMRES can reach
    most, patience = 150, 60

    def __init__(self, numbering, mat, contact, preconditioner):
        self.numbering, self.krylov = numbering, 0
        self._system = CondensedSystem(numbering, mat, contact)
        self._preconditioner = preconditioner

    def Solve(self, b, x, accuracy):
        """Put the solution into x; returns its relative residual.

        Raises
        ------
        LinearSolveError
            On all ranks: no convergence.
        """
        accuracy, size = max(accuracy, self.exact), b.norm()
        x.set(0)
        left, error = b, 1.0
        best, found = (np.inf, None), x.duplicate()
        found.set(0)
        for _ in range(self.rounds if size else 0):
            step, left = self._Step(left, 0.9 * accuracy * size)
            found.axpy(1.0, step)
            error = left.norm() / size
            if error < best[0]:
                best = error, found.copy()
            if not accuracy < error < np.inf:
                break
        if best[1] is not None:
            best[1].copy(x)
        return best[0] if size else 0.0

    def _Step(self, b, residual):
        """A solution up to a residual, and what is left: new vectors."""
        reduced = self._system.Reduce(b)
        size, w = reduced.norm(), b.duplicate()
        tol = min(max(residual / size, self.best), 0.1) if size else 1.0
        limits = {"tol": tol, "most": self.most, "patience": self.patience}
        given = reduced, w, self.numbering.Total
        iteration = FGMRES(self._system.Mult, self._Precondition, *given, **limits)
        self.krylov += iteration.number
        if not iteration.residual <= tol:
            raise LinearSolveError(
                f"no convergence in {iteration.number} iterations: {iteration.residual:.1e}"
            )
        return self._system.Expand(b, w)

    def _Precondition(self, r, z):
        with Checked():
            self._preconditioner.apply(r, z)
