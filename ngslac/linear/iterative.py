"""Condensed Newton systems by a preconditioned iteration, which needs little memory."""

from ngslac._ngslac import TwoLevel, TwoLevelProduct
from ngslac.linear.condensed import Condensed, IsNear, RightGMRes
from ngslac.linear.factor import LU, Cholesky, OnVertices

__all__ = ["IterativeCondensed"]


class IterativeCondensed(Condensed):
    """With a two-level preconditioner, which needs little memory, made for each system.

    Slip is in it: a frictionless one costs up to twice the iterations.

    Parameters
    ----------
    freedofs, bits, dim, inverse :
        As above; the direct solver is for the vertices.
    coarse : BitArray
        Dofs of the vertices.
    preconditioner : callable, optional
        Takes the place of the two levels: see ContactSolver.
    """

    most_iterations = 250
    best = 1e-5  # in single precision; the rounds do the rest

    def __init__(self, freedofs, bits, dim, inverse, coarse, preconditioner=None):
        super().__init__(freedofs, bits, dim, inverse)
        self.coarse, self.preconditioner = coarse, preconditioner

    def _Accuracy(self, wanted):
        return max(wanted, self.exact)

    def _Frictionless(self, _):
        return None

    def _Preconditioners(self, system, symmetric, _):
        if self._kept is None or not IsNear(system, self._kept[0]):
            self._kept = None
            self._kept = system, *self._Make(system, symmetric)
        yield self._kept[1], self.most_iterations

    def _Make(self, system, symmetric):
        """The preconditioner, and what has to live as long."""
        if self.preconditioner is None:
            inverse = (Cholesky if symmetric else LU)(self.inverse)
            return OnVertices(system, self.coarse, inverse), None
        mat = system.Part()
        inverse = self.preconditioner(mat, system.freedofs)
        if getattr(inverse, "shape", None) != mat.shape:
            raise ValueError(
                f"preconditioner= returned {inverse}, not an operator of the size {mat.shape}"
            )
        return inverse, mat

    def _Iterate(self, system, _, inverse, rhs, tol, iterations):
        own = isinstance(inverse, TwoLevel)
        product = TwoLevelProduct(inverse) if own else system @ inverse
        given = product, inverse, rhs, system.freedofs
        return RightGMRes(*given, tol=tol, maxiter=iterations)
