# SPDX-License-Identifier: LGPL-2.1-or-later
"""Rotations that a bulk resists since its space cannot represent them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import VOL, CoefficientFunction, GridFunction

from ngslac.arrays import AsNumPy, ScalarDofs
from ngslac.bodies.freedom import NullSpace
from ngslac.bodies.rigidmotions import Arms, MotionIntegrals, StrainIntegrals
from ngslac.parallel.layout import LayoutOf

if TYPE_CHECKING:
    from ngslac.bodies.bodies import Bodies

__all__ = ["FalseStiffness"]

# Strain of a rotation that is rounding, and how much stiffer than shear it may be.
EXACT, STIFFER = 1e-10, 10.0


class FalseStiffness:
    """Strains of the rigid motions in a displacement space, and what forces they explain.

    On curved elements of a degree above that of the displacement a rotation has strains. A body
    that nothing holds then seems to have weak springs.
    """

    def __init__(self, bodies: Bodies, forces: Callable[[np.ndarray], np.ndarray]):
        self.bodies, self.forces, self.space = bodies, forces, bodies.space

    @cached_property
    def strains(self) -> np.ndarray:
        """Integrals of the strains of the motions times those of the basis functions (n, m)."""
        return StrainIntegrals(self.space, self.bodies.motions)

    @cached_property
    def any(self) -> bool:
        """Has a motion strains at all?"""
        if self.space.mesh.GetCurveOrder() <= 1:
            return False
        squares = np.sum(self.bodies.motions * self.strains, axis=0)
        volume = MotionIntegrals(self.space)[:, 0] @ self.bodies.motions[:, 0]
        return bool(np.any(squares > EXACT**2 * volume))

    @cached_property
    def inside(self) -> np.ndarray:
        """(n,) bool: dofs that no element of the boundary has."""
        space, forces = self.space, self.forces
        layout = LayoutOf(space)
        outer = AsNumPy(ScalarDofs(space.GetDofs(space.mesh.Boundaries(".*")), space))
        outer = layout.Everywhere(outer)
        random = np.random.default_rng(2).uniform(1, 2, len(outer))
        values = np.where(outer, layout.Consistent(random), 0.0)
        return ~outer & (forces(values) == 0)

    @cached_property
    def shear(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """A simple shear, what it does as `forces`, and integrals of its strains (n,)."""
        arms = Arms(self.space.mesh)
        gf = GridFunction(self.space)
        gf.Set(CoefficientFunction((arms[1], *([0] * (len(arms) - 1)))), VOL)
        values = LayoutOf(self.space).Values(gf.vec).copy()
        return values, self.forces(values), StrainIntegrals(self.space, values[:, None])[:, 0]

    def Unresisted(
        self, dofs: np.ndarray, motions: np.ndarray, moved: np.ndarray, scale: float
    ) -> np.ndarray:
        """Combinations (m, k) of the motions of a body that nothing but false stiffness resists."""
        rigid, values = self.bodies.motions[dofs] @ motions, self.shear
        inner = np.where(self.inside[dofs, None], moved, 0.0) / scale
        kept = NullSpace(inner, self.bodies.resists)
        shear, force, strain = (part[dofs] for part in values)
        modulus = (shear @ force) / (shear @ strain)
        energy = rigid.T @ moved
        false = rigid.T @ self.strains[dofs] @ motions
        excess = (
            kept.T @ ((energy + energy.T) / 2 - STIFFER * modulus * (false + false.T) / 2) @ kept
        )
        sizes, vectors = np.linalg.eigh(excess)
        return kept @ vectors[:, sizes <= self.bodies.resists * scale * np.linalg.norm(rigid, 2)]
