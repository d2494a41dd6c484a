# SPDX-License-Identifier: LGPL-2.1-or-later
"""The energy balance of a motion."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from ngslac.steps.control import StepLine

if TYPE_CHECKING:
    from ngsolve import GridFunction

    from ngslac.contact.contact import LACContact

__all__ = ["ContactWorks", "EnergyBalance", "TimeStep"]

# Part of the energy lost so far that counts as being at hand.
PAST = 0.01


@dataclass(frozen=True)
class EnergyBalance:
    """Energies now, and works since the beginning (energy; per unit thickness in 2D).

    ``kinetic + internal = their start + external - friction - impact - algorithmic``.

    Attributes
    ----------
    time : float
    kinetic : float
    internal : float
        Work done on the material: the strain energy, where it is elastic.
    external : float
        Work of loads, and of supports and obstacles that move.
    friction : float
        Dissipated by sliding, >= 0.
    impact : float
        Lost when surfaces meet: the part of the motion that the mesh cannot reflect. `friction`
        and `impact` together never decrease.
    algorithmic : float
        Dissipated by the time integration; 0 for a linear bulk with ``rho_inf=1``, kept from below
        0 for a nonlinear one.
    """

    time: float = 0.0
    kinetic: float = 0.0
    internal: float = 0.0
    external: float = 0.0
    friction: float = 0.0
    impact: float = 0.0
    algorithmic: float = 0.0

    @property
    def total(self) -> float:
        """Kinetic and internal energy together."""
        return self.kinetic + self.internal

    def Won(self, before: EnergyBalance) -> float:
        """Energy that contact and time integration have brought in since another balance.

        Parameters
        ----------
        before : EnergyBalance

        Returns
        -------
        float
            Relative to the largest energy or work at hand; not below 0.
        """
        contact = self.friction + self.impact - before.friction - before.impact
        won = max(0.0, -contact) + max(0.0, before.algorithmic - self.algorithmic)
        work = abs(self.external - before.external)
        return won / (max(self.AtHand(before), work) or 1.0)

    def AtHand(self, before: EnergyBalance) -> float:
        """The largest energy of both balances, or work of internal forces in between.

        A part of what has been lost counts, too: of bodies that came to rest little else is left.

        The internal energy has no zero of its own where it is a work and the stiffness changes, or
        loads are in it: it may be below zero.

        Parameters
        ----------
        before : EnergyBalance

        Returns
        -------
        float
        """
        energies = (max(balance.total, balance.kinetic) for balance in (self, before))
        lost = before.friction + before.impact + before.algorithmic
        return max(*energies, abs(self.internal - before.internal), PAST * lost)

    def After(
        self,
        time: float,
        kinetic: float,
        *,
        internal: float,
        external: float,
        friction: float,
        impact: float,
    ) -> EnergyBalance:
        """The balance after a step.

        Parameters
        ----------
        time, kinetic : float
            At the end of the step.
        internal, external, friction, impact : float
            Works done and energies lost in it.

        Returns
        -------
        EnergyBalance
        """
        losses = friction + impact
        return EnergyBalance(
            time,
            kinetic,
            self.internal + internal,
            self.external + external,
            self.friction + friction,
            self.impact + impact,
            self.algorithmic + self.kinetic - kinetic - internal + external - losses,
        )

    @classmethod
    def Table(cls, balances: Iterable[EnergyBalance]) -> dict[str, np.ndarray]:
        """Balances as arrays.

        Parameters
        ----------
        balances : iterable of EnergyBalance

        Returns
        -------
        dict
            Name -> (n,) array, for each attribute.
        """
        rows = np.array([astuple(balance) for balance in balances]).reshape(-1, len(fields(cls)))
        return {f.name: column for f, column in zip(fields(cls), rows.T, strict=True)}

    def __str__(self) -> str:
        names = ("kinetic", "internal", "external", "friction", "impact", "algorithmic")
        return "  energy: " + "  ".join(f"{name} {getattr(self, name):.5g}" for name in names)


@dataclass(frozen=True)
class TimeStep:
    """A converged time step.

    Attributes
    ----------
    number : int
    time : float
        At the end of the step.
    iterations : int
        Linear solves of this step (those of failed attempts not counted).
    cuts : int
        How often the step was halved before it converged.
    balance : EnergyBalance
    """

    number: int
    time: float
    iterations: int
    cuts: int
    balance: EnergyBalance

    def __str__(self) -> str:
        return f"{StepLine(self, 'time')}{self.balance}"


def ContactWorks(
    contacts: Sequence[LACContact], gf: GridFunction, motion: np.ndarray
) -> tuple[list[np.ndarray], float, float]:
    """Residuals (n,) of the contacts before the commit, their work, and what sliding dissipates."""
    residuals, friction = [], 0.0
    for contact in contacts:
        forces = gf.vec.CreateVector()
        contact.Evaluate(gf)
        contact.Apply(gf.vec, forces)
        residuals.append(contact.layout.Values(forces).copy())
        table = contact.Table()
        friction -= float(table["area"] @ np.sum(table["traction"] * table["slip"], axis=1))
    return residuals, -float(sum(residuals) @ motion), friction
