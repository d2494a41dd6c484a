# SPDX-License-Identifier: LGPL-2.1-or-later
"""Matrices of PETSc from what each rank has."""

import numpy as np
import scipy

from ngslac.petsc.library import LoadPETSc

__all__ = ["Assembled", "Sum"]


def Assembled(numbering, part, rows, diagonal=None):
    """The sum over all ranks of square parts; collective."""
    PETSc = LoadPETSc()
    if part is None:
        part, rows = scipy.sparse.csr_matrix((0, 0)), []
    rows = np.asarray(rows, dtype=np.int64)
    if diagonal is not None:
        part, rows = WithDiagonal(part, rows, numbering.start + np.arange(len(diagonal)), diagonal)
    local = PETSc.Mat().createAIJ(part.shape, csr=CSR(part), comm=PETSc.COMM_SELF)
    mapping = PETSc.LGMap().create(rows.astype(PETSc.IntType), comm=numbering.comm)
    mat = PETSc.Mat().createIS(numbering.sizes, lgmapr=mapping, lgmapc=mapping, comm=numbering.comm)
    mat.setISLocalMat(local)
    mat.assemble()
    mat.convert("aij")
    mat.setBlockSize(numbering.width)
    return mat


def CSR(part):
    """Starts, columns and values as PETSc wants them."""
    PETSc = LoadPETSc()
    part.sort_indices()
    return (
        part.indptr.astype(PETSc.IntType),
        part.indices.astype(PETSc.IntType),
        part.data.astype(PETSc.ScalarType),
    )


def WithDiagonal(part, rows, own, diagonal):
    """A part and its rows, with a diagonal on rows `own`."""
    every = np.union1d(rows, own)
    at, on = np.searchsorted(every, rows), np.searchsorted(every, own)
    part = part.tocoo()
    row = np.concatenate([at[part.row], on])
    column = np.concatenate([at[part.col], on])
    values = np.concatenate([part.data, diagonal])
    return scipy.sparse.csr_matrix((values, (row, column)), shape=(len(every),) * 2), every


def Sum(mat, other):
    """A new matrix."""
    total = mat.copy()
    total.axpy(1.0, other, structure=LoadPETSc().Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    return total
