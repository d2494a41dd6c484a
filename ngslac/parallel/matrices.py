# SPDX-License-Identifier: LGPL-2.1-or-later
"""Matrices of contact on the skin with the rows and columns of a distributed space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import scipy
from netgen.meshing import NgException

from ngslac.arrays import Product, Sparse, ToCSR

if TYPE_CHECKING:
    from ngsolve import BaseMatrix
    from scipy.sparse import coo_matrix, csr_matrix, spmatrix

    from ngslac.parallel.form import SkinForm
    from ngslac.parallel.skin import Trace

__all__ = ["Entries", "SkinMatrix", "SkinRows", "Stacked"]


class SkinMatrix:
    """A matrix of contact on the skin, with the rows and columns of the distributed space."""

    def __init__(self, mat: BaseMatrix | None, form: SkinForm):
        if mat is None:
            raise NgException("the contact has no matrix yet")
        self.there, self.trace, self.layout = mat, form.trace, form.layout
        self.height = self.width = form.fes.ndof * form.fes.dim if mat.height else 0

    def CSR(self) -> tuple:
        """Return the arrays of the matrix on the skin."""
        return self.there.CSR()

    def Times(self, values: np.ndarray) -> np.ndarray:
        """Multiply by an array (n,)."""
        factor, product = self.there.CreateRowVector(), self.there.CreateColVector()
        factor.FV().NumPy()[:] = self.trace.Gather(values)
        product.data = self.there * factor
        return self.FromSkin(product.FV().NumPy())

    def FromSkin(self, values: np.ndarray) -> np.ndarray:
        """Extend values on the skin by 0 elsewhere (n,)."""
        found = self.layout.Zeros()
        self.trace.Put(values, found)
        return found


class SkinSparse:
    """A copy of a SkinMatrix, with some methods of SciPy's matrices."""

    def __init__(self, there: csr_matrix, mat: SkinMatrix):
        self.there, self.mat = there, mat

    def __add__(self, other: SkinSparse) -> SkinSparse:
        return SkinSparse(self.there + other.there, self.mat)

    def __sub__(self, other: SkinSparse) -> SkinSparse:
        return SkinSparse(self.there - other.there, self.mat)

    def __abs__(self) -> SkinSparse:
        return SkinSparse(abs(self.there), self.mat)

    def __matmul__(self, values: np.ndarray) -> np.ndarray:
        return self.mat.FromSkin(self.there @ self.mat.trace.Gather(values))


@Sparse.register
def _(mat: SkinMatrix) -> SkinSparse:
    return SkinSparse(ToCSR(mat.there), mat)


@Product.register
def _(mat: SkinMatrix, values: np.ndarray) -> np.ndarray:
    return mat.Times(values)


class SkinRows:
    """Sparse rows whose columns are those of a distributed space, kept on the skin."""

    def __init__(self, there: spmatrix, trace: Trace):
        self.there, self.trace = there.tocsr(), trace

    @property
    def shape(self) -> tuple[int, int]:
        """The number of all rows, and of the columns of this process."""
        return self.there.shape[0], self.trace.count

    def __getitem__(self, rows: np.ndarray | slice) -> SkinRows:
        return SkinRows(self.there[rows], self.trace)

    def __truediv__(self, number: float) -> SkinRows:
        return SkinRows(self.there / number, self.trace)

    def __matmul__(self, values: np.ndarray | spmatrix) -> np.ndarray | spmatrix:
        if scipy.sparse.issparse(values):
            return self.there @ self.trace.GatherSparse(values)
        return self.there @ self.trace.Gather(values)

    def __rmatmul__(self, mat: spmatrix) -> SkinRows:
        return SkinRows(mat @ self.there, self.trace)

    def Transposed(self, factors: np.ndarray) -> np.ndarray:
        """Multiply the transposed rows by factors (n,)."""
        found = self.trace.Zeros()
        self.trace.Put(self.there.T @ factors, found)
        return found


def Entries(rows: SkinRows | spmatrix, values: np.ndarray) -> tuple[coo_matrix, np.ndarray]:
    """Sparse rows as SciPy's entries, and values (n,) of their columns."""
    if isinstance(rows, SkinRows):
        return rows.there.tocoo(), rows.trace.Gather(values)
    return rows.tocoo(), values


def Stacked(rows: Sequence[SkinRows | spmatrix]) -> SkinRows | csr_matrix:
    """Put sparse rows one below the other."""
    if isinstance(rows[0], SkinRows):
        return SkinRows(scipy.sparse.vstack([part.there for part in rows]), rows[0].trace)
    return scipy.sparse.vstack(rows).tocsr()
