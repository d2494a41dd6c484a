# SPDX-License-Identifier: LGPL-2.1-or-later
"""Inertia added to a bulk form."""

from ngsolve import BilinearForm, InnerProduct, dx

__all__ = ["WithMass"]


def WithMass(a, factor, density, u, v):
    """The form ``a + factor * density * u.v``."""
    form = BilinearForm(a.space, condense=a.condense)
    for integrator in a.integrators:
        form += integrator
    form += factor * density * InnerProduct(u, v) * dx
    return form
