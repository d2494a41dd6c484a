# SPDX-License-Identifier: LGPL-2.1-or-later
"""The parts of a webgui scene of a contact: a function, objects, patches and a legend."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import CoefficientFunction, GridFunction, InnerProduct

from ngslac.output.fields import ARROWS, RECOVERED, FieldOf, NumbersOf
from ngslac.output.glyphs import Arrows, Bands, BarAreas, Bars, Lines, Ticks
from ngslac.output.shapes import Creases, Patch, Triangles

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact
    from ngslac.output.facepoints import FacePoints

__all__ = ["FlatMarks", "SolidMarks"]

COLOUR = "crimson"  # of bars and arrows in 2D
STATUS = {"open": "#808080", "stick": "#4169e1", "slip": "#ff9f1c"}
ALONE, GRAY = "no partner", STATUS["open"]
BODIES = {"opacity": 0.3, "behind": True}
BARS = {"opacity": 0.4, "flat": True}
HUES = 32  # of macro-elements
# Colours nearly as in the legend, with a little shade on curved faces.
LIGHT = {"ambient": 0.75, "diffuse": 0.25, "shininess": 10, "specularity": 0.05}
PALE = ([0.86, 0.89, 0.93], [0.94, 0.91, 0.85])  # of bodies side by side
# Towards the camera from a face that closes on itself.
ANYWHERE = np.array([0.6, -1.0, 0.5])
SIDEWAYS = 0.7  # of the direction to the camera, beside the normal
ROUND = 0.3  # mean of unit normals below which the face closes on itself
AROUND = 1.6  # radius of what is seen, by that of the slave face


class Marks:
    """Arguments of a scene: `shown`, `objects`, `patches`, `legend`, `settings`, `options`."""

    def __init__(self, contact: LACContact, field: str, faces: FacePoints, size: float | None):
        self.contact, self.field, self.faces, self.size = contact, field, faces, size
        self.objects, self.patches, self.settings, self.options = [], [], {}, {}
        self.legend = list(STATUS.items()) if field == "status" else []
        self.alone = np.isnan(contact.Table()["gap"])  # macro-elements without a partner
        if field in ("gap", "segments") and np.any(self.alone):
            self.legend = [(ALONE, GRAY)]
        if field == "segments":
            self.objects = [contact]
        elif field in ARROWS:
            vectors = np.nan_to_num(self.FaceValues())
            colour = COLOUR if contact.surface.mesh.dim == 2 else "black"
            self.objects = [Arrows(faces, field, colour, vectors, size)]

    def FaceValues(self) -> np.ndarray:
        """Values of the field, one for each slave face."""
        if self.field in RECOVERED:
            return np.squeeze(self.faces.Evaluate(FieldOf(self.contact, self.field)))
        return self.contact.Table()[self.field][self.faces.macro]


class FlatMarks(Marks):
    """In 2D: bars, bands and strokes on the bodies, which `background` colours."""

    def __init__(
        self,
        contact: LACContact,
        field: str,
        faces: FacePoints,
        background: CoefficientFunction | None,
        size: float | None,
    ):
        super().__init__(contact, field, faces, size)
        self.shown = [background, contact.surface.mesh]
        if background is None:
            self.shown = [contact.surface.mesh]
            self.options = {"colors": _Pale(len(contact.surface.mesh.GetMaterials()))}
        if field == "macros":
            self.patches = [Patch(field, COLOUR, Ticks(faces, size), flat=True)]
        elif field == "status":
            status = self.FaceValues()
            self.patches = [self._Band(*s, status == k) for k, s in enumerate(STATUS.items())]
        elif not self.objects:
            self._AddBars()

    def _Band(self, name: str, colour: str, chosen: np.ndarray) -> dict[str, Any]:
        return Patch(name, colour, Bands(self.faces, chosen), flat=True)

    def _AddBars(self) -> None:
        """Bars of the values, in outline and filled, and what has no partner."""
        values = np.nan_to_num(self.FaceValues())
        self.objects = [Bars(self.faces, self.field, COLOUR, values, self.size)]
        areas = BarAreas(self.faces, values, self.size)
        self.patches = [Patch(f"{self.field} (filled)", COLOUR, areas, **BARS)]
        if self.field == "gap" and np.any(self.alone):
            self.patches.append(self._Band(ALONE, GRAY, self.alone[self.faces.macro]))


class SolidMarks(Marks):
    """In 3D: colours on the slave faces, seen through the bodies."""

    def __init__(
        self,
        contact: LACContact,
        field: str,
        faces: FacePoints,
        deformation: GridFunction | CoefficientFunction | None,
        size: float | None,
    ):
        super().__init__(contact, field, faces, size)
        self.settings = {"Light": LIGHT}
        self.shown = [self._Colours(), contact.surface.slave]
        macros = np.array(contact.surface.macros)
        others = Triangles(contact.surface.mesh, macros < 0, deformation)
        self.patches = [Patch("Bodies", "silver", others, **BODIES)]
        if len(creases := Creases(contact.surface.mesh, deformation)):
            self.objects = [*self.objects, Lines("Creases", "gray", creases)]
        if field in ("gap", "segments") and np.any(self.alone):
            alone = (macros >= 0) & self.alone[macros]
            self.patches.append(
                Patch(ALONE, GRAY, Triangles(contact.surface.mesh, alone, deformation))
            )
        points = Triangles(contact.surface.mesh, macros >= 0, deformation).reshape(-1, 3)
        self.options |= View(points, faces.normals)

    def _Colours(self) -> CoefficientFunction:
        """The function whose values are colours; sets what belongs to it."""
        contact, field = self.contact, self.field
        if field == "status":
            self.options = {"min": 0, "max": 2, "colors": [_RGB(c) for c in STATUS.values()]}
            self.settings |= {"colormap_ncolors": 3, "Objects": {"Colorbar": False}}
            return contact.status
        if field == "macros":
            # Neighbours have nearly the same number: in order they would have the same colour.
            order = np.random.default_rng(1).permutation(contact.surface.nmacros)
            hues = min(HUES, len(order))
            self.options = {"min": -0.5, "max": hues - 0.5}
            self.settings |= {"colormap_ncolors": hues, "Objects": {"Colorbar": False}}
            return NumbersOf(contact, order % hues)
        if field in ("gap", "segments"):
            return self._Gaps()
        values = FieldOf(contact, field)
        return InnerProduct(values, values) ** 0.5 if field in ARROWS else values

    def _Gaps(self) -> GridFunction:
        """The webgui leaves out faces with nan, but not from the ends of the colours."""
        gaps = self.contact.Table()["gap"]
        known = gaps[~self.alone]
        self.options = {"min": known.min(initial=np.inf), "max": known.max(initial=-np.inf)}
        if not len(known):
            self.options = {"min": 0, "max": 1}
        return NumbersOf(self.contact, gaps)


def _RGB(colour: str) -> list[float]:
    """Parts from 0 to 1 of a colour such as "#808080"."""
    return [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]


def _Pale(count: int) -> list[list[float]]:
    """Colours of `count` materials."""
    return [PALE[k % len(PALE)] for k in range(count)]


def View(points: np.ndarray, normals: np.ndarray) -> dict[str, Any]:
    """Options euler_angles, center, radius of a scene that looks at a face with these `points`."""
    low, high = points.min(axis=0), points.max(axis=0)
    turn = scipy.spatial.transform.Rotation.from_matrix(_Axes(_Towards(normals)))
    return {
        "euler_angles": turn.as_euler("XYZ", degrees=True).round(3).tolist(),
        "center": ((low + high) / 2).tolist(),
        "radius": float(AROUND * np.linalg.norm(high - low) / 2),
    }


def _Towards(normals: np.ndarray) -> np.ndarray:
    """The direction from the faces to the camera."""
    mean = normals.mean(axis=0)
    if np.linalg.norm(mean) < ROUND:
        return ANYWHERE / np.linalg.norm(ANYWHERE)
    mean /= np.linalg.norm(mean)
    side = ANYWHERE - (ANYWHERE @ mean) * mean
    towards = mean + SIDEWAYS * side / np.linalg.norm(side)
    return towards / np.linalg.norm(towards)


def _Axes(towards: np.ndarray) -> np.ndarray:
    """Rows: what the picture has to its right, above, and towards the camera; z goes up."""
    up = np.eye(3)[2 if abs(towards[2]) < 0.95 else 1]
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(towards, right), towards])
