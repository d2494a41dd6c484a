# SPDX-License-Identifier: LGPL-2.1-or-later
"""Is an equilibrium of laws that soften stable?"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ngslac.arrays import Sparse
from ngslac.errors import ContactConvergenceError

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ngslac.solve.system import Configuration, System

__all__ = ["Stability", "UnstableError"]

# Growth of a push from which on a state is unstable, and a relative change that ends the iteration.
GROWS, STILL = 1.01, 0.02
# Steps of the power iteration: at first, and where it goes on from the step before.
FIRST, LATER = 30, 4
# Part of a new random push in one that goes on, for what was no part of it so far.
NEW = 0.1
# Length of the push out of an unstable state, relative to the smallest macro-element.
LENGTH = 1e-3


class UnstableError(ContactConvergenceError):
    """Energy falls along a `push` (n,) out of the equilibrium at a `place`."""

    def __init__(self, place: Configuration, push: np.ndarray):
        super().__init__(
            "the equilibrium is unstable, as a law softens: is the sign of its traction right?"
        )
        self.place, self.push = place, push


class Stability:
    """The second look at states with a law of one's own: does energy fall on a way out of them?

    Newton's method comes to any equilibrium, a descent goes away from an unstable one. The largest
    growth of its steps is found by power iteration, from step to step. Bodies are stable by
    themselves, and what is condensed is not looked at.
    """

    def __init__(self):
        self.push = None

    @property
    def softened(self) -> bool:
        """Did a law soften in the state looked at last?"""
        return self.push is not None

    def Check(self, system: System) -> None:
        """Raise an `UnstableError`, if the state of a System is an unstable equilibrium."""
        if not system.own_law or system.bulk.a.condense:
            return
        if not system.Softens():
            self.push = None
            return
        growth = self._Iterate(system, Softening(system))
        if growth > GROWS:
            length = LENGTH * np.min(system.Sizes())
            push = length / np.abs(self.push).max() * self.push
            raise UnstableError(system.Place(), push)

    def _Iterate(self, system: System, softening: csr_matrix) -> float:
        """The growth of `push`, which becomes the motion that grows most."""
        displacements = system.residual.displacements
        moves = displacements & system.linear.free
        random = np.random.default_rng(0).normal(size=len(moves))
        random = system.layout.Consistent(random) * moves
        random /= np.linalg.norm(random)
        known = self.push is not None and len(self.push) == len(moves)
        push = self.push + NEW * random if known else random
        growth = 0.0
        for _ in range(LATER if known else FIRST):
            mats = [contact.form.mat for contact in system.contacts]
            rows = system.MakeLinearSystem(mats, softening @ (push / np.linalg.norm(push)))
            push = system.linear.SolveShifted(rows, displacements) * moves
            before, growth = growth, np.linalg.norm(push)
            if growth == 0 or abs(growth - before) < STILL * growth:
                break
        self.push = push / growth if growth else random
        return growth


def Softening(system: System) -> csr_matrix:
    """The part that the matrix of a descent leaves out, which is assembled last; sparse."""
    state, found = system.Measure(), []
    for convex in (False, True):
        system.Linearize(state, convex=convex)
        mats = [Sparse(contact.form.mat) for contact in system.contacts]
        found.append(sum(mats[1:], mats[0]))
    return found[1] - found[0]
