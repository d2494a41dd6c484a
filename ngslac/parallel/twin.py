# SPDX-License-Identifier: LGPL-2.1-or-later
"""What users hold on a distributed mesh in place of objects that live on the conductor."""

import inspect
import weakref
from functools import wraps
from types import MethodType

from ngsolve import BND, BitArray, GridFunction, Region

from ngslac.distributable import OnManyProcesses
from ngslac.errors import Portable
from ngslac.parallel.bulk import RemoteForm
from ngslac.parallel.ensemble import Ensemble
from ngslac.parallel.functions import VECTORS
from ngslac.parallel.plain import Arguments, IsPlain, Reference, View
from ngslac.parallel.recipes import Recipe

__all__ = ["CallEverywhere", "Twin"]

RESULT = "result"  # kind of key


class Twin:
    """Stands for an object on the conductor: the same attributes and methods, on all processes.

    Methods have to be called on all processes at once. Attributes are those after the last call.
    """

    def __init__(self, kind, ensemble, key):
        vars(self).update(
            _kind=kind, _ensemble=ensemble, _key=key, _arguments={}, _public={}, _text=""
        )
        ensemble.twins[key] = self

    @property
    def __class__(self):
        """That of the object, so that it passes for one."""
        return self._kind

    @property
    def mesh(self):
        """The distributed mesh."""
        return self._ensemble.mesh.original

    def __repr__(self):
        return self._text

    __str__ = __repr__

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        method = getattr(self._kind, name, None)
        if inspect.isfunction(method):

            @wraps(MethodType(method, self))
            def Method(*args, **options):
                return self._Call(name, args, options)

            return Method
        for known in (self._public, self._arguments):
            if name in known:
                return known[name]
        raise AttributeError(
            f"{name} of a {self._kind.__name__} is not known on a distributed mesh"
        )

    def __dir__(self):
        methods = {name for name, _ in inspect.getmembers(self._kind, inspect.isfunction)}
        return sorted({*methods, *self._public, *self._arguments, "mesh"})

    def __setattr__(self, name, value):
        value = Recipe(value, self._ensemble)
        key = self._key
        RunEverywhere(
            self._ensemble,
            f"{self._kind.__name__}.{name} =",
            lambda: setattr(self._ensemble.homes[key], name, value()),
            {},
        )

    def _Call(self, name, args, options):
        ensemble, key = self._ensemble, self._key
        recipes = Recipes(args, options, ensemble)
        title = f"{self._kind.__name__}.{name}"
        if any(isinstance(arg, VECTORS) for arg in (*args, *options.values())):
            raise ValueError(f"{title} is not known on a distributed mesh: it takes vectors")

        def Work():
            args, options = recipes()
            return getattr(ensemble.homes[key], name)(*args, **options)

        words = Arguments(MethodType(getattr(self._kind, name), self), args, options)
        return RunEverywhere(ensemble, title, Work, words)


def Recipes(args, options, ensemble):
    """Makes of arguments those of the conductor, when it is called there."""
    args = [Recipe(arg, ensemble) for arg in args]
    options = {name: Recipe(arg, ensemble) for name, arg in options.items()}
    return lambda: ([arg() for arg in args], {name: arg() for name, arg in options.items()})


def MakeTwin(mesh, kind, args, options):
    """The Twin of a new object."""
    ensemble = Ensemble.Of(mesh)
    key, recipes = ensemble.NewNumber(), Recipes(args, options, ensemble)

    def Work():
        args, options = recipes()
        ensemble.homes[key] = kind(*args, **options)
        ForgetWith(twin)

    twin = Twin(kind, ensemble, key)
    RunEverywhere(ensemble, kind.__name__, Work, Arguments(kind, args, options))
    twin._arguments.update(inspect.signature(kind).bind_partial(*args, **options).arguments)
    return twin


def ForgetWith(twin):
    """Keep what a Twin stands for as long as users have the twin."""
    weakref.finalize(twin, twin._ensemble.homes.pop, twin._key, None).atexit = False


def CallEverywhere(mesh, function, args, options):
    """The result of a function on the conductor."""
    ensemble = Ensemble.Of(mesh)
    recipes = Recipes(args, options, ensemble)

    def Work():
        args, options = recipes()
        return function(*args, **options)

    words = Arguments(function, args, options)
    return RunEverywhere(ensemble, function.__name__, Work, words)


OnManyProcesses.Make, OnManyProcesses.Call = MakeTwin, CallEverywhere


# --- what comes back -----------------------------------------------------------------------------


def RunEverywhere(ensemble, title, work, arguments):
    """What `work` gives on the conductor, as all processes may have it; see `Crew.Call`."""
    kept = []

    def Work():
        error = None
        try:
            kept.append(work())
        except Exception as problem:
            kept.append(None)
            error = problem
        kept.append(error)
        kept.append([*ensemble.twins.values()])  # which keep what they stand for
        before = set(ensemble.homes)
        packed = Packed(kept[0], ensemble)
        keys = [key for key in ensemble.homes if key not in before or key in ensemble.twins]
        shown = {key: Shown(ensemble, key) for key in keys if key not in before or Changes(key)}
        return packed, shown, Portable(error)

    result, shown, error = ensemble.Call(title, Work, arguments)
    found = Unpacked(result, ensemble, *kept[:1])
    for key, (public, text) in shown.items():
        twin = ensemble.twins.get(key)
        if twin is not None:
            public = {name: Unpacked(value, ensemble) for name, value in public.items()}
            vars(twin).update(_public=public, _text=text)
    ensemble.pairs.Complete()
    if error is not None:
        raise kept[1] if kept else error
    return found


def Changes(key):
    """Has an object other attributes after each call? Results, such as reports, have not."""
    return not (isinstance(key, tuple) and key[0] == RESULT)


def Shown(ensemble, key):
    """The attributes of an object that all may see, and its line."""
    home, public = ensemble.homes[key], {}
    names = {name for name, kind in inspect.getmembers(type(home)) if isinstance(kind, property)}
    for name in sorted({*names, *vars(home)}):
        if not name.startswith("_"):
            value = getattr(home, name, None)
            packed = Packed(value, ensemble, view=True)
            if packed is not None or value is None:
                public[name] = packed
    return public, repr(home)


def Packed(value, ensemble, view=False):
    """What can be sent of a value: itself, what stands for it, or None."""
    if IsPlain(value):
        return value
    if isinstance(value, (list, tuple)) and value:
        return type(value)(Packed(part, ensemble, view) for part in value)
    if isinstance(value, GridFunction):
        return ensemble.pairs.ReferenceTo(value)
    if isinstance(value, RemoteForm):
        return Reference("original", value.number)
    if isinstance(value, Region) and value.VB() == BND:
        return Reference("boundary", [*value.Mask()])
    for key, home in [*ensemble.homes.items()]:
        if home is value:
            return Reference("twin" if key in ensemble.twins else "original", key, type(value))
    if hasattr(type(value), "shown"):
        return View.Of(value)
    module = type(value).__module__
    if view or not module.startswith("ngslac") or module == "ngslac._ngslac":
        return None
    key = (RESULT, next(ensemble.results))
    ensemble.homes[key] = value
    return Reference("twin", key, type(value))


def Unpacked(value, ensemble, own=None):
    """The value here; `own` where the conductor has more of it."""
    if isinstance(value, (list, tuple)) and any(isinstance(v, Reference) for v in value):
        return type(value)(Unpacked(part, ensemble) for part in value)
    if not isinstance(value, Reference):
        return own if value is None else value
    if value.kind == "function":
        return ensemble.pairs.Original(value)
    if value.kind == "boundary":
        return Region(ensemble.mesh.original, BND, BitArray(value.key))
    if value.kind == "original":
        return ensemble.Original(value.key)
    twin = ensemble.twins.get(value.key)
    if twin is None:
        twin = Twin(value.what, ensemble, value.key)
        ForgetWith(twin)
    return twin
