# SPDX-License-Identifier: LGPL-2.1-or-later
"""The end of a time step: forces, velocities and the energy balance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ngslac.bodies.constraints import ActiveRates, ActiveRows
from ngslac.parallel.matrices import SkinRows, Stacked
from ngslac.steps.balance import ContactWorks, EnergyBalance
from ngslac.steps.conservation import Conservation
from ngslac.steps.forces import BulkForces
from ngslac.steps.obstacles import Obstacles

if TYPE_CHECKING:
    from ngsolve import BaseVector, GridFunction
    from scipy.sparse import spmatrix

    from ngslac.parallel.layout import Layout, Whole
    from ngslac.solve.solver import ContactSolver
    from ngslac.solve.system import System
    from ngslac.steps.inertia import DynamicForm, Mass, Scheme

__all__ = ["StepEnd"]


@dataclass
class StepBalance:
    """Works and losses of one step, losses of each body (count,), and forces of contact (n,)."""

    internal: float
    external: float
    friction: float
    impact: float
    by_contact: np.ndarray
    by_time: np.ndarray
    pushed: np.ndarray

    def After(self, before: EnergyBalance, time: float, kinetic: float) -> EnergyBalance:
        """The EnergyBalance that follows from the one before."""
        names = ("internal", "external", "friction", "impact")
        return before.After(time, kinetic, **{name: getattr(self, name) for name in names})


class StepEnd:
    """The state that one time step leaves for the next one besides the solution."""

    def __init__(
        self,
        static: ContactSolver,
        form: DynamicForm,
        mass: Mass,
        scheme: Scheme,
        velocity: GridFunction,
    ):
        self.static, self.form, self.mass, self.scheme = static, form, mass, scheme
        self.gf, self.contacts, self.velocity = static.gf, static.contacts, velocity
        self.obstacles = Obstacles(static.contacts)
        self._forces = BulkForces(static, mass.rows)
        self._conservation = Conservation(mass, static.contacts[0])
        self._momentum = None  # M times the acceleration due to the bulk's forces
        self._rate = None  # mean velocity of the last step, and its length
        self._balanced = None  # force of the bulk with loads, and loads alone, at its end

    @property
    def _layout(self) -> Layout | Whole:
        return self.static.system.layout

    def _Values(self, gf: GridFunction) -> np.ndarray:
        return self._layout.Values(gf.vec)

    def State(self) -> dict:
        """As a dict."""
        return {
            "momentum": self._momentum,
            "rate": self._rate,
            "obstacles": self.obstacles.state,
            "forces": self._balanced,
            "account": self._conservation.account,
        }

    def SetState(self, state: dict) -> None:
        """Go back to a `State`."""
        self._momentum, self._rate = state["momentum"], state["rate"]
        self.obstacles.state, self._balanced = state["obstacles"], state["forces"]
        self._conservation.account = state["account"]

    def Begin(self, dt: float, prescribed: bool) -> None:
        """Forces of the present state; `dt` is the step, `prescribed` whether supports move."""
        self._balanced = self._forces.Now()
        if self._momentum is not None:
            return
        if not prescribed:
            self._Values(self.velocity)[~self.mass.free] = 0
        self._momentum = -self._balanced[0]
        self._rate = self.Velocity(), dt

    def Velocity(self) -> np.ndarray:
        """Of the displacement (n,), 0 elsewhere."""
        return self._Values(self.velocity) * self.mass.rows

    def Kinetic(self) -> float:
        """Kinetic energy."""
        return self.mass.Energy(self.Velocity())

    def Load(self) -> BaseVector:
        """Right hand side of the step: loads and what the step before leaves behind."""
        scheme, vec = self.scheme, self.gf.vec.CreateVector()
        memory = (1 - 2 * scheme.beta - scheme.weight * scheme.mass) * self._momentum
        memory -= scheme.weight * scheme.force * self._balanced[0]
        for rows in self.static.system.residual.scalars:  # these hold at the end of the step
            memory[rows] = 0
        load = self.static.system.bulk.load
        self._layout.Values(vec)[:] = memory + scheme.share * load
        return vec

    def Accept(
        self,
        start: np.ndarray,
        dt: float,
        before: EnergyBalance,
        now: float,
        *,
        system: System,
        energy: float | None,
    ) -> tuple[EnergyBalance, float, float]:
        """Go on from the end of a step: its EnergyBalance, the parts of the energy won and owed."""
        self.obstacles.Wear(self.gf)
        motion = (self._Values(self.gf) - start) * self.mass.rows
        forces, way, linear = self._Forces(start, motion, system)
        loads = 0.5 * (self._balanced[1] + forces[1])
        velocity, momentum = self._NewVelocity(motion, forces[0], dt)
        step = self._Works(motion, forces[0], loads, way, velocity)
        if energy is not None:
            step.internal = energy - before.internal
        if linear:  # the method is stable by itself
            step.by_time[:] = 0
        step.external += self._MoveSupports(velocity, motion / dt, dt)
        for contact in self.contacts:
            contact.Commit(self.gf)
        rows = Stacked([ActiveRows(contact) for contact in self.contacts])
        velocity = self._Arrest(rows, velocity, dt, step)
        groups = self._conservation.Groups(rows)
        if not linear and all(contact.finite for contact in self.contacts):
            velocity = self._Restore(velocity, groups, motion, dt, loads, way, step)
        self._balanced, self._momentum = forces, momentum
        return self._Settle(groups, rows, velocity, before, now, step)

    def _Forces(
        self, start: np.ndarray, motion: np.ndarray, system: System
    ) -> tuple[tuple[np.ndarray, np.ndarray], list[tuple[float, np.ndarray, np.ndarray]], bool]:
        """Those of the bulk at the end, on the way, and whether they are linear there."""
        form, step = self.form, self._Values(self.gf) - start
        islinear, before = system.bulk.islinear, self._balanced
        linear = islinear and not form.renewed
        whole = not form.condense  # is the matrix that of all dofs?

        def IsRounding(forces: np.ndarray) -> bool:
            return islinear and system.residual.IsRounding(forces, system.scale)

        product = form.ElasticChange if whole and linear else None
        forces = self._forces.Next(form.Elastic(self._Values(self.gf)), product)
        if whole:
            change = form.ElasticChange(step)
            linear = self._forces.Changed(before, forces, change, IsRounding)
        return forces, *self._forces.OnTheWay(motion, before, forces, linear, IsRounding)

    def _NewVelocity(
        self, motion: np.ndarray, force: np.ndarray, dt: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Velocity and `_momentum` at the end of the step, by the time integration."""
        scheme, before = self.scheme, self._momentum
        mean = (1 - scheme.force) * force + scheme.force * self._balanced[0]
        momentum = -(scheme.mass * before + mean) / (1 - scheme.mass)
        velocity = 2 / dt * motion - self.Velocity()
        if scheme.rho_inf < 1:
            bend = dt * (scheme.gamma - 2 * scheme.beta)
            velocity += bend * self.mass.Solve(momentum - before)
        return velocity, momentum

    def _Arrest(
        self, rows: SkinRows | spmatrix, velocity: np.ndarray, dt: float, step: StepBalance
    ) -> np.ndarray:
        """The admissible velocity, with what that takes from the bodies."""
        mass, contacts = self.mass, self.contacts
        rates = self.obstacles.Rates(dt)
        rates = [ActiveRates(*pair) for pair in zip(contacts, rates, strict=True)]
        admissible = mass.Arrest(rows, velocity, np.concatenate(rates))
        lost = mass.Energy(velocity - admissible)
        step.impact += lost
        step.external += lost - mass.Energy(velocity) + mass.Energy(admissible)
        step.by_contact += self._conservation.Kinetic(velocity - admissible)
        return admissible

    def _Restore(
        self,
        velocity: np.ndarray,
        groups: np.ndarray,
        motion: np.ndarray,
        dt: float,
        loads: np.ndarray,
        way: list[tuple[float, np.ndarray, np.ndarray]],
        step: StepBalance,
    ) -> np.ndarray:
        """The velocity with the momenta that loads give to free bodies."""
        conservation, end = self._conservation, self._Values(self.gf)
        momenta = conservation.Virtual(self.mass.Times(self.Velocity()), end - motion)
        momenta += dt * conservation.Virtual(loads, end - 0.5 * motion)
        squares = sum(conservation.Products(force, force) for *_, force in way)
        free = np.all([conservation.Balanced(f, at, squares) for _, at, f in way], axis=0)
        impulses = dt * conservation.Virtual(step.pushed, end)[:, : self.contacts[0].mesh.dim]
        restored = conservation.Restore(velocity, momenta, groups, free, impulses, end)
        step.by_time += conservation.Kinetic(velocity) - conservation.Kinetic(restored)
        return restored

    def _Settle(
        self,
        groups: np.ndarray,
        rows: SkinRows | spmatrix,
        velocity: np.ndarray,
        before: EnergyBalance,
        now: float,
        step: StepBalance,
    ) -> tuple[EnergyBalance, float, float]:
        """Remove the energy that contact and time integration have brought in; see `Accept`."""
        won = step.After(before, now, self.mass.Energy(velocity)).Won(before)
        velocity, back, owed = self._conservation.Settle(
            velocity, groups, rows, step.by_contact, step.by_time, self._Values(self.gf)
        )
        step.impact += back
        self._Values(self.velocity)[:] = velocity
        after = step.After(before, now, self.mass.Energy(velocity))
        return after, won, owed / (after.AtHand(before) or 1.0)

    def _MoveSupports(self, velocity: np.ndarray, rate: np.ndarray, dt: float) -> float:
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

    def _Works(
        self,
        motion: np.ndarray,
        force: np.ndarray,
        loads: np.ndarray,
        way: list[tuple[float, np.ndarray, np.ndarray]],
        velocity: np.ndarray,
    ) -> StepBalance:
        """The StepBalance of all forces, before the commit."""
        forces, work, friction = ContactWorks(self.contacts, self.gf, motion)
        conservation, form, end = self._conservation, self.form, self._Values(self.gf)
        load = self.static.system.bulk.load * self.mass.rows
        inertia = 2 / form.dt**2 * self.mass.Times(end - self._Values(form.start))
        balance = form.share * (force + load) + inertia
        reaction = balance + sum(forces) - self._layout.Values(self.Load())
        outer = reaction * ~self.mass.free + loads
        resistance = sum(weight * force for weight, _, force in way)
        pushes = self.obstacles.Works(self.gf)
        pushed = float(sum(map(np.sum, pushes)))
        internal, external = float(resistance @ motion), float(outer @ motion) + pushed
        algorithmic = conservation.Kinetic(self.Velocity()) - conservation.Kinetic(velocity)
        algorithmic += conservation.Products(outer - sum(forces) - resistance, motion)
        finite = sum(f for f, c in zip(forces, self.contacts, strict=True) if c.finite)
        impact = conservation.Products(finite + np.zeros_like(motion), motion)
        for contact, push in zip(self.contacts, pushes, strict=True):
            if contact.finite and np.any(push):
                impact += conservation.OfMacros(contact, push)
        lost, forces = pushed - work - friction, -sum(forces) * self.mass.rows
        return StepBalance(internal, external, friction, lost, impact, algorithmic, forces)
