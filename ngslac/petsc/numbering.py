# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which rank owns which row, and its number there."""

import numpy as np

from ngslac.petsc.library import LoadPETSc

__all__ = ["Numbering"]


class Numbering:
    """Rows of PETSc's matrices: blocks of nodes, each rank's one after the other.

    A node belongs to the lowest rank that has one of its dofs, or else to rank 0. Rank 0 knows all
    dofs, every other rank its own ones. Collective, as all methods are.

    Attributes
    ----------
    new : (n,) int or None
        On rank 0: the row of each dof.
    rows : (k,) int
        Those of the free ones of this rank's dofs.
    used : (len(dofs),) bool
        Which of its dofs are free; -1 stands for none.
    held : (stop - start,) float
        1 in this rank's rows of no free dof, else 0.
    """

    def __init__(self, comm, n, dofs, nodes, free):
        PETSc = LoadPETSc()
        self._comm, self.comm = comm, PETSc.COMM_SELF if comm is None else comm
        self.rank, ranks = (0, 1) if comm is None else (comm.rank, comm.size)
        self.n, self.new, self._place, counts = n, None, None, None
        every = self._Gather(dofs)
        if self.rank == 0:
            owner = Owners(every, n, ranks)
            self.new, self._place, *counts = Rows(owner, nodes.blocks, ranks)
        # Blocks of each rank; rows of a block.
        counts, self.width = self.Tell(counts)
        starts = np.concatenate([[0], np.cumsum(counts)]) * self.width
        # All rows, those of dofs and what fills up the blocks; this rank's.
        self.size, self.start, self.stop = int(starts[-1]), *map(int, starts[self.rank :][:2])
        self.used, self.rows = self._Scatter(every, free)
        vec = self.Vector()
        self._scatter, self._all = PETSc.Scatter.toZero(vec)
        self.held = self.Put(None if free is None else 1.0 - free, vec, fill=1.0).array.copy()

    def _Gather(self, dofs):
        """The dofs of all ranks, on rank 0: messages of one rank each, which stay small."""
        if self.rank:
            self._comm.send(dofs, 0)
            return None
        others = range(1, 1 if self._comm is None else self._comm.size)
        return [dofs, *(self._comm.recv(source=rank) for rank in others)]

    def _Scatter(self, every, free):
        """Which of this rank's dofs are free, and the rows of these."""
        if self.rank:
            return self._comm.recv(source=0)
        for rank, dofs in enumerate(every[1:], start=1):
            self._comm.send(self._Own(dofs, free), rank)
        return self._Own(every[0], free)

    def _Own(self, dofs, free):
        used = dofs >= 0
        used[used] = free[dofs[used]]
        return used, self.new[dofs[used]]

    @property
    def sizes(self):
        """Of a square matrix: local and global ones."""
        return ((self.stop - self.start, self.size),) * 2

    def Vector(self):
        """A vector of zeros."""
        vec = LoadPETSc().Vec().create(self.comm)
        vec.setSizes(self.sizes[0], bsize=self.width)
        vec.setType("standard")
        return vec

    def CleanUp(self):
        """Let PETSc free what Python has let go: it waits for all ranks to say so."""
        PETSc = LoadPETSc()
        for comm in (PETSc.COMM_SELF, self.comm):
            PETSc.garbage_cleanup(comm)

    def Tell(self, found):
        """What rank 0 has found, on all ranks."""
        return found if self._comm is None else self._comm.bcast(found)

    def Total(self, values):
        """The sum of an array over all ranks."""
        if self._comm is None:
            return values
        total = np.empty_like(values)
        self._comm.Allreduce(values, total)
        return total

    def Columns(self, values):
        """A list of vectors of the columns of an array (n, m) that rank 0 has."""
        count = self.Tell(None if values is None else values.shape[1])
        columns = [None] * count if values is None else values.T
        return [self.Put(column, self.Vector()) for column in columns]

    def Put(self, values, vec, fill=0.0):
        """Make a vector of values (n,) that rank 0 has, and `fill` in rows that have no dof."""
        if self.rank == 0:
            full = np.full(self.size, fill)
            full[self.new] = values
            self._all.array[:] = full
        self._scatter.scatter(self._all, vec, mode="reverse")
        return vec

    def Rows(self, which):
        """Which of this rank's rows are those of nodes (k,) bool that rank 0 chooses."""
        vec = self.Vector()
        if self.rank == 0:
            full = self._all.array.reshape(-1, self.width)
            full[self._place] = which[:, None]
        self._scatter.scatter(self._all, vec, mode="reverse")
        return vec.array != 0

    def Get(self, vec):
        """The values (n,) of a vector on rank 0, None elsewhere."""
        self._scatter.scatter(vec, self._all)
        return self._all.array[self.new] if self.rank == 0 else None


def Owners(every, n, ranks):
    """The lowest of the ranks that have a dof in their list of dofs, for each of n; or else 0."""
    owner = np.zeros(n, dtype=np.int32)
    for rank in reversed(range(ranks)):
        owner[every[rank][every[rank] >= 0]] = rank
    return owner


def Rows(owner, blocks, ranks):
    """Row of each dof, place of each block; blocks of each rank, rows of a block."""
    k, width = blocks.shape
    of_block = np.where(blocks >= 0, owner[blocks], ranks).min(axis=1)
    order = np.argsort(of_block, kind="stable")
    place = np.empty(k, dtype=np.int64)
    place[order] = np.arange(k)
    rows = place[:, None] * width + np.arange(width)
    new = np.full(len(owner), -1, dtype=np.int32)
    new[blocks[blocks >= 0]] = rows[blocks >= 0]
    return new, place, np.bincount(of_block, minlength=ranks), width
