# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bodies and the rigid motions that nothing prevents."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ngslac.bodies.constraints import COARSE, CONTACT, TIGHT, Sight, ToolDofs
from ngslac.bodies.falsestiffness import FalseStiffness
from ngslac.bodies.freedom import EXACT, Apart, Freedom, NullSpace, Unresisted
from ngslac.bodies.names import BodyNames
from ngslac.bodies.parts import AreApart, Forces, Groups, PartsOf
from ngslac.bodies.rigidmotions import MotionIntegrals, PoissonRatio, RigidMotions, Turned
from ngslac.bodies.slides import OwnSlides, SlidesOf
from ngslac.parallel.extent import ExtentOf
from ngslac.parallel.layout import LayoutOf
from ngslac.rigid import Tables

if TYPE_CHECKING:
    from ngsolve import BaseMatrix
    from scipy.sparse import csr_matrix

    from ngslac.contact.contact import LACContact

__all__ = ["Bodies", "NoBodies"]

TOLERANCE = 1e-8
# Forces against a rigid motion, relative to those against others: more is a spring, if a weak one.
RESISTS = 1e-12
# The same of springs that are weak beside the body: next to nothing holds it.
WEAK = 1e-2
# How far a body goes, relative to the size of the mesh, when nothing holds it.
FAR = 1.0
# How much of a motion along all surfaces of a body closed contact may seem to prevent: where the
# other surface is curved contact is not along either of them, and a corner touches across.
PREVENTED = 0.5


@dataclass
class Placed:
    """Bodies where a displacement (count,) has taken them.

    Attributes
    ----------
    displacement : (count,) array or None
    motions : (count, m) array
        Rigid motions of the displaced mesh.
    columns : (n, k) sparse matrix
        Those of bodies and tools that neither conditions nor the bulk prevent.
    found : dict
        Each Freedom there, as long as contacts stay as they are.
    """

    displacement: np.ndarray | None
    motions: np.ndarray
    columns: scipy.sparse.csr_matrix  # SciPy loads it when it is used
    found: dict = field(default_factory=dict)
    _contacts: list = field(default_factory=list)

    def Forget(self, contacts: Sequence[tuple]) -> None:
        """Drop the results for other states of contacts than these."""
        if self._contacts != contacts:
            self._contacts, self.found = contacts, {}


class Bodies:
    """The connected parts of the bulk matrix with their free rigid motions.

    Attributes
    ----------
    floating : list of (int, (m, k) array)
        Parts, and the combinations of rigid motions that neither conditions nor the bulk prevents.
    false : bool
        Does the bulk resist some of them, as its space cannot represent rotations?
    loose : int
        How many parts float, or are held by weak springs alone.
    """

    floating, false, loose = (), False, 0
    first = count = 0
    _slides = _placed = None

    def __init__(self, mat: BaseMatrix, contact: LACContact, free: np.ndarray):
        form = contact.form
        self.space, block = form.component, form.fes.dim
        space = self.space
        self.first, self.count = form.offset * block, space.ndof * block
        self.motions, self.names, self.size = RigidMotions(space)
        # Coordinates far from the origin hold rounding errors.
        far = ExtentOf(space.mesh).far / self.size
        self.resists = min(TOLERANCE, RESISTS * max(1.0, far))
        self.layout = contact.layout
        forces = Forces(mat, self.layout, self.first, self.count)
        values = np.random.default_rng(0).standard_normal(self.count)
        values = LayoutOf(space).Consistent(values)
        pushed = forces(values)
        sizes = np.abs(pushed)
        self.part = PartsOf(
            mat, form, lambda part: AreApart(part, forces, values, pushed), sizes > 0
        )
        allowed = self._Allowed(sizes > 0, free[self.first : self.first + self.count])
        # (part, combinations of motions as columns)
        self.floating = list(self._WithoutForces(allowed, forces, sizes))
        self.name = BodyNames(space, self.part, sizes > 0, self.motions)

    def _Allowed(
        self, used: np.ndarray, free: np.ndarray
    ) -> list[tuple[int, np.ndarray, np.ndarray]]:
        """Parts that their constrained dofs let move: part, dofs, combinations as columns."""
        allowed = []
        for part, own in Groups(self.part, used):
            combinations = NullSpace(self.motions[own[~np.asarray(free)[own]]])
            if combinations.shape[1]:
                allowed.append((part, own, combinations))
        return allowed

    def _WithoutForces(
        self,
        parts: Sequence[tuple[int, np.ndarray, np.ndarray]],
        forces: Callable[[np.ndarray], np.ndarray],
        sizes: np.ndarray,
    ) -> Iterator[tuple[int, np.ndarray]]:
        """Reduce the combinations of each part to those that nothing resists.

        All parts move at once: no two of them are connected.
        """
        random = np.random.default_rng(1).standard_normal(len(self.names))
        moved = self._ForcesOf(parts, forces, random)
        scales = [sizes[dofs].mean() * Norm(self.motions[dofs]) for _, dofs, _ in parts]
        # Mostly constraints hold a part, or nothing does: a random motion shows which.
        held = [
            not np.linalg.norm(moved[dofs]) <= self.resists * scale
            for (_, dofs, _), scale in zip(parts, scales, strict=True)
        ]
        resisted = [part for part, yes in zip(parts, held, strict=True) if yes]
        most = max((motions.shape[1] for *_, motions in resisted), default=0)
        columns = [self._ForcesOf(resisted, forces, weights) for weights in np.eye(most)]
        false = FalseStiffness(self, forces) if most else None
        self.loose = len(parts) - len(resisted)
        for (part, dofs, motions), scale, yes in zip(parts, scales, held, strict=True):
            if yes:
                moved = np.stack([c[dofs] for c in columns[: motions.shape[1]]], axis=1)
                free = NullSpace(moved / scale, self.resists)
                self.loose += NullSpace(moved / scale, WEAK).shape[1] > 0
                if free.shape[1] < motions.shape[1] and false.any:
                    free, self.false = false.Unresisted(dofs, motions, moved, scale), True
                motions = motions @ free
            if motions.shape[1]:
                yield part, motions

    def _ForcesOf(
        self,
        parts: Sequence[tuple[int, np.ndarray, np.ndarray]],
        forces: Callable[[np.ndarray], np.ndarray],
        weights: np.ndarray,
    ) -> np.ndarray:
        """The forces where each part moves by its combinations, weighted."""
        values = LayoutOf(self.space).Zeros()
        for _, dofs, motions in parts:
            values[dofs] = self.motions[dofs] @ (motions @ weights[: motions.shape[1]])
        return forces(values) if parts else values

    def Freedom(
        self,
        contacts: Sequence[LACContact],
        holds: str = "now",
        displacement: np.ndarray | None = None,
        normals: str = CONTACT,
        slides: bool = True,
    ) -> Freedom:
        """The motions that contact leaves, as a Freedom."""
        placed = self._Placed(contacts, displacement)
        sights = [self._sights.setdefault(contact, Sight(contact)) for contact in contacts]
        placed.Forget([sight.Look() for sight in sights])
        key = holds, normals, slides
        if key not in placed.found:
            placed.found[key] = self._Free(placed, sights, *key)
        return placed.found[key]

    def _Free(
        self, placed: Placed, sights: Sequence[Sight], holds: str, normals: str, slides: bool
    ) -> Freedom:
        """The motions that contact leaves bodies there, and how well it resists them."""
        contacts = [sight.contact for sight in sights]
        motions, columns, displacement = placed.motions, placed.columns, placed.displacement

        def Seen(holds: str) -> tuple[np.ndarray, ...]:
            found = [sight.Resistances(columns, holds, normals) for sight in sights]
            return tuple(map(np.concatenate, zip(*found, strict=True)))

        prevented, coarse, all_seen = Seen(holds)
        touching = Seen("now") if holds == "closed" else (prevented, coarse, all_seen)
        slides = self._Slides(contacts, displacement, *touching[::2]) if slides else []
        own = np.concatenate([np.zeros((all_seen.shape[1], 0)), *(w for w, *_ in slides)], axis=1)
        weights, resistance = Unresisted(prevented, coarse, all_seen)
        if own.shape[1]:
            measure = self._Measure(motions)
            apart = [
                Apart(weights[:, some], resistance[some], own, measure)
                for some in (resistance <= EXACT, resistance > EXACT)
            ]
            weights, resistance = (np.concatenate(p, axis=-1) for p in zip(*apart, strict=True))
        # A few macro-elements of a curved surface do not determine its center; friction does.
        rubs = any(contact.holds_tangentially for contact in contacts)
        vague = (resistance <= EXACT) & np.any(coarse > TIGHT) & (not rubs)
        mesh = np.concatenate([*(m for *_, m, _ in slides), np.where(vague, COARSE, resistance)])
        weights = np.concatenate([own, weights], axis=1)
        resistance = np.concatenate([*(a for _, a, *_ in slides), resistance])
        whose = np.concatenate([*(b for *_, b in slides), np.full(len(vague), -1)])
        turning, d = np.zeros(weights.shape[1]), contacts[0].mesh.dim
        for _, combinations, rows in self.unknowns:
            turns = np.linalg.norm((combinations @ weights[rows])[d:], axis=0)
            turning = np.maximum(turning, turns / self.size)
        body = np.full(contacts[0].nscalars, -1)
        body[self.first : self.first + self.count] = self._bodies
        motions = contacts[0].layout.Of(columns @ weights)
        return Freedom(weights, resistance, motions, turning, mesh, whose, body, len(self.floating))

    def _Placed(self, contacts: Sequence[LACContact], displacement: np.ndarray | None) -> Placed:
        """The Placed bodies, kept as long as they stay where they are."""
        own, motions = None, self.motions
        if displacement is not None and self.floating:
            own = displacement[self.first : self.first + self.count].copy()
        if self._placed is not None and np.array_equal(self._placed.displacement, own):
            return self._placed
        if own is not None:
            motions = motions + Turned(self.space, own, self.size)
        moved, tools = self.Columns(motions).tocoo(), ToolDofs(contacts)
        numbers = moved.shape[1] + np.arange(len(tools))
        shape = contacts[0].nscalars, moved.shape[1] + len(tools)
        places = [(moved.row + self.first, tools), (moved.col, numbers)]
        values = np.concatenate([moved.data, np.ones(len(tools))])
        columns = scipy.sparse.csr_matrix((values, [*map(np.concatenate, places)]), shape)
        self._placed = Placed(own, motions, columns)
        return self._placed

    def Columns(self, motions: np.ndarray) -> csr_matrix:
        """The free rigid motions of all bodies as columns of a sparse matrix (count, k)."""
        values = [np.asarray(motions[dofs] @ own).ravel() for dofs, own, _ in self.unknowns]
        shape = self.count, sum(own.shape[1] for _, own in self.floating)
        values = np.concatenate([np.zeros(0), *values])
        return scipy.sparse.csr_matrix((values, self._entries), shape)

    @cached_property
    def _entries(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows and columns of the entries of `Columns`."""
        rows, columns = [np.zeros(0, int)], [np.zeros(0, int)]
        for dofs, own, numbers in self.unknowns:
            rows.append(dofs.repeat(own.shape[1]))
            columns.append(np.tile(np.arange(numbers.start, numbers.stop), len(dofs)))
        return np.concatenate(rows), np.concatenate(columns)

    @cached_property
    def unknowns(self) -> list[tuple[np.ndarray, np.ndarray, slice]]:
        """Of each floating body: dofs, combinations of motions, their rows among all weights."""
        found, at = [], 0
        for part, combinations in self.floating:
            rows = slice(at, at + combinations.shape[1])
            found.append((np.flatnonzero(self.part == part), combinations, rows))
            at = rows.stop
        return found

    @cached_property
    def _sights(self) -> dict[LACContact, Sight]:
        """The Sight of each contact."""
        return {}

    @cached_property
    def _bodies(self) -> np.ndarray:
        """Which floating body each dof (count,) moves with; none: -1."""
        body = np.full(self.count, -1)
        for number, (inside, *_) in enumerate(self.unknowns):
            body[inside[np.any(np.asarray(self.motions)[inside], axis=1)]] = number
        return body

    @cached_property
    def _triangles(self) -> list[np.ndarray]:
        return self._Triangles(self.motions)

    def _Triangles(self, motions: np.ndarray) -> list[np.ndarray]:
        """Of the free motions of each body: products of their columns are those of the motions."""
        return [np.linalg.qr(motions[inside] @ own, mode="r") for inside, own, _ in self.unknowns]

    def _Measure(self, motions: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """A function of weights whose columns have products that are those of displacements."""
        triangles = self._triangles if motions is self.motions else self._Triangles(motions)

        def Sized(weights: np.ndarray) -> np.ndarray:
            sized = weights.copy()
            for triangle, (*_, rows) in zip(triangles, self.unknowns, strict=True):
                sized[rows] = triangle @ weights[rows]
            return sized

        return Sized

    def _Slides(
        self,
        contacts: Sequence[LACContact],
        displacement: np.ndarray | None,
        prevented: np.ndarray,
        seen: np.ndarray,
    ) -> list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
        """Motions along all own surfaces of bodies which do not meet corners of others.

        `prevented` and `seen` are those of `Resistances`. Yields weights (m, k), and across, mesh
        and the number of the body, (k,).
        """
        if self._slides is None:
            self._slides = SlidesOf(self, contacts)
        least, found = np.full(len(prevented), PREVENTED), []
        for body, slides in enumerate(self._slides):
            weights = np.zeros((seen.shape[1], slides.weights.shape[1]))
            still = displacement is None
            weights[slides.rows] = slides.weights if still else self._Carried(slides, displacement)
            kept, _ = Unresisted(prevented @ weights, least, seen @ weights)
            shares, count = kept**2, kept.shape[1]
            figures = np.sqrt(slides.across**2 @ shares), slides.mesh @ shares
            found.append((weights @ kept, *figures, np.full(count, body)))
        return found

    def _Carried(self, slides: OwnSlides, displacement: np.ndarray) -> np.ndarray:
        """Weights of the slides of a body that has moved: it turns about a center that moved."""
        tables, _ = Tables(self.space.mesh.dim)
        d, inside, combinations = len(tables[0]), slides.inside, slides.combinations
        volumes = self._integrals[inside, :d]
        moved = displacement[inside] @ volumes
        moved /= np.sum(self.motions[inside, :d] * volumes, axis=0)
        motions = combinations @ slides.weights
        back = np.einsum("mcb,b->cm", tables[d:, :, 1:], moved / self.size)
        motions[:d] -= back @ motions[d:]
        return np.linalg.lstsq(combinations, motions, rcond=None)[0]

    @cached_property
    def _integrals(self) -> np.ndarray:
        """Of the motions times the basis functions."""
        return MotionIntegrals(self.space)

    def Measure(self, contacts: Sequence[LACContact], freedom: Freedom) -> np.ndarray:
        """Integrals of free motions times displacements, as (n, k) array; tools count once."""
        tools, weights = ToolDofs(contacts), freedom.weights
        result = np.zeros_like(freedom.motions)
        for inside, combinations, rows in self.unknowns:
            result[self.first + inside] = self._integrals[inside] @ (combinations @ weights[rows])
        result[tools] = weights[len(weights) - len(tools) :]
        return result

    def Names(self, weights: np.ndarray) -> list[str]:
        """Descriptions of motions, columns of weights as those of a Freedom."""
        if not weights.shape[1]:
            return []
        # Any basis is as good as another: name the motions that a pivoted elimination finds.
        blocks = scipy.linalg.block_diag(np.zeros((0, 0)), *(own for _, own in self.floating))
        count = blocks.shape[1]
        wanted = np.concatenate([blocks @ weights[:count], weights[count:]])
        # Of two equally good ones, as where bodies float together, take the first.
        wanted *= 1 - 1e-6 * np.arange(len(wanted))[:, None]
        *_, pivots = scipy.linalg.qr(wanted.T, pivoting=True)
        chosen = [divmod(k, len(self.names)) for k in sorted(pivots[: weights.shape[1]])]
        return [self._Named(body, k) for body, k in chosen]

    def _Named(self, body: int, k: int) -> str:
        """A motion that nothing prevents; after those of bodies the unknowns of tools count on."""
        if body < len(self.floating):
            return f"body {self.name(self.floating[body][0])} floats ({self.names[k]})"
        number = (body - len(self.floating)) * len(self.names) + k
        return f"the tool floats (unknown {number + 1} of its motion)"

    def Lost(self, values: np.ndarray) -> list[str]:
        """Descriptions of the bodies that displacements (n,) carry off like rigid ones.

        Farther than the size of the mesh, and far more than they deform.
        """
        lost = []
        for part, weights, rigid, moved in self._Rigid(values):
            if rigid > FAR * self.size and moved < 0.2 * rigid:
                most = np.argmax(np.abs(weights))
                lost.append(f"body {self.name(part)} moves off ({self.names[most]})")
        return lost

    def Way(self, values: np.ndarray) -> float:
        """How far displacements (n,) carry any of the bodies like a rigid one."""
        return max((rigid for _, _, rigid, _ in self._Rigid(values)), default=0.0)

    def Drift(self, forces: np.ndarray, stiffness: np.ndarray) -> float:
        """How far forces (n,) carry any of the bodies against springs (n,) at all of its dofs."""
        way = 0.0
        for _, _, rows, motions in self._Loose():
            against = motions.T @ (stiffness[rows, None] * motions)
            weights = np.linalg.lstsq(against, motions.T @ forces[rows])[0]
            way = max(way, np.max(np.abs(motions @ weights)))
        return way

    def _Loose(self) -> Iterator[tuple[int, np.ndarray, np.ndarray, np.ndarray]]:
        """Of each body that floats its number and combinations, its rows, and its motions there."""
        for part, combinations in self.floating:
            own = np.flatnonzero(self.part == part)
            yield part, combinations, self.first + own, self.motions[own] @ combinations

    def PoissonRatio(self, mat: BaseMatrix) -> float:
        """The largest one of all bodies, from the matrix of the bulk."""
        forces = Forces(mat, self.layout, self.first, self.count)
        return PoissonRatio(self.space, self.part, forces)

    def _Rigid(self, values: np.ndarray) -> Iterator[tuple[int, np.ndarray, float, float]]:
        """Of each body its number, rigid motion, how far that takes it, and how far the rest."""
        for part, combinations, rows, motions in self._Loose():
            moved = values[rows]
            weights = np.linalg.lstsq(motions, moved)[0]
            rigid = motions @ weights
            far, rest = np.max(np.abs(rigid)), np.max(np.abs(moved - rigid))
            yield part, combinations @ weights, far, rest


class NoBodies(Bodies):
    """Bodies with mass, however small: nothing floats but tools, which have none."""

    def __init__(self):
        self.names, self.motions = ["unknown"], np.zeros((0, 0))

    def PoissonRatio(self, _: BaseMatrix) -> float:
        """Not known: the matrix is that of the mass, too."""
        return 0.0


def Norm(matrix: np.ndarray) -> float:
    """The largest singular value of a tall matrix."""
    return np.sqrt(np.linalg.norm(matrix.T @ matrix, 2))
