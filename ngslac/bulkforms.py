# SPDX-License-Identifier: LGPL-2.1-or-later
"""Verbs of a bulk form and its matrix besides those that NGSolve gives them.

A class that needs other ones registers them in its own module.
"""

from functools import singledispatch

from ngsolve import BilinearForm, InnerProduct, dx

__all__ = ["ScaleMatrix", "WithMass", "WithoutMass"]


@singledispatch
def WithoutMass(form):
    """The form without inertia."""
    return form


def WithMass(form, factor, density, u, v):
    """The form plus ``factor * density * u.v``."""
    heavy = BilinearForm(form.space, condense=form.condense)
    for integrator in form.integrators:
        heavy += integrator
    heavy += factor * density * InnerProduct(u, v) * dx
    return heavy


def ScaleMatrix(form, factor):
    """Multiply the matrix that was made last, of which each process may have a part."""
    getattr(form.mat, "local_mat", form.mat).AsVector().data *= factor
