# SPDX-License-Identifier: LGPL-2.1-or-later
"""Linear systems by factors of the whole matrix."""

from functools import partial

import numpy as np

from ngslac._ngslac import MergeMatrices
from ngslac.arrays import AddToDiagonal, AsBits, AsNumPy, Multiply, SameEntries
from ngslac.linear.factor import CHOLESKY, LU, Cholesky, Factor, IsSymmetric
from ngslac.linear.refine import FirstGood, Refine
from ngslac.linear.system import Method

__all__ = ["Direct", "Merged"]

SAFE = "umfpack"


class Merged:
    """The scaled matrix of bulk and contacts, changed where contacts change."""

    def __init__(self):
        self.number = 0  # of the matrix: another one where it has got other values
        self.Forget()

    def Forget(self):
        """Make another matrix the next time, as where the bulk has got other values."""
        self._mat = self._bulk = self._scale = self._entries = None
        self._plain = False  # may it be changed in place?

    def Of(self, system):
        """The matrix of a LinearSystem."""
        entries = system.Entries()
        same = system.mat is self._bulk and np.array_equal(system.scale, self._scale)
        if same and SameEntries(entries, self._entries):
            return self._mat
        plain = system.shift is None and not system.alone
        former = self._mat if same and plain and self._plain else None
        self.Forget()  # half changed, if that raises an error
        self._mat = MergeMatrices(system.mat, system.contacts, system.scale, former)
        if system.shift is not None:
            AddToDiagonal(self._mat, system.shift)
        self._bulk, self._scale = system.mat, np.array(system.scale)
        self._entries, self._plain = entries, plain
        self.number += 1
        return self._mat


class Direct(Method):
    """LU, or Cholesky factors of displacements alone where symmetric, kept for the same matrix.

    Some factorisations return NaN on saddle point matrices, others lose ten digits, without saying
    so. Then the safe solver takes over.
    """

    tolerance, serves_alone = 1e-9, True

    def __init__(self, bits, merged, inverse=None):
        self.bits, self.merged, self.factorisations = bits, merged, 0
        self.inverse = LU(inverse)
        self._cholesky = Cholesky(inverse if inverse in CHOLESKY else None)
        self.NewBulk()

    def __str__(self):
        return f"factors of the whole, by {self.inverse}"

    def NewBulk(self):
        """The bulk matrix has got other values."""
        self.merged.Forget()
        self._kept = None, None, None  # number of the matrix, and what its factors are
        self._symmetric = None, False

    def State(self):
        """What has been learnt."""
        return {"inverse": self.inverse}

    def SetState(self, state):
        """Go on with a `State`."""
        self.inverse = state["inverse"] or self.inverse

    def Solve(self, system, b):
        """See Method."""
        mat, free = self.merged.Of(system), AsNumPy(self.bits)
        symmetric = system.alone and self._IsSymmetric(mat)
        if system.alone:
            free[system.multipliers] = False
        names = dict.fromkeys((self._cholesky if symmetric else self.inverse, SAFE))
        solve = partial(self._Solve, mat, free, b, symmetric)
        x, error, name = FirstGood((name, partial(solve, name), self.tolerance) for name in names)
        if name == SAFE and not symmetric:
            self.inverse = SAFE
        return x, error

    def _IsSymmetric(self, mat):
        if self._symmetric[0] != self.merged.number:
            self._symmetric = self.merged.number, IsSymmetric(mat)
        return self._symmetric[1]

    def _Solve(self, mat, free, b, symmetric, inverse):
        factors = self._Factors(mat, free, inverse, symmetric)

        def Step(left):
            return Multiply([factors], left)

        return Refine(Step, lambda x: (b - Multiply([mat], x)) * free, b)

    def _Factors(self, mat, free, inverse, symmetric):
        if self._kept[:2] != (self.merged.number, inverse):
            self._kept = None, None, None  # two of them would need twice the memory
            self.factorisations += 1
            factors = Factor(mat, AsBits(free), inverse, symmetric=symmetric)
            self._kept = self.merged.number, inverse, factors
        return self._kept[2]
