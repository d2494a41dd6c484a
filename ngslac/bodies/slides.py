# SPDX-License-Identifier: LGPL-2.1-or-later
"""Motions of bodies along all of their own curved surfaces that may touch others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import (
    CoefficientFunction,
    GridFunction,
    InnerProduct,
    LinearForm,
    Region,
    SurfaceL2,
    ds,
    specialcf,
)

from ngslac.bodies.rigidmotions import Arms, Field, TablesOf
from ngslac.parallel.layout import LayoutOf

if TYPE_CHECKING:
    from ngslac.bodies.bodies import Bodies
    from ngslac.contact.contact import LACContact

__all__ = ["OwnSlides", "SlidesOf"]

# How far a face moves across itself on average, relative to all motion of the surfaces: meshes of
# discs and balls have up to 1e-3, flat triangles on a ball .03, and an ellipse of which the axes
# differ by a hundredth .007.
ACROSS, FLAT = 1e-3, 0.04
# The same at points: a disc of eight edges has .22, a square .4, planes rounding errors. Of what
# slides on planes the closed contact decides.
POINTWISE, EXACT = 0.25, 1e-7
# How well a mesh knows a smooth surface whose faces are curved: or better, or as its normals show.
FINE = 1e-3


@dataclass
class OwnSlides:
    """Turns of one round body that no frictionless contact resists, whatever its status.

    Closed contact seems to, as the meshes of both surfaces have other normals.
    """

    inside: np.ndarray
    combinations: np.ndarray
    rows: slice
    weights: np.ndarray
    across: np.ndarray
    mesh: np.ndarray


def SlidesOf(bodies: Bodies, contacts: Sequence[LACContact]) -> list[OwnSlides]:
    """The OwnSlides of each floating body that has some."""
    found = []
    surfaces = Surfaces(bodies, contacts) if bodies.floating else None
    for inside, combinations, rows in bodies.unknowns:
        weights, across, points = surfaces.Slides(inside, combinations)
        # A mesh knows the motions along a curved surface as well as it knows that surface.
        mesh = np.maximum(across, np.minimum(points, np.maximum(points**2 / 4, FINE)))
        if weights.shape[1]:
            found.append(OwnSlides(inside, combinations, rows, weights, across, mesh))
    return found


class Surfaces:
    """All surfaces of contacts, and how rigid motions move them."""

    def __init__(self, bodies: Bodies, contacts: Sequence[LACContact]):
        self.bodies, self.space, mesh = bodies, bodies.space, bodies.space.mesh
        arms, (tables, _) = Arms(mesh), TablesOf(self.space)
        self.fields = [Field(table, arms) for table in tables]
        curved = mesh.dim == 2 or mesh.GetCurveOrder() > 1
        self.most = ACROSS if curved else FLAT
        slips, holds = Regions(contacts, False), Regions(contacts, True)
        held = self._Integrals(holds, self._Whole)
        self.moved = self._Integrals(slips, self._Whole) + held
        self.across = self._Integrals(slips, self._Means) + held
        self.points = self._Integrals(slips, self._Points) + held

    def _Integrals(
        self,
        region: Region | None,
        of: Callable[[CoefficientFunction, Region], CoefficientFunction],
    ) -> np.ndarray:
        """Integrals over a region of `of(motion, region)` times the basis functions: (n, m)."""
        if region is None:
            zeros = np.zeros((self.bodies.count, len(self.fields)))
            return LayoutOf(self.space).Of(zeros)
        columns, v = [], self.space.TestFunction().Trace()
        for field in self.fields:
            form = LinearForm(self.space)
            form += InnerProduct(of(field, region), v) * ds(definedon=region)
            columns.append(LayoutOf(self.space).Values(form.Assemble().vec).copy())
        return np.stack(columns, axis=1)

    def _Whole(self, field: CoefficientFunction, _: Region) -> CoefficientFunction:
        return field

    def _Points(self, field: CoefficientFunction, _: Region) -> CoefficientFunction:
        normal = specialcf.normal(self.space.mesh.dim)
        return InnerProduct(field, normal) * normal

    def _Means(self, field: CoefficientFunction, region: Region) -> CoefficientFunction:
        """Across each face, on average."""
        normal = specialcf.normal(self.space.mesh.dim)
        mean = GridFunction(SurfaceL2(self.space.mesh, order=0))
        mean.Set(InnerProduct(field, normal), definedon=region)
        return mean * normal

    def Slides(
        self, inside: np.ndarray, combinations: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of one body: weights (m, k) of its free motions; how far across on average, at points."""
        motions = self.bodies.motions[inside] @ combinations

        def Squares(integrals: np.ndarray) -> np.ndarray:
            squares = motions.T @ integrals[inside] @ combinations
            return (squares + squares.T) / 2

        whole, moved_across, none = Squares(self.moved), Squares(self.across), np.zeros(0)
        sizes = np.linalg.eigvalsh(whole)
        count = LayoutOf(self.space).together.Sum(len(inside))
        if sizes[0] <= np.finfo(float).eps * count * sizes[-1]:  # too little touches others
            return np.zeros((len(sizes), 0)), none, none
        across, along = scipy.linalg.eigh(moved_across, whole)
        own = along[:, across <= self.most**2]
        if not own.shape[1]:
            return own, none, none
        points, turned = scipy.linalg.eigh(own.T @ Squares(self.points) @ own, own.T @ whole @ own)
        round_ = (points > EXACT**2) & (points <= POINTWISE**2)
        own, points = own @ turned[:, round_], points[round_]
        if not own.shape[1]:
            return own, none, none
        own /= np.linalg.norm(own, axis=0)
        across = np.einsum("ij,ij->j", own, moved_across @ own)
        across /= np.einsum("ij,ij->j", own, whole @ own)
        return own, np.sqrt(np.maximum(across, 0)), np.sqrt(np.maximum(points, 0))


def Regions(contacts: Sequence[LACContact], tangentially: bool) -> Region | None:
    """The surfaces of contacts that hold tangentially, or of all others; None: there are none."""
    found = [contact for contact in contacts if contact.holds_tangentially == tangentially]
    surfaces = [contact.space.slave for contact in found]
    surfaces += [contact.master for contact in found if contact.master is not None]
    return sum(surfaces[1:], surfaces[0]) if surfaces else None
