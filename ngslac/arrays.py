# SPDX-License-Identifier: LGPL-2.1-or-later
"""Dofs and products of matrices as numpy arrays of scalar entries."""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch
from typing import TYPE_CHECKING

import numpy as np
import scipy
from netgen.meshing import NgException
from ngsolve import BaseMatrix, BaseVector, BitArray, FESpace
from ngsolve.la import PARALLEL_STATUS, SparseMatrixd

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix, spmatrix

__all__ = [
    "AddToDiagonal",
    "AsBits",
    "AsNumPy",
    "ComponentsOf",
    "Exported",
    "Like",
    "Multiply",
    "Product",
    "SameEntries",
    "SameMatrix",
    "ScalarDofs",
    "Sparse",
    "ToCSR",
]


def Multiply(mats: Sequence[BaseMatrix], values: np.ndarray) -> np.ndarray:
    """The sum of sparse matrices times a vector, as numpy arrays of scalar entries."""
    return sum(Product(mat, values) for mat in mats)


@singledispatch
def Product(mat: BaseMatrix, values: np.ndarray) -> np.ndarray:
    """A matrix times a vector, see `Multiply`."""
    factor, product = mat.CreateRowVector(), mat.CreateColVector()
    factor.FV().NumPy()[:] = values
    factor.SetParallelStatus(PARALLEL_STATUS.CUMULATED)
    product.data = mat * factor
    product.Cumulate()
    return Like(values, product.FV().NumPy().copy())


@singledispatch
def Sparse(mat: SparseMatrixd) -> csr_matrix:
    """A copy of a sparse matrix that knows sums, differences, sizes and products with arrays."""
    return ToCSR(mat)


def Like(values: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Other values by the rows of an array, which may be one of many processes."""
    return values.Like(others) if hasattr(values, "Like") else others


def AsNumPy(bits: BitArray) -> np.ndarray:
    """A BitArray as numpy array of bool."""
    vec = BaseVector(len(bits))
    vec[:] = 0
    vec[bits] = 1  # far faster than a loop over the bits
    return vec.FV().NumPy() != 0


def AsBits(values: np.ndarray) -> BitArray:
    """A numpy array of bool as BitArray."""
    return BitArray(np.asarray(values, dtype=bool).tolist())


def ScalarDofs(dofs: BitArray, space: FESpace) -> BitArray:
    """The scalar entries that belong to dofs of a space with blocks."""
    if space.dim == 1:
        return dofs
    return AsBits(AsNumPy(dofs).repeat(space.dim))


def ComponentsOf(space: FESpace) -> list[FESpace]:
    """The components of a space; of one that has none nothing."""
    try:
        return space.components
    except NgException:
        return []


def AddToDiagonal(mat: SparseMatrixd, values: np.ndarray) -> None:
    """Add to the diagonal of a sparse matrix, which has to be in its graph."""
    entries, columns, starts = mat.CSR()
    rows = np.repeat(np.arange(mat.height), np.diff(np.asarray(starts).astype(int)))
    where = np.flatnonzero(rows == np.asarray(columns))
    np.asarray(entries)[where] += values[rows[where]]


def Exported(mat: spmatrix) -> SparseMatrixd:
    """A scipy matrix as one of NGSolve, also with its zeros."""
    entries = mat.tocoo()
    places = (places.astype(np.int32) for places in (entries.row, entries.col))
    return SparseMatrixd.CreateFromCOO(*places, entries.data, *mat.shape)


def SameMatrix(one: spmatrix, other: spmatrix) -> bool:
    """Are two sparse matrices the same?"""
    return one.shape == other.shape and (one != other).nnz == 0


def SameEntries(
    ones: Sequence[Sequence[np.ndarray]], others: Sequence[Sequence[np.ndarray]]
) -> bool:
    """Are two lists of the arrays of matrices the same?"""
    return len(ones) == len(others) and all(
        np.array_equal(*pair)
        for one, other in zip(ones, others, strict=True)
        for pair in zip(one, other, strict=True)
    )


def ToCSR(mat: BaseMatrix) -> csr_matrix:
    """A sparse NGSolve matrix with scalar or square block entries as scipy matrix."""
    block = mat.entrysizes[0]
    # CSR() shows memory of the matrix: copy, the matrix may be a temporary.
    values, columns, starts = (np.array(a) for a in mat.CSR())
    if block == 1:
        return scipy.sparse.csr_matrix((values, columns, starts), shape=mat.shape)
    shape = block * mat.height, block * mat.width
    return scipy.sparse.bsr_matrix(
        (values.reshape(-1, block, block), columns, starts), shape=shape
    ).tocsr()
