# SPDX-License-Identifier: LGPL-2.1-or-later
"""A linear system, the options for its solution, and the methods that solve it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import BaseMatrix, BitArray

from ngslac._ngslac import MergeMatrices
from ngslac.arrays import AddToDiagonal, AsNumPy, SameEntries
from ngslac.errors import LinearSolveError

if TYPE_CHECKING:
    from ngsolve.la import SparseMatrixd

    from ngslac.linear.interface import Compliance

__all__ = ["LinearSystem", "Link", "Merged", "Method", "Options"]


@dataclass(frozen=True)
class LinearSystem:
    """(mat + contacts) x = rhs on the free dofs, which is solved with scaled rows and columns."""

    mat: BaseMatrix  # of the bulk
    contacts: list  # of the matrices that contacts add to it
    multipliers: np.ndarray  # (m,) int: their dofs, d in a row for each macro-element
    scale: np.ndarray  # (n,)
    rhs: np.ndarray  # (n,)
    shift: np.ndarray | None = None  # (n,): added to the diagonal of the scaled matrix
    accuracy: float = 0.0  # relative residual that is enough of an iteration
    alone: bool = False  # are the displacements solved for alone? Then the multipliers stay zero
    bits: BitArray | None = None  # for methods: free dofs that are not eliminated
    merged: Merged | None = None  # for methods: keeps the matrix until the next system

    @cached_property
    def _made(self) -> tuple[BaseMatrix, int]:
        return self.merged.Of(self), self.merged.number

    @property
    def matrix(self) -> SparseMatrixd:
        """The scaled matrix of bulk and contacts, sparse; it changes with the next system."""
        return self._made[0]

    @property
    def number(self) -> int:
        """The number of the values of `matrix`: others have another one."""
        return self._made[1]

    @property
    def free(self) -> np.ndarray:
        """The dofs (n,) bool that are solved for."""
        free = AsNumPy(self.bits)
        if self.alone:
            free[self.multipliers] = False
        return free

    def Entries(self) -> list[list[np.ndarray]]:
        """A list of lists of arrays, which with `mat` make the scaled matrix."""
        shift = np.zeros(0) if self.shift is None else np.array(self.shift)
        contacts = [[np.array(part) for part in contact.CSR()] for contact in self.contacts]
        return [*contacts, [np.array(self.scale), shift, np.array(self.alone)]]


class Merged:
    """The scaled matrix of bulk and contacts, changed where contacts change."""

    def __init__(self):
        self.number = 0  # of the matrix: another one where it has got other values
        self.Forget()

    def Forget(self) -> None:
        """Make another matrix the next time, as where the bulk has got other values."""
        self._mat = self._bulk = self._scale = self._entries = None
        self._plain = False  # may it be changed in place?

    def Of(self, system: LinearSystem) -> SparseMatrixd:
        """The matrix of a LinearSystem."""
        entries = system.Entries()
        same = system.mat is self._bulk and np.array_equal(system.scale, self._scale)
        if same and SameEntries(entries, self._entries):
            return self._mat
        plain = system.shift is None and not system.alone
        former = self._mat if same and plain and self._plain else None
        self.Forget()  # half changed, if that raises an error
        self._mat = MergeMatrices(system.mat, system.contacts, system.scale, former)
        if system.shift is not None:
            AddToDiagonal(self._mat, system.shift)
        self._bulk, self._scale = system.mat, np.array(system.scale)
        self._entries, self._plain = entries, plain
        self.number += 1
        return self._mat


@dataclass(frozen=True)
class Options:
    """The choices of users, see `ContactSolver`."""

    solver: str | None = None
    inverse: str | None = None
    preconditioner: object = None


class Method(ABC):
    """One way to solve linear systems; `chain.METHODS` has a line for each.

    Where it raises a RuntimeError, an NgException or a LinAlgError, or its residual is large, the
    next method of the chain solves the system.

    Attributes
    ----------
    factorisations, krylov : int
        Of matrices of full size, and iterations, since this was made.
    inverse : str or None
        The NGSolve solver that factors whole systems.
    is_iteration : bool
        It may stop at the accuracy that a system asks for, and is given up where it keeps failing.
    serves_alone : bool
        It solves for displacements alone, too.
    """

    factorisations = krylov = 0
    inverse = None
    is_iteration = serves_alone = False

    def __str__(self) -> str:
        return type(self).__name__

    @abstractmethod
    def Solve(self, system: LinearSystem, b: np.ndarray) -> tuple[np.ndarray, float]:
        """Scaled solution (n,), 0 where not free, and its relative residual, which is believed."""

    def Compliance(self, system: LinearSystem, b: np.ndarray) -> Compliance:
        """How the bulk follows what acts on the interface, with the right side `b` (n,)."""
        raise LinearSolveError(f"{self}: the bulk is not factored alone")

    def NewBulk(self) -> None:  # noqa: B027
        """Keep nothing: the matrix of the bulk has got other values."""

    def State(self) -> dict:
        """A record of what was learnt, to go on with."""
        return {}

    def SetState(self, state: dict) -> None:  # noqa: B027
        """Go on with a `State`."""


@dataclass(frozen=True)
class Link:
    """A method of a chain: its name, and why it is there."""

    name: str
    method: Method
    why: str
