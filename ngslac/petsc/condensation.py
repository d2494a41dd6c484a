# SPDX-License-Identifier: LGPL-2.1-or-later
"""What contacts add to a system, on rank 0; the system without their multipliers, distributed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import scipy
from netgen.meshing import NgException

from ngslac._ngslac import Condensation
from ngslac.arrays import AsBits, Exported, ToCSR
from ngslac.errors import LinearSolveError
from ngslac.petsc.library import LoadPETSc

if TYPE_CHECKING:
    from petsc4py import PETSc
    from scipy.sparse import coo_matrix, csr_matrix, spmatrix

    from ngslac.petsc.numbering import Numbering

__all__ = ["CondensedSystem", "Contacts"]


class Contacts:
    """The sum of scaled contact matrices on free dofs of the surfaces.

    Attributes
    ----------
    touched : (n,) bool
        Displacements with entries.
    """

    def __init__(
        self, total: coo_matrix, multipliers: np.ndarray, scale: np.ndarray, free: np.ndarray
    ):
        n, self._multipliers = len(free), np.asarray(multipliers, dtype=int)
        kept = free[total.row] & free[total.col] & (total.data != 0)
        row, column = total.row[kept], total.col[kept]
        values = scale[row] * total.data[kept] * scale[column]
        self._mat = scipy.sparse.coo_matrix((values, (row, column)), shape=(n, n)).tocsr()
        self.ismultiplier = np.zeros(n, dtype=bool)
        self.ismultiplier[self._multipliers] = True
        self.touched = np.zeros(n, dtype=bool)
        self.touched[row] = self.touched[column] = True
        self.touched &= ~self.ismultiplier

    def All(self) -> tuple[csr_matrix, np.ndarray]:
        """The matrix on some dofs, and these."""
        return OnItsDofs(self._mat)

    def Condensed(self, dim: int) -> LocalContact:
        """The LocalContact."""
        return LocalContact(self._mat, self._multipliers, dim)

    def Sparse(self, condensed: LocalContact) -> tuple[csr_matrix, np.ndarray]:
        """What is added to the bulk in its place, on some dofs, and these."""
        mat = self._mat.tocoo()
        apart = ~(self.ismultiplier[mat.row] | self.ismultiplier[mat.col])
        where = mat.row[apart], mat.col[apart]
        stiffness = scipy.sparse.csr_matrix((mat.data[apart], where), shape=mat.shape)
        terms, dofs = condensed.terms.tocoo(), condensed.dofs
        where = dofs[terms.row], dofs[terms.col]
        terms = scipy.sparse.csr_matrix((terms.data, where), shape=mat.shape)
        diagonal = scipy.sparse.diags_array(1.0 * self.ismultiplier)
        return OnItsDofs(stiffness + terms + diagonal)


def OnItsDofs(mat: spmatrix) -> tuple[csr_matrix, np.ndarray]:
    """The part of a matrix that is not empty, and its dofs."""
    mat = mat.tocoo()
    dofs = np.union1d(mat.row[mat.data != 0], mat.col[mat.data != 0])
    mat = mat.tocsr()[dofs][:, dofs]
    return mat, dofs


class LocalContact:
    """The contacts of a system on the dofs they touch, on rank 0, without the bulk.

    Attributes
    ----------
    dofs : (k,) int
        Those touched by multipliers, and these.
    mat : (k, k) csr_matrix
    terms : (k, k) csr_matrix
        T, see Condensation, which is added to the bulk's K.
    islam : (k,) bool
        Which are multipliers; each has a unit row in what stands for the sum.
    system : Condensation
        Of the rows and columns of the multipliers alone.
    """

    def __init__(self, mat: csr_matrix, multipliers: np.ndarray, dim: int):
        ismultiplier = np.zeros(mat.shape[0], dtype=bool)
        ismultiplier[multipliers] = True
        mat = mat.tocoo()
        kept = ismultiplier[mat.row] | ismultiplier[mat.col]
        row, column, values = mat.row[kept], mat.col[kept], mat.data[kept]
        self.dofs = np.unique(np.concatenate([row, column, multipliers]))
        where = np.searchsorted(self.dofs, row), np.searchsorted(self.dofs, column)
        size = len(self.dofs)
        self.mat = scipy.sparse.coo_matrix((values, where), shape=(size, size)).tocsr()
        self.islam = ismultiplier[self.dofs]
        numbers = np.searchsorted(self.dofs, multipliers).tolist()
        every = np.arange(size)  # also zeros, as the graph has to be symmetric with its diagonal
        graph = np.hstack([where, where[::-1], (every, every)])
        values = np.concatenate([values, np.zeros(len(values) + size)])
        local = Exported(scipy.sparse.coo_matrix((values, graph), shape=(size, size)))
        try:
            self.system = Condensation(local, numbers, dim, AsBits(np.ones(size)))
        except NgException as error:
            raise LinearSolveError(str(error)) from error
        self.terms = ToCSR(self.system.Part(np.arange(self.system.height)))
        self.terms.eliminate_zeros()


class CondensedSystem:
    """Products with  A = Pl^T M P,  M = K + T; collective.

    The projections of a Condensation take from T all but the terms of slip, so that one distributed
    matrix serves for products with A and preconditions it.
    """

    def __init__(self, numbering: Numbering, mat: PETSc.Mat, contact: LocalContact | None):
        PETSc = LoadPETSc()
        self.numbering, self.mat, self.contact = numbering, mat, contact
        rows = numbering.surfaces.rows[contact.dofs] if contact else np.empty(0, dtype=int)
        self._local = PETSc.Vec().createSeq(len(rows), comm=PETSc.COMM_SELF)
        where = PETSc.IS().createGeneral(rows.astype(PETSc.IntType), comm=PETSc.COMM_SELF)
        self._work = numbering.Vector()
        self._scatter = PETSc.Scatter().create(self._work, where, self._local, None)

    def _Change(
        self, vec: PETSc.Vec, function: Callable[..., np.ndarray], *others
    ) -> np.ndarray | None:
        """Put into a vector what a function makes of its entries, and of other arrays, on rank 0.

        These entries are those of the dofs that contact touches. Returns what it has put, and None
        elsewhere.
        """
        self._scatter.scatter(vec, self._local)
        if self.contact is None:
            values = None
        else:
            values = function(self._local.array.copy(), *others)
            self._local.array[:] = values
        self._scatter.scatter(self._local, vec, mode="reverse")
        return values

    def _Own(self, vec: PETSc.Vec) -> np.ndarray | None:
        return self._Change(vec, lambda values: values)

    def _Bulk(self, u: np.ndarray, image: np.ndarray) -> np.ndarray:
        """K u from the image of M u."""
        contact = self.contact
        return np.where(contact.islam, 0.0, image - contact.terms @ u)

    def Mult(self, z: PETSc.Vec, image: PETSc.Vec) -> None:
        """image = A z"""
        z.copy(self._work)
        self._Change(self._work, self._Projected)
        self.mat.mult(self._work, image)
        self._Change(image, self._Tested)

    def _Projected(self, z: np.ndarray) -> np.ndarray:
        return np.where(self.contact.islam, 0.0, self.contact.system.Project(z))

    def _Tested(self, image: np.ndarray) -> np.ndarray:
        return self.contact.system.Test(np.where(self.contact.islam, 0.0, image))

    def Reduce(self, b: PETSc.Vec) -> PETSc.Vec:
        """The right hand side of A, a new vector."""
        own, u, reduced = self._Own(b), self._work, b.duplicate()
        u.set(0)
        lifted = self._Change(u, lambda zero: self.contact.system.Displacements(own, zero))
        self.mat.mult(u, reduced)
        bulk = self._Change(reduced, lambda image: self._Bulk(lifted, image))
        reduced.aypx(-1.0, b)
        self._Change(reduced, lambda _: self.contact.system.Reduce(own, lifted, bulk))
        return reduced

    def Expand(self, b: PETSc.Vec, w: PETSc.Vec) -> PETSc.Vec:
        """The solution from that of A: a new vector."""
        own, x, image = self._Own(b), w.copy(), b.duplicate()
        u = self._Change(x, lambda part: self.contact.system.Displacements(own, part))
        self.mat.mult(x, image)
        bulk = self._Change(image, lambda part: self._Bulk(u, part))
        self._Change(x, lambda _: self.contact.system.Complete(own, u, bulk))
        return x

    def Residual(self, b: PETSc.Vec, x: PETSc.Vec) -> PETSc.Vec:
        """What a solution leaves of b: a new vector."""
        own, u, left = self._Own(x), x.copy(), b.duplicate()
        self._Change(u, lambda part: np.where(self.contact.islam, 0.0, part))
        self.mat.mult(u, left)
        self._Change(left, lambda image: self._Image(own, image))
        left.aypx(-1.0, b)
        return left

    def _Image(self, x: np.ndarray, image: np.ndarray) -> np.ndarray:
        """That of the whole system."""
        u = np.where(self.contact.islam, 0.0, x)
        return self._Bulk(u, image) + self.contact.mat @ x
