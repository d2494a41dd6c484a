# SPDX-License-Identifier: LGPL-2.1-or-later
"""Repeat steps, to evaluate residuals and functionals near the converged states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from netgen.meshing import NgException
from ngsolve import CoefficientFunction, GridFunction, LinearForm, Region

from ngslac.analysis.learnt import Learnt
from ngslac.analysis.record import Record, Stage
from ngslac.contact.state import FormState
from ngslac.solve.solver import ContactSolver
from ngslac.steps.prescribed import Prescribed

if TYPE_CHECKING:
    from ngslac.analysis.sensitivity import Integrals, Number
    from ngslac.analysis.variables import Entries, Motion, Scalar

__all__ = ["Course", "Node", "Replay"]


@dataclass
class Course:
    """Start and steps of what was computed: of one solve, or of a Record.

    Attributes
    ----------
    states : list of dict
        Of the contacts where it began.
    scales : list of (m,) array
        Of the rows of the multipliers of the contacts.
    fresh : bool
        Did it begin without a history?
    load, begin : Parameter and float, or None
        What the steps set, and its value where it began.
    learnt : list of Learnt
        How the contacts follow the stiffness, once it was gone through.
    remembers : bool
        Does a step depend on those before it?
    """

    solver: ContactSolver
    stages: list
    states: list
    scales: list
    fresh: bool
    prescribed: Prescribed
    load: object = None
    begin: float = 0.0
    commit: object = None
    memory: list = field(default_factory=list)
    kept: list = field(default_factory=list)
    learnt: list = field(default_factory=list)

    @property
    def remembers(self) -> bool:
        """Does a step depend on those before it?"""
        rubs = self.solver.system.rubs or self.solver.system.own_law
        return len(self.stages) > 1 and (rubs or bool(self.memory))


def CourseOf(
    solver: ContactSolver | Record,
    prescribe: dict[str | Region, CoefficientFunction] | Callable[[GridFunction], object] | None,
) -> Course:
    """That of a solver, or of a Record."""
    contacts = solver.solver.contacts if isinstance(solver, Record) else solver.contacts
    scales = [contact.form.History()["c"] for contact in contacts]
    if isinstance(solver, Record):
        record, static = solver, solver.solver
        if prescribe is not None:
            raise ValueError("prescribe= is that of the stepper: leave it out with a Record")
        if not record.stages:
            raise ValueError(
                "the Record is empty: give it to stepper.Integrate as callback=, and integrate"
            )
        driven = record.stepper._prescribed
        start = record.states, scales, record.fresh, driven, record.stepper.load, record.begin
        return Course(static, [*record.stages], *start, record.commit, record.memory, record.kept)
    values = solver.gf.vec.FV().NumPy().copy()
    ended = [c for c in contacts if c._accepted is not None and c.holds_tangentially]
    if any(np.array_equal(c._accepted, values) for c in ended):
        raise ValueError(
            "the contacts have accepted this solution as the end of a step, and what slipped in "
            "it is no longer known: give Record(stepper) to Integrate as the callback, and that "
            "Record in place of the solver"
        )
    states = [contact.State() for contact in contacts]
    fresh = all(contact._accepted is None for contact in contacts)
    stage = Stage(None, contacts[0].dt.Get(), values)
    return Course(solver, [stage], states, scales, fresh, Prescribed(solver, prescribe))


@dataclass
class Node:
    """A problem at a variation: the histories of its contacts, and of its bulk."""

    direction: object
    way: float
    shadows: list
    kept: list


class Replay:
    """A context in which steps are evaluated again; at its end everything is as before."""

    def __init__(self, course: Course):
        self.course, self.solver = course, course.solver
        self.gf, self.system = self.solver.gf, self.solver.system
        self.direction = None

    def __enter__(self) -> Replay:
        """Note all that the steps change."""
        course, system, contacts = self.course, self.system, self.solver.contacts
        things = [system, system.residual, system.bulk, *contacts]
        self._kept = [(thing, vars(thing).copy()) for thing in things]
        arrays = [each.vec.FV().NumPy() for each in (self.gf, *course.memory)]
        self._values = [(array, array.copy()) for array in arrays]
        parameters = [contact.dt for contact in contacts]
        parameters += [course.load] if course.load is not None else []
        self._parameters = [(each, each.Get()) for each in parameters]
        self._rhs = system.bulk.rhs if isinstance(system.bulk.rhs, LinearForm) else None
        if self._rhs:
            self._loads = self._rhs.vec.FV().NumPy().copy()
            self._rhs.Assemble()
            # Users may have added something to the vector.
            self._added = self._loads - self._rhs.vec.FV().NumPy()
        return self

    def __exit__(self, *_) -> None:
        try:
            self._PutBack()
        except KeyboardInterrupt:
            self._PutBack()
            raise

    def _PutBack(self) -> None:
        """Bring back all that was noted."""
        if self.direction is not None:
            self.direction.Set(0)
        for parameter, value in self._parameters:
            parameter.Set(value)
        for array, values in self._values:
            array[:] = values
        if self._rhs:
            self._rhs.vec.FV().NumPy()[:] = self._loads
        self._Attributes()
        for contact in self.solver.contacts:
            contact._Fill()
        self._Attributes()  # of which Fill has changed some
        if self.course.load is not None:
            self.system.bulk.Forget()

    def _Attributes(self) -> None:
        for thing, attributes in self._kept:
            vars(thing).update(attributes)

    # --- going through the steps -----------------------------------------------------------------

    def Start(self, direction: Motion | Scalar | Entries | None = None, way: float = 0.0) -> Node:
        """The Node of a variation where the steps began."""
        if direction and direction.moves and not self.course.fresh:
            raise ValueError(
                "the contacts have a history of earlier steps, made in the present shape: make the "
                "Record before the first step"
            )
        self.direction = direction or self.direction
        course, moves = self.course, bool(direction and direction.moves)
        self._SetLoad(course.begin)
        self._Remember(course.kept)
        for k, learnt in enumerate(course.learnt):
            if learnt.Needs(moves):
                self.direction.Set(0)
                learnt.Measure(self._Shadow(k, moves), moves)
        if direction:
            direction.Set(way)
        shadows = [self._Shadow(k, moves) for k in range(len(course.states))]
        # The stiffness is learnt in the first step.
        self._SetLoad(course.stages[0].load)
        if not course.learnt:
            course.learnt = [self._Learnt(k, shadow) for k, shadow in enumerate(shadows)]
        for k, (shadow, learnt) in enumerate(zip(shadows, course.learnt, strict=True)):
            if learnt.follows and (direction or self._IsApart(k)):
                learnt.Learn(shadow, course.scales[k], moves)
        return Node(direction, way, shadows, [values.copy() for values in course.kept])

    def _SetLoad(self, load: float | None) -> None:
        if load is not None and self.course.load is not None:
            self.course.load.Set(load)

    def _Remember(self, kept: Sequence[np.ndarray]) -> None:
        for each, values in zip(self.course.memory, kept, strict=True):
            each.vec.FV().NumPy()[:] = values

    def _IsApart(self, k: int) -> bool:
        """Was a contact not paired yet?"""
        return self.course.states[k]["paired"] is None

    def _Shadow(self, k: int, moves: bool) -> FormState:
        """The FormState of a contact where the steps began, `moves`: paired anew."""
        state, old, apart = self.course.states[k], self.solver.contacts[k]._state, self._IsApart(k)
        shadow = FormState(old.setup, old.stiffness)
        if apart or moves:
            around = None if apart else shadow._Function(state["paired"])
            shadow.Pair(around, active=bool(state.get("active", True)))
            shadow.Scale(self.system.bulk.mat, self.system.bulk.elastic)
            # A factor of rows of the residual.
            shadow.form.SetHistory(shadow.form.History() | {"c": self.course.scales[k]})
        else:
            shadow.SetState(state, self._At(self.course.stages[0].values))
        return shadow

    def _Learnt(self, k: int, shadow: FormState) -> Learnt:
        """How a contact follows the stiffness: not where friction has a history of other steps."""
        contact = self.solver.contacts[k]
        learnt = Learnt(contact, self.system.bulk.elastic)
        if self.course.fresh or not contact.holds_tangentially:
            learnt.Compare(shadow, self._IsApart(k))
        return learnt

    def _At(self, values: np.ndarray) -> GridFunction:
        self.gf.vec.FV().NumPy()[:] = values
        return self.gf

    def Go(self, node: Node, stage: Stage, values: np.ndarray) -> None:
        """Make the problem that of a node in a step, with a solution (n,)."""
        if node.direction:
            node.direction.Set(node.way)
        course, contacts = self.course, self.solver.contacts
        for contact, shadow in zip(contacts, node.shadows, strict=True):
            contact._state = shadow
        self._Remember(node.kept)
        if self._rhs:  # which steps do not assemble
            for parameter, value in self._parameters:
                parameter.Set(value)
            self._rhs.Assemble()
            self._rhs.vec.FV().NumPy()[:] += self._added
        for contact in contacts:
            contact.dt.Set(stage.dt)
        if stage.load is not None:
            course.load.Set(stage.load)
        self._At(values)
        if course.prescribed:
            course.prescribed.Set()

    def Residual(self, node: Node, stage: Stage, way: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        """That (n,) of a node at a step, and the solution, which goes a way (n,) with the node."""
        self.Go(node, stage, stage.values + node.way * way)
        vec, forces = self.gf.vec, self.gf.vec.CreateVector()
        self.solver.a.Apply(vec, forces)
        for contact in self.solver.contacts:
            contact.form.Follow(vec)
            contact.form.AddApply(vec, forces)
        found = forces.FV().NumPy() - self.system.bulk.load
        return found, vec.FV().NumPy().copy()

    def Look(
        self, node: Node, stage: Stage, values: np.ndarray, functional: Integrals | Number
    ) -> np.ndarray:
        """The value of a functional at a node, for a solution (n,) of a step."""
        self.Go(node, stage, values)
        for contact in self.solver.contacts:
            contact.form.Follow(self.gf.vec)
            contact.Evaluate(self.gf)
        return functional.Value(self.gf)

    def Commit(self, node: Node, stage: Stage, values: np.ndarray) -> None:
        """Go on to the next step."""
        self.Go(node, stage, values)
        for shadow in node.shadows:
            shadow.Commit(self.gf)
        if self.course.commit:
            self.course.commit(stage.step)
        node.kept = [each.vec.FV().NumPy().copy() for each in self.course.memory]

    def MayBe(self, direction: Motion | Scalar | Entries | None, way: float) -> Node | None:
        """The Node of a variation where the steps began, or None where there is no problem."""
        try:
            node = self.Start(direction, way)
            residual, _ = self.Residual(node, self.course.stages[0])
        except NgException:
            return None
        return node if np.all(np.isfinite(residual)) else None
