# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact that has to hold bodies: what floats, and which macro-elements close for it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ngslac.arrays import AsBits
from ngslac.bodies.messages import FewMessage, FloatingMessage, SlidingMessage
from ngslac.errors import FloatingBodyError
from ngslac.solve.iteration import STILL, Iteration, Unchanged

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact
    from ngslac.solve.system import System

__all__ = ["Holding"]

# Forces without balance, relative to those at work, that are more than the search for a balance.
PUSHED = 1e-4
# How often bodies may be held by closing what the iteration opens again.
MOST_CLOSINGS = 5
# Gap over the size of a macro-element that touches.
TOUCHING = 1e-6


class Holding:
    """Closes the nearest macro-elements where a body is held by open contact."""

    def __init__(self, system: System, initial: str):
        self.system, self.initial, self.closings = system, initial, 0

    def Close(self, start: bool = False, *, guess: bool = True) -> bool:
        """Close what has to hold bodies; True if something was closed.

        At the start the status is no guide: rounding closes some of the macro-elements that touch.
        """
        system = self.system
        system.Evaluate()
        active = [contact for contact in system.contacts if contact.active]
        touching = all(np.any(contact.Table()["status"]) for contact in active)
        system.idle = False
        if not guess or (touching and not start):
            return False
        free = system.Freedom("rubbing").Others()
        system.idle = (
            system.rubs and bool(free) and self.initial == "gap" and not system.IsPushed(free)
        )
        if not free or (self.initial == "gap" and not system.IsPushed(free)):
            return False
        self.closings += 1
        if self.closings > MOST_CLOSINGS:
            raise FloatingBodyError(
                FloatingMessage(system.bodies.Names(free.weights))
                + ". The loads pull it away from the contact, or too little touches at first"
            )
        if self.initial == "gap" and CloseNearest(system):
            return True
        few = FewMessage(system.contacts)
        raise FloatingBodyError(FloatingMessage(system.WhatFloats()) + few)

    def Reaches(self) -> bool:
        """Are there closed macro-elements that do not touch?"""
        for contact in self.system.contacts:
            table = contact.Table()
            gapes = table["gap"] > TOUCHING * contact._Sizes()
            if contact.active and np.any(gapes[table["status"] > 0]):
                return True
        return False

    def MayHold(self) -> bool:
        """Would contact hold all bodies that loads move, if all of it were closed?"""
        system = self.system
        return self.initial == "gap" and not system.IsDriven(system.Freedom("closed"), "closed")

    def WhatSlides(self, history: Sequence[Iteration]) -> str:
        """What loads carry off where the status has settled, with friction at its limit."""
        system = self.system
        settled = len(history) > STILL and Unchanged(history)
        # Where both ends of a body slip apart next to nothing is left: there one of them sticks.
        pushed = history and history[-1].equilibrium > PUSHED
        if not (settled and pushed and system.islinear and system.rubs):
            return ""
        free = system.Freedom("now")
        return SlidingMessage(system.WhatFloats()) if system.IsPushed(free) else ""


def CloseNearest(system: System) -> bool:
    """Close macro-elements, the nearest first, until loads move no body; False if none helps.

    Of each contact as few as hold what all of it would. Farther contacts are left alone where the
    nearest ones hold all bodies, and so is what does not touch where that does which touches: a
    sheet between two tools that are round beside it would be torn apart.
    """
    loose = Loose(system)
    for contact in sorted(system.contacts, key=SmallestGap):
        before, found, sets = system.values.copy(), [], {}
        for distance in (0, 0.05, 0.1, 0.2, 0.4, 0.8):
            macros = NearestMacros(contact, distance)
            sets.setdefault(macros.tobytes(), macros)
        for macros in sets.values():
            system.values[:] = before
            contact.form.Close(AsBits(macros), system.gf.vec)
            contact.Evaluate(system.gf)
            if not (free := Loose(system)):
                return True
            found.append((free, system.values.copy()))
        least, values = min(found, key=lambda one: one[0])
        system.values[:] = values if least < loose else before
        contact.Evaluate(system.gf)
        loose = min(least, loose)
    return False


def Loose(system: System) -> int:
    """How many motions contact leaves, if loads do work on one; else 0."""
    free = system.Freedom()
    return free.weights.shape[1] if system.IsDriven(free) else 0


def SmallestGap(contact: LACContact) -> float:
    """Relative to the mean size of the macro-elements."""
    table = contact.Table()
    return abs(table["gap"][table["area"] > 0]).min(initial=np.inf) / contact._Sizes().mean()


def NearestMacros(contact: LACContact, distance: float) -> np.ndarray:
    """Macro-elements whose gap exceeds the smallest one by at most `distance` times their size.

    With the distance 0 those that touch, if any do.
    """
    table = contact.Table()
    paired = table["area"] > 0
    size = contact._Sizes()
    nearest = table["gap"][paired].min(initial=np.inf)
    limit = nearest + distance * size if distance else TOUCHING * size
    return paired & (table["gap"] <= limit)
