# SPDX-License-Identifier: LGPL-2.1-or-later
"""What contacts add to a system, on rank 0."""

import numpy as np
import scipy

from ngslac.bodies.constraints import ToCSR
from ngslac.petsc.condensation import LocalContact

__all__ = ["Contacts"]


class Contacts:
    """The sum of scaled contact matrices on free dofs.

    Parameters
    ----------
    mats : list[BaseMatrix]
    multipliers : (m,) int
        Their dofs, d in a row for each macro-element.
    scale : (n,) array
    shift : (n,) array or None
        Is added to the diagonal of the scaled matrix.
    free : (n,) bool

    Attributes
    ----------
    touched : (n,) bool
        Displacements with entries.
    """

    def __init__(self, mats, multipliers, scale, shift, free):
        n, self._multipliers = len(free), np.asarray(multipliers, dtype=int)
        total = sum((ToCSR(mat) for mat in mats), scipy.sparse.csr_matrix((n, n))).tocoo()
        kept = free[total.row] & free[total.col] & (total.data != 0)
        row, column = total.row[kept], total.col[kept]
        values = scale[row] * total.data[kept] * scale[column]
        self._mat = scipy.sparse.coo_matrix((values, (row, column)), shape=(n, n)).tocsr()
        self._shift = np.where(free, 0.0 if shift is None else shift, 0.0)
        self.ismultiplier = np.zeros(n, dtype=bool)
        self.ismultiplier[self._multipliers] = True
        self.touched = np.zeros(n, dtype=bool)
        self.touched[row] = self.touched[column] = True
        self.touched &= ~self.ismultiplier

    def All(self):
        """The matrix with the shift, on some dofs, and these."""
        return OnItsDofs(self._mat + scipy.sparse.diags_array(self._shift))

    def Condensed(self, dim):
        """The LocalContact."""
        return LocalContact(self._mat, self._multipliers, dim)

    def Sparse(self, condensed):
        """What is added to the bulk in its place, on some dofs, and these."""
        mat = self._mat.tocoo()
        apart = ~(self.ismultiplier[mat.row] | self.ismultiplier[mat.col])
        where = mat.row[apart], mat.col[apart]
        stiffness = scipy.sparse.csr_matrix((mat.data[apart], where), shape=mat.shape)
        terms, dofs = condensed.terms.tocoo(), condensed.dofs
        where = dofs[terms.row], dofs[terms.col]
        terms = scipy.sparse.csr_matrix((terms.data, where), shape=mat.shape)
        diagonal = scipy.sparse.diags_array(self._shift + self.ismultiplier)
        return OnItsDofs(stiffness + terms + diagonal)


def OnItsDofs(mat):
    """The part of a matrix that is not empty, and its dofs."""
    mat = mat.tocoo()
    dofs = np.union1d(mat.row[mat.data != 0], mat.col[mat.data != 0])
    mat = mat.tocsr()[dofs][:, dofs]
    return mat, dofs
