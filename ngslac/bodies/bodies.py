# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bodies and the rigid motions that nothing prevents."""

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csr_matrix, vstack

from ngslac.bodies.constraints import ActiveRows, ToolDofs
from ngslac.bodies.names import BodyNames
from ngslac.bodies.parts import AreApart, ConnectedParts, Forces, LikelyParts
from ngslac.bodies.rigidmotions import RigidMotions, Turned

__all__ = ["Bodies"]

TOLERANCE = 1e-8
# Forces against a rigid motion, relative to those against others: more is a spring, if a weak one.
RESISTS = 1e-12
# How far a body goes, relative to the size of the mesh, when nothing holds it.
FAR = 1.0


class Bodies:
    """The connected parts of the bulk matrix with their free rigid motions.

    Parameters
    ----------
    mat : BaseMatrix
        Assembled bulk matrix on the product space.
    contact : LACContact
        Any contact on the space: tells the displacement.
    free : (n,) bool
        Free scalar dofs.
    """

    def __init__(self, mat, contact, free):
        form = contact.form
        self.space, block = form.component, form.fes.dim
        space = self.space
        self.first, self.count = form.offset * block, space.ndof * block
        self.motions, self.names, self.size = RigidMotions(space)
        # Coordinates far from the origin hold rounding errors.
        far = np.abs(np.asarray(space.mesh.ngmesh.Coordinates())).max() / self.size
        self.resists = min(TOLERANCE, RESISTS * max(1.0, far))
        forces = Forces(mat, self.first, self.count)
        values = np.random.default_rng(0).standard_normal(self.count)
        pushed = forces(values)
        sizes = np.abs(pushed)
        if hasattr(mat, "Parts"):  # which no process has all of
            self.part = mat.Parts()[self.first : self.first + self.count]
        else:
            self.part = LikelyParts(mat, form.offset, space.ndof).repeat(block)
            if not AreApart(self.part, forces, values, pushed):
                self.part = ConnectedParts(mat, form.offset, space.ndof).repeat(block)
        allowed = self._Allowed(sizes > 0, free[self.first : self.first + self.count])
        self.floating = [  # (part, combinations of motions as columns)
            (self.part[dofs[0]], combinations)
            for dofs, combinations in self._WithoutForces(allowed, forces, sizes)
        ]
        self.name = BodyNames(space, self.part, sizes > 0, self.motions)

    @classmethod
    def Heavy(cls):
        """Bodies with mass, however small: nothing floats but tools, which have none."""
        bodies = object.__new__(cls)
        bodies.floating, bodies.names, bodies.motions = [], ["unknown"], None
        return bodies

    def _Allowed(self, used, free):
        """Parts that their constrained dofs let move: dofs, combinations of motions as columns."""
        dofs = np.flatnonzero(used)
        dofs = dofs[np.argsort(self.part[dofs], kind="stable")]
        ends = np.flatnonzero(np.diff(self.part[dofs], append=-1))
        allowed = []
        for own in np.split(dofs, 1 + ends[:-1])[: len(ends)]:
            combinations = NullSpace(self.motions[own[~free[own]]])
            if combinations.shape[1]:
                allowed.append((own, combinations))
        return allowed

    def _WithoutForces(self, parts, forces, sizes):
        """Reduce the combinations of each part to those that nothing resists.

        All parts move at once: no two of them are connected.
        """
        random = np.random.default_rng(1).standard_normal(len(self.names))
        moved = self._Moved(parts, forces, random)
        scales = [sizes[dofs].mean() * Norm(self.motions[dofs]) for dofs, _ in parts]
        # Mostly constraints hold a part, or nothing does, which a random motion tells.
        held = [
            not np.linalg.norm(moved[dofs]) <= self.resists * scale
            for (dofs, _), scale in zip(parts, scales, strict=True)
        ]
        resisted = [part for part, yes in zip(parts, held, strict=True) if yes]
        most = max((motions.shape[1] for _, motions in resisted), default=0)
        columns = [self._Moved(resisted, forces, weights) for weights in np.eye(most)]
        for (dofs, motions), scale, yes in zip(parts, scales, held, strict=True):
            if yes:
                moved = np.stack([c[dofs] for c in columns[: motions.shape[1]]], axis=1)
                motions = motions @ NullSpace(moved / scale, self.resists)
            if motions.shape[1]:
                yield dofs, motions

    def _Moved(self, parts, forces, weights):
        """The forces where each part moves by its combinations, weighted."""
        values = np.zeros(self.count)
        for dofs, motions in parts:
            values[dofs] = self.motions[dofs] @ (motions @ weights[: motions.shape[1]])
        return forces(values) if parts else values

    def Floats(self, contacts, holds="now"):
        """Does contact leave any free rigid motion, see `ActiveRows`?"""
        if not self.floating and not len(ToolDofs(contacts)):
            return False
        return self._Left(contacts, holds).shape[1] > 0

    def Floating(self, contacts, holds="now"):
        """Descriptions of the free rigid motions that contact leaves, see `ActiveRows`."""
        tools = ToolDofs(contacts)
        if not self.floating and not len(tools):
            return []
        left = self._Left(contacts, holds)
        # Any basis is as good as another: name the motions that a pivoted elimination finds.
        place = self._Places()
        coordinates = np.zeros((len(self.floating), len(self.names), len(place)))
        for at, (body, weights) in enumerate(zip(place, self._Weights(), strict=True)):
            coordinates[body, :, at] = weights
        coordinates = coordinates.reshape(len(self.floating) * len(self.names), len(place))
        of_bodies = coordinates @ left[: len(place)]
        wanted = np.concatenate([of_bodies, left[len(place) :]])
        # Of two that are as good, as where bodies float together, the first and not what rounds up.
        wanted *= 1 - 1e-6 * np.arange(len(wanted))[:, None]
        *_, pivots = qr(wanted.T, pivoting=True)
        chosen = [divmod(k, len(self.names)) for k in sorted(pivots[: left.shape[1]])]
        return [self._Named(body, k) for body, k in chosen]

    def _Named(self, body, k):
        """A motion that nothing prevents; after those of bodies the unknowns of tools count on."""
        if body < len(self.floating):
            return f"body {self.name(self.floating[body][0])} floats ({self.names[k]})"
        number = (body - len(self.floating)) * len(self.names) + k
        return f"the tool floats (unknown {number + 1} of its motion)"

    def AreIdle(self, contacts, holds, forces, least, displacement=None):
        """Do no forces push along the motions that contact leaves? Then bodies may stay.

        Parameters
        ----------
        contacts, holds :
            As in `Floating`.
        forces : ((n,), (n,))
            Scaled, and what they have to be multiplied with.
        least : float
            Norm of scaled forces that are none.
        displacement : (n,) array, optional
            Bodies turn where they are then, not where they were.
        """
        tools = ToolDofs(contacts)
        if not self.floating and not len(tools):
            return False  # what is held, if only just, may not stay anywhere else
        scaled, factors = forces
        left = self._Left(contacts, holds)
        if len(tools) and not left.shape[1]:
            return False
        weights, at = np.zeros((len(scaled), left.shape[1])), 0
        motions = self.motions if displacement is None else self._Displaced(displacement)
        for part, combinations in self.floating:
            inside, count = np.flatnonzero(self.part == part), combinations.shape[1]
            moved = motions[inside] @ (combinations @ left[at : at + count])
            weights[self.first + inside], at = moved, at + count
        weights[tools] = left[at:]
        weights *= factors[:, None]
        works, gross = np.abs(scaled @ weights), np.abs(scaled) @ np.abs(weights)
        none = least * np.linalg.norm(weights, axis=0)
        return bool(np.all(works <= np.maximum(1e-8 * gross, none)))

    def _Displaced(self, displacement):
        """The rigid motions of the displaced bodies."""
        own = displacement[self.first : self.first + self.count]
        return self.motions + Turned(self.space, own, self.size)

    def _Left(self, contacts, holds):
        """The motions that contact leaves: columns of weights of all motions, and of tools."""
        rows = vstack([ActiveRows(contact, holds) for contact in contacts]).tocsr()
        prevented = [self._Jump(rows, part) @ motions for part, motions in self.floating]
        prevented.append(rows[:, ToolDofs(contacts)].toarray())
        return NullSpace(np.concatenate(prevented, axis=1))

    def _Weights(self):
        """All combinations, one after the other."""
        return [weights for _, motions in self.floating for weights in motions.T]

    def _Places(self):
        """Which of the floating bodies each of all combinations belongs to."""
        counts = [motions.shape[1] for _, motions in self.floating]
        return np.repeat(np.arange(len(counts)), counts)

    def Lost(self, values):
        """Descriptions of the bodies that displacements (n,) carry off like rigid ones.

        Farther than the size of the mesh, and far more than they deform.
        """
        lost = []
        for part, combinations in self.floating:
            own = np.flatnonzero(self.part == part)
            motions = self.motions[own] @ combinations
            moved = values[self.first + own]
            weights = np.linalg.lstsq(motions, moved)[0]
            rigid = motions @ weights
            far = np.max(np.abs(rigid)) > FAR * self.size
            if far and np.max(np.abs(moved - rigid)) < 0.2 * np.max(np.abs(rigid)):
                most = np.argmax(np.abs(combinations @ weights))
                lost.append(f"body {self.name(part)} moves off ({self.names[most]})")
        return lost

    def _Jump(self, rows, part):
        """What the constraints see of the rigid motions of one part."""
        columns = rows.indices - self.first
        own = (columns >= 0) & (columns < self.count)
        columns = np.where(own, columns, 0)
        values = rows.data * (own & (self.part[columns] == part))
        shape = rows.shape[0], self.count
        return csr_matrix((values, columns, rows.indptr), shape=shape) @ self.motions


def NullSpace(matrix, tolerance=TOLERANCE):
    """Orthonormal basis of the null space, relative to the size of the matrix or to 1."""
    if not matrix.size:
        return np.eye(matrix.shape[1])
    if matrix.shape[0] > matrix.shape[1]:
        matrix = np.linalg.qr(matrix, mode="r")
    _, singular, vectors = np.linalg.svd(matrix)
    rank = int(np.sum(singular > tolerance * max(1.0, singular.max(initial=0.0))))
    return vectors[rank:].T


def Norm(matrix):
    """The largest singular value of a tall matrix."""
    return np.sqrt(np.linalg.norm(matrix.T @ matrix, 2))
