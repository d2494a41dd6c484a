# SPDX-License-Identifier: LGPL-2.1-or-later
"""The bulk form with its loads: matrix, residual, and whether it is linear."""

from dataclasses import dataclass

import numpy as np
from ngsolve import BaseMatrix, BaseVector, BilinearForm, BitArray

from ngslac.arrays import AsNumPy, Multiply, ScalarDofs
from ngslac.loads import CheckRhs, LoadVector
from ngslac.solve.probe import AssembleLinear, Probe
from ngslac.solve.problem import AssembleBulk

__all__ = ["LINEAR", "ROUNDING", "Bulk"]

# Deviation from the straight line, relative to the way along it, that is rounding.
LINEAR = 1e-10
# Errors of a force, relative to the stiffness times the displacement.
ROUNDING = 1e-14
# Change of the residual, relative to the forces at work, that tells nothing.
TINY = 1e-5


@dataclass
class Honest:
    """Where the form itself was applied, what it gave, the merit and rounding errors there."""

    vec: BaseVector
    residual: BaseVector
    merit: float
    rounding: float


class Bulk:
    """What is solved besides contact, at the solution.

    A form whose residual changes as its matrix says seems to be linear, be it from the solution to
    a random displacement, where that is asked first, or along Newton's steps: its matrix is kept,
    and a product with it takes the place of the element loop. What looks converged then has to be
    confirmed.

    Parameters
    ----------
    a : BilinearForm
        Or what has its verbs.
    gf : GridFunction
    rhs :
        As in ContactSolver.

    Attributes
    ----------
    islinear : bool or None
        As far as seen; None: not at all.
    inner : (n,) bool
        Free dofs that are condensed: they are not in the matrix.
    product : BaseMatrix or None
        A product with it takes the place of the form.
    last : Honest or None
        The last residual that came from the form itself.
    """

    def __init__(self, a, gf, rhs):
        self.a, self.gf, self.rhs = a, gf, CheckRhs(rhs, a.space)
        self.inner = np.zeros(len(gf.vec.FV().NumPy()), dtype=bool)
        if a.condense:
            inner = BitArray(a.space.FreeDofs())
            inner &= ~a.space.FreeDofs(True)
            self.inner = AsNumPy(ScalarDofs(inner, a.space))
        self._vouched = False  # is the matrix linear as a random displacement says?
        self._refuted = False  # by a random displacement: no other one is asked
        self.StartAfresh()

    @property
    def mat(self):
        """The derivative of the form where it was assembled last."""
        return self.a.mat

    @property
    def elastic(self):
        """The BilinearForm without inertia, or a matrix with its diagonal; None: unknown."""
        form = getattr(self.a, "elastic", self.a)
        form = getattr(form, "elastic", form)
        return form if isinstance(form, (BilinearForm, BaseMatrix)) else None

    @property
    def diagonal(self):
        """The matrix, or one that has its diagonal in common with it."""
        return getattr(self.mat, "diagonal", self.mat)

    @property
    def load(self):
        """The loads that are not in the form, as array (n,)."""
        return LoadVector(self.rhs, self.gf.vec)

    def StartAfresh(self):
        """Know nothing of the form."""
        self.islinear = None
        self.Forget()

    def Forget(self):
        """Know no residual of before: the next one comes from the form."""
        self.last, self.product, self._proposed, self._probe = None, None, None, None

    def Assemble(self):
        """Make the matrix at the solution; False if that of before still holds."""
        self._probe = None
        if self.islinear and self.mat.height == self.a.space.ndof:
            if self._vouched:  # the way to a solution is the same each time
                self._TakeForLinear()
            return False
        self._vouched = False
        self.Propose(None)
        if self.islinear is not None or self.a.condense or self._refuted:
            AssembleBulk(self.a, self.gf.vec)
            return True
        self._probe = Probe.At(self.a, self.gf)
        if self._probe and AssembleLinear(self.a) and self._probe.Agrees(self.mat):
            self._TakeForLinear()
            return True
        AssembleBulk(self.a, self.gf.vec)
        if self._probe and self._probe.Agrees(self.mat):
            self._TakeForLinear()
        self._refuted = not self.islinear
        return True

    def _TakeForLinear(self):
        self.islinear = self._vouched = True
        self.Propose(self.mat)
        self.Propose(self.mat)

    def Propose(self, mat):
        """Use a matrix in place of the form if that is proposed twice.

        A first step often is a rigid motion, which tells little.
        """
        self.product = mat if mat is self._proposed else None
        self._proposed = mat

    # --- residual ------------------------------------------------------------------------------

    def Apply(self, honest):
        """The residual before loads are taken off, and whether it comes from the form itself.

        Parameters
        ----------
        honest : bool
            It has to.

        Returns
        -------
        BaseVector, bool
        """
        if not honest and self.product is not None and self.last is not None:
            residual = self.gf.vec.CreateVector()
            residual.data = self.last.residual + self.Change()
            return residual, False
        probe, self._probe = self._probe, None
        if probe is not None and np.array_equal(probe.values, self.gf.vec.FV().NumPy()):
            return probe.residual, True
        residual = self.gf.vec.CreateVector()
        self.a.Apply(self.gf.vec, residual)
        return residual, True

    def Remember(self, residual, merit, rounding):
        """Take an honest residual as the one from which products go on."""
        start = self.gf.vec.CreateVector()
        start.data = self.gf.vec
        self.last = Honest(start, residual, merit, rounding)

    def Change(self):
        """What a linear form adds to its last honest residual."""
        moved, change = self.gf.vec.CreateVector(), self.gf.vec.CreateVector()
        moved.data = self.gf.vec - self.last.vec
        change.data = self.product * moved
        return change

    # --- is it linear? -------------------------------------------------------------------------

    def Learn(self, before, after, motion, scale, residual):
        """See from a motion (n,) between two States whether the form is linear.

        Parameters
        ----------
        before, after : Measurement
        motion, scale : (n,) array
        residual : Residual
            Tells the forces at work, and rounding errors.
        """
        if after.honest:
            change = before.bulk - after.bulk
            self.islinear = self.Explains(change, motion, scale, residual)
            keeps = self.islinear and not self.a.condense  # else the matrix is not all of it
            self.Propose(self.mat if keeps else None)

    def Explains(self, difference, motion, scale, residual):
        """Does the matrix say so of a difference (n,) of residuals? See `Learn`.

        What is too short tells nothing.
        """
        change, expected = self.gf.vec.CreateVector(), Multiply([self.mat], motion)
        change.FV().NumPy()[:] = difference
        inside, inner = self._MovesInside(change, motion, scale), self.inner
        self.Condense(change)
        deviation, expected = (
            np.where(inner, 0.0, scale * force)
            for force in (change.FV().NumPy() - expected, expected)
        )
        size, deviation = np.linalg.norm(expected), np.linalg.norm(deviation)
        # Of thin bodies in bending the forces are small beside those that cancel out.
        rounding = residual.rounding + ROUNDING * np.linalg.norm(motion / scale)
        if size < max(TINY * residual.forces, residual.rounding):
            return self.islinear is not False
        linear = inside and deviation <= LINEAR * size
        return bool(linear or (self.islinear is not False and deviation <= rounding))

    def _MovesInside(self, change, motion, scale):
        """Do condensed dofs move as the bulk says where forces change so?

        Their matrix K_ii is known by its inverse only: K_ii^-1 times forces is the motion that is
        not that of the harmonic extension.
        """
        if not self.a.condense:
            return True
        moved, own = self.gf.vec.CreateVector(), self.gf.vec.CreateVector()
        moved.FV().NumPy()[:] = motion
        own.data = self.a.inner_solve * change + self.a.harmonic_extension * moved
        away = np.where(self.inner, own.FV().NumPy() - motion, 0.0) / scale
        return np.linalg.norm(away) <= LINEAR * np.linalg.norm(motion / scale)

    def Refute(self):
        """It is not linear: be honest from now on."""
        self.islinear = self._vouched = False
        self.Propose(None)

    # --- condensation --------------------------------------------------------------------------

    def Condense(self, residual):
        """Add the forces on condensed dofs to those on the others."""
        if self.a.condense:
            residual.data += self.a.harmonic_extension_trans * residual

    def Extend(self, correction, residual):
        """Add to a correction what condensed dofs follow by."""
        if self.a.condense:
            correction.data += self.a.harmonic_extension * correction
            correction.data += self.a.inner_solve * residual
