"""What belongs to a distributed mesh: its processes, and what of it the conductor has twice."""

import numpy as np
from ngsolve import GridFunction, LinearForm, ProductSpace
from ngsolve.la import PARALLEL_STATUS

from ngslac._ngslac import LACSpace
from ngslac.parallel.crew import Crew
from ngslac.parallel.replica import MeshReplica, SpaceReplica

__all__ = ["Ensemble"]


class Pair:
    """A GridFunction on a distributed mesh and the one on the conductor that stands for it.

    Parameters
    ----------
    given : GridFunction
        On the distributed mesh.
    space : SpaceReplica
    home : GridFunction or None
        On the conductor.
    reads : bool
        May users change it?
    """

    def __init__(self, given, space, home, reads=True):
        self.given, self.space, self.home, self.reads = given, space, home, reads
        self.sent = None


class Ensemble:
    """All that the processes of one distributed mesh know of each other's objects.

    Things have numbers, which are the same on all processes, since all of them make the same calls.

    Parameters
    ----------
    mesh : ngsolve.Mesh

    Attributes
    ----------
    crew : Crew
    mesh : MeshReplica
    things : list
        By number.
    """

    _known = []

    @classmethod
    def Of(cls, mesh):
        """That of a distributed mesh."""
        for known in cls._known:
            if known.mesh.given == mesh:
                return known
        cls._known.append(cls(mesh))
        return cls._known[-1]

    def __init__(self, mesh):
        self.crew = Crew(mesh.comm.mpi4py)
        self.mesh = MeshReplica(mesh, self.crew)
        self.things, self.homes, self.pairs = [], {}, []
        self.crew.tasks |= {
            "dofs": lambda number, told: self.things[number].LearnDofs(told),
            "free": lambda number: self.things[number].Free(),
            "get": self._Get,
            "put": self._Put,
            "load": self._Load,
        }

    def Add(self, thing):
        """The number of a thing that all processes have."""
        self.things.append(thing)
        return len(self.things) - 1

    def NumberOf(self, thing):
        """The number of a thing; a new one where it is not known."""
        for number, known in enumerate(self.things):
            if known is thing:
                return number
        return self.Add(thing)

    # --- spaces --------------------------------------------------------------------------------

    def SpaceOf(self, space):
        """The SpaceReplica of a space; its numbers are `NumberOf` that."""
        for known in self.things:
            if isinstance(known, SpaceReplica) and known.given == space:
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

    def Space(self, space):
        """The space on the replica that stands for one: the conductor only."""
        replica = self.SpaceOf(space)
        for part in (*replica.parts, replica):
            part.Make(self.crew, self.NumberOf(part))
        return replica.space

    # --- values --------------------------------------------------------------------------------

    def PairOf(self, given):
        """The Pair of a GridFunction, which `Function` completes on the conductor."""
        for pair in self.pairs:
            if pair.given is given:
                return pair
        pair = Pair(given, self.SpaceOf(given.space), None)
        self.pairs.append(pair)
        return pair

    def Function(self, pair):
        """The GridFunction on the conductor."""
        if pair.home is None:
            pair.home = GridFunction(self.Space(pair.given.space))
            self._Read(pair)
        return pair.home

    def Read(self):
        """Take over what users have done to their functions."""
        for pair in self.pairs:
            if pair.home is not None and pair.reads:
                self._Read(pair)

    def _Read(self, pair):
        _, *parts = self.crew.Order("get", self.pairs.index(pair))
        values = pair.home.vec.FV().NumPy()
        for dofs, part in zip(pair.space.dofs, parts, strict=True):
            values[dofs[dofs >= 0]] = part[dofs >= 0]
        pair.sent = values.copy()

    def Write(self):
        """Show users what has become of their functions."""
        for number, pair in enumerate(self.pairs):
            if pair.home is None:
                continue
            values = pair.home.vec.FV().NumPy()
            if pair.sent is None or not np.array_equal(values, pair.sent):
                each = [np.where(dofs >= 0, values[dofs], 0.0) for dofs in pair.space.dofs]
                self.crew.Order("put", number, each=each)
                own = pair.space.own
                pair.given.vec.FV().NumPy()[:] = values[own]
                pair.sent = values.copy()

    def _Get(self, number):
        return self.pairs[number].given.vec.FV().NumPy().copy()

    def _Put(self, number, values):
        vec = self.pairs[number].given.vec
        vec.SetParallelStatus(PARALLEL_STATUS.CUMULATED)
        vec.FV().NumPy()[:] = values

    def _Load(self, number):
        """Values of a load, and whether those of shared dofs are to be added."""
        load = self.things[number]
        load = load() if not hasattr(load, "FV") and callable(load) else load
        vec = load.vec if isinstance(load, LinearForm) else load
        added = vec.GetParallelStatus() == PARALLEL_STATUS.DISTRIBUTED
        return vec.FV().NumPy().copy(), added
