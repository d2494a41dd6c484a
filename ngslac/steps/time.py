# SPDX-License-Identifier: LGPL-2.1-or-later
"""Implicit dynamics with contact."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from ngsolve import CoefficientFunction, GridFunction, Integrate, Mesh, Parameter, Region

from ngslac.arguments import (
    LARGEST_COUNT,
    CheckCount,
    CheckFunction,
    CheckInstance,
    CheckNumber,
    CheckPositive,
    CheckPrinting,
    CheckState,
    FillVector,
)
from ngslac.bodies.bodies import NoBodies
from ngslac.errors import ContactConvergenceError, RefuseCopy
from ngslac.parallel.together import OnAll
from ngslac.progress import Say
from ngslac.solve.bulk import Bulk
from ngslac.solve.solver import ContactSolver, Equilibrium, MeshOfSolver
from ngslac.solve.system import System
from ngslac.steps.balance import EnergyBalance, TimeStep
from ngslac.steps.control import Journal, StepControl
from ngslac.steps.directions import Directions
from ngslac.steps.inertia import CheckEnergy, DynamicForm, Mass, Scheme
from ngslac.steps.prescribed import Prescribed
from ngslac.steps.stepend import StepEnd

__all__ = ["TimeStepper"]

# Part of the energy that a step may bring in before a shorter one is tried, although it goes out of
# the velocities again: the time integration of large deformation may, and large sliding. What of it
# may stay, where velocities have no more of it to give.
MOST_WON, MOST_OWED = 0.02, 1e-3
# Work that new directions of pressures change, relative to the kinetic energy, for which the step
# is solved again; and how often it is solved.
CHANGED, MOST_SOLVES = 1e-4, 3


def CheckLaws(solver: ContactSolver) -> None:
    """Raise for laws of the user's own, of which impacts do not know, and for scalar fields."""
    if solver.contacts[0].components == 1:
        raise ValueError(
            "solver is that of a scalar field, which has no inertia: integrate a temperature by a "
            "term such as (T - old) / dt * S * dx in the bulk form, and ContactSolver"
        )
    if solver.system.own_law:
        raise ValueError(
            "solver has a contact with law=, which TimeStepper does not know: it stops the "
            "velocities across each closed contact, and the energy that such a law stores would be "
            "lost; use LoadStepper, or in place of the law a spring in the bulk form"
        )


def MeshOf(stepper: TimeStepper, *_, **__) -> Mesh:
    """The mesh of a stepper."""
    return stepper.static.gf.space.mesh


class TimeStepper:
    """Integrate the motion of bodies in contact; halve a step that fails, and grow again.

    The bulk is integrated by the generalised-alpha method, which is the trapezoidal rule for
    ``rho_inf=1``: of second order for smooth motion. Contact holds at the end of each step, and one
    contact traction acts all through the step (Kane, Repetto, Ortiz and Marsden 1999), so that
    contact and friction can only take energy away; it is the mean over the step. Then the
    velocities are freed from what contact forbids, by the closest admissible ones in the sense of
    the kinetic energy: without that the velocities of touching surfaces, and with them the
    pressures, would swing from step to step. The surface layer that meets an obstacle loses its
    kinetic energy, a fraction of the order of element size over body size.

    With ``finite=True`` pressures act across the way that surfaces slide in the step, and do no
    work along it. What contact brings in all the same, and what the time integration of a nonlinear
    bulk has brought in altogether, goes out of the velocities again, such that the momenta stay: no
    energy is won, with any `rho_inf`. Linear momentum is conserved, and angular momentum of a
    nonlinear bulk, too, both to rounding.

    A step that brings in more than 2 % of the energy before that is halved if it can be. A failed
    step leaves solution, velocity, time and history at the last converged step.

    Parameters
    ----------
    solver : ContactSolver
        Of the static problem: bulk, solution, contacts and loads are taken from there. Its bulk may
        be nonlinear and may condense, and it may contain loads, but no inertia.
    density : float or CoefficientFunction
        Mass per reference volume (2D: per area and unit thickness), > 0.
    dt : float
        Largest step. Waves are resolved by steps of about the time they need through an element.
    rho_inf : float
        0 to 1: factor by which one step multiplies oscillations much faster than `dt`.
    time : ngsolve.Parameter, optional
        Appears in the bulk form, in `rhs`, or in `prescribe`; its value is the time.
    prescribe : dict or callable, optional
        Dirichlet values that depend on the time, as in `LoadStepper`.
    energy : CoefficientFunction, optional
        Strain energy per reference volume of the current `gf`, for `EnergyBalance.internal`.
        Default: the work of the internal forces, exact for a linear bulk and of the sixth order
        in the step for others.
    maxcuts : int
        How often a step may be halved.

    Attributes
    ----------
    velocity : GridFunction
        On the product space; set its displacement component before the first step.
    balance : EnergyBalance
    steps : list[TimeStep]

    Raises
    ------
    TypeError, ValueError
        A step or density that is not positive, `rho_inf` out of range, another kind of object, or a
        contact with a law of your own.

    Notes
    -----
    Loads are read off the bulk form as its residual at zero displacement: loads that follow the
    deformation count as internal.

    Examples
    --------
    >>> stepper = TimeStepper(solver, 1.0, dt=0.01)
    >>> stepper.velocity.components[0].Set((0, -1))
    >>> last = stepper.Integrate(0.02, printing=False)[-1]
    >>> abs(last.balance.algorithmic) < 1e-12
    True
    """

    __deepcopy__ = __reduce_ex__ = RefuseCopy

    @OnAll(MeshOfSolver)
    def __init__(
        self,
        solver: ContactSolver,
        density: CoefficientFunction | float,
        *,
        dt: float,
        rho_inf: float = 1.0,
        time: Parameter | None = None,
        prescribe: dict[str | Region, CoefficientFunction]
        | Callable[[GridFunction], object]
        | None = None,
        energy: CoefficientFunction | float | None = None,
        maxcuts: int = 8,
    ):
        CheckInstance("solver", solver, ContactSolver, "a ContactSolver, of the static problem")
        solver.system.CheckSpace()
        CheckLaws(solver)
        self.dt, self.scheme = CheckPositive("dt", dt), Scheme(rho_inf)
        self.maxcuts = CheckCount("maxcuts", maxcuts, least=0)
        self.time = Parameter(0.0) if time is None else time
        CheckInstance("time", self.time, Parameter, "an ngsolve.Parameter, such as Parameter(0)")
        self.energy = CheckEnergy(energy)
        free = solver.system.residual.free
        self.mass = Mass(solver.a, solver.contacts[0], density, free)
        self.form = DynamicForm(solver.a, self.mass, self.scheme)
        self.static = solver
        self.prescribe = prescribe
        self.velocity = GridFunction(solver.gf.space, name="velocity")
        self._end = StepEnd(solver, self.form, self.mass, self.scheme, self.velocity)
        bulk = Bulk(self.form, solver.gf, self._end.Load)
        system = System(bulk, solver.contacts, solver.linear, free, NoBodies())
        system.scheme = solver.system.scheme
        self.solver = Equilibrium(system, solver.constrained, solver.initial)
        self._journal = Journal(self, "time", self.time)
        self.balance: EnergyBalance | None = None
        self.steps: list[TimeStep] = []
        self.printing = True
        self._directions = Directions(solver.contacts)

    def __repr__(self) -> str:
        steps = f"{len(self.steps)} steps, dt = {self.dt:g}"
        return f"<TimeStepper: time {self.time.Get():g} after {steps}>"

    @property
    def gf(self) -> GridFunction:
        """The solution."""
        return self.solver.gf

    @property
    def prescribe(
        self,
    ) -> dict[str | Region, CoefficientFunction] | Callable[[GridFunction], object] | None:
        """Dirichlet values that depend on the time, see above."""
        return self._prescribed.values

    @prescribe.setter
    def prescribe(
        self,
        values: dict[str | Region, CoefficientFunction] | Callable[[GridFunction], object] | None,
    ) -> None:
        self._prescribed = Prescribed(self.static, values)

    # --- steps ---------------------------------------------------------------------------------

    @OnAll(MeshOf)
    def Integrate(
        self,
        end: float,
        *,
        callback: Callable[[TimeStep], object] | None = None,
        printing: bool | str = True,
        maxit: int = 100,
        tol: float = 1e-10,
    ) -> list[TimeStep]:
        """Go on to the time `end`, in equal steps of at most `dt`.

        Parameters
        ----------
        end : float
        callback : callable, optional
            Called with each converged `TimeStep` after the commit.
        printing : bool or "steps"
            One line per step and iteration, and the energies; or one line per step. False: a
            terminal shows one that changes, files and pipes nothing.
        maxit, tol :
            Handed to `ContactSolver.Solve`.

        Returns
        -------
        list[TimeStep]

        Raises
        ------
        TypeError, ValueError
            If `end` is not after the present time, an argument is no number, the state holds NaN,
            or the density has changed.
        ContactConvergenceError
            When the smallest step fails. After any error, solution, velocity, time and history are
            those of the last converged step.
        """
        begin, end = CheckNumber("time.Get()", self.time.Get()), CheckNumber("end", end)
        if not end > begin:
            raise ValueError(f"end = {end} is not after the time {begin}")
        if end - begin < 1e-12 * self.dt:
            raise ValueError(
                f"end = {end} is nearer to the time {begin} than any step of dt = {self.dt} is long"
            )
        CheckFunction("callback", callback)
        self.printing = CheckPrinting(printing)
        count = max(1, np.ceil((end - begin) / self.dt - 1e-9))
        if count > LARGEST_COUNT:
            raise ValueError(f"end = {end} is {count:g} steps of dt = {self.dt} away: take fewer")
        targets = [begin + (end - begin) * k / count for k in range(1, int(count))] + [end]
        reach = lambda to: self._Reach(to, callback, maxit, tol)  # noqa: E731
        return self._journal.Run(targets, reach, self._Begin)

    def State(self) -> dict:
        """What the next step depends on: that of the solver, velocity, time, energies and steps.

        Returns
        -------
        dict
        """
        return {
            "solver": self.solver.State(),
            "time": self.time.Get(),
            "velocity": self._Values(self.velocity).copy(),
            "steps": list(self.steps),
            "balance": self.balance,
            "directions": self._directions.State(),
            "dt": self.form.dt,
        } | self._end.State()

    @OnAll(MeshOf)
    def SetState(self, state: dict) -> None:
        """Go back to a state.

        Parameters
        ----------
        state : dict
            Of `State`.
        """
        names = ("time", "solver", "velocity", "steps", "balance", "momentum", "obstacles")
        CheckState(state, *names, "account", "directions")
        self.time.Set(state["time"])
        self.solver.SetState(state["solver"])
        FillVector("velocity", self.velocity.vec, state["velocity"])
        self.steps[:] = state["steps"]
        self.balance = state["balance"]
        self._end.SetState(state)
        self._directions.SetState(state["directions"])
        self._Turn()
        if state["dt"]:
            self.form.SetStep(state["dt"])
        self.solver.system.bulk.StartAfresh()

    def _Begin(self) -> None:
        """Forces and energies of the present state, which the user may have changed."""
        self.solver.system.CheckSpace()
        for name, field in {"gf": self.gf, "velocity": self.velocity}.items():
            if not np.all(np.isfinite(self._Values(field))):
                raise ValueError(f"{name} holds NaN or infinite values")
        energy = self._Energy() or 0.0
        if not np.isfinite(energy):
            raise ValueError("energy is NaN or infinite where the motion begins")
        for contact in self.solver.contacts:
            if not contact.form.paired:
                contact.Update(self.gf if contact.finite else None)
        self._end.Begin(self.dt, bool(self._prescribed))
        kinetic = self._end.Kinetic()
        if self.balance is None:
            self.balance = EnergyBalance(self.time.Get(), kinetic, energy)
            return
        external = self.balance.external + kinetic - self.balance.kinetic
        self.balance = replace(self.balance, kinetic=kinetic, external=external)

    def _Reach(
        self, target: float, callback: Callable[[TimeStep], object] | None, maxit: int, tol: float
    ) -> list[TimeStep]:
        """The steps up to a target, shorter ones where a step fails."""
        printing = self.printing is True
        done, control = [], StepControl(self.time.Get(), target, self.maxcuts)
        while not control.done:
            goal = control.goal
            if printing:
                Say(f"step {len(self.steps) + 1}  time {goal:g}")
            try:
                count = self._Attempt(goal, printing, maxit, tol, control.smallest)
            except ContactConvergenceError as error:
                if control.smallest:
                    raise
                if printing:
                    Say(f"  {error}; halved")
                control.cuts += 1
                control.size = control.half
                continue
            if printing:
                Say(self.balance)
            cuts = control.Reached(goal)
            step = TimeStep(len(self.steps) + 1, goal, count, cuts, self.balance)
            done.append(self._journal.Add(step, callback, gf=self.gf, velocity=self.velocity))
            control.size *= 2
        return done

    def _Attempt(
        self, goal: float, printing: bool, maxit: int, tol: float, last_chance: bool
    ) -> int:
        """The linear solves of one step up to a goal; after an error all is as before."""
        now = self.time.Get()
        start = self._Values(self.gf).copy()
        if self.form.SetStep(goal - now):
            self.solver.system.bulk.StartAfresh()
        dt, self.form.renewed = self.form.dt, False
        for contact in self.solver.contacts:
            contact.dt.Set(dt)
            contact.form.SetFlowShare(self.form.share)
        inertial = start + dt * self._end.Velocity()
        self._Values(self.form.start)[:] = inertial
        try:
            self._end.obstacles.Begin(self.gf)
            self._directions.Begin(self.gf)
            self.time.Set(goal)
            self._end.obstacles.Move(self.gf)
            self.mass.CheckConstant()
            if self._prescribed:
                self._prescribed.Set()
            self._Values(self.gf)[self.mass.free] = inertial[self.mass.free]
            count = self._Solve(start, maxit=maxit, tol=tol, printing=printing)
            energy = self._Energy()
            if not (energy is None or np.isfinite(energy)):
                raise ContactConvergenceError("elements turned inside out")
        except BaseException:
            self._journal.saved.Restore()
            raise
        finally:  # the contacts may be those of other solvers, too
            for contact in self.solver.contacts:
                contact.form.SetFlowShare(1)
        known = {"system": self.solver.system, "energy": energy}
        self.balance, won, owed = self._end.Accept(start, dt, self.balance, goal, **known)
        if not last_chance and (won > MOST_WON or owed > MOST_OWED):
            self._journal.saved.Restore()
            raise ContactConvergenceError(f"the step wins {100 * won:.2g} % of the energy")
        return count

    def _Solve(self, start: np.ndarray, **options) -> int:
        """Solve, with directions of pressures that suit the motion; returns the linear solves."""
        directions, count = self._directions, 0
        for _ in range(MOST_SOLVES):
            directions.Next()
            self._Turn()
            count += self.solver.Solve(path=False, **options).number
            changed = directions.Learn(self.gf, self._MotionFrom(start))
            if changed <= CHANGED * self.balance.kinetic:
                break
        return count

    def _Turn(self) -> None:
        """The pressures get the directions of the step."""
        self.solver.system.lean = self._directions.used
        self.solver.system.Lean()

    def _MotionFrom(self, start: np.ndarray) -> np.ndarray:
        return (self._Values(self.gf) - start) * self.mass.rows

    def _Values(self, gf: GridFunction) -> np.ndarray:
        return self.static.system.layout.Values(gf.vec)

    def _Energy(self) -> float | None:
        """The strain energy (None: unknown)."""
        if self.energy is None:
            return None
        return float(Integrate(self.energy, self.gf.space.mesh))

    def Table(self) -> dict[str, np.ndarray]:
        """The energy balance after each step as numpy arrays, see `EnergyBalance.Table`."""
        return EnergyBalance.Table(step.balance for step in self.steps)
