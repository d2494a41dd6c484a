# SPDX-License-Identifier: LGPL-2.1-or-later
"""Arguments of users as those of the serial code on the conductor."""

from functools import partial

from ngsolve import (
    BilinearForm,
    BitArray,
    CoefficientFunction,
    GridFunction,
    Parameter,
    Region,
)
from ngsolve.comp import ProxyFunction

from ngslac._ngslac import HoldsGridFunction, LACSpace, ProxyPath
from ngslac.arguments import IsFunction
from ngslac.arrays import AsBits, AsNumPy
from ngslac.loads import LoadVector
from ngslac.parallel.bulk import FormPart, RemoteForm
from ngslac.parallel.functions import VECTORS, RemoteIntegrand
from ngslac.parallel.plain import Reference

__all__ = ["Recipe"]


def Recipe(given, ensemble):
    """A function that makes of an argument what the conductor works with.

    All processes ask for it at once; only the conductor calls it, in the middle of a call.
    """
    if "_ensemble" in getattr(given, "__dict__", {}):  # a Twin
        return OfTwin(given, ensemble)
    for kinds, recipe in RECIPES:
        if isinstance(given, kinds):
            return recipe(given, ensemble)
    if IsFunction(given) and not isinstance(given, type):
        return OfFunction(given, ensemble)
    return lambda: given


def OfTwin(given, ensemble):
    """What stands for an object on the conductor: that object."""
    if given._ensemble is not ensemble:
        raise ValueError(f"{given} lives on another mesh: take one mesh for all")
    return lambda: ensemble.homes[given._key]


def OfFunctions(given, ensemble):
    """A GridFunction: that which stands for it."""
    key, kept = ensemble.pairs.Of(given), []

    def Make():
        kept.append(ensemble.pairs.Home(key))  # to the end of the call, when users see its values
        return kept[-1]

    return Make


def OfForm(given, ensemble):
    """A bulk form: orders to all parts of it."""
    replica = ensemble.context = ensemble.SpaceOf(given.space)
    known = (n for n, t in ensemble.things.items() if isinstance(t, FormPart) and t.form is given)
    number = next(known, None)
    if number is None:
        number = ensemble.Add(FormPart(given, replica))

    def Make():
        form = ensemble.NeededBy(number) or RemoteForm(ensemble, number, given)
        replica.TakeFree(ensemble.crew, ensemble.NumberOf(replica))  # users may have changed them
        return form

    return Make


def OfProxy(given, ensemble):
    """A trial function: that of the same component."""
    path, replica = ProxyPath(given, "u or lam"), ensemble.SpaceOf(given.space)

    def Make():
        found = ensemble.Space(replica).TrialFunction()
        for k in path:
            found = found[k]
        return found

    return Make


def OfParameter(given, ensemble):
    """A parameter of the load: itself, with the same value everywhere."""
    ensemble.AddParameter(given)
    return lambda: given


def OfCoefficient(given, ensemble):
    """A function of place and parameters: itself. One of solutions: its integral, no more."""
    number = ensemble.Add(given)
    if HoldsGridFunction(given):
        return lambda: RemoteIntegrand(ensemble, number)
    ensemble.Need(number, given)
    return lambda: given


def OfBits(given, ensemble):
    """Dofs of the product space."""
    number, replica = ensemble.Add(given), ensemble.context

    def Make():
        if len(given) != replica.given.ndof:
            raise ValueError(
                f"a BitArray has {len(given)} bits, the space {replica.given.ndof} dofs on this "
                "process: take a copy of X.FreeDofs()"
            )
        bits = AsNumPy(replica.space.FreeDofs())
        _, *found = ensemble.Order("bits", number)
        d = replica.space.dim
        for dofs, own in zip(replica.dofs, found, strict=True):
            bits[dofs[::d] // d] = own
        return AsBits(bits)

    return Make


def OfMany(given, ensemble):
    """A list or a tuple."""
    parts = [Recipe(part, ensemble) for part in given]
    return lambda: type(given)(part() for part in parts)


def OfDict(given, ensemble):
    """Values by names or regions."""
    parts = [(Recipe(key, ensemble), Recipe(given[key], ensemble)) for key in given]
    return lambda: {key(): part() for key, part in parts}


def OfLoad(given, ensemble):
    """Forces: a function that gives them."""
    return OfFunction(lambda: given, ensemble)


def OfFunction(given, ensemble):
    """A function of users: all processes call it at once."""
    replica, pairs = ensemble.context, ensemble.pairs
    number = ensemble.Add(lambda *args: Checked(given(*args), replica))

    def Call(*args):
        ensemble.Show()
        args = [pairs.ReferenceTo(a) if isinstance(a, GridFunction) else a for a in args]
        users = [pairs.Given(a) if isinstance(a, Reference) else a for a in args]
        own = partial(ensemble.crew.tasks["call"], number, *users)
        try:
            result, *parts = ensemble.Order("call", number, *args, own=own)
        finally:
            pairs.Read()
        if not isinstance(result, VECTORS):
            return result
        return LoadOf(replica, parts)

    ensemble.Need(number, Call)
    return lambda: Call


def Checked(load, replica):
    """What a function gives, of loads those that suit the space."""
    if isinstance(load, VECTORS):
        LoadVector(lambda: load, GridFunction(replica.given).vec)
    return load


def LoadOf(replica, parts):
    """The vector that processes have parts of, which may have to be added up."""
    load = GridFunction(replica.space).vec
    total = load.FV().NumPy()
    total[:] = 0
    values, added = zip(*parts, strict=True)
    (replica.Add if any(added) else replica.Put)(values, total)
    return load


RECIPES = (
    (GridFunction, OfFunctions),
    (BilinearForm, OfForm),
    (ProxyFunction, OfProxy),
    (Parameter, OfParameter),
    (VECTORS, OfLoad),
    (CoefficientFunction, OfCoefficient),
    (Region, lambda given, ensemble: lambda: ensemble.mesh.Region(given)),
    (LACSpace, lambda given, ensemble: lambda: ensemble.homes[given.number]),
    (BitArray, OfBits),
    (dict, OfDict),
    ((list, tuple), OfMany),
)
