# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which process owns which row, and its number there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from ngslac.arrays import ToCSR
from ngslac.petsc.library import LoadPETSc

if TYPE_CHECKING:
    from ngsolve import BaseMatrix
    from petsc4py import PETSc
    from scipy.sparse import coo_matrix

    from ngslac.parallel.form import WholeTrace
    from ngslac.parallel.layout import Layout, Whole
    from ngslac.parallel.skin import Trace
    from ngslac.petsc.nodes import Nodes

__all__ = ["Numbering", "Surfaces"]


class Numbering:
    """Rows of PETSc's matrices: blocks of nodes, those of each process one after the other.

    Collective, as all methods are.

    Attributes
    ----------
    rows : (n,) int
        Of the dofs of this process.
    surfaces : Surfaces
    free : (n,) bool
    held : (stop - start,) float
        1 in this process's rows of no free dof, else 0.
    """

    def __init__(
        self,
        layout: Layout | Whole,
        traces: Sequence[Trace | WholeTrace],
        nodes: Nodes,
        free: np.ndarray,
    ):
        PETSc = LoadPETSc()
        self.layout, self.together = layout, layout.together
        self.comm = getattr(self.together, "comm", PETSc.COMM_SELF)
        self.rank, self.free = self.together.rank, np.asarray(free)
        owned, blocks = np.asarray(layout.owned), nodes.blocks
        self.width, self._blocks = blocks.shape[1], owned[blocks[:, 0]]
        counts = self.together.Gather(int(np.sum(self._blocks)))
        starts = self.width * np.concatenate([[0], np.cumsum(counts)])
        # All rows, those of dofs and what fills up the blocks; this process's.
        self.size, self.start, self.stop = int(starts[-1]), *map(int, starts[self.rank :][:2])
        own, rows = blocks[self._blocks], np.zeros(len(owned))
        numbers = self.start + np.arange(own.size).reshape(own.shape)
        rows[own[own >= 0]] = numbers[own >= 0]
        self.rows = np.round(np.asarray(layout.Consistent(rows))).astype(int)
        self._own = np.flatnonzero(owned)
        self.surfaces = Surfaces(traces, self.rows)
        vec, index = self.Vector(), self.rows.astype(PETSc.IntType)
        index = PETSc.IS().createGeneral(index, comm=PETSc.COMM_SELF)
        self._local = PETSc.Vec().createSeq(len(self.rows), comm=PETSc.COMM_SELF)
        self._scatter = PETSc.Scatter().create(vec, index, self._local, None)
        self.held = self.Put(1.0 - self.free, fill=1.0).array.copy()

    @property
    def sizes(self) -> tuple[tuple[int, int], tuple[int, int]]:
        """Of a square matrix: local and global ones."""
        return ((self.stop - self.start, self.size),) * 2

    def Vector(self) -> PETSc.Vec:
        """A vector of zeros."""
        vec = LoadPETSc().Vec().create(self.comm)
        vec.setSizes(self.sizes[0], bsize=self.width)
        vec.setType("standard")
        return vec

    def CleanUp(self) -> None:
        """Let PETSc free objects that Python has dropped; PETSc waits until all processes ask."""
        PETSc = LoadPETSc()
        for comm in (PETSc.COMM_SELF, self.comm):
            PETSc.garbage_cleanup(comm)

    def Tell(self, found: Any) -> Any:
        """Send the result of the first process to all."""
        return self.together.Tell(found)

    def Total(self, values: np.ndarray) -> np.ndarray:
        """The sum of an array over all processes."""
        return self.together.Sum(values)

    def Put(self, values: np.ndarray, fill: float = 0.0) -> PETSc.Vec:
        """A vector of values (n,), and `fill` in rows that have no dof."""
        vec = self.Vector()
        array = np.full(self.stop - self.start, fill)
        array[self.rows[self._own] - self.start] = np.asarray(values)[self._own]
        vec.array[:] = array
        return vec

    def Nodes(self, which: np.ndarray) -> np.ndarray:
        """Which of this process's rows are those of nodes (k,) bool of its own."""
        return np.repeat(np.asarray(which)[self._blocks], self.width)

    def Get(self, vec: PETSc.Vec) -> np.ndarray:
        """The values (n,) of a vector."""
        self._scatter.scatter(vec, self._local)
        return self.layout.Of(self._local.array.copy())


class Surfaces:
    """The rows of PETSc's matrices on the surfaces of all contacts, which all processes know.

    Attributes
    ----------
    rows : (k,) int
    """

    def __init__(self, traces: Sequence[Trace | WholeTrace], rows: np.ndarray):
        self._traces = traces
        found = [np.round(trace.Gather(1.0 + rows)).astype(int) - 1 for trace in traces]
        every = np.unique(np.concatenate(found))
        self.rows = every[every >= 0]  # others have no dofs
        self._places = [np.where(part < 0, -1, np.searchsorted(self.rows, part)) for part in found]

    def Gather(self, values: np.ndarray) -> np.ndarray:
        """Those of values (n,) of this process that are on the surfaces (k,), of all processes."""
        found = np.zeros(len(self.rows))
        for trace, places in zip(self._traces, self._places, strict=True):
            found[places[places >= 0]] = trace.Gather(values)[places >= 0]
        return found

    def Rows(self, chosen: np.ndarray, total: np.ndarray) -> None:
        """Set the rows (n,) bool of this process that are among those chosen (k,) bool."""
        for trace, places in zip(self._traces, self._places, strict=True):
            own = trace.Zeros()
            trace.Put(1.0 * ((places >= 0) & chosen[places]), own)
            total |= np.asarray(own) > 0

    def Sum(self, mats: Sequence[BaseMatrix]) -> coo_matrix:
        """The sum (k, k) of a matrix for each contact, as scipy matrix."""
        shape, total = (len(self.rows),) * 2, 0
        for mat, trace, places in zip(mats, self._traces, self._places, strict=False):
            part = ToCSR(trace.Matrix(mat)).tocoo()
            where = places[part.row], places[part.col]
            total = total + scipy.sparse.coo_matrix((part.data, where), shape=shape)
        return scipy.sparse.coo_matrix(shape) if isinstance(total, int) else total.tocoo()
