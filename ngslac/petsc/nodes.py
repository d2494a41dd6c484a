# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scalar dofs in blocks, as preconditioners and PETSc's block matrices want them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ngslac.bodies.rigidmotions import MotionsOf, SameComponents
from ngslac.linear.vertices import VertexNodes

if TYPE_CHECKING:
    from ngsolve import BitArray, FESpace

    from ngslac.contact.contact import LACContact
    from ngslac.parallel.layout import Layout, Whole

__all__ = ["Nodes"]


@dataclass(frozen=True)
class Nodes:
    """Every scalar dof of a system in one block of d: those of a node of the displacement.

    Attributes
    ----------
    blocks : (k, d) int
        Dofs, -1 where a block is not full.
    vertices : (k,) bool
        Which blocks are those of vertices, whose functions are those of first order.
    motions : (n, m) array
        The rigid motions, see `MotionsOf`.
    """

    blocks: np.ndarray
    vertices: np.ndarray
    motions: np.ndarray

    @classmethod
    def Of(cls, contact: LACContact, freedofs: BitArray) -> Nodes:
        """Those of a contact's product space with these free dofs, a BitArray."""
        form, motions = contact.form, MotionsOf(contact)
        d, first = contact.mesh.dim, form.offset * form.fes.dim
        blocks = Completed(DisplacementNodes(form.component, first, d), contact.layout, d)
        found = VertexNodes.Of(form.component, freedofs, first)
        vertices = np.zeros(len(motions), dtype=bool)
        if found is not None:
            vertices[found.dofs[found.dofs >= 0]] = True
        of_vertices = np.any(vertices[blocks] & (blocks >= 0), axis=1)
        return cls(blocks, of_vertices, motions)

    def With(self, dofs: np.ndarray) -> np.ndarray:
        """Which nodes (k,) have one of the dofs (n,) bool."""
        return np.any(dofs[self.blocks] & (self.blocks >= 0), axis=1)


def DisplacementNodes(space: FESpace, first: int, d: int) -> np.ndarray:
    """The dofs of each node (k, d) of a displacement space whose dofs begin at `first`."""
    if space.dim == d:
        return first + np.arange(space.ndof * d).reshape(-1, d)
    parts = SameComponents(space)
    count = parts[0].ndof if parts else 0
    return first + np.arange(count)[:, None] + count * np.arange(d)


def Completed(blocks: np.ndarray, layout: Layout | Whole, d: int) -> np.ndarray:
    """These blocks and those of all other dofs: of multipliers d in a row, of others one each."""
    apart = np.ones(len(layout.owned), dtype=bool)
    apart[blocks] = False
    multipliers = np.flatnonzero(layout.multipliers & apart)
    multipliers = np.concatenate([multipliers, np.full(-len(multipliers) % d, -1)])
    others = np.flatnonzero(apart & ~layout.multipliers)
    alone = np.full((len(others), d), -1)
    alone[:, 0] = others
    return np.concatenate([blocks, multipliers.reshape(-1, d), alone])
