# SPDX-License-Identifier: LGPL-2.1-or-later
"""A continuous pressure that does not pull.

Where contact ends between two macro-elements the pressure falls to zero like the square root of the
distance, so that its square goes on smoothly where the pressure itself does not. In a patch with
open neighbours the unknowns are the squares of the pressure at the vertices, which may be negative
outside, and the pressure is that of every point: ``lam - c g`` with its gap g. In a patch without
such an end they are the pressures themselves, and only the means count, as for the multipliers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix, diags, vstack
from scipy.sparse.linalg import splu

from ngslac.recovery.stencils import ThirdDifferences

if TYPE_CHECKING:
    from ngslac.recovery.surface import Patches, SlaveSurface

__all__ = ["PressureFit"]

# Weight of the differences, for vertices as far from each other as macro-elements. Ten times of it
# flattens Hertz' pressure, a tenth lets the scatter of the multipliers pass.
SMOOTHNESS = 1.0
ROUNDING = 1e-12  # of the pressure: less is not a pull
STEEPEST = 1e-2  # part of the largest pressure, below which its root has no steeper slope
ITERATIONS = 30
DAMPING = 1e-12, 1e-10, 1e4  # least, first, and largest, relative to the largest curvature
OUTSIDE = -0.1  # first guess of the square where contact is open


class PressureFit:
    """Least squares by the damped method of Gauss and Newton.

    Attributes
    ----------
    root, square, blend : (n,)
        Of the pressure at the vertices, see `At`.
    peak : (n,)
        Largest pressure of the patch of each vertex.
    """

    def __init__(
        self,
        surface: SlaveSurface,
        rough: csr_matrix,
        patches: Patches,
        means: np.ndarray,
        samples: np.ndarray,
    ):
        self.surface = surface
        closed = means > 0
        ended = self._Ended(patches, closed)
        self.blend = (surface.touches.T @ ended > 0).astype(float)
        self._squared = self.blend > 0
        self._blend = surface.shapes @ self.blend
        self._SetPeaks(patches, means)
        self._rows = self._Weights(closed & ~ended, ended)
        self._data = self._rows @ np.where(ended[surface.macro], samples, means[surface.macro])
        self._SetRoughness(rough)
        around = surface.neighbours @ (surface.neighbours @ patches.touched.astype(float))
        start = self._Start(means, patches)
        self._Solve(start, np.flatnonzero(around))
        self.square = np.where(patches.touched, self.square, np.minimum(self.square, 0))
        self._Restore(patches, means, start)

    def _Ended(self, patches: Patches, closed: np.ndarray) -> np.ndarray:
        """Macro-elements of patches with open neighbours, and these."""
        paired = self.surface.area > 0
        ends = np.zeros(patches.count + 1, bool)
        ends[patches.macro[paired & ~closed]] = True
        return paired & ends[patches.macro] & (patches.macro >= 0)

    def _SetPeaks(self, patches: Patches, means: np.ndarray) -> None:
        peaks = np.zeros(patches.count + 1)
        np.maximum.at(peaks, patches.macro, means)
        peaks[-1] = peaks.max()
        self.peak = peaks[patches.Around(patches.Around(patches.vertex))]
        self._peak = peaks[patches.macro[self.surface.macro]]

    def _Weights(self, by_means: np.ndarray, by_points: np.ndarray) -> csr_matrix:
        """The sums over points that are compared: of a macro-element, or of each point."""
        surface = self.surface
        points = np.arange(len(surface.weight))
        area = np.sqrt(np.where(surface.area > 0, surface.area, 1))[surface.macro]
        shares = surface.weight * by_means[surface.macro] / area / self._peak
        sums = csr_matrix((shares, (surface.macro, points)), (surface.nmacros, len(points)))
        single = np.sqrt(surface.weight * by_points[surface.macro]) / self._peak
        return vstack([sums, diags(single)]).tocsr()

    def _SetRoughness(self, rough: csr_matrix) -> None:
        """Set the rows that keep root and square smooth."""
        surface = self.surface
        share = np.where(surface.share > 0, surface.share, 1)
        wide = surface.OnVertices(surface.area) / share
        weight = np.sqrt(SMOOTHNESS * surface.share) * wide**1.5 / self.peak
        third = ThirdDifferences(rough, surface.neighbours)
        plain = abs(rough) @ self.blend == 0
        self._by_root = diags(weight * plain) @ rough
        self._by_square = diags(0.5 * weight * ~plain / self.peak) @ third

    def _Start(self, means: np.ndarray, patches: Patches) -> np.ndarray:
        start = self.surface.OnVertices(means) / self.peak
        squares = np.where(patches.touched, start**2, OUTSIDE)
        return np.where(self._squared, squares, start)

    def _Restore(self, patches: Patches, means: np.ndarray, start: np.ndarray) -> None:
        """Where a patch is so small that its pressure got lost its means have to do."""
        surface = self.surface
        label = patches.macro[surface.macro]
        found = patches.Sums(label, (surface.weight * self.At())[:, None])
        wanted = patches.Sums(patches.macro, (surface.area * means)[:, None])
        lost = np.append((found < wanted / 2) | (found > 2 * wanted), False)[patches.vertex]
        square, _ = self.square, self._Set(start)
        self.square = np.where(lost, self.square, square)
        self.root = np.sqrt(np.maximum(self.square, 0))

    # --- the pressure ----------------------------------------------------------------------------

    def _Set(self, values: np.ndarray) -> None:
        squares = np.where(self._squared, values, np.maximum(values, 0) ** 2)
        self.square = self.peak**2 * squares
        self.root = np.sqrt(np.maximum(self.square, 0))

    def At(self) -> np.ndarray:
        """Pressure (q,) at the points.

        Its square is ``(1 - blend) root**2 + blend square`` of linear functions, or 0 if negative.
        """
        shapes, blend = self.surface.shapes, self._blend
        square = (1 - blend) * (shapes @ self.root) ** 2 + blend * (shapes @ self.square)
        return np.sqrt(np.maximum(square, 0))

    def Pulls(self, extra: np.ndarray) -> bool:
        """Whether the pressure times ``1 + extra``, with `extra` at the vertices, pulls anywhere.

        Where it has no end the pressure is linear, and ``peak * extra`` is added to it.
        """
        factors = 1 + extra[self.surface.neighbours @ self.blend > 0]
        values = self.root / self.peak + extra
        return min(factors.min(initial=0), values[~self._squared].min(initial=0)) < -ROUNDING

    def _Residual(self) -> np.ndarray:
        rough = self._by_root @ self.root + self._by_square @ self.square
        return np.concatenate([self._rows @ self.At() - self._data, rough])

    def _Jacobian(self, values: np.ndarray) -> csc_matrix:
        """The derivative of the residual by the values."""
        shapes, pressure, blend = self.surface.shapes, self.At(), self._blend
        slope = np.where(pressure > 0, 1 / np.maximum(pressure, STEEPEST * self._peak), 0)
        # Where nothing is blended the pressure is the root itself, at 0 as well.
        share = np.where(blend > 0, (1 - blend) * (shapes @ self.root) * slope, 1)
        peak = self.peak
        steep = 0.5 * peak**2 / np.maximum(self.root, STEEPEST * peak)
        roots = diags(np.where(self._squared, steep, peak))
        squares = diags(peak**2 * np.where(self._squared, 1, 2 * np.maximum(values, 0)))
        points = diags(share) @ shapes @ roots + diags(0.5 * blend * slope) @ shapes @ squares
        rough = self._by_root @ roots + self._by_square @ squares
        return vstack([self._rows @ points, rough]).tocsc()

    # --- Gauss-Newton --------------------------------------------------------------------------

    def _Solve(self, values: np.ndarray, free: np.ndarray) -> None:
        """Fit the values that are free, by steps of Levenberg and Marquardt."""
        self._Set(values)
        residual, damping = self._Residual(), DAMPING[1]
        for _ in range(ITERATIONS):
            jacobian = self._Jacobian(values)[:, free]
            before = residual @ residual
            values, damping = self._Step(values, free, jacobian, residual, damping)
            residual = self._Residual()
            if before - residual @ residual <= 1e-9 * before:
                return

    def _Step(
        self,
        values: np.ndarray,
        free: np.ndarray,
        jacobian: csc_matrix,
        residual: np.ndarray,
        damping: float,
    ) -> tuple[np.ndarray, float]:
        """The next values, those as they were if none are better, and the next damping."""
        cost, slope = residual @ residual, jacobian.T @ residual
        matrix = (jacobian.T @ jacobian).tocsc()
        scale = diags(np.full(len(free), matrix.diagonal().max()))
        while damping < DAMPING[2]:
            trial = values.copy()
            trial[free] -= splu((matrix + damping * scale).tocsc()).solve(slope)
            self._Set(trial)
            residual = self._Residual()
            if residual @ residual <= cost:
                return trial, max(DAMPING[0], damping / 10)
            damping *= 10
        self._Set(values)
        return values, damping
