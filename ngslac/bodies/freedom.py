# SPDX-License-Identifier: LGPL-2.1-or-later
"""Motions that nothing resists, and the forces that drive them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ngslac.linear.grounded import MostApart
from ngslac.parallel.spread import MaxAt, Spread, SumAt

__all__ = ["EXACT", "Apart", "Freedom", "Ground", "NullSpace", "Unresisted"]

TOLERANCE = 1e-8

# Work of forces that is none: relative to that of their sizes, and to what the mesh of a curved
# surface makes of forces across it.
IDLE, MESH = 1e-8, 2.0
# The same where rotations are no functions of the space: thermal stress does false work.
FALSE = 1e-6
# Approach over motion along flat surfaces, which is rounding; part of a motion that is the same.
EXACT, NEAR = 1e-9, 0.7
# Part of a motion that is none of a set which makes it another one: a ring that rolls has .7.
DISTINCT = 0.6
# Motions seen by contact that are rounding.
UNSEEN = 1e-8
# Condition of springs that hold motions well.
REGULAR = 1e3
# Springs that hold idle motions, relative to the scaled diagonal of the bulk; and where contact
# seems to resist.
SPRING, WEAK = 1.0, 1e-5


@dataclass
class Freedom:
    """Motions of bodies and tools that neither the bulk nor contact resists.

    Attributes
    ----------
    weights : (m, k)
        Of all free rigid motions of the bodies, and of the unknowns of tools.
    resistance : (k,)
        Approach over motion along the surfaces, which is none but for their meshes.
    motions : (n, k)
        The same as coefficients of the solution.
    turning : (k,)
        By what angles bodies turn, at most.
    mesh : (k,)
        How much of forces across the surfaces their meshes make seem to be along the motions.
    own : (k,) int
        Which body moves along all of its surfaces that may touch others, so that no contact holds
        it; none: -1.
    body : (n,) int
        The body that coefficients of the solution move; none: -1.
    bodies : int
        How many bodies float.
    """

    weights: np.ndarray
    resistance: np.ndarray
    motions: np.ndarray
    turning: np.ndarray
    mesh: np.ndarray
    own: np.ndarray
    body: np.ndarray
    bodies: int

    def __bool__(self) -> bool:
        return self.weights.shape[1] > 0

    def Outright(self) -> Freedom:
        """The motions that no mesh makes look as if something resisted."""
        return self.Some(self.resistance <= EXACT)

    def Others(self) -> Freedom:
        """The motions that contact would hold, if it were closed elsewhere."""
        return self.Some(self.own < 0)

    def Some(self, chosen: np.ndarray | Sequence[int]) -> Freedom:
        """Those of the motions that a mask (k,) or numbers select."""
        parts = self.weights[:, chosen], self.resistance[chosen], self.motions[:, chosen]
        every = self.turning[chosen], self.mesh[chosen], self.own[chosen]
        return Freedom(*parts, *every, self.body, self.bodies)

    def Along(self, motion: Freedom) -> Freedom | None:
        """The motion of these that is nearest to one of other weights; None: none is near."""
        factors, *_ = np.linalg.lstsq(self.weights, motion.weights[:, 0], rcond=None)
        weights = self.weights @ factors
        if np.linalg.norm(weights) < NEAR * np.linalg.norm(motion.weights):
            return None
        mesh = np.array([max(self.resistance.max(initial=0.0), motion.mesh[0])])
        moved = self.motions @ factors
        parts = weights[:, None], motion.resistance, moved[:, None]
        return Freedom(*parts, motion.turning, mesh, motion.own, self.body, self.bodies)

    def Works(
        self, forces: list[np.ndarray], least: np.ndarray, blur: float = 0.0, false: bool = False
    ) -> np.ndarray:
        """The work (k,) of a list of forces (n,) that add up; 0 where `least` (n,) makes more.

        `blur` is how far forces may be from where they seem to act; with `false` stress does false
        work, as rotations are no functions of the space.
        """
        sizes = np.abs(self.motions)
        works = sum(forces[1:], forces[0]) @ self.motions
        gross = np.max([np.abs(force) @ sizes for force in forces], axis=0)
        none = np.linalg.norm(least[:, None] * self.motions, axis=0)
        none += blur * self.turning * max(np.abs(force).sum() for force in forces)
        idle = FALSE if false else IDLE
        allowed = np.maximum(np.maximum(idle, MESH * self.mesh) * gross, none)
        if np.any(vague := (self.own < 0) & (self.resistance <= EXACT) & (self.mesh > EXACT)):
            across = MESH * self.mesh * self.Across([np.abs(force) for force in forces])
            allowed = np.where(vague, np.maximum(allowed, across), allowed)
        return np.where(np.abs(works) > allowed, works, 0.0)

    def Across(self, sizes: list[np.ndarray]) -> np.ndarray:
        """The work (k,) of forces of a list of sizes (n,) if all were along the motions."""
        inside = np.flatnonzero(self.body >= 0)
        body, count = self.body[inside], self.bodies
        ways = MaxAt(body, np.abs(self.motions[inside]), count)
        return np.max([SumAt(body, size[inside], count) @ ways for size in sizes], axis=0)


class Ground:
    """Holds motions that nothing drives, so that bodies stay nearest to where they were.

    What holds them are forces spread over the bodies: none, but for rounding and for what the
    meshes of curved surfaces make of contact across them.
    """

    def __init__(
        self,
        freedom: Freedom,
        measure: np.ndarray,
        start: np.ndarray,
        free: np.ndarray,
        like: Ground | None = None,
    ):
        self.motions, self.measure, self.start = freedom.motions, measure, start
        self.turns = bool(np.any(freedom.own >= 0))
        # Does contact along curved surfaces seem to resist?
        self.resisted = self.turns or bool(np.any(freedom.mesh > EXACT))
        if np.linalg.cond(measure.T @ self.motions) > 1 / UNSEEN:  # turned by a right angle
            self.measure = self.motions
        self.forces = self.measure * free[:, None]
        self._works = self.motions.T @ self.forces
        self.pins = self._Pins(free, like)

    def _Pins(self, free: np.ndarray, like: Ground | None) -> Pins:
        serves = like is not None and like.motions.shape == self.motions.shape
        if serves and np.linalg.cond(like.pins.Of(self.motions)) < REGULAR:
            return like.pins
        return Pins.Among(np.flatnonzero(free & np.any(self.motions, axis=1)), self.motions)

    def Shift(self) -> np.ndarray:
        """What the scaled diagonal of the matrix gets."""
        shift = np.zeros_like(self.start)
        shift[self.pins.dofs] = WEAK if self.resisted else SPRING
        return shift

    def Balanced(self, forces: np.ndarray) -> np.ndarray:
        """Forces (n,) and what holds the bodies: together they do no work along the motions."""
        return forces - self.forces @ np.linalg.solve(self._works, self.motions.T @ forces)

    def Nearest(
        self,
        values: np.ndarray,
        correction: np.ndarray,
        scale: np.ndarray,
        solve: Callable[[np.ndarray], np.ndarray],
    ) -> np.ndarray:
        """The correction (n,) of the solution that leaves bodies nearest to the start.

        `solve` gives those of forces (n,), of the system with `Shift`, which the springs are taken
        out of where contact seems to resist. `scale` (n,) are the factors of its rows.
        """
        wanted = self.measure.T @ (values - self.start)
        if not self.resisted:
            factors = np.linalg.solve(self._works.T, self.measure.T @ correction - wanted)
            return correction - self.motions @ factors
        forces = [self.forces[:, k] for k in range(self.forces.shape[1])]
        forces += [-spring for spring in self.pins.Each(self.Shift() / scale**2)]
        ways = np.stack([solve(force) for force in forces], axis=1)
        ends = self.pins.Of(ways)
        ends += np.eye(*ends.shape, self.forces.shape[1])
        rows = np.concatenate([self.measure.T @ ways, ends])
        right = [self.measure.T @ correction - wanted, self.pins.Of(correction)]
        return correction - ways @ np.linalg.solve(rows, np.concatenate(right))


@dataclass
class Pins:
    """A few rows of arrays.

    Attributes
    ----------
    dofs, places : (k,) int
        The rows of this process, and their places among all.
    count : int
        Of all.
    """

    dofs: np.ndarray
    places: np.ndarray
    count: int

    @classmethod
    def Among(cls, dofs: np.ndarray, motions: np.ndarray) -> Pins:
        """Those of some rows (k,) here that tell the motions (n, m) apart best."""
        if not isinstance(motions, Spread):
            chosen = MostApart(dofs, motions[dofs])
            return cls(chosen, np.arange(len(chosen)), len(chosen))
        dofs = dofs[motions.owned[dofs]]
        mine = MostApart(dofs, np.asarray(motions)[dofs])
        together = motions.together
        ranks = together.Rows(np.full(len(mine), together.rank))
        rows, every = together.Rows(mine), together.Rows(np.asarray(motions)[mine])
        chosen = MostApart(np.arange(len(rows)), every)
        places = np.flatnonzero(ranks[chosen] == together.rank)
        return cls(rows[chosen][places], places, len(chosen))

    def Of(self, values: np.ndarray) -> np.ndarray:
        """These rows (k, ...) of an array, on all processes."""
        found = np.zeros((self.count, *values.shape[1:]))
        found[self.places] = np.asarray(values)[self.dofs]
        return values.together.Sum(found) if isinstance(values, Spread) else found

    def Each(self, values: np.ndarray) -> Iterator[np.ndarray]:
        """Arrays with one of the rows of values (n,) each."""
        for place in range(self.count):
            found = np.zeros_like(values)
            own = self.dofs[self.places == place]
            found[own] = values[own]
            yield found


def Unresisted(
    prevented: np.ndarray, coarse: np.ndarray, seen: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Combinations (m, k) of motions that contact does not resist, and what it prevents of them."""
    prevented_there = prevented / coarse[:, None]
    both = np.concatenate([prevented_there, seen])
    if not both.size:
        return np.eye(both.shape[1]), np.zeros(both.shape[1])
    sizes, basis = Triangular(both)
    rank = int(np.sum(sizes > UNSEEN * max(1.0, np.abs(seen).max(initial=0.0))))
    outright, others = basis[rank:].T, basis[:rank].T
    if not rank:
        return outright, np.zeros(outright.shape[1])
    q, r = np.linalg.qr(both @ others)
    cosines, turned = Triangular(q[: len(prevented)])
    near = others @ np.linalg.solve(r, turned[cosines**2 <= 0.5].T)
    near /= np.linalg.norm(near, axis=0)
    sizes = [np.linalg.norm(rows @ near, axis=0) for rows in (prevented, seen)]
    resistance = np.concatenate([np.zeros(outright.shape[1]), sizes[0] / sizes[1]])
    return np.concatenate([outright, near], axis=1), resistance


def Apart(
    weights: np.ndarray,
    resistance: np.ndarray,
    own: np.ndarray,
    measure: Callable[[np.ndarray], np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """Those of some motions, with their resistance (k,), that are not nearly of another set."""
    if not weights.shape[1]:
        return weights, resistance
    whole, triangle = np.linalg.qr(measure(weights))
    others, _ = np.linalg.qr(measure(own))
    _, sizes, turned = np.linalg.svd(whole - others @ (others.T @ whole), full_matrices=False)
    mixed = np.linalg.solve(triangle, turned[sizes > DISTINCT].T)
    mixed /= np.linalg.norm(weights @ mixed, axis=0)
    return weights @ mixed, np.sqrt(resistance**2 @ mixed**2)


def Triangular(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Singular values of a matrix (r, m), m of them, and its right singular vectors as rows."""
    _, sizes, basis = np.linalg.svd(np.linalg.qr(matrix, mode="r"))
    return np.pad(sizes, (0, len(basis) - len(sizes))), basis


def NullSpace(matrix: np.ndarray, tolerance: float = TOLERANCE) -> np.ndarray:
    """Orthonormal basis of the null space, relative to the size of the matrix or to 1."""
    if isinstance(matrix, Spread) or matrix.shape[0] > matrix.shape[1]:
        matrix = np.linalg.qr(matrix, mode="r")
    if not matrix.size:
        return np.eye(matrix.shape[1])
    _, singular, vectors = np.linalg.svd(matrix)
    rank = int(np.sum(singular > tolerance * max(1.0, singular.max(initial=0.0))))
    return vectors[rank:].T
