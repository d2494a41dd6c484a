# SPDX-License-Identifier: LGPL-2.1-or-later
"""Factorisation of the whole system by MUMPS."""

import numpy as np

from ngslac.linear.factor import LinearSolveError
from ngslac.petsc.library import Checked, LoadPETSc

__all__ = ["PetscDirect"]

# Per cent of memory beyond the estimate: where pivoting needs more there is another try.
ROOM = (30, 100, 400)
OUT_OF_ROOM = (-8, -9, -14, -15, -17, -20)
SYMMETRIC = 1e-13


class PetscDirect:
    """Solves by L D L^T or L U with pivoting, and refines.

    Attributes
    ----------
    factorisations : int
    mat : PETSc.Mat or None
    """

    refinements = 4
    exact = 1e-14  # relative residual that is enough
    small = 1e-9  # that which symmetric factors have to reach, or else LU takes over

    def __init__(self):
        self.factorisations = 0
        self.Forget()

    def Forget(self):
        """Keep no factors."""
        self.mat = self._factors = self._symmetric = None

    def Take(self, mat):
        """Another matrix."""
        self.Forget()
        self.mat = mat

    def Solve(self, b, x):
        """Put the solution into x; returns its relative residual.

        Raises
        ------
        LinearSolveError
            The matrix is singular, or memory does not suffice.
        """
        size = b.norm()
        x.set(0)
        if size == 0:
            return 0.0
        if self._symmetric is None:
            self._symmetric = IsSymmetric(self.mat)
        if self._symmetric:
            error = self._Try("cholesky", b, x)
            if error <= self.small * size:
                return error / size
            self._symmetric, self._factors = False, None
        error = self._Try("lu", b, x)
        if not np.isfinite(error):
            raise LinearSolveError("MUMPS: the matrix is singular")
        return error / size

    def _Try(self, kind, b, x):
        """Norm of the residual with one kind of factors; infinity if there are none."""
        try:
            if self._factors is None:
                self._factors = self._Factor(kind)
        except LinearSolveError:
            if kind == "lu":
                raise
            return np.inf
        return self._Refined(b, x)

    def _Refined(self, b, x):
        size, left, step = b.norm(), b.copy(), b.duplicate()
        best, found = np.inf, x.duplicate()
        found.set(0)
        for _ in range(self.refinements):
            self._factors.apply(left, step)
            found.axpy(1.0, step)
            self.mat.mult(found, left)
            left.aypx(-1.0, b)
            before, error = best, left.norm()
            if not error < before:  # no better, or NaN
                break
            found.copy(x)
            best = error
            if error <= self.exact * size or error > 0.5 * before:
                break
        return best

    def _Factor(self, kind):
        """Factors of MUMPS; collective errors, as its codes are those of all ranks."""
        for room in ROOM:
            self.factorisations += 1
            factors, info = MUMPS(self.mat, kind, room)
            if info == 0:
                return factors
            if info not in OUT_OF_ROOM:
                break
        raise LinearSolveError(f"MUMPS ended with error {info}")


def MUMPS(mat, kind, room):
    """Factors as PETSc.PC, and INFOG(1)."""
    PETSc = LoadPETSc()
    mat.setOption(PETSc.Mat.Option.SYMMETRIC, kind == "cholesky")
    pc = PETSc.PC().create(mat.comm)
    pc.setOperators(mat)
    pc.setType(kind)
    pc.setFactorSolverType("mumps")
    pc.setFactorSetUpSolverType()
    factors = pc.getFactorMatrix()
    factors.setMumpsIcntl(14, room)
    factors.setMumpsIcntl(24, 0)
    with Checked():
        pc.setUp()
    return pc, min(factors.getMumpsInfog(1), 0)


def IsSymmetric(mat):
    """Is x.Ay = y.Ax for two random vectors, to rounding? The same answer on all ranks."""
    x, y, image = (mat.createVecRight() for _ in range(3))
    start = mat.getOwnershipRange()[0]
    for vec, seed in ((x, 0.6), (y, 1.7)):
        vec.array[:] = np.sin(seed * np.arange(start, start + vec.local_size) ** 1.3)
    mat.mult(y, image)
    product, size = x.dot(image), x.norm() * image.norm()
    mat.mult(x, image)
    return abs(y.dot(image) - product) <= SYMMETRIC * size
