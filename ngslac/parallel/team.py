# SPDX-License-Identifier: LGPL-2.1-or-later
"""The processes that solve linear systems together, as the conductor sees them."""

from functools import partial

import numpy as np

from ngslac.arrays import AsNumPy
from ngslac.parallel.farewell import BeforeOthers
from ngslac.petsc.system import PetscSystem

__all__ = ["Team"]


class Team:
    """Calls methods of a PetscSystem on all processes.

    There may be several for a form, whose solvers take turns. All processes end theirs at once, as
    PETSc wants it: when the conductor has let go its Team.
    """

    def __init__(self, ensemble, form, freedofs, nodes):
        free = AsNumPy(freedofs)
        order = form.number, len(free)
        own = partial(ensemble.crew.tasks["system"], *order, free, nodes)
        self._crew, self._number = ensemble.crew, ensemble.Order("system", *order, own=own)[0]
        self._system = ensemble.things[self._number]
        ensemble.Need(self._number, self)

    def Call(self, name, *args):
        """What a method gives here; what workers have no use for, or have themselves, stays."""
        told = [arg if isinstance(arg, (str, float)) else None for arg in args]
        own = args
        if name == "SetBulk":
            told, own = [args[0].form.number], (None,)
        order = self._number, name, *told
        return self._crew.Order("petsc", *order, own=lambda: self.Get(name)(*own))[0]

    def Get(self, name):
        """An attribute of the PetscSystem here."""
        return getattr(self._system, name)


class TeamMember:
    """A process's part of linear systems."""

    def __init__(self, ensemble):
        self._ensemble = ensemble

    def Make(self, form, size, *options):
        """The number of a PetscSystem of the bulk; `options` are what the conductor tells."""
        ensemble, crew = self._ensemble, self._ensemble.crew
        number = ensemble.NewNumber()  # also where it cannot be made
        dofs = np.empty(0, dtype=int) if crew.conducts else ensemble.things[form].dofs
        ensemble.things[number] = PetscSystem(crew.messages.comm, size, dofs, *options)
        BeforeOthers()
        return number

    def Obey(self, number, name, *args):
        """Call a method of the PetscSystem with this number."""
        things = self._ensemble.things
        if name == "SetBulk":
            args = [things[form].Local("mat") for form in args]
        getattr(things[number], name)(*args)
