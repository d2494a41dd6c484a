# SPDX-License-Identifier: LGPL-2.1-or-later
"""Solution of the Newton system without multipliers, by a Krylov method."""

from dataclasses import dataclass

import numpy as np

from ngslac._ngslac import GMRes
from ngslac.arrays import Multiply
from ngslac.linear.factor import LinearSolveError

__all__ = ["Condensed", "Krylov", "RightGMRes"]


@dataclass(frozen=True)
class Krylov:
    """What an iteration came to.

    Attributes
    ----------
    iterations : int
    converged : bool
    """

    iterations: int
    converged: bool


class Condensed:
    """Solves merged Newton systems by eliminating multipliers and one inner node of each.

    What is left (``Z^T K Z`` with the columns Z of the displacements that keep the constraints) is
    symmetric and positive definite where the bulk is, as long as nothing slips. Slip makes it
    unsymmetric, which takes GMRES.

    Parameters
    ----------
    freedofs : (n,) bool
        Scalar dofs of the whole system.
    bits : BitArray
        The same.
    dim : int
        Of the mesh.
    inverse : str, optional
        Sparse direct solver.

    Attributes
    ----------
    factorisations, krylov : int
        Of matrices of full size, and iterations, since this was made.
    """

    rounds = 3
    exact = 1e-13  # where nothing less is asked for
    best = 1e-14  # relative residual that a Krylov method can reach

    def __init__(self, freedofs, bits, dim, inverse=None):
        self.free, self.bits, self.dim, self.inverse = freedofs, bits, dim, inverse
        self.factorisations = self.krylov = 0
        self.scale = None  # of the system, set by who has it
        self.NewBulk()
        self.Forget()

    def Forget(self):
        """Keep no factorisation for the next system."""
        self._kept = self._systems = None

    def NewBulk(self):
        """The bulk matrix has got other values."""
        self.NewMatrix()

    def NewMatrix(self):
        """The merged matrix has got other values."""
        self._systems = None

    def Solve(self, mat, multipliers, b, accuracy):
        """x with mat x = b on the free dofs, and its relative residual: array and number.

        Parameters
        ----------
        mat : SparseMatrix
            Merged and scaled; that of the last call if `NewMatrix` was not called.
        multipliers : (n,) int
            Their dofs, d per macro-element.
        b : (n,)
            Zero where nothing is free.
        accuracy : float
            Relative residual that is enough for an iterative solution.

        Raises
        ------
        NgException
            A macro-element has no displacement of its own.
        LinearSolveError
            The matrix is singular, or the iteration does not converge.
        """
        if self._systems is None:
            multipliers = np.asarray(multipliers).tolist()
            self._systems = self._Systems(mat, multipliers, self.dim, self.bits)
        accuracy, size = self._Accuracy(accuracy), np.linalg.norm(b)
        x, left, error = np.zeros_like(b), b, 1.0
        best = x, error
        for _ in range(self.rounds if size else 0):
            x = x + self._Step(left, 0.9 * accuracy * size)
            left = (b - Multiply([mat], x)) * self.free
            error = float(np.linalg.norm(left)) / size
            self._Learn(error, accuracy)
            if error < best[1]:  # not so where it is NaN
                best = x, error
            if not accuracy < error < np.inf:
                break
        return best if size else (x, 0.0)

    def _Learn(self, error, accuracy):
        """See what a round came to that was to reach an accuracy."""

    def _Step(self, rhs, residual):
        """Solution of the whole system, up to a residual, from that of the first condensed one."""
        system = self._systems[0]
        reduced = system.CreateColVector()
        reduced.FV().NumPy()[:] = system.Reduce(rhs)
        size = reduced.Norm()
        tol = min(max(residual / size, self.best), 0.1) if size else 1.0
        for inverse, iterations in self._Preconditioners(reduced, *self._systems):
            krylov, w = self._Iterate(inverse, reduced, tol, iterations, *self._systems)
            self.krylov += krylov.iterations
            if krylov.converged:
                return system.Expand(rhs, w.FV().NumPy())
        raise LinearSolveError("the condensed system could not be solved")


def RightGMRes(product, rhs, freedofs, *, tol, maxiter, patience=0):
    """GMRES preconditioned from the right, so that it is the residual that gets small.

    Parameters
    ----------
    product : PreconditionedProduct
        Its preconditioner may be rougher than the solution: preconditioned vectors are kept.
    patience : int
        If not 0, it ends where so many products do not halve the residual.

    Returns
    -------
    Krylov, BaseVector
        The iteration, and the solution.
    """
    found, residuals, converged = GMRes(product, rhs, freedofs, tol, maxiter, patience)
    return Krylov(len(residuals) - 1, converged), found
