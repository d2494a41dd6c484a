"""What belongs to a distributed mesh: its processes, and what of it the conductor has twice."""

import numpy as np
from ngsolve import BaseVector, GridFunction, Integrate, LinearForm, Parameter, ProductSpace
from ngsolve.la import PARALLEL_STATUS, DynamicVectorExpression

from ngslac._ngslac import LACSpace
from ngslac.arrays import AsNumPy
from ngslac.parallel.bulk import FormPart
from ngslac.parallel.crew import Crew
from ngslac.parallel.mass import WithMass
from ngslac.parallel.plain import Reference
from ngslac.parallel.replica import MeshReplica, SpaceReplica
from ngslac.parallel.team import TeamMember

__all__ = ["VECTORS", "Ensemble"]

VECTORS = LinearForm, BaseVector, DynamicVectorExpression


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
        self.parameters, self.twins, self.context = [], {}, None
        self._fresh = False
        self.crew.tasks |= {
            "dofs": lambda number, told: self.things[number].LearnDofs(told),
            "free": lambda number: self.things[number].Free(),
            "get": self._Get,
            "put": self._Put,
            "form": self._Form,
            "petsc": TeamMember(self).Obey,
            "with": self._With,
            "call": self.CallFunction,
            "integral": self.Integral,
            "mass": self.AddMass,
            "bits": lambda number: AsNumPy(self.things[number]),
            "nothing": lambda: None,
        }

    # --- calls ---------------------------------------------------------------------------------

    def Call(self, name, work):
        """What `work` gives on the conductor, on all processes; users' functions follow."""

        def Work():
            self.Read()
            try:
                return work()
            finally:
                self.Write()

        return self.crew.Call(name, Work)

    def Order(self, task, *args, own=None, each=None):
        """See `Crew.Order`: parameters have on all processes the values of the conductor."""
        values = [(number, self.things[number].Get()) for number in self.parameters]
        return self.crew.Order("with", values, task, *args, own=own, each=each)

    def _With(self, values, task, *args):
        for number, value in values:
            if self.things[number].Get() != value:
                self.things[number].Set(value)
        return self.crew.tasks[task](*args)

    # --- things --------------------------------------------------------------------------------

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
            if pair.home is not None and pair.given is not None and pair.reads:
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
            if pair.home is None or pair.given is None:
                continue
            values = pair.home.vec.FV().NumPy()
            if pair.sent is None or not np.array_equal(values, pair.sent):
                each = [np.where(dofs >= 0, values[dofs], 0.0) for dofs in pair.space.dofs]
                self.crew.Order("put", number, each=each)
                own = pair.space.own
                pair.given.vec.FV().NumPy()[:] = values[own]
                pair.sent = values.copy()
        if self.parameters:
            self.Order("nothing")

    def _Get(self, number):
        return self.pairs[number].given.vec.FV().NumPy().copy()

    def _Put(self, number, values):
        vec = self.pairs[number].given.vec
        vec.SetParallelStatus(PARALLEL_STATUS.CUMULATED)
        vec.FV().NumPy()[:] = values

    def _Form(self, number, verb, *args):
        *args, values = args
        return getattr(self.things[number], verb)(values, *args)

    # --- functions that others make --------------------------------------------------------------

    def ReferenceTo(self, home):
        """What stands for a GridFunction of the conductor in a message."""
        for key, pair in enumerate(self.pairs):
            if pair.home is home:
                return Reference("function", key)
        what = self._SpaceLike(home.space)
        if what is None:
            return None
        self.pairs.append(Pair(None, None, home, reads=what[1] is None))
        return Reference("function", len(self.pairs) - 1, (*what, home.name))

    def _SpaceLike(self, space):
        """The number of a space or of a LACSpace, and of components where these are others."""
        for number, known in enumerate(self.things):
            if isinstance(known, SpaceReplica) and known.space == space:
                return number, None
        for number, home in self.homes.items():
            if isinstance(home, LACSpace) and isinstance(space, LACSpace):
                same = home.displacement == space.displacement, [*home.macros] == [*space.macros]
                if all(same):
                    return number, space.ndof * space.dim // max(space.nmacros, 1)
        return None

    def GivenFunction(self, reference):
        """The GridFunction on the distributed mesh; a new one where there is none."""
        if reference.key < len(self.pairs) and self.pairs[reference.key].given is not None:
            return self.pairs[reference.key].given
        number, components, name = reference.what
        if components is None:
            space = self.things[number].given
        else:
            space = self.Given(number).WithComponents(components)
        given, replica = GridFunction(space, name=name), self.SpaceOf(space)
        if reference.key == len(self.pairs):
            self.pairs.append(Pair(given, replica, None, reads=components is None))
        else:
            pair = self.pairs[reference.key]
            pair.given, pair.space = given, replica
        self._fresh = True
        return given

    def Given(self, number):
        """What users have of a form or a LACSpace with this number on the conductor."""
        for known in self.things:
            if isinstance(known, SpaceReplica) and known.multipliers == number:
                return known.given
        return self.things[number].form

    def Complete(self):
        """Fill new functions."""
        if self._fresh:
            self._fresh = False
            self.crew.Call("values", self.Write)

    # --- functions of users ------------------------------------------------------------------

    def Integral(self, number):
        """Of a function over the whole mesh, asked for by all processes."""
        return Integrate(self.things[number], self.mesh.given)

    def AddMass(self, number, path, density, factor=None):
        """The number of a form with inertia, made by all processes.

        Parameters
        ----------
        number : int
            Of the FormPart without it.
        path : list[int]
            Leads to the displacement among the components.
        density : float or Reference
        factor : Parameter, optional
            That of the conductor.
        """
        part = self.things[number]
        u, v = part.form.space.TnT()
        for k in path:
            u, v = u[k], v[k]
        density = self.things[density.key] if isinstance(density, Reference) else density
        factor = Parameter(1.0) if factor is None else factor
        self.parameters.append(self.Add(factor))
        form = WithMass(part.form, factor, density, u, v)
        return self.Add(FormPart(form, part.replica))

    def CallFunction(self, number, *args):
        """What a function of users says here; of loads the values, and are they to be added?"""
        args = [self.GivenFunction(a) if isinstance(a, Reference) else a for a in args]
        load = self.things[number](*args)
        if self.crew.conducts or not isinstance(load, VECTORS):
            return load
        load = load.Evaluate() if isinstance(load, DynamicVectorExpression) else load
        vec = load.vec if isinstance(load, LinearForm) else load
        added = vec.GetParallelStatus() == PARALLEL_STATUS.DISTRIBUTED
        return vec.FV().NumPy().copy(), added
