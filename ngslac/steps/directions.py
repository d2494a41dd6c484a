# SPDX-License-Identifier: LGPL-2.1-or-later
"""Directions of pressures that do no work where surfaces slide along each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ngslac._ngslac import Side
from ngslac.parallel.form import JumpRows

if TYPE_CHECKING:
    from ngsolve import GridFunction

    from ngslac.contact.contact import LACContact

__all__ = ["Directions"]

# Longest vector that may turn a direction, a unit vector: larger angles have other reasons.
LONGEST = 0.5
# Motion between two surfaces that is none, relative to all motion of the step.
STILL = 1e-8


class Directions:
    """Turns the pressures of large sliding until their work is that of the master's normal.

    Gaps do not change where the slave slides along the master: only along the normals of the
    master, from where they are at the begin of a step to where they are at its end, pressures
    should do work. The direction n in which they push is another one, that of the end of the step
    and between the normals of both sides. So it gets the shortest vector in addition with which
    n.d is right for the mean relative motion d of the macro-element in the step, which is along d:
    a discrete gradient (Gonzalez 1996). The forces on both sides remain opposite and equal.
    """

    def __init__(self, contacts: Sequence[LACContact]):
        self.contacts, self._start = contacts, None
        # With which the last solution was found; no rows where they do not count.
        self.used = [np.zeros((c.space.nmacros * Turns(c), c.mesh.dim)) for c in contacts]
        self._next = self.used

    def State(self) -> dict:
        """What the next step depends on."""
        return {"used": self.used, "next": self._next}

    def SetState(self, state: dict) -> None:
        """Go back to a `State`."""
        self.used, self._next = state["used"], state["next"]

    def Begin(self, gf: GridFunction) -> None:
        """A step begins at a solution."""
        self._start = [self._Facing(contact, gf) for contact in self.contacts]

    @staticmethod
    def _Facing(contact: LACContact, gf: GridFunction) -> np.ndarray | None:
        """Mean normals (m, d) of the master, 0 where it is not seen."""
        if not Turns(contact):
            return None
        contact.Follow(gf)
        contact.Evaluate(gf)
        return contact.form.Table()["facing"]

    def Learn(self, gf: GridFunction, motion: np.ndarray) -> float:
        """Find the vectors of the `Next` solution from the motion (n,) to this one."""
        found = [self._LearnOf(k, gf, motion) for k in range(len(self.contacts))]
        self._next = [vectors for vectors, _ in found]
        return sum(work for _, work in found)

    def Next(self) -> None:
        """Use what was learnt last."""
        self.used = self._next

    def _LearnOf(self, k: int, gf: GridFunction, motion: np.ndarray) -> tuple[np.ndarray, float]:
        """The vectors of one contact, and the work that they change."""
        contact, begin = self.contacts[k], self._start[k]
        if not Turns(contact):
            return self.used[k], 0.0
        end, table, form = self._Facing(contact, gf), contact.Table(), contact.form
        if not np.any(table["status"]):
            return 0 * end, 0.0
        sees = np.any(begin, axis=1)[:, None] & (np.sum(begin * end, axis=1) > 0)[:, None]
        normal = -Unit(np.where(sees, begin, 0) + end)
        jump, first = JumpRows(form, Side.both), form.offset * form.fes.dim
        moved = (jump @ motion[first : first + jump.shape[1]]).reshape(end.shape)
        still = STILL * table["fullarea"] * np.max(np.abs(motion), initial=0)
        works = (table["status"] > 0) & (np.linalg.norm(moved, axis=1) > still)
        along = Unit(moved)
        off = np.sum((normal - table["normal"]) * along, axis=1) * works
        vectors = np.clip(off, -LONGEST, LONGEST)[:, None] * along
        change = np.sum((vectors - self.used[k]) * moved, axis=1) * works
        return vectors, float(np.abs(table["pressure"]) @ np.abs(change))


def Turns(contact: LACContact) -> bool:
    """Do pressures get directions? Those of tools and tied surfaces keep theirs."""
    return contact.finite and contact.master is not None and not contact.tied


def Unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (m, d) of length 1, or 0."""
    size = np.linalg.norm(vectors, axis=1)[:, None]
    return vectors / np.where(size > 0, size, 1)
