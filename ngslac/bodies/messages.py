# SPDX-License-Identifier: LGPL-2.1-or-later
"""Messages about bodies that nothing holds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ngslac.bodies.bodies import Bodies
    from ngslac.contact.contact import LACContact

__all__ = [
    "DrivenMessage",
    "FewMessage",
    "FloatingMessage",
    "IdleMessage",
    "LostMessage",
    "OverloadMessage",
    "OwnLawMessage",
    "RubberMessage",
    "SlidingMessage",
]

MOST = 6  # motions that a message names


def _Listed(motions: Sequence[str], verb: str = "floats") -> str:
    """The first of many motions, with another verb."""
    more = [f"and {len(motions) - MOST} motions more"] if len(motions) > MOST else []
    return "; ".join([*motions[:MOST], *more]).replace(" floats (", f" {verb} (")


def FloatingMessage(floating: Sequence[str]) -> str:
    return (
        _Listed(floating)
        + ": no Dirichlet condition and no active contact holds it. Constrain it, start in "
        "contact, or prescribe a displacement in place of a force"
    )


def DrivenMessage(floating: Sequence[str]) -> str:
    """For loads that move bodies along what nothing resists."""
    return (
        "no equilibrium: "
        + _Listed(floating)
        + " under the loads: no Dirichlet condition and no contact resists this motion. Constrain "
        "it, add friction, or prescribe a displacement in place of a force"
    )


def IdleMessage(floating: Sequence[str]) -> str:
    return (
        _Listed(floating, "is free")
        + ": nothing holds it and nothing drives it, so that it stays where it was. Constrain it "
        "if that is not meant"
    )


def FewMessage(contacts: Sequence[LACContact]) -> str:
    """Where there are so few macro-elements that bodies may turn on them; empty if nowhere."""
    active = [c for c in contacts if c.active]
    few = [c for c in active if np.count_nonzero(c.Table()["area"]) < c.mesh.dim]
    return "".join(
        f". Contact number {contacts.index(c)} holds on average over "
        f"{np.count_nonzero(c.Table()['area'])} macro-elements only: refine its slave surface, or "
        "take BubbleVectorH1 for displacements of order 1"
        for c in few
    )


def SlidingMessage(floating: Sequence[str]) -> str:
    """For bodies that slide off where friction is at its limit."""
    return (
        "no equilibrium is found: "
        + _Listed(floating, "slides away")
        + ": friction is at its limit wherever contact holds it. Constrain it, or prescribe a "
        "displacement in place of a force"
    )


def OverloadMessage(bodies: Bodies) -> str:
    """For a load that seems to exceed what friction can carry."""
    names = [bodies.name(part) for part, _ in bodies.floating[:3]]
    return (
        "nearly all closed macro-elements slip: the load seems to exceed what friction can carry"
        + (f" on body {' or '.join(names)}" if names else "")
        + ". Prescribe a displacement in place of a force to follow the sliding"
    )


def OwnLawMessage() -> str:
    """Advice on laws of the user's own."""
    return (
        ". A law of your own needs a traction without jumps, and right derivatives (compare those "
        "of one in NumPy with differences); where it softens, small steps and several faces in "
        "the length over which it does, and beyond the largest force that it bears there is no "
        "state: prescribe a displacement"
    )


def RubberMessage(iterations: int, nu: float) -> str:
    """Of a first solve of a material that hardly changes its volume."""
    return (
        f"the first solve has taken {iterations} iterations, as a material hardly changes its "
        f"volume (Poisson's ratio about {nu:.4g}): take its pressure as another unknown, as "
        "NeoHooke(F, young, nu, pressure=p) does, see the how-to on rubber"
    )


def FarMessage() -> str:
    return (
        ". Loose bodies that fall, roll or slide far before they rest have no equilibrium near "
        "the start: let them move in time by TimeStepper"
    )


def LostMessage(lost: Sequence[str]) -> str:
    return (
        _Listed(lost)
        + ": the loads exceed what contact and friction can carry. Constrain it, or prescribe a "
        "displacement in place of a force"
    )
