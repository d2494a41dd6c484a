# SPDX-License-Identifier: LGPL-2.1-or-later
"""The mass matrix of a displacement, and its counterpart for a distributed mesh."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import BilinearForm, CoefficientFunction, InnerProduct, dx

from ngslac.arrays import Multiply, SameMatrix, ToCSR
from ngslac.bodies.parts import ConnectedParts, PartsOf
from ngslac.linear.parts import PartsInverse
from ngslac.parallel.matrices import SkinRows
from ngslac.parallel.spread import Spread

if TYPE_CHECKING:
    from ngsolve.comp import ProxyFunction
    from scipy.sparse import csr_matrix

    from ngslac.contact.contact import LACContact

__all__ = ["MassByProducts", "MassMatrix", "WholeMass"]

# Of rounding, relative; most iterations.
ROUNDING, MOST = 1e-14, 1000


def MassMatrix(
    density: CoefficientFunction | float,
    proxies: tuple[ProxyFunction, ProxyFunction],
    contact: LACContact,
    free: np.ndarray,
) -> WholeMass | MassByProducts:
    """The mass of the displacement of a contact on the free dofs (n,) bool.

    `proxies` are its trial and test function.
    """
    kind = MassByProducts if isinstance(free, Spread) else WholeMass
    return kind(density, proxies, contact, free)


class WholeMass:
    """The mass matrix in one process: `entries` (n, n), sparse."""

    def __init__(
        self,
        density: CoefficientFunction | float,
        proxies: tuple[ProxyFunction, ProxyFunction],
        contact: LACContact,
        free: np.ndarray,
    ):
        self._mat = BilinearForm(density * InnerProduct(*proxies) * dx).Assemble().mat
        self.entries, self._form, self._free = ToCSR(self._mat), contact.form, free
        self.entries.eliminate_zeros()  # which stand where components would be coupled
        self._known = None, None  # constraints, and how they see impulses

    @property
    def diagonal(self) -> np.ndarray:
        """That of the matrix (n,)."""
        return self.entries.diagonal()

    def Parts(self) -> np.ndarray:
        """A number for each dof of the displacement: the same in each body."""
        form = self._form
        parts = ConnectedParts(self._mat, form.offset, form.component.ndof)
        return parts.repeat(form.fes.dim)

    def Times(self, values: np.ndarray) -> np.ndarray:
        """The product with a numpy vector."""
        return self.entries @ values

    @cached_property
    def _inverse(self) -> PartsInverse:
        return PartsInverse(self.entries, self._free)

    def Solve(self, forces: np.ndarray) -> np.ndarray:
        """The accelerations of the free dofs under forces (n,); 0 elsewhere."""
        return self._inverse.Solve(forces)

    def Follow(self, rows: csr_matrix, rates: np.ndarray, loose: np.ndarray) -> np.ndarray:
        """The velocity (n,) of least energy that has the `rates` (k,) in sparse rows (k, n).

        `loose` (k, j) is an orthonormal basis of rates that nothing with mass has to have.
        """
        seen = self._Compliance(rows)

        def Project(left: np.ndarray) -> np.ndarray:
            return left - loose @ (loose.T @ left)

        def Seen(impulses: np.ndarray) -> np.ndarray:
            return Project(seen(impulses))

        # As well conditioned as the mass matrix.
        impulses = ConjugateGradients(Seen, rates, Project, 10 * len(rates) + 50)
        return self.Solve(rows.T @ impulses)

    def _Compliance(self, rows: csr_matrix) -> Callable[[np.ndarray], np.ndarray]:
        """A function: the rates (k,) of constraints that impulses (k,) along them cause."""
        last, known = self._known
        if last is not None and SameMatrix(rows, last):
            return known
        matrix, transposed = self._inverse.Complement(rows), rows.T.tocsr()

        def Seen(impulses: np.ndarray) -> np.ndarray:
            if matrix is not None:
                return np.einsum("ij,j->i", matrix, impulses)  # BLAS threads fight for cores
            return rows @ self.Solve(transposed @ impulses)

        self._known = rows, Seen
        return Seen


class MassByProducts:
    """A mass matrix of which each process has the part of its elements.

    Conjugate gradients with the diagonal as preconditioner solve with it, in the space of motions
    that keep the constraints (Gould, Hribar and Nocedal, SIAM J. Sci. Comput. 23, 2001).

    Attributes
    ----------
    diagonal : (n,) array
        Of the matrix.
    """

    def __init__(
        self,
        density: CoefficientFunction | float,
        proxies: tuple[ProxyFunction, ProxyFunction],
        contact: LACContact,
        free: np.ndarray,
    ):
        self._mat = BilinearForm(density * InnerProduct(*proxies) * dx).Assemble().mat
        self._form, layout = contact.form, contact.layout
        self.diagonal = layout.Diagonal(self._mat)
        used = free & (self.diagonal > 0)
        self._inverse = np.where(used, 1 / np.where(used, self.diagonal, 1), 0.0)

    def Times(self, values: np.ndarray) -> np.ndarray:
        """The product with an array (n,)."""
        return Multiply([self._mat], values)

    def Parts(self) -> np.ndarray:
        """As `WholeMass.Parts`."""
        first = self._form.offset * self._form.fes.dim
        count = self._form.component.ndof * self._form.component.dim
        return PartsOf(self._mat, self._form, None, self.diagonal[first : first + count] > 0)

    def Solve(self, forces: np.ndarray) -> np.ndarray:
        """The accelerations of the free dofs under forces; 0 elsewhere."""
        return ConjugateGradients(self.Times, forces, lambda left: self._inverse * left)

    def Follow(self, rows: SkinRows, rates: np.ndarray, loose: np.ndarray) -> np.ndarray:
        """See WholeMass."""
        inverse = rows.trace.Gather(self._inverse)
        there = rows.there @ scipy.sparse.diags(1.0 * (inverse > 0))
        if loose.shape[1]:
            loose = scipy.sparse.csr_matrix(loose)
            there = there - loose @ (loose.T @ there)
        rows = SkinRows(there, rows.trace)
        seen = (there @ scipy.sparse.diags(inverse) @ there.T).tocsc()
        least = ROUNDING * np.max(seen.diagonal(), initial=0) * scipy.sparse.eye(len(rates))
        factors = scipy.sparse.linalg.splu((seen + least).tocsc())

        def Moves(wrong: np.ndarray) -> np.ndarray:
            found = factors.solve(wrong)
            found = found + factors.solve(wrong - seen @ found)
            return self._inverse * rows.Transposed(found)

        def Project(left: np.ndarray) -> np.ndarray:
            moved = self._inverse * left
            for _ in range(2):  # the second time for rounding errors
                moved = moved - Moves(rows @ moved)
            return moved

        start = Moves(rates)
        return start + ConjugateGradients(self.Times, -self.Times(start), Project)


def ConjugateGradients(
    times: Callable[[np.ndarray], np.ndarray],
    right: np.ndarray,
    precondition: Callable[[np.ndarray], np.ndarray],
    most: int = MOST,
) -> np.ndarray:
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
