# SPDX-License-Identifier: LGPL-2.1-or-later
"""A linear system, what users choose for its solution, and what solves it."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from ngsolve import BaseMatrix

__all__ = ["LinearSystem", "Link", "Method", "Options"]


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

    def Entries(self):
        """A list of lists of arrays, which with `mat` make the scaled matrix."""
        shift = np.zeros(0) if self.shift is None else np.array(self.shift)
        contacts = [[np.array(part) for part in contact.CSR()] for contact in self.contacts]
        return [*contacts, [np.array(self.scale), shift, np.array(self.alone)]]


@dataclass(frozen=True)
class Options:
    """The choices of users, see `ContactSolver`."""

    solver: str | None = None
    inverse: str | None = None
    preconditioner: object = None


class Method(ABC):
    """One way to solve linear systems; `chain.METHODS` has a line for each.

    Where it raises a RuntimeError or an NgException, or its residual is large, the next method of
    the chain solves the system.

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

    @abstractmethod
    def Solve(self, system: LinearSystem, b: np.ndarray) -> tuple[np.ndarray, float]:
        """Scaled solution for a scaled right hand side, and its relative residual."""

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
