# SPDX-License-Identifier: LGPL-2.1-or-later
"""Macro-elements of a distributed slave surface: those of the whole mesh."""

import numpy as np
from ngsolve import Region

from ngslac._ngslac import LACSpace
from ngslac.parallel.ensemble import Ensemble

__all__ = ["MacroElements"]


def MacroElements(V, slave, macros, axisymmetric):
    """What a LACSpace on a distributed mesh has to know."""
    ensemble = Ensemble.Of(V.mesh)
    replica = ensemble.SpaceOf(V)
    own = ensemble.Add([])
    tasks = ensemble.crew.tasks
    tasks["macros"] = lambda number, found: ensemble.things[number].append(found)

    def Make():
        if macros is not None:
            raise ValueError("LACSpace: macros= is not known on a distributed mesh: leave it out")
        mesh = ensemble.mesh.Gather()
        space = ensemble.Space(replica)
        region = Region(mesh, slave.VB(), slave.Mask()) if isinstance(slave, Region) else slave
        home = LACSpace(space, slave=region, axisymmetric=axisymmetric)
        numbers = np.array(list(home.macros), dtype=np.int32)
        ensemble.crew.Order("macros", own, each=[numbers[f] for f in ensemble.mesh.faces])
        ensemble.homes[own] = home
        return home.nmacros

    words = {"slave": slave} if isinstance(slave, str) else {}
    count = ensemble.InStep("LACSpace", Make, words | {"axisymmetric": axisymmetric})
    faces = ensemble.things[own][0] if ensemble.things[own] else np.empty(0, np.int32)
    return count, faces, own
