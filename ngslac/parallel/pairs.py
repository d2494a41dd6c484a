# SPDX-License-Identifier: LGPL-2.1-or-later
"""GridFunctions on a distributed mesh and those on the conductor: the same values."""

from hashlib import blake2b
from itertools import count
from weakref import ref

import numpy as np
from ngsolve import GridFunction
from ngsolve.la import PARALLEL_STATUS

from ngslac._ngslac import LACSpace
from ngslac.parallel.plain import Reference
from ngslac.parallel.replica import SpaceReplica

__all__ = ["Pairs"]


class Pair:
    """A GridFunction on a distributed mesh and the one on the conductor that stands for it.

    The conductor keeps neither: it ends the pair on all processes when one of them is gone.
    """

    def __init__(self, what=None):
        # They return the function on the distributed mesh and that on the conductor; None: there is
        # no such, not yet or no longer.
        self.original = self.home = Nothing
        self.space = self.sent = None  # SpaceReplica of both; values that both had last
        self.seen = None  # digest of the own part of them, on a worker
        self.what = what

    @property
    def reads(self):
        """May users change the values?"""
        return self.what is None or self.what[1] is None

    @property
    def whole(self):
        """Are there both, on the conductor?"""
        return self.home() is not None and self.original() is not None

    @property
    def ended(self):
        """Has one of them gone, on the conductor?"""
        return self.home() is None or (self.original() is None and self.original is not Nothing)


def Nothing():
    """No function."""


class Pairs:
    """All functions that users and the conductor have in common."""

    def __init__(self, ensemble):
        # Keys are the same on all processes, those below 0 of functions that the conductor makes.
        self._ensemble, self.known, self.next, self._fresh = ensemble, {}, 0, False
        self._own = count(-1, -1)
        ensemble.crew.tasks |= {"get": self._Get, "put": self._Put}

    def Of(self, original):
        """The key of the pair of a user's function; all processes ask for it."""
        for key, pair in self.known.items():
            if pair.original() is original:
                return key
        key = self.next
        self.next, self.known[key] = key + 1, Pair()
        self._Give(self.known[key], original, self._ensemble.SpaceOf(original.space))
        return key

    def _Give(self, pair, original, space):
        """Let a pair have the function of users, which workers keep until the conductor ends it."""
        pair.original = ref(original) if self._ensemble.crew.conducts else lambda: original
        pair.space = space

    def Ended(self):
        """Keys of pairs that are of no more use; the conductor knows."""
        return [key for key, pair in self.known.items() if pair.ended]

    def Home(self, key):
        """The function on the conductor; who asks for it keeps it."""
        pair = self.known[key]
        home = pair.home()
        if home is None:
            home = GridFunction(self._ensemble.Space(pair.space))
            pair.home = ref(home)
            self._Read(key, whole=True)
        return home

    # --- values --------------------------------------------------------------------------------

    def Read(self):
        """Take over what users have done to their functions."""
        for key, pair in self.known.items():
            if pair.whole and pair.reads:
                self._Read(key)

    def _Read(self, key, *, whole=False):
        """All of the values, or of the workers where they have changed."""
        pair = self.known[key]
        _, *parts = self._ensemble.crew.Order("get", key, whole)
        values = pair.home().vec.FV().NumPy()
        if whole or any(part is not None for part in parts):
            pair.space.Put(parts, values)
            pair.sent = values.copy()

    def Write(self):
        """Show users what has become of their functions."""
        for key, pair in self.known.items():
            values = pair.home().vec.FV().NumPy() if pair.whole else None
            if not pair.whole or (pair.sent is not None and np.array_equal(values, pair.sent)):
                continue
            self._ensemble.crew.Order("put", key, each=pair.space.Split(values))
            pair.original().vec.FV().NumPy()[:] = values[pair.space.own]
            pair.sent = values.copy()

    def _Get(self, key, whole):
        pair = self.known[key]
        values = pair.original().vec.FV().NumPy()
        before, pair.seen = pair.seen, Digest(values)
        return values.copy() if whole or pair.seen != before else None

    def _Put(self, key, values):
        pair = self.known[key]
        vec = pair.original().vec
        vec.SetParallelStatus(PARALLEL_STATUS.CUMULATED)
        vec.FV().NumPy()[:] = values
        pair.seen = Digest(values)

    # --- functions that the conductor makes ------------------------------------------------------

    def ReferenceTo(self, home):
        """What stands for a function of the conductor in a message; None: nothing can."""
        for key, pair in self.known.items():
            if pair.home() is home and not pair.ended:
                return Reference("function", key, pair.what)
        what = self._SpaceLike(home.space)
        if what is None:
            return None
        key = next(self._own)
        pair = self.known[key] = Pair((*what, home.name))
        pair.home = ref(home)
        return Reference("function", key, pair.what)

    def _SpaceLike(self, space):
        """The number of a space, or of a LACSpace, and of components where these are others."""
        for known in self._ensemble.Spaces():
            if known.space == space:
                return self._ensemble.NumberOf(known), None
        for number, home in self._ensemble.homes.items():
            if SameMacroElements(home, space):
                return number, space.ndof * space.dim // max(space.nmacros, 1)
        return None

    def Original(self, reference):
        """The function of users; a new one where there is none."""
        pair = self.known.setdefault(reference.key, Pair(reference.what))
        original = pair.original()
        if original is None:
            original, space = self._Made(*pair.what)
            self._Give(pair, original, space)
            self._fresh = True
        return original

    def _Made(self, number, components, name):
        """A function of users, and the SpaceReplica of its space."""
        ensemble = self._ensemble
        if components is None:
            replica = ensemble.things[number]
            return GridFunction(replica.original, name=name), replica
        space = ensemble.Original(number).WithComponents(components)
        replica = SpaceReplica.OfMultipliers(space, ensemble.mesh, ensemble.homes.get(number))
        return GridFunction(space, name=name), replica

    def Complete(self):
        """Fill new functions of users; all processes call it."""
        if self._fresh:
            self._fresh = False
            self._ensemble.InStep("values", self.Write, {})


def Digest(values):
    """Tells arrays apart, in a few bytes."""
    return blake2b(np.ascontiguousarray(values), digest_size=16).digest()


def SameMacroElements(*spaces):
    """Are both LACSpaces, and of the same macro-elements?"""
    if not all(isinstance(space, LACSpace) for space in spaces):
        return False
    one, other = spaces
    return one.displacement == other.displacement and [*one.macros] == [*other.macros]
