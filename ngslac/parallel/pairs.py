"""GridFunctions on a distributed mesh and those on the conductor: the same values."""

import numpy as np
from ngsolve import GridFunction
from ngsolve.la import PARALLEL_STATUS

from ngslac._ngslac import LACSpace
from ngslac.parallel.plain import Reference

__all__ = ["Pairs"]


class Pair:
    """A GridFunction on a distributed mesh and the one on the conductor that stands for it.

    Parameters
    ----------
    given : GridFunction or None
        On the distributed mesh; None: users do not have it yet.
    space : SpaceReplica or None
    home : GridFunction or None
        On the conductor, if it needs it.
    reads : bool
        May users change it?
    """

    def __init__(self, given, space, home=None, reads=True):
        self.given, self.space, self.home, self.reads = given, space, home, reads
        self.sent = None

    @property
    def whole(self):
        """Are there both, on the conductor?"""
        return self.home is not None and self.given is not None


class Pairs:
    """All functions that users and the conductor have in common.

    Parameters
    ----------
    ensemble : Ensemble
    """

    def __init__(self, ensemble):
        self._ensemble, self._pairs, self._fresh = ensemble, [], False
        ensemble.crew.tasks |= {"get": self._Get, "put": self._Put}

    def Of(self, given):
        """The Pair of a user's function; all processes ask for it."""
        for pair in self._pairs:
            if pair.given is given:
                return pair
        self._pairs.append(Pair(given, self._ensemble.SpaceOf(given.space)))
        return self._pairs[-1]

    @property
    def count(self):
        """How many there are."""
        return len(self._pairs)

    def Keep(self, count):
        """Drop all but the first."""
        del self._pairs[count:]

    def Home(self, pair):
        """The function on the conductor."""
        if pair.home is None:
            pair.home = GridFunction(self._ensemble.Space(pair.space))
            self._Read(pair)
        return pair.home

    # --- values --------------------------------------------------------------------------------

    def Read(self):
        """Take over what users have done to their functions."""
        for pair in self._pairs:
            if pair.whole and pair.reads:
                self._Read(pair)

    def _Read(self, pair):
        _, *parts = self._ensemble.crew.Order("get", self._pairs.index(pair))
        values = pair.home.vec.FV().NumPy()
        pair.space.Put(parts, values)
        pair.sent = values.copy()

    def Write(self):
        """Show users what has become of their functions."""
        for number, pair in enumerate(self._pairs):
            values = pair.home.vec.FV().NumPy() if pair.whole else None
            if not pair.whole or (pair.sent is not None and np.array_equal(values, pair.sent)):
                continue
            self._ensemble.crew.Order("put", number, each=pair.space.Split(values))
            pair.given.vec.FV().NumPy()[:] = values[pair.space.own]
            pair.sent = values.copy()

    def _Get(self, number):
        return self._pairs[number].given.vec.FV().NumPy().copy()

    def _Put(self, number, values):
        vec = self._pairs[number].given.vec
        vec.SetParallelStatus(PARALLEL_STATUS.CUMULATED)
        vec.FV().NumPy()[:] = values

    # --- functions that the conductor makes ------------------------------------------------------

    def ReferenceTo(self, home):
        """What stands for a function of the conductor in a message; None: nothing can."""
        for key, pair in enumerate(self._pairs):
            if pair.home is home:
                return Reference("function", key)
        what = self._SpaceLike(home.space)
        if what is None:
            return None
        self._pairs.append(Pair(None, None, home, reads=what[1] is None))
        return Reference("function", len(self._pairs) - 1, (*what, home.name))

    def _SpaceLike(self, space):
        """The number of a space, or of a LACSpace, and of components where these are others."""
        for known in self._ensemble.Spaces():
            if known.space == space:
                return self._ensemble.NumberOf(known), None
        for number, home in self._ensemble.homes.items():
            if SameMacroElements(home, space):
                return number, space.ndof * space.dim // max(space.nmacros, 1)
        return None

    def Given(self, reference):
        """The function of users; a new one where there is none."""
        known = self._pairs[reference.key] if reference.key < len(self._pairs) else None
        if known is not None and known.given is not None:
            return known.given
        number, components, name = reference.what
        if components is None:
            space = self._ensemble.things[number].given
        else:
            space = self._ensemble.Given(number).WithComponents(components)
        given = GridFunction(space, name=name)
        if known is None:
            known = Pair(given, None)
            self._pairs.append(known)
        known.given, known.space = given, self._ensemble.SpaceOf(space)
        self._fresh = True
        return given

    def Complete(self):
        """Fill new functions of users; all processes call it."""
        if self._fresh:
            self._fresh = False
            self._ensemble.InStep("values", self.Write)


def SameMacroElements(*spaces):
    """Are both LACSpaces, and of the same macro-elements?"""
    if not all(isinstance(space, LACSpace) for space in spaces):
        return False
    one, other = spaces
    return one.displacement == other.displacement and [*one.macros] == [*other.macros]
