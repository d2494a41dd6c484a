# SPDX-License-Identifier: LGPL-2.1-or-later
"""Corrections that give a continuous traction the force and moment of the multipliers."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ngslac.recovery.surface import Patches, SlaveSurface

__all__ = ["Balance"]

ITERATIONS = 20
LARGEST = 1.0  # step of the extra, which may stand in an exponential
ROUNDING = 1e-14


class Balance:
    """Traction ``scaled(extra) (base + slip)`` with given resultants in each patch.

    The extra is a linear function of the position in each patch; `scaled` makes the pressures at
    the points from its values there, and their derivatives; without extra they are `density`. To
    the slip comes a rigid motion of each patch, tangentially and where there is slack. Of all of
    these the smallest is taken.
    """

    def __init__(
        self,
        surface: SlaveSurface,
        patches: Patches,
        density: np.ndarray,
        scaled: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
        base: np.ndarray,
        forces: np.ndarray,
        moments: np.ndarray,
    ):
        self.surface, self.patches = surface, patches
        self.scaled, self.base = scaled, base
        self._label = patches.macro[surface.macro]
        tiny, weight = np.finfo(float).tiny, (surface.weight * density)[:, None]
        total = patches.Sums(self._label, weight).clip(tiny)
        self._middle = patches.Sums(self._label, weight * surface.position) / total
        arms = self._Arms(surface.position, self._label)
        spread = patches.Sums(self._label, weight * np.sum(arms**2, axis=1, keepdims=True))
        self._size = np.sqrt(spread / total).clip(tiny)
        self._arms = arms / self._size[self._label]
        force, moment = (patches.Sums(patches.macro, values) for values in (forces, moments))
        moment = moment[:, -1:] if forces.shape[1] == 2 else moment
        self._wanted = np.hstack([force, (moment - _Cross(self._middle, force)) / self._size])

    def _Arms(self, points: np.ndarray, label: np.ndarray) -> np.ndarray:
        return np.where(label[:, None] >= 0, points - self._middle[label], 0)

    def Solve(
        self, slip: np.ndarray, normals: np.ndarray, slack: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, float]:
        """By Newton's method, of `slip`, `normals` (n, d) and `slack` (n,) at the vertices."""
        affine, rigid = self._Ways(normals, slack)
        start, values = slip, np.zeros((self.patches.count, affine.shape[1] + rigid.shape[1]))
        best = np.inf, None, None
        for _ in range(ITERATIONS):
            mine = values[self.patches.vertex]
            extra = np.einsum("na,na->n", affine, mine[:, : affine.shape[1]])
            slip = start + np.einsum("nak,na->nk", rigid, mine[:, affine.shape[1] :])
            rest, error = self._Rest(extra, slip)
            if error >= best[0]:
                break
            best = error, extra, slip
            if error < ROUNDING:
                break
            inverse = np.linalg.pinv(self._Jacobian(extra, slip, affine, rigid))
            step = np.einsum("kba,kb->ka", inverse, rest)
            wide = np.abs(step[:, : affine.shape[1]]).sum(axis=1).max(initial=LARGEST)
            values = values + step * LARGEST / wide
        return best[1], best[2], best[0]

    def _Ways(self, normals: np.ndarray, slack: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Linear functions (n, d + 1) and tangential rigid motions (n, 3 or 6, d) of patches."""
        label = self.patches.vertex
        arms = self._Arms(self.surface.points, label) / self._size[label]
        mine = label >= 0
        rigid = _RigidMotions(arms) * (mine * slack)[:, None, None]
        rigid -= np.einsum("nak,nk->na", rigid, normals)[..., None] * normals[:, None]
        return np.column_stack([np.ones(len(arms)), arms]) * mine[:, None], rigid

    def _Along(self, vectors: np.ndarray) -> np.ndarray:
        """Their part (q, d) across the base, a unit vector or zero."""
        return vectors - np.einsum("qk,qk->q", vectors, self.base)[:, None] * self.base

    def _Rest(self, extra: np.ndarray, slip: np.ndarray) -> tuple[np.ndarray, float]:
        """The missing forces and moments, and their size relative to the forces."""
        shapes = self.surface.shapes
        scale, _ = self.scaled(shapes @ extra)
        tractions = scale[:, None] * (self.base + self._Along(shapes @ slip))
        rest = self._wanted - self._Resultants(tractions)
        size = np.linalg.norm(tractions, axis=1, keepdims=True) * self.surface.weight[:, None]
        size = self.patches.Sums(self._label, size).clip(np.finfo(float).tiny)
        return rest, np.max(np.abs(rest) / size)

    def _Jacobian(
        self, extra: np.ndarray, slip: np.ndarray, affine: np.ndarray, rigid: np.ndarray
    ) -> np.ndarray:
        """The derivative of the resultants by both kinds of corrections."""
        shapes = self.surface.shapes
        direction = self.base + self._Along(shapes @ slip)
        scale, slope = self.scaled(shapes @ extra)
        stretched = (slope[:, None] * (shapes @ affine))[..., None] * direction[:, None]
        moved = np.stack(
            [self._Along(shapes @ motion) for motion in rigid.transpose(1, 0, 2)], axis=1
        )
        moved = scale[:, None, None] * moved
        return self._Resultants(np.concatenate([stretched, moved], axis=1))

    def _Resultants(self, tractions: np.ndarray) -> np.ndarray:
        """Forces, and moments over the size, (count, ..., 3 or 6) of tractions (q, ..., d)."""
        arms = self._arms.reshape(len(self._arms), *[1] * (tractions.ndim - 2), -1)
        both = np.concatenate([tractions, _Cross(arms, tractions)], axis=-1)
        weight = self.surface.weight.reshape(-1, *[1] * (tractions.ndim - 1))
        return self.patches.Sums(self._label, weight * both)


def _Cross(arms: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Moments (..., 1) in 2D, (..., 3) in 3D."""
    if forces.shape[-1] == 3:
        return np.cross(arms, forces)
    return arms[..., :1] * forces[..., 1:] - arms[..., 1:] * forces[..., :1]


def _RigidMotions(arms: np.ndarray) -> np.ndarray:
    """Translations and rotations (n, 3 or 6, d)."""
    n, d = arms.shape
    moves = np.broadcast_to(np.eye(d), (n, d, d))
    if d == 2:
        turns = np.stack([-arms[:, 1], arms[:, 0]], axis=1)[:, None]
    else:
        turns = np.cross(np.eye(3)[None], arms[:, None])
    return np.concatenate([moves, turns], axis=1)
