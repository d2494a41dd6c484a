# SPDX-License-Identifier: LGPL-2.1-or-later
"""The contact conditions of macro-elements, kept in the inside of what they allow."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ngslac.solve.pressures import INSIDE, TIE, Bilateral, Unilateral

__all__ = ["Barrier", "Centering", "Mean", "Tie"]

SMALLEST = np.finfo(float).tiny ** 0.25  # whose square is no zero


class Barrier:
    """Pressures p and gaps g with p g = mu, tangential tractions t inside of |t| < s.

    For mu -> 0 they tend to what contact with friction asks for. With the slack
    w = (s^2 - |t|^2)/2 > 0 of the friction law and its multiplier nu > 0: slip = -nu t and
    nu w = mu. Newton's method on all of these equations, with steps that stay inside, is a primal
    dual interior point method (Mehrotra 1992); per macro-element everything but the displacement is
    eliminated. The bound s is that of the step before (Tresca): what is left is symmetric.

    All arrays count the macro-elements that face a master and are not tied.
    """

    def __init__(
        self,
        press: Unilateral | Bilateral,
        normal: np.ndarray,
        gap: np.ndarray,
        bound: np.ndarray,
        product: float,
    ):
        self.press, self.rubs = press, bound > 0
        self.t, self.normal = np.zeros_like(normal), normal
        self.Place(normal, gap, np.zeros_like(normal))
        self.s = np.where(self.rubs, bound, 1.0)
        self.w = self.s**2 / 2
        self.nu = np.where(self.rubs, product / self.w, 0.0)

    def Place(self, normal: np.ndarray, gap: np.ndarray, slip: np.ndarray) -> None:
        """Take gaps (n,) and slips (n, d) of another displacement; tractions stay as they are."""
        along = self.traction - np.sum(self.traction * normal, axis=1)[:, None] * normal
        self.t = np.where(self.rubs[:, None], along, 0.0)
        self.normal, self.gap, self.slip = normal, gap, slip

    def Bound(self, bound: np.ndarray) -> None:
        """Take bounds (n,) of the tangential tractions, which grow or shrink with them."""
        bound = np.where(self.rubs, np.maximum(bound, SMALLEST), 1.0)
        ratio = bound / self.s
        self.s, self.t = bound, self.t * ratio[:, None]
        self.w, self.nu = self.w * ratio**2, self.nu / ratio

    def Center(self, mu: float) -> None:
        """Go back to the middle of what is allowed, where all products are `mu`."""
        self.press.Center(mu, self.gap)
        self.t = self.t / 2
        self.w = self._Slack()
        self.nu = np.where(self.rubs, mu / self.w, 0.0)

    @property
    def traction(self) -> np.ndarray:
        return self.t - self.press.p[:, None] * self.normal

    @property
    def products(self) -> np.ndarray:
        """Sum and number of the products that have to vanish (stress times length)."""
        return self._Products(self.press.products, self.nu * self.w)

    def _Products(self, normal: np.ndarray, tangential: np.ndarray) -> np.ndarray:
        """Sum and number of products (n,) of pressures and of those that rub."""
        total = normal.sum() + tangential[self.rubs].sum()
        return np.array([total, len(normal) + np.count_nonzero(self.rubs)])

    def Stiffness(self) -> np.ndarray:
        """How tractions follow the jump: (n, d, d), symmetric and positive definite."""
        normals = self.normal[:, :, None] * self.normal[:, None, :]
        self._turn = self._Tangential(normals)
        return self.press.slope[:, None, None] * normals + self._turn

    def _Tangential(self, normals: np.ndarray) -> np.ndarray:
        """The inverse of nu I + nu/w t t^T on the tangential plane, where there is friction."""
        plane = np.eye(self.normal.shape[1]) - normals
        nu = np.where(self.rubs, self.nu, 1.0)
        along = self.t[:, :, None] * self.t[:, None, :]
        along /= (self.w + np.sum(self.t**2, axis=1))[:, None, None]
        return np.where(self.rubs, 1 / nu, 0.0)[:, None, None] * (plane - along)

    def Change(self, mu: float, correction: BarrierStep | None = None) -> np.ndarray:
        """What tractions (n, d) change by if no displacement changes.

        `correction` is the step whose products are taken into account (second order).
        """
        over, rubbing = (0, 0) if correction is None else correction.products
        self._aim = mu - rubbing
        press = self.press.Aim(mu - over, self.gap)
        rate = (self._aim - self.nu * self.w) / self.w
        self._behind = -self.slip - (self.nu + rate)[:, None] * self.t
        along = np.einsum("kij,kj->ki", self._turn, self._behind)
        return along - press[:, None] * self.normal

    def Step(self, change: np.ndarray) -> BarrierStep:
        """The step of everything that belongs to changes (n, d) of the tractions."""
        press = -np.sum(change * self.normal, axis=1)
        along = change + press[:, None] * self.normal
        slack = np.where(self.rubs, -np.sum(self.t * along, axis=1), 0.0)
        rate = (self._aim - self.nu * (self.w + slack)) / self.w
        rate = np.where(self.rubs, rate, 0.0)
        return BarrierStep(self.press.Step(press, self.gap), along, slack, rate)

    def Shown(self, step: BarrierStep, part: float) -> np.ndarray:
        """Tractions (n, d) after a part of a step, without those that tend to zero."""
        p = self.press.Shown(step.press, part)
        return (self.t + part * step.t) * (p != 0)[:, None] - p[:, None] * self.normal

    def Longest(self, step: BarrierStep) -> float:
        """The part of a step, at most 1, that leaves pressures and gaps positive."""
        return self.press.Longest(step.press)

    def Predicted(self, step: BarrierStep, part: float) -> np.ndarray:
        """`products` after a part of a step, which remembers its own for the correction."""
        step.products = self.press.Bent(step.press, part), part**2 * step.w * step.nu
        normal = self.press.Predicted(step.press, part)
        w, nu = Above(self.w, part * step.w), Above(self.nu, part * step.nu)
        return self._Products(normal, w * nu)

    def Take(self, step: BarrierStep, part: float) -> None:
        """Move on by a part of a step; tangential tractions are brought back inside."""
        self.press.Take(step.press, part)
        self.nu = Above(self.nu, part * step.nu)
        along = self.t + part * step.t
        before, size = (np.linalg.norm(t, axis=1) for t in (self.t, along))
        most = self.s - (1 - INSIDE) * (self.s - before)
        self.t = along * np.minimum(1, most / np.maximum(size, SMALLEST))[:, None]
        self.w = self._Slack()

    def _Slack(self) -> np.ndarray:
        """The slack (n,) of the tractions, kept positive."""
        slack = (self.s**2 - np.sum(self.t**2, axis=1)) / 2
        return np.maximum(slack, np.finfo(float).eps * self.s**2)  # of rounding


def Above(values: np.ndarray, changes: np.ndarray) -> np.ndarray:
    """Values and changes, but no less than a small part of the values."""
    return np.maximum(values + changes, (1 - INSIDE) * values)


class BarrierStep:
    """Changes of pressures with their gaps, tangential tractions, slacks and their multipliers."""

    def __init__(
        self,
        press: tuple[np.ndarray, np.ndarray] | np.ndarray,
        t: np.ndarray,
        w: np.ndarray,
        nu: np.ndarray,
    ):
        self.press, self.t, self.w, self.nu = press, t, w, nu


class Tie:
    """Tractions that hold tied surfaces together, by the method of multipliers: as `Barrier`."""

    products = np.zeros(2)

    def Center(self, mu: float) -> None:
        """Nothing limits the tractions."""

    def __init__(self, traction: np.ndarray, stiffness: np.ndarray):
        self.traction, self.stiffness = traction.copy(), TIE * stiffness

    def Place(self, normal: np.ndarray, gap: np.ndarray, slip: np.ndarray) -> None:
        """Take gaps (n,) and slips (n, d) of another displacement, which are jumps together."""
        self.jump = slip - gap[:, None] * normal

    def Stiffness(self) -> np.ndarray:
        """How tractions follow the jump: (n, d, d)."""
        return self.stiffness[:, None, None] * np.eye(self.traction.shape[1])

    def Change(self, *_) -> np.ndarray:
        """What tractions (n, d) change by if no displacement changes."""
        return -self.stiffness[:, None] * self.jump

    def Step(self, change: np.ndarray) -> np.ndarray:
        """The step is the change of the tractions."""
        return change

    def Shown(self, step: np.ndarray, part: float) -> np.ndarray:
        """Tractions (n, d) after a part of a step."""
        return self.traction + part * step

    def Longest(self, _: np.ndarray) -> float:
        """Nothing limits the step."""
        return 1.0

    def Predicted(self, *_) -> np.ndarray:
        """There are no products."""
        return self.products

    def Take(self, step: np.ndarray, part: float) -> None:
        """Move on by a part of a step."""
        self.traction = self.traction + part * step


def Mean(products: Iterable[np.ndarray]) -> float:
    """The mean of products, of which each array holds a sum and a number."""
    total, count = sum(products)
    return total / count if count else 0.0


def Centering(before: float, predicted: float) -> float:
    """The product that a corrected step aims at, by the means before and after the predicted one.

    Mehrotra (1992).
    """
    return before * min(1.0, max((predicted / before) ** 3, 1e-6)) if before else 0.0
