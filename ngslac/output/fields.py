# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fields of a contact by their names, as pictures and files take them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import CoefficientFunction, GridFunction

from ngslac.parallel.form import FunctionOver

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact

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
    def solved(self) -> set[str]:
        """Names of fields that only a solution has."""
        return {*self.scalars, *self.vectors, *self.recovered} - {"gap", "normal"}


OF_DISPLACEMENTS = FieldNames(("pressure", "gap", "status"), ARROWS[:3], RECOVERED)
OF_SCALARS = FieldNames(("flux", "status"), ("normal",))


def FieldOf(contact: LACContact, field: str) -> CoefficientFunction:
    """A function on the slave surface."""
    if field in RECOVERED:
        return getattr(contact.Recovered(), field.removeprefix("recovered "))
    return FunctionOver(contact.form, getattr(contact, field))


def NumbersOf(contact: LACContact, values: np.ndarray) -> GridFunction:
    """A field with one number for each macro-element."""
    field = GridFunction(contact.surface.WithComponents(1))
    field.vec.FV().NumPy()[:] = values
    return field
