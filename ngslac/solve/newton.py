# SPDX-License-Identifier: LGPL-2.1-or-later
"""One solve by a generalised Newton method with active set."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ngslac.bodies.messages import OwnLawMessage, RubberMessage
from ngslac.errors import ContactConvergenceError, FloatingBodyError, LinearSolveError, Reason
from ngslac.solve.descent import Descent
from ngslac.solve.failure import CarriedOff, Failure
from ngslac.solve.globalization import Globalization
from ngslac.solve.holding import Holding
from ngslac.solve.inverted import InvertedError
from ngslac.solve.iteration import Iteration, Log, MostlySlips, Unchanged
from ngslac.solve.look import BORNE, Look
from ngslac.solve.nearness import FEW, Nearness
from ngslac.solve.relaxation import Relaxation
from ngslac.solve.stability import UnstableError
from ngslac.solve.statussearch import FAILURES, StatusSearch

if TYPE_CHECKING:
    from ngslac.solve.residual import Measurement
    from ngslac.solve.system import Configuration, System

__all__ = ["Newton"]

# Iterations of a first solve that are many, and the ratio of Poisson from which on that is why.
LONG, RUBBER = 20, 0.485
# Steps in which all is settled after the contact conditions of a linear bulk have been solved.
SETTLES = 8
# How often the contact conditions of a linearised problem may have no solution that is found; if
# one leads so far that it has to be shortened, they are left alone.
MOST_TRIES = 2
# Residual from which on Newton's steps are the best ones, whatever changes.
NEAR = 1e-3
# Newton's steps where a law of one's own may soften, unless they get on.
OWN = 15
# Linear solves that have to be left for another method to be tried.
LEAST = 10
# Slip of a step, relative to the size of macro-elements, that small sliding is not made for.
STRAYED = 0.5
# Most iterations of another method where loads carry a body off, nearly all slips, or the bulk is
# nonlinear, where a smaller step may be the better way; Newton's iterations from which on nearly
# all has slipped for long.
SEARCH, RUBBED = 30, 10
# Most iterations in which a law that softens comes to a stable state.
DESCENT = 200
# Most iterations in which loose bodies come to rest, for each of them, and for all.
RELAX, MOST_RELAX = 120, 500
# Several loose bodies with friction fly about where Newton's method carries them so far, relative
# to the largest macro-element, after so many steps. Then they come to rest first, within so many
# iterations.
SEVERAL, FLOWN, TRIES, SETTLE = 2, 20.0, 3, 60
# Relative residual of an iterative solution while the contact status still changes: without and
# with tangential forces, whose direction has to be found, too.
LOOSE, FIRM = 0.1, 1e-2
# The same where the status still changes after so many iterations: of thin bodies in bending a
# small residual is no small error.
FINE, EARLY = 1e-3, 6
# Newton steps in which round bodies may turn, and how far that may move anything, relative to the
# mesh.
LET_TURN, TURNED = 8, 1e-2
# What turns round sticks a little behind that point; how many of those that turn are looked at.
TURN, MOST_TURNS = 1e-6, 3


class FlightError(ContactConvergenceError):
    """Loose bodies are carried far off."""


class Newton:
    """The way of a System to its solution, once."""

    def __init__(self, system: System, log: Log, *, initial: str, path: bool):
        self.system, self.log, self.tol, self.path = system, log, log.tol, path
        self.globalization, self.holding = Globalization(), Holding(system, initial)
        self.failure = Failure(system, self.holding)
        self.tries = 0  # that found no way to obey the contact conditions
        self.settled = True  # is the state the one of all solutions that is nearest to the start?
        self.onpath = False  # another method looks for the status: none is guessed
        self.reach = None  # values (n,), and how far from there bodies may fly
        self.stuck = None  # the solution where the residual has a minimum that is not zero

    @property
    def history(self) -> list[Iteration]:
        """The lines of the table so far."""
        return self.log.history

    def Run(self, maxit: int) -> Iteration:
        """The last line, after at most so many linear solves; raises what keeps it from that."""
        system = self.system
        system.Assemble()
        system.residual.Follow()
        state = system.residual.Begin(system.scale, self.tol)
        if not state.finite:
            raise ContactConvergenceError(f"{state.reason} at the start")
        start, found = system.Place(), None
        self.falls = self._Falls()
        try:
            if (last := self._OnSurfaces(state)) is None:
                state = self._Closed(state)
                self.reach = self._Reach(start)
                most = OWN if system.own_law else system.scheme.most
                last = self.Iterate(state, min(maxit, most), maxit)
            if not (system.residual.drowned and (self._Strays() or self._IsPushedFrom(start))):
                return last
            found = system.Place()
            raise ContactConvergenceError("bodies move until their forces are rounding errors")
        except InvertedError as error:
            self.failure.LookAt(start, error, lost=False)
            raise
        except FAILURES as error:
            return self._Otherwise(error, maxit, start, found)

    def _Closed(self, state: Measurement) -> Measurement:
        """The first state, noted, with what has to hold bodies closed."""
        if self.holding.Close(start=True):
            state = self.system.Measure()
        self.Record(state)
        return state

    def _OnSurfaces(self, state: Measurement) -> Iteration | None:
        """The last line where nothing but contact is nonlinear, and its conditions are solved.

        None, and back, where that is not found, or does not lead to a solution at once.
        """
        system, number = self.system, len(self.history)
        suits = system.scheme.searches and self.holding.initial == "gap" and system.islinear
        if not suits or self.Converged(state):
            return None
        idle, start = system.Freedom("rubbing").Others(), system.Place()
        correction = system.ContactCorrection(system.Linearize(state))
        if correction is None:
            return None
        system.values[:] -= correction
        after = system.Trial(state, 1.0, correction)
        if after.finite and idle:
            system.PutBack(idle, start[0])
            after = system.Measure()
        if after.finite and (free := system.Freedom("rubbing")):
            self.settled = False
            system.TurnBack(free, start[0])
            after = system.Measure()
        last = None
        if after.finite and (self.settled or self._Stays()):
            end = system.Place()
            self.Record(system.Visit(start))
            system.GoTo(end)
            after = system.Measure()
            system.Moved(state, after, -correction, 1.0)
            after = self.Confirmed(after)
            self.Record(after)
            last = self.Polish(after, SETTLES)
        if last is None:
            del self.history[number:]
            self.settled = True
            system.ForgetBodies()
            system.Visit(start)
        return last

    def _Stays(self) -> bool:
        """Has no body moved farther than what is driven, by a macro-element?"""
        return self.system.Flight() <= np.max(self.system.Sizes())

    def _Falls(self) -> bool:
        """Do loose bodies have a way to fall before large sliding sees what holds them?"""
        system = self.system
        if not (system.finite and system.bodies.loose):
            return False
        system.Evaluate()
        touches = any(np.any(contact.Table()["status"]) for contact in system.contacts)
        return not touches or system.IsDriven(system.Freedom().Others())

    # --- the loop ------------------------------------------------------------------------------

    def Iterate(self, state: Measurement, patience: int, most: int = 0) -> Iteration:
        """Newton's method from the Measurement noted last: the last line.

        At most `patience` steps, or up to `most` as long as the residual falls.
        """
        for contact in self.system.contacts:
            contact.form.BeginSolve()
        self.globalization.Begin()
        for number in range(max(patience, most) + 1):
            if self.Converged(state):
                return self._LetTurn() or self.Accept()
            # A body that contact holds may slip far, and only the residual tells.
            patient = self.system.islinear and not self.system.bodies.floating
            self.Watch(state, patient=patient)
            slow = number >= patience and not (number < most and self.globalization.falls)
            if slow or self.globalization.stagnates or self._Crawls() or self._Strides():
                break
            if len(self.history) > 1:
                self.system.Assemble()
            state, damping = self._Step(state)
            self.settled = True
            state = self.Confirmed(state)
            self.Record(state, damping)
        # A residual that falls no more is at a minimum.
        steps = self.globalization
        if steps.stagnates and not steps.returns and Unchanged(self.history) and not self.onpath:
            self.stuck = self.system.values.copy()
        raise self.NotConverged(state)

    def Watch(self, state: Measurement, *, patient: bool = False) -> None:
        """Let the globalisation look at the iterate noted last, see there."""
        moving = self.system.motion is not None
        self.globalization.Watch(state, self.history[-1].changed, patient=patient, moving=moving)

    def Polish(self, state: Measurement, steps: int) -> Iteration | None:
        """The end of the method from a Measurement; None, and back, if it does not come to one."""
        before = self.system.Place()
        try:
            return self.Iterate(state, steps)
        except FAILURES:
            self.system.GoTo(before)
            self.system.residual.Follow()
            return None

    def _LetTurn(self) -> Iteration | None:
        """The last line where round bodies have turned until contact balances them, or None.

        Contact does so as far as it meets several macro-elements of each, by what their meshes make
        of it. Where that takes more than a little, they stay where they are, unless it is their
        mesh that bears them there.
        """
        system = self.system
        if not (system.slides and system.ground and system.ground.turns):
            return None
        borne = system.residual.borne > BORNE
        closed = self.history[-1].stick + self.history[-1].slip
        if closed < system.gf.space.mesh.dim and not borne:
            return None  # that balances no body
        before, number, system.slides = system.Place(), len(self.history), False
        last = self.Polish(self._Balanced(), LET_TURN)
        if last and (borne or system.Way(before[0]) <= TURNED * system.residual.size):
            return last
        system.slides = True
        del self.history[number:]
        system.GoTo(before)
        system.residual.Follow()
        self._Balanced()
        system.Evaluate()
        return None

    def _Balanced(self) -> Measurement:
        """The Measurement with what holds idle bodies now."""
        self.system.HoldIdle("rubbing")
        return self.system.Measure()

    def _Crawls(self) -> bool:
        """Is another method faster? Without friction, where it follows a path to the status."""
        system = self.system
        suits = system.scheme.searches and system.islinear and not self.onpath
        rubs = any(contact.holds_tangentially and not contact.tied for contact in system.contacts)
        if rubs or not (suits and self.history[-1].changed):
            return False
        leaps = bool(system.bodies.floating) and self.globalization.leaps
        return leaps or self.globalization.crawls

    def _Strides(self) -> bool:
        """May it tear more than the next stable state does, where a law softens?

        Near a state its residual falls in each step.
        """
        if not self.system.stability.softened or self.onpath or len(self.history) < 3:
            return False
        before, now = (max(entry.equilibrium, entry.constraint) for entry in self.history[-2:])
        return now > before

    def Record(self, state: Measurement, damping: float = 1.0) -> None:
        """Note an iterate, which a part of a step led to."""
        self.system.Evaluate()
        self.log.Add(state, damping)
        late = self.onpath or len(self.history) > TRIES
        if self.reach and late and self.system.Flight(self.reach[0]) > self.reach[1]:
            raise FlightError("bodies fly about")

    def Converged(self, state: Measurement) -> bool:
        """Is it the solution?"""
        done = state.equilibrium < self.tol and state.constraint < self.tol
        return done and self.settled and self.system.motion is None

    def Confirmed(self, state: Measurement) -> Measurement:
        """The state, by the bulk's own residual where it looks converged or hopeless."""
        system = self.system
        if self.Converged(state) or self.globalization.stagnates:
            linear = system.bulk.islinear
            state = system.residual.Confirm(state, system.scale)
            if not state.finite:
                raise ContactConvergenceError(state.reason)
            if linear and not system.bulk.islinear:  # iterate on with another matrix
                self.globalization.Begin()
        return state

    def Accept(self) -> Iteration:
        """The last line, if the state that it tells of is possible."""
        Look(self.system)()
        self.system.stability.Check(self.system)
        if advice := self._RubberAdvice():
            self.system.notes["rubber"] = advice
        self.system.restless = self.system.slid = False
        for contact in self.system.contacts:
            contact._ClearOpen(self.system.gf)
        self.system.residual.Accept()
        return self.history[-1]

    def NotConverged(self, state: Measurement) -> ContactConvergenceError:
        """The error that ends the table at a Measurement."""
        return ContactConvergenceError(
            f"no convergence in {len(self.history) - 1} iterations: equilibrium "
            f"{state.equilibrium:.2e}, constraint {state.constraint:.2e}"
            + (", the contact status cycles" if self.globalization.cycles else "")
            + "; take smaller steps"
            + self.system.scheme.advice
            + (OwnLawMessage() if self.system.own_law else "")
            + (advice and "; " + advice if (advice := self._RubberAdvice()) else "")
        )

    def _RubberAdvice(self) -> str:
        """Advice for a first solve that is long because a material hardly changes its volume."""
        bulk, count = self.system.bulk, len(self.history) - 1
        if self.system.residual.converged or count <= LONG or bulk.islinear or bulk.a.condense:
            return ""
        return RubberMessage(count, self._poisson) if self._poisson > RUBBER else ""

    @cached_property
    def _poisson(self) -> float:
        """Poisson's ratio, once for all errors of a solve."""
        return self.system.bodies.PoissonRatio(self.system.bulk.mat)

    # --- one step ------------------------------------------------------------------------------

    def _Step(self, state: Measurement, *, convex: bool = False) -> tuple[Measurement, float]:
        """The Measurement after a step, and the part of it; `convex`: of a `Descent`."""
        system, vec = self.system, self.system.gf.vec
        system.scheme.Prepare(self, state)
        correction, obeys = self._Correction(state, convex)
        unproven = None if convex else self.globalization.unproven
        led_away = unproven is not None and unproven.LedAway(correction)
        if led_away:
            state, correction = self.globalization.TakeBack(), unproven.way
        start = vec.CreateVector()
        start.data = vec
        longest = system.Sight(correction)
        way = longest * correction
        judged = self._BendsHeld() and not (convex or led_away or obeys)
        nearness = Nearness(system, state, way) if judged else None

        def move(part: float) -> Measurement:
            vec.data = start
            system.values[:] -= part * way
            return system.Trial(state, part * longest, part * way)

        found = None
        if self.holding.closings and len(self.history) == 1:
            found = self.globalization.SearchStart(move)
        elif system.loose and system.motion is None:
            found = self._Stick(state, move)
        moving = system.motion is not None or convex
        trial, part = found or self.globalization.Search(move, moving, nearness)
        damping = part * longest
        if obeys and damping < 1:
            self.tries = MOST_TRIES
            vec.data = start
            return self._Step(system.Visit(system.Place()), convex=convex)
        if not trial.finite:
            raise ContactConvergenceError(trial.reason + " however short the Newton step")
        system.Moved(state, trial, -correction, damping)
        if self.holding.Close(guess=not self.onpath):
            return system.Measure(), damping
        return trial, damping

    def _Correction(self, state: Measurement, convex: bool) -> tuple[np.ndarray, bool]:
        """That of the next step, and whether all contact conditions hold after it.

        As far as pairs, normals and the bulk stay as they are. While the status changes that is the
        better step, unless a few macro-elements touch, whose normals matter most.
        """
        system, last = self.system, self.history[-1]
        residual = system.Linearize(state, convex=convex)
        changes = not system.islinear and (last.changed or not last.number)
        far = max(state.equilibrium, state.constraint) > NEAR
        touches = np.count_nonzero(state.status)
        suits = changes and far and not 0 < touches <= FEW and self.tries < MOST_TRIES
        if suits and system.scheme.searches and not (convex or self.onpath or system.Idles()):
            found = system.ContactCorrection(residual)
            if found is not None:
                return found, True
            self.tries += 1
        return system.Correction(residual, self._Accuracy(state)), False

    def _BendsHeld(self) -> bool:
        """Do bodies bend that others than contact hold, and is there no motion left?"""
        system = self.system
        bends = not system.islinear and system.contacts[0].components > 1
        held = not (system.bodies.floating or system.loose or system.ground or system.residual.drag)
        return bends and held and system.motion is None

    def _Stick(
        self, state: Measurement, move: Callable[[float], Measurement]
    ) -> tuple[Measurement, float] | None:
        """The step up to where another macro-element sticks; None if none comes to rest.

        Where all that holds a body slips nothing tells how far it moves: until a slip turns round.
        If that has been tried, the body moves the other way: its equilibrium may be unstable.
        """
        before = self._Slips()
        if not move(1.0).finite:
            return None
        change = self._Slips() - before
        length = np.sum(change**2, axis=1)
        turns = (state.status == 2) & (length > 0)
        parts = -np.sum(before * change, axis=1)[turns] / length[turns]
        if np.any(parts > 0):
            for part in sorted(parts, key=lambda part: (part < 0, abs(part)))[:MOST_TURNS]:
                trial = move(part * (1 + TURN))
                sticks = trial.finite and np.any(trial.status == 1)
                if sticks and not self.globalization.Knows(trial):
                    return trial, part
        return None

    def _Slips(self) -> np.ndarray:
        """Of the macro-elements of all contacts (n, d)."""
        return np.concatenate([contact.Table()["slip"] for contact in self.system.contacts])

    def _Accuracy(self, state: Measurement) -> float:
        """Relative residual that an iterative solution needs for the next step to be a Newton step.

        Loose while the contact status changes, then such that convergence stays quadratic, or
        enough where nothing but the status was nonlinear.
        """
        last = self.history[-1]
        most, scheme = FIRM if self.system.rubs else LOOSE, self.system.scheme
        if last.number > EARLY and self.system.islinear:
            most = FINE
        if last.changed or not last.number:
            return most
        size = max(state.equilibrium, state.constraint)
        if not size:  # all that is left is a motion
            return most
        enough = 0.03 * self.tol / size
        final = self.system.bulk.islinear and not (last.slip and self.system.rubs)
        return min(most, max(enough if final else max(enough, 0.1 * size), scheme.accuracy))

    # --- where it does not get there -----------------------------------------------------------

    def _Strays(self) -> bool:
        """Did a body that contact holds move farther than what drives it, by a macro-element?

        In small sliding its slip tells, which is not made for as much.
        """
        if not self.system.bodies.floating:
            return False
        if self.system.finite and self.system.Flight() > STRAYED * np.max(self.system.Sizes()):
            return True
        contacts = [c for c in self.system.contacts if not c.finite]
        slips = [np.linalg.norm(c.Table()["slip"], axis=1) / c._Sizes() for c in contacts]
        return max((np.max(slip) for slip in slips), default=0.0) > STRAYED

    def _IsPushedFrom(self, start: Configuration) -> bool:
        """Do loads carry a body off from that solution? Contacts are as they are afterwards."""
        now = self.system.Place()
        self.system.values[:] = start[0]
        carried = CarriedOff(self.system)
        self.system.GoTo(now)
        self.system.Measure()
        return bool(carried)

    def _Reach(self, start: Configuration) -> tuple[np.ndarray, float] | None:
        """How far from the start Newton's method may carry several loose bodies that rub."""
        system = self.system
        if not (system.islinear and system.rubs and len(system.bodies.floating) >= SEVERAL):
            return None
        farthest = STRAYED if self.holding.Reaches() else FLOWN
        return start[0], farthest * np.max(system.Sizes())

    def _Otherwise(
        self,
        error: ContactConvergenceError | LinearSolveError,
        maxit: int,
        start: Configuration,
        found: Configuration | None,
    ) -> Iteration:
        """The last line of another method, from the start again; else what Newton's found."""
        system, failure, self.reach = self.system, self.failure, None
        if not system.scheme.searches:
            if found is not None and not system.bodies.Lost(found[0]):
                return self.Accept()
            failure.LookAt(start, error, lost=True)
            raise error
        failure.slides = "" if found is not None else self.holding.WhatSlides(self.history)
        held = bool(system.bodies.floating) and system.HasFriction()  # by contact alone
        if held and len(self.history) > RUBBED and MostlySlips(self.history):
            failure.reason |= Reason.SLIPS
        if failure.slides or Reason.SLIPS in failure.reason or not system.islinear:
            maxit = min(maxit, len(self.history) + SEARCH)
        failure.LookAt(start, error, lost=found is None)
        system.restless = system.restless or bool(failure.unbalanced)
        try:
            floats = isinstance(error, FloatingBodyError)
            loose = found is not None or floats or self.falls
            path = self.path and any(entry.changed for entry in self.history)
            unstable = isinstance(error, UnstableError)
            suits = self.path or unstable if system.own_law else loose or path or system.islinear
            if failure.known or maxit - len(self.history) < LEAST or not suits:
                raise error
            system.GoTo(start)
            failure.reason |= Reason.EXHAUSTED
            return self._Search(error, maxit, start)
        except FAILURES:
            if found is None or system.bodies.Lost(found[0]):
                raise
            system.GoTo(found)
            self.Record(system.Measure())
            return self.Accept()

    def _Search(
        self,
        error: ContactConvergenceError | LinearSolveError,
        maxit: int,
        start: Configuration,
    ) -> Iteration:
        """The last line of what finds the contact status by a path, or lets bodies come to rest."""
        system = self.system
        if system.own_law:
            if isinstance(error, UnstableError):
                system.GoTo(error.place)
                system.values[:] += error.push
            return Descent(self, len(self.history) + DESCENT).Run(error)
        if isinstance(error, FlightError):
            try:
                return Relaxation(self, len(self.history) + SETTLE).Run()
            except FAILURES:
                system.GoTo(start)
        if self.falls and not system.restless:
            return self._Relax(error, start)
        try:
            return StatusSearch(self, maxit).Run(error)
        except FAILURES as failed:
            if system.restless or not system.bodies.loose:
                raise
            system.GoTo(start)
            return self._Relax(failed, start)

    def _Relax(
        self,
        error: ContactConvergenceError | LinearSolveError,
        start: Configuration,
    ) -> Iteration:
        """The last line where loose bodies have come to rest."""
        system = self.system
        try:
            most = min(RELAX * system.bodies.loose, MOST_RELAX)
            if not system.islinear and system.residual.converged:
                most = SEARCH  # a smaller step from there may be the better way
            return Relaxation(self, len(self.history) + most).Run()
        except FAILURES:
            system.restless = True
            system.GoTo(start)
        raise error
