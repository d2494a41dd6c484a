# SPDX-License-Identifier: LGPL-2.1-or-later
"""Continuous pressure and traction, as functions on the slave side."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import CF, H1, GridFunction, IfPos, InnerProduct, exp, sqrt

from ngslac.recovery.pressure import PressureFit
from ngslac.recovery.resultants import Balance
from ngslac.recovery.stencils import FitMeans, SecondDifferences
from ngslac.recovery.surface import Patches, SlaveSurface

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact

__all__ = ["Recovered"]

# Part of the automatic scale of stresses per length by which gaps within macro-elements count:
# the error of Hertz' pressure hardly changes between three quarters and one.
GAP_SHARE = 0.9
NEAREST = 1e-9  # of the largest pressure: less is none


class Recovered:
    """Continuous pressure and traction with the resultants of the multipliers.

    `LACContact.Recovered` makes it. Resultants are sums over the points of the contact; where the
    pressure ends within a face, `Integrate` with other points differs by what they miss of its end.

    Attributes
    ----------
    pressure : CoefficientFunction
        On the slave side, stress units; never negative, except where contact cannot separate.
    traction : CoefficientFunction
        Vector (d,), on the slave body.
    normal : CoefficientFunction
        Unit vector (d,) out of the slave, continuous; the pressure acts along it.
    """

    def __init__(self, contact: LACContact, displacement: GridFunction | None):
        self._contact, self._mesh = contact, contact.surface.mesh
        surface = self._surface = SlaveSurface(contact)
        self._table, self._unit = contact.Table(), 1.0
        self._SetUnit()
        self._SetNormals()
        pressure = self._table["pressure"]
        self._pulls = contact.tied or contact.bilateral
        if self._pulls:
            closed = surface.area > 0
        else:
            closed = (self._table["status"] > 0) & (surface.area > 0)
            closed &= pressure > NEAREST * np.abs(pressure).max(initial=0)
        self._patches = Patches(surface, closed)
        if not closed.any():
            self.pressure, self.traction = CF(0), CF((0,) * self._mesh.dim)
        elif self._pulls:
            self._SetPulling(closed)
        else:
            self._SetUnilateral(closed, displacement)

    def _SetUnit(self) -> None:
        """Stresses become parts of the largest one, whose squares are numbers."""
        largest = np.abs(self._table["traction"]).max(initial=0)
        if not np.isfinite(largest):
            raise ValueError(
                "the contact tractions of the last evaluation are not all finite, so that nothing "
                "can be recovered from them: Evaluate a solution first"
            )
        self._unit = largest or 1.0
        for name in ("traction", "pressure"):
            self._table[name] = self._table[name] / self._unit

    def _SetNormals(self) -> None:
        """Fit normals at the vertices to those of the macro-elements."""
        surface, normals = self._surface, self._table["normal"]
        near = _Units(surface.OnVertices(normals))
        self._rough = SecondDifferences(surface.points, near, surface.neighbours)
        paired = surface.area > 0
        ones = np.ones(len(surface.weight))
        fitted = FitMeans(surface, self._rough, ones, normals, paired)
        known = (surface.touches.T @ paired > 0)[:, None]
        self._normals = np.where(known, _Units(np.where(known, fitted, near)), near)
        normal = self._Field(self._normals)
        self.normal = normal / sqrt(InnerProduct(normal, normal))

    # --- what does not pull ----------------------------------------------------------------------

    def _SetUnilateral(self, closed: np.ndarray, displacement: GridFunction | None) -> None:
        """Pressure and traction of a contact that only presses."""
        surface, contact = self._surface, self._contact
        means = np.where(closed, self._table["pressure"], 0)
        if not contact.finite:
            # Of a constant traction on curved faces this is the mean of the pressure.
            means = means * contact.form.Table()["flatness"]
        samples = np.maximum(means[surface.macro] - self._PressureOfGaps(displacement), 0)
        fit = PressureFit(surface, self._rough, self._patches, means, samples)
        slip, slack = self._Friction(closed, fit.At())
        density = fit.At()
        root, square, blend, peak = map(self._Field, (fit.root, fit.square, fit.blend, fit.peak))
        square = (1 - blend) * root * root + blend * square
        pressure = sqrt(IfPos(square, square, 0))
        stretch = np.where(surface.shapes @ fit.blend > 0, density, surface.shapes @ fit.peak)

        def Stretched(extra: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return density + stretch * extra, stretch

        def Tilted(extra: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            pressure = density * np.exp(extra)
            return pressure, pressure

        # A linear pressure stays linear, unless it would pull somewhere.
        extra, found = self._Balanced(density, Stretched, slip, slack)
        if fit.Pulls(extra):
            extra, found = self._Balanced(density, Tilted, slip, slack)
            pressure = pressure * exp(self._Field(extra))
        else:
            pressure = pressure + IfPos(blend, pressure, peak) * self._Field(extra)
        self.pressure = self._unit * IfPos(pressure, pressure, 0)
        slip = self._Field(found)
        across = 1 + InnerProduct(slip, self.normal)
        self.traction = self.pressure * (slip - across * self.normal)

    def _PressureOfGaps(self, displacement: GridFunction | None) -> np.ndarray:
        """How much the gaps of points reduce the pressure; unknown without a displacement."""
        contact, surface = self._contact, self._surface
        if displacement is None:
            return np.zeros(len(surface.weight))
        # The scale is that of elements, macro-elements are softer, the wider.
        count = np.asarray(surface.touches.sum(axis=1)).ravel()
        spacing = surface.touches @ surface.share / count
        paired = (surface.area > 0) & (spacing > 0)  # the others have no points
        wide = np.divide(surface.area, spacing, out=np.ones_like(count), where=paired)
        scale = GAP_SHARE * contact.form.Table()["c"] / contact.stiffness / np.sqrt(wide)
        return scale[surface.macro] / self._unit * self._Gaps(displacement)

    def _Gaps(self, displacement: GridFunction) -> np.ndarray:
        """Gaps (q,) of the points, whose means are those of the macro-elements."""
        contact, surface = self._contact, self._surface
        if contact.finite:
            return surface.gap
        normal = self._table["normal"][surface.macro]
        gap = surface.gap * np.einsum("qk,qk->q", surface.normal, normal)
        return gap - np.einsum("qk,qk->q", surface.Jump(displacement), normal)

    def _Friction(self, closed: np.ndarray, density: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Tangential traction over pressure at the vertices, and how far it is from the bound."""
        surface, table = self._surface, self._table
        ones = np.ones(len(surface.vertices))
        if not self._contact.holds_tangentially:
            return np.zeros_like(self._normals), ones
        pressure = np.where(closed, table["pressure"], 1)[:, None]
        share = (table["traction"] + pressure * table["normal"]) / pressure * closed[:, None]
        slip = FitMeans(surface, self._rough, density, share, closed)
        slip -= np.einsum("nk,nk->n", slip, self._normals)[:, None] * self._normals
        bound = self._Bound(closed)
        size = np.linalg.norm(slip, axis=1)
        slip *= np.minimum(1, np.divide(bound, size, out=ones.copy(), where=size > 0))[:, None]
        used = np.divide(np.minimum(size, bound), bound, out=ones.copy(), where=bound > 0)
        return slip, np.where(np.isfinite(bound), 1 - used**2, 1)

    def _Bound(self, closed: np.ndarray) -> np.ndarray:
        """Least coefficient of friction of the closed macro-elements at each vertex."""
        surface, friction = self._surface, self._table["friction"]
        bound = np.full(len(surface.vertices), np.inf)
        known = (surface.faces >= 0) & closed[surface.owner, None]
        owner = np.broadcast_to(surface.owner[:, None], known.shape)[known]
        least = np.where(friction < 0, np.inf, friction)
        np.minimum.at(bound, surface.faces[known], least[owner])
        return bound

    # --- what may pull ---------------------------------------------------------------------------

    def _SetPulling(self, closed: np.ndarray) -> None:
        """Pressure and traction of a contact that pulls, too."""
        surface = self._surface
        ones = np.ones(len(surface.weight))
        vectors = FitMeans(surface, self._rough, ones, self._table["traction"], closed)
        _, vectors = self._Balanced(
            ones, lambda extra: (ones, 0 * ones), vectors, np.ones(len(vectors))
        )
        self.traction = self._unit * self._Field(vectors)
        self.pressure = -InnerProduct(self.traction, self.normal)

    # --- both ------------------------------------------------------------------------------------

    def _Balanced(
        self,
        density: np.ndarray,
        scaled: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
        slip: np.ndarray,
        slack: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Corrections for which forces and moments are those of the multipliers, see `Balance`."""
        resultants, normals = self._contact.form.Resultants(), self._normals
        wanted = [resultants[name] / self._unit for name in ("force", "moment")]
        base = -_Units(self._surface.shapes @ normals)
        if self._pulls:
            base, normals = 0 * base, 0 * normals
        balance = Balance(self._surface, self._patches, density, scaled, base, *wanted)
        extra, found, error = balance.Solve(slip, normals, slack)
        if error > 1e-12 and slack.min() < 1:
            # What all slips may leave no way to these resultants: they come first.
            extra, found, error = balance.Solve(slip, normals, np.ones_like(slack))
        return extra, found

    def _Field(self, values: np.ndarray) -> GridFunction:
        """The function that is linear on the faces with values (n, ...) at the vertices."""
        field = GridFunction(H1(self._mesh, order=1, dim=values[0].size))
        vertices = self._surface.vertices
        field.vec.FV().NumPy().reshape(-1, values[0].size)[vertices] = values.reshape(
            len(vertices), -1
        )
        return field


def _Units(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
