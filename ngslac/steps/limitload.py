# SPDX-License-Identifier: LGPL-2.1-or-later
"""The largest load that a structure carries before it snaps or collapses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from ngsolve import VOL, ElementId, Grad, GridFunction, InnerProduct, Integrate, Parameter, Sym

from ngslac.errors import ContactConvergenceError, LinearSolveError

if TYPE_CHECKING:
    from ngslac.solve.solver import ContactSolver

__all__ = ["LimitLoad"]

# Part of the tangent's motion for which the resistance is looked at, how often it is shortened,
# and how far the resistance at its beginning may be from that which the tangent says.
SHORT, ROUNDS, STRAIGHT = 2.0**-6, 4, 0.2
# Residual of a load, relative to the forces at work, that moves nothing; of constraints, too.
IDLE = 1e-6
# Part of the way to the limit that a step goes, and of the step asked for that is near to it.
SAFE, NEAR = 0.7, 1 / 48
# How far beyond a limit that is near the step goes which has to fail if it is one.
BEYOND = 3.0
# Solves that end at a tangent without resistance, of which the last one may be believed.
FOLDS = 2


class LimitLoad:
    """Looks for a limit of the load from converged states and from where Newton's method got stuck.

    Along the motion that a load causes at first, the resistance of a structure that collapses has
    a maximum. For a short way the resistance is a parabola, whose maximum estimates the limit
    (Koiter's expansion), the better the nearer it is. Beyond the limit, Newton's method gets stuck
    where the residual has a minimum that is not zero, which is where the tangent is singular: the
    least load that is left there shows the limit, too.
    """

    def __init__(self, solver: ContactSolver, load: Parameter, full: float):
        self.solver, self.system, self.load, self.full = solver, solver.system, load, full
        self.expected = None  # the limit, by the first estimate; None: there seems to be none
        self.folds, self._place = 0, ""  # how often the second one found a limit, and where

    @property
    def suspected(self) -> bool:
        """Does anything speak for a limit?"""
        return self.expected is not None or self.folds > 0

    def Estimate(self, goal: float, failed: bool) -> None:
        """Look from the converged state at hand towards another load, by which a step may fail.

        Solution and load are the same afterwards, not so what contacts have evaluated.
        """
        self._begin, self._goal, self._fold = self.load.Get(), goal, False
        self.expected = None
        if self.system.islinear or not self.solver.history:
            return  # nothing bends, or no solve has come to a residual
        values = self.system.values
        before = values.copy()
        try:
            self.load.Set(goal)
            if self._LeadsWhatTouches():
                return
            if failed and self.solver.stuck is not None:
                self._LookAtFold()
            values[:] = before
            self.load.Set(goal)
            share = self._Share()
            self.expected = self._begin + share * (goal - self._begin) if share < 1 else None
        except (ContactConvergenceError, LinearSolveError):
            return
        finally:
            values[:] = before
            self.load.Set(self._begin)

    def Size(self, size: float) -> float:
        """Of the next step: that which is wanted, unless the limit is nearer."""
        if self.expected is None:
            return size
        left = abs(self.expected - self._begin)
        own = SAFE * left if left > NEAR * abs(self.full) else BEYOND * left
        return np.copysign(min(abs(size), own), self.full)

    def Passed(self) -> bool:
        """Does the short step that failed last confirm a limit?"""
        size = abs(self._goal - self._begin)
        return size <= 1.001 * BEYOND * NEAR * abs(self.full) and self.known

    @property
    def known(self) -> bool:
        """Does the step that failed last lead beyond a limit?"""
        return self.expected is not None or (self._fold and self.folds >= FOLDS)

    def __str__(self) -> str:
        return (
            f"a limit load is reached between {self._begin:.4g} and {self._goal:.4g}, where "
            f"{self._place}. Prescribe a displacement in place of a force, or follow the motion "
            "with a TimeStepper"
        )

    def _LeadsWhatTouches(self) -> bool:
        """Does the load move a tool or change gaps, rather than push? Such a load has no limit."""
        return self.system.MeasureExactly().constraint > IDLE

    # --- from a converged state ------------------------------------------------------------------

    def _Share(self) -> float:
        """Part of the step of the load up to the first maximum of the resistance; or infinite."""
        before = self.system.values.copy()
        start, motion = self._Tangent()
        if motion is None:
            return np.inf
        share = self._Peak(before, start, motion)
        if share < 1 and not self._fold:
            self._place = self._Place(motion)
        return share

    def _Tangent(self) -> tuple[np.ndarray, np.ndarray] | tuple[None, None]:
        """Forces that are not balanced, and the motion that follows from the tangent."""
        system = self.system
        system.motion = None
        system.Assemble()
        state = system.MeasureExactly()
        if not state.finite or state.equilibrium < IDLE:
            return None, None
        start = self._Forces()
        return start, -system.Correction(system.Linearize(state))

    def _Forces(self) -> np.ndarray:
        """Of bulk, loads and contact on the displacements, as measured last."""
        residual = self.system.residual
        return np.where(residual.displacements, residual.scaled / self.system.scale, 0.0)

    def _Peak(self, before: np.ndarray, start: np.ndarray, motion: np.ndarray) -> float:
        """From the parabola that the work against the resistance is for a short way."""
        push = -float(motion @ start)
        if push <= 0:
            return np.inf
        part, share = SHORT, np.inf
        for _ in range(ROUNDS):
            there, back = (self._Work(before, start, motion, s) / push for s in (part, -part))
            slope, bend = (there - back) / (2 * part), -(there + back) / (2 * part**2)
            if not abs(slope - 1) < STRAIGHT:  # something gives way at once, or it is no number
                return np.inf
            share = 1 / (4 * bend) if bend > 0 else np.inf
            if part <= share / 4:
                break
            part = share / 8
        return share

    def _Work(
        self, before: np.ndarray, start: np.ndarray, motion: np.ndarray, part: float
    ) -> float:
        """Of the forces that a part of the motion adds, along all of it."""
        self.system.values[:] = before + part * motion
        if not self.system.MeasureExactly().finite:
            return np.nan
        return float(motion @ (self._Forces() - start))

    # --- from where Newton's method got stuck ----------------------------------------------------

    def _LookAtFold(self) -> None:
        """Is what is left of the residual there a part of the load? Then that has a limit."""
        residual = self.system.residual
        self.system.values[:] = self.solver.stuck
        at = []
        for load in (self._begin, self._goal):
            self.load.Set(load)
            if not self.system.MeasureExactly().finite:
                return
            at.append(np.where(residual.displacements, residual.scaled, 0.0))
        left, push = float(at[1] @ at[1]), float(at[1] @ (at[1] - at[0]))
        self._fold = 0.1 * push < left < 2 * push
        if self._fold:
            self.folds += 1
            _, motion = self._Tangent()
            self._place = self._Place(motion) if motion is not None else self._place

    def _Place(self, motion: np.ndarray) -> str:
        """The body and the element that a motion strains most, in words."""
        form = self.system.contacts[0].form
        u, mesh = GridFunction(form.component), form.fes.mesh
        first, values = form.offset * form.fes.dim, u.vec.FV().NumPy()
        values[:] = motion[first : first + len(values)]
        strain = Sym(Grad(u))
        strains = Integrate(InnerProduct(strain, strain), mesh, element_wise=True).NumPy()
        volumes = Integrate(1, mesh, element_wise=True).NumPy()
        weakest = ElementId(VOL, int(np.argmax(np.asarray(strains) / np.asarray(volumes))))
        corners = [mesh[v].point for v in mesh[weakest].vertices]
        place = ", ".join(f"{value:.3g}" for value in np.mean(corners, axis=0))
        bodies = self.system.bodies
        dofs = [dof for dof in form.component.GetDofNrs(weakest) if dof >= 0]
        name = bodies.name(bodies.part[dofs[0] * form.fes.dim])
        return f"body {name} snaps or collapses, most of all around ({place})"
