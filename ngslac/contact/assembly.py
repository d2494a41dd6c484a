# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact without names: which faces of many bodies face each other."""

from __future__ import annotations

import pickle
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import scipy
from netgen.meshing import FaceDescriptor
from ngsolve import (
    BND,
    CF,
    ET,
    H1,
    VOL,
    BilinearForm,
    FacetFESpace,
    FESpace,
    GridFunction,
    IntegrationRule,
    LinearForm,
    Mesh,
    Region,
    ds,
    dx,
    specialcf,
    x,
    y,
    z,
)

from ngslac._ngslac import BoundaryVertices, LACSpace
from ngslac.arguments import CheckInstance, CheckNumber, CheckPositive, Wrong
from ngslac.arrays import AsBits, AsNumPy, ToCSR
from ngslac.contact.contact import LACContact
from ngslac.output.facepoints import OnePoint

if TYPE_CHECKING:
    from ngsolve.comp import ProxyFunction
    from scipy.sparse import csr_matrix

__all__ = ["Assembly", "FindContacts", "Pair"]

PARTS = 5  # of the sides of a face, between which it is looked at
BEYOND = 3.0  # times the distance of pairs: bodies farther apart are not reported
NEXT = 0.75  # of the distance of points: a point above a face has one of it nearer than that
NEAREST = 8  # points that a way through a thin sheet is looked for at
SHOWN = 5  # lines of what is left out
ALIKE = 0.2  # relative difference of sizes, or moduli, that decides nothing


def Lattice(parts: int) -> dict[ET, IntegrationRule]:
    """Points of faces of all kinds, in the middles of so many parts of each side."""
    ticks = [(k + 0.5) / parts for k in range(parts)]
    square = [(s, t) for s in ticks for t in ticks]
    triangle = [(s + 0.5 / parts / 3, t + 0.5 / parts / 3) for s, t in square]
    kinds = {
        ET.SEGM: [(s,) for s in ticks],
        ET.QUAD: square,
        ET.TRIG: [p for p in triangle if sum(p) < 1],
    }
    return {kind: IntegrationRule(p, [1.0] * len(p)) for kind, p in kinds.items()}


@dataclass
class Pair:
    """Two bodies that face each other.

    Attributes
    ----------
    slave, master : str
        Names of the bodies.
    slave_faces, master_faces : Region
        Of `Assembly.mesh`: the boundaries that have faces which face each other.
    gap : (float, float)
        Between which limits the distance is there, along the slave's normals; < 0: they overlap.
    sizes : (float, float)
        Mean sizes of the faces of slave and master there.
    count : int
        Faces of the slave there.
    tied : bool
        Are they tied?
    """

    slave: str
    master: str
    gap: tuple
    sizes: tuple
    count: int
    tied: bool
    slave_faces: Region | None = field(default=None, repr=False)
    master_faces: Region | None = field(default=None, repr=False)
    bodies: tuple = field(default=(), repr=False)  # numbers
    materials: list = field(default_factory=list, repr=False)  # of both

    def __str__(self) -> str:
        """In a line: both sides, their sizes, and the gap."""
        low, high = self.gap
        kind = "tied to" if self.tied else "on"
        return (
            f"{self.slave} ({self.count} faces of size {self.sizes[0]:.3g}) {kind} {self.master} "
            f"({self.sizes[1]:.3g}), gap {low:.3g} to {high:.3g}"
        )


class Assembly:
    """Bodies that face each other, of `FindContacts`.

    Attributes
    ----------
    mesh : ngsolve.Mesh
        The mesh, or where bodies share a boundary a copy, with the same names.
    pairs : list of Pair
    left_out : list of str
        What is near to each other, but not paired, and why.
    """

    def __init__(self, mesh: Mesh, pairs: Sequence[Pair], left_out: list[str], faces: Faces):
        self.mesh, self.pairs, self.left_out = mesh, pairs, left_out
        self._groups, self._body, self._names = Groups(pairs), faces.body, faces.names

    def __str__(self) -> str:
        lines = [str(pair) for pair in self.pairs] or ["no bodies face each other"]
        lines += [f"left out: {line}" for line in self.left_out[:SHOWN]]
        more = len(self.left_out) - SHOWN
        return "\n".join(lines + [f"and {more} more"] * (more > 0))

    def Spaces(self, V: FESpace, **flags) -> list:
        """Spaces of multipliers, for the product with the displacement: few, whatever is paired.

        Parameters
        ----------
        V : ngsolve.FESpace
            Displacement, on `mesh`.
        **flags
            Further arguments of `LACSpace`.

        Returns
        -------
        list of LACSpace
        """
        return [LACSpace(V, slave=_Together(g, "slave_faces"), **flags) for g in self._groups]

    def Contacts(self, u: ProxyFunction, lams: Sequence[ProxyFunction], **law) -> list:
        """The contacts, for `ContactSolver`.

        Parameters
        ----------
        u : trial function
            Displacement.
        lams : list of trial functions
            Of the `Spaces`, in their order.
        **law
            Further arguments of `LACContact`; those of friction do not count for what is tied.

        Returns
        -------
        list of LACContact

        Raises
        ------
        ValueError
            There are more or less multipliers than spaces.
        """
        if len(lams) != len(self._groups):
            raise ValueError(f"lams has {len(lams)} parts: give one for each of Spaces(V)")
        contacts = []
        for group, lam in zip(self._groups, lams, strict=True):
            own = {"tied": True, "finite": law.get("finite", False)} if group[0].tied else law
            contacts.append(LACContact(u, lam, master=_Together(group, "master_faces"), **own))
        return contacts

    def Forces(self, contacts: Sequence[LACContact]) -> dict:
        """The force on the slave of each pair, of those, too, that have met since.

        Parameters
        ----------
        contacts : list of LACContact
            Of `Contacts`.

        Returns
        -------
        dict
            A vector (d,) for each pair of names (slave, master).
        """
        forces = {}
        for contact in contacts:
            segments, names = contact.Segments(), self._names
            macro = np.array(contact.space.macros)[segments.slave]
            share = segments.area / np.bincount(macro, segments.area)[macro]
            force = share[:, None] * contact.form.Resultants()["force"][macro]
            bodies = np.stack([self._body[segments.slave], self._body[segments.master]])
            kinds, kind = np.unique(bodies, axis=1, return_inverse=True)
            for number, (slave, master) in enumerate(kinds.T):
                key = names[slave], names[master]
                forces[key] = forces.get(key, 0) + force[kind.ravel() == number].sum(axis=0)
        return forces


def _Together(group: list[Pair], name: str) -> Region:
    """The faces of all pairs of a group, as one region."""
    return sum((getattr(pair, name) for pair in group[1:]), getattr(group[0], name))


def Groups(pairs: Sequence[Pair]) -> list[list[Pair]]:
    """Pairs that one contact holds: there a body is slave or master, not both."""
    groups = []
    for pair in pairs:
        slave, master = pair.bodies
        for known, slaves, masters, tied in groups:
            if tied == pair.tied and slave not in masters and master not in slaves:
                group = known
                break
        else:
            group, slaves, masters = [], set(), set()
            groups.append((group, slaves, masters, pair.tied))
        group.append(pair)
        slaves.add(slave), masters.add(master)
    return [group for group, *_ in groups]


def FindContacts(
    mesh: Mesh,
    *,
    within: float,
    sliding: float = 0.0,
    angle: float = 45.0,
    masters: Sequence[str] = (),
    tied: Sequence[tuple[str, str]] = (),
    young: dict[str, float] | None = None,
) -> Assembly:
    """Find which faces of many bodies face each other; their boundaries need no names.

    Bodies are what shares no vertex. Exterior faces of two of them are paired where they are not
    farther apart than a distance, and look at each other. The slave is the body with the smaller
    faces there; where these are alike (to 20 %) the softer one, if moduli are given, else the
    smaller body, and of like bodies the one that lies first by its coordinates, the last one first.

    Parameters
    ----------
    mesh : ngsolve.Mesh
        It is not changed.
    within : float
        Distance up to which faces are paired; so deep they may overlap.
    sliding : float
        For contacts with ``finite=True``: faces up to so far from another body count, too, wherever
        they look, as they may meet it.
    angle : float
        In degrees: by how much normals may differ from opposite ones.
    masters : list of str, optional
        Names of materials whose bodies are masters, such as a base that is held all over, where
        they face others.
    tied : list of (str, str), optional
        Names of materials, the bodies of which are tied where they face each other.
    young : dict, optional
        Young's moduli by names of materials.

    Returns
    -------
    Assembly

    Raises
    ------
    ValueError, TypeError
        No distance, an angle outside of 0 to 90, names that are no materials.

    Examples
    --------
    >>> from netgen.occ import Box, Compound, OCCGeometry
    >>> from ngslac import FindContacts
    >>> from ngsolve import FESpace
    >>> floor, brick = Box((0, 0, -1), (3, 3, 0)), Box((1, 1, 0.01), (2, 2, 1))
    >>> floor.solids.name, brick.solids.name = "floor", "brick"
    >>> brick.faces.maxh = 0.2
    >>> mesh = Mesh(OCCGeometry(Compound([floor, brick])).GenerateMesh(maxh=0.5))
    >>> found = FindContacts(mesh, within=0.05)
    >>> [(pair.slave, pair.master) for pair in found.pairs]
    [('brick', 'floor')]
    >>> V = VectorH1(found.mesh, order=2)
    >>> fes = FESpace([V, *found.Spaces(V)])
    >>> u, *lams = fes.TrialFunction()
    >>> contacts = found.Contacts(u, lams, friction=0.2)
    """
    CheckInstance("mesh", mesh, Mesh, "an ngsolve.Mesh")
    if mesh.dim < 2 or not mesh.ne:
        raise ValueError("mesh has no bodies: it needs elements in 2D, or solid ones in 3D")
    if mesh.comm.size > 1:
        raise ValueError("mesh is distributed: name the faces, FindContacts is for one process")
    if mesh.deformation is not None:
        raise ValueError("mesh has a deformation, which its copy would not have: unset it")
    CheckPositive("within", within, "a positive length")
    CheckNumber("sliding", sliding, "a length >= 0", lambda s: 0 <= s < np.inf)
    CheckNumber("angle", angle, "an angle from 0 to 90 degrees", lambda a: 0 <= a <= 90)
    CheckMaterials(mesh, masters, tied, young)
    faces = Faces(mesh)
    facing, left_out = AllFacing(faces, Reach(within, sliding, np.cos(np.radians(angle))))
    pairs, sides = [], []
    for bodies, found in facing.items():
        order = (0, 1) if SlaveOf(faces, bodies, found, masters, young) == 0 else (1, 0)
        slave, master = (bodies[k] for k in order)
        chosen = [found.faces[k] for k in order]
        kinds = faces.materials[slave], faces.materials[master]
        pairs.append(
            Pair(
                faces.names[slave],
                faces.names[master],
                found.gap,
                tuple(float(faces.size[c].mean()) for c in chosen),
                len(chosen[0]),
                any(a in kinds[k] and b in kinds[1 - k] for a, b in tied for k in (0, 1)),
                bodies=(slave, master),
                materials=kinds[0] + kinds[1],
            )
        )
        sides += chosen
    for a, b in tied:
        if not any(pair.tied and {a, b} <= set(pair.materials) for pair in pairs):
            left_out.insert(0, f"the tie of {a} to {b}: no bodies of these face each other")
    divided, boundary = Divided(mesh, faces)
    for pair, *both in zip(pairs, sides[::2], sides[1::2], strict=True):
        pair.slave_faces, pair.master_faces = (RegionOf(divided, boundary[side]) for side in both)
    return Assembly(divided, pairs, left_out, faces)


def CheckMaterials(
    mesh: Mesh,
    masters: Sequence[str],
    tied: Sequence[tuple[str, str]],
    young: dict[str, float] | None,
) -> None:
    """Names of materials, alone, in pairs, and with numbers."""
    names, wanted = set(mesh.GetMaterials()), "a list of names of materials"
    if isinstance(masters, str):
        raise Wrong(TypeError, "masters", masters, wanted)
    for two in tied:
        if isinstance(two, str) or len(two) != 2:
            raise Wrong(ValueError, "tied", tied, "a list of pairs of names of materials")
    if young is not None:
        CheckInstance("young", young, dict, "a dict of numbers by names of materials")
    given = {"masters": masters, "tied": [n for two in tied for n in two], "young": young or ()}
    for argument, some in given.items():
        for name in some:
            if name not in names:
                raise Wrong(ValueError, argument, name, f"one of {', '.join(sorted(names))}")


def Bodies(graph: csr_matrix, points: np.ndarray) -> tuple[int, np.ndarray]:
    """How many connected parts there are, and that of each vertex, numbered by their places."""
    count, part = scipy.sparse.csgraph.connected_components(graph)
    low, high = np.full((2, count, points.shape[1]), [[[np.inf]], [[-np.inf]]])
    np.minimum.at(low, part, points)
    np.maximum.at(high, part, points)
    middle = np.round((low + high) / 2 / np.ptp(points, axis=0).max(), 6)
    order = np.lexsort(middle.T)
    number = np.empty(count, dtype=int)
    number[order] = np.arange(count)
    return count, number[part]


class Faces:
    """The exterior faces of all bodies: points on them, normals, sizes and bodies."""

    def __init__(self, mesh: Mesh):
        self.mesh, d = mesh, mesh.dim
        V = H1(mesh, order=1)
        u, v = V.TnT()
        graph = ToCSR(BilinearForm(u * v * dx).Assemble().mat)
        count, vertex = Bodies(graph, np.asarray(mesh.ngmesh.Coordinates())[: mesh.nv, :d])
        self.body = vertex[BoundaryVertices(mesh)[:, 0]]
        self._Name(V, vertex, count)
        at = CF((x, y, z)[:d])
        middle = mesh.MapToAllElements(OnePoint(), BND)
        corners = mesh.MapToAllElements(Lattice(PARTS), BND)
        self.owner, self.points = corners["nr"], at(corners)
        far = np.zeros(len(self.body))
        away = np.linalg.norm(self.points - at(middle)[self.owner], axis=1)
        np.maximum.at(far, self.owner, away)
        self.size = 2 * PARTS / (PARTS - 1) * far
        self.spacing = self.size / PARTS  # of the points
        outwards, self.exterior = self._Outwards(middle)
        normal = specialcf.normal(d)
        way = np.where(np.sum(normal(middle) * outwards, axis=1) < 0, -1, 1)[self.owner]
        self.normal = way[:, None] * normal(corners)  # at the points
        self.count = count

    def _Outwards(self, middle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Outward normals in the middles, times areas, and which faces have one side only."""
        V = FacetFESpace(self.mesh, order=0)
        w, sums = V.TestFunction(), []
        around = dx(element_boundary=True)
        normal = specialcf.normal(self.mesh.dim)
        for form in (w * ds, w * around, *(n * w * around for n in normal)):
            sums.append(GridFunction(V))
            sums[-1].vec.data = LinearForm(form).Assemble().vec
        area, both, *outwards = (one(middle)[:, 0] for one in sums)
        return np.stack(outwards, axis=1), both < 1.5 * area

    def _Name(self, V: FESpace, vertex: np.ndarray, count: int) -> None:
        """After the materials; where several bodies have the same, with a number."""
        self.materials = [[] for _ in range(count)]
        names = np.array(self.mesh.GetMaterials())
        for name in dict.fromkeys(names.tolist()):
            dofs = AsNumPy(V.GetDofs(Region(self.mesh, VOL, AsBits(names == name))))
            for body in np.unique(vertex[dofs]):
                self.materials[body].append(name)
        alike = Counter(map("+".join, self.materials))
        seen, self.names = Counter(), []
        for name in map("+".join, self.materials):
            seen[name] += 1
            label = name if alike[name] == 1 else f"{name} {seen[name]}"
            self.names.append(label if alike[name] == 1 or label not in alike else f"{label}'")


@dataclass
class Facing:
    """Where two bodies face each other: numbers of faces of both, and least and largest gap."""

    faces: tuple
    gap: tuple


@dataclass
class Reach:
    """The distances up to which faces meet, and how opposite their normals have to be."""

    within: float
    sliding: float
    cosine: float

    @property
    def farthest(self) -> float:
        """Of both lengths the larger one."""
        return max(self.within, self.sliding)


def AllFacing(faces: Faces, reach: Reach) -> tuple[dict[tuple[int, int], Facing], list[str]]:
    """A `Facing` for each pair of bodies, and texts about others that are near."""
    points = np.flatnonzero(faces.exterior[faces.owner])
    body = faces.body[faces.owner[points]]
    points, ends = points[np.argsort(body, kind="stable")], np.bincount(body, minlength=faces.count)
    of = np.split(points, np.cumsum(ends)[:-1])
    low = np.array([np.min(faces.points[own], axis=0, initial=np.inf) for own in of])
    high = np.array([np.max(faces.points[own], axis=0, initial=-np.inf) for own in of])
    apart = np.maximum(low[:, None] - high, low - high[:, None]).max(axis=2)
    found, left_out, farthest = {}, [], BEYOND * reach.farthest
    for a, b in np.argwhere(np.triu(apart <= farthest + faces.spacing.max(), 1)):
        near = [
            Near(faces, of[one], (low[other], high[other]), farthest)
            for one, other in ((a, b), (b, a))
        ]
        if not all(map(len, near)):
            continue
        looks = [Looks(faces, *sides, reach) for sides in (near, near[::-1])]
        ours, theirs = (np.union1d(look.faces, other.seen) for look, other in (looks, looks[::-1]))
        gaps, close = np.concatenate([look.gaps for look in looks]), looks[0].distance
        if len(ours):
            found[a, b] = Facing((ours, theirs), (float(gaps.min()), float(gaps.max())))
        elif close <= farthest:
            why = "no faces look at each other there"
            if close > reach.farthest:
                why = "farther than faces are paired"
            names = f"{faces.names[a]} and {faces.names[b]}"
            left_out.append((close, f"{names}, about {close:.2g} apart: {why}"))
    left_out = [line for _, line in sorted(left_out)]
    return found, left_out


def Near(
    faces: Faces, points: np.ndarray, box: tuple[np.ndarray, np.ndarray], farthest: float
) -> np.ndarray:
    """The points whose surroundings reach into a box."""
    reach = farthest + faces.spacing[faces.owner[points]][:, None]
    inside = (faces.points[points] >= box[0] - reach) & (faces.points[points] <= box[1] + reach)
    return points[np.all(inside, axis=1)]


@dataclass
class Look:
    """Faces that see others, these, the gaps, and the least distance of all."""

    faces: np.ndarray
    seen: np.ndarray
    gaps: np.ndarray
    distance: float


def Looks(faces: Faces, points: np.ndarray, others: np.ndarray, reach: Reach) -> Look:
    """The faces with these points that see others, and the others, as a `Look`."""
    spacing = faces.spacing[faces.owner[others]]
    nearest = Opposite(faces, others, points, reach.farthest, 1)
    seen, face = others[nearest], faces.owner[points]
    normal = faces.normal[points]
    apart = faces.points[seen] - faces.points[points]
    distance = np.linalg.norm(apart, axis=1)
    gap, aside = AlongAside(apart, normal)
    opposite = np.sum(normal * faces.normal[seen], axis=1) <= -reach.cosine
    sees = opposite & (np.abs(gap) <= reach.within) & (aside <= NEXT * spacing[nearest])
    deep = np.flatnonzero(sees & (gap < 0))
    sees[deep[Crosses(faces, points, deep, -gap[deep], reach)]] = False
    facing = gap[sees]
    sees |= distance <= reach.sliding
    gaps, seen = facing if len(facing) else gap[sees], faces.owner[seen[sees]]
    return Look(np.unique(face[sees]), np.unique(seen), gaps, distance.min())


def AlongAside(apart: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parts of vectors along unit normals, with sign, and the lengths of the rest."""
    along = np.sum(apart * normal, axis=-1)
    return along, np.linalg.norm(apart - along[..., None] * normal, axis=-1)


def Opposite(
    faces: Faces, points: np.ndarray, start: np.ndarray, length: float, count: int
) -> np.ndarray:
    """Of some points the nearest ones to others with opposite normals: as positions in `points`.

    Where normals do not fit, that counts as if points were by a `length`, or a face, farther apart.
    """
    turn = length + faces.spacing[faces.owner[points]].max()
    tree = scipy.spatial.cKDTree(np.hstack([faces.points[points], turn * faces.normal[points]]))
    wanted = np.hstack([faces.points[start], -turn * faces.normal[start]])
    return tree.query(wanted, k=count, workers=1)[1]


def Crosses(
    faces: Faces, points: np.ndarray, chosen: np.ndarray, depth: np.ndarray, reach: Reach
) -> np.ndarray:
    """Do ways inwards from chosen ones of some points leave the own body, as a thin sheet?"""
    if not len(chosen):
        return np.zeros(0, dtype=bool)
    start = points[chosen]
    near = Opposite(faces, points, start, depth.max(), min(NEAREST, len(points)))
    other, normal = points[near.reshape(len(start), -1)], faces.normal[start][:, None]
    apart = faces.points[other] - faces.points[start][:, None]
    outwards, aside = AlongAside(apart, normal)
    opposite = np.sum(normal * faces.normal[other], axis=2) <= -reach.cosine
    before = (outwards < 0) & (-outwards < depth[:, None])
    beside = aside <= 2 * faces.spacing[faces.owner[other]]
    return np.any(opposite & before & beside, axis=1)


def ModulusOf(materials: list[str], young: dict[str, float]) -> float:
    """The mean of those that are known; NaN if none is."""
    known = [young[name] for name in materials if name in young]
    return np.mean(known) if known else np.nan


def SlaveOf(
    faces: Faces,
    bodies: tuple[int, int],
    found: Facing,
    masters: Sequence[str],
    young: dict[str, float] | None,
) -> int:
    """Which of two bodies, 0 or 1, is the slave."""
    holds = [any(name in masters for name in faces.materials[body]) for body in bodies]
    if holds[0] != holds[1]:
        return int(holds[0])
    sizes = [faces.size[own].mean() for own in found.faces]
    moduli = [ModulusOf(faces.materials[body], young or {}) for body in bodies]
    areas = [np.sum(faces.size[faces.body == body] ** (faces.mesh.dim - 1)) for body in bodies]
    for values in (sizes, moduli, areas):
        if abs(values[0] - values[1]) > ALIKE * max(values):
            return int(values[1] < values[0])
    return 0


def Divided(mesh: Mesh, faces: Faces) -> tuple[Mesh, np.ndarray]:
    """The mesh, or a copy where no boundary belongs to two bodies, and the boundary of each face.

    Names stay. Boundaries of a geometry belong to one body each, and stay whole.
    """
    ngmesh, boundary = mesh.ngmesh, BoundaryOf(mesh)
    kinds = np.unique(np.stack([boundary, faces.body]), axis=1)
    shared = np.flatnonzero(np.bincount(kinds[0]) > 1)
    if not len(shared):
        return mesh, boundary
    ngmesh, names = pickle.loads(pickle.dumps(ngmesh)), list(mesh.GetBoundaries())
    elements = ngmesh.Elements1D() if mesh.dim == 2 else ngmesh.Elements2D()
    index = elements.NumPy()["index"]
    for old, body in kinds.T[np.isin(kinds[0], shared)]:
        chosen = np.flatnonzero((boundary == old) & (faces.body == body))
        names.append(names[old])
        index[chosen] = len(names)
        if mesh.dim == 3:
            own = ngmesh.FaceDescriptor(int(mesh.ngmesh.Elements2D().NumPy()["index"][chosen[0]]))
            place = {"domin": own.domin, "domout": own.domout, "bc": len(names)}
            index[chosen] = ngmesh.Add(FaceDescriptor(surfnr=own.surfnr, **place))
        ngmesh.SetBCName(len(names) - 1, names[-1])
    copy = Mesh(ngmesh)
    if copy.GetCurveOrder() != mesh.GetCurveOrder():
        copy.Curve(mesh.GetCurveOrder())
    return copy, BoundaryOf(copy)


def BoundaryOf(mesh: Mesh) -> np.ndarray:
    """Number of the boundary of each face."""
    ngmesh = mesh.ngmesh
    if mesh.dim == 2:
        return ngmesh.Elements1D().NumPy()["index"] - 1
    own = np.array([descriptor.bc - 1 for descriptor in ngmesh.FaceDescriptors()])
    return own[ngmesh.Elements2D().NumPy()["index"] - 1]


def RegionOf(mesh: Mesh, boundaries: np.ndarray) -> Region:
    """Boundaries by their numbers."""
    mask = np.zeros(len(mesh.GetBoundaries()), dtype=bool)
    mask[boundaries] = True
    return Region(mesh, BND, AsBits(mask))
