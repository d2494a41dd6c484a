# SPDX-License-Identifier: LGPL-2.1-or-later
"""Derivatives of a converged contact problem by loads, materials, friction, obstacles, shape."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from netgen.meshing import NgException
from ngsolve import (
    BilinearForm,
    CoefficientFunction,
    FESpace,
    GridFunction,
    Parameter,
    Region,
    Variation,
)
from ngsolve.comp import SumOfIntegrals

from ngslac.analysis.fields import AtSurfaces, Groups, Reach
from ngslac.analysis.record import Record, Stage
from ngslac.analysis.replay import CourseOf, Node, Replay
from ngslac.analysis.tangent import CONVERGED, Factors, Static, Tangent
from ngslac.analysis.variables import DirectionsOf, Entries, Motion, Scalar
from ngslac.arguments import CheckInstance, IsFunction, Wrong
from ngslac.bodies.messages import FloatingMessage
from ngslac.errors import LinearSolveError, RefuseCopy, Warn
from ngslac.solve.residual import Norm
from ngslac.solve.solver import ContactSolver

if TYPE_CHECKING:
    from ngslac.analysis.shape import Shape
    from ngslac.contact.contact import LACContact

__all__ = ["Sensitivity"]

# Change of the residual, relative to the forces at work, from which differences are formed.
CHANGE = 1e-5
# Changes that are as good; and how often another step is tried.
GOOD, TRIALS = (1e-7, 1e-4), 8
# Factor for a step that is far too long; change that is too small to choose a step by.
FAR, NOTHING = 1e-3, 1e-12
# Relative distance to another status that is none: the derivative is that of one side.
VERGE = 1e-7
# Corrections of a solution where the tangent is that of Newton's method, and not quite exact.
REFINED = 2
# Relative difference of a functional's derivative to that of its integrand that is none.
SLOPE = 1e-3
# Weights of central differences, and of those to one side, at multiples of the step.
CENTRAL = {-1: -0.5, 1: 0.5}
FORWARD = {0: -1.5, 1: 2.0, 2: -0.5}
BACKWARD = {0: 1.5, -1: -2.0, -2: 0.5}


@dataclass
class Linearized:
    """The tangent at a step, with the residual (n,) there and the forces at work."""

    factors: Factors
    scale: np.ndarray
    residual: np.ndarray
    forces: float


class Integrals:
    """A functional that is a sum of integrals of trial functions; NGSolve knows its derivative."""

    def __init__(self, integrals: SumOfIntegrals, space: FESpace):
        self.form = BilinearForm(space)
        try:
            self.form += Variation(integrals)
        except (NgException, TypeError) as error:
            raise ValueError(
                "functional has integrals that have no derivative by the trial functions of the "
                f"product space ({error}): give a function that returns a number instead"
            ) from error

    def Value(self, gf: GridFunction) -> np.ndarray:
        """Of a solution."""
        return np.asarray(self.form.Energy(gf.vec))

    def Slope(self, gf: GridFunction) -> np.ndarray:
        """The derivative (n,) by the solution."""
        slope = gf.vec.CreateVector()
        self.form.Apply(gf.vec, slope)
        return slope.FV().NumPy().copy()


class Number:
    """A functional that is a function of the user's own: of contacts, solver and solution."""

    def __init__(self, function: Callable[[], float | np.ndarray]):
        self.function = function

    def Value(self, gf: GridFunction) -> np.ndarray:
        """Of the present state."""
        answer = self.function()
        try:
            value = np.asarray(answer, dtype=float)
        except (TypeError, ValueError) as error:
            raise Wrong(
                TypeError, "functional()", answer, "a number, or an array of them"
            ) from error
        if not np.all(np.isfinite(value)):
            raise ValueError("functional returns NaN or infinite values")
        return value


class Sensitivity:
    """Derivatives of a functional of a converged contact problem, and of its solution.

    For small changes the status of contact (open, stick or slip) stays: then the solution has a
    derivative, which solves the linearized problem, see `Tangent`. How residuals change with a
    variable follows from central differences at the solution, each of one evaluation, to some 1e-9.
    By the adjoint method all variables together need one linear solve; that is taken where the
    functional is a sum of integrals and no step depends on the one before. Else, as with friction
    through several steps, with large sliding in 3D, and for functions of your own, each variable
    needs one per step. Nothing of solver, contacts, mesh and variables is changed.

    Parameters
    ----------
    solver : ContactSolver or Record
        After `Solve`, or the steps of a `LoadStepper`. Of a solver slip counts from the history
        that its contacts had, which is taken as fixed.
    functional : sum of integrals, or callable
        Integrals of the trial functions of the product space, such as
        ``u[1] * ds("top") + lam[0] * ds("slave")``; or a function without arguments that returns a
        number or an array, and may look at ``gf``, fields, `Force`, `Table` of contacts and
        `Reaction` of the solver, such as ``lambda: contact.Force()[1]``.
    prescribe : dict or callable, optional
        Dirichlet values that depend on variables, as in `LoadStepper`; with a Record it is that of
        the stepper.

    Attributes
    ----------
    value : float or array
        Of the functional; with a Record an array with one row per step, as in all that follows.

    Raises
    ------
    TypeError, ValueError
        `solver` is none or has not converged at its solution with the present values of the
        Parameters, ``condense=True``, a distributed mesh, or a functional that returns NaN.

    Warns
    -----
    ContactWarning
        Macro-elements are just about to touch, open or slip: derivatives there are those of one
        side, that of the present status.

    Notes
    -----
    Variables are an ngsolve.Parameter, wherever it occurs; a GridFunction that is a coefficient,
    with a derivative for each of its entries; a `Shape`; or a thing of your own with ``Get()`` and
    ``Set(value)``, such as a constant of a law in NumPy.

    What a contact learns of the stiffness of both bodies follows, as in full solves by new contacts
    or after ``contact.Update()``: the contact direction where normals differ, and the scale of
    sharp ends and of a slave that is held along the surface. A contact that was kept from solves
    with other values keeps that as it is, and so does friction with a history of steps before those
    that are looked at: derivatives then are those of solves that keep it.

    Examples
    --------
    >>> from ngsolve import ds
    >>> from ngslac.analysis import Sensitivity
    >>> last = solver.Solve(printing=False)
    >>> s = Sensitivity(solver, lam[1] * ds("slave"))
    >>> force, slope = s.value, s.By(load)
    >>> load.Set(load.Get() * 1.001)
    >>> last = solver.Solve(printing=False)
    >>> bool(abs(contact.Force()[1] / (force + 0.001 * slope * load.Get() / 1.001) - 1) < 1e-5)
    True
    """

    __deepcopy__ = __reduce_ex__ = RefuseCopy

    def __init__(
        self,
        solver: ContactSolver | Record,
        functional: SumOfIntegrals | Callable[[], float | np.ndarray],
        *,
        prescribe: dict[str | Region, CoefficientFunction]
        | Callable[[GridFunction], object]
        | None = None,
    ):
        wanted = "a ContactSolver, or a Record of the steps of a LoadStepper"
        CheckInstance("solver", solver, (ContactSolver, Record), wanted)
        static = Static(solver)
        self._integrals = isinstance(functional, SumOfIntegrals)
        if self._integrals:
            self._functional = Integrals(functional, static.gf.space)
        elif IsFunction(functional):
            self._functional = Number(functional)
        else:
            wanted = "a sum of integrals such as u[1]*ds('top'), or a function without arguments"
            raise Wrong(TypeError, "functional", functional, wanted)
        static.system.CheckSpace()
        if static.system.scale is None:
            raise ValueError("solver has not solved anything: call solver.Solve() first")
        self.solver, self._path = static, isinstance(solver, Record)
        self._course = CourseOf(solver, prescribe)
        # There the tangent is not quite the derivative of the residual.
        self._rough = bool(static.system._meshed) and static.gf.space.mesh.dim == 3
        self._adjoint = self._integrals and not (self._rough or self._course.remembers)
        with Replay(self._course) as replay:
            self._Linearize(replay)

    def __repr__(self) -> str:
        way = "adjoint" if self._adjoint else "direct"
        return f"<Sensitivity: {way}, {len(self._course.stages)} steps, value {self.value}>"

    def By(self, variable: Parameter | GridFunction | Shape) -> float | np.ndarray:
        """The derivative of the functional by a variable.

        Parameters
        ----------
        variable : Parameter, GridFunction, Shape, or thing with Get and Set

        Returns
        -------
        float or array
            Of the shape of `value`, and for a GridFunction with an axis of its n entries behind.

        Raises
        ------
        TypeError, ValueError
            The variable is none, or the problem has changed since.
        """
        directions, probe = DirectionsOf(variable, self.solver, self._course.load)
        isfield = isinstance(variable, GridFunction)
        along = self._Adjoint if self._adjoint else self._Direct
        with Replay(self._course) as replay:
            differ = self._Step(replay, probe)
            found = self._Together(replay, variable, probe, *differ) if isfield else None
            if found is None:
                found = [along(replay, each, *differ)[0] for each in directions]
                found = np.stack(found, axis=-1) if isfield else found[0]
        found = found if self._path else found[0]
        return float(found) if found.ndim == 0 else found

    def Gradient(self, variables: Sequence[Parameter | GridFunction | Shape]) -> np.ndarray:
        """The derivatives by several variables, one behind the other in the last axis.

        Parameters
        ----------
        variables : list

        Returns
        -------
        array
            Of a number the gradient (k,); of m numbers the Jacobian (m, k).

        Raises
        ------
        TypeError, ValueError
            `variables` is no list, or as of `By`.
        """
        count = np.ndim(self.value)
        CheckInstance("variables", variables, (list, tuple), "a list of variables, such as [mu]")
        parts = [np.asarray(self.By(variable)) for variable in variables]
        parts = [part[..., None] if part.ndim == count else part for part in parts]
        return np.concatenate(parts, axis=-1) if parts else np.zeros((*np.shape(self.value), 0))

    def Solution(self, variable: Parameter | Shape) -> GridFunction:
        """The derivative of the solution by a Parameter or a Shape, with that of what is driven.

        Parameters
        ----------
        variable : Parameter, Shape, or thing with Get and Set

        Returns
        -------
        GridFunction
            On the product space; with a Record that of the last step. Of a Shape: at points that
            move along with the mesh.

        Raises
        ------
        TypeError, ValueError
            As of `By`, and for a GridFunction, which has one for each of its entries.
        """
        directions, probe = DirectionsOf(variable, self.solver, self._course.load)
        if isinstance(variable, GridFunction):
            raise ValueError("variable is a GridFunction: take a Parameter for one of its entries")
        with Replay(self._course) as replay:
            _, ways = self._Direct(replay, directions[0], *self._Step(replay, probe))
        found = GridFunction(self.solver.gf.space, name="derivative")
        found.vec.FV().NumPy()[:] = ways[-1]
        return found

    # --- the converged states --------------------------------------------------------------------

    def _Linearize(self, replay: Replay) -> None:
        """Tangents, values and, for the adjoint method, the dual solutions at all steps."""
        node, values, near = replay.Start(), [], 0
        self._tangents, self._duals = [], []
        for number, stage in enumerate(self._course.stages):
            self._tangents.append(self._TangentAt(replay, node, stage))
            near += sum(AtVerge(contact) for contact in self.solver.contacts)
            values.append(replay.Look(node, stage, stage.values, self._functional))
            if self._adjoint:
                slope = self._functional.Slope(self.solver.gf)
                self._CheckSlope(replay, node, stage, slope)
                known = self._tangents[-1]
                self._duals.append(self._Solve(known, slope, transposed=True))
            if number + 1 < len(self._course.stages):
                replay.Commit(node, stage, stage.values)
        value = np.stack(values) if self._path else values[0]
        self.value = float(value) if value.ndim == 0 else value
        if near:
            Warn(
                f"{near} macro-elements are at the verge of another contact status: derivatives "
                "are those of one side, for the present status"
            )

    def _CheckSlope(self, replay: Replay, node: Node, stage: Stage, slope: np.ndarray) -> None:
        """Raise where integrals hold the solution itself beside trial functions."""
        sides = [
            replay.Look(node, stage, (1 + step) * stage.values, self._functional)
            for step in (CHANGE, -CHANGE)
        ]
        change, known = (sides[0] - sides[1]) / (2 * CHANGE), slope @ stage.values
        size = max(abs(change), abs(known))
        # Parts that cancel out in balance leave rounding errors.
        parts = abs(sides[0]) + np.sum(np.abs(slope * stage.values))
        if abs(change - known) > SLOPE * size + CHANGE * parts:
            raise ValueError(
                "functional changes with the solution by more than by its trial functions: write "
                "u, lam, ... = fes.TrialFunction() in place of gf and of fields of the contact, or "
                "give a function that returns Integrate(...)"
            )

    def _TangentAt(self, replay: Replay, node: Node, stage: Stage) -> Linearized:
        """The tangent at a step, which has to be in equilibrium."""
        system = self.solver.system
        residual, _ = replay.Residual(node, stage)
        if stage.load is not None:  # on which the matrix may depend
            system.bulk.StartAfresh()
        if not system.bulk.a.condense:
            state = system.MeasureExactly()
            worst = max(state.equilibrium, state.constraint)
            if not worst <= CONVERGED:
                raise ValueError(
                    f"solver is not in equilibrium at its solution (relative residual {worst:.1e}):"
                    " solve again after a change of Parameters, and record all steps"
                )
        for contact in self.solver.contacts:  # which way it slipped in the step before is past
            contact.form.BeginSolve()
        tangent = Tangent(self.solver, keeping=False)
        forces = max(system.residual.forces, system.residual.converged)
        return Linearized(tangent.Factors(), tangent.scale, residual, forces)

    def _Solve(self, known: Linearized, forces: np.ndarray, transposed: bool = False) -> np.ndarray:
        """With the tangent of a step; an error that names what floats, if that is why it fails."""
        try:
            return known.factors.Solve(forces, transposed=transposed)
        except LinearSolveError as error:
            floating = self.solver.system.WhatFloats()
            if not floating:
                raise
            raise LinearSolveError(f"{error}: {FloatingMessage(floating)}") from error

    # --- differences -----------------------------------------------------------------------------

    def _Step(
        self, replay: Replay, direction: Motion | Scalar | Entries
    ) -> tuple[float, dict[int, float]]:
        """The step of differences in a direction, and their weights."""
        known = self._tangents
        base = self._Residuals(replay, replay.Start(direction, 0.0))
        away = Norm(known[0].scale * (base[0] - known[0].residual))
        if away > CONVERGED * known[0].forces:
            raise ValueError("the problem has changed since: make a new Sensitivity")

        def Change(step: float) -> float:
            """The largest relative change of residuals by a step; infinite where there are none."""
            sides = (side * step for side in (1, -1))
            node = next((n for way in sides if (n := replay.MayBe(direction, way))), None)
            if node is None:
                return np.inf
            each = zip(self._Residuals(replay, node), base, known, strict=True)
            return max(Relative(Norm(k.scale * (new - old)), k.forces) for new, old, k in each)

        step = self._Suitable(Change, CHANGE * (direction.size or 1.0), direction.most)
        if step is None:
            step = CHANGE * (direction.size or 1.0)
            self._WarnIfVoid(replay, direction, step)
        sides = [replay.MayBe(direction, side * step) for side in (-1, 1)]
        if not any(sides):
            raise ValueError("there is no problem beside the present one on either side")
        return step, CENTRAL if all(sides) else FORWARD if sides[1] else BACKWARD

    def _Residuals(self, replay: Replay, node: Node) -> list[np.ndarray]:
        """Those of a node at the solutions of all steps."""
        found = []
        for stage in self._course.stages:
            found.append(replay.Residual(node, stage)[0])
            if self._course.remembers and stage is not self._course.stages[-1]:
                replay.Commit(node, stage, stage.values)
        return found

    def _Suitable(self, change: Callable[[float], float], step: float, most: float) -> float | None:
        """A step up to `most` by which residuals change just enough, or None."""
        for _ in range(TRIALS):
            size = change(step)
            if GOOD[0] <= size <= GOOD[1]:
                return step
            if not size <= 1:  # or infinite
                step *= FAR
            else:
                longer = step * (CHANGE / size if size > NOTHING else 1 / FAR)
                if longer > most:
                    return None
                step = longer
        return None

    def _WarnIfVoid(
        self, replay: Replay, direction: Motion | Scalar | Entries, step: float
    ) -> None:
        """Warn that a variable changes neither the problem nor the functional."""
        stage, values = self._course.stages[-1], []
        for way in (0.0, step):
            node = replay.Start(direction, way)
            values.append(replay.Look(node, stage, stage.values, self._functional))
        if np.all(values[0] == values[1]):
            Warn("the variable hardly changes the problem: does a form or a contact depend on it?")

    def _Forces(
        self,
        replay: Replay,
        nodes: Sequence[tuple[Node, float]],
        stage: Stage,
        step: float,
        way: np.ndarray | float = 0.0,
    ) -> tuple[np.ndarray, np.ndarray]:
        """The derivatives (n,) of the residual, and of what is driven of the solution."""
        found = [replay.Residual(node, stage, way) for node, _ in nodes]
        weights = [weight / step for _, weight in nodes]
        sums = [
            sum(w * part for w, part in zip(weights, parts, strict=True))
            for parts in zip(*found, strict=True)
        ]
        driven = np.where(self.solver.system.residual.free, 0.0, sums[1])
        return sums[0], driven

    def _Nodes(
        self,
        replay: Replay,
        direction: Motion | Scalar | Entries,
        step: float,
        weights: dict[int, float],
    ) -> list[tuple[Node, float]]:
        return [(replay.Start(direction, k * step), weight) for k, weight in weights.items()]

    def _Adjoint(
        self,
        replay: Replay,
        direction: Motion | Scalar | Entries,
        step: float,
        weights: dict[int, float],
    ) -> tuple[np.ndarray, list[np.ndarray]]:
        """The derivatives of the values at all steps, by the dual solutions."""
        nodes, found = self._Nodes(replay, direction, step, weights), []
        for stage, dual in zip(self._course.stages, self._duals, strict=True):
            forces, _ = self._Forces(replay, nodes, stage, step)
            looks = [w * replay.Look(n, stage, stage.values, self._functional) for n, w in nodes]
            found.append(sum(looks) / step - dual @ forces)
        return np.stack(found), []

    def _Together(
        self,
        replay: Replay,
        field: GridFunction,
        probe: Entries,
        step: float,
        weights: dict[int, float],
    ) -> np.ndarray | None:
        """The derivatives by all entries of a field, or None where they need one by one."""
        course, space = self._course, self.solver.gf.space
        reach = Reach(field, space) if self._adjoint and not course.prescribed else None
        if reach is None:
            return None
        nodes = self._Nodes(replay, probe, step, weights)
        for stage in course.stages:
            looks = [replay.Look(n, stage, stage.values, self._functional) for n, _ in nodes]
            if np.ptp(looks) > 0:  # the functional holds the field
                return None
        expected, _ = self._Adjoint(replay, probe, step, weights)
        found = np.zeros((len(self._duals), reach.shape[1]))
        for group in Groups(probe, reach):
            nodes = self._Nodes(replay, group, step, weights)
            for row, stage, dual in zip(found, course.stages, self._duals, strict=True):
                forces, _ = self._Forces(replay, nodes, stage, step)
                row[group.chosen] = -(reach.T @ (dual * forces))[group.chosen]

        def Fits() -> bool:  # else an entry changes other rows than those of its elements
            errors = np.abs(found @ probe.factors - expected)
            return np.all(errors <= CONVERGED * np.abs(found).sum(axis=1))

        if not Fits():  # by the stiffness at the surfaces all contact changes
            for number in np.flatnonzero(AtSurfaces(reach, self.solver.contacts)):
                entry = Entries(probe.values, probe.start, number)
                found[:, number] = self._Adjoint(replay, entry, step, weights)[0]
        return found if Fits() else None

    def _Direct(
        self,
        replay: Replay,
        direction: Motion | Scalar | Entries,
        step: float,
        weights: dict[int, float],
    ) -> tuple[np.ndarray, list[np.ndarray]]:
        """The derivatives of the values at all steps, and of their solutions."""
        nodes, found, ways = self._Nodes(replay, direction, step, weights), [], []
        for stage, known in zip(self._course.stages, self._tangents, strict=True):
            forces, driven = self._Forces(replay, nodes, stage, step)
            way = driven - self._Solve(known, forces)
            for _ in range(REFINED if self._rough else 0):
                forces, _ = self._Forces(replay, nodes, stage, step, way)
                way = way - self._Solve(known, forces)
            sums = 0.0
            for node, weight in nodes:
                values = stage.values + node.way * way
                sums = sums + weight * replay.Look(node, stage, values, self._functional)
                if stage is not self._course.stages[-1]:
                    replay.Commit(node, stage, values)
            found.append(np.asarray(sums / step))
            ways.append(way)
        return np.stack(found), ways


def Relative(change: float, forces: float) -> float:
    """A change in relation to the forces at work; where there are none, any is as good."""
    return change / forces if forces else CHANGE * bool(change)


def AtVerge(contact: LACContact) -> int:
    """How many macro-elements are within rounding errors of another status."""
    if contact.tied or contact.own_law or contact.components == 1:
        return 0
    table, known = contact.Table(), contact.form.Table()
    paired = table["area"] > 0
    pressure, gap = table["pressure"], np.where(paired, np.nan_to_num(table["gap"]), 1.0)
    most = np.max(np.abs(pressure), initial=0)
    if not most:
        return 0
    trial = pressure - known["c"] * gap
    near = paired & (np.abs(trial) <= VERGE * most) & (not contact.bilateral)
    bound = np.where(table["friction"] >= 0, table["friction"] * np.abs(pressure), np.inf)
    bound = np.where(known["tresca"] >= 0, np.minimum(bound, known["tresca"]), bound)
    across = table["traction"] + pressure[:, None] * table["normal"]
    across = np.linalg.norm(across - known["c"][:, None] * table["slip"], axis=1)
    rubs = paired & (table["status"] > 0) & np.isfinite(bound) & (bound > 0)
    return int(np.sum(near | (rubs & (np.abs(across - bound) <= VERGE * bound))))
