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


def Recipe(thing, ensemble):
    """A function that makes of an argument what the conductor works with.

    All processes ask for it at once; only the conductor calls it, in the middle of a call.
    """
    if "_ensemble" in getattr(thing, "__dict__", {}):  # a Twin
        return OfTwin(thing, ensemble)
    for kinds, recipe in RECIPES:
        if isinstance(thing, kinds):
            return recipe(thing, ensemble)
    if IsFunction(thing) and not isinstance(thing, type):
        return OfFunction(thing, ensemble)
    return lambda: thing


def OfTwin(thing, ensemble):
    """What stands for an object on the conductor: that object."""
    if thing._ensemble is not ensemble:
        raise ValueError(f"{thing} lives on another mesh: take one mesh for all")
    return lambda: ensemble.homes[thing._key]


def OfFunctions(thing, ensemble):
    """A GridFunction: that which stands for it."""
    key, kept = ensemble.pairs.Of(thing), []

    def Make():
        kept.append(ensemble.pairs.Home(key))  # to the end of the call, when users see its values
        return kept[-1]

    return Make


def OfForm(thing, ensemble):
    """A bulk form: orders to all parts of it."""
    replica = ensemble.context = ensemble.SpaceOf(thing.space)
    known = (n for n, t in ensemble.things.items() if isinstance(t, FormPart) and t.form is thing)
    number = next(known, None)
    if number is None:
        number = ensemble.Add(FormPart(thing, replica))

    def Make():
        form = ensemble.NeededBy(number) or RemoteForm(ensemble, number, thing)
        replica.TakeFree(ensemble.crew, ensemble.NumberOf(replica))  # users may have changed them
        return form

    return Make


def OfProxy(thing, ensemble):
    """A trial function: that of the same component."""
    path, replica = ProxyPath(thing, "u or lam"), ensemble.SpaceOf(thing.space)

    def Make():
        found = ensemble.Space(replica).TrialFunction()
        for k in path:
            found = found[k]
        return found

    return Make


def OfParameter(thing, ensemble):
    """A parameter of the load: itself, with the same value everywhere."""
    ensemble.AddParameter(thing)
    return lambda: thing


def OfCoefficient(thing, ensemble):
    """A function of place and parameters: itself. One of solutions: its integral, no more."""
    number = ensemble.Add(thing)
    if HoldsGridFunction(thing):
        return lambda: RemoteIntegrand(ensemble, number)
    ensemble.Need(number, thing)
    return lambda: thing


def OfBits(thing, ensemble):
    """Dofs of the product space."""
    number, replica = ensemble.Add(thing), ensemble.context

    def Make():
        if len(thing) != replica.original.ndof:
            raise ValueError(
                f"a BitArray has {len(thing)} bits, the space {replica.original.ndof} dofs on this "
                "process: take a copy of X.FreeDofs()"
            )
        bits = AsNumPy(replica.space.FreeDofs())
        _, *found = ensemble.Order("bits", number)
        d = replica.space.dim
        for dofs, own in zip(replica.dofs, found, strict=True):
            bits[dofs[::d] // d] = own
        return AsBits(bits)

    return Make


def OfMany(thing, ensemble):
    """A list or a tuple."""
    parts = [Recipe(part, ensemble) for part in thing]
    return lambda: type(thing)(part() for part in parts)


def OfDict(thing, ensemble):
    """Values by names or regions."""
    parts = [(Recipe(key, ensemble), Recipe(thing[key], ensemble)) for key in thing]
    return lambda: {key(): part() for key, part in parts}


def OfLoad(thing, ensemble):
    """Forces: a function that gives them."""
    return OfFunction(lambda: thing, ensemble)


def OfFunction(thing, ensemble):
    """A function of users: all processes call it at once."""
    replica, pairs = ensemble.context, ensemble.pairs
    number = ensemble.Add(lambda *args: Checked(thing(*args), replica))

    def Call(*args):
        ensemble.Show()
        args = [pairs.ReferenceTo(a) if isinstance(a, GridFunction) else a for a in args]
        users = [pairs.Original(a) if isinstance(a, Reference) else a for a in args]
        own = partial(ensemble.crew.tasks["call"], number, *users)
        try:
            result, *parts = ensemble.Order("call", number, *args, own=own)
        finally:
            pairs.Read()
        if not isinstance(result, VECTORS):
            return result
        return LoadOf(replica, parts)

    ensemble.Need(number, Call)
    Call.kept = getattr(thing, "kept", {})  # of a law
    Call.expression = thing  # what makes an expression is the conductor's alone
    return lambda: Call


def Checked(load, replica):
    """What a function gives, of loads those that suit the space."""
    if isinstance(load, VECTORS):
        LoadVector(lambda: load, GridFunction(replica.original).vec)
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
    (Region, lambda thing, ensemble: lambda: ensemble.mesh.Region(thing)),
    (LACSpace, lambda thing, ensemble: lambda: ensemble.homes[thing.number]),
    (BitArray, OfBits),
    (dict, OfDict),
    ((list, tuple), OfMany),
)
