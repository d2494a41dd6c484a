# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contacts of a system, on rank 0, and the distributed system without their multipliers."""

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
        Displacements that have entries in the sum.
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
        """Return the matrix on the dofs that have entries, and these dofs."""
        return OnItsDofs(self._mat)

    def Condensed(self, dim: int) -> LocalContact:
        """Make the LocalContact of this sum."""
        return LocalContact(self._mat, self._multipliers, dim)

    def Sparse(self, condensed: LocalContact) -> tuple[csr_matrix, np.ndarray]:
        """Return the matrix to add to the bulk instead of the sum, on its dofs, and these dofs."""
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
    """Return the rows and columns of a matrix that have entries, and their dofs."""
    mat = mat.tocoo()
    dofs = np.union1d(mat.row[mat.data != 0], mat.col[mat.data != 0])
    mat = mat.tocsr()[dofs][:, dofs]
    return mat, dofs


class LocalContact:
    """The contacts of a system on the dofs they touch, on rank 0, without the bulk.

    Attributes
    ----------
    dofs : (k,) int
        Displacements that multipliers couple with, and the multipliers.
    mat : (k, k) csr_matrix
    terms : (k, k) csr_matrix
        The matrix T of Condensation, which is added to the matrix K of the bulk.
    islam : (k,) bool
        Which dofs are multipliers; each has a unit row in `Contacts.Sparse`.
    system : Condensation
        Made from the rows and columns of the multipliers alone.
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
        every = np.arange(size)  # zeros make the graph symmetric, and give it a diagonal
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

    The projections of a Condensation remove all of T but the terms of slip. Therefore one
    distributed matrix serves both for products with A and for its preconditioner.
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
        """Replace the entries of a vector at contacts by a function of them and of other arrays.

        These entries are those of `contact.dofs`; rank 0 replaces them. Returns the new entries
        there, and None on other ranks.
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
        """Compute K u from the image M u."""
        contact = self.contact
        return np.where(contact.islam, 0.0, image - contact.terms @ u)

    def Mult(self, z: PETSc.Vec, image: PETSc.Vec) -> None:
        """Compute image = A z."""
        z.copy(self._work)
        self._Change(self._work, self._Projected)
        self.mat.mult(self._work, image)
        self._Change(image, self._Tested)

    def _Projected(self, z: np.ndarray) -> np.ndarray:
        return np.where(self.contact.islam, 0.0, self.contact.system.Project(z))

    def _Tested(self, image: np.ndarray) -> np.ndarray:
        return self.contact.system.Test(np.where(self.contact.islam, 0.0, image))

    def Reduce(self, b: PETSc.Vec) -> PETSc.Vec:
        """Make the right hand side of the system with A, as a new vector."""
        own, u, reduced = self._Own(b), self._work, b.duplicate()
        u.set(0)
        lifted = self._Change(u, lambda zero: self.contact.system.Displacements(own, zero))
        self.mat.mult(u, reduced)
        bulk = self._Change(reduced, lambda image: self._Bulk(lifted, image))
        reduced.aypx(-1.0, b)
        self._Change(reduced, lambda _: self.contact.system.Reduce(own, lifted, bulk))
        return reduced

    def Expand(self, b: PETSc.Vec, w: PETSc.Vec) -> PETSc.Vec:
        """Make the solution from the solution w of the system with A, as a new vector."""
        own, x, image = self._Own(b), w.copy(), b.duplicate()
        u = self._Change(x, lambda part: self.contact.system.Displacements(own, part))
        self.mat.mult(x, image)
        bulk = self._Change(image, lambda part: self._Bulk(u, part))
        self._Change(x, lambda _: self.contact.system.Complete(own, u, bulk))
        return x

    def Residual(self, b: PETSc.Vec, x: PETSc.Vec) -> PETSc.Vec:
        """Make the residual b less the image of x under the whole system, as a new vector."""
        own, u, left = self._Own(x), x.copy(), b.duplicate()
        self._Change(u, lambda part: np.where(self.contact.islam, 0.0, part))
        self.mat.mult(u, left)
        self._Change(left, lambda image: self._Image(own, image))
        left.aypx(-1.0, b)
        return left

    def _Image(self, x: np.ndarray, image: np.ndarray) -> np.ndarray:
        """Compute the image of x under the whole system, from the image M u."""
        u = np.where(self.contact.islam, 0.0, x)
        return self._Bulk(u, image) + self.contact.mat @ x
