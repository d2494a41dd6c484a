# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fields of a contact by their names, as pictures and files take them."""

from ngsolve import GridFunction

__all__ = ["ARROWS", "RECOVERED", "SCALARS", "SOLVED", "VECTORS", "FieldOf", "NumbersOf"]

SCALARS, VECTORS = ("pressure", "gap", "status"), ("traction", "slip", "normal")
RECOVERED = ("recovered pressure", "recovered traction")
ARROWS = (*VECTORS, RECOVERED[1])
SOLVED = ("pressure", "status", *VECTORS[:2], *RECOVERED)  # what only a solution has


def FieldOf(contact, field):
    """A function on the slave surface."""
    if field in RECOVERED:
        return getattr(contact.Recovered(), field.removeprefix("recovered "))
    return getattr(contact, field)


def NumbersOf(contact, values):
    """A field with one number for each macro-element."""
    field = GridFunction(contact.space.WithComponents(1))
    field.vec.FV().NumPy()[:] = values
    return field
