"""Points on the slave faces, where glyphs stand and profiles are taken."""

import numpy as np
from ngsolve import CF, ET, IntegrationRule, x, y, z

__all__ = ["FacePoints"]

CENTER = {ET.SEGM: (0.5, 0), ET.TRIG: (1 / 3, 1 / 3), ET.QUAD: (0.5, 0.5)}


class FacePoints:
    """Centres of the slave faces of a contact, and in 2D their ends, perhaps deformed.

    Attributes
    ----------
    macro : (n,) int
        Macro-element of each face.
    centers : (n, d)
    normals : (n, d)
        Mean normals of the macro-elements.
    ends : (2, n, d)
        In 2D only.
    diameter : float
        Of the box around the centres and ends.
    """

    def __init__(self, contact, deformation=None):
        self.contact, self.region = contact, contact.space.slave
        self._position = CF((x, y, z)[: contact.mesh.dim])
        if deformation is not None:
            self._position += deformation
        macros = np.array(contact.space.macros)
        self.macro = macros[macros >= 0]
        self.normals = contact.Table()["normal"][self.macro]
        self.centers = self._At(CENTER)
        box = [self.centers]
        if contact.mesh.dim == 2:
            self.ends = np.stack([self._At({ET.SEGM: (s, 0)}) for s in (0, 1)])
            box = list(self.ends)
        self.diameter = np.linalg.norm(np.ptp(np.concatenate(box), axis=0))

    def _At(self, points):
        rules = {kind: IntegrationRule([point], [0]) for kind, point in points.items()}
        at = self.contact.mesh.MapToAllElements(rules, self.region)
        return self._position(at).reshape(-1, self.contact.mesh.dim)

    def MacroMeans(self, values):
        """Means (nmacros, d) over the faces of each macro-element of `values` (n, d)."""
        counts = np.bincount(self.macro)[:, None]
        sums = [np.bincount(self.macro, column) for column in values.T]
        return np.stack(sums, axis=1) / counts
