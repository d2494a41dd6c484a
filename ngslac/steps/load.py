# SPDX-License-Identifier: LGPL-2.1-or-later
"""Load stepping with control of the step size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from ngsolve import BaseVector, CoefficientFunction, GridFunction, Mesh, Parameter, Region

from ngslac.arguments import (
    CheckCount,
    CheckFlag,
    CheckFunction,
    CheckInstance,
    CheckNumber,
    CheckPrinting,
    CheckState,
)
from ngslac.bodies.messages import FarMessage, OverloadMessage
from ngslac.errors import ContactConvergenceError, FloatingBodyError, Reason, RefuseCopy, Warn
from ngslac.parallel.together import OnAll
from ngslac.progress import Say
from ngslac.solve.failure import CarriedOff
from ngslac.solve.iteration import Iteration, MostlySlips
from ngslac.solve.problem import MultiplierRows
from ngslac.solve.solver import ContactSolver, MeshOfSolver
from ngslac.steps.control import Journal, StepControl, StepLine
from ngslac.steps.limitload import LimitLoad
from ngslac.steps.prescribed import Prescribed
from ngslac.table import Columns

__all__ = ["LoadStepper", "Step"]

# Steps in which everything was tried, or nearly all slipped, until a load counts as one without
# equilibrium.
MOST_HOPELESS = 3
BISECTIONS = 14  # of the loads up to one that has no balance
STILL = 1e-12  # relative to the size of the mesh: solutions that are one
SAME = 1e-12  # relative difference of loads that are the same


@dataclass(frozen=True)
class Step:
    """A converged step.

    Attributes
    ----------
    number : int
    time : float
        Value of the load parameter.
    iterations : int
        Linear solves of this step (those of failed attempts not counted).
    cuts : int
        How often the step was halved before it converged.
    forces : tuple of tuples of float
        Resultant on the slave of each contact.
    """

    number: int
    time: float
    iterations: int
    cuts: int
    forces: tuple = ()

    def __str__(self) -> str:
        forces = "  ".join(f"({', '.join(f'{part:.5g}' for part in f)})" for f in self.forces)
        return f"{StepLine(self, 'load')}  force on the slave {forces}"


def MeshOf(stepper: LoadStepper, *_, **__) -> Mesh:
    """The mesh of a stepper."""
    return stepper.solver.gf.space.mesh


class LoadStepper:
    """Raise the load in steps; halve a step that fails, and grow again after success.

    A failed step leaves solution, load and history at the last converged step. If the smallest step
    fails, longer ones are tried that start without contact tractions: they find a state after a
    snap.

    Parameters
    ----------
    solver : ContactSolver
    load : ngsolve.Parameter
        Appears in the bulk form, in `rhs`, or in `prescribe`; its value is the time.
    prescribe : dict or callable, optional
        Dirichlet values that depend on the load: a displacement for each region,
        ``{"top": CF((0, -0.1 * load))}``, of which the components count that the space constrains
        there, and where two regions meet those of the later one; or ``prescribe(gf)``, which sets
        them. Dofs that are not constrained stay as they are.
    predict : bool
        Start each step from the linear extrapolation of the last two, unless the residual is far
        larger there than without.
    maxcuts : int
        How often a step may be halved: the smallest step is the equal one over 2**maxcuts.

    Raises
    ------
    TypeError, ValueError
        If `solver` is no ContactSolver, `load` no Parameter, or `prescribe` names a region that is
        not there or not constrained.

    Examples
    --------
    >>> load.Set(0)
    >>> steps = LoadStepper(solver, load).Integrate(steps=4, printing=False)
    >>> steps[-1].time
    1.0
    """

    __deepcopy__ = __reduce_ex__ = RefuseCopy

    @OnAll(MeshOfSolver)
    def __init__(
        self,
        solver: ContactSolver,
        load: Parameter,
        *,
        prescribe: dict[str | Region, CoefficientFunction]
        | Callable[[GridFunction], object]
        | None = None,
        predict: bool = True,
        maxcuts: int = 8,
    ):
        CheckInstance("solver", solver, ContactSolver, "a ContactSolver")
        CheckInstance("load", load, Parameter, "an ngsolve.Parameter, such as Parameter(0)")
        self.solver, self.load = solver, load
        self.prescribe = prescribe
        self.predict = CheckFlag("predict", predict)
        self.maxcuts = CheckCount("maxcuts", maxcuts, least=0)
        self.steps: list[Step] = []
        self.printing = True
        self._journal = Journal(self, "load", load)
        self._idle = True  # has no step changed anything?
        self._last = None  # increment of the solution and of the load in the last step
        self._size = np.inf  # of the next step, where the last ones had to be cut

    def __repr__(self) -> str:
        return f"<LoadStepper: load {self.load.Get():g} after {len(self.steps)} steps>"

    def __str__(self) -> str:
        return f"{self!r}\n{self.Table()}" if self.steps else repr(self)

    @property
    def prescribe(
        self,
    ) -> dict[str | Region, CoefficientFunction] | Callable[[GridFunction], object] | None:
        """Dirichlet values that depend on the load, see above."""
        return self._prescribed.values

    @prescribe.setter
    def prescribe(
        self,
        values: dict[str | Region, CoefficientFunction] | Callable[[GridFunction], object] | None,
    ) -> None:
        self._prescribed = Prescribed(self.solver, values)

    @OnAll(MeshOf)
    def Integrate(
        self,
        end: float = 1.0,
        *,
        steps: int = 10,
        callback: Callable[[Step], object] | None = None,
        printing: bool | str = True,
        maxit: int = 100,
        tol: float = 1e-10,
    ) -> list[Step]:
        """Go from the current load to `end` in `steps` equal steps.

        Parameters
        ----------
        end : float
            Last value of the load parameter.
        steps : int
            Number of equal steps; failing ones are divided.
        callback : callable, optional
            Called with each converged `Step` (of any size) after the commit.
        printing : bool or "steps"
            One line per attempt and iteration, or per step. False: a terminal shows one that
            changes, files and pipes nothing.
        maxit, tol :
            Handed to `ContactSolver.Solve`.

        Returns
        -------
        list[Step]

        Raises
        ------
        TypeError, ValueError
            If there is no step, the load is at `end` already, or an argument is no number.
        ContactConvergenceError
            When the smallest step fails; the message says what the contact looks like there. After
            any error, solution, load, history and fields are those of the last converged step.

        Examples
        --------
        A film of the steps is a `callback`: for the webgui a function of many components, which
        ``Draw(film, mesh, animate=True, deformation=True)`` plays, for ParaView files with a list
        of them, ``film.pvd``.

        >>> import tempfile
        >>> from ngsolve import GridFunction, VTKOutput
        >>> u = gf.components[0]
        >>> film, folder = GridFunction(u.space, multidim=0), tempfile.TemporaryDirectory()
        >>> vtk = VTKOutput(mesh, coefs=[u], names=["u"], filename=folder.name + "/film")
        >>> def Film(step):
        ...     film.AddMultiDimComponent(u.vec)
        ...     vtk.Do(time=step.time)
        >>> load.Set(0)
        >>> steps = LoadStepper(solver, load).Integrate(steps=4, callback=Film, printing=False)
        >>> len(film.vecs)
        4
        >>> folder.cleanup()
        """
        end, steps = CheckNumber("end", end), CheckCount("steps", steps)
        CheckFunction("callback", callback)
        self.printing = CheckPrinting(printing)
        begin = self._CheckBegin(end)
        self.solver.system.PairOnce()
        targets = [begin + (end - begin) * k / steps for k in range(1, steps + 1)]
        self._idle = True
        done = self._journal.Run(targets, lambda to: self._Reach(to, callback, maxit, tol))
        if self._idle:
            Warn(
                f"nothing changes while the load goes from {begin:g} to {end:g}: does a, rhs or "
                "prescribe hold this Parameter, on a region that exists? ds('name') of a name that "
                "no boundary has is no error in NGSolve"
            )
        return done

    def _CheckBegin(self, end: float) -> float:
        """The present load, from which there is a step to the end."""
        begin = CheckNumber("load.Get()", self.load.Get())
        CheckNumber("end - load.Get()", end - begin)
        if abs(end - begin) <= SAME * max(abs(end), abs(begin)):
            raise ValueError(
                f"end = {end:g} is the present value of the load, there is no step to it: set the "
                "load to its start before, load.Set(0), or give another end"
            )
        return begin

    def Table(self) -> dict[str, np.ndarray]:
        """The converged steps as numpy arrays, which print as a table.

        Returns
        -------
        dict
            ``step`` (n,), ``load`` (n,), ``iterations`` (n,), ``cuts`` (n,), and ``force``
            (n, contacts, d), the resultant on the slave of each contact.

        Examples
        --------
        >>> load.Set(0)
        >>> stepper = LoadStepper(solver, load)
        >>> steps = stepper.Integrate(steps=4, printing=False)
        >>> stepper.Table()["load"].tolist()
        [0.25, 0.5, 0.75, 1.0]
        """
        rows = [(step.number, step.time, step.iterations, step.cuts) for step in self.steps]
        rows = np.array(rows).reshape(-1, 4).T
        force = np.array([step.forces for step in self.steps])
        shape = len(self.steps), len(self.solver.contacts), self.solver.contacts[0].components
        return Columns(
            step=rows[0].astype(int),
            load=rows[1],
            iterations=rows[2].astype(int),
            cuts=rows[3].astype(int),
            force=force.reshape(shape),
        )

    def State(self) -> dict:
        """What the next step depends on: that of the solver, load, steps and their size.

        Returns
        -------
        dict
        """
        return {
            "solver": self.solver.State(),
            "load": self.load.Get(),
            "steps": list(self.steps),
            "last": self._last,
            "size": self._size,
        }

    @OnAll(MeshOf)
    def SetState(self, state: dict) -> None:
        """Go back to a state.

        Parameters
        ----------
        state : dict
            Of `State`.
        """
        CheckState(state, "load", "solver", "steps", "last", "size")
        self.load.Set(state["load"])
        self.solver.SetState(state["solver"])
        self.steps[:] = state["steps"]
        self._last, self._size = state["last"], state["size"]

    def _Reach(
        self, target: float, callback: Callable[[Step], object] | None, maxit: int, tol: float
    ) -> list[Step]:
        """The steps up to a target, shorter ones where a step fails."""
        done, hopeless, rubs = [], 0, 0
        control = StepControl(self.load.Get(), target, self.maxcuts, self._size)
        limit = LimitLoad(self.solver, self.load, control.full)
        while not control.done:
            goal = control.goal
            start = "last" if control.cuts else "predicted"
            path = not limit.suspected and (control.smallest or not (control.cuts or hopeless))
            try:
                last = self._Attempt(goal, maxit, tol, start, path)
            except ContactConvergenceError as error:
                control.cuts += 1
                hopeless += len(error.reason & (Reason.EXHAUSTED | Reason.SLIDES))
                rubs = rubs + 1 if Reason.SLIPS in error.reason else 0
                self._Estimate(limit, goal, failed=True)
                ends = error.reason & (Reason.CERTAIN | Reason.UNHELD)
                ends = ends or max(hopeless, rubs) > MOST_HOPELESS or limit.Passed()
                if not (control.smallest or ends):
                    if self.printing is True:
                        Say("  halved")
                    control.size = limit.Size(control.half)
                    continue
                tried = goal if Reason.CERTAIN in error.reason else None
                goal, last = self._Jump(target, error, limit, maxit, tol, tried)
            self._Continue(control)
            cuts, number = control.Reached(goal), len(self.steps) + 1
            step = Step(number, goal, last.number, cuts, self._Forces())
            done.append(self._journal.Add(step, callback, gf=self.solver.gf))
            rubs = 0
            if limit.expected is not None and not control.done:
                self._Estimate(limit, target, failed=False)
                control.size = limit.Size(control.size)
        return done

    def _Forces(self) -> tuple[tuple[float, ...], ...]:
        return tuple(tuple(contact.Force().tolist()) for contact in self.solver.contacts)

    def _Continue(self, control: StepControl) -> None:
        """Choose the next size after success: what was hard mostly is so for another while."""
        control.size = control.size if control.cuts else 2 * control.size
        shortened = control.cuts or abs(control.size) < 0.9 * abs(control.full)
        self._size = 2 * abs(control.size) if shortened else np.inf

    def _Estimate(self, limit: LimitLoad, goal: float, failed: bool) -> None:
        """Is there a limit of the load on the way from the last converged state to this one?"""
        try:
            limit.Estimate(goal, failed)
        finally:
            self._journal.saved.Restore()

    def _Jump(
        self,
        target: float,
        error: ContactConvergenceError,
        limit: LimitLoad,
        maxit: int,
        tol: float,
        tried: float | None,
    ) -> tuple[float, Iteration]:
        """Leave a state from which no small step converges: it may snap to another one.

        `tried`: a load that is known to have no equilibrium, of which no part was tried, or None.
        """
        begin = self.load.Get()
        useless = Reason.EXHAUSTED in error.reason and self.solver.system.islinear
        useless = useless or Reason.SLIPS in error.reason
        if not (useless or isinstance(error, FloatingBodyError)):
            near = [] if limit.known else [begin + 0.25 * (target - begin)]
            for goal in (*near, target):
                try:
                    return goal, self._Attempt(goal, 2 * maxit, tol, "free", False)
                except ContactConvergenceError:
                    continue
        known = type(error)(self._Diagnosis(error, limit, tried), error.history)
        known.reason = error.reason
        raise known from error

    def _Attempt(self, goal: float, maxit: int, tol: float, start: str, path: bool) -> Iteration:
        """One step from a start: "predicted", "last" or "free" of contact tractions."""
        solver, vec = self.solver, self.solver.gf.vec
        begin = self.load.Get()
        last = vec.CreateVector()
        last.data = vec
        before = self._Driven()
        self.load.Set(goal)
        if self.printing is True:
            note = {"predicted": "", "last": "", "free": ", from no contact"}
            Say(f"step {len(self.steps) + 1}  load {goal:g}{note[start]}")
        for contact in solver.contacts:
            contact.dt.Set(abs(goal - begin))
        try:
            flags = self._Start(last, goal - begin, start) | {"path": path}
            result = solver.Solve(maxit=maxit, tol=tol, printing=self.printing is True, **flags)
        except BaseException as error:
            self._journal.saved.Restore()
            if self.printing is True:
                Say(f"  {error}")
            raise
        Values = solver.system.layout.Values
        increment = Values(vec) - Values(last)
        moved = np.abs(increment).max()
        fields = zip(before, self._Driven(), strict=True)
        same = moved <= STILL * solver.system.residual.size and all(
            np.allclose(*pair) for pair in fields
        )
        self._idle = self._idle and same
        for contact in solver.contacts:
            contact.Commit(solver.gf)
        self._last = increment, goal - begin
        return result

    def _Driven(self) -> list[np.ndarray]:
        """The data of contacts that the load may change, besides the solution."""
        tables = [contact.Table() for contact in self.solver.contacts]
        return [np.nan_to_num(table[name]) for table in tables for name in ("gap", "friction")]

    def _Start(self, last: BaseVector, step: float, start: str) -> dict[str, np.ndarray]:
        """Put the start of a step into the solution; returns what Solve has to know of it."""
        solver, vec = self.solver, self.solver.gf.vec
        Values = solver.system.layout.Values
        values, now, fixed = Values(vec), Values(last), None
        if self._prescribed:
            self._prescribed.Set()
            fixed = self.solver.constrained
            wanted = np.where(fixed, values, now)
            values[:] = wanted
        softens = solver.system.stability.softened  # what tears next does not follow from the last
        if self._last is not None and self.predict and start == "predicted" and not softens:
            increment, size = self._last
            merit = self.solver.Merit()
            values[:] = now + (step / size) * self._Steady(now, increment)
            if fixed is not None:
                values[fixed] = wanted[fixed]
            # A larger residual is no harm as long as the status is a better guess.
            if merit is None or self.solver.Merit(same_load=True) < 10 * merit:
                return {}
        vec.data = last
        if start == "free":
            for contact in self.solver.contacts:
                values[contact.form.MultiplierDofs()] = 0
        return {} if fixed is None else {"motion": wanted - now}

    def _Steady(self, last: np.ndarray, increment: np.ndarray) -> np.ndarray:
        """The increment less that of what has just closed, beside what was closed before."""
        multipliers = MultiplierRows(self.solver.contacts)
        fresh = multipliers & (last == increment)
        return np.where(fresh, 0.0, increment) if np.any(last[multipliers & ~fresh]) else increment

    def _Balanced(self, least: float) -> float:
        """The largest load between the present one and one without balance that has a balance."""
        most = self.load.Get()
        try:
            for _ in range(BISECTIONS):
                self.load.Set(middle := (most + least) / 2)
                carried = CarriedOff(self.solver.system)
                most, least = (most, middle) if carried else (middle, least)
        finally:
            self._journal.saved.Restore()
        return most

    def _Diagnosis(
        self, error: ContactConvergenceError, limit: LimitLoad, tried: float | None
    ) -> str:
        """The message about a step that fails at any size, or for certain."""
        begin = f"{self.load.Get():g}"
        if tried is not None:
            balanced = f"; up to a load of {self._Balanced(tried):.3g} there is one"
            return f"the step from load {begin} to {tried:g} fails: {error}" + balanced
        if limit.known and not isinstance(error, FloatingBodyError):
            return f"no step beyond load {begin} converges: {limit}"
        small = "; take smaller steps"  # they were taken
        reason = str(error).replace(small + ".", ".").removesuffix(small)
        message = f"no step beyond load {begin} converges: {reason}"
        if isinstance(error, FloatingBodyError):
            return message
        contacts = self.solver.contacts
        status = np.concatenate([c.Table()["status"] for c in contacts])
        closed = int(np.sum(status > 0))
        if MostlySlips(error.history) or (closed and np.all(status[status > 0] == 2)):
            if self.solver.system.HasFriction():
                message += "; " + OverloadMessage(self.solver.system.bodies)
        elif closed == 0 and Reason.EXHAUSTED not in error.reason:
            message += "; all macro-elements are open"
        system = self.solver.system
        return message + (FarMessage() if system.finite and system.bodies.floating else "")
