# SPDX-License-Identifier: LGPL-2.1-or-later
"""Energy and momentum of bodies in a time step, corrected by changes of the velocities."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy

from ngslac.bodies.freedom import NullSpace
from ngslac.bodies.rigidmotions import RigidMotions, Turned
from ngslac.parallel.form import OnSurface
from ngslac.parallel.layout import LayoutOf
from ngslac.parallel.matrices import Entries
from ngslac.parallel.spread import Spread, SumAt

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix, spmatrix

    from ngslac.contact.contact import LACContact
    from ngslac.steps.inertia import Mass

__all__ = ["Conservation"]

# Energy that is a rounding error, relative to the kinetic energy.
ROUNDING = 1e-13
# Resultant of forces that is zero, relative to their size.
BALANCED = 1e-8
# Part of a rigid motion along the normals that is no approach: deformed surfaces are not smooth.
ALONG = 0.05


class Conservation:
    """Takes energy out of velocities, of bodies that touch together, and leaves their momenta.

    Bodies that touch share what they have won. Of all velocities with less energy, and with the
    momenta in all rigid motions of the bodies that supports and contact let them have, the closest
    one, in the sense of the kinetic energy, is taken: relative to such motions all velocities
    become smaller by one factor. So bodies keep their common momenta, linear and angular, and what
    slides on something is not held up.
    """

    def __init__(self, mass: Mass, contact: LACContact):
        form, block = contact.form, contact.form.fes.dim
        self.mass, self._space = mass, form.component
        first, dofs = form.offset * block, form.component.ndof
        self._own = slice(first, first + dofs * block)
        part = mass.matrix.Parts()
        self._used = mass.matrix.diagonal[self._own] > 0
        # Each dof that nothing uses is a part of its own, without mass.
        self._body = Numbered(part, self._used)
        self.count = 1 + int(np.max(self._body, initial=-1))
        self.account = np.zeros(self.count)  # energy taken from each body by time integration
        self._rigid, _, self._size = RigidMotions(self._space)

    def Products(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """The scalar product of two vectors (n,), body by body."""
        own = self._own
        return SumAt(self._body, a[own] * b[own], self.count)

    def OfMacros(self, contact: LACContact, works: np.ndarray) -> np.ndarray:
        """Values (m,) of the macro-elements of a contact, summed up body by body."""
        block = contact.form.fes.dim
        cores = np.array([contact.surface.CoreDofs(m)[0] for m in range(len(works))])
        body = OnSurface(contact.form, self._body)[cores * block].astype(int)
        return np.bincount(body, weights=works, minlength=self.count)

    def Kinetic(self, velocity: np.ndarray) -> np.ndarray:
        """Kinetic energies of the bodies."""
        return 0.5 * self.Products(velocity, self.mass.Times(velocity))

    def Virtual(self, forces: np.ndarray, displacement: np.ndarray) -> np.ndarray:
        """Work of forces (n,) in the rigid motions of the displaced bodies, a row for each body."""
        return np.stack(
            [self.Products(m, forces) for m in Columns(self._Motions(displacement))], axis=1
        )

    def Balanced(
        self, forces: np.ndarray, displacement: np.ndarray, squares: np.ndarray
    ) -> np.ndarray:
        """Do forces (n,) do no work in the rigid motions of a displaced body? For each body.

        `squares` (count,) are those of forces that are not small.
        """
        motions, size = Columns(self._Motions(displacement)), squares[:, None]
        sizes = np.stack([self.Products(m, m) for m in motions], axis=1) * size
        return np.all(self.Virtual(forces, displacement) ** 2 <= BALANCED**2 * sizes, axis=1)

    def _Motions(self, displacement: np.ndarray) -> np.ndarray:
        """The rigid motions (n, m) of the whole mesh where it is displaced."""
        motions = np.zeros((len(displacement), self._rigid.shape[1]))
        motions = LayoutOf(self.mass.space).Of(motions)
        turned = Turned(self._space, displacement[self._own], self._size)
        motions[self._own] = self._rigid + turned
        return motions

    def Restore(
        self,
        velocity: np.ndarray,
        momenta: np.ndarray,
        groups: np.ndarray,
        free: np.ndarray,
        impulses: np.ndarray,
        displacement: np.ndarray,
    ) -> np.ndarray:
        """Give free bodies the momenta that they should have, by one rigid motion of each group.

        Groups that supports hold, or on which forces or contacts act from outside, are left alone.
        """
        wrong = momenta - self.Virtual(self.mass.Times(velocity), displacement)
        fixed = ~self.mass.free[self._own] & self._used
        free = free & (SumAt(self._body, 1.0 * fixed, self.count) == 0)
        motions = self._Motions(displacement)
        sizes = BALANCED * np.abs(impulses).sum(axis=1) + ROUNDING * np.abs(momenta).sum(axis=1)
        for group in np.unique(groups):
            bodies = groups == group
            outside = np.abs(impulses[bodies].sum(axis=0)).max() > sizes[bodies].sum()
            if outside or not np.all(free[bodies]):
                continue
            own = motions * self._Inside(bodies)[:, None]
            pushed = np.stack([self.mass.Times(column) for column in Columns(own)], axis=1)
            velocity = velocity + own @ np.linalg.solve(pushed.T @ own, wrong[bodies].sum(axis=0))
        return velocity

    def _Inside(self, bodies: np.ndarray) -> np.ndarray:
        """Which entries of a vector (n,) belong to some bodies."""
        inside = np.zeros(len(self.mass.free), dtype=bool)
        inside[self._own] = bodies[np.asarray(self._body)]
        return inside

    def Groups(self, rows: spmatrix) -> np.ndarray:
        """Numbers (count,) of the bodies, the same where constraints (sparse rows) join them."""
        every = np.full(len(self.mass.free), -1.0)
        every[self._own] = self._body
        rows, body = Entries(rows, every)
        inside = (rows.data != 0) & (body[rows.col] >= 0)
        bodies = body[rows.col[inside]].astype(int)
        shape = rows.shape[0], self.count
        touched = scipy.sparse.csr_matrix(
            (np.ones(len(bodies)), (rows.row[inside], bodies)), shape=shape
        )
        return scipy.sparse.csgraph.connected_components(touched.T @ touched, directed=False)[1]

    def Settle(
        self,
        velocity: np.ndarray,
        groups: np.ndarray,
        rows: spmatrix,
        impact: np.ndarray,
        algorithmic: np.ndarray,
        displacement: np.ndarray,
    ) -> tuple[np.ndarray, float, float]:
        """The velocity without energy brought in; what went out for contact; what is owed."""
        self.account = self.account + algorithmic
        least = ROUNDING * self.Kinetic(velocity).sum()
        back = owed = 0.0
        for group in np.unique(groups):
            bodies = groups == group
            by_contact = max(0.0, -impact[bodies].sum())
            by_time = max(0.0, -self.account[bodies].sum())
            if by_contact + by_time <= least:
                continue
            kept = self._Kept(bodies, rows, displacement)
            velocity, out = self._Slower(velocity, bodies, by_contact + by_time, kept)
            brought = by_contact + max(0.0, -algorithmic[bodies].sum())
            owed += min(by_contact + by_time - out, brought)
            back += min(by_contact, out)
            self.account[bodies] += (out - by_contact) / bodies.sum()
        return velocity, back, owed

    def _Slower(
        self, velocity: np.ndarray, bodies: np.ndarray, energy: float, kept: np.ndarray
    ) -> tuple[np.ndarray, float]:
        """Take the energy from some bodies, or as much as is there; returns it, too."""
        relative = velocity * (self._Inside(bodies) & self.mass.free)
        if kept.shape[1]:
            momenta = np.stack([self.mass.Times(column) for column in Columns(kept)], axis=1)
            relative -= kept @ np.linalg.solve(momenta.T @ kept, momenta.T @ relative)
        pushed = self.mass.Times(relative)
        # velocity - f relative  has lost  f slope - f^2 most / 2.
        slope, most = float(velocity @ pushed), float(relative @ pushed)
        if not most > 0:
            return velocity, 0.0
        left = slope**2 - 2 * energy * most
        factor = 2 * energy / (slope + np.sqrt(left)) if left > 0 < slope else slope / most
        factor = min(max(factor, 0.0), 1.0)
        return velocity - factor * relative, factor * slope - 0.5 * factor**2 * most

    def _Kept(self, bodies: np.ndarray, rows: csr_matrix, displacement: np.ndarray) -> np.ndarray:
        """Rigid motions (n, m) of each of some bodies, as far as supports and contact let them.

        Those of all together are among them, whatever contact says.
        """
        motions, chosen = self._Motions(displacement), np.flatnonzero(bodies)
        insides = [self._Inside(np.arange(self.count) == body)[:, None] for body in chosen]
        each = np.concatenate([motions * inside for inside in insides], axis=1)
        held = each[self._own][~self.mass.free[self._own] & self._used]
        together = np.tile(np.eye(motions.shape[1]), (len(chosen), 1)) / np.sqrt(len(chosen))
        together = together @ NullSpace(held @ together)
        apart = NullSpace(held)
        apart = apart @ NullSpace(together.T @ apart)
        apart = apart @ NullSpace(rows @ (each @ apart), ALONG)
        return each @ np.concatenate([together, apart], axis=1)


def Numbered(part: np.ndarray, used: np.ndarray) -> np.ndarray:
    """Numbers (n,) from 0 on in place of those of the parts that are used; 0 elsewhere."""
    if isinstance(part, Spread):
        return np.where(used, part, 0)
    body = np.zeros(len(part), dtype=int)
    body[used] = np.unique(part[used], return_inverse=True)[1]
    return body


def Columns(matrix: np.ndarray) -> list[np.ndarray]:
    """The columns of an array (n, m) as a list."""
    return [matrix[:, k] for k in range(matrix.shape[1])]
