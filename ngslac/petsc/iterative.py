# SPDX-License-Identifier: LGPL-2.1-or-later
"""Condensed Newton systems by FGMRES and multigrid."""

from ngslac.linear.factor import LinearSolveError
from ngslac.linear.refine import EXACT, Refine
from ngslac.petsc.condensation import CondensedSystem
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
    contact : LocalContact or None
    preconditioner : PETSc.PC

    Attributes
    ----------
    krylov : int
        Iterations so far.
    """

    best = 1e-12  # relative residual that FGMRES can reach
    most, patience = 150, 60

    def __init__(self, numbering, mat, contact, preconditioner):
        self.numbering, self.krylov = numbering, 0
        self._system = CondensedSystem(numbering, mat, contact)
        self._preconditioner = preconditioner

    def Solve(self, b, accuracy):
        """The solution, a new vector, and its relative residual.

        Raises
        ------
        LinearSolveError
            On all ranks: no convergence.
        """
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
        limits = {"tol": tol, "most": self.most, "patience": self.patience}
        steps = self._system.Mult, self._Precondition
        iteration = FGMRES(*steps, reduced, w, self.numbering.Total, **limits)
        self.krylov += iteration.number
        if not iteration.residual <= tol:
            raise LinearSolveError(
                f"no convergence in {iteration.number} iterations: {iteration.residual:.1e}"
            )
        return self._system.Expand(b, w)

    def _Precondition(self, r, z):
        with Checked():
            self._preconditioner.apply(r, z)
