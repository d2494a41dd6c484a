# SPDX-License-Identifier: LGPL-2.1-or-later
"""The mass matrix of a displacement, and its counterpart for a distributed mesh."""

from functools import cached_property, singledispatch

import numpy as np
import scipy
from ngsolve import BilinearForm, InnerProduct, dx

from ngslac.arrays import SameMatrix, ToCSR
from ngslac.bodies.parts import ConnectedParts
from ngslac.linear.parts import PartsInverse

__all__ = ["MassByProducts", "MassMatrix", "WholeMass"]

# Of rounding, relative; most iterations.
ROUNDING, MOST = 1e-14, 1000


@singledispatch
def MassMatrix(a, density, proxies, contact, free):
    """The mass of the displacement of a contact on the free dofs (n,) bool of a bulk form.

    `proxies` are its trial and test function. The parallel room has an answer of its own.
    """
    return WholeMass(density, proxies, contact, free)


class WholeMass:
    """The mass matrix in one process: `entries` (n, n), sparse."""

    def __init__(self, density, proxies, contact, free):
        self._mat = BilinearForm(density * InnerProduct(*proxies) * dx).Assemble().mat
        self.entries, self._form, self._free = ToCSR(self._mat), contact.form, free
        self.entries.eliminate_zeros()  # which stand where components would be coupled
        self._known = None, None  # constraints, and how they see impulses

    @property
    def diagonal(self):
        """That of the matrix (n,)."""
        return self.entries.diagonal()

    def Parts(self):
        """A number for each dof of the displacement: the same in each body."""
        form = self._form
        parts = ConnectedParts(self._mat, form.offset, form.component.ndof)
        return parts.repeat(form.fes.dim)

    def Times(self, values):
        """The product with a numpy vector."""
        return self.entries @ values

    @cached_property
    def _inverse(self):
        return PartsInverse(self.entries, self._free)

    def Solve(self, forces):
        """The accelerations of the free dofs under forces (n,); 0 elsewhere."""
        return self._inverse.Solve(forces)

    def Follow(self, rows, rates, loose):
        """The velocity (n,) of least energy that has the `rates` (k,) in sparse rows (k, n).

        `loose` (k, j) is an orthonormal basis of rates that nothing with mass has to have.
        """
        seen = self._Compliance(rows)

        def Project(left):
            return left - loose @ (loose.T @ left)

        def Seen(impulses):
            return Project(seen(impulses))

        # As well conditioned as the mass matrix.
        impulses = ConjugateGradients(Seen, rates, Project, 10 * len(rates) + 50)
        return self.Solve(rows.T @ impulses)

    def _Compliance(self, rows):
        """A function: the rates (k,) of constraints that impulses (k,) along them cause."""
        last, known = self._known
        if last is not None and SameMatrix(rows, last):
            return known
        matrix, transposed = self._inverse.Complement(rows), rows.T.tocsr()

        def Seen(impulses):
            if matrix is not None:
                return np.einsum("ij,j->i", matrix, impulses)  # BLAS threads fight for cores
            return rows @ self.Solve(transposed @ impulses)

        self._known = rows, Seen
        return Seen


class MassByProducts:
    """A mass matrix of which products and the diagonal are known.

    Conjugate gradients with the diagonal as preconditioner solve with it, in the space of motions
    that keep the constraints (Gould, Hribar and Nocedal, SIAM J. Sci. Comput. 23, 2001).

    Parameters
    ----------
    times : callable
        The product with a numpy vector.
    diagonal : (n,) array
        Of the matrix.
    free : (n,) bool
    parts : callable
        As `WholeMass.Parts`.
    """

    def __init__(self, times, diagonal, free, parts):
        self.Times, self.diagonal, self.Parts = times, diagonal, parts
        used = free & (diagonal > 0)
        self._inverse = np.where(used, 1 / np.where(used, diagonal, 1), 0.0)

    def Solve(self, forces):
        """The accelerations of the free dofs under forces (n,); 0 elsewhere."""
        return ConjugateGradients(self.Times, forces, lambda left: self._inverse * left)

    def Follow(self, rows, rates, loose):
        """See WholeMass."""
        rows = rows @ scipy.sparse.diags(1.0 * (self._inverse > 0))
        if loose.shape[1]:
            rows = rows - scipy.sparse.csr_matrix(loose) @ (scipy.sparse.csr_matrix(loose.T) @ rows)
        moves = scipy.sparse.diags(self._inverse) @ rows.T
        seen = (rows @ moves).tocsc()
        least = ROUNDING * np.max(seen.diagonal(), initial=0) * scipy.sparse.eye(len(rates))
        factors = scipy.sparse.linalg.splu((seen + least).tocsc())

        def Impulses(wrong):
            found = factors.solve(wrong)
            return found + factors.solve(wrong - seen @ found)

        def Project(left):
            moved = self._inverse * left
            for _ in range(2):  # the second time for rounding errors
                moved = moved - moves @ Impulses(rows @ moved)
            return moved

        start = moves @ Impulses(rates)
        return start + ConjugateGradients(self.Times, -self.Times(start), Project)


def ConjugateGradients(times, right, precondition, most=MOST):
    """Solve with a symmetric operator to rounding errors, in so many iterations at most.

    The solution is in the space that the preconditioner leads to.
    """
    found, left = np.zeros(len(right)), 1.0 * right
    direction = moved = precondition(left)
    square = start = left @ moved
    for _ in range(most):
        if not square > ROUNDING**2 * start:
            break
        image = times(direction)
        step = square / (direction @ image)
        found = found + step * direction
        left = left - step * image
        moved = precondition(left)
        before, square = square, left @ moved
        direction = moved + square / before * direction
    return found
