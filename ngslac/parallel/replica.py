# SPDX-License-Identifier: LGPL-2.1-or-later
"""The whole mesh and its spaces on the conductor, and the dofs of each process among theirs."""

import numpy as np
from ngsolve import FESpace, ProductSpace, Region

from ngslac._ngslac import ElementDofs, LACSpace, PieceOf, WholeMesh
from ngslac.arrays import AsBits, AsNumPy

__all__ = ["MeshReplica", "SpaceReplica"]


class MeshReplica:
    """A distributed mesh on the conductor, in the numbers that it has in one process.

    All processes make it at once, in the middle of a call of the crew.
    """

    def __init__(self, mesh, crew):
        self.original, self.crew, self.mesh = mesh, crew, None  # until it is gathered
        crew.tasks |= {"piece": self._Piece, "order": self._Order}

    def _Piece(self):
        return (*PieceOf(self.original), self._Order())

    def _Order(self):
        """That of curved elements of the own part, which has to be as it was distributed."""
        if self.original.deformation is not None:
            raise ValueError(
                "the distributed mesh has a deformation: call mesh.UnsetDeformation(), or Curve it"
            )
        if self.original.levels > 1:
            raise ValueError(
                "the mesh was refined after its distribution, which tears it: refine it before, "
                "see ngslac.meshes.Distributed"
            )
        return self.original.GetCurveOrder()

    def Gather(self):
        """Make the replica; the conductor only."""
        if self.mesh is not None:
            return self.mesh
        *pieces, orders = zip(*self.crew.Order("piece", own=self._Piece), strict=True)
        mesh = WholeMesh(self.original, tuple(map(np.concatenate, pieces)))
        self._Curve(mesh, max(orders))
        _, _, volumes, surfaces, _, segments, _ = pieces
        tables = (volumes, surfaces) if mesh.dim == 3 else (surfaces, segments)
        # Numbers of the volume and boundary elements of each worker.
        self.elements, self.faces = (Places(table[1:]) for table in tables)
        self.mesh = mesh
        return mesh

    def _Curve(self, mesh, order):
        if mesh.GetCurveOrder() != order:
            mesh.Curve(order)

    def Follow(self):
        """See to it that the replica is as the distributed mesh is now; the conductor only."""
        if self.mesh is not None:  # the conductor has nothing to curve, and does not know
            self._Curve(self.mesh, max(self.crew.Order("order", own=self._Order)))

    def Region(self, original):
        """What a region of the distributed mesh is on the replica."""
        return Region(self.mesh, original.VB(), original.Mask())


def Places(tables):
    """Places of rows of several tables in the order of their numbers: a list of (n,) int."""
    numbers = [table[:, 0] for table in tables]
    known = np.unique(np.concatenate(numbers))
    return [np.searchsorted(known, part) for part in numbers]


class SpaceReplica:
    """A space on a distributed mesh, and the same on its replica."""

    def __init__(self, original, mesh, parts=()):
        self.original, self.mesh, self.parts = original, mesh, parts
        # On a worker the number of each of its scalar dofs in the replica, -1: none; on the
        # conductor those of all workers, and of what it has itself: multipliers.
        self.space = self.dofs = None
        self.own, self.multipliers = np.empty(0, dtype=int), None  # number, if a LACSpace
        self._places = None

    def Make(self, crew, number):
        """The replica; the conductor only. `number` is that by which workers know this one."""
        if self.space is not None:
            return self.space
        mesh = self.mesh.Gather()
        if self.parts:
            self.space = FESpace([part.space for part in self.parts])
        else:
            self.space = CopyOf(self.original, mesh)
        each = None if self.parts else DofsByElements(self.space, self.mesh.elements)
        starts = [self.space.Range(k).start for k in range(len(self.parts))]
        own = [p.own + self.space.dim * k for p, k in zip(self.parts, starts, strict=True)]
        self.own = np.concatenate([self.own, *own])
        each = each or [starts] * len(crew.workers)
        _, *self.dofs = crew.Order("dofs", number, each=each)
        self.TakeFree(crew, number)
        return self.space

    # --- values on the conductor ---------------------------------------------------------------

    def Split(self, values):
        """For each worker the part of values (n,) that belongs to its dofs, 0 elsewhere."""
        parts = [np.zeros(len(dofs)) for dofs in self.dofs]
        for part, (own, numbers) in zip(parts, self._Places(), strict=True):
            part[own] = values[numbers]
        return parts

    def Put(self, parts, values):
        """Write parts of workers, which have the same at shared dofs, into values (n,); or None."""
        for part, (own, numbers) in zip(parts, self._Places(), strict=True):
            if part is not None:
                values[numbers] = part[own]

    def Add(self, parts, values):
        """Add parts of workers to values (n,)."""
        for part, (own, numbers) in zip(parts, self._Places(), strict=True):
            values[numbers] += part[own]  # each is there once

    def _Places(self):
        """For each worker the dofs that are in the replica, and their numbers there."""
        if self._places is None:
            known = [dofs >= 0 for dofs in self.dofs]
            self._places = [
                (slice(None) if np.all(yes) else np.flatnonzero(yes), dofs[yes])
                for yes, dofs in zip(known, self.dofs, strict=True)
            ]
        return self._places

    # --- dofs ----------------------------------------------------------------------------------

    def TakeFree(self, crew, number):
        """Let the same dofs be free as on the workers, where users may have changed them."""
        _, *found = crew.Order("free", number)
        for coupling in (False, True):
            self._SetFree(self.space.FreeDofs(coupling), [own[coupling] for own in found])

    def _SetFree(self, bits, found):
        free, d = AsNumPy(bits), self.space.dim
        for dofs, own in zip(self.dofs, found, strict=True):
            inside = dofs[::d] >= 0
            free[dofs[::d][inside] // d] = own[inside]
        bits.Clear()
        bits |= AsBits(free)

    def LearnDofs(self, told):
        """On a worker: its dofs, from starts of components or from those of its elements."""
        d = self.original.dim
        if self.parts:
            places = [
                np.where(part.dofs >= 0, part.dofs + d * start, -1)
                for part, start in zip(self.parts, told, strict=True)
            ]
            self.dofs = np.concatenate(places)
            return self.dofs
        counts, dofs = ElementDofs(self.original)
        if not np.array_equal(counts, told[0]):
            raise ValueError(
                f"a space of type {self.original.type} is not known on a distributed mesh: its "
                "copy on the whole mesh has other dofs"
            )
        numbers = np.full(self.original.ndof, -1)
        used = (dofs >= 0) & (told[1] >= 0)
        numbers[dofs[used]] = told[1][used]
        self.dofs = Scalars(numbers, d)
        return self.dofs

    @property
    def displacements(self):
        """On a worker: `dofs`, but -1 for multipliers, which the conductor alone has."""
        if self.multipliers is not None:
            return np.full(len(self.dofs), -1)
        if not self.parts:
            return self.dofs
        apart = np.concatenate([part.displacements for part in self.parts]) < 0
        return np.where(apart, -1, self.dofs)

    def Free(self):
        """On a worker: which of its dofs are free, all and without condensed ones."""
        return AsNumPy(self.original.FreeDofs()), AsNumPy(self.original.FreeDofs(True))

    @classmethod
    def OfMultipliers(cls, original, mesh, space):
        """A LACSpace, of which all processes have all dofs."""
        replica = cls(original, mesh)
        replica.space = space
        replica.multipliers = original.number
        replica.dofs = replica.own = np.arange(original.ndof * original.dim)
        if space is not None:
            replica.dofs = [replica.dofs] * len(mesh.crew.workers)
        return replica


def Scalars(numbers, d):
    """Numbers (n,) of blocks as those of their d scalars (n * d,)."""
    scalars = d * numbers[:, None] + np.arange(d)
    return np.where(numbers[:, None] < 0, -1, scalars).ravel()


def CopyOf(space, mesh):
    """The same kind of space on another mesh."""
    if isinstance(space, LACSpace) or type(space) is ProductSpace:
        raise ValueError(f"a {type(space).__name__} is not known on a distributed mesh here")
    state = space.__getstate__()
    if len(state) != 3:  # one that another space is in
        raise ValueError(
            f"a {type(space).__name__} space ({space.type}) is not known on a distributed mesh: "
            "take the space in it"
        )
    kind, _, flags = state
    copy = FESpace.__new__(FESpace)
    copy.__setstate__((kind, mesh, flags))
    return copy


def DofsByElements(space, elements):
    """For each of several lists of elements: counts of their dofs, and these."""
    counts, dofs = ElementDofs(space)
    starts = np.cumsum(counts) - counts
    found = []
    for own in elements:
        many = counts[own]
        first = np.repeat(starts[own] - (np.cumsum(many) - many), many)
        found.append((many, dofs[first + np.arange(len(first))]))
    return found
