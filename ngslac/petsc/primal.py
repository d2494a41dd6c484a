# SPDX-License-Identifier: LGPL-2.1-or-later
"""Linear systems of the displacements alone, by PETSc."""

from dataclasses import dataclass

import numpy as np
from ngsolve import BaseMatrix

from ngslac.linear.attempts import SolveShifted
from ngslac.petsc.solver import PetscSolver

__all__ = ["PrimalPetsc"]


class PrimalPetsc:
    """What a PrimalSolver is, by factors of MUMPS: for the springs of the interior point method.

    Parameters
    ----------
    linear : PetscSolver
        Whose bulk and processes these are; the two take turns.

    Attributes
    ----------
    contacts : list[BaseMatrix]
        What the contacts add to the bulk's matrix.
    shifts : int
        Systems in a row that were singular.
    """

    def __init__(self, linear):
        self._linear = linear
        self._direct = PetscSolver(linear.team, linear.freedofs, "direct")
        self.contacts, self.shifts = [], 0

    def Leave(self, rows):
        """Leave out the multipliers, a (n,) array of bool: they get a diagonal of their own."""
        self._diagonal = rows.astype(float)

    def SolveShifted(self, bulk, forms, scale, rhs, rows, accuracy=0.0, pins=None):
        """See LinearSolver."""
        return SolveShifted(self, (bulk, forms, scale, rhs), rows, accuracy, pins)

    def Solve(self, bulk, forms, scale, rhs, shift=None, accuracy=0.0):
        """As PetscSolver, with the matrices `contacts` in place of the forms."""
        if self._linear.used:  # since it was left here, so that PETSc has its matrices
            self._direct.NewBulk()
        self._linear.NewBulk()
        diagonal = self._diagonal if shift is None else self._diagonal + shift
        return self._direct.Solve(bulk, [Added(mat) for mat in self.contacts], scale, rhs, diagonal)


@dataclass(frozen=True)
class Added:
    """What a contact adds, in the words of a ContactForm."""

    mat: BaseMatrix

    @staticmethod
    def MultiplierDofs():
        """None of them takes part."""
        return np.empty(0, dtype=int)
