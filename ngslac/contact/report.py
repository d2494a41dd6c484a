# SPDX-License-Identifier: LGPL-2.1-or-later
"""A report on a contact, for those that do not behave as expected."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from ngsolve import H1

from ngslac.arguments import ShownPoint
from ngslac.arrays import AsNumPy
from ngslac.contact.certificate import CertificateOf
from ngslac.contact.neighbours import Neighbours

if TYPE_CHECKING:
    from ngslac._ngslac import LACSpace
    from ngslac.contact.contact import LACContact

__all__ = ["ContactReport"]


class ContactReport:
    """Sizes and quality of a pairing; `print` it.

    Attributes
    ----------
    nmacros, nsegments : int
    active : bool
        Is contact switched on? Else nothing has a partner.
    area, paired_area : float
        Slave area, and the part of it that faces the master.
    unpaired, partial : (n,) int
        Macro-elements without a partner, and those that face the master in part only.
    min_gap, max_gap : float
        Mean gaps of paired macro-elements at the last evaluation; negative: penetration.
    penetrating : (n,) int
        Macro-elements that penetrate by more than a thousandth of their size.
    overlapping : (n,) int
        Macro-elements that lie behind the master deeper than contact looks for it, partly at least.
    deepest : float
        How deep that is at most; 0 where there are none.
    prescribed : (n,) int
        Macro-elements whose slave displacement is prescribed in some directions: there they stick
        elastically, or carry the pressure so if the normal is one of them.
    large, bent : (n,) int
        Macro-elements of more than four times the usual number of faces, and those whose normals
        differ so much that their mean is shorter than 0.9.
    undefined : (n,) int
        Macro-elements with an area, a normal or a gap that is not finite.
    shared : (n,) int
        Mesh vertices of both surfaces: there nothing can open or slide, as at the tip of a crack.
    narrow : (n,) int
        Closed macro-elements that have no closed neighbours to their sides: contact there is one
        macro-element wide, and its pressure a mean over what is not resolved.
    outside : (n,) int
        Closed macro-elements that stick out of the master by more than half.
    certificate : Certificate or None
        What is left at points of conditions that hold in the mean; None before a solution.
    """

    def __init__(self, contact: LACContact):
        table, self.active = contact.Table(), contact.active
        area, full = table["area"], table["fullarea"]
        paired = area > 0
        self.nmacros, self.nsegments = len(area), contact.form.nsegments
        self.area, self.paired_area = float(full.sum()), float(area.sum())
        self.unpaired = np.flatnonzero(~paired)
        self.partial = np.flatnonzero(paired & (area < (1 - 1e-6) * full))
        gaps = table["gap"][paired]
        # Where only slivers overlap there is no gap.
        self.min_gap, self.max_gap = (
            (float(gaps.min()), float(gaps.max())) if len(gaps) else (np.nan, np.nan)
        )
        size = contact._Sizes()
        self.penetrating = np.flatnonzero(paired & (table["gap"] < -1e-3 * size))
        known = contact.form.Table()
        self.prescribed = np.flatnonzero(known["prescribed"] > 0.5)
        faces = _FacesOf(contact.surface)
        self.large = np.flatnonzero(faces > 4 * np.median(faces))
        self.bent = np.flatnonzero(known["flatness"] < 0.9)
        finite = [np.isfinite(table[name]) for name in ("area", "fullarea")]
        finite.append(np.isfinite(table["gap"]) | ~paired)
        self.undefined = np.flatnonzero(~np.all([*finite, *np.isfinite(table["normal"]).T], axis=0))
        self.macro_size = (float(size.min()), float(size.max()))
        self.where = table["x"]
        unmet = len(self.unpaired) or len(self.partial)
        depths = contact.form.Overlaps() if unmet else np.zeros(len(area))
        self.overlapping, self.deepest = np.flatnonzero(depths), float(depths.max())
        self.shared = _SharedVertices(contact)
        closed = (table["status"] > 0) & paired
        self.outside = np.flatnonzero(closed & (area < 0.5 * full))
        self.narrow = np.array([], int)
        if not contact.tied and closed.any():
            self.narrow = Neighbours(contact.surface, contact.surface.mesh).Narrow(closed)
        solved = self.active and contact._solution is not None and contact.components > 1
        self.certificate = CertificateOf(contact) if solved else None
        self._corners = [contact.surface.mesh.vertices[v].point for v in self.shared[:3]]

    def _Some(self, macros: np.ndarray) -> str:
        some = ", ".join(f"{m} at {ShownPoint(self.where[m])}" for m in macros[:3])
        return some + (f" and {len(macros) - 3} more" if len(macros) > 3 else "")

    def __repr__(self) -> str:
        return str(self)

    def __str__(self) -> str:
        lines = [
            f"macro-elements   {self.nmacros}, size {self.macro_size[0]:.4g} to "
            f"{self.macro_size[1]:.4g}; {self.nsegments} segments",
            f"paired area      {self.paired_area:.6g} of {self.area:.6g} "
            f"({100 * self.paired_area / self.area:.1f} %)",
            f"gap              {self.min_gap:.4g} to {self.max_gap:.4g}",
        ]
        if not self.active:
            return lines[0] + "\nswitched off     no forces until Activate(gf)"
        remarks = {
            "without partner": (self.unpaired, ""),
            "overhanging": (self.partial, ""),
            "prescribed": (self.prescribed, ""),
            "of many faces": (self.large, ""),
            "bent": (self.bent, ""),
            "not a number": (self.undefined, ""),
            "penetrating": (self.penetrating, f", by up to {-self.min_gap:.4g}"),
            "deep overlap": (
                self.overlapping,
                f", up to {self.deepest:.4g} behind the master, where it is not seen: give "
                f"penetration = {1.1 * self.deepest:.4g}, or move the bodies apart",
            ),
            "not resolved": (
                self.narrow,
                ", where contact is one of them wide: refine the slave there",
            ),
            "half outside": (
                self.outside,
                ", closed, by more than half beyond the end of the master: refine the slave there, "
                "or take edges=True",
            ),
        }
        lines += [
            f"{what:16} {len(macros)} macro-elements{words}: {self._Some(macros)}"
            for what, (macros, words) in remarks.items()
            if len(macros)
        ]
        if len(self.shared):
            points = ", ".join(map(ShownPoint, self._corners))
            lines.append(f"shared vertices  {len(self.shared)}, of slave and master: {points}")
        if self.certificate is not None:
            lines.append(str(self.certificate))
        return "\n".join(lines)


def _FacesOf(space: LACSpace) -> np.ndarray:
    """Number of faces of each macro-element."""
    macros = np.array(space.macros)
    return np.bincount(macros[macros >= 0], minlength=space.nmacros)


def _SharedVertices(contact: LACContact) -> np.ndarray:
    """Numbers of the vertices that slave and master share."""
    if contact.master is None:
        return np.array([], int)
    slave, corners = contact.surface.slave, H1(contact.surface.mesh, order=1)
    both = corners.GetDofs(slave) & corners.GetDofs(contact.facing)
    # A surface that may touch itself is both.
    return np.flatnonzero(AsNumPy(both & ~corners.GetDofs(slave * contact.facing)))
