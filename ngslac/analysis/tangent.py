# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bulk and contacts, linearized at a converged state."""

from __future__ import annotations

from contextlib import nullcontext
from typing import TYPE_CHECKING, Any

import numpy as np

from ngslac.arguments import CheckInstance
from ngslac.arrays import AsBits, Exported, Multiply, ToCSR
from ngslac.errors import LinearSolveError
from ngslac.linear.factor import LU, Factor, OneBLASThread
from ngslac.linear.refine import Refine
from ngslac.solve.snapshot import Snapshot
from ngslac.solve.solver import ContactSolver, Equilibrium

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ngslac.solve.system import System
    from ngslac.steps.load import LoadStepper
    from ngslac.steps.time import TimeStepper

__all__ = ["AsBefore", "ContactMatrix", "Factors", "Static", "Tangent"]

# Relative residual up to which a state counts as converged: that of `Solve` is 1e-10.
CONVERGED = 1e-6


class Tangent:
    """The derivative of the residual of bulk and contacts at the solution of a solver.

    Statuses are as they are: what sticks is held, what slips moves with its friction, and what is
    open has no traction. Rows of displacements are forces, those of multipliers are lengths times
    areas. With friction the matrix is not symmetric. With large sliding in 3D it is that of
    Newton's method, which knows the motion of what overlaps to some 1e-6.

    Attributes
    ----------
    bulk, contact : (n, n) scipy.sparse.csr_matrix
        The two parts of the matrix, on all scalar dofs of the product space.
    free, multipliers : (n,) bool
        Dofs that are solved for, and those of the multipliers of contacts.
    scale : (n,) array
        Factors by which rows and columns of the matrix become free of units.
    """

    def __init__(self, solver: Equilibrium | LoadStepper | TimeStepper, *, keeping: bool = True):
        static = Static(solver)
        system = static.system
        if system.bulk.a.condense:
            raise ValueError(
                "solver: the bulk was made with condense=True, which leaves no matrix of all dofs: "
                "make the BilinearForm without it"
            )
        if system.scale is None:
            raise ValueError("solver has not solved anything: call solver.Solve() first")
        # Else the caller puts back what changes.
        with AsBefore(static) if keeping else nullcontext():
            self._Linearize(system)

    def _Linearize(self, system: System) -> None:
        """Take the matrices of bulk and contact at the solution, which has to be one."""
        state = system.Measure()
        if not max(state.equilibrium, state.constraint) <= CONVERGED:
            raise ValueError(
                "solver has not converged at its solution (relative residual "
                f"{max(state.equilibrium, state.constraint):.1e}): call solver.Solve() first"
            )
        system.Assemble()
        self.bulk, self.contact = ToCSR(system.bulk.mat), ContactMatrix(system)
        self.free, self.multipliers = system.residual.free, system.residual.multipliers
        self.scale = system.scale

    @property
    def matrix(self) -> csr_matrix:
        """The sum of both parts."""
        return self.bulk + self.contact

    def Factors(self, matrix: csr_matrix | None = None) -> Factors:
        """Those of the tangent, or of a matrix of the same size, on the free dofs."""
        return Factors(self.matrix if matrix is None else matrix, self.free, self.scale)


def ContactMatrix(system: System) -> csr_matrix:
    """The part of the contacts in the tangent, (n, n), as they were measured last."""
    vec = system.gf.vec
    residual = vec.CreateVector()
    for contact in system.contacts:
        contact.form.AssembleStep(vec, residual, False)
    return sum(ToCSR(contact.form.mat) for contact in system.contacts)


class AsBefore:
    """A context at the end of which solver and contacts are as they were."""

    def __init__(self, static: Equilibrium):
        self._static, self._state = static, Snapshot(static)
        self._memories = [contact.form.Kept() for contact in static.contacts]
        self._accepted = [contact._accepted for contact in static.contacts]

    def __enter__(self) -> AsBefore:
        return self

    def __exit__(self, *_) -> None:
        """Put the state back, and what is no part of it."""
        self._state.Restore()
        for contact, memory in zip(self._static.contacts, self._memories, strict=True):
            if any(np.any(memory[name] != now) for name, now in contact.form.Kept().items()):
                contact.Evaluate(self._static.gf)  # of a state that is not that of a commit
        for contact, accepted in zip(self._static.contacts, self._accepted, strict=True):
            contact._accepted = accepted  # which the state of a solver does not contain


def Static(solver: Any) -> ContactSolver:
    """A solver of static problems, or that of a stepper; a ValueError on a distributed mesh."""
    solver = getattr(solver, "static", getattr(solver, "solver", solver))
    CheckInstance("solver", solver, Equilibrium, "a solver, such as ContactSolver")
    if solver.gf.space.mesh.comm.size > 1:
        raise ValueError("solver is on a distributed mesh: analyses of a state need one process")
    return solver


class Factors:
    """Solves with a scaled sparse matrix (n, n) on the free dofs, or with its transpose."""

    def __init__(self, matrix: csr_matrix, free: np.ndarray, scale: np.ndarray):
        self.free, self.scale = free, scale
        scaled = matrix.multiply(scale[:, None]).multiply(scale).tocsr()
        self._mat = Exported(scaled)
        with OneBLASThread():
            self._factors = Factor(self._mat, AsBits(free), LU())

    def Solve(self, forces: np.ndarray, *, transposed: bool = False) -> np.ndarray:
        """The solution (n,) or (n, k) for forces of this shape, 0 where nothing is free."""
        if np.ndim(forces) == 2:
            columns = [self.Solve(column, transposed=transposed) for column in forces.T]
            return np.stack(columns, axis=1) if columns else np.zeros(np.shape(forces))
        mat, factors = self._mat, self._factors
        if transposed:
            mat, factors = mat.CreateTranspose(), factors.T
        right = self.scale * forces * self.free
        with OneBLASThread():
            found, error = Refine(
                lambda left: Multiply([factors], left),
                lambda x: (right - Multiply([mat], x)) * self.free,
                right,
            )
        if not error <= CONVERGED:
            raise LinearSolveError(f"the tangent is nearly singular: relative residual {error:.1e}")
        return self.scale * found
