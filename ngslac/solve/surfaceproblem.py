# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact where nothing else is nonlinear: solved on the surfaces, by the bulk's compliance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ngslac.linear.factor import OneBLASThread
from ngslac.linear.interface import DenseFactors
from ngslac.solve.barrier import Centering, Mean
from ngslac.solve.pressures import WIDE

if TYPE_CHECKING:
    from ngslac.linear.interface import Compliance
    from ngslac.solve.barrier import Barrier, BarrierStep, Tie
    from ngslac.solve.surfaces import Answer, Surfaces

__all__ = ["SurfaceProblem"]

# Residual of the laws and of the springs, relative to the largest traction and force, and that of
# the laws to what the traction would be without them: rounding.
DONE, ROUNDING = 1e-11, 1e-14
# Part of the springs that stays where nothing else holds a body.
SOFT = 1e-7
# Bound of friction that is none, relative to the largest.
LEAST = 1e-6
# Components of tractions up to which a path, which counts all of them in each step, is cheap.
SMALL = 400
# Steps of Newton's method and on a path, and times that bounds of friction are looked at.
NEWTON, PATH, BOUNDS = 40, 60, 10
# Part of a step on a path that leads nowhere, and products at its end over the first ones, and over
# those of the largest pressure with what it does to the surface.
TINY, FALLEN = 1e-4, 1e-11
# Residual, relative to that with the same status before, that is no progress.
PROGRESS = 0.5

Laws = list["Barrier | Tie"]


class SurfaceProblem:
    """Finds tractions for which all contact conditions hold, without another look at the bulk.

    The unknowns y are changes of the scaled tractions, and forces of the springs that hold the
    bodies of a `Compliance`; jumps follow them: ``start + Z y``. Newton's method with active set
    goes on from the present status. Where it does not converge, an interior point method solves
    the problem with bounds of friction that are given (Tresca), at first none, then those of the
    pressures that it finds; each time Newton's method may end it. All of it is dense algebra on
    the surfaces, and a step is far cheaper than one of the whole system.

    Parameters
    ----------
    surfaces : Surfaces
    compliance : Compliance
    scale : (n,)
        Factors of the multipliers' rows and columns.
    moved : (n,)
        Scaled integrals of the jumps of a prescribed motion.
    far : float
        Jumps that are larger carry bodies off.
    """

    def __init__(
        self,
        surfaces: Surfaces,
        compliance: Compliance,
        scale: np.ndarray,
        moved: np.ndarray,
        far: float,
    ):
        self.surfaces, self._far, (k, d) = surfaces, far, surfaces.traction.shape
        own = np.flatnonzero(np.repeat(surfaces.own, d))
        self._used = np.concatenate([own, np.arange(len(scale), len(compliance.start))])
        self._count, self._scale = k * d, scale[own]
        matrix = compliance.matrix[np.ix_(self._used, self._used)]
        start = compliance.start[self._used]
        means = 1 / (self._scale * np.repeat(surfaces.area, d))
        self._Z = means[:, None] * matrix[: k * d]
        self._start = means * (start[: k * d] + moved[own])
        self._springs = compliance.spring * matrix[k * d :]
        self._held = compliance.spring * start[k * d :]
        self._size = len(compliance.start)
        self._soft = 0.0
        self._Put(np.zeros(len(self._used)))

    @OneBLASThread()
    def Solve(self) -> np.ndarray | None:
        """Multipliers and springs (m,) of the correction, scaled; None where they are not found."""
        with np.errstate(over="ignore", invalid="ignore"):  # steps that lead nowhere
            found = self._count and (self._Newton() or self._FindStatus())
        if not found:
            return None
        forces = np.zeros(self._size)
        forces[self._used] = -self._y
        return forces

    # --- how the bulk answers ------------------------------------------------------------------

    def _Put(self, y: np.ndarray, jump: np.ndarray | None = None) -> None:
        """Go to unknowns, and to their jumps if these are not others on the way."""
        self._y = y
        self.jump = self._Jump(y) if jump is None else jump

    def _Jump(self, y: np.ndarray) -> np.ndarray:
        return (self._start + self._Z @ y).reshape(self.surfaces.traction.shape)

    @property
    def traction(self) -> np.ndarray:
        """Of the present unknowns (k, d)."""
        change = self._scale * self._y[: self._count]
        return self.surfaces.traction + change.reshape(self.surfaces.traction.shape)

    @property
    def _left(self) -> np.ndarray:
        """Changes of the forces of springs that are still needed."""
        kept = 1 - self._soft
        return kept * (self._held + self._springs @ self._y) - self._y[self._count :]

    def _Response(self, own: np.ndarray, by_jump: np.ndarray) -> Response | None:
        """To laws of which ``own`` times tractions plus ``by_jump`` times jumps are prescribed."""
        stiff = (1 - self._soft) * self._springs
        return Response.Of(own, by_jump, self._Z, stiff, self._scale)

    def _Change(self, response: Response, right: np.ndarray) -> np.ndarray:
        """Of the unknowns, by a Response to what is prescribed (k, d), from the present place."""
        return response.Solve(right, self._Jump(self._y) - self.jump, self._left)

    # --- Newton's method -----------------------------------------------------------------------

    def _Newton(self) -> bool:
        """Go on to the solution; False: the method does not get there."""
        seen, way = {}, np.zeros_like(self.jump)
        for _ in range(NEWTON):
            trial = self.surfaces.Trial(self.traction, self.jump)
            answer = self.surfaces.Project(trial)
            way = self._PassStick(answer, trial, way)
            left = self.traction - answer.traction
            error = self._Error(left, trial)
            if error <= DONE:
                return Largest(self.jump) <= self._far
            status = answer.status.tobytes()
            if error > PROGRESS * seen.get(status, np.inf):
                return False
            seen[status] = error
            stiffness = self.surfaces.stiffness[:, None, None]
            own = np.eye(left.shape[1]) - answer.derivative
            response = self._Response(own, stiffness * answer.derivative)
            if response is None:
                return False
            self._Put(self._y + self._Change(response, -left))
        return False

    def _PassStick(self, answer: Answer, trial: np.ndarray, before: np.ndarray) -> np.ndarray:
        """Let slip that has turned round stick first; returns where friction points now (k, d)."""
        normal = self.surfaces.normal
        along = answer.traction - np.sum(answer.traction * normal, axis=1)[:, None] * normal
        slips = answer.status == 2
        turned = slips & (np.sum(along * before, axis=1) < 0)
        answer.status[turned], answer.traction[turned] = 1, trial[turned]
        answer.derivative[turned] = np.eye(trial.shape[1])
        return along * (slips & ~turned)[:, None]

    def _Error(self, left: np.ndarray, trial: np.ndarray) -> float:
        """Of the laws and of the springs, relative to tractions and forces, beyond rounding."""
        size, above = Largest(self.traction), Largest(left) - ROUNDING * Largest(trial)
        force = max(Largest(self._y[self._count :]), Largest(self._held))
        return max(above / (size or 1.0), Largest(self._left) / (force or 1.0))

    # --- interior point method -----------------------------------------------------------------

    def _FindStatus(self) -> bool:
        """Find the solution whatever the present status is, if that can be."""
        surfaces = self.surfaces
        if self._count > SMALL:
            return False
        pressure = np.zeros(len(surfaces.gap))
        for _ in range(BOUNDS):
            bound = surfaces.Bound(pressure)
            surfaces.bound, self._soft = bound * (bound > LEAST * Largest(bound)), SOFT
            found = self._FollowPath()
            surfaces.bound = None
            if not found:
                return False
            end = self._y, self.jump
            pressure = np.maximum(0, -np.sum(self.traction * surfaces.normal, axis=1))
            if self._Ends(end):
                return True
            if not np.any(surfaces.rubs):
                return False
        return False

    def _Ends(self, end: tuple[np.ndarray, np.ndarray]) -> bool:
        """Does Newton's method end it from there? Springs stay where nothing else holds a body."""
        for self._soft in (0.0, SOFT):
            self._Put(*end)
            if self._Newton():
                break
        else:
            return False
        soft, end = self._soft, (self._y, self.jump)
        self._soft = 0.0
        if soft and not self._Newton():
            self._Put(*end)
        return True

    def _FollowPath(self) -> bool:
        """Go to the end of the path to the solution with the present bounds; False: none begins."""
        laws = self._Begin()
        if laws is None:
            return False
        first = Mean(law.products for law in laws)
        for _ in range(PATH):
            mean = Mean(law.products for law in laws)
            if mean <= FALLEN * min(first, self._Product(laws)) or not self._Advance(laws, mean):
                break
        self._Put(self._Unknowns(self._Shown(laws)), self.jump)
        return True

    def _Begin(self) -> Laws | None:
        """Let weak springs hold all surfaces, and choose pressures by their forces."""
        surfaces, (k, d) = self.surfaces, self.jump.shape
        nothing = np.zeros((k, d))
        self._Put(self._Unknowns(nothing), nothing)
        weak = np.multiply.outer(surfaces.stiffness / WIDE, np.eye(d))
        response = self._Response(np.tile(np.eye(d), (k, 1, 1)), weak)
        if response is None:
            return None
        self._Put(self._y + self._Change(response, nothing))
        press = -np.sum(self.traction * surfaces.normal, axis=1)
        overlap = press - surfaces.stiffness / WIDE * surfaces.gap
        now = np.sum(surfaces.traction * surfaces.normal, axis=1)
        pressure = max(Largest(size[~surfaces.tied]) for size in (press, overlap.clip(0), now))
        if not 0 < pressure < np.inf:
            return None
        return surfaces.Barriers(pressure, surfaces.After(self.jump)[0])

    def _Advance(self, laws: Laws, mean: float) -> bool:
        """A step, predicted and corrected; False: there is none."""
        self.surfaces.Place(laws, self.jump)
        d = self.jump.shape[1]
        stiffness = np.concatenate([law.Stiffness() for law in laws])
        self._Put(self._Unknowns(np.concatenate([law.traction for law in laws])), self.jump)
        response = self._Response(np.tile(np.eye(d), (len(stiffness), 1, 1)), stiffness)
        if response is None:
            return False
        steps, _ = self._Direction(laws, response, 0.0, [None] * len(laws))
        part = Longest(laws, steps)
        after = Mean(law.Predicted(step, part) for law, step in zip(laws, steps, strict=True))
        steps, change = self._Direction(laws, response, Centering(mean, after), steps)
        part = Longest(laws, steps)
        if part < TINY:
            return False
        for law, step in zip(laws, steps, strict=True):
            law.Take(step, part)
        self._Put(self._y + part * change, self.jump + part * self._Moved(change))
        return True

    def _Moved(self, change: np.ndarray) -> np.ndarray:
        """Changes of the jumps with those of the unknowns, up to where they follow these."""
        return self._Jump(self._y + change) - self.jump

    def _Direction(
        self,
        laws: Laws,
        response: Response,
        center: float,
        corrections: Sequence[BarrierStep | np.ndarray | None],
    ) -> tuple[list[BarrierStep | np.ndarray], np.ndarray]:
        """Steps of the laws towards a product `center`, and what the unknowns change by."""
        changes = [law.Change(center, own) for law, own in zip(laws, corrections, strict=True)]
        change = self._Change(response, np.concatenate(changes))
        follow = (self._scale * change[: self._count]).reshape(self.jump.shape)
        parts = self.surfaces.parts
        return [law.Step(follow[part]) for law, part in zip(laws, parts, strict=True)], change

    def _Unknowns(self, traction: np.ndarray) -> np.ndarray:
        """With other tractions (k, d)."""
        change = (traction - self.surfaces.traction).ravel() / self._scale
        return np.concatenate([change, self._y[self._count :]])

    def _Product(self, laws: Laws) -> float:
        """Of the largest pressure and what it does to the surface."""
        surfaces, traction = self.surfaces, np.concatenate([law.traction for law in laws])
        pressure = np.sum(traction * surfaces.normal, axis=1) * ~surfaces.tied
        return Largest(pressure**2 / surfaces.stiffness)

    def _Shown(self, laws: Laws) -> np.ndarray:
        """Tractions (k, d) without those that tend to zero."""
        surfaces, traction = self.surfaces, np.concatenate([law.traction for law in laws])
        pressure = -np.sum(traction * surfaces.normal, axis=1)
        closed = pressure > surfaces.stiffness * surfaces.After(self.jump)[0]
        return traction * (closed | surfaces.tied | surfaces.bilateral)[:, None]


class Response:
    """Changes of the unknowns for which ``own dt + by_jump dj`` and the springs are prescribed."""

    def __init__(self, follows: np.ndarray, blocks: tuple[np.ndarray, ...], factors: DenseFactors):
        self._follows, self._blocks, self._factors = follows, blocks, factors

    @classmethod
    def Of(
        cls,
        own: np.ndarray,
        by_jump: np.ndarray,
        Z: np.ndarray,
        springs: np.ndarray,
        scale: np.ndarray,
    ) -> Response | None:
        """That of blocks (k, d, d); None if it is not the only one.

        `Z` (kd, n) are jumps by unknowns, `springs` (s, n) forces by them.
        """
        k, d, _ = own.shape
        follows = np.any(by_jump, axis=(1, 2))
        unknown = np.concatenate([np.repeat(follows, d), np.ones(len(springs), bool)])
        rows, count = np.flatnonzero(unknown[: k * d]), np.count_nonzero(follows)
        matrix = np.eye(count * d + len(springs))
        matrix[count * d :] -= springs[:, unknown]
        jumps = Z[np.ix_(rows, unknown)].reshape(count, d, len(matrix))
        top = np.einsum("kij,kjc->kic", by_jump[follows], jumps)
        each, scales = np.arange(count), scale[rows].reshape(count, 1, d)
        columns = d * each[:, None, None] + np.arange(d)
        top[each[:, None, None], np.arange(d)[:, None], columns] += own[follows] * scales
        matrix[: count * d] = top.reshape(count * d, len(matrix))
        factors = DenseFactors.Of(matrix)
        return factors and cls(follows, (own, by_jump, Z, springs, scale), factors)

    def Solve(self, right: np.ndarray, ahead: np.ndarray, left: np.ndarray) -> np.ndarray:
        """Changes of the unknowns.

        `right` (k, d) is prescribed, `ahead` (k, d) what jumps have to make up for, and `left` (s,)
        the forces of the springs.
        """
        own, by_jump, Z, springs, scale = self._blocks
        k, d, _ = own.shape
        follows, change = self._follows, np.zeros(Z.shape[1])
        alone = np.repeat(~follows, d)
        change[: k * d][alone] = right[~follows].ravel() / scale[alone]
        moved = ahead + (Z @ change).reshape(k, d)
        right = right - np.einsum("kij,kj->ki", by_jump, moved)
        right = np.concatenate([right[follows].ravel(), left + springs @ change])
        unknown = np.concatenate([~alone, np.ones(len(springs), bool)])
        change[unknown] = self._factors.Solve(right)
        return change


def Largest(values: np.ndarray) -> float:
    """The largest size of any value."""
    return float(np.max(np.abs(values), initial=0.0))


def Longest(laws: Laws, steps: Sequence[BarrierStep | np.ndarray]) -> float:
    """The part of a step that keeps all laws inside."""
    return min(law.Longest(step) for law, step in zip(laws, steps, strict=True))
