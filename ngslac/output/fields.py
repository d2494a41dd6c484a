# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fields of a contact by their names, as pictures and files take them."""

from dataclasses import dataclass

from ngsolve import GridFunction

from ngslac.parallel.form import FunctionOver

__all__ = [
    "ARROWS",
    "OF_DISPLACEMENTS",
    "OF_SCALARS",
    "RECOVERED",
    "FieldNames",
    "FieldOf",
    "NumbersOf",
]

RECOVERED = ("recovered pressure", "recovered traction")
ARROWS = ("traction", "slip", "normal", RECOVERED[1])


@dataclass(frozen=True)
class FieldNames:
    """The fields that a contact has, of numbers and of vectors."""

    scalars: tuple
    vectors: tuple
    recovered: tuple = ()

    @property
    def solved(self):
        """Names of fields that only a solution has."""
        return {*self.scalars, *self.vectors, *self.recovered} - {"gap", "normal"}


OF_DISPLACEMENTS = FieldNames(("pressure", "gap", "status"), ARROWS[:3], RECOVERED)
OF_SCALARS = FieldNames(("flux", "status"), ("normal",))


def FieldOf(contact, field):
    """A function on the slave surface."""
    if field in RECOVERED:
        return getattr(contact.Recovered(), field.removeprefix("recovered "))
    return FunctionOver(contact.form, getattr(contact, field))


def NumbersOf(contact, values):
    """A field with one number for each macro-element."""
    field = GridFunction(contact.surface.WithComponents(1))
    field.vec.FV().NumPy()[:] = values
    return field
