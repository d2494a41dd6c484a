# SPDX-License-Identifier: LGPL-2.1-or-later
"""Newton systems of contact, distributed, as matrices of PETSc."""

import numpy as np
import scipy

from ngslac.arrays import ToCSR
from ngslac.errors import LinearSolveError
from ngslac.petsc.condensation import Contacts
from ngslac.petsc.direct import PetscDirect
from ngslac.petsc.iterative import PetscIterative
from ngslac.petsc.matrices import Assembled, Sum
from ngslac.petsc.multigrid import PetscMultigrid
from ngslac.petsc.numbering import Numbering

__all__ = ["PetscSystem"]


class PetscSystem:
    """Bulk matrices of all ranks and the contacts of rank 0 as one system; collective throughout.

    Dofs have the numbers of a product space of displacements and multipliers that rank 0 knows.
    """

    def __init__(self, comm, n, dofs, free=None, nodes=None):
        self.dofs = np.asarray(dofs, dtype=np.int64)
        self.numbering = Numbering(comm, n, self.dofs, nodes)
        self.free = free if comm is None else comm.bcast(free)
        self._nodes, self._bulk, self._scale, self._multigrid = nodes, None, None, None
        self._direct, self.krylov = PetscDirect(self.numbering), 0
        self.Forget()

    @property
    def factorisations(self):
        """Of matrices of full size, so far."""
        return self._direct.factorisations

    def SetBulk(self, mat):
        """Take this rank's part of the bulk's matrix; entries of the same dofs are added."""
        part = rows = None
        if mat is not None:
            part, rows = self._FreePart(ToCSR(mat).tocoo())
        numbering = self.numbering
        held = np.ones(numbering.size)
        held[numbering.new[self.free]] = 0
        held = held[numbering.start : numbering.stop]
        self.Forget()
        self._bulk = self._scale = None
        self._bulk = Assembled(numbering, part, rows, held)

    def _FreePart(self, mat):
        """Entries of free dofs, and the rows of these."""
        used = self.dofs >= 0
        used[used] = self.free[self.dofs[used]]
        kept = used[mat.row] & used[mat.col]
        number = np.cumsum(used) - 1
        where = number[mat.row[kept]], number[mat.col[kept]]
        part = scipy.sparse.csr_matrix((mat.data[kept], where), shape=(used.sum(),) * 2)
        return part, self.numbering.new[self.dofs[used]]

    def SetContacts(self, mats=None, multipliers=None, scale=None, shift=None):
        """Take what contacts add to the bulk, and how the sum is scaled."""
        self.Forget()
        self._Scale(scale)
        if self.numbering.rank == 0:
            self._contacts = Contacts(mats, multipliers, self._scale, shift, self.free)

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
        """Solve with the matrices that were set."""
        accuracy, method = self.numbering.Tell((accuracy, method))
        solve = self._Direct if method == "direct" else self._Iterate
        right = self.numbering.Put(b, self.numbering.Vector())
        try:
            x, error = solve(right, accuracy)
            return self.numbering.Get(x), error
        finally:
            self.numbering.CleanUp()

    def Forget(self):
        """Keep nothing but the bulk."""
        self._contacts = self._iterative = None
        self._direct.Forget()
        self.numbering.CleanUp()

    def _Direct(self, b, _):
        if self._direct.mat is None:
            self._direct.Take(self._WithBulk(self._OnRankZero(Contacts.All)))
        return self._direct.Solve(b)

    def _Iterate(self, b, accuracy):
        if self._iterative is None:
            self._iterative = self._Iterative()
        before = self._iterative.krylov
        try:
            return self._iterative.Solve(b, accuracy)
        finally:
            self.krylov += self._iterative.krylov - before

    def _Iterative(self):
        """The PetscIterative for the matrices that were set."""
        numbering, dim = self.numbering, self.numbering.width
        condensed = self._OnRankZero(lambda contacts: contacts.Condensed(dim))
        mat = self._WithBulk(self._OnRankZero(lambda contacts: contacts.Sparse(condensed)))
        if self._multigrid is None:
            vertices = self._OnRankZero(lambda _: self._nodes.vertices)
            self._multigrid = PetscMultigrid(numbering, numbering.Rows(vertices))
        touched = self._OnRankZero(lambda contacts: self._nodes.With(contacts.touched))
        motions = numbering.Columns(self._OnRankZero(self._Motions))
        pc = self._multigrid.Preconditioner(mat, numbering.Rows(touched), motions)
        return PetscIterative(numbering, mat, condensed, pc)

    def _Motions(self, _):
        """The rigid motions in scaled variables."""
        return np.where(self.free, 1 / self._scale, 0.0)[:, None] * self._nodes.motions

    def _WithBulk(self, found):
        """The sum of the bulk and what rank 0 has found: a matrix and its dofs."""
        part, dofs = found or (None, None)
        rows = None if part is None else self.numbering.new[dofs]
        return Sum(self._bulk, Assembled(self.numbering, part, rows))

    def _OnRankZero(self, function):
        """What a function of the Contacts returns, None on other ranks; all raise its errors."""
        found = error = None
        if self.numbering.rank == 0:
            try:
                found = function(self._contacts)
            except LinearSolveError as raised:
                error = str(raised)
        error = self.numbering.Tell(error)
        if error is not None:
            raise LinearSolveError(error)
        return found
