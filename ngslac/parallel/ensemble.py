# SPDX-License-Identifier: LGPL-2.1-or-later
"""What belongs to a distributed mesh: its processes, and what of it the conductor has twice."""

from itertools import count
from weakref import WeakValueDictionary

from ngsolve import ProductSpace

from ngslac._ngslac import LACSpace
from ngslac.arrays import AsNumPy
from ngslac.parallel.crew import Crew, OutOfStepError
from ngslac.parallel.farewell import Join
from ngslac.parallel.functions import UserFunctions
from ngslac.parallel.pairs import Pairs
from ngslac.parallel.replica import MeshReplica, SpaceReplica
from ngslac.parallel.team import TeamMember

__all__ = ["Ensemble"]

KNOWN = []


class Ensemble:
    """All that the processes of one distributed mesh know of each other's objects.

    Things have numbers, which are the same on all processes, since all of them make the same calls.
    """

    @classmethod
    def Of(cls, mesh):
        """That of a distributed mesh."""
        for known in KNOWN:
            if known.mesh.original == mesh:
                return known
        KNOWN.append(cls(mesh))
        return KNOWN[-1]

    def __init__(self, mesh):
        self.crew = Crew(mesh.comm.mpi4py)
        Join(self.crew)
        self.mesh = MeshReplica(mesh, self.crew)
        # By number, on all processes, as long as the conductor needs them; on the conductor what
        # stands there for them; what users hold, by the same keys.
        self.things, self.homes, self.twins = {}, {}, WeakValueDictionary()
        # The context is the SpaceReplica of the product space that was spoken of last.
        self._next, self._parameters, self.context = 0, [], None
        self.results = count()
        self._needs = WeakValueDictionary()
        self.pairs = Pairs(self)
        self.Agree()
        team = TeamMember(self)
        self.crew.tasks |= {
            "dofs": lambda number, told: self.things[number].LearnDofs(told),
            "free": lambda number: self.things[number].Free(),
            "form": lambda number, verb, *args: getattr(self.things[number], verb)(*args),
            "drop": self._Drop,
            "system": team.Make,
            "petsc": team.Obey,
            "with": self._With,
            "bits": lambda number: AsNumPy(self.things[number]),
            "nothing": lambda: None,
        } | UserFunctions(self).tasks

    # --- calls ---------------------------------------------------------------------------------

    def Call(self, name, work, arguments):
        """What `work` gives on the conductor, on all processes; users' functions follow."""

        def Work():
            self.mesh.Follow()
            self.pairs.Read()
            try:
                return work()
            finally:
                self.Show()
                self._Tidy()

        return self.InStep(name, Work, arguments)

    def InStep(self, name, work, arguments):
        """See `Crew.Call`; what processes that are out of step have added loses its number."""
        try:
            return self.crew.Call(name, work, arguments)
        except OutOfStepError:
            self._next, self.pairs.next = self._agreed
            new = [number for number in self.things if number >= self._next]
            self._Drop(new, [key for key in self.pairs.known if key >= self.pairs.next])
            raise
        finally:
            self.Agree()

    def Agree(self):
        """So far all processes have the same numbers."""
        self._agreed = self._next, self.pairs.next

    def Show(self):
        """Let users see the conductor's functions and parameters."""
        self.pairs.Write()
        if self._parameters:
            self.Order("nothing")

    def Order(self, task, *args, own=None, each=None):
        """See `Crew.Order`: parameters have on all processes the values of the conductor."""
        values = [(number, self.things[number].Get()) for number in self._parameters]
        return self.crew.Order("with", values, task, *args, own=own, each=each)

    def _With(self, values, task, *args):
        for number, value in values:
            if self.things[number].Get() != value:
                self.things[number].Set(value)
        return self.crew.tasks[task](*args)

    # --- things --------------------------------------------------------------------------------

    def NewNumber(self):
        """One that all processes take at once."""
        self._next += 1
        return self._next - 1

    def Add(self, thing):
        """The number of a thing that all processes have."""
        number = self.NewNumber()
        self.things[number] = thing
        return number

    def Need(self, number, home):
        """The conductor needs a thing as long as it has a certain object."""
        if self.crew.conducts:
            self._needs[number] = home

    def NeededBy(self, number):
        """The object on the conductor that needs a thing; None: it is gone."""
        return self._needs.get(number)

    def NumberOf(self, thing):
        """The number of a thing; a new one where it is not known."""
        for number, known in self.things.items():
            if known is thing:
                return number
        return self.Add(thing)

    def _Tidy(self):
        """All processes drop what the conductor needs no more, but for spaces."""
        things = self.things.items()
        gone = [(n, thing) for n, thing in things if n not in self._needs]
        numbers = [n for n, thing in gone if not isinstance(thing, SpaceReplica)]
        keys = self.pairs.Ended()
        if numbers or keys:
            self.Order("drop", numbers, keys, own=lambda: self._Drop(numbers, keys))

    def _Drop(self, numbers, keys):
        for number in numbers:
            self.things.pop(number, None)
            if number in self._parameters:
                self._parameters.remove(number)
        for key in keys:
            self.pairs.known.pop(key, None)

    def AddParameter(self, parameter):
        """Let a parameter have the conductor's value everywhere, from the next order on."""
        number = self.NumberOf(parameter)
        if number not in self._parameters:
            self._parameters.append(number)
            self.Need(number, parameter)

    def Original(self, number):
        """What users have of a form or a LACSpace with this number on the conductor."""
        for known in self.Spaces():
            if known.multipliers == number:
                return known.original
        return self.things[number].form

    # --- spaces --------------------------------------------------------------------------------

    def Spaces(self):
        """All that are known."""
        return [known for known in self.things.values() if isinstance(known, SpaceReplica)]

    def SpaceOf(self, space):
        """The SpaceReplica of a space on the distributed mesh."""
        if space.mesh != self.mesh.original:
            raise ValueError("parts of the problem live on different meshes: take one mesh for all")
        for known in self.Spaces():
            if known.original == space:
                return known
        if isinstance(space, LACSpace):
            home = self.homes.get(space.number)
            replica = SpaceReplica.OfMultipliers(space, self.mesh, home)
        else:
            product = type(space) is ProductSpace
            parts = [self.SpaceOf(part) for part in space.components] if product else ()
            replica = SpaceReplica(space, self.mesh, parts)
        self.Add(replica)
        return replica

    def Space(self, replica):
        """The space on the conductor, which makes it once."""
        for part in replica.parts:
            self.Space(part)
        return replica.Make(self.crew, self.NumberOf(replica))
