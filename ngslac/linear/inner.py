# SPDX-License-Identifier: LGPL-2.1-or-later
"""Dofs inside of elements, which are eliminated before linear systems are solved."""

from __future__ import annotations

from typing import TYPE_CHECKING

from netgen.meshing import NgException

from ngslac._ngslac import InnerElimination
from ngslac.arrays import AsBits, AsNumPy
from ngslac.errors import LinearSolveError

if TYPE_CHECKING:
    from ngsolve import BitArray, FESpace
    from ngsolve.la import SparseMatrixd

__all__ = ["InnerDofs"]


class InnerDofs:
    """Eliminates them from the bulk's matrix, once for each one, and from right hand sides.

    What is left are vertices, edges and faces, as after static condensation: smaller systems, and
    with stars of these alone the iterations do not see what is inside.
    """

    def __init__(self, dofs: BitArray):
        self.dofs = dofs
        self.Forget()

    @classmethod
    def Of(
        cls, space: FESpace, freedofs: BitArray, first: int = 0, own: FESpace | None = None
    ) -> InnerDofs | None:
        """Those of the component `own` of a space, whose dofs begin at `first`; None without any.

        Pressures of mixed forms stay: without them nearly incompressible bulks are badly
        conditioned. Spaces of several values for each dof have none.
        """
        own = own or space
        if space.dim > 1 or own.dim > 1 or own.flags.ToDict().get("dgjumps"):
            return None
        inner = AsNumPy(freedofs & space.FreeDofs(False) & ~space.FreeDofs(True))
        inner[:first] = inner[first + own.ndof :] = False
        return cls(AsBits(inner)) if inner.any() else None

    def Forget(self) -> None:
        """The matrix has got other values."""
        self._kept = None, None

    def Eliminate(self, bulk: SparseMatrixd) -> InnerElimination:
        """The InnerElimination of a matrix."""
        if self._kept[0] is not bulk:
            try:
                self._kept = bulk, InnerElimination(bulk, self.dofs)
            except NgException as error:
                raise LinearSolveError(str(error)) from error
        return self._kept[1]
