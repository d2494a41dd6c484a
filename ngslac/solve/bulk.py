# SPDX-License-Identifier: LGPL-2.1-or-later
"""The bulk form with its loads: matrix, residual, and whether it is linear."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import BaseMatrix, BaseVector, BilinearForm, BitArray, GridFunction, LinearForm

from ngslac.arrays import AsNumPy, Multiply, ScalarDofs
from ngslac.bulkforms import WithoutMass
from ngslac.parallel.layout import LayoutOf
from ngslac.solve.loads import CheckRhs, LoadVector
from ngslac.solve.probe import AssembleLinear, Probe
from ngslac.solve.problem import AssembleBulk

if TYPE_CHECKING:
    from ngslac.solve.residual import Measurement, Residual

__all__ = ["LINEAR", "ROUNDING", "Bulk"]

# Deviation from the straight line, relative to the way along it, that is rounding.
LINEAR = 1e-10
# Errors of a force, relative to the stiffness times the displacement.
ROUNDING = 1e-14
# Change of the residual, relative to the forces at work, that says nothing about the form.
TINY = 1e-5


@dataclass
class Exact:
    """Where the form itself was applied, what it gave, the merit and rounding errors there."""

    vec: BaseVector
    residual: BaseVector
    merit: float
    rounding: float


class Bulk:
    """What is solved besides contact, at the solution.

    A random displacement shows whether the form is linear, when its matrix is made first. The
    matrix of a linear form is kept, and products with it take the place of the element loop, until
    a residual of the form itself shows that a Parameter has changed the form.

    Attributes
    ----------
    islinear : bool or None
        None: not asked yet.
    inner : (n,) bool
        Free dofs that are condensed: they are not in the matrix.
    last : Exact or None
        The last residual that came from the form itself.
    """

    def __init__(
        self,
        a: BilinearForm,
        gf: GridFunction,
        rhs: LinearForm | BaseVector | Callable[[], LinearForm | BaseVector] | None,
    ):
        self.a, self.gf, self.rhs = a, gf, CheckRhs(rhs, a.space)
        self.layout = LayoutOf(a.space)
        self.inner = self.layout.Of(np.zeros(a.space.ndof * a.space.dim, dtype=bool))
        if a.condense:
            inner = BitArray(a.space.FreeDofs())
            inner &= ~a.space.FreeDofs(True)
            self.inner = self.layout.Of(AsNumPy(ScalarDofs(inner, a.space)))
        self.StartAfresh()

    @property
    def mat(self) -> BaseMatrix:
        """The derivative of the form where it was assembled last."""
        return self.a.mat

    @property
    def product(self) -> BaseMatrix | None:
        """The matrix, where a product with it takes the place of the form; else None."""
        known = self.islinear and self.last is not None and not self.a.condense
        return self.mat if known else None

    @property
    def elastic(self) -> BilinearForm | None:
        """The BilinearForm without inertia; None: unknown."""
        form = WithoutMass(self.a)
        return form if isinstance(form, BilinearForm) else None

    @property
    def load(self) -> np.ndarray:
        """The loads that are not in the form, as array (n,)."""
        return LoadVector(self.rhs, self.gf)

    def StartAfresh(self) -> None:
        """Know nothing of the form."""
        self.islinear, self._changed = None, False
        self.Forget()

    def Forget(self) -> None:
        """Know no residual of before: the next one comes from the form."""
        self.last = self._probe = None

    def Begin(self) -> None:
        """A solve begins: a form that has changed is asked anew."""
        if self._changed:
            self.StartAfresh()

    def Assemble(self) -> bool:
        """Make the matrix at the solution; False if that of before still holds."""
        self._probe = None
        if self.islinear and self.mat.height == self.a.space.ndof:
            return False
        if self.islinear is None:
            self._probe = Probe.At(self)
            if self._probe and AssembleLinear(self.a, self.layout) and self._probe.Agrees(self):
                self.islinear = True
                return True
        AssembleBulk(self.a, self.gf.vec, self.layout)
        if self.islinear is None:
            self.islinear = bool(self._probe and self._probe.Agrees(self))
        return True

    # --- residual ------------------------------------------------------------------------------

    def Apply(self, exact: bool) -> tuple[BaseVector, bool]:
        """The residual (BaseVector) before loads are taken off, and whether it is exact.

        It comes from the form itself then, as it does where `exact` asks for that.
        """
        residual = self.gf.vec.CreateVector()
        if not exact and self.product is not None:
            Values = self.layout.Values
            Values(residual)[:] = Values(self.last.residual) + self.Change()
            return residual, False
        probe, self._probe = self._probe, None
        if probe is not None and np.array_equal(probe.values, self.layout.Values(self.gf.vec)):
            return probe.residual, True
        self.layout.Apply(self.a, self.gf.vec, residual)
        return residual, True

    def Remember(self, residual: BaseVector, merit: float, rounding: float) -> None:
        """Take an exact residual as the one from which products go on."""
        start = self.gf.vec.CreateVector()
        start.data = self.gf.vec
        self.last = Exact(start, residual, merit, rounding)

    def Change(self) -> np.ndarray:
        """What a linear form adds to its last exact residual."""
        Values = self.layout.Values
        return Multiply([self.product], Values(self.gf.vec) - Values(self.last.vec))

    # --- is it linear, still? ------------------------------------------------------------------

    def Learn(
        self,
        before: Measurement,
        after: Measurement,
        motion: np.ndarray,
        scale: np.ndarray,
        residual: Residual,
    ) -> None:
        """See from a motion (n,) between two Measurements whether a condensed form has changed."""
        if self.islinear and self.a.condense:
            self.islinear = self._Explains(before.bulk - after.bulk, motion, scale, residual)
            self._changed = not self.islinear

    def _Explains(
        self, change: np.ndarray, motion: np.ndarray, scale: np.ndarray, residual: Residual
    ) -> bool:
        """Does the matrix explain a change (n,) of residuals, as far as that says anything?"""
        deviation, expected = self.Deviation(change, motion)
        away = np.linalg.norm((deviation / scale)[self.inner])
        deviation, expected = (
            np.linalg.norm((scale * forces)[~self.inner]) for forces in (deviation, expected)
        )
        if expected < max(TINY * residual.forces, residual.rounding):
            return True
        # Of thin bodies in bending the forces are small beside those that cancel out.
        moved = np.linalg.norm(motion / scale)
        inside = away <= LINEAR * moved and deviation <= LINEAR * expected
        return bool(inside or deviation <= residual.rounding + ROUNDING * moved)

    def Deviation(self, change: np.ndarray, motion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How far a change (n,) of the residual is from what the matrix says, and what that is.

        Of condensed dofs the matrix K_ii is known by its inverse only: for them both are motions,
        as K_ii^-1 times forces is the motion that is not that of the harmonic extension.
        """
        Values = self.layout.Values
        forces = self.gf.vec.CreateVector()
        Values(forces)[:] = change
        expected = Multiply([self.mat], motion)
        if not self.a.condense:
            return change - expected, expected
        follows = Multiply([self.a.harmonic_extension], motion)
        deviation = Multiply([self.a.inner_solve], change) + follows - motion
        self.Condense(forces)
        expected = np.where(self.inner, np.abs(follows) + np.abs(motion), expected)
        outside = Values(forces) - expected
        return np.where(self.inner, deviation, outside), expected

    def Refute(self) -> None:
        """The form is another one: it is assembled in each step up to the end of the solve."""
        self.islinear, self._changed = False, True

    # --- condensation --------------------------------------------------------------------------

    def Condense(self, residual: BaseVector) -> None:
        """Add the forces on condensed dofs to those on the others."""
        if self.a.condense:
            self._Add(residual, self.a.harmonic_extension_trans, residual)

    def Extend(self, correction: BaseVector, residual: BaseVector) -> None:
        """Add to a correction what condensed dofs follow by."""
        if self.a.condense:
            self._Add(correction, self.a.harmonic_extension, correction)
            self._Add(correction, self.a.inner_solve, residual)

    def _Add(self, total: BaseVector, mat: BaseMatrix, vec: BaseVector) -> None:
        values = self.layout.Values(total)
        values += Multiply([mat], self.layout.Values(vec))
