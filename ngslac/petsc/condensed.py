# SPDX-License-Identifier: LGPL-2.1-or-later
"""The condensed system as operator, and the way to its right hand side and back."""

from ngslac.petsc.library import LoadPETSc

__all__ = ["CondensedSystem"]


class CondensedSystem:
    """Products with  A = Pl^T M P,  M = K + T; collective.

    Parameters
    ----------
    numbering : Numbering
    mat : PETSc.Mat
        M, with unit rows for multipliers.
    contact : LocalContact or NoContact
        The latter where the rank is not 0.
    """

    def __init__(self, numbering, mat, contact):
        PETSc = LoadPETSc()
        self.numbering, self.mat, self.contact = numbering, mat, contact
        rows = numbering.new[contact.dofs]
        self._local = PETSc.Vec().createSeq(len(rows), comm=PETSc.COMM_SELF)
        where = PETSc.IS().createGeneral(rows.astype(PETSc.IntType), comm=PETSc.COMM_SELF)
        self._work = numbering.Vector()
        self._scatter = PETSc.Scatter().create(self._work, where, self._local, None)

    def _Get(self, vec):
        """Entries of the dofs that contact touches, on rank 0."""
        self._scatter.scatter(vec, self._local)
        return self._local.array.copy()

    def _Put(self, values, vec):
        """The opposite."""
        self._local.array[:] = values
        self._scatter.scatter(self._local, vec, mode="reverse")

    def Mult(self, z, image):
        """image = A z"""
        z.copy(self._work)
        self._Put(self.contact.Project(self._Get(z)), self._work)
        self.mat.mult(self._work, image)
        self._Put(self.contact.Test(self._Get(image)), image)

    def Reduce(self, b):
        """The right hand side of A, a new vector."""
        contact, u, reduced = self.contact, self._work, b.duplicate()
        part = self._Get(b)
        lifted = contact.Particular(part)
        u.set(0)
        self._Put(lifted, u)
        self.mat.mult(u, reduced)
        bulk = contact.Bulk(lifted, self._Get(reduced))
        reduced.aypx(-1.0, b)
        self._Put(contact.Reduce(part, bulk), reduced)
        return reduced

    def Expand(self, b, w):
        """The solution from that of A, and its residual: new vectors."""
        contact, x, left = self.contact, w.copy(), b.duplicate()
        part, own = self._Get(b), self._Get(w)
        moved = contact.Displacements(part, own)
        self._Put(moved, x)
        self.mat.mult(x, left)
        bulk = contact.Bulk(moved, self._Get(left))
        full = contact.Complete(part, own, bulk)
        self._Put(full, x)
        left.aypx(-1.0, b)
        self._Put(part - bulk - contact.mat @ full, left)
        return x, left
