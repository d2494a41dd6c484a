# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pressures of macro-elements on the way of an interior point method: with signs, and without."""

import numpy as np

__all__ = ["INSIDE", "TIE", "WIDE", "Bilateral", "Unilateral"]

# Share of the way to the boundary that a step may go.
INSIDE = 0.995
# Stiffness of ties, relative to that of what they lie on.
TIE = 1e3
# Gaps to start with, relative to what the pressure does to the surface: too large is no harm, and
# thin bodies bend far more than that.
WIDE = 30.0


class Unilateral:
    """Pressures p and gaps g > 0 with p g = mu."""

    def __init__(self, gap: np.ndarray, stiffness: np.ndarray, pressure: float):
        self.stiffness = stiffness
        self.p = np.full(len(gap), pressure)
        self.g = np.maximum(gap, WIDE * pressure / stiffness)

    @property
    def products(self) -> np.ndarray:
        """What has to vanish (stress times length)."""
        return self.p * self.g

    @property
    def apart(self) -> np.ndarray:
        """Gaps of what faces nothing."""
        return self.g

    @property
    def slope(self) -> np.ndarray:
        """How pressures follow an approach."""
        return self.p / self.g

    @property
    def size(self) -> np.ndarray:
        """Of the pressures that bound friction."""
        return self.p

    def Center(self, mu: float, gap: np.ndarray) -> None:
        """Go back to the middle of what is allowed, where all products are `mu`."""
        closed = self.p > self.stiffness * gap
        least = np.sqrt(mu * self.stiffness)
        self.p = np.where(closed, np.maximum(self.p, least), mu / np.maximum(gap, mu / least))
        self.g = mu / self.p

    def Aim(self, products: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """What pressures change by, if no displacement does, for these products."""
        self._press = (products - self.p * gap) / self.g
        return self._press

    def Step(self, change: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The step, of pressures and gaps, that belongs to changes (n,) of the pressures."""
        closer = self.g / self.p * (self._press - change)  # what the gap changes by
        return change, gap - self.g + closer

    def Bent(self, step: tuple[np.ndarray, np.ndarray], part: float) -> np.ndarray:
        """What the products have of second order in a part of a step."""
        return part**2 * step[0] * step[1]

    def After(
        self, step: tuple[np.ndarray, np.ndarray], part: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Pressures and gaps after a part of a step."""
        return self.p + part * step[0], self.g + part * step[1]

    def Predicted(self, step: tuple[np.ndarray, np.ndarray], part: float) -> np.ndarray:
        """Products after a part of a step."""
        return np.multiply(*self.After(step, part))

    def Shown(self, step: tuple[np.ndarray, np.ndarray], part: float) -> np.ndarray:
        """Pressures after a part of a step, without those that tend to zero."""
        p, g = self.After(step, part)
        return p * (p > self.stiffness * g)

    def Longest(self, step: tuple[np.ndarray, np.ndarray]) -> float:
        """The part of a step, at most 1, that leaves pressures and gaps positive."""
        longest = 1.0
        for now, change in zip((self.p, self.g), step, strict=True):
            down = change < 0
            if np.any(down):
                longest = min(longest, INSIDE * np.min(-now[down] / change[down]))
        return longest

    def Take(self, step: tuple[np.ndarray, np.ndarray], part: float) -> None:
        """Move on by a part of a step."""
        self.p, self.g = self.After(step, part)


class Bilateral:
    """Pressures of any sign that bring the gaps to zero, by the method of multipliers.

    As `Unilateral`; `products` are none.
    """

    products, apart = np.empty(0), 0.0

    def __init__(self, pressures: np.ndarray, stiffness: np.ndarray, pressure: float):
        self.p, self.slope = pressures.copy(), TIE * stiffness
        self.size = np.maximum(np.abs(pressures), pressure)

    def Center(self, mu: float, gap: np.ndarray) -> None:
        """Nothing limits the pressures."""

    def Aim(self, _: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """What pressures change by, if no displacement does."""
        return -self.slope * gap

    def Step(self, change: np.ndarray, _: np.ndarray) -> np.ndarray:
        """The step is the change of the pressures."""
        return change

    def Bent(self, *_) -> float:
        """There are no products."""
        return 0.0

    def Predicted(self, *_) -> np.ndarray:
        """There are no products."""
        return self.products

    def Shown(self, step: np.ndarray, part: float) -> np.ndarray:
        """Pressures after a part of a step."""
        return self.p + part * step

    def Longest(self, _: np.ndarray) -> float:
        """Nothing limits the step."""
        return 1.0

    def Take(self, step: np.ndarray, part: float) -> None:
        """Move on by a part of a step."""
        self.p = self.p + part * step
        self.size = np.abs(self.p)
