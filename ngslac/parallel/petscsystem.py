"""Newton systems of contact, distributed, as matrices of PETSc."""

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from ngslac.bodies.constraints import ToCSR
from ngslac.parallel.matrices import Assembled, Sum
from ngslac.parallel.numbering import Numbering
from ngslac.parallel.petscdirect import PetscDirect

__all__ = ["PetscSystem"]


class PetscSystem:
    """Bulk matrices of all ranks and the contacts of rank 0 as one system; collective throughout.

    Dofs have the numbers of a product space of displacements and multipliers that rank 0 knows.

    Parameters
    ----------
    comm : mpi4py communicator or None
        None: this process alone.
    n : int
        Scalar dofs of the system.
    dofs : (m,) int
        Number in the system of each scalar dof of this rank's bulk matrix, -1 for none.
    free : (n,) bool
        Rank 0 tells; None elsewhere, as in all that follows.
    nodes : Nodes

    Attributes
    ----------
    factorisations, krylov : int
        So far, of matrices of full size; iterations.
    """

    def __init__(self, comm, n, dofs, free=None, nodes=None):
        self.dofs = np.asarray(dofs, dtype=np.int64)
        self.numbering = Numbering(comm, n, self.dofs, nodes)
        self.free = free if comm is None else comm.bcast(free)
        self.nodes = nodes
        self._bulk = self._scale = self._mat = None
        self.direct = PetscDirect()

    @property
    def factorisations(self):
        """Of matrices of full size, so far."""
        return self.direct.factorisations

    @property
    def krylov(self):
        """Krylov iterations so far."""
        return 0

    def SetBulk(self, mat):
        """Take this rank's part of the bulk's matrix; entries of the same dofs are added.

        Parameters
        ----------
        mat : BaseMatrix or None
            Sparse, of the rank's own dofs, scalar or with blocks; None where it has none.
        """
        part = rows = None
        if mat is not None:
            part, rows = self._FreePart(ToCSR(mat).tocoo())
        numbering = self.numbering
        held = np.ones(numbering.size)
        held[numbering.new[self.free]] = 0
        held = held[numbering.start : numbering.stop]
        self._bulk = None
        self._bulk = Assembled(numbering, part, rows, held)
        self._scale = self._mat = None

    def _FreePart(self, mat):
        """Entries of free dofs, and the rows of these."""
        used = self.dofs >= 0
        used[used] = self.free[self.dofs[used]]
        kept = used[mat.row] & used[mat.col]
        number = np.cumsum(used) - 1
        where = number[mat.row[kept]], number[mat.col[kept]]
        part = csr_matrix((mat.data[kept], where), shape=(used.sum(),) * 2)
        return part, self.numbering.new[self.dofs[used]]

    def SetContacts(self, mats=None, multipliers=None, scale=None, shift=None):
        """Take what contacts add to the bulk, and how the sum is scaled.

        Parameters
        ----------
        mats : list[BaseMatrix]
            Sparse, on all dofs.
        multipliers : (m,) int
            Their dofs, d in a row for each macro-element.
        scale : (n,) array
            Factors of rows and columns.
        shift : (n,) array, optional
            Is added to the diagonal of the scaled matrix.
        """
        self._Scale(scale)
        part = rows = None
        if self.numbering.rank == 0:
            part, rows = self._ContactPart(mats, scale, shift)
        self._mat = None
        self._mat = Sum(self._bulk, Assembled(self.numbering, part, rows))
        self.direct.Take(self._mat)

    def _ContactPart(self, mats, scale, shift):
        """The scaled sum on the dofs it touches, and their rows."""
        n, free = self.numbering.n, self.free
        total = csr_matrix((n, n))
        for mat in mats:
            total = total + ToCSR(mat)
        total = total.tocoo()
        kept = free[total.row] & free[total.col] & (total.data != 0)
        row, column = total.row[kept], total.col[kept]
        data = scale[row] * total.data[kept] * scale[column]
        if shift is not None:
            moved = np.flatnonzero(free & (shift != 0))
            row, column = np.concatenate([row, moved]), np.concatenate([column, moved])
            data = np.concatenate([data, shift[moved]])
        dofs = np.union1d(row, column)
        where = np.searchsorted(dofs, row), np.searchsorted(dofs, column)
        part = coo_matrix((data, where), shape=(len(dofs),) * 2).tocsr()
        return part, self.numbering.new[dofs]

    def _Scale(self, scale):
        """Scale the bulk, once for each scale."""
        numbering = self.numbering
        factor = numbering.Vector()
        if numbering.rank == 0:
            scale = np.where(self.free, scale, 1.0)
            before = 1.0 if self._scale is None else self._scale
            self._scale = scale
            scale = scale / before
        numbering.Put(scale, factor, fill=1.0)
        self._bulk.diagonalScale(factor, factor)

    def Solve(self, b=None, accuracy=0.0, method="direct"):
        """Solve with the matrices that were set.

        Parameters
        ----------
        b : (n,) array
            Scaled right hand side, 0 where nothing is free.
        accuracy : float
            Relative residual that is enough of an iteration.
        method : {"direct"}

        Returns
        -------
        x : (n,) array
            Scaled solution; None where the rank is not 0.
        error : float
            Its relative residual.

        Raises
        ------
        LinearSolveError
            On all ranks.
        """
        right, x = self.numbering.Put(b, self.numbering.Vector()), self.numbering.Vector()
        error = self.direct.Solve(right, x)
        return self.numbering.Get(x), error

    def Forget(self):
        """Keep nothing but the bulk."""
        self._mat = None
        self.direct.Forget()
