# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checked solution of linear systems by a chain of methods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import BaseMatrix, BitArray

from ngslac.arrays import AsNumPy
from ngslac.errors import LinearSolveError
from ngslac.linear.factor import OneBLASThread
from ngslac.linear.refine import FirstGood
from ngslac.linear.system import LinearSystem, Link, Merged

if TYPE_CHECKING:
    from ngslac._ngslac import InnerElimination
    from ngslac.linear.inner import InnerDofs
    from ngslac.linear.interface import Compliance

__all__ = ["LinearSolver"]

# Of the diagonal of the scaled matrix where that is singular, and how often in a row.
SHIFT, MOST_SHIFTS = 1e-4, 5
# Residual of an iteration that is accepted, over the one that was asked for.
ENOUGH = 3


class LinearSolver:
    """Solves linear systems by the first method of a chain that returns a small residual."""

    tolerance = 1e-9
    most_failures = 2  # of an iteration in a row where another method serves: it is given up
    shown = "method", "factorisations", "krylov"  # on all processes

    def __init__(self, freedofs: BitArray, links: Sequence[Link], inner: InnerDofs | None = None):
        self.freedofs, self.free, self.inner = BitArray(freedofs), AsNumPy(freedofs), inner
        self.bits = self.freedofs & ~inner.dofs if inner else self.freedofs
        self.shifts, self.failures = 0, {}  # in a row: singular systems, iterations that failed
        self.nearly_singular, self._all, self._merged = False, links, Merged()

    def __str__(self) -> str:
        return f"linear systems: {self._links[0].method} ({self._links[0].why})"

    @property
    def _links(self) -> list[Link]:
        """The methods that are not given up."""
        failures = self.failures
        return [link for link in self._all if failures.get(link.name, 0) < self.most_failures]

    @property
    def method(self) -> str:
        """The name of the present method, such as "interface"."""
        return self._links[0].name

    @property
    def inverse(self) -> str | None:
        """The NGSolve solver that factors whole systems; None: PETSc's."""
        return next(filter(None, (link.method.inverse for link in self._all)), None)

    @property
    def factorisations(self) -> int:
        """Of matrices of full size, so far."""
        return sum(link.method.factorisations for link in self._all)

    @property
    def krylov(self) -> int:
        """Krylov iterations so far."""
        return sum(link.method.krylov for link in self._all)

    def State(self) -> dict:
        """A dict of what has been learnt about the methods."""
        methods = {link.name: link.method.State() for link in self._all}
        return {"failures": dict(self.failures), "methods": methods}

    def SetState(self, state: dict) -> None:
        """Go on with the methods of a `State`; one that it does not know goes on as it is."""
        methods, failures = state["methods"], state["failures"]
        if isinstance(methods, list):  # of an older file
            methods, failures = dict.fromkeys(methods, state), {"iterative": failures}
        self.failures = dict(failures)
        for link in self._all:
            if link.name in methods:
                link.method.SetState(methods[link.name])

    def NewBulk(self) -> None:
        """The bulk matrix that was used last has got other values."""
        if self.inner:
            self.inner.Forget()
        self._merged.Forget()
        for link in self._all:
            link.method.NewBulk()

    @OneBLASThread()
    def Solve(self, system: LinearSystem) -> np.ndarray:
        """The solution (n,) of a LinearSystem, 0 where nothing is free."""
        elimination = self._Elimination(system.mat)
        if elimination is None:
            return self._Solve(system)
        reduced = replace(system, mat=elimination.mat, rhs=elimination.Reduce(system.rhs))
        return elimination.Expand(system.rhs, self._Solve(reduced))

    def _Elimination(self, bulk: BaseMatrix) -> InnerElimination | None:
        """That of inner dofs; None, and no more of it, where the matrix of some is singular."""
        try:
            return self.inner and self.inner.Eliminate(bulk)
        except LinearSolveError:
            self.inner, self.bits = None, self.freedofs
            self.NewBulk()

    def _Solve(self, system: LinearSystem) -> np.ndarray:
        """The solution by the first method that has a good one."""
        self.nearly_singular = True
        system = replace(system, bits=self.bits, merged=self._merged)
        b = system.scale * system.rhs * system.free
        attempts = [
            (link.name, partial(link.method.Solve, system, b), partial(self._IsGood, link, system))
            for link in self._links
            if link.method.serves_alone or not system.alone
        ]
        try:
            x, _, name = FirstGood(attempts)
        except LinearSolveError as error:
            raise LinearSolveError(f"the linear system could not be solved ({error})") from None
        if name is not None:
            self.nearly_singular = False
            self._LearnFrom(name, system)
        return system.scale * x

    def Compliance(self, system: LinearSystem) -> Compliance:
        """How the bulk of a LinearSystem follows what acts on the interface; it may not be known.

        Then there is an error, as where a system is not solved.
        """
        if self.inner:
            raise LinearSolveError("the system is reduced")
        system = replace(system, bits=self.bits, merged=self._merged)
        b = system.scale * system.rhs * system.free
        b[system.multipliers] = 0
        return self._links[0].method.Compliance(system, b)

    def _IsGood(self, link: Link, system: LinearSystem, _: np.ndarray, error: float) -> bool:
        return error <= max(self.tolerance, ENOUGH * system.accuracy * link.method.is_iteration)

    def _LearnFrom(self, name: str, system: LinearSystem) -> None:
        """A method has served: an iteration that comes before it has not."""
        names = [link.name for link in self._links]
        for link in self._links if not system.alone else ():
            if link.method.is_iteration:
                after = names.index(name) > names.index(link.name)
                self.failures[link.name] = after * (self.failures.get(link.name, 0) + 1)

    def SolveShifted(self, system: LinearSystem, rows: np.ndarray) -> np.ndarray:
        """The same; a singular matrix gets a small diagonal on `rows` (n,) bool.

        Where all that holds a body slips, nothing determines how far it moves. It moves as if it
        had mass, less each time, until something sticks.
        """
        try:
            solution = self.Solve(system)
            self.shifts = 0
        except LinearSolveError:
            self.shifts += 1
            if self.shifts > MOST_SHIFTS:
                raise
            shift = SHIFT * 0.1 ** (self.shifts - 1) * rows
            if system.shift is not None:
                shift = shift + system.shift
            solution = self.Solve(replace(system, shift=shift, accuracy=0.0))
        return solution
