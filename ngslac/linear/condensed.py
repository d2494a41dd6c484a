"""Solution of the Newton system without multipliers, by a Krylov method."""

from dataclasses import dataclass

import numpy as np

from ngslac._ngslac import Condensation, GMRes
from ngslac.arrays import Multiply
from ngslac.linear.factor import IsSymmetric, LinearSolveError

__all__ = ["Condensed", "IsNear", "Krylov", "RightGMRes"]


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

    system = Condensation  # which variant
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
        self._kept = None

    def NewBulk(self):
        """The bulk matrix has got other values."""
        self._bulk_is_symmetric = None

    def Solve(self, mat, multipliers, b, accuracy):
        """x with mat x = b on the free dofs, and its relative residual: array and number.

        Parameters
        ----------
        mat : SparseMatrix
            Merged and scaled.
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
        given = mat, np.asarray(multipliers).tolist(), self.dim, self.bits
        system = self.system(*given)
        frictionless = system if self._IsSymmetric(system) else self._Frictionless(given)
        accuracy, size = self._Accuracy(accuracy), np.linalg.norm(b)
        x, left, error = np.zeros_like(b), b, 1.0
        best = x, error
        for _ in range(self.rounds if size else 0):
            x = x + self._Step(system, frictionless, left, 0.9 * accuracy * size)
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

    def _Frictionless(self, given):
        """The system in which slip is frictionless, if that serves and is symmetric."""
        variant = Condensation(*given, symmetric=True)
        return variant if self._IsSymmetric(variant) else None

    def _IsSymmetric(self, system):
        if not system.has_symmetric_contact:
            return False
        if self._bulk_is_symmetric is None:
            self._bulk_is_symmetric = IsSymmetric(system)
        return self._bulk_is_symmetric

    def _Step(self, system, frictionless, rhs, residual):
        """Solution of the whole system, up to a residual, from that of the condensed one."""
        reduced = system.CreateColVector()
        reduced.FV().NumPy()[:] = system.Reduce(rhs)
        size = reduced.Norm()
        tol = min(max(residual / size, self.best), 0.1) if size else 1.0
        for inverse, iterations in self._Preconditioners(system, frictionless, reduced):
            krylov, w = self._Iterate(system, frictionless, inverse, reduced, tol, iterations)
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
