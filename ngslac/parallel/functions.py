# SPDX-License-Identifier: LGPL-2.1-or-later
"""Functions of users that only the processes with elements can evaluate."""

from functools import partial

from ngsolve import BaseVector, BilinearForm, InnerProduct, Integrate, LinearForm, Parameter, dx
from ngsolve.la import PARALLEL_STATUS, DynamicVectorExpression

from ngslac.bulkforms import Integrand, WithMass
from ngslac.parallel.bulk import FormPart
from ngslac.parallel.plain import Reference

__all__ = ["VECTORS", "RemoteIntegrand", "UserFunctions"]

VECTORS = LinearForm, BaseVector, DynamicVectorExpression


class RemoteIntegrand(Integrand):
    """A function on a distributed mesh that holds the solution: the conductor can integrate it."""

    def __init__(self, ensemble, number):
        self._ensemble, self._number = ensemble, number
        ensemble.Need(number, self)

    def __repr__(self):
        return (
            "<function that holds a GridFunction: on a distributed mesh there are functions of "
            "place and Parameters only>"
        )

    def Integrate(self):
        """The integral over the mesh."""
        self._ensemble.Show()
        own = partial(self._ensemble.crew.tasks["integral"], self._number)
        return float(self._ensemble.Order("integral", self._number, own=own)[-1])


class UserFunctions:
    """What all processes do at once with functions of users."""

    def __init__(self, ensemble):
        self._ensemble = ensemble

    @property
    def tasks(self):
        """For the workers of a Crew."""
        return {
            "call": self.Call,
            "integral": self.Integral,
            "heavy": self.AddMass,
            "mass": self.MakeMass,
        }

    def Call(self, number, *args):
        """What a function says here; of loads the values, and are they to be added up?"""
        args = [
            self._ensemble.pairs.Original(arg) if isinstance(arg, Reference) else arg
            for arg in args
        ]
        self._ensemble.Agree()
        crew = self._ensemble.crew
        with crew.interrupts.Let():
            load = self._ensemble.things[number](*args)
        if crew.conducts:
            return load
        if not isinstance(load, VECTORS):
            return None  # it may be what cannot be sent
        load = load.Evaluate() if isinstance(load, DynamicVectorExpression) else load
        vec = load.vec if isinstance(load, LinearForm) else load
        added = vec.GetParallelStatus() == PARALLEL_STATUS.DISTRIBUTED
        return vec.FV().NumPy().copy(), added

    def Integral(self, number):
        """Of a function over the whole mesh."""
        return Integrate(self._ensemble.things[number], self._ensemble.mesh.original)

    def AddMass(self, number, path, density, factor=None):
        """The number of a form with inertia."""
        part = self._ensemble.things[number]
        factor = Parameter(1.0) if factor is None else factor
        self._ensemble.AddParameter(factor)
        form = WithMass(part.form, factor, self._Density(density), *Proxies(part, path))
        return self._ensemble.Add(FormPart(form, part.replica))

    def MakeMass(self, number, path, density):
        """The number of the form of inertia alone, on the space of another form."""
        part = self._ensemble.things[number]
        form = BilinearForm(self._Density(density) * InnerProduct(*Proxies(part, path)) * dx)
        return self._ensemble.Add(FormPart(form, part.replica))

    def _Density(self, density):
        known = isinstance(density, Reference)
        return self._ensemble.things[density.key] if known else density


def Proxies(part, path):
    """Trial and test function of the component of a FormPart's space that a path leads to."""
    u, v = part.form.space.TnT()
    for k in path:
        u, v = u[k], v[k]
    return u, v
