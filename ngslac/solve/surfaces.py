# SPDX-License-Identifier: LGPL-2.1-or-later
"""The contact conditions of all macro-elements as functions of tractions and jumps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ngslac.solve.barrier import Barrier, Tie
from ngslac.solve.pressures import Bilateral, Unilateral

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact

__all__ = ["Answer", "Surfaces"]

SMALLEST = np.finfo(float).tiny


@dataclass
class Answer:
    """Answer of laws to trial tractions: status (k,), tractions (k, d), derivatives (k, d, d)."""

    status: np.ndarray
    traction: np.ndarray
    derivative: np.ndarray


class Surfaces:
    """The macro-elements that face something, with small sliding and the laws of `Project`.

    All arrays count these macro-elements, those of all contacts one after the other. Jumps (k, d)
    are mean motions of the slave against the master from the present displacement on.

    Attributes
    ----------
    own : (n,) bool
        These, among all macro-elements.
    parts : list of slice
        Those of each contact.
    area, gap, stiffness : (k,)
        The last is the scale of the law, a traction per displacement.
    normal, slip, traction : (k, d)
        Of the present displacement.
    bound : (k,) array or None
        Of friction, where the problem is one with given bounds.
    """

    def __init__(self, contacts: Sequence[LACContact]):
        known = [contact.Table() for contact in contacts]
        tables = [contact.form.Table() for contact in contacts]
        own = [table["area"] > 0 for table in known]
        counts = [np.count_nonzero(one) for one in own]
        ends = np.cumsum([0, *counts])
        self.own, self.bound = np.concatenate(own), None
        self.parts = [slice(*pair) for pair in pairwise(ends)]

        def Of(name: str, tables: Sequence[dict]) -> np.ndarray:
            return np.concatenate([t[name][one] for t, one in zip(tables, own, strict=True)])

        self.area, self.gap, self.normal, self.slip, self.traction = (
            Of(name, known) for name in ("area", "gap", "normal", "slip", "traction")
        )
        self.stiffness, friction, threshold = (Of(n, tables) for n in ("c", "friction", "tresca"))
        self.rubs = friction >= 0
        self._friction = np.where(self.rubs, friction, 0.0)
        self._threshold = np.where(threshold >= 0, threshold, np.where(self.rubs, np.inf, 0.0))
        self.tied = np.repeat([contact.tied for contact in contacts], counts)
        self.bilateral = np.repeat([contact.bilateral for contact in contacts], counts)

    @staticmethod
    def Suit(contacts: Sequence[LACContact]) -> bool:
        """Do all contacts have laws of projection and even pressures, with no other unknowns?"""
        for contact in contacts:
            table = contact.form.Table()
            held = table["prescribed"][table["area"] > 0]
            special = contact.own_law or contact.fluxes or contact.components == 1
            if special or len(contact.form.ToolDofs()) or np.any(table["ends"]) or np.any(held):
                return False
        return True

    def Bound(self, pressure: np.ndarray) -> np.ndarray:
        """Of tangential tractions (k,), 0 without friction, under pressures (k,)."""
        if self.bound is not None:
            return self.bound
        coulomb = np.where(self.rubs, self._friction * np.abs(pressure), np.inf)
        return np.minimum(coulomb, self._threshold)

    def After(self, jump: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps (k,) and slips (k, d) after a jump."""
        nearer = np.sum(jump * self.normal, axis=1)
        return self.gap - nearer, self.slip + jump - nearer[:, None] * self.normal

    def Trial(self, traction: np.ndarray, jump: np.ndarray) -> np.ndarray:
        """The trial tractions (k, d) after a jump."""
        gap, slip = self.After(jump)
        return traction - self.stiffness[:, None] * (slip - gap[:, None] * self.normal)

    def Project(self, trial: np.ndarray) -> Answer:
        """The projection of trial tractions (k, d), see `Project` in cpp/contact/law.hpp."""
        n, one = self.normal, np.eye(trial.shape[1])
        pressure = -np.sum(trial * n, axis=1)
        along = trial + pressure[:, None] * n
        size, bound = np.linalg.norm(along, axis=1), self.Bound(pressure)
        sticks = self.tied | (size <= bound) & (bound > 0)
        opens = ~(self.tied | self.bilateral) & (pressure <= 0)
        way = along / np.maximum(size, SMALLEST)[:, None]
        nn, ee = (v[:, :, None] * v[:, None, :] for v in (n, way))
        turn, growth = bound / np.maximum(size, SMALLEST), self._Growth(pressure)
        slopes = nn + turn[:, None, None] * (one - nn - ee)
        slopes -= growth[:, None, None] * way[:, :, None] * n[:, None, :]
        traction = bound[:, None] * way - pressure[:, None] * n
        kinds = [opens, sticks]
        return Answer(
            np.select(kinds, [0, 1], 2),
            np.select([kind[:, None] for kind in kinds], [0.0, trial], traction),
            np.select([kind[:, None, None] for kind in kinds], [0.0, one], slopes),
        )

    def _Growth(self, pressure: np.ndarray) -> np.ndarray:
        """How bounds (k,) grow with pressures."""
        if self.bound is not None:
            return np.zeros(len(pressure))
        coulomb = self._friction * np.abs(pressure) <= self._threshold
        return np.where(coulomb, np.sign(pressure) * self._friction, 0.0)

    def Barriers(self, pressure: float, gap: np.ndarray) -> list[Barrier | Tie]:
        """The laws of all contacts on the way of an interior point method, with given bounds."""
        return [self._Barrier(part, pressure, gap[part]) for part in self.parts]

    def _Barrier(self, part: slice, pressure: float, gap: np.ndarray) -> Barrier | Tie:
        traction, normal, stiffness = (
            values[part] for values in (self.traction, self.normal, self.stiffness)
        )
        if np.any(self.tied[part]):
            return Tie(traction, stiffness)
        press = Unilateral(gap, stiffness, pressure)
        product = np.mean(press.products) if len(gap) else 0.0
        if np.any(self.bilateral[part]):
            press = Bilateral(-np.sum(traction * normal, axis=1), stiffness, pressure)
        return Barrier(press, normal, gap, self.bound[part], product)

    def Place(self, laws: Sequence[Barrier | Tie], jump: np.ndarray) -> None:
        """Let those laws know of a jump."""
        gap, slip = self.After(jump)
        for law, part in zip(laws, self.parts, strict=True):
            law.Place(self.normal[part], gap[part], slip[part])
