"""The processes that solve linear systems together, as the conductor sees them."""

from collections import defaultdict
from itertools import count
from weakref import finalize

import numpy as np

from ngslac.arrays import AsNumPy
from ngslac.petsc.nodes import Nodes
from ngslac.petsc.system import PetscSystem

__all__ = ["Team"]


class Team:
    """Calls methods of a PetscSystem on all processes.

    There may be several for a form, whose solvers take turns. All processes end theirs at once, as
    PETSc wants it: when the next one is made.

    Parameters
    ----------
    crew : Crew
    form : RemoteForm
        The bulk.
    contact : LACContact
        The first of those on the space.
    freedofs : BitArray
        Scalar dofs.
    """

    _numbers, _left = count(), defaultdict(dict)  # by number, what is left of teams that are gone

    def __init__(self, crew, form, contact, freedofs):
        self._crew, self._system, self._number = crew, None, next(Team._numbers)
        self._End(crew)
        free = AsNumPy(freedofs)
        given = free, Nodes.Of(contact, freedofs)

        def Own():
            none = np.empty(0, dtype=int)
            self._system = PetscSystem(crew.messages.comm, len(free), none, *given)

        crew.Order("petsc", self._number, None, form.number, len(free), own=Own)
        left = Team._left[crew]
        finalize(self, left.__setitem__, self._number, self._system).atexit = False

    @staticmethod
    def _End(crew):
        left = Team._left[crew]
        gone = [*left]
        if gone:
            crew.Order("petsc", gone, "End", own=lambda: [left.pop(number) for number in gone])

    def Call(self, name, *args):
        """What a method gives here; what workers have no use for, or have themselves, stays."""
        told = [arg if isinstance(arg, (str, float)) else None for arg in args]
        own = args
        if name == "SetBulk":
            told, own = [args[0].form.number], (None,)
        given = self._number, name, *told
        return self._crew.Order("petsc", *given, own=lambda: self._Own(name, own))[0]

    def _Own(self, name, args):
        return getattr(self._system, name)(*args)

    def Get(self, name):
        """An attribute of the PetscSystem here."""
        return getattr(self._system, name)


class TeamMember:
    """A worker's part of linear systems.

    Parameters
    ----------
    ensemble : Ensemble
    """

    def __init__(self, ensemble):
        self._ensemble, self._systems = ensemble, {}

    def Obey(self, number, name, *args):
        """Call a method of the PetscSystem with this number; None: make it."""
        things = self._ensemble.things
        if name is None:
            form, size = args
            comm, dofs = self._ensemble.crew.messages.comm, things[form].dofs
            self._systems[number] = PetscSystem(comm, size, dofs)
        elif name == "End":
            for ended in number:
                self._systems.pop(ended, None)
        elif name == "SetBulk":
            (bulk,) = args
            self._systems[number].SetBulk(things[bulk].Local("mat"))
        else:
            getattr(self._systems[number], name)(*args)
