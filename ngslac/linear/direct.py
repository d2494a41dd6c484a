# SPDX-License-Identifier: LGPL-2.1-or-later
"""Linear systems by factors of the whole matrix."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ngslac.arrays import AsBits, Multiply
from ngslac.linear.factor import CHOLESKY, LU, Cholesky, Factor, IsSymmetric
from ngslac.linear.refine import FirstGood, Refine
from ngslac.linear.system import LinearSystem, Method

if TYPE_CHECKING:
    from ngsolve import BaseMatrix

__all__ = ["Direct"]

SAFE = "umfpack"
# Residual over the product of what it is the difference of, matrix and solution, that is rounding.
ROUNDING = 1e-15


class Direct(Method):
    """LU, or Cholesky factors of displacements alone where symmetric, kept for the same matrix.

    Some factorisations return NaN on saddle point matrices, others lose ten digits, without saying
    so. Then the safe solver takes over.
    """

    tolerance, serves_alone = 1e-9, True

    def __init__(self, inverse: str | None = None):
        self.factorisations = 0
        self.inverse = LU(inverse)
        self._cholesky = Cholesky(inverse if inverse in CHOLESKY else None)
        self.NewBulk()

    def __str__(self) -> str:
        return f"factors of the whole, by {self.inverse}"

    def NewBulk(self) -> None:
        """The bulk matrix has got other values."""
        self._kept = None, None, None  # number of the matrix, and what its factors are
        self._symmetric = None, False

    def State(self) -> dict:
        """What has been learnt."""
        return {"inverse": self.inverse}

    def SetState(self, state: dict) -> None:
        """Go on with a `State`."""
        self.inverse = state["inverse"] or self.inverse

    def Solve(self, system: LinearSystem, b: np.ndarray) -> tuple[np.ndarray, float]:
        """See Method."""
        symmetric = system.alone and self._IsSymmetric(system)
        names = dict.fromkeys((self._cholesky if symmetric else self.inverse, SAFE))
        solve, good = partial(self._Solve, system, b, symmetric), partial(self._IsGood, system, b)
        x, error, name = FirstGood((name, partial(solve, name), good) for name in names)
        if name == SAFE and not symmetric:
            self.inverse = SAFE
        return x, error

    def _IsGood(self, system: LinearSystem, b: np.ndarray, x: np.ndarray, error: float) -> bool:
        """Is the residual small, or are other factors of no use?

        What hardly anything holds moves so far that its residual is all rounding.
        """
        size = np.linalg.norm(system.matrix.AsVector().FV().NumPy()) * np.linalg.norm(x)
        return error <= self.tolerance or error * np.linalg.norm(b) <= ROUNDING * size

    def _IsSymmetric(self, system: LinearSystem) -> bool:
        if self._symmetric[0] != system.number:
            self._symmetric = system.number, IsSymmetric(system.matrix)
        return self._symmetric[1]

    def _Solve(
        self, system: LinearSystem, b: np.ndarray, symmetric: bool, inverse: str
    ) -> tuple[np.ndarray, float]:
        """The solution by one kind of factors, refined, and its relative residual."""
        mat, free, factors = system.matrix, system.free, self._Factors(system, inverse, symmetric)

        def Step(left: np.ndarray) -> np.ndarray:
            return Multiply([factors], left)

        return Refine(Step, lambda x: (b - Multiply([mat], x)) * free, b)

    def _Factors(self, system: LinearSystem, inverse: str, symmetric: bool) -> BaseMatrix:
        """Factors of the matrix, which are kept until it is another one."""
        if self._kept[:2] != (system.number, inverse):
            self._kept = None, None, None  # two of them would need twice the memory
            self.factorisations += 1
            free = AsBits(system.free)
            factors = Factor(system.matrix, free, inverse, symmetric=symmetric)
            self._kept = system.number, inverse, factors
        return self._kept[2]
