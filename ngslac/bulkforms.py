# SPDX-License-Identifier: LGPL-2.1-or-later
"""Verbs of a bulk form and its matrix besides those that NGSolve gives them.

These are for one process. A class that needs other ones registers them in its own module.
"""

from abc import ABC, abstractmethod
from functools import singledispatch

from ngsolve import BilinearForm, InnerProduct, Integrate, dx

__all__ = [
    "BulkForm",
    "Integral",
    "Integrand",
    "ScaleMatrix",
    "WithDiagonal",
    "WithMass",
    "WithoutMass",
]


class BulkForm(ABC):  # noqa: B024
    """A BilinearForm, or an object with its methods that stands for one."""


BulkForm.register(BilinearForm)


@singledispatch
def WithoutMass(form):
    """The form without inertia."""
    return form


@singledispatch
def WithMass(form, factor, density, u, v):
    """The form plus ``factor * density * u.v``."""
    heavy = BilinearForm(form.space, condense=form.condense)
    for integrator in form.integrators:
        heavy += integrator
    heavy += factor * density * InnerProduct(u, v) * dx
    return heavy


@singledispatch
def ScaleMatrix(form, factor):
    """Multiply the matrix that was made last."""
    form.mat.AsVector().data *= factor


@singledispatch
def WithDiagonal(operator):
    """A form or a matrix itself, or a sparse matrix that has its diagonal."""
    return operator


class Integrand(ABC):
    """A function of which only the integral is known."""

    @abstractmethod
    def Integrate(self):
        """The integral over the mesh."""


def Integral(function, mesh):
    """The integral of a function or an Integrand."""
    if isinstance(function, Integrand):
        return function.Integrate()
    return float(Integrate(function, mesh))
