# SPDX-License-Identifier: LGPL-2.1-or-later
"""Factorisation of the whole system by MUMPS."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ngslac.errors import LinearSolveError
from ngslac.linear.factor import HasEqualWorks
from ngslac.linear.refine import Refine
from ngslac.petsc.library import Checked, LoadPETSc

if TYPE_CHECKING:
    from petsc4py import PETSc

    from ngslac.petsc.numbering import Numbering

__all__ = ["PetscDirect"]

# Per cent of memory beyond the estimate: where pivoting needs more there is another try.
ROOM = (30, 100, 400)
OUT_OF_ROOM = (-8, -9, -14, -15, -17, -20)


class PetscDirect:
    """Solves by L D L^T or L U with pivoting, and refines."""

    small = 1e-9  # residual that symmetric factors have to reach, or else LU takes over

    def __init__(self, numbering: Numbering):
        self.factorisations, self._total = 0, lambda part: numbering.Total(np.array([part]))[0]
        self.Forget()

    def Forget(self) -> None:
        """Keep no factors."""
        self.mat = self._factors = self._symmetric = None

    def Take(self, mat: PETSc.Mat) -> None:
        """Another matrix."""
        self.Forget()
        self.mat = mat

    def Solve(self, b: PETSc.Vec) -> tuple[PETSc.Vec, float]:
        """The solution, a new vector, and its relative residual."""
        if self._symmetric is None:
            self._symmetric = IsSymmetric(self.mat, self._total)
        if self._symmetric:
            x, error = self._Try("cholesky", b)
            if error <= self.small:
                return x, error
            self._symmetric, self._factors = False, None
        x, error = self._Try("lu", b)
        if not error < 1:
            raise LinearSolveError("MUMPS: the matrix is singular")
        return x, error

    def _Try(self, kind: str, b: PETSc.Vec) -> tuple[PETSc.Vec, float]:
        """Solution by one kind of factors, and its relative residual; infinity without any."""
        try:
            if self._factors is None:
                self._factors = self._Factor(kind)
        except LinearSolveError:
            if kind == "lu":
                raise
            return b, np.inf

        def Step(left: PETSc.Vec) -> PETSc.Vec:
            step = left.duplicate()
            self._factors.apply(left, step)
            return step

        return Refine(Step, lambda x: b - self.mat * x, b, norm=lambda vec: vec.norm())

    def _Factor(self, kind: str) -> PETSc.PC:
        """Factors of MUMPS; collective errors, as its codes are those of all ranks."""
        for room in ROOM:
            self.factorisations += 1
            factors, info = MUMPS(self.mat, kind, room)
            if info == 0:
                return factors
            if info not in OUT_OF_ROOM:
                break
        raise LinearSolveError(f"MUMPS ended with error {info}")


def MUMPS(mat: PETSc.Mat, kind: str, room: int) -> tuple[PETSc.PC, int]:
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


def IsSymmetric(mat: PETSc.Mat, total: Callable[[float], float]) -> bool:
    """Is a matrix symmetric? The same answer on all ranks, whose numbers `total` sums up."""
    vec, start = mat.createVecRight(), mat.getOwnershipRange()[0]
    rows = np.arange(start, start + vec.local_size) ** 1.3

    def Product(values: np.ndarray) -> np.ndarray:
        vec.array[:] = values
        return (mat * vec).array.copy()

    return HasEqualWorks(Product, np.sin(0.6 * rows), np.sin(1.7 * rows), total)
