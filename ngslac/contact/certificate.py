# SPDX-License-Identifier: LGPL-2.1-or-later
"""Violation at points of contact conditions, which hold in the mean over macro-elements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ngslac.arguments import ShownPoint
from ngslac.contact.neighbours import Neighbours
from ngslac.recovery.surface import SlaveSurface

if TYPE_CHECKING:
    from ngsolve import GridFunction

    from ngslac.contact.contact import LACContact

__all__ = ["Certificate", "CertificateOf", "Excess", "PointsInside"]

# Surfaces that are so steep meet at a corner or an edge. That is inside from the first part of a
# macro-element's size on; smooth surfaces sink in by less than the second before mean gaps close.
STEEP, CORNER, SMOOTH = 0.5, 1e-3, 0.1
# Of the largest traction: what is below is rounding.
ROUNDING = 1e-10


@dataclass(frozen=True)
class Excess:
    """By how much a condition is violated at a point, at most.

    Attributes
    ----------
    value : float
        A length, or a stress.
    relative : float
        To the size of the macro-element, or to the largest traction.
    place : (d,) array
    """

    value: float
    relative: float
    place: np.ndarray


@dataclass(frozen=True)
class Certificate:
    """Where a state violates contact at points, and by how much; None: nowhere.

    Attributes
    ----------
    penetration : Excess or None
        Of points of the slave and of corners of the master; surfaces that are tied keep their
        distance in the mean only.
    tension : Excess or None
        Of the macro-elements, on which the pressure is constant: where contact cannot open.
    friction : Excess or None
        Of the tangential traction over the bound, where this varies inside of macro-elements.
    """

    penetration: Excess | None
    tension: Excess | None
    friction: Excess | None

    def __str__(self) -> str:
        parts = [
            _Words("penetration", self.penetration, "macro-element"),
            _Words("tension", self.tension, "largest traction"),
            _Words("above friction's bound", self.friction, "largest traction"),
        ]
        lines = ["at points        " + parts[0], *(f"{'':17}{part}" for part in parts[1:])]
        return "\n".join(lines) + " (means are exact)"


def _Words(what: str, excess: Excess | None, whole: str) -> str:
    """Describe how far one condition is violated, as part of a line."""
    if excess is None:
        return f"{what} none"
    return (
        f"{what} up to {excess.value:.4g}, {100 * excess.relative:.2g} % of the {whole}, "
        f"at {ShownPoint(excess.place)}"
    )


def CertificateOf(contact: LACContact) -> Certificate:
    """Of the last evaluated state of a contact."""
    table = contact.Table()
    largest = np.linalg.norm(table["traction"], axis=1).max(initial=0)
    return Certificate(
        None if contact.tied else _Penetration(contact, table),
        _Tension(table, largest),
        _AboveBound(contact, table, largest),
    )


def _Penetration(contact: LACContact, table: dict[str, np.ndarray]) -> Excess | None:
    """The deepest overlap at a point; None if there is none."""
    gaps = PointGaps(contact, contact._solution)
    deepest = np.argmin(gaps.least)
    depth = -float(gaps.least[deepest])
    if not depth > 0:
        return None
    return Excess(depth, depth / contact._Sizes()[deepest], gaps.places[deepest])


def _Tension(table: dict[str, np.ndarray], largest: float) -> Excess | None:
    least = np.argmin(table["pressure"])
    value = -float(table["pressure"][least])
    if not value > ROUNDING * largest:
        return None
    return Excess(value, value / largest, table["x"][least])


def _AboveBound(contact: LACContact, table: dict[str, np.ndarray], largest: float) -> Excess | None:
    """Of the tangential traction, constant on a macro-element, over friction's bound at points."""
    limits = {name: contact._state.setup[name] for name in ("friction", "tresca")}
    limits = {name: limit for name, limit in limits.items() if limit is not None}
    if not limits:
        return None
    surface, pressure = SlaveSurface(contact), table["pressure"]
    face, at = surface.table[:, 0].astype(int), surface.table[:, 2:4]
    bound = np.full(len(face), np.inf)
    for name, limit in limits.items():
        factor = np.abs(pressure)[surface.macro] if name == "friction" else 1
        bound = np.minimum(bound, surface.Evaluate(limit, face, at)[:, 0] * factor)
    across = np.linalg.norm(table["traction"] + pressure[:, None] * table["normal"], axis=1)
    closed = (table["status"] > 0)[surface.macro]
    excess = np.where(closed, across[surface.macro] - bound, 0)
    value = float(excess.max(initial=0))
    if not value > ROUNDING * largest:
        return None
    return Excess(value, value / largest, surface.position[np.argmax(excess)])


def PointsInside(
    contact: LACContact, gf: GridFunction | None = None
) -> tuple[float, np.ndarray, float] | None:
    """The deepest point inside of the other body where contact is open, or None.

    Depth, place on the slave (d,), and size of the macro-element.

    Means over macro-elements do not see a corner, or an edge, that is small beside them, of the
    slave or of the master. Beside closed macro-elements points that lie inside are normal, as they
    are where a smooth surface is about to touch: those do not count. `gf` is what the contact's
    form was evaluated for last; None: that of `LACContact.Evaluate`.
    """
    entries = contact._solution if gf is None else gf.vec.FV().NumPy()
    if entries is None or contact.tied or contact.bilateral or not contact.active:
        return None
    table = contact.Table()
    neighbours = Neighbours(contact.surface, contact.surface.mesh)
    beside = neighbours.Near(table["status"] > 0)
    away = ~beside & (table["area"] > 0)
    if not away.any():
        return None
    gaps, size = PointGaps(contact, entries), contact._Sizes()
    steep = (gaps.slope > STEEP) & ~neighbours.Near(beside)
    limit = np.where(steep, CORNER, SMOOTH) * size
    depth = np.where(away & (gaps.least < -limit), -gaps.least, 0)
    deepest = np.argmax(depth)
    if not depth[deepest] > 0:
        return None
    return float(depth[deepest]), gaps.places[deepest], float(size[deepest])


class PointGaps:
    """The gaps at the points of each macro-element."""

    def __init__(self, contact: LACContact, entries: np.ndarray):
        d = contact.surface.mesh.dim
        table = contact.form.GapRanges(entries).reshape(-1, 2 + 2 * d)
        paired = np.isfinite(table[:, 0])
        # Infinite without a partner; where it is least; the slope from there to the greatest.
        self.least, self.greatest = np.where(paired, table[:, :2].T, np.inf)
        self.places = table[:, 2 : 2 + d]
        way = np.linalg.norm(table[:, 2 + d :] - self.places, axis=1)
        rise = np.where(paired, table[:, 1] - table[:, 0], 0)
        self.slope = np.divide(rise, way, out=np.zeros(len(way)), where=way > 0)
