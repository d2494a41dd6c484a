# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which rows of a vector belong to which process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import BaseMatrix, BaseVector, FESpace, GridFunction, ProductSpace
from ngsolve.la import PARALLEL_STATUS

from ngslac._ngslac import LACSpace
from ngslac.arrays import AsNumPy, ToCSR
from ngslac.parallel.spread import Spread
from ngslac.parallel.together import ALONE, Recall, Together

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

__all__ = ["LayoutOf"]


class Whole:
    """The rows of a space in one process: vectors are NumPy's arrays."""

    together = ALONE

    def __init__(self, space: FESpace):
        self.space = space

    @property
    def owned(self) -> np.ndarray:
        """The rows (n,) bool that count for this process: all of them."""
        return np.ones(self.space.ndof * self.space.dim, dtype=bool)

    @property
    def multipliers(self) -> np.ndarray:
        """The rows (n,) bool of multipliers."""
        return IsMultiplier(self.space)

    def Zeros(self) -> np.ndarray:
        """A new array of zeros (n,)."""
        return np.zeros(self.space.ndof * self.space.dim)

    def Of(self, values: np.ndarray) -> np.ndarray:
        """Return the array (n,) of rows of the space."""
        return values

    def Values(self, vec: BaseVector) -> np.ndarray:
        """Return the entries of a vector of NGSolve, which may be written to."""
        return vec.FV().NumPy()

    def Apply(self, form: Any, x: BaseVector, y: BaseVector) -> None:
        """Apply a form: y = form(x)."""
        form.Apply(x, y)

    def Consistent(self, values: np.ndarray) -> np.ndarray:
        """Return values (n,) that each process has computed, as those of the owners."""
        return values

    def Added(self, values: np.ndarray) -> np.ndarray:
        """Add up values (n,) that processes have computed from their elements."""
        return values

    def Everywhere(self, rows: np.ndarray) -> np.ndarray:
        """Return the rows (n,) bool that some process has found for its elements."""
        return rows

    def Local(self, mat: BaseMatrix) -> BaseMatrix:
        """The part of a sparse matrix that belongs to the elements of this process."""
        return mat

    def Works(self, columns: csr_matrix, forces: np.ndarray) -> np.ndarray:
        """The products (k,) of sparse columns (n, k) with forces (n,)."""
        return columns.T @ forces

    def Diagonal(self, mat: BaseMatrix) -> np.ndarray:
        """Return the diagonal (n,) of a sparse matrix."""
        return ToCSR(mat).diagonal()


class Layout:
    """The rows (n,) of a space on a distributed mesh that this process knows.

    Those of displacements belong to one of the processes that know them; multipliers, which all
    know, to the first one.
    """

    def __init__(self, space: FESpace):
        self.space, self.together = space, Together.Of(space.mesh)
        self.owned = Owned(space, self.together.rank)
        self.multipliers = IsMultiplier(space)
        self._vec = GridFunction(space).vec

    def Of(self, values: np.ndarray) -> np.ndarray:
        """Make an array of rows of the space one of all processes."""
        return Spread.Of(values, self.owned, self.together)

    def Values(self, vec: BaseVector) -> np.ndarray:
        """Return the entries of a vector, which may be written to; shared ones are the same."""
        if vec.GetParallelStatus() == PARALLEL_STATUS.DISTRIBUTED:
            vec.Cumulate()
        vec.SetParallelStatus(PARALLEL_STATUS.CUMULATED)
        return self.Of(vec.FV().NumPy())

    def Apply(self, form: Any, x: BaseVector, y: BaseVector) -> None:
        """Apply a form: y = form(x); an error on one process is raised on all."""
        self.Values(x)
        self.together.Agree(lambda: form.Apply(x, y), Exception)
        self.Values(y)

    def Consistent(self, values: np.ndarray) -> np.ndarray:
        """Return values (n,) that each process has computed, as those of the owners."""
        found = self.Added(np.where(self.owned, values, 0.0))
        if np.any(self.multipliers):
            found[self.multipliers] = self.together.Tell(np.asarray(found)[self.multipliers])
        return found

    def Added(self, values: np.ndarray) -> np.ndarray:
        """Add up values (n,) that processes have computed from their elements."""
        self._vec.FV().NumPy()[:] = values
        self._vec.SetParallelStatus(PARALLEL_STATUS.DISTRIBUTED)
        self._vec.Cumulate()
        return self.Of(self._vec.FV().NumPy().copy())

    def Everywhere(self, rows: np.ndarray) -> np.ndarray:
        """Return the rows (n,) bool that some process has found for its elements."""
        return self.Added(np.asarray(rows).astype(float)) > 0

    def Zeros(self) -> np.ndarray:
        """A new array of zeros (n,)."""
        return self.Of(np.zeros(len(self.owned)))

    def Works(self, columns: csr_matrix, forces: np.ndarray) -> np.ndarray:
        """The products (k,) of sparse columns (n, k) with forces (n,)."""
        return self.together.Sum(columns[self.owned].T @ np.asarray(forces)[self.owned])

    def Local(self, mat: BaseMatrix) -> BaseMatrix:
        """The part of a sparse matrix that belongs to the elements of this process."""
        return getattr(mat, "local_mat", mat)

    def Diagonal(self, mat: BaseMatrix) -> np.ndarray:
        """Return the diagonal (n,) of a sparse matrix."""
        return self.Added(ToCSR(self.Local(mat)).diagonal())


def LayoutOf(space: FESpace) -> Layout | Whole:
    """The layout of a space: Whole in one process, otherwise Layout."""
    mesh = space.mesh
    if mesh.comm.size == 1:
        return Whole(space)
    known = Together.Of(mesh).layouts
    return Recall(known, lambda layout: layout.space == space, lambda: Layout(space))


def Owned(space: FESpace, rank: int) -> np.ndarray:
    """Which rows (n,) bool of a space count for this process."""
    if type(space) is ProductSpace:
        return np.concatenate([Owned(part, rank) for part in space.components])
    n = space.ndof * space.dim
    if isinstance(space, LACSpace):
        return np.full(n, rank == 0)
    if not n:
        return np.zeros(0, dtype=bool)
    return AsNumPy(space.ParallelDofs().MasterDofs()).repeat(space.dim)


def IsMultiplier(space: FESpace) -> np.ndarray:
    """Which rows (n,) bool belong to multipliers, which all processes have."""
    if type(space) is ProductSpace:
        return np.concatenate([IsMultiplier(part) for part in space.components])
    return np.full(space.ndof * space.dim, isinstance(space, LACSpace))
