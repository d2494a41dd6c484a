"""Solution of the Newton system without multipliers, by a Krylov method."""

from dataclasses import dataclass

import numpy as np
from ngsolve import BaseMatrix, Projector
from ngsolve.krylovspace import CGSolver, GMResSolver

from ngslac._ngslac import Condensation, TwoLevelProduct
from ngslac.preconditioner import (
    CHOLESKY,
    LU,
    Cholesky,
    Factor,
    IsSymmetric,
    LinearSolveError,
    OnVertices,
)

__all__ = ["DirectCondensed", "IterativeCondensed"]

# Systems to factor at once after a kept factorisation did not serve.
WAIT = 2


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
        system = Condensation(*given)
        frictionless = system if self._IsSymmetric(system) else self._Frictionless(given)
        accuracy, size = self._Accuracy(accuracy), np.linalg.norm(b)
        x, left, error = np.zeros_like(b), b, 1.0
        best = x, error
        product, factor = mat.CreateColVector(), mat.CreateRowVector()
        for _ in range(self.rounds if size else 0):
            x = x + self._Step(system, frictionless, left, 0.9 * accuracy * size)
            factor.FV().NumPy()[:] = x
            product.data = mat * factor
            left = (b - product.FV().NumPy()) * self.free
            error = float(np.linalg.norm(left)) / size
            if error < best[1]:  # not so where it is NaN
                best = x, error
            if not accuracy < error < np.inf:
                break
        return best if size else (x, 0.0)

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
            if not krylov.residuals or krylov.residuals[-1] <= tol * krylov.residuals[0]:
                return system.Expand(rhs, w.FV().NumPy())
        raise LinearSolveError("the condensed system could not be solved")


def _RightGMRes(product, inverse, rhs, freedofs, **options):
    """GMRES preconditioned from the right, so that it is the residual that gets small.

    `product` is the matrix times `inverse`. Returns the iteration, and the solution.
    """
    krylov = GMResSolver(mat=product, pre=Projector(freedofs, True), **options)
    return krylov, (inverse * krylov.Solve(rhs=rhs)).Evaluate()


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

    def _Frictionless(self, given):
        # In 2D LU costs less than Cholesky and the iterations with it.
        lu = self.inverse not in CHOLESKY if self.inverse else self.dim == 2
        return None if lu else super()._Frictionless(given)

    def _Preconditioners(self, system, frictionless, rhs):
        """Inverses to try, with the most iterations for each."""
        near = frictionless or system
        if self._kept is None or not IsNear(near, self._kept.system):
            if self._Serves(near):
                yield self._kept.inverse, self._kept.patience
                self._wait = WAIT
            self._Factor(system, frictionless, rhs)
        yield self._kept.inverse, self.most_iterations

    def _Iterate(self, system, frictionless, inverse, rhs, tol, iterations):
        if system is not frictionless:
            given = system @ inverse, inverse, rhs, system.freedofs
            return _RightGMRes(*given, tol=tol, maxiter=iterations)
        # Conjugate gradients look at another norm of the residual, whose size is adapted.
        krylov = CGSolver(mat=system, pre=inverse, tol=0.3 * tol, maxiter=iterations)
        return krylov, krylov.Solve(rhs=rhs)

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


class IterativeCondensed(Condensed):
    """With a two-level preconditioner, which needs little memory, made for each system.

    Slip is in it: a frictionless one costs up to twice the iterations.

    Parameters
    ----------
    freedofs, bits, dim, inverse :
        As above; the direct solver is for the vertices.
    coarse : BitArray
        Dofs of the vertices.
    """

    most_iterations = 250
    best = 1e-5  # in single precision; the rounds do the rest

    def __init__(self, freedofs, bits, dim, inverse, coarse):
        super().__init__(freedofs, bits, dim, inverse)
        self.coarse = coarse

    def _Accuracy(self, wanted):
        return max(wanted, self.exact)

    def _Frictionless(self, _):
        return None

    def _Preconditioners(self, system, symmetric, _):
        if self._kept is None or not IsNear(system, self._kept[0]):
            self._kept = None
            inverse = (Cholesky if symmetric else LU)(self.inverse)
            self._kept = system, OnVertices(system, self.coarse, inverse)
        yield self._kept[1], self.most_iterations

    def _Iterate(self, system, _, inverse, rhs, tol, iterations):
        given = TwoLevelProduct(inverse), inverse, rhs, system.freedofs
        return _RightGMRes(*given, tol=tol, maxiter=iterations)
