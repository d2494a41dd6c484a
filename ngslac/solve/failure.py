# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is known of a solve that fails: whether the loads have a balance at all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ngslac.bodies.messages import DrivenMessage, FloatingMessage, OwnLawMessage
from ngslac.bodies.rigidbalance import RigidBalance
from ngslac.errors import ContactConvergenceError, FloatingBodyError, LinearSolveError, Reason
from ngslac.solve.look import MechanismError

if TYPE_CHECKING:
    from ngslac.solve.holding import Holding
    from ngslac.solve.iteration import Iteration
    from ngslac.solve.system import Configuration, System

__all__ = ["CarriedOff", "Failure"]


class Failure:
    """Reasons why a System has no solution, as they are found."""

    def __init__(self, system: System, holding: Holding):
        self.system, self.holding = system, holding
        self.unbalanced = self.slides = ""  # which bodies loads carry off, or friction lets go
        self.reason = Reason(0)

    @property
    def known(self) -> bool:
        """Is another method of no use?"""
        return bool(self.unbalanced) or Reason.EXHAUSTED in self.reason

    def LookAt(
        self,
        start: Configuration,
        error: ContactConvergenceError | LinearSolveError,
        *,
        lost: bool,
    ) -> None:
        """From the start again: raise the error if the loads have no equilibrium for certain."""
        system = self.system
        now = system.Place()
        system.Visit(start)
        if lost and not self.holding.MayHold():
            self.reason |= Reason.EXHAUSTED | Reason.UNHELD
            self.unbalanced, self.slides = self._Unheld(error), ""
        else:
            self.unbalanced = CarriedOff(system)
        if self.unbalanced and system.islinear:
            self.reason |= Reason.CERTAIN
            raise error
        system.GoTo(now)

    def _Unheld(self, error: ContactConvergenceError | LinearSolveError) -> str:
        """What no closed contact would hold, where the error does not speak of it."""
        free = self.system.Freedom("closed")
        if isinstance(error, FloatingBodyError) or not self.system.IsDriven(free, "closed"):
            return ""
        return DrivenMessage(self.system.DrivenMotion(free, "closed"))

    def Error(
        self,
        error: ContactConvergenceError | LinearSolveError,
        floating: Sequence[str],
        history: Sequence[Iteration],
    ) -> ContactConvergenceError:
        """An error with all that is known: which body is carried off, first of all."""
        if isinstance(error, LinearSolveError):
            kind = FloatingBodyError if floating else ContactConvergenceError
            hint = OwnLawMessage() if self.system.own_law else ""
            error = kind(FloatingMessage(floating) if floating else str(error) + hint)
        loose = isinstance(error, MechanismError)
        if loose:
            error = FloatingBodyError(str(error))
        if self.unbalanced or self.slides:
            error = FloatingBodyError(self.unbalanced or self.slides)
        goes_on = Reason.SLIPS in self.reason and (self.system.islinear or self.system.slid)
        found = {Reason.EXHAUSTED: self.known, Reason.UNHELD: loose}
        found[Reason.SLIDES] = self.slides or goes_on
        error.history, error.reason = history, self.reason
        for reason in (reason for reason, holds in found.items() if holds):
            error.reason |= reason
        return error


def CarriedOff(system: System) -> str:
    """Which bodies the loads carry off, whatever contact does; "" where there is a balance."""
    bodies = system.bodies
    if not bodies.floating or system.own_law:
        return ""
    if system.bulk.a.condense or system.scale is None:  # as before the first solve
        system.Assemble()
    state = system.MeasureExactly()
    if not state.finite or system.residual.IsRounding(state.bulk, system.scale):
        return ""
    forces = system.gf.vec.CreateVector()
    values = system.layout.Values(forces)
    values[:] = state.bulk
    system.bulk.Condense(forces)  # bodies do not know what is condensed
    own = slice(bodies.first, bodies.first + bodies.count)
    displacement = system.values[own] if system.finite else None
    return RigidBalance(bodies, system.contacts, displacement).Find(
        system.layout.Values(forces)[own]
    )
