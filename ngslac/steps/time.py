"""Implicit dynamics with contact."""

from dataclasses import replace

import numpy as np
from ngsolve import GridFunction, Integrate, Parameter

from ngslac.arguments import (
    LARGEST_COUNT,
    CheckCount,
    CheckFlag,
    CheckFunction,
    CheckInstance,
    CheckNumber,
    CheckPositive,
    CheckState,
    FillVector,
)
from ngslac.errors import ContactConvergenceError, RefuseCopy
from ngslac.solve.bulk import Bulk
from ngslac.solve.solver import ContactSolver, OnBulk
from ngslac.steps.balance import ContactWorks, EnergyBalance, TimeStep
from ngslac.steps.control import Journal, StepControl
from ngslac.steps.inertia import CheckEnergy, DynamicForm, Inert, Mass, Scheme
from ngslac.steps.obstacles import Obstacles
from ngslac.steps.prescribed import Prescribed

__all__ = ["TimeStepper"]

# Part of the energy that a step may bring in before a shorter one is tried: the time integration of
# large deformation may, and the direction of contact in large sliding.
MOST_WON = 0.02


class TimeStepper:
    """Integrate the motion of bodies in contact; halve a step that fails, and grow again.

    The bulk is integrated by the generalised-alpha method, which is the trapezoidal rule for
    ``rho_inf=1``: of second order for smooth motion. Contact holds at the end of each step, and one
    contact traction acts all through the step (Kane, Repetto, Ortiz and Marsden 1999), so that
    contact and friction can only take energy away; it is the mean over the step. Then the
    velocities are freed from what contact forbids, by the closest admissible ones in the sense of
    the kinetic energy: without that the velocities of touching surfaces, and with them the
    pressures, would swing from step to step. The surface layer that meets an obstacle loses its
    kinetic energy, a fraction of the order of element size over body size. With ``finite=True``
    contact conserves energy up to the angle between its direction and the normal of the master.

    A step that brings in more than 2 % of the energy, as those of large deformation may, is halved,
    too, if it can be. A failed step leaves solution, velocity, time and history at the last
    converged step.

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
        0 to 1: factor by which one step multiplies oscillations much faster than `dt`. Take less
        than 1 for large deformation, where the trapezoidal rule may become unstable.
    time : ngsolve.Parameter, optional
        Appears in the bulk form, in `rhs`, or in `prescribe`; its value is the time.
    prescribe : dict or callable, optional
        Dirichlet values that depend on the time, as in `LoadStepper`.
    energy : CoefficientFunction, optional
        Strain energy per reference volume of the current `gf`, for `EnergyBalance.internal`.
        Default: the work of the internal forces, exact for a linear bulk.
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
        A step or density that is not positive, `rho_inf` out of range, or another kind of object.

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

    def __init__(
        self, solver, density, *, dt, rho_inf=1.0, time=None, prescribe=None, energy=None, maxcuts=8
    ):
        CheckInstance("solver", solver, ContactSolver, "a ContactSolver")
        if isinstance(solver.a, DynamicForm):
            raise TypeError(
                "solver is the one that a TimeStepper works with: give the ContactSolver that this "
                "was made of"
            )
        solver.system.CheckSpace()
        self.dt, self.scheme = CheckPositive("dt", dt), Scheme(rho_inf)
        self.maxcuts = CheckCount("maxcuts", maxcuts, least=0)
        self.time = Parameter(0.0) if time is None else time
        CheckInstance("time", self.time, Parameter, "an ngsolve.Parameter, such as Parameter(0)")
        self.energy = CheckEnergy(energy)
        free = solver.system.residual.free
        self.mass = Mass(solver.contacts[0], density, free, solver.linear.wanted)
        self.form = DynamicForm(solver.a, self.mass, self.scheme)
        self.static = solver
        self.prescribe = prescribe
        self.solver = OnBulk(solver, Bulk(self.form, solver.gf, self._Load), Inert())
        self.velocity = GridFunction(solver.gf.space, name="velocity")
        self._obstacles = Obstacles(solver.contacts)
        self._journal = Journal(self, "time", self.time)
        self.balance, self.steps = None, []
        self._momentum = None  # M times the acceleration due to the bulk's forces
        self._rate = None  # mean velocity of the last step, and its length
        self._balanced = None  # force of the bulk with loads, and loads alone, at its end

    def __repr__(self):
        steps = f"{len(self.steps)} steps, dt = {self.dt:g}"
        return f"<TimeStepper: time {self.time.Get():g} after {steps}>"

    @property
    def gf(self) -> GridFunction:
        """The solution."""
        return self.solver.gf

    @property
    def prescribe(self):
        """Dirichlet values that depend on the time, see above."""
        return self._prescribed.values

    @prescribe.setter
    def prescribe(self, values):
        self._prescribed = Prescribed(self.static, values)

    # --- steps ---------------------------------------------------------------------------------

    def Integrate(
        self, end, *, callback=None, printing=True, maxit=100, tol=1e-10
    ) -> list[TimeStep]:
        """Go on to the time `end`, in equal steps of at most `dt`.

        Parameters
        ----------
        end : float
        callback : callable, optional
            Called with each converged `TimeStep` after the commit.
        printing : bool
            One line per step and iteration, and the energies.
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
        CheckFlag("printing", printing)
        count = max(1, np.ceil((end - begin) / self.dt - 1e-9))
        if count > LARGEST_COUNT:
            raise ValueError(f"end = {end} is {count:g} steps of dt = {self.dt} away: take fewer")
        targets = [begin + (end - begin) * k / count for k in range(1, int(count))] + [end]
        reach = lambda to: self._Reach(to, callback, printing, maxit, tol)  # noqa: E731
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
            "velocity": self.velocity.vec.FV().NumPy().copy(),
            "steps": list(self.steps),
            "balance": self.balance,
            "momentum": self._momentum,
            "rate": self._rate,
            "obstacles": self._obstacles.state,
            "forces": self._balanced,
            "dt": self.form.dt,
        }

    def SetState(self, state) -> None:
        """Go back to a state.

        Parameters
        ----------
        state : dict
            Of `State`.
        """
        CheckState(state, "time", "solver", "velocity", "steps", "balance", "momentum", "obstacles")
        self.time.Set(state["time"])
        self.solver.SetState(state["solver"])
        FillVector("velocity", self.velocity.vec, state["velocity"])
        self.steps[:] = state["steps"]
        self.balance, self._momentum = state["balance"], state["momentum"]
        self._rate, self._balanced = state["rate"], state["forces"]
        self._obstacles.state = state["obstacles"]
        if state["dt"]:
            self.form.SetStep(state["dt"])
        self.solver.system.bulk.StartAfresh()

    def _Begin(self):
        """Forces and energies of the present state, which the user may have changed."""
        self.solver.system.CheckSpace()
        for name, field in {"gf": self.gf, "velocity": self.velocity}.items():
            if not np.all(np.isfinite(field.vec.FV().NumPy())):
                raise ValueError(f"{name} holds NaN or infinite values")
        if not np.isfinite(self._Energy()):
            raise ValueError("energy is NaN or infinite where the motion begins")
        for contact in self.solver.contacts:
            if not contact.form.paired:
                contact.Update(self.gf if contact.finite else None)
        self._balanced = self._Forces()
        if self._momentum is None:
            if not self._prescribed:
                self.velocity.vec.FV().NumPy()[~self.mass.free] = 0
            self._momentum = -self._balanced[0]
            self._rate = self._Velocity(), self.dt
        kinetic = self.mass.Energy(self._Velocity())
        if self.balance is None:
            self.balance = EnergyBalance(self.time.Get(), kinetic, self._Energy())
            return
        external = self.balance.external + kinetic - self.balance.kinetic
        self.balance = replace(self.balance, kinetic=kinetic, external=external)

    def _Reach(self, target, callback, printing, maxit, tol):
        done, control = [], StepControl(self.time.Get(), target, self.maxcuts)
        while not control.done:
            goal = control.goal
            if printing:
                print(f"step {len(self.steps) + 1}  time {goal:g}")
            try:
                last = self._Attempt(goal, printing, maxit, tol, control.smallest)
            except ContactConvergenceError as error:
                if control.smallest:
                    raise
                if printing:
                    print(f"  {error}; halved")
                control.cuts += 1
                control.size = control.half
                continue
            if printing:
                print(self.balance)
            cuts = control.Reached(goal)
            step = TimeStep(len(self.steps) + 1, goal, last.number, cuts, self.balance)
            done.append(self._journal.Add(step, callback, gf=self.gf, velocity=self.velocity))
            control.size *= 2
        return done

    def _Attempt(self, goal, printing, maxit, tol, last_chance):
        vec, now = self.gf.vec, self.time.Get()
        start = vec.FV().NumPy().copy()
        if self.form.SetStep(goal - now):
            self.solver.system.bulk.StartAfresh()
        dt = self.form.dt
        inertial = start + dt * self._Velocity()
        self.form.start.vec.FV().NumPy()[:] = inertial
        try:
            self._obstacles.Begin(self.gf)
            self.time.Set(goal)
            self._obstacles.Move(self.gf)
            self.mass.CheckConstant()
            if self._prescribed:
                self._prescribed.Set()
            vec.FV().NumPy()[self.mass.free] = inertial[self.mass.free]
            last = self.solver.Solve(maxit=maxit, tol=tol, printing=printing, path=False)
            if not np.isfinite(self._Energy()):
                raise ContactConvergenceError("elements turned inside out")
        except BaseException:
            self._journal.saved.Restore()
            raise
        before = self.balance
        self._Accept(start, dt)
        if not last_chance and (won := self.balance.Won(before)) > MOST_WON:
            self._journal.saved.Restore()
            raise ContactConvergenceError(f"the step wins {100 * won:.2g} % of the energy")
        return last

    def _Accept(self, start, dt):
        scheme, mass, (old, oldloads) = self.scheme, self.mass, self._balanced
        motion = (self.gf.vec.FV().NumPy() - start) * mass.rows
        force, loads = self._Forces()
        mean = (1 - scheme.force) * force + scheme.force * old
        momentum = -(scheme.mass * self._momentum + mean) / (1 - scheme.mass)
        velocity = 2 / dt * motion - self._Velocity()
        if scheme.rho_inf < 1:
            bend = dt * (scheme.gamma - 2 * scheme.beta)
            velocity += bend * mass.Solve(momentum - self._momentum)
        works = self._Works(motion, loads)
        works["external"] += self._MoveSupports(velocity, motion / dt, dt)
        for contact in self.solver.contacts:
            contact.Commit(self.gf)
        admissible = mass.Arrest(self.solver.contacts, velocity, self._obstacles.Rates(dt))
        lost = mass.Energy(velocity - admissible)
        works["impact"] += lost
        works["external"] += lost - mass.Energy(velocity) + mass.Energy(admissible)
        works["internal"] = 0.5 * float((old + force + oldloads + loads) @ motion)
        self.velocity.vec.FV().NumPy()[:] = admissible
        self._balanced, self._momentum = (force, loads), momentum
        if self.energy is not None:
            works["internal"] = self._Energy() - self.balance.internal
        self.balance = self.balance.After(self.time.Get(), mass.Energy(admissible), **works)

    def _MoveSupports(self, velocity, rate, dt):
        """Velocities of what is prescribed, from backward differences; returns the energy of that.

        The trapezoidal rule would answer to a jump of the velocity with oscillations for ever.
        """
        fixed = self.mass.rows & ~self.mass.free
        before, last = self._rate
        self._rate = rate * fixed, dt
        if not (np.any(rate[fixed]) or np.any(before[fixed])):
            return 0.0
        energy = self.mass.Energy(velocity)
        velocity[fixed] = (rate + dt / (dt + last) * (rate - before))[fixed]
        return self.mass.Energy(velocity) - energy

    # --- forces and energies -------------------------------------------------------------------

    def _Velocity(self):
        return self.velocity.vec.FV().NumPy() * self.mass.rows

    def _Energy(self):
        return 0.0 if self.energy is None else float(Integrate(self.energy, self.gf.space.mesh))

    def _Forces(self):
        """Force of the bulk including the loads, and the loads alone."""
        static = self.static
        zero, result = self.gf.vec.CreateVector(), self.gf.vec.CreateVector()
        zero[:] = 0
        load = static.system.bulk.load
        static.a.Apply(zero, result)
        loads = (load - result.FV().NumPy()) * self.mass.rows
        static.a.Apply(self.gf.vec, result)
        return (result.FV().NumPy() - load) * self.mass.rows, loads

    def _Load(self):
        """Right hand side of the step: loads and what the step before leaves behind."""
        scheme, vec = self.scheme, self.gf.vec.CreateVector()
        memory = (1 - 2 * scheme.beta - scheme.weight * scheme.mass) * self._momentum
        memory -= scheme.weight * scheme.force * self._balanced[0]
        load = self.static.system.bulk.load
        vec.FV().NumPy()[:] = memory + scheme.share * load
        return vec

    def _Works(self, motion, loads):
        """Works of contact, friction, loads, supports and obstacles, before the commit."""
        forces, work, friction = ContactWorks(self.solver.contacts, self.gf, motion)
        balance = self.gf.vec.CreateVector()
        self.form.Apply(self.gf.vec, balance)
        reaction = balance.FV().NumPy() + forces - self._Load().FV().NumPy()
        supports = float((reaction * ~self.mass.free) @ motion)
        external = supports + 0.5 * float((self._balanced[1] + loads) @ motion)
        pushed = self._obstacles.Work()
        impact = pushed - work - friction
        return {"external": external + pushed, "friction": friction, "impact": impact}

    def Table(self) -> dict[str, np.ndarray]:
        """The energy balance after each step as numpy arrays, see `EnergyBalance.Table`."""
        return EnergyBalance.Table(step.balance for step in self.steps)
