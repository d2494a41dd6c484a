# SPDX-License-Identifier: LGPL-2.1-or-later
"""The whole of a distributed mesh on its first process, for files of the whole problem."""

from __future__ import annotations

import numpy as np
from ngsolve import BND, FESpace, Mesh, ProductSpace, Region

from ngslac._ngslac import LACSpace, PieceOf, WholeMesh
from ngslac.parallel.layout import LayoutOf
from ngslac.parallel.skin import ByElements, CopyOf, EmptyLike, Places
from ngslac.parallel.together import Together

__all__ = ["AsWhole", "WholeCopy"]


def AsWhole(space: FESpace) -> WholeCopy | Itself:
    """A WholeCopy of a space; in one process the space as it is."""
    return WholeCopy(space) if space.mesh.comm.size > 1 else Itself(space)


class Itself:
    """The methods of a WholeCopy where one process has everything."""

    def __init__(self, space: FESpace):
        self.space, self.size = space, space.ndof * space.dim

    def Gather(self, values: np.ndarray) -> np.ndarray:
        """See WholeCopy."""
        return np.asarray(values)

    def Scatter(self, values: np.ndarray) -> np.ndarray:
        """See WholeCopy."""
        return values


class WholeCopy:
    """A space on the whole mesh, made on the first process for as long as this is kept.

    Attributes
    ----------
    space : FESpace or None
        On the first process, else None.
    size : int
        The number of all rows.
    """

    def __init__(self, space: FESpace):
        self._layout, self.together = LayoutOf(space), Together.Of(space.mesh)
        self._mesh, self._places = None, []
        self._Gather(space.mesh)
        self.space, places = self._Copy(space)
        self._rows = self.together.Gather(places)
        self.size = self.together.Tell(self.space and self.space.ndof * self.space.dim)

    def _Gather(self, mesh: Mesh) -> None:
        """Gather the mesh, and find the numbers of the elements of each process in it."""
        tables = list(map(np.array, PieceOf(mesh)))
        pieces = self.together.comm.gather(tables)
        order = self.together.Reduce(mesh.GetCurveOrder(), "MAX")
        if pieces is None:
            return
        every = tuple(map(np.concatenate, zip(*pieces, strict=True)))
        self._mesh = WholeMesh(Mesh(EmptyLike(mesh)), every)
        if self._mesh.GetCurveOrder() != order:
            self._mesh.Curve(int(order))
        volume = 2 if mesh.dim == 3 else 3
        self._places = [Places(every[volume], piece[volume]) for piece in pieces]

    def _Copy(self, space: FESpace) -> tuple[FESpace | None, np.ndarray]:
        """Copy the space to the first process; also find the numbers there of the rows here."""
        if type(space) is ProductSpace:
            copies, places = zip(*map(self._Copy, space.components), strict=True)
            copy = FESpace(list(copies)) if self._mesh is not None else None
            starts = copy and [copy.Range(k).start * copy.dim for k in range(len(copies))]
            starts = self.together.Tell(starts)
            return copy, np.concatenate([p + s for p, s in zip(places, starts, strict=True)])
        if isinstance(space, LACSpace):
            return self._Macros(space), np.arange(space.ndof * space.dim)
        copy = CopyOf(space, self._mesh) if self._mesh is not None else None
        each = copy and [ByElements(copy, places) for places in self._places]
        there = self.together.comm.scatter(each)
        here = ByElements(space, np.arange(space.mesh.ne))
        numbers, d = np.zeros(space.ndof, dtype=int), space.dim
        numbers[here[here >= 0]] = there[here >= 0]
        return copy, (d * numbers[:, None] + np.arange(d)).ravel()

    def _Macros(self, space: LACSpace) -> LACSpace | None:
        """Make the same macro-elements on the whole mesh."""
        if self._mesh is None:
            return None
        V = CopyOf(space.displacement, self._mesh)
        slave = Region(self._mesh, BND, space.slave.Mask())
        return LACSpace(V, slave=slave, axisymmetric=space.axisymmetric)

    def Gather(self, values: np.ndarray) -> np.ndarray | None:
        """Gather values (size, ...) of all rows on the first process; others get None."""
        values = np.asarray(values)
        mine = np.flatnonzero(self._layout.owned)
        found = self.together.comm.gather((mine, values[mine]))
        if found is None:
            return None
        whole = np.zeros((self.size, *values.shape[1:]), values.dtype)
        for rows, (own, part) in zip(self._rows, found, strict=True):
            whole[rows[own]] = part
        return whole

    def Scatter(self, values: np.ndarray | None) -> np.ndarray:
        """Give each process its rows of the values that the first process has."""
        parts = None if values is None else [values[rows] for rows in self._rows]
        return self._layout.Of(self.together.comm.scatter(parts))
