# SPDX-License-Identifier: LGPL-2.1-or-later
"""Newton systems without multipliers: contact is condensed on rank 0, the bulk is distributed."""

import numpy as np
import scipy
from netgen.meshing import NgException
from ngsolve.la import SparseMatrixd

from ngslac._ngslac import OrthogonalCondensation
from ngslac.arrays import AsBits
from ngslac.bodies.constraints import ToCSR
from ngslac.linear.factor import LinearSolveError

__all__ = ["LocalContact", "NoContact"]


class LocalContact:
    """The contacts of a system on the dofs they touch, on rank 0, without the bulk.

    An `OrthogonalCondensation` of contact rows alone knows the projections P and Pl. It adds terms
    T to the bulk's K, those of slip and a penalty for the constraints, of which only the first stay
    in  A = Pl^T (K + T) P. So one distributed matrix K + T serves for products with A and
    preconditions it.

    Parameters
    ----------
    mat : csr_matrix
        Scaled, on free dofs.
    multipliers : (m,) int
        Their dofs, d in a row for each macro-element.
    dim : int
        Of the mesh.

    Attributes
    ----------
    dofs : (k,) int
        Those touched by multipliers, and these.
    terms : (k, k) csr_matrix
        T, a unit for each multiplier.
    """

    def __init__(self, mat, multipliers, dim):
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
        try:
            self._system = OrthogonalCondensation(
                AsNGSolve(self.mat), numbers, dim, AsBits(np.ones(size, dtype=bool))
            )
        except NgException as error:
            raise LinearSolveError(str(error)) from error
        part = ToCSR(self._system.Part())
        part.eliminate_zeros()
        self._stiff = part
        self.terms = part + scipy.sparse.diags_array(self.islam.astype(float)).tocsr()

    def Project(self, z):
        """P z, 0 for multipliers."""
        projected = self._system.Expand(np.zeros(len(z)), z)
        projected[self.islam] = 0
        return projected

    def Test(self, f):
        """Pl^T f, 0 for multipliers."""
        return self._system.Reduce(np.where(self.islam, 0.0, f))

    def Particular(self, b):
        """Displacements that fulfil the constraints of a right hand side."""
        found = self._system.Expand(b, np.zeros(len(b)))
        found[self.islam] = 0
        return found

    def Bulk(self, x, image):
        """K x from the image of (K + T) x."""
        return np.where(self.islam, 0.0, image - self._stiff @ x)

    def Reduce(self, b, bulk):
        """Right hand side of A from `bulk`, which is K times the `Particular`."""
        return self._system.Reduce(b - bulk)

    def Displacements(self, b, w):
        """Those of the solution from that of A."""
        found = self._system.Expand(b, w)
        found[self.islam] = 0
        return found

    def Complete(self, b, w, bulk):
        """Displacements and multipliers; `bulk` is K times the first."""
        return self._system.Expand(b - bulk, w)


class NoContact:
    """What stands for it on other ranks: all of it is empty."""

    def __init__(self):
        self.dofs, self.mat, self.terms = (
            np.zeros(0, dtype=int),
            scipy.sparse.csr_matrix((0, 0)),
            None,
        )

    def Project(self, z, *_):
        """Nothing."""
        return z

    Test = Particular = Bulk = Reduce = Displacements = Complete = Project


def AsNGSolve(mat):
    """A csr_matrix as sparse matrix of NGSolve, with a symmetric graph and its diagonal."""
    size = mat.shape[0]
    mat = mat.tocoo()
    every, zeros = np.arange(size), np.zeros(mat.nnz + size)
    rows = np.concatenate([mat.row, mat.col, every])
    columns = np.concatenate([mat.col, mat.row, every])
    values = np.concatenate([mat.data, zeros])
    given = rows.tolist(), columns.tolist(), values.tolist()
    return SparseMatrixd.CreateFromCOO(*given, size, size)
