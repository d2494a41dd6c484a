# SPDX-License-Identifier: LGPL-2.1-or-later
"""Macro-elements of a distributed slave surface: those of the whole mesh."""

import numpy as np

from ngslac._ngslac import LACSpace
from ngslac.parallel.skin import Skin
from ngslac.parallel.together import OnAll

__all__ = ["MacroElements"]


def MeshOf(V, *_):
    """That of a space."""
    return V.mesh


@OnAll(MeshOf)
def MacroElements(V, slave, macros, axisymmetric):
    """What a LACSpace on a distributed mesh has to know."""
    if macros is not None:
        raise ValueError("LACSpace: macros= is not known on a distributed mesh: leave it out")
    skin = Skin.Of(V.mesh)
    skin.Follow()
    home = LACSpace(skin.Trace(V).copy, slave=skin.Region(slave), axisymmetric=axisymmetric)
    skin.homes.append(home)
    numbers = np.array(list(home.macros), dtype=np.int32)
    return home.nmacros, numbers[skin.faces], len(skin.homes) - 1
