# SPDX-License-Identifier: LGPL-2.1-or-later
"""The residual of bulk plus contact, and how large it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from netgen.meshing import NgException

from ngslac.arrays import Sparse
from ngslac.parallel.extent import Extent, ExtentOf
from ngslac.solve.bulk import LINEAR, ROUNDING, Bulk
from ngslac.solve.loads import CheckNoMultiplierLoad
from ngslac.solve.problem import MultiplierRows, ScalarFields

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact

__all__ = ["Measurement", "Residual"]

# What a residual keeps from one solve to the next.
REMEMBERED = ("converged", "forces", "reference", "tol")
# Displacements that are less of the size of the mesh are rounding errors.
NO_MOTION = 1e-12


@dataclass
class Measurement:
    """Residual of bulk and loads, its sizes and the contact status, at one iterate.

    Attributes
    ----------
    bulk : (n,)
        Residual of the bulk form minus `rhs`; None where there is none.
    equilibrium, constraint : float
        Norms of the scaled residuals of both kinds of rows, relative to the forces at work.
    merit : float
        Norm of both, not divided by the forces: what a line search compares. Infinite where the
        residual has no value, or the surfaces cannot be paired.
    unbalance : float
        The part of the equilibrium rows of the merit.
    status : (m,) int
        Of the macro-elements of all contacts: 0 open, 1 stick, 2 slip.
    covered, gaps : (m,)
        Share of their area that faces a master, and how far it is away.
    reason : str
        Why there is no residual.
    exact : bool
        Is `bulk` what the bulk form itself says?
    """

    bulk: np.ndarray = field(repr=False)
    equilibrium: float
    constraint: float
    merit: float
    unbalance: float
    status: np.ndarray = field(repr=False)
    covered: np.ndarray = field(repr=False)
    gaps: np.ndarray = field(repr=False)
    reason: str = ""
    exact: bool = True

    @property
    def finite(self) -> bool:
        """Is there a residual?"""
        return np.isfinite(self.merit)

    def LostSight(self, before: Measurement, moved: float) -> bool:
        """Did a macro-element lose a partner that a step may have moved it through?

        `moved` is how far it moved anything. Where a partner was farther away than both may have
        moved, the macro-element has turned away from it.
        """
        lost = self.covered < 0.5 * before.covered
        return bool(np.any(before.gaps[lost] <= 2 * moved))

    @classmethod
    def Nothing(cls, reason: str) -> Measurement:
        """Of an iterate that has no residual."""
        return cls(None, np.inf, np.inf, np.inf, np.inf, None, None, None, reason)


class Residual:
    """Measures both kinds of rows, scaled and relative to the forces at work.

    Attributes
    ----------
    multipliers, displacements : (n,) bool
        Rows of multipliers, and of all else but the scalar fields that flow through contacts.
    parts : (n, 2) array
        The residual measured last: of bulk and loads, and of contact.
    scaled : (n,)
        It, times the factors of the rows.
    forces, first, reference, rounding, places : float
        What counts as zero: of the loads and reactions, now and where the solve began, of earlier
        solves, and rounding errors, in the rows of multipliers those of positions.
    """

    def __init__(self, bulk: Bulk, contacts: Sequence[LACContact], free: np.ndarray):
        self.bulk, self.gf, self.contacts, self.free = bulk, bulk.gf, contacts, free
        self.layout = bulk.layout
        self.multipliers, self.tol = MultiplierRows(contacts), None
        self.scalars = [rows for _, rows in ScalarFields(contacts)]
        self.displacements = ~self.multipliers
        for rows in self.scalars:
            self.displacements[rows] = False
        self.ground = self.drag = None
        self.converged = 0.0  # largest forces of a converged state
        self.forces = self.first = self.reference = 0.0

    @property
    def drowned(self) -> bool:
        """Are the forces so small, or the motions so large, that rounding sets the tolerance?"""
        return 0 < max(self.forces, self.converged) < self.rounding / self.tol

    @property
    def borne(self) -> float:
        """Forces that hold idle bodies, relative to those of contact, in what was measured last."""
        bulk, contact = np.abs(self.parts).sum(axis=0)
        if not self.ground or contact <= ROUNDING * bulk:
            return 0.0
        unbalanced = np.sum(self.parts, axis=1) * self.free
        held = unbalanced - self.ground.Balanced(unbalanced)
        return np.abs(held).sum() / (contact or np.inf)

    def State(self) -> dict[str, float]:
        """What the next solve depends on, as a dict."""
        names = REMEMBERED if self.tol else REMEMBERED[:-1]  # none before the first solve
        return {name: getattr(self, name) for name in names}

    def SetState(self, state: dict) -> None:
        """Go on from a `State`."""
        for name in state.keys() & set(REMEMBERED):  # of older files there are others
            setattr(self, name, state[name])
        self.bulk.Forget()

    def Begin(self, scale: np.ndarray, tol: float) -> Measurement:
        """Start a solve with these factors and tolerance; returns the first Measurement."""
        self.reference, self.tol = self.converged, tol
        state = self.Measure(scale, exact=True)
        if state.finite:
            self._CheckMultiplierLoads(scale)
        # A body that moves without touching feels nothing but the jump of its Dirichlet values.
        self.first = self.forces
        self.reference = max(self.converged, 1e-5 * self.forces)
        return state

    def Follow(self) -> None:
        """Contacts that follow the motion pair anew in the configuration of gf."""
        for contact in self.contacts:
            contact.Follow(self.gf)

    def Accept(self) -> None:
        """The state measured last has converged."""
        self.converged = max(self.forces, self.converged)

    def Confirm(self, state: Measurement, scale: np.ndarray) -> Measurement:
        """The exact Measurement of gf in place of the last one.

        Where the bulk turns out not to be linear, gf is that of the last exact residual if this
        was smaller.
        """
        if state.exact:
            return state
        last, change = self.bulk.last, self.bulk.Change()
        exact = self.Measure(scale, exact=True)
        errors = exact.bulk - state.bulk if exact.finite else None
        if exact.finite and self._SeemsLinear(change, errors, scale):
            return exact
        self.bulk.Refute()
        if not exact.merit <= last.merit:
            self.gf.vec.data = last.vec
            exact = self.Measure(scale)
        return exact

    def _SeemsLinear(self, change: np.ndarray, error: np.ndarray, scale: np.ndarray) -> bool:
        """Are errors (n,) of a change of the bulk's forces small, in each kind of rows?"""
        least = max(1e-2 * LINEAR * self.forces, self.rounding)
        kinds = [(self.displacements, least)]
        kinds += [(rows, self._RoundingOf(rows, scale)) for rows in self.scalars]
        return all(
            Norm((scale * error)[rows]) <= max(LINEAR * Norm((scale * change)[rows]), rounding)
            for rows, rounding in kinds
        )

    def Measure(self, scale: np.ndarray, exact: bool = False) -> Measurement:
        """The Measurement of gf; `exact`: by the bulk form, even if it seems to be linear."""
        vec = self.gf.vec
        contact_residual = vec.CreateVector()
        contact_residual[:] = 0
        try:
            self.Follow()
            residual, exact = self.bulk.Apply(exact)
            for contact in self.contacts:
                contact.AddApply(vec, contact_residual)
                contact.form.Evaluate(vec)
        except NgException as error:
            return Measurement.Nothing(str(error))
        Values = self.layout.Values
        bulk, pushed = Values(residual), Values(contact_residual)
        load = self.bulk.load
        # Forces at work: reactions, contact forces and loads all count.
        forces = max(Norm((scale * f)[self.displacements]) for f in (bulk, pushed, load))
        flows = [
            max(Norm((scale * f)[rows]) for f in (bulk, pushed, load)) for rows in self.scalars
        ]
        self._gapshifts = {
            "rhs": load[self.multipliers],
            "a, the bulk form,": bulk[self.multipliers],
        }
        bulk = bulk - load
        unbalanced = (bulk + pushed) * self.free
        if self.drag:
            unbalanced = unbalanced + self.drag.Forces(Values(vec), scale)
        if self.ground:
            unbalanced = self.ground.Balanced(unbalanced)
        scaled = scale * unbalanced
        if not np.all(np.isfinite(scaled)):
            parts = {"rhs": load, "a, the bulk form,": bulk, "contact": pushed}
            wrong = (name for name, part in parts.items() if not np.all(np.isfinite(part)))
            return Measurement.Nothing(
                f"the residual holds NaN or infinite values of {next(wrong, 'all')}"
            )
        self.forces, self.scaled, self.parts = forces, scaled, np.stack([bulk, pushed], axis=1)
        self.rounding = self._Rounding(scale, np.any(pushed) or np.any(load))
        self.places = self._RoundingOfPlaces(scale)
        state = self._StateOf(bulk, exact, self._Unsteadiness(flows, scale))
        if exact:
            self.bulk.Remember(residual, state.merit, self.rounding)
        elif self._IsSpoilt(state):
            return self.Measure(scale, exact=True)
        return state

    def _IsSpoilt(self, state: Measurement) -> bool:
        """Do products go on from so far away that rounding errors of there are all there is?"""
        errors = self.bulk.last.rounding
        matters = errors > max(self.tol * max(self.forces, self.reference), 10 * self.rounding)
        return matters and state.unbalance <= errors

    def _Unsteadiness(self, flows: Sequence[float], scale: np.ndarray) -> float:
        """The largest residual of a scalar field, relative to what flows in it."""
        largest = 0.0
        crossing = self._RoundingOfFlows(scale) if self.scalars else None
        for rows, flow in zip(self.scalars, flows, strict=True):
            rounding = max(self._RoundingOf(rows, scale), Norm(crossing[rows]))
            size = max(flow, rounding / self.tol)
            largest = max(largest, Norm(self.scaled[rows]) / (size or 1.0))
        return largest

    def _StateOf(self, bulk: np.ndarray, exact: bool, unsteadiness: float) -> Measurement:
        """What was measured, relative to the forces at work."""
        reference = max(self.forces, self.reference, self.rounding / self.tol)
        # Gaps know their rounding errors better: no sums over elements are in them.
        gaps = max(0.1 * self.rounding, self.places)
        pressing = max(self.forces, self.reference, gaps / self.tol)
        equilibrium, constraint = (
            Norm(self.scaled[self.displacements]),
            Norm(self.scaled[self.multipliers]),
        )
        reference = reference or max(equilibrium, constraint) or 1.0
        pressing = pressing or reference
        unbalance = equilibrium
        if unsteadiness:
            unbalance = float(np.hypot(equilibrium, unsteadiness * (self.first or reference)))
        merit = float(np.hypot(unbalance, constraint))
        tables = [contact.Table() for contact in self.contacts]
        return Measurement(
            bulk,
            max(equilibrium / reference, unsteadiness),
            constraint / pressing,
            merit,
            unbalance,
            np.concatenate([t["status"] for t in tables]),
            np.concatenate([t["area"] / t["fullarea"] for t in tables]),
            np.concatenate([t["gap"] for t in tables]),
            exact=exact,
        )

    def _Rounding(self, scale: np.ndarray, pushed: bool) -> float:
        """No residual gets below the rounding errors of the stiffness times the displacement.

        A nonlinear bulk has those of the positions in each element, too, and of the whole mesh
        where nothing pushes or moves; loads of a linear one may be as small as they like.
        """
        rows = self.free & self.displacements  # what is carried along whole has no residual
        factors, displacement = scale[rows], self.layout.Values(self.gf.vec)[rows]
        moved = self._RoundingOf(rows, scale)
        if self.bulk.islinear is not False:
            return moved
        mesh, size = self.gf.space.mesh, self.size
        elements = self._extent.elements
        if not pushed and np.abs(displacement).max(initial=0) <= NO_MOTION * size:
            return max(moved, 1e-15 * Norm(size / factors))
        return max(moved, 3e-16 * Norm(size * elements ** (-1 / mesh.dim) / factors))

    def _RoundingOf(self, rows: np.ndarray, scale: np.ndarray) -> float:
        """Errors of the stiffness times the values of some rows."""
        return ROUNDING * Norm(self.layout.Values(self.gf.vec)[rows] / scale[rows])

    def _RoundingOfFlows(self, scale: np.ndarray) -> np.ndarray:
        """Errors (n,) of what flows through contacts, which are differences of their unknowns.

        With large sliding these are positions.
        """
        errors = np.zeros_like(scale)
        for contact in self.contacts:
            mat, values = contact.form.mat, np.abs(self.layout.Values(self.gf.vec))
            if contact.finite:
                values[self.displacements] += self.size
            if contact.fluxes and mat.height:
                errors += abs(Sparse(mat)) @ values
        return ROUNDING * scale * errors

    @cached_property
    def _extent(self) -> Extent:
        return ExtentOf(self.gf.space.mesh)

    @property
    def size(self) -> float:
        """Of the mesh."""
        return self._extent.size

    def _RoundingOfPlaces(self, scale: np.ndarray) -> float:
        """Gaps and slip of large sliding are differences of positions, wherever these are."""
        rows = [
            scale[c.form.MultiplierDofs()] * c.Table()["area"].repeat(c.mesh.dim)
            for c in self.contacts
            if c.finite
        ]
        return np.finfo(float).eps * self.size * Norm(np.concatenate(rows)) if rows else 0.0

    def IsRounding(self, forces: np.ndarray, scale: np.ndarray) -> bool:
        """Are forces (n,) of bulk and loads nothing but rounding errors?"""
        free = self.free & self.displacements
        return Norm((scale * forces)[free]) <= 10 * self.rounding

    def _CheckMultiplierLoads(self, scale: np.ndarray) -> None:
        """Once per solve: what depends on the iterate, the matrix shows."""
        allowed = self.tol * max(self.forces, self.reference, self.rounding / self.tol)
        for name, shift in self._gapshifts.items():
            CheckNoMultiplierLoad(name, Norm(scale[self.multipliers] * shift), allowed)


def Norm(values: np.ndarray) -> float:
    """Euclidean norm without BLAS, whose threads fight for the cores with those of NGSolve.

    Squares of what is very large or very small are none: such values are scaled.
    """
    with np.errstate(over="ignore", under="ignore"):
        square = float(np.sum(np.square(values)))
    if 1e-280 < square < np.inf:
        return float(np.sqrt(square))
    largest = float(np.max(np.abs(values), initial=0))
    if not 0 < largest < np.inf:
        return largest
    return largest * float(np.sqrt(np.sum(np.square(values / largest))))
