# SPDX-License-Identifier: LGPL-2.1-or-later
"""Points on the slave faces, where glyphs stand and profiles are taken."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from ngsolve import CF, ET, CoefficientFunction, GridFunction, IntegrationRule, x, y, z

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact

__all__ = ["FacePoints", "OnePoint"]

CENTER = {ET.SEGM: (0.5, 0), ET.TRIG: (1 / 3, 1 / 3), ET.QUAD: (0.5, 0.5)}


def OnePoint(points: dict[ET, tuple[float, float]] = CENTER) -> dict[ET, IntegrationRule]:
    """Rules of one point for each kind of face, by default its middle."""
    return {kind: IntegrationRule([point], [1.0]) for kind, point in points.items()}


class FacePoints:
    """Centres of the slave faces of a contact, and in 2D their ends, perhaps deformed."""

    def __init__(
        self, contact: LACContact, deformation: GridFunction | CoefficientFunction | None = None
    ):
        self.contact, self.region = contact, contact.surface.slave
        self._position = CF((x, y, z)[: contact.surface.mesh.dim])
        if deformation is not None:
            self._position += deformation
        macros = np.array(contact.surface.macros)
        self.macro = macros[macros >= 0]  # of each face
        self.normals = contact.Table()["normal"][self.macro]
        self.centers = self.Positions()
        box = [self.centers]
        if contact.surface.mesh.dim == 2:
            self.ends = np.stack([self.Positions(s) for s in (0, 1)])
            box = list(self.ends)
        self.diameter = np.linalg.norm(np.ptp(np.concatenate(box), axis=0))

    def Positions(self, place: float | None = None) -> np.ndarray:
        """Points (n, d) in the middle of the faces, in 2D also at a coordinate from 0 to 1."""
        return self.Evaluate(self._position, place)

    def Evaluate(self, function: CoefficientFunction, place: float | None = None) -> np.ndarray:
        """Values (n, ...) of a function at the `Positions`."""
        rules = OnePoint() if place is None else OnePoint({ET.SEGM: (place, 0)})
        values = function(self.contact.surface.mesh.MapToAllElements(rules, self.region))
        return values.reshape(len(self.macro), -1)

    def MacroMeans(self, values: np.ndarray) -> np.ndarray:
        """Means (nmacros, d) over the faces of each macro-element of `values` (n, d)."""
        counts = np.bincount(self.macro)[:, None]
        sums = [np.bincount(self.macro, column) for column in values.T]
        return np.stack(sums, axis=1) / counts
