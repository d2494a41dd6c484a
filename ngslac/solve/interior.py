# SPDX-License-Identifier: LGPL-2.1-or-later
"""The contact status by an interior point method, where Newton's method with active set fails."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from ngslac.arrays import Multiply
from ngslac.errors import ContactConvergenceError
from ngslac.parallel.spread import Pick
from ngslac.solve.barrier import Barrier, BarrierStep, Centering, Mean, Tie
from ngslac.solve.pressures import WIDE, Bilateral, Unilateral

if TYPE_CHECKING:
    from ngsolve import BaseMatrix, BaseVector, GridFunction

    from ngslac.contact.contact import LACContact
    from ngslac.solve.residual import Measurement
    from ngslac.solve.system import System

__all__ = ["EvenPressures", "InteriorPoint"]

# How often a step is halved until there is a residual.
HALVINGS = 12
# After a step as short as this the next one starts from the middle of what is allowed: a few times,
# else the products do not get smaller.
SHORT, MOST_RETURNS = 0.1, 3


class InteriorPoint:
    """Follows the central path of bulk and contact, see `Barrier`.

    Each macro-element pushes from afar, less and less: nothing floats on the way, no status has to
    be guessed, and thin bodies, whose status Newton's method finds one macro-element at a time,
    take as many steps as others. A step costs one factorisation of a matrix that is symmetric and
    positive definite where that of the bulk is.
    """

    def __init__(self, system: System, state: Measurement):
        self.system, self.vec, self.values = system, system.gf.vec, system.values
        self.multipliers, self.returns = system.residual.multipliers, 0
        system.linear.shifts = 0
        self.springs = [Springs(contact, system.gf) for contact in system.contacts]
        # Does contact end inside of macro-elements? On the way their pressures are even.
        self.approximates = any(np.any(c.form.Table()["ends"] > 0) for c in system.contacts)
        pressure = self._Settle(state)
        if not 0 < pressure < np.inf:
            raise ContactConvergenceError("nothing presses where the surfaces face each other")
        for spring in self.springs:
            spring.Start(pressure)

    def _Settle(self, state: Measurement) -> float:
        """Let weak springs hold what loads and prescribed motions move: the size of pressures.

        Where the bulk is linear that is a better start, too, and its Measurement the next one.
        """
        self.state = state
        self.system.HoldIdle("closed")
        weak = [spring.Weaken(self.vec) for spring in self.springs]
        tractions = [Pick(self.values, spring.dofs.ravel()) for spring in self.springs]
        motion = self._Motion(state, weak, tractions)
        pressure = max(spring.Pressure(motion) for spring in self.springs)
        if self.system.CountMotionAsDone():
            self.values[:] += motion
            self.state = self.system.Measure()
        return pressure

    def Step(self, state: Measurement) -> tuple[Measurement, float]:
        """Move on by one step: the next Measurement, and the part that was taken."""
        mats = [spring.Assemble(self.vec) for spring in self.springs]
        self.system.HoldIdle("closed")
        before = Mean(spring.law.products for spring in self.springs)
        steps, _ = self._Direction(state, mats, 0.0)
        part = self._Longest(steps)
        predicted = Mean(s.law.Predicted(step, part) for s, step in self._Each(steps))
        center = Centering(before, predicted)
        steps, motion = self._Direction(state, mats, center, steps)
        trial, part = self._Take(state, steps, motion)
        if part < SHORT and self.returns < MOST_RETURNS:
            self.returns += 1
            for spring in self.springs:
                spring.law.Center(before)
        return trial, part

    def _Each(self, steps: Iterable) -> Iterable[tuple[Springs, Any]]:
        return zip(self.springs, steps, strict=True)

    def _Longest(self, steps: Sequence[BarrierStep | np.ndarray]) -> float:
        return min(spring.law.Longest(step) for spring, step in self._Each(steps))

    def _Motion(
        self, state: Measurement, mats: Sequence[BaseMatrix], tractions: Sequence[np.ndarray]
    ) -> np.ndarray:
        """How displacements answer to tractions, with these matrices of the springs."""
        residual = self.vec.CreateVector()
        forces = self.system.layout.Values(residual)
        forces[:] = state.bulk
        forces[self.multipliers] = 0
        for spring, own in self._Each(tractions):
            spring.form.AddForces(self.vec, own, residual)
        system = self.system
        pins = system.ground.Shift() if system.ground else None

        def Solve(forces: np.ndarray) -> np.ndarray:
            """Without condensed dofs, with the springs as matrix."""
            # Bodies that nothing pushes in the end stay where they are.
            springs = system.MakeLinearSystem(mats, forces, shift=pins, alone=True)
            return system.linear.SolveShifted(springs, ~self.multipliers)

        return -system.Displace(residual, Solve, mats)

    def _Direction(
        self,
        state: Measurement,
        mats: Sequence[BaseMatrix],
        mu: float,
        corrections: Sequence[BarrierStep | np.ndarray] | None = None,
    ) -> tuple[list[BarrierStep | np.ndarray], np.ndarray]:
        """Steps of the springs, and the motion of the displacements, towards a `mu`."""
        corrections = corrections or [None] * len(self.springs)
        changes = [spring.law.Change(mu, own) for spring, own in self._Each(corrections)]
        aim = [s.Tractions(s.law.traction + change) for s, change in self._Each(changes)]
        motion = self._Motion(state, mats, aim)
        steps = [spring.Step(change, motion) for spring, change in self._Each(changes)]
        return steps, motion

    def _Take(
        self, state: Measurement, steps: Sequence[BarrierStep | np.ndarray], motion: np.ndarray
    ) -> tuple[Measurement, float]:
        """As much of the steps as stays inside and has a residual."""
        start = self.values.copy()
        part = min(self._Longest(steps), self.system.Sight(-motion))
        for _ in range(HALVINGS):
            self.values[:] = start + part * motion
            for spring, step in self._Each(steps):
                spring.Show(self.values, spring.law.Shown(step, part))
            trial = self.system.Trial(state, part, part * motion)
            if trial.finite:
                break
            part /= 2
        else:
            raise ContactConvergenceError(trial.reason + " however short the step")
        for spring, step in self._Each(steps):
            spring.law.Take(step, part)
        self.system.Moved(state, trial, motion, part)
        return trial, part


@contextmanager
def EvenPressures(contacts: Sequence[LACContact], even: bool = True) -> Iterator[None]:
    """Pressures of the contacts are even where contact ends, or not, in this context."""
    try:
        for contact in contacts:
            contact.form.SetEven(even)
        yield
    finally:
        for contact in contacts:
            contact.form.SetEven(not even)


class Springs:
    """What takes the place of the law of one contact."""

    def __init__(self, contact: LACContact, gf: GridFunction):
        self.contact, self.form, self.gf = contact, contact.form, gf
        contact.Evaluate(gf)
        table, self._scale = contact.Table(), self.form.Table()["c"]
        # With large sliding any macro-element may come to face the master.
        self.own = (table["area"] > 0) | (contact.finite & (self._scale > 0))
        self.area, self.stiffness = self._Areas(table), self._scale[self.own]
        self.dofs = self.form.MultiplierDofs().reshape(len(self.own), -1)

    def Weaken(self, vec: BaseVector) -> BaseMatrix:
        """Matrix of springs that hold the surfaces loosely where they are."""
        d = self.dofs.shape[1]
        weak = np.multiply.outer(self._scale / WIDE * self.own, np.eye(d))
        return self.form.Matrix(vec, vec.FV().NumPy()[self.dofs.ravel()], weak.ravel())

    def Pressure(self, motion: np.ndarray) -> float:
        """The size of the pressures of those springs after a motion, and of those at the start."""
        if self.contact.tied:
            return 0.0
        table = self.contact.Table()
        change = -np.sum(self._Follow(motion) * table["normal"][self.own], axis=1)
        overlap = change - self.stiffness / WIDE * self._Gaps(table, 0.0)
        start = np.abs(table["pressure"][self.own])
        return max(np.max(sizes, initial=0.0) for sizes in (np.abs(change), overlap, start))

    def _Areas(self, table: dict[str, np.ndarray]) -> np.ndarray:
        """Of its macro-elements: all of those that face no master."""
        area, full = table["area"][self.own], table["fullarea"][self.own]
        return np.where(area > 0, area, full)

    def _Gaps(self, table: dict[str, np.ndarray], without: float | np.ndarray) -> np.ndarray:
        """Of its macro-elements, those `without` (n,) or a number where they face no master."""
        gap = table["gap"][self.own]
        return np.where(np.isnan(gap), without, gap)

    def Start(self, pressure: float) -> None:
        """Start with pressures of this size."""
        self.contact.Evaluate(self.gf)
        table = self.contact.Table()
        if self.contact.tied:
            self.law = Tie(table["traction"][self.own], self.stiffness)
            return
        normal, gap = table["normal"][self.own], self._Gaps(table, 0.0)
        press = Unilateral(gap, self.stiffness, pressure)
        product = np.mean(press.products) if len(gap) else 0.0
        if self.contact.bilateral:
            press = Bilateral(table["pressure"][self.own], self.stiffness, pressure)
        self.law = Barrier(press, normal, gap, self._Bound(press.size, table), product)

    def _Bound(self, pressure: np.ndarray, table: dict[str, np.ndarray]) -> np.ndarray:
        """Of the tangential traction."""
        friction = table["friction"][self.own]
        threshold = self.form.Table()["tresca"][self.own]
        coulomb = np.where(friction >= 0, friction * pressure, np.inf)
        bound = np.minimum(coulomb, np.where(threshold >= 0, threshold, np.inf))
        return np.where(np.isfinite(bound), bound, 0.0)

    def Assemble(self, vec: BaseVector) -> BaseMatrix:
        """Their matrix, of the displacements alone, where the solution is now."""
        self._Place(vec)
        d = self.dofs.shape[1]
        stiffness = np.zeros((len(self.own), d, d))
        stiffness[self.own] = self.law.Stiffness()
        return self.form.Matrix(vec, self.Tractions(self.law.traction), stiffness.ravel())

    def _Place(self, vec: BaseVector) -> None:
        """Let the law know gaps and slips, or jumps, where the solution is now."""
        if self.contact.tied:
            rows = vec.CreateVector()
            self.contact.Apply(vec, rows)
            jump = -rows.FV().NumPy()[self.dofs[self.own]] / self.area[:, None]
            self.law.Place(0 * jump, 0 * jump[:, 0], jump)
            return
        self.contact.Evaluate(self.gf)
        table = self.contact.Table()
        self.area = self._Areas(table)
        gaps = self._Gaps(table, self.law.press.apart)
        self.law.Place(table["normal"][self.own], gaps, table["slip"][self.own])
        self.law.Bound(self._Bound(self.law.press.size, table))

    def Tractions(self, own: np.ndarray) -> np.ndarray:
        """Of all macro-elements, flat: those `own` (n, d) of its own, and 0."""
        tractions = np.zeros(self.dofs.shape)
        tractions[self.own] = own
        return tractions.ravel()

    def Show(self, values: np.ndarray, traction: np.ndarray) -> None:
        """Put tractions (n, d) into the solution."""
        values[self.dofs.ravel()] = self.Tractions(traction)

    def Step(self, change: np.ndarray, motion: np.ndarray) -> BarrierStep | np.ndarray:
        """The step of the law to a motion of the displacements."""
        return self.law.Step(change + self._Follow(motion))

    def _Follow(self, motion: np.ndarray) -> np.ndarray:
        """What a motion of the displacements changes the tractions (n, d) by."""
        follow = Pick(Multiply([self.form.mat], motion), self.dofs[self.own])
        return (self.stiffness / self.area)[:, None] * follow
