# SPDX-License-Identifier: LGPL-2.1-or-later
"""Coefficients that are fields: entries that do not touch each other are varied at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from netgen.meshing import NgException
from ngsolve import BilinearForm, FESpace, GridFunction, ds, dx

from ngslac.analysis.colours import Colours
from ngslac.analysis.learnt import SurfaceDofs
from ngslac.analysis.variables import Entries
from ngslac.arrays import AsNumPy, ToCSR

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ngslac.contact.contact import LACContact

__all__ = ["AtSurfaces", "Groups", "Reach"]


def Reach(field: GridFunction, space: FESpace) -> csr_matrix | None:
    """Rows of a residual that each entry of a field changes, ones in (n, entries), or None.

    They are those of the elements on which the entry lives, whatever the integrand is.
    """
    own = field.space
    if own.dim != 1 or space.dim != 1 or field.components:
        return None
    form = BilinearForm(trialspace=own, testspace=space)
    product = 0.0 * own.TrialFunction() * space.TestFunction()[0][0]
    try:
        form += product * dx + product * ds
        form.Assemble()
    except NgException:
        return None
    found = ToCSR(form.mat)
    found.data[:] = 1
    return found


def AtSurfaces(reach: csr_matrix, contacts: Sequence[LACContact]) -> np.ndarray:
    """Entries (bool) that change a row of the surfaces of contacts."""
    rows = np.logical_or.reduce([AsNumPy(SurfaceDofs(contact)) for contact in contacts])
    return reach[rows].getnnz(axis=0) > 0


def Groups(entries: Entries, reach: csr_matrix) -> list[Entries]:
    """Directions that vary many of the entries at once, no two of which change the same row."""
    groups = Colours(reach)
    chosen = (np.flatnonzero(groups == number) for number in range(groups.max() + 1))
    return [Entries(entries.values, entries.start, some) for some in chosen]
