# SPDX-License-Identifier: LGPL-2.1-or-later
"""The solver of the linear systems of a ContactSolver: PETSc, or the chain of methods."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ngslac.arrays import AsNumPy, SameEntries
from ngslac.bodies.rigidmotions import MotionsOf
from ngslac.errors import LinearSolveError
from ngslac.linear.chain import IsLarge, MakeLinearSolver
from ngslac.linear.solver import LinearSolver
from ngslac.linear.system import LinearSystem, Link, Method, Options
from ngslac.parallel.copies import WarnOfCopies
from ngslac.parallel.form import TraceOf
from ngslac.petsc.nodes import Nodes
from ngslac.petsc.system import PetscSystem

if TYPE_CHECKING:
    from ngsolve import BilinearForm, BitArray

    from ngslac.contact.contact import LACContact

__all__ = ["LinearSolverFor", "PetscLinearSolver"]

# Up to this many factors may take over where the iteration fails: in 3D they need 20 GB by then.
MOST_DIRECT = 1_000_000
WAYS = {"iterative": "FGMRES with multigrid", "direct": "factors of MUMPS"}


class Taken:
    """The matrices that a PetscSystem has, those of the last LinearSystem."""

    def __init__(self, petsc: PetscSystem):
        self.petsc, self._together = petsc, petsc.numbering.together
        self.NewBulk()

    def NewBulk(self) -> None:
        """The bulk matrix has got other values."""
        self._bulk = self._entries = None

    def Take(self, system: LinearSystem) -> None:
        """Set what is not the same as for the last system."""
        if self._bulk is not system.mat:
            self.NewBulk()
            self.petsc.SetBulk(system.mat)
            self._bulk = system.mat
        entries = system.Entries()
        same = self._entries is not None and SameEntries(entries, self._entries)
        if not self._together.Reduce(same, "LAND"):
            self._entries, shift = None, system.shift
            if system.alone:  # the multipliers get a diagonal of their own
                shift = np.zeros(len(system.rhs)) if shift is None else shift.copy()
                shift[system.multipliers] += 1
            coupled = system.multipliers[: 0 if system.alone else None]
            self.petsc.SetContacts(system.contacts, coupled, system.scale, shift)
            self._entries = entries


class PetscMethod(Method):
    """One of the ways of a PetscSystem, see Method."""

    def __init__(self, taken: Taken, name: str, most: float = np.inf):
        self._taken, self._name, self._most = taken, name, most
        self.is_iteration, self.serves_alone = name == "iterative", name == "direct"

    def __str__(self) -> str:
        return f"PETSc, {WAYS[self._name]}"

    @property
    def factorisations(self) -> int:
        """Of matrices of full size, so far."""
        return self._taken.petsc.factorisations if self._name == "direct" else 0

    @property
    def krylov(self) -> int:
        """Krylov iterations so far."""
        return self._taken.petsc.krylov if self._name == "iterative" else 0

    def Solve(self, system: LinearSystem, b: np.ndarray) -> tuple[np.ndarray, float]:
        """See Method."""
        if self._taken.petsc.numbering.size > self._most and not system.alone:
            raise LinearSolveError("the system is large")
        self._taken.Take(system)
        return self._taken.petsc.Solve(b, system.accuracy, self._name)

    def NewBulk(self) -> None:
        """The bulk matrix has got other values."""
        self._taken.NewBulk()


def PetscLinearSolver(
    contacts: Sequence[LACContact], freedofs: BitArray, wanted: str | None = None
) -> LinearSolver:
    """The LinearSolver of these contacts and free dofs with the methods of PETSc."""
    layout, nodes = contacts[0].layout, Nodes.Of(contacts[0], freedofs)
    traces = [TraceOf(contact.form) for contact in contacts]
    dim = nodes.blocks.shape[1]
    free = np.count_nonzero(layout.Of(AsNumPy(freedofs)))
    why = f"{free} free dofs in {dim}D" if wanted is None else "as asked for"
    if wanted is None:
        coarse = layout.together.Sum(np.count_nonzero(nodes.vertices))
        wanted = "iterative" if coarse and IsLarge(free, dim, "petsc") else "direct"
    petsc = PetscSystem(layout, traces, AsNumPy(freedofs), nodes)
    names = dict.fromkeys((wanted, "direct"))
    taken, most = Taken(petsc), np.inf if wanted == "direct" else MOST_DIRECT

    methods = (PetscMethod(taken, n, most if n == "direct" else np.inf) for n in names)
    links = [Link(*link, why) for link in zip(names, methods, strict=True)]
    return LinearSolver(freedofs, links)


def LinearSolverFor(
    a: BilinearForm, contacts: Sequence[LACContact], freedofs: BitArray, options: Options
) -> LinearSolver:
    """The LinearSolver of a bulk form on free scalar dofs."""
    mesh, wanted = a.space.mesh, options.solver
    WarnOfCopies(mesh)
    if mesh.comm.size == 1 and wanted != "petsc":
        return MakeLinearSolver(a, contacts, freedofs, options, partial(MotionsOf, contacts[0]))
    for name in ("inverse", "preconditioner"):
        if getattr(options, name) is not None and mesh.comm.size > 1:
            raise ValueError(f"{name}= is not known on a distributed mesh: leave it out")
        if getattr(options, name) is not None:
            raise ValueError(f"{name}= does not go with solver='petsc': leave it out")
    if wanted not in (None, "petsc", "direct", "iterative"):
        raise ValueError(
            f"solver={wanted!r} is for one process: on a distributed mesh leave it out, or "
            "take 'direct' or 'iterative', both on PETSc"
        )
    return PetscLinearSolver(contacts, freedofs, None if wanted == "petsc" else wanted)
