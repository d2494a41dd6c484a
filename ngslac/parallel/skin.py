# SPDX-License-Identifier: LGPL-2.1-or-later
"""The skin of a distributed mesh: all elements at contact surfaces, as a serial mesh."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import netgen.meshing
import numpy as np
import scipy
from ngsolve import BND, BaseMatrix, BitArray, FESpace, Mesh, ProductSpace, Region

from ngslac._ngslac import ElementDofs, LACSpace, PieceOf, WholeMesh
from ngslac.arrays import AsBits, AsNumPy
from ngslac.parallel.layout import LayoutOf
from ngslac.parallel.together import Recall, Together

if TYPE_CHECKING:
    from netgen.meshing import Mesh as NetgenMesh
    from scipy.sparse import csr_matrix, spmatrix

    from ngslac.parallel.matrices import SkinMatrix

__all__ = ["Skin", "Trace"]

HEAD = 4  # columns of a row of a piece before its points: number, type, region, count


class Skin:
    """The elements that touch some boundaries, as a serial mesh that is the same on all processes.

    Contact surfaces are on it, and each process computes all of the contact.

    Attributes
    ----------
    mesh : Mesh
    faces : (m,) int
        Number on the skin of each boundary element of this process; -1: it is not there.
    """

    def __init__(self, mesh: Mesh, mask: list[bool]):
        self.original, self.mask, self.together = mesh, mask, Together.Of(mesh)
        self._traces = []
        numbers, points, *tables = map(np.array, PieceOf(mesh))
        volumes, surfaces, _, segments, _ = tables
        elements, faces = (volumes, surfaces) if mesh.dim == 3 else (surfaces, segments)
        rows = self.together.Rows
        chosen = [face.nr for face in Region(mesh, BND, BitArray(mask)).Elements()]
        marked = np.unique(rows(PointsOf(faces[chosen])))
        kept = [Touches(table, marked) for table in (volumes, surfaces, segments)]
        of_elements, of_faces = kept[:2] if mesh.dim == 3 else kept[1:]
        tables = [table[kept[k]] for table, k in zip(tables, (0, 1, 1, 2, 2), strict=True)]
        used = [PointsOf(tables[k]) for k in (0, 1, 3)]
        used = np.isin(numbers[:, 0], np.unique(np.concatenate(used)))
        numbers, points, *tables = map(rows, (numbers[used], points[used], *tables))
        known = np.unique(numbers)  # sorted by global numbers, which keeps orientations
        for k in (0, 1, 3):
            wide, inside = PointColumns(tables[k])
            wide[inside] = np.searchsorted(known, wide[inside])
        piece = np.searchsorted(known, numbers).astype(np.int32), points, *tables
        self.mesh = WholeMesh(Mesh(EmptyLike(mesh)), piece)
        every = tables[0:2] if mesh.dim == 3 else tables[1:4:2]
        self.own = np.flatnonzero(of_elements)
        self.places = Places(every[0], elements[self.own])
        self.faces = np.full(len(faces), -1)
        self.faces[of_faces] = Places(every[1], faces[of_faces])
        self.Follow()

    @classmethod
    def Of(cls, mesh: Mesh, *regions: Region | None) -> Skin:
        """Find or make the skin of some boundaries of a distributed mesh; regions may be None."""
        masks = [region.Mask() for region in regions if region is not None]
        mask = [*map(any, zip(*masks, strict=True))]

        def Fits(skin: Skin) -> bool:
            return skin.original == mesh and skin.mask == mask

        return Recall(Together.Of(mesh).skins, Fits, lambda: cls(mesh, mask))

    def Follow(self) -> None:
        """Curve elements as they are in the distributed mesh now."""
        mesh = self.original
        if mesh.deformation is not None:
            raise ValueError(
                "the distributed mesh has a deformation: call mesh.UnsetDeformation(), or Curve it"
            )
        order, levels = (
            self.together.Reduce(number, "MAX") for number in (mesh.GetCurveOrder(), mesh.levels)
        )
        if levels > 1:
            raise ValueError(
                "the mesh was refined after its distribution, which tears it: refine it before, "
                "see ngslac.meshes.Distributed"
            )
        if self.mesh.GetCurveOrder() != order:
            self.mesh.Curve(int(order))

    def Region(self, original: Region | None) -> Region | None:
        """Find a region of the distributed mesh on the skin."""
        if not isinstance(original, Region):
            return original
        return Region(self.mesh, original.VB(), original.Mask())

    def Macros(self, space: LACSpace) -> LACSpace:
        """Make a LACSpace with the same macro-elements on the skin."""
        V, slave = self.Trace(space.displacement).copy, self.Region(space.slave)
        found = LACSpace(V, slave=slave, axisymmetric=space.axisymmetric)
        if found.ndof == space.ndof:
            return found
        return found.WithComponents(space.ndof * space.dim // max(space.nmacros, 1))

    def Trace(self, space: FESpace) -> Trace:
        """Find or make the Trace of a space of the distributed mesh."""
        return Recall(self._traces, lambda trace: trace.space == space, lambda: Trace(self, space))


class Trace:
    """A space of a distributed mesh, its copy on the skin, and the rows that both have.

    Attributes
    ----------
    space, copy : FESpace
    local, there : (k,) int
        Rows of this process that are on the skin, too, and their numbers on the skin.
    count, size : int
        Numbers of rows of this process, and of the skin.
    """

    def __init__(self, skin: Skin, space: FESpace):
        self.skin, self.space = skin, space
        if type(space) is ProductSpace:
            self._Join([skin.Trace(part) for part in space.components])
        elif isinstance(space, LACSpace):
            self.copy = skin.Macros(space)
            self.local = self.there = np.arange(space.ndof * space.dim)
        else:
            self.copy = CopyOf(space, skin.mesh)
            self._Find()
        layout = LayoutOf(space)
        self.count, self.Zeros = space.ndof * space.dim, layout.Zeros
        mine = layout.owned[self.local]
        self._mine = self.local[mine]
        self._order = skin.together.Rows(self.there[mine])
        self._counts = np.array(skin.together.Gather(len(self._mine)))
        self.size = self.copy.ndof * self.copy.dim
        free = self.Gather(AsNumPy(space.FreeDofs()).repeat(space.dim).astype(float))
        bits = self.copy.FreeDofs()
        bits.Clear()
        bits |= AsBits(free.reshape(self.copy.ndof, -1).any(axis=1))

    def _Join(self, parts: Sequence[Trace]) -> None:
        """Join the rows of the parts of a product."""
        self.copy = FESpace([part.copy for part in parts])
        d = self.space.dim
        every = range(len(parts))
        self.local = np.concatenate([parts[k].local + d * self.space.Range(k).start for k in every])
        self.there = np.concatenate([parts[k].there + d * self.copy.Range(k).start for k in every])

    def _Find(self) -> None:
        """Find the rows by the dofs of elements; other processes find the rest."""
        skin, space = self.skin, self.space
        here, there = ByElements(space, skin.own), ByElements(self.copy, skin.places)
        if skin.together.Sum(len(here) != len(there)):
            raise ValueError(
                f"a space of type {space.type} is not known on a distributed mesh: its copy on the "
                "skin has other dofs"
            )
        layout, d, used = LayoutOf(space), space.dim, here >= 0
        numbers = np.zeros(space.ndof)
        numbers[here[used]] = 1.0 + there[used]
        known = np.where(numbers > 0, 1.0, 0.0)
        total, count = (np.asarray(layout.Added(v.repeat(d)))[::d] for v in (numbers, known))
        dofs = np.flatnonzero(count)
        numbers = np.round(total[dofs] / count[dofs]).astype(int) - 1
        self.local, self.there = (
            (d * part[:, None] + np.arange(d)).ravel() for part in (dofs, numbers)
        )

    def Gather(self, values: np.ndarray) -> np.ndarray:
        """Gather values of all processes (size, ...) on the skin; they are the same on all."""
        values = np.asarray(values)
        if isinstance(self.space, LACSpace):  # all processes have them
            return values.copy()
        found = np.zeros((self.size, *values.shape[1:]))
        found[self._order] = self.skin.together.Rows(values[self._mine], self._counts)
        return found

    def GatherSparse(self, columns: spmatrix) -> csr_matrix:
        """Gather a sparse matrix, whose rows are those of this process, on the skin."""
        pieces = self.skin.together.Gather(columns.tocsr()[self._mine])
        found = scipy.sparse.vstack(pieces).tocoo()
        shape = self.size, columns.shape[1]
        where = self._order[found.row], found.col
        return scipy.sparse.coo_matrix((found.data, where), shape=shape).tocsr()

    def Matrix(self, mat: SkinMatrix) -> BaseMatrix:
        """Return the part of a SkinMatrix that is on the skin."""
        return mat.there

    def Add(self, values: np.ndarray, total: np.ndarray) -> None:
        """Add values (size,) on the skin to those of this process."""
        np.asarray(total)[self.local] += values[self.there]

    def Put(self, values: np.ndarray, total: np.ndarray) -> None:
        """Write values (size,) on the skin into those of this process."""
        np.asarray(total)[self.local] = values[self.there]


def EmptyLike(mesh: Mesh) -> NetgenMesh:
    """A serial mesh with the regions, names and geometry of another one."""
    original, empty = mesh.ngmesh, netgen.meshing.Mesh(dim=mesh.dim)
    for region in (*original.FaceDescriptors(), *original.EdgeDescriptors()):
        empty.Add(region)
    for number, name in enumerate(mesh.GetMaterials()):
        empty.SetMaterial(number + 1, name)
    for number, name in enumerate(mesh.GetBoundaries()):
        empty.SetBCName(number, name)
    empty.SetGeometry(original.GetGeometry())
    return empty


def PointColumns(table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The columns with points, and which of their entries (m, k) bool are points."""
    wide = table[:, HEAD : HEAD + table[:, HEAD - 1].max(initial=0)]
    return wide, np.arange(wide.shape[1]) < table[:, HEAD - 1 : HEAD]


def PointsOf(table: np.ndarray) -> np.ndarray:
    """The points of the elements of a table."""
    wide, inside = PointColumns(table)
    return np.unique(wide[inside])


def Touches(table: np.ndarray, marked: np.ndarray) -> np.ndarray:
    """Which elements (m,) bool have one of the marked points?"""
    wide, inside = PointColumns(table)
    return np.any(inside & np.isin(wide, marked), axis=1)


def Places(known: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Find the positions of rows among the known ones, which are sorted by their numbers."""
    return np.searchsorted(np.unique(known[:, 0]), rows[:, 0])


def ByElements(space: FESpace, elements: np.ndarray) -> np.ndarray:
    """Dofs of these elements, one after the other."""
    counts, dofs = ElementDofs(space)
    starts = np.cumsum(counts) - counts
    many = counts[elements]
    first = np.repeat(starts[elements] - (np.cumsum(many) - many), many)
    return dofs[first + np.arange(len(first))].astype(int)


def CopyOf(space: FESpace, mesh: Mesh) -> FESpace:
    """The same kind of space on another mesh."""
    state = space.__getstate__()
    if len(state) != 3:  # a space that contains another one
        raise ValueError(
            f"a {type(space).__name__} space ({space.type}) is not known on a distributed mesh: "
            "take the space in it"
        )
    kind, _, flags = state
    copy = FESpace.__new__(FESpace)
    copy.__setstate__((kind, mesh, flags))
    return copy
