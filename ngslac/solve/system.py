# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bulk and contacts as one system of equations: residual, matrices and corrections."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from netgen.meshing import NgException
from ngsolve.la import SparseMatrixd

from ngslac.arguments import FillVector
from ngslac.arrays import Multiply, Sparse
from ngslac.bodies.bodies import Bodies
from ngslac.bodies.constraints import CONTACT, MASTER, SLAVE, AllJumps, ToolDofs, ToolsSlipFar
from ngslac.bodies.freedom import EXACT, Freedom, Ground
from ngslac.bulkforms import WithoutMass
from ngslac.errors import LinearSolveError, Warn
from ngslac.linear.system import LinearSystem
from ngslac.parallel.form import ScaleOf
from ngslac.solve.inverted import InvertedMessage, TurningMaterials
from ngslac.solve.problem import (
    CheckAxis,
    CheckBodies,
    CheckMatrix,
    MultiplierRows,
    UnheldFields,
)
from ngslac.solve.residual import Measurement, Norm, Residual
from ngslac.solve.stability import Stability
from ngslac.solve.surfaceproblem import SurfaceProblem
from ngslac.solve.surfaces import Surfaces

if TYPE_CHECKING:
    from ngsolve import BaseMatrix, BaseVector

    from ngslac._ngslac import ContactForm
    from ngslac.contact.contact import LACContact
    from ngslac.linear.solver import LinearSolver
    from ngslac.solve.bulk import Bulk
    from ngslac.solve.newton import Newton
    from ngslac.solve.relaxation import Drag
    from ngslac.tool import Tool

__all__ = ["Configuration", "Saddle", "System"]

# Values (n,) of a solution, and the motion (n,) that is left, or None.
Configuration = tuple[np.ndarray, np.ndarray | None]

# Shorter parts of a step may lead macro-elements off the master.
LEAST_SIGHT = 1 / 8
# Of the diagonal of the scaled matrix: it keeps bodies where they are that nothing pushes.
IDLE_SHIFT = 1e-6
# The same for tools that next to nothing holds, as where all contact slips under a roll.
TOOL_SHIFTS = (1e-4, 1e-3, 1e-2, 0.1, 1.0)
# Forces that push nothing, relative to those at work.
IDLE = 1e-9
# Stiffness of motions that bodies rock by, relative to that of a pendulum as large as the mesh.
ROCKS = 1e-5
# Work of stress along turns of round bodies that their space does not know, where it is nonlinear.
FALSE_TURN = 1e-3
# Of a traction: what its direction is known by.
ROUNDING = 1e-8
# How far a macro-element has to move to come through a tool, how deep in it that may begin, and how
# deep it has to have been, relative to its size; cosine of normals of opposite sides.
MOVED, TOUCHES, THIN, OPPOSITE = 0.25, 0.05, 0.02, -0.3
# Components of tractions up to which a problem of the surfaces alone is cheap: once, and for each
# matrix of a nonlinear bulk and all pairs of large sliding anew.
MOST, MOST_AGAIN = 1500, 300
# Newton steps after which the method goes on only while the residual falls.
NEWTON = 30


class Saddle:
    """The multipliers are unknowns of each linear system, as the displacements are.

    Attributes
    ----------
    most : int
        Newton steps after which the method goes on only while the residual falls.
    searches : bool
        May another method look for the contact status where this one does not find it?
    advice : str
        What else to try where there is no convergence.
    accuracy : float
        Relative residual of a linear system that is enough in each step.
    """

    most, searches, advice, accuracy = NEWTON, True, "", 0.0

    def Prepare(self, newton: Newton, state: Measurement) -> None:
        """Before each linear system of a Newton's method."""

    def Change(self, system: System) -> None:
        """Change the matrices of the contacts, which are assembled."""


class System:
    """What is solved: bulk plus contacts at a solution, with what is known of it.

    Attributes
    ----------
    residual : Residual
    scale : (n,) array or None
        Factors of the rows, once there is a matrix.
    scheme : Saddle or Augmented
        How the multipliers are found.
    motion : (n,) array or None
        How far constrained dofs still have to move: the next correction carries it.
    ground : Ground or None
        What held bodies that float and that nothing pushes, in the last linear system.
    lean : list of (m, d) array or None
        What the pressures of each contact are turned by, see `Directions`.
    idle : bool
        Do bodies float, with friction, that nothing pushes?
    notes : dict
        What the look at the last state that was accepted has to say, by its kind.
    restless, slid : bool
        Did loads carry loose bodies off, or did these not come to rest by `Relaxation`, as they
        slid on steadily? Then that is not tried again before a state is accepted.
    slides : bool
        Do round bodies stay where they are, even where closed contact seems to resist?
    stability : Stability
        The look at states of laws that soften.
    loose : bool
        Was the last linear system nearly singular, as it is where all contact of a body slips?
    """

    def __init__(
        self,
        bulk: Bulk,
        contacts: list[LACContact],
        linear: LinearSolver,
        free: np.ndarray,
        bodies: Bodies | None = None,
    ):
        self.bulk, self.gf, self.contacts, self.linear = bulk, bulk.gf, contacts, linear
        self.layout = bulk.layout
        self.residual, self.scheme = Residual(bulk, contacts, free), Saddle()
        self.scale = self.motion = self._rest = self.ground = self._start = self._driven = None
        self.loose, self.idle, self.slides = False, False, True
        self.restless = self.slid = False
        self.notes, self._said, self.stability = {}, set(), Stability()
        self.lean = self._solved = None
        self._bodies = bodies
        self._apart = False  # is the bulk known to leave the multipliers alone?
        self._turning = None  # materials of which it knows finite rotations, once that matters

    @property
    def values(self) -> np.ndarray:
        """All coefficients of the solution, to be written to."""
        return self.layout.Values(self.gf.vec)

    @property
    def finite(self) -> bool:
        """Does a contact follow large sliding?"""
        return any(contact.finite for contact in self.contacts)

    @property
    def _meshed(self) -> list[LACContact]:
        """Contacts that follow large sliding on a mesh."""
        return [c for c in self.contacts if c.finite and c.tool is None and not c.tied]

    @property
    def rubs(self) -> bool:
        """Does a contact hold surfaces in tangential direction?"""
        return any(contact.holds_tangentially for contact in self.contacts)

    def HasFriction(self) -> bool:
        """May friction be at its limit? Of a law of the user's own: does it pull aside now?"""
        return any(PullsAside(c) if c.own_law else c.holds_tangentially for c in self.contacts)

    @property
    def own_law(self) -> bool:
        """Has a contact a law of the user's own, of which only Newton's method knows?"""
        return any(contact.own_law for contact in self.contacts)

    def Softens(self) -> bool:
        """Does a law soften in the present state?"""
        return any(contact.form.Softens(self.gf.vec) for contact in self.contacts)

    @property
    def islinear(self) -> bool:
        """Is nothing but the contact law nonlinear?"""
        return bool(self.bulk.islinear) and not self.finite

    # --- state ---------------------------------------------------------------------------------

    def State(self) -> dict:
        """What the next solve depends on, as a dict."""
        return {
            "gf": self.values.copy(),
            "contacts": [contact.State() for contact in self.contacts],
            "scale": self.scale,
            "residual": self.residual.State(),
            "push": self.stability.push,
        }

    def SetState(self, state: dict) -> None:
        """Go on from a `State`, or stay as before if it is that of another problem."""
        if len(state["contacts"]) != len(self.contacts):
            raise ValueError(
                f"state is that of {len(state['contacts'])} contacts, the solver has "
                f"{len(self.contacts)}"
            )
        before = self.values.copy(), [contact.State() for contact in self.contacts]
        try:
            self._Put(state["gf"], state["contacts"])
        except BaseException:
            self._Put(*before)
            raise
        self.residual.SetState(state["residual"])
        self.scale = state["scale"]
        self.stability.push = state.get("push")

    def _Put(self, values: np.ndarray, parts: Sequence[dict]) -> None:
        FillVector("gf", self.gf.vec, values)
        for contact, part in zip(self.contacts, parts, strict=True):
            contact.SetState(part, self.gf)

    def Place(self) -> Configuration:
        """Solution and what is left of the motion, for `GoTo`."""
        return self.values.copy(), self.motion

    def GoTo(self, place: Configuration) -> None:
        """Take the solution of another `Place`."""
        self.values[:], self.motion = place

    def Visit(self, place: Configuration) -> Measurement:
        """Go to another `Place`, and let contacts look at it: the Measurement there."""
        self.GoTo(place)
        state = self.Measure()
        self.Evaluate()
        return state

    @property
    def _origin(self) -> np.ndarray:
        """The last state (n,) that was committed, else where the solve began.

        A solve of a stepper begins with a prediction, which may be behind a master.
        """
        committed = self.contacts[0]._accepted
        return self._start if committed is None else committed

    @contextmanager
    def _AtOrigin(self) -> Iterator[None]:
        """Contacts are where the step began, in this context."""
        now = self.Place()
        self.values[:] = self._origin
        self.residual.Follow()
        self.Evaluate()
        try:
            yield
        finally:
            self.Visit(now)

    def Tell(self) -> None:
        """Warn of the notes, unless the solution before had the same ones."""
        for kind, message in self.notes.items():
            if kind not in self._said:
                Warn(message)
        self._said = set(self.notes)

    def Way(self, before: np.ndarray) -> float:
        """How far anything has moved since other values (n,)."""
        return np.abs(self.values - before)[self.residual.displacements].max()

    def Flight(self, before: np.ndarray | None = None) -> float:
        """How much farther a body has moved than what is driven, since values (n,) or the start."""
        moved = self.values - (self._start if before is None else before)
        driven = self.residual.displacements & ~self.residual.free
        return self.bodies.Way(moved) - np.max(np.abs(moved[driven]), initial=0)

    def Sizes(self) -> np.ndarray:
        """Of all macro-elements."""
        return np.concatenate([contact._Sizes() for contact in self.contacts])

    def Passed(self) -> tuple[float, np.ndarray] | None:
        """How far the slave has gone through its master since the start, and where; or None.

        By more than the slave is large, straight on, where all that moves so far is open.
        """
        tables = [(contact, contact.Table()) for contact in self._meshed]
        ends = [(c, np.ptp(t["x"], axis=0).max(), t["status"] == 0) for c, t in tables]
        if not ends or self.Way(self._origin) <= min(size for _, size, _ in ends):
            return None
        motion = self.values - self._origin
        with self._AtOrigin():
            way, place = max((WayThrough(*end, motion) for end in ends), key=lambda found: found[0])
        return (way, place) if way > 0 else None

    def PassedTool(self) -> np.ndarray | None:
        """Where the slave has gone through a tool since the last step, or None."""
        contacts = [c for c in self.contacts if c.tool and c.active and not len(c.form.ToolDofs())]
        if not contacts:
            return None
        with self._AtOrigin():
            begins = [contact._OnTool(contact._placement) for contact in contacts]
        places = (ThroughTool(c, begin) for c, begin in zip(contacts, begins, strict=True))
        return next((place for place in places if place is not None), None)

    def CheckSpace(self) -> None:
        """What was made for a space goes on with this one: it was not refined since."""
        if len(self.linear.free) != self.values.size:
            raise ValueError(
                "the space was refined: make a new ContactSolver, and then new steppers"
            )

    def PairOnce(self) -> None:
        """Pair what is not paired yet, in the reference configuration."""
        for contact in self.contacts:
            if not contact.form.paired:
                contact.Update()

    def StartAfresh(self) -> None:
        """Keep no matrix and no factorisation: the next solve makes its own."""
        self.bulk.StartAfresh()
        self.linear.NewBulk()

    def Begin(self, motion: np.ndarray | None, constrained: np.ndarray) -> None:
        """Start a solve."""
        self.bulk.Begin()
        self.motion, self._start = None, self.values.copy()
        self.ForgetBodies()
        self.SetDrag(None)
        self.Lean()
        if motion is not None and np.any(motion[constrained]):
            self.motion = np.where(constrained, motion, 0.0)
            # What is left of the motion up to this is rounding, see `Moved`.
            self._rest = np.finfo(float).eps * np.max(np.abs(self.motion))

    def ForgetBodies(self) -> None:
        """Forget which bodies are held, and which are driven."""
        self._driven, self.slides, self.linear.shifts = None, True, 0
        self.SetGround(None)

    def Lean(self) -> None:
        """Turn the pressures of the contacts by what is known."""
        for k, contact in enumerate(self.contacts):
            if contact.form.paired:
                contact.form.Lean(self.lean[k].ravel() if self.lean else [])

    # --- residual and matrices -----------------------------------------------------------------

    def Assemble(self) -> None:
        """Make the bulk's matrix at the solution, and the scale."""
        bulk = self.bulk
        if bulk.Assemble():
            self.linear.NewBulk()
        fresh = [contact for contact in self.contacts if not contact.prepared]
        elastic = bulk.elastic if fresh else None
        for contact in fresh:
            contact.Prepare(bulk.mat, form=elastic)
        if not self._apart:
            CheckMatrix(bulk.mat, MultiplierRows(self.contacts), self.layout)
            free, rests = self.linear.free & ~bulk.inner, not np.any(self.values)
            CheckBodies(bulk.mat, self.contacts[0], free, rests=rests)
            CheckAxis(bulk.mat, self.contacts, self.linear.free)
            self._apart = True
        self.scale = ScaleOf(bulk.mat, self._Forms())
        if bulk.a.condense:  # the Schur complement does not tell the stiffness of inner dofs
            self.scale[bulk.inner] = np.median(self.scale[self.linear.free])

    def _Forms(self) -> list[ContactForm]:
        return [contact.form for contact in self.contacts]

    def Evaluate(self) -> None:
        """Contacts look at the solution."""
        for contact in self.contacts:
            contact.Evaluate(self.gf)

    def Measure(self) -> Measurement:
        """The Measurement of the solution."""
        return self.residual.Measure(self.scale, self.motion is not None)

    def MeasureExactly(self) -> Measurement:
        """The Measurement of the solution, by the bulk form itself."""
        return self.residual.Measure(self.scale, exact=True)

    def Sight(self, correction: np.ndarray) -> float:
        """The part of a correction (n,) that takes no face farther than contact looks for it."""
        return min((SightOf(contact, -correction) for contact in self._meshed), default=1.0)

    def Trial(self, state: Measurement, part: float, motion: np.ndarray) -> Measurement:
        """The Measurement after a part of a step, a motion (n,), from another Measurement."""
        trial = self.Measure()
        if trial.finite and part > LEAST_SIGHT:
            moved = np.max(np.abs(motion[self.residual.displacements]), initial=0.0)
            if trial.LostSight(state, moved):
                return Measurement.Nothing("surfaces pass through each other")
        return trial

    def Moved(
        self, before: Measurement, after: Measurement, motion: np.ndarray, part: float
    ) -> None:
        """Learn from a part of a motion between two States, which was taken."""
        self.bulk.Learn(before, after, -part * motion, self.scale, self.residual)
        if self.motion is not None:
            self.motion = (1 - part) * self.motion
            if np.max(np.abs(self.motion)) <= self._rest:
                self.motion = None

    def CountMotionAsDone(self) -> bool:
        """Where one step of a linear bulk carries the whole motion; says whether it does."""
        if self.islinear:
            self.motion = None
        return self.islinear

    # --- linear systems ------------------------------------------------------------------------

    def Linearize(self, state: Measurement, *, convex: bool = False) -> BaseVector:
        """The residual (BaseVector) of the next linear system, whose matrices are assembled.

        `convex`: they know nothing of how laws soften.
        """
        residual = self.gf.vec.CreateVector()
        values = self.layout.Values(residual)
        values[:] = state.bulk
        for contact in self.contacts:
            contact.form.AssembleStep(self.gf.vec, residual, convex)
        if self.residual.drag:
            values += self.residual.drag.Forces(self.values, self.scale)
        self.scheme.Change(self)
        return residual

    def MakeLinearSystem(
        self, contacts: Sequence[BaseMatrix], rhs: np.ndarray, **options
    ) -> LinearSystem:
        """That of the bulk, and of matrices of contacts."""
        multipliers = np.concatenate([form.MultiplierDofs() for form in self._Forms()])
        return LinearSystem(self.bulk.mat, contacts, multipliers, self.scale, rhs, **options)

    def Correction(self, residual: BaseVector, accuracy: float = 0.0) -> np.ndarray:
        """The correction (n,) of the linear system with this residual."""
        self.loose, drag, mats = False, self.residual.drag, [form.mat for form in self._Forms()]
        self.HoldIdle("rubbing", mats)

        def Solve(residual: np.ndarray) -> np.ndarray:
            """The same without condensed dofs; bodies and tools that nothing holds stay."""
            displacements = ~self.residual.multipliers
            system = self.MakeLinearSystem(mats, residual, accuracy=accuracy)
            self._solved = system
            if drag or self.idle:
                shift = drag.Shift() if drag else IDLE_SHIFT * displacements
                return self.linear.Solve(replace(system, shift=shift))
            if self.ground:
                held = replace(system, shift=self.ground.Shift())
                found = self.linear.SolveShifted(held, displacements)
                self.loose = bool(self.linear.shifts)
                return found
            found = self.linear.SolveShifted(system, displacements)
            singular = self.linear.nearly_singular or self.linear.shifts
            if ToolsSlipFar(self.contacts, found):
                found, singular = self._WithHeldTools(system), True
            if singular and self._MayStay(found[displacements]):
                return self.linear.Solve(replace(system, shift=IDLE_SHIFT * displacements))
            self.loose = bool(singular)
            return found

        return self.Displace(residual, Solve, mats)

    def ContactCorrection(self, residual: BaseVector) -> np.ndarray | None:
        """The correction (n,) to where all contact conditions hold; None where it is not found.

        Of a problem of which nothing but contact is nonlinear, see `SurfaceProblem`.
        """
        many = sum(np.count_nonzero(self.linear.free[f.MultiplierDofs()]) for f in self._Forms())
        suits = many <= (MOST if self.islinear else MOST_AGAIN) and not self.residual.drag
        if not suits or not Surfaces.Suit(self.contacts):
            return None
        self.SetGround(None)
        mats = [form.mat for form in self._Forms()]

        def Solve(rows: np.ndarray) -> np.ndarray:
            """The correction, or an error."""
            system = self.MakeLinearSystem(mats, rows)
            compliance = self.linear.Compliance(system)
            scale, moved = self.scale[system.multipliers], np.zeros(len(system.multipliers))
            if self.motion is not None:
                moves = sum(Sparse(mat).T @ self.motion for mat in mats)
                moved = -scale * moves[system.multipliers]
            parts = Surfaces(self.contacts), compliance, scale, moved, self.residual.size
            forces = SurfaceProblem(*parts).Solve()
            if forces is None:
                raise LinearSolveError("no tractions are found")
            return self.scale * compliance.Solution(forces)

        try:
            return self.Displace(residual, Solve, mats)
        except (LinearSolveError, NgException):
            return None

    def SimplifiedCorrection(self) -> np.ndarray:
        """That (n,) of the residual measured last, with the matrices of the last correction."""
        residual = self.gf.vec.CreateVector()
        self.layout.Values(residual)[:] = np.sum(self.residual.parts, axis=1)

        def Solve(rows: np.ndarray) -> np.ndarray:
            return self.linear.Solve(replace(self._solved, rhs=rows))

        return self.Displace(residual, Solve, [form.mat for form in self._Forms()])

    def _MayStay(self, displacements: np.ndarray) -> bool:
        """May bodies stay where they are, in place of displacements of a nearly singular system?"""
        if free := self.Freedom().Others():
            return not self.IsPushed(free)
        # What holds them is soft, then, unless it hardly holds them.
        return bool(self.bodies.floating) and np.max(np.abs(displacements)) > self.bodies.size

    def _WithHeldTools(self, system: LinearSystem) -> np.ndarray:
        """The solution with springs on the motions of tools, as weak as they may be."""
        tools = np.isin(np.arange(len(system.rhs)), ToolDofs(self.contacts))
        for shift in TOOL_SHIFTS:
            found = self.linear.Solve(replace(system, shift=shift * tools))
            if not ToolsSlipFar(self.contacts, found):
                break
        return found

    def Displace(
        self,
        residual: BaseVector,
        solve: Callable[[np.ndarray], np.ndarray],
        mats: Sequence[BaseMatrix],
    ) -> np.ndarray:
        """The correction (n,) of a residual; `solve` gives it without condensed dofs."""
        bulk, correction, Values = self.bulk, self.gf.vec.CreateVector(), self.layout.Values

        def Solve(forces: np.ndarray, motion: np.ndarray | None = None) -> np.ndarray:
            """The correction (n,) of forces, with condensed dofs, that carries a motion."""
            right = residual.CreateVector()
            rows, found = Values(right), Values(correction)
            rows[:] = forces
            bulk.Condense(right)
            if motion is not None:
                rows -= Multiply((bulk.mat, *mats), -motion)
            found[:] = solve(rows)
            if motion is not None:
                found -= motion
            bulk.Extend(correction, right)
            return Values(correction).copy()

        forces = Values(residual)
        if not self.ground:
            return Solve(forces, self.motion)
        found = Solve(self.ground.Balanced(forces), self.motion)
        return self.ground.Nearest(self.values, found, self.scale, Solve)

    # --- bodies --------------------------------------------------------------------------------

    @property
    def bodies(self) -> Bodies:
        """The Bodies, found when first asked for."""
        if self._bodies is None:
            self._bodies = Bodies(self.bulk.mat, self.contacts[0], self.linear.free)
        return self._bodies

    def Freedom(
        self, holds: str = "now", normals: str = CONTACT, slides: bool | None = None
    ) -> Freedom:
        """The motions that contact leaves, see `Bodies.Freedom`."""
        slides = self.slides if slides is None else slides
        turns = self.finite or self.bulk.islinear is False
        values = self.values if turns else None
        return self.bodies.Freedom(self.contacts, holds, values, normals, slides)

    def WhatFloats(self, holds: str = "now") -> list[str]:
        """Descriptions of these motions."""
        return self.bodies.Names(self.Freedom(holds).weights)

    def UnheldFields(self) -> str:
        """Where the last matrices hold no constant of a scalar field, in words."""
        mats = [self.bulk.mat, *(form.mat for form in self._Forms())]
        known = self._apart and isinstance(self.bulk.mat, SparseMatrixd)
        return UnheldFields(mats, self.contacts, self.linear.free) if known else ""

    def IsDriven(self, freedom: Freedom, holds: str = "now") -> bool:
        """Do the forces measured last do work on the motions that contact leaves?"""
        return bool(freedom) and bool(np.any(self._Drives(freedom, holds)))

    def _Drives(self, freedom: Freedom, holds: str) -> np.ndarray:
        """Their work (k,) on free motions.

        On curved surfaces with other normals on both sides, as in a hole with play, bodies slide
        along either: nothing is driven that does not move along one of them.
        """
        works = self._Works(freedom)
        seem = np.flatnonzero((works != 0) & (freedom.mesh > EXACT))
        if len(seem):
            sides = [self.Freedom(holds, normals) for normals in (SLAVE, MASTER)]
            works[[k for k in seem if not self._IsDrivenAlong(freedom.Some([k]), sides)]] = 0
        return works

    def _IsDrivenAlong(self, motion: Freedom, sides: list[Freedom]) -> bool:
        """Is a motion driven as all sides that know it see it?"""
        if motion.own[0] < 0 and motion.resistance[0] <= EXACT:  # where too little touches to tell
            near = [others for side in sides if (others := side.Others())]
            known = [others for others in near if others.Along(motion) is not None]
            return all(np.any(self._Works(others)) for others in known)
        near = [side.Along(motion) for side in sides if side]
        return all(np.any(self._Works(own)) for own in near if own is not None)

    def IsPushed(self, freedom: Freedom) -> bool:
        """Does the residual measured last do work on them, with all multipliers as they are?

        Those of a linear system balance the bulk's false work, too.
        """
        bulk, contact = self.residual.parts[:, 0], self.residual.parts[:, 1]
        if not freedom or not np.any(pushed := self._WorksOf(freedom, contact)):
            return False
        return bool(np.any((pushed != 0) & (self._WorksOf(freedom, contact, bulk) != 0)))

    def PutBack(self, freedom: Freedom, start: np.ndarray) -> None:
        """Take bodies that contact does not press back to where they were at values (n,).

        `freedom` are the motions that they had there.
        """
        forces = self.scale * self.residual.parts[:, 1]
        least = self.residual.tol * max(self.residual.forces, self.residual.first)
        moved = np.any(freedom.motions, axis=1) & (freedom.body >= 0)
        for body in np.unique(freedom.body[moved]):
            rows = moved & (freedom.body == body)
            if Norm(forces[rows]) <= least:
                self._TakeBack(freedom, start, rows)

    def TurnBack(self, freedom: Freedom, start: np.ndarray) -> None:
        """Take bodies back along motions that nothing resists, as near to values (n,) as may be."""
        self._TakeBack(freedom, start, np.ones(len(start), bool))

    def _TakeBack(self, freedom: Freedom, start: np.ndarray, rows: np.ndarray) -> None:
        """The same for some rows (n,) bool."""
        motions, way = freedom.motions[rows], (self.values - start)[rows]
        self.values[rows] -= motions @ np.linalg.lstsq(motions, way, rcond=None)[0]

    def DrivenMotion(self, freedom: Freedom, holds: str = "now") -> list[str]:
        """Description of the free motion along which the forces measured last do work."""
        works = self._Drives(freedom, holds)
        return self.bodies.Names((freedom.weights @ works / np.linalg.norm(works))[:, None])

    def _Works(self, freedom: Freedom) -> np.ndarray:
        """The work of loads and friction along free motions, 0 where it is none."""
        return self._WorksOf(freedom, self._Rubbing())

    def _WorksOf(
        self, freedom: Freedom, contact: np.ndarray, bulk: np.ndarray | None = None
    ) -> np.ndarray:
        """The same of other forces of the contacts, and of the bulk: without its false ones."""
        residual = self.residual
        # Loads may be in balance: then the springs that hold bodies leave a part of them.
        forces = max(residual.reference, residual.first)
        least = max(IDLE * forces, 10 * residual.rounding) / self.scale
        if bulk is None:
            bulk = residual.parts[:, 0] - self._FalseForces()
        if self.bodies.false and not self.bulk.islinear:  # its stress does work along turns, too
            turns = np.maximum(freedom.mesh, FALSE_TURN)
            freedom = replace(freedom, mesh=np.where(freedom.own >= 0, turns, freedom.mesh))
        return freedom.Works([bulk, contact], least, self._Blur(), self.bodies.false)

    def _FalseForces(self) -> np.ndarray | float:
        """What the bulk says of the displacement, if that does false work along rigid motions."""
        if not (self.bodies.false and self.bulk.islinear):
            return 0.0
        return Multiply([self.bulk.mat], np.where(self.residual.multipliers, 0.0, self.values))

    def _Rubbing(self) -> np.ndarray:
        """The forces of friction where contact is closed: pressures do not drive what they hold."""
        vec, forces = self.gf.vec.CreateVector(), self.gf.vec.CreateVector()
        vec.data, forces[:] = self.gf.vec, 0
        values = self.layout.Values(vec)
        for contact in self.contacts:
            if not (contact.holds_tangentially or len(contact.form.ToolDofs())):
                continue
            table = contact.Table()
            tangential = table["traction"] + table["pressure"][:, None] * table["normal"]
            tangential[table["status"] == 0] = 0
            tangential *= contact.holds_tangentially  # else the directions of an iterate before
            dofs = np.asarray(contact.form.MultiplierDofs())
            values[dofs] = tangential[:, : contact.components].ravel()
            contact.AddApply(vec, forces)
        return np.where(self.residual.multipliers, 0.0, self.layout.Values(forces))

    def _Blur(self) -> float:
        """How different the gaps are that have to close: so far is where they meet not known."""
        tables = [contact.Table() for contact in self.contacts]
        closed = [t["gap"][t["status"] > 0] for t in tables]
        return max((np.ptp(gaps) for gaps in closed if len(gaps)), default=0.0)

    def HoldIdle(self, holds: str, mats: Sequence[BaseMatrix] = ()) -> None:
        """Hold bodies that nothing pushes and nothing else holds, not even friction.

        With the matrices of contacts in the next linear system: nor their weight, as of a ball in a
        bowl, or weak springs.
        """
        # A drag holds them all, with forces along their motions, and two of these do not agree.
        held = not self.residual.drag and self.MayFloat()
        freedom = self.Freedom(holds) if held else None
        if not freedom:
            self.SetGround(None)
            return
        if self._driven is None:
            self._driven = np.unique(freedom.own[(freedom.own >= 0) & (self._Works(freedom) != 0)])
        # Along curved surfaces nothing but their meshes resists: bodies wait there for the end.
        stay = not self.IsDriven(freedom.Others().Outright(), holds)
        held = np.where(freedom.own < 0, stay, ~np.isin(freedom.own, self._driven))
        exact = np.flatnonzero(held & (freedom.own < 0) & (freedom.mesh <= EXACT)) if mats else []
        held[[k for k in exact if self._Rocks(freedom.Some([k]), mats)]] = False
        if not np.any(held):
            self.SetGround(None)
            return
        held = freedom.Some(held)
        measure, free = self.bodies.Measure(self.contacts, held), self.residual.free
        self.SetGround(Ground(held, measure, self._start, free, self.ground))

    def Idles(self) -> bool:
        """Do bodies have to be held that nothing pushes?"""
        self.HoldIdle("rubbing", [form.mat for form in self._Forms()])
        return self.idle or self.ground is not None

    def _Rocks(self, motion: Freedom, mats: Sequence[BaseMatrix]) -> bool:
        """Does a motion change the direction in which forces push the body?

        The false stiffness of a linear bulk does not tell.
        """
        if not (self.bulk.islinear and self.bodies.false):
            mats = [self.bulk.mat, *mats]
        way = np.where(self.bulk.inner, 0.0, motion.motions[:, 0])
        sizes = np.abs(self.residual.parts)
        forces = motion.Across([sizes[:, 0], sizes[:, 1]])[0] * np.max(np.abs(way))
        stiffness = abs(way @ Multiply(mats, way))
        return stiffness * self.residual.size > ROCKS * forces > 0

    def SetGround(self, ground: Ground | None) -> None:
        """Take what holds idle bodies, or None."""
        self.ground = self.residual.ground = ground

    def SetDrag(self, drag: Drag | None) -> None:
        """Let a Drag hold bodies, too, or None."""
        self.residual.drag = drag

    def MayFloat(self) -> bool:
        """Are there bodies or tools that contact has to hold?"""
        return bool(self.bodies.floating) or len(ToolDofs(self.contacts)) > 0

    def Inverted(self) -> tuple[str, str]:
        """Which elements are inside out: of materials that know rotations, and of all others."""
        form = self.contacts[0].form
        if self.islinear:
            return "", ""
        flat = self.bulk.islinear or self.contacts[0].components == 1
        if self._turning is None and flat:
            self._turning = np.zeros(len(self.gf.space.mesh.GetMaterials()), dtype=bool)
        elif self._turning is None:
            self._turning = TurningMaterials(WithoutMass(self.bulk.a), form, self.gf)
        others = InvertedMessage(form, self.gf, ~self._turning) if self.finite else ""
        known = InvertedMessage(form, self.gf, self._turning) if np.any(self._turning) else ""
        return known, others


def PullsAside(contact: LACContact) -> bool:
    """Has a traction a tangential part, beyond rounding, where surfaces may slide?"""
    if contact.tied:
        return False
    table = contact.Table()
    traction, normal = (table[name][table["area"] > 0] for name in ("traction", "normal"))
    aside = traction - np.sum(traction * normal, axis=1)[:, None] * normal
    return bool(np.linalg.norm(aside) > ROUNDING * np.linalg.norm(traction))


def Approach(contact: LACContact, motion: np.ndarray) -> np.ndarray:
    """How much nearer to the master a motion (n,) brings each macro-element, times its area."""
    table, d = contact.Table(), contact.mesh.dim
    moved = (AllJumps(contact) @ motion).reshape(len(table["area"]), d)
    return np.sum(moved * table["normal"], axis=1)


def WayThrough(
    contact: LACContact, size: float, may: np.ndarray, motion: np.ndarray
) -> tuple[float, np.ndarray]:
    """How far a motion takes some macro-elements through the master, if by more than a size."""
    table = contact.Table()
    paired = may & (table["area"] > 0)
    way = np.zeros(len(paired))
    way[paired] = Approach(contact, motion)[paired] / table["area"][paired] - table["gap"][paired]
    farthest = int(np.argmax(way))
    return (way[farthest] if way[farthest] > size else 0.0), table["x"][farthest]


def ThroughTool(contact: LACContact, begins: np.ndarray) -> np.ndarray | None:
    """Where a macro-element is that has come through the tool from places (m, d), or None.

    Straight on, as seen from the tool, from outside to outside: out of the side that is opposite to
    where it went in, or deeper than it is large.
    """
    ends, sizes = contact._OnTool(contact.tool.placement), contact._Sizes()
    far = np.flatnonzero(np.linalg.norm(ends - begins, axis=1) > MOVED * sizes)
    if not len(far):
        return None
    sizes, begins, ways = sizes[far], begins[far], (ends - begins)[far]
    (before, inwards), (after, outwards) = map(contact.tool._Look, (begins, begins + ways))
    outside = (before > -TOUCHES * sizes) & (after > -sizes / 2)
    depth = np.zeros(len(far))
    depth[outside] = Depths(contact.tool, begins[outside], ways[outside], sizes[outside])
    opposite = np.sum(inwards * outwards, axis=1) < OPPOSITE
    through = far[outside & ((depth > sizes) | opposite & (depth > THIN * sizes))]
    return contact.Table()["x"][through[0]] if len(through) else None


def Depths(tool: Tool, begins: np.ndarray, ways: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """How deep ways (m, d) from places go into the tool, at most (m,).

    The distance tells how far nothing can be missed.
    """
    part, depth, lengths = (
        np.zeros(len(begins)),
        np.zeros(len(begins)),
        np.linalg.norm(ways, axis=1),
    )
    while np.any(goes := part < 1):
        distances, _ = tool._Look(begins[goes] + part[goes, None] * ways[goes])
        depth[goes] = np.maximum(depth[goes], -distances)
        part[goes] += np.maximum(np.abs(distances), THIN * sizes[goes]) / lengths[goes]
    return depth


def SightOf(contact: LACContact, motion: np.ndarray) -> float:
    """The part of a motion (n,) of the solution after which a contact still sees its master.

    Macro-elements may come as near as they are to it, and pass it by the depth of the search.
    """
    table, approach = contact.Table(), Approach(contact, motion)
    area = table["area"]
    coming = np.flatnonzero((area > 0) & (approach > 0))
    if not len(coming):
        return 1.0
    way = np.maximum(table["gap"][coming], 0) + contact.form.Depths()[coming]
    return min(1.0, np.min(way * area[coming] / approach[coming]))
