# SPDX-License-Identifier: LGPL-2.1-or-later
"""The solver of the linear systems of a ContactSolver: PETSc, or the chain of methods."""

from functools import partial, singledispatch

import numpy as np

from ngslac.arrays import AsNumPy, SameEntries
from ngslac.bodies.rigidmotions import MotionsOf
from ngslac.distributable import WarnOfCopies
from ngslac.errors import LinearSolveError
from ngslac.linear.chain import IsLarge, MakeLinearSolver
from ngslac.linear.solver import LinearSolver
from ngslac.linear.system import Link, Method
from ngslac.petsc.nodes import Nodes
from ngslac.petsc.system import PetscSystem

__all__ = ["LinearSolverFor", "PetscLinearSolver"]

# Up to this many factors may take over where the iteration fails: in 3D they need 20 GB by then.
MOST_DIRECT = 1_000_000
WAYS = {"iterative": "FGMRES with multigrid", "direct": "factors of MUMPS"}


class Alone:
    """The team of one process."""

    def __init__(self, system):
        self._system = system

    def Call(self, name, *args):
        """Call a method of the PetscSystem."""
        return getattr(self._system, name)(*args)

    def Get(self, name):
        """An attribute of the PetscSystem on rank 0."""
        return getattr(self._system, name)


class Taken:
    """The matrices that a team has, those of the last LinearSystem."""

    def __init__(self, team):
        self.team = team
        self.NewBulk()

    def NewBulk(self):
        """The bulk matrix has got other values."""
        self._bulk = self._entries = None

    def Take(self, system):
        """Set what is not the same as for the last system."""
        if self._bulk is not system.mat:
            self.NewBulk()
            self.team.Call("SetBulk", system.mat)
            self._bulk = system.mat
        entries = system.Entries()
        if self._entries is None or not SameEntries(entries, self._entries):
            self._entries, shift = None, system.shift
            if system.alone:  # the multipliers get a diagonal of their own
                shift = np.zeros(len(system.rhs)) if shift is None else shift.copy()
                shift[system.multipliers] += 1
            coupled = system.multipliers[: 0 if system.alone else None]
            self.team.Call("SetContacts", system.contacts, coupled, system.scale, shift)
            self._entries = entries


class PetscMethod(Method):
    """One of the ways of a PetscSystem, see Method."""

    def __init__(self, taken, name, most=np.inf):
        self._taken, self._name, self._most = taken, name, most
        self.is_iteration, self.serves_alone = name == "iterative", name == "direct"

    def __str__(self):
        return f"PETSc, {WAYS[self._name]}"

    @property
    def factorisations(self):
        """Of matrices of full size, so far."""
        return self._taken.team.Get("factorisations") if self._name == "direct" else 0

    @property
    def krylov(self):
        """Krylov iterations so far."""
        return self._taken.team.Get("krylov") if self._name == "iterative" else 0

    def Solve(self, system, b):
        """See Method."""
        if len(b) > self._most and not system.alone:
            raise LinearSolveError("the system is large")
        self._taken.Take(system)
        return self._taken.team.Call("Solve", b, system.accuracy, self._name)

    def NewBulk(self):
        """The bulk matrix has got other values."""
        self._taken.NewBulk()


def PetscLinearSolver(team, freedofs, nodes, wanted=None):
    """The LinearSolver of these Nodes and free dofs, with the methods of a team."""
    free, dim = freedofs.NumSet(), nodes.blocks.shape[1]
    why = f"{free} free dofs in {dim}D" if wanted is None else "as asked for"
    if wanted is None:
        large = np.any(nodes.vertices) and IsLarge(free, dim, "petsc")
        wanted = "iterative" if large else "direct"
    names = dict.fromkeys((wanted, "direct"))
    taken, most = Taken(team), np.inf if wanted == "direct" else MOST_DIRECT

    methods = (PetscMethod(taken, n, most if n == "direct" else np.inf) for n in names)
    links = [Link(*link, why) for link in zip(names, methods, strict=True)]
    return LinearSolver(freedofs, links)


@singledispatch
def LinearSolverFor(a, contacts, freedofs, options):
    """The LinearSolver of a bulk form on free scalar dofs; the parallel room has its own."""
    WarnOfCopies(a.space.mesh)
    if options.solver == "petsc":
        return SerialPetsc(contacts[0], freedofs, options)
    return MakeLinearSolver(a, contacts, freedofs, options, partial(MotionsOf, contacts[0]))


def SerialPetsc(contact, freedofs, options):
    """The LinearSolver for this process alone."""
    for name in ("inverse", "preconditioner"):
        if getattr(options, name) is not None:
            raise ValueError(f"{name}= does not go with solver='petsc': leave it out")
    free, nodes = AsNumPy(freedofs), Nodes.Of(contact, freedofs)
    system = PetscSystem(None, len(free), np.arange(len(free)), free, nodes)
    return PetscLinearSolver(Alone(system), freedofs, nodes)
