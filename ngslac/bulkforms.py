# SPDX-License-Identifier: LGPL-2.1-or-later
"""Verbs of a bulk form and its matrix besides those that NGSolve gives them.

A class that needs other ones registers them in its own module.
"""

from __future__ import annotations

from functools import singledispatch
from typing import TYPE_CHECKING, Any

from ngsolve import BilinearForm, CoefficientFunction, InnerProduct, Parameter, dx

if TYPE_CHECKING:
    from ngsolve.comp import ProxyFunction

__all__ = ["ScaleMatrix", "WithMass", "WithoutMass"]


@singledispatch
def WithoutMass(form: Any) -> Any:
    """The form without inertia."""
    return form


def WithMass(
    form: BilinearForm,
    factor: Parameter,
    density: CoefficientFunction | float,
    u: ProxyFunction,
    v: ProxyFunction,
) -> BilinearForm:
    """The form plus ``factor * density * u.v``."""
    heavy = BilinearForm(form.space, condense=form.condense)
    for integrator in form.integrators:
        heavy += integrator
    heavy += factor * density * InnerProduct(u, v) * dx
    return heavy


def ScaleMatrix(form: BilinearForm, factor: float) -> None:
    """Multiply the matrix that was made last, of which each process may have a part."""
    getattr(form.mat, "local_mat", form.mat).AsVector().data *= factor
