# SPDX-License-Identifier: LGPL-2.1-or-later
"""Velocities of things that are no bodies: obstacles, tools, offsets with a Parameter, wear."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ngslac.bodies.constraints import ToolRows

if TYPE_CHECKING:
    from ngsolve import GridFunction

    from ngslac.contact.contact import LACContact

__all__ = ["Obstacles"]


class Obstacles:
    """How fast obstacles move where macro-elements see them, from what they did in the last steps.

    An obstacle that is a function, and an offset, move along the normal; a tool moves as a rigid
    body does, along the slave as well.
    """

    def __init__(self, contacts: Sequence[LACContact]):
        self.contacts = contacts
        self.state = None  # rates of the last step, of all macro-elements, and its length
        self._start, self._before, self.ways, self._offsets = None, None, None, None

    def Begin(self, gf: GridFunction) -> None:
        """Before the time is set to the end of the step; `gf` is where the step begins."""
        self._start = self.contacts[0].layout.Values(gf.vec).copy()
        self._before = [self._Of(contact, gf) for contact in self.contacts]

    def Move(self, gf: GridFunction) -> None:
        """After that; `gf` is the same. `ways`: how far the obstacle moves each macro-element."""
        self.ways = [
            self._Way(contact, gf, before)
            for contact, before in zip(self.contacts, self._before, strict=True)
        ]
        self._offsets = [contact.form.Table()["offset"] for contact in self.contacts]

    def Wear(self, gf: GridFunction) -> None:
        """After the step is solved: the change of an offset that depends on the contact."""
        for contact, way, before in zip(self.contacts, self.ways, self._offsets, strict=True):
            if contact.gap_is_driven:
                contact.Evaluate(gf)
                worn = contact.form.Table()["offset"] - before
                way += worn[:, None] * contact.Table()["normal"]

    def _Of(self, contact: LACContact, gf: GridFunction) -> tuple[np.ndarray, np.ndarray] | None:
        """Mean gaps, and where the points of a tool are that are at the macro-elements."""
        if not contact.gap_is_driven:
            return None
        contact.Evaluate(gf)
        table = contact.Table()
        places = np.zeros_like(table["x"])
        if contact.tool is not None:
            turn, shift = contact.tool.placement
            places = (table["x"] - shift) @ turn
        return np.nan_to_num(table["gap"]), places  # what has no partner is not moved

    def _Way(
        self, contact: LACContact, gf: GridFunction, before: tuple[np.ndarray, np.ndarray] | None
    ) -> np.ndarray:
        """How far the obstacle of a contact moves each macro-element: (m, d)."""
        now = self._Of(contact, gf)
        if now is None:
            return np.zeros((contact.space.nmacros, contact.mesh.dim))
        normal = contact.Table()["normal"]
        way = np.zeros_like(normal)
        if contact.tool is not None:
            turn, _ = contact.tool.placement
            way = (before[1] - now[1]) @ turn.T
        along = np.sum(way * normal, axis=1)
        return way + (now[0] - before[0] - along)[:, None] * normal

    def Rates(self, dt: float) -> list[np.ndarray]:
        """Velocities at the end of a step of the length `dt`, from backward differences."""
        rates = np.concatenate(self.ways) / dt
        before, last = self.state or (rates, dt)
        if before.shape != rates.shape:  # the mesh was refined
            before = rates
        self.state = rates, dt
        rates = rates + dt / (dt + last) * (rates - before)
        return np.split(rates, np.cumsum([len(part) for part in self.ways])[:-1])

    def Works(self, gf: GridFunction) -> list[np.ndarray]:
        """Of the moved obstacles on each macro-element, after `Evaluate` of `gf`, the solution."""
        motion = self.contacts[0].layout.Values(gf.vec) - self._start
        return [self._WorkOf(*pair, motion) for pair in zip(self.contacts, self.ways, strict=True)]

    @staticmethod
    def _WorkOf(contact: LACContact, way: np.ndarray, motion: np.ndarray) -> np.ndarray:
        table = contact.Table()
        way = table["area"][:, None] * way
        if len(contact.form.ToolDofs()):  # forces move it, too
            way = way - (ToolRows(contact) @ motion).reshape(way.shape)
        return np.sum(table["traction"] * way, axis=1)
