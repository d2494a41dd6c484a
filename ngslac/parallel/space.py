# SPDX-License-Identifier: LGPL-2.1-or-later
"""Macro-elements of a distributed slave surface: those of the whole mesh."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ngslac._ngslac import LACSpace, RegionWithFaces
from ngslac.parallel.skin import Skin
from ngslac.parallel.together import OnAll

if TYPE_CHECKING:
    from ngsolve import FESpace, Mesh, Region

__all__ = ["MacroElements"]


def MeshOf(V: FESpace, *_) -> Mesh:
    """The mesh of a space."""
    return V.mesh


@OnAll(MeshOf)
def MacroElements(
    V: FESpace, slave: Region | str, macros: Sequence[int] | None, axisymmetric: bool
) -> tuple[int, np.ndarray]:
    """Number the macro-elements of a LACSpace: their count, and that of each boundary element."""
    if macros is not None:
        raise ValueError("LACSpace: macros= is not known on a distributed mesh: leave it out")
    region = RegionWithFaces(V.mesh, "LACSpace: slave", slave)
    skin = Skin.Of(V.mesh, region)
    skin.Follow()
    there = skin.Trace(V).copy
    home = LACSpace(there, slave=skin.Region(region), axisymmetric=axisymmetric)
    numbers = np.array([*home.macros, -1], dtype=np.int32)  # of faces that it lacks: -1
    return home.nmacros, numbers[skin.faces]
