# SPDX-License-Identifier: LGPL-2.1-or-later
"""Preconditioner of bulks with a pressure of their own, as for incompressible materials."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from ngsolve import BaseMatrix, BaseVector

from ngslac.arrays import AsNumPy

if TYPE_CHECKING:
    from ngslac._ngslac import Condensation

__all__ = ["Mixed", "PressureRows"]

# Diagonal entries that are rounding errors of zero.
ZERO = 1e-12


def PressureRows(system: Condensation) -> np.ndarray:
    """The free rows (n,) bool of a Condensation whose diagonal is not positive.

    They belong to the pressure of a mixed form, or to another multiplier in the bulk: the matrix is
    scaled so that rows of displacements have the diagonal 1.
    """
    return AsNumPy(system.freedofs) & (system.diagonal < ZERO)


class Mixed(BaseMatrix):
    """Block triangular: displacements first, then what is left for the pressure.

    Where displacements and pressure satisfy an inf-sup condition the pressure's Schur complement
    ``C + B K^-1 B^T`` is like a mass matrix, and so like ``diag(C + B diag(K)^-1 B^T)``, whatever
    the bulk modulus is (Elman, Silvester, Wathen, Finite Elements and Fast Iterative Solvers,
    chapter 4).
    """

    def __init__(self, system: Condensation, inverse: BaseMatrix, pressures: np.ndarray):
        super().__init__()
        self.system, self.inverse, self.pressures = system, inverse, pressures
        self._compliance = Compliance(system, pressures)[pressures]
        self._left = system.CreateColVector()

    def Mult(self, x: BaseVector, y: BaseVector) -> None:
        """Y = M^-1 x."""
        y.data = self.inverse * x
        self._left.data = x - self.system * y
        left, values = self._left.FV().NumPy(), y.FV().NumPy()
        values[self.pressures] = -left[self.pressures] / self._compliance

    def Height(self) -> int:
        """Rows."""
        return self.system.height

    def Width(self) -> int:
        """Columns."""
        return self.system.width

    def CreateColVector(self) -> BaseVector:
        """A vector of `Height`."""
        return self.system.CreateColVector()

    def CreateRowVector(self) -> BaseVector:
        """A vector of `Width`."""
        return self.system.CreateRowVector()


def Compliance(system: Condensation, pressures: np.ndarray) -> np.ndarray:
    """Diagonal of C + B B^T on the rows of pressures (n,); that of K is 1."""
    mat = system.Part(np.arange(system.height))  # whose memory the views below are
    values, columns, starts = map(np.asarray, mat.CSR())
    rows = np.repeat(np.arange(system.height), np.diff(starts.astype(int)))
    own = rows == columns
    counts = pressures[rows] & (own | (AsNumPy(system.freedofs) & ~pressures)[columns])
    terms = np.where(own, -values, values**2)
    return np.bincount(rows[counts], terms[counts], minlength=system.height)
