# SPDX-License-Identifier: LGPL-2.1-or-later
"""The motions that contact prevents, as rows of a sparse matrix on the displacements."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ngslac._ngslac import Side
from ngslac.parallel.form import JumpRowsEverywhere, NoRows
from ngslac.parallel.matrices import SkinRows, Stacked

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ngslac.contact.contact import LACContact

__all__ = [
    "COARSE",
    "CONTACT",
    "MASTER",
    "SLAVE",
    "TIGHT",
    "ActiveRates",
    "ActiveRows",
    "AllJumps",
    "Sight",
    "ToolDofs",
    "ToolRows",
    "ToolsSlipFar",
]

# Of the size of the slave: a tool that nothing but friction holds goes no farther at once.
FAR_SLIP = 0.1
# Approach over motion along a flat surface that is rounding.
TIGHT = 1e-5
# Approach over motion along a curved surface that its mesh makes: at least, per square of the angle
# by which a macro-element bends, and at most. Discs and balls have 1e-5 to 2e-2.
COARSE, PER_BEND, MOST_COARSE = 2e-3, 0.2, 0.05
# Normals that are one, and the cosine from which on neighbours are a curved surface, no edge.
SAME_NORMAL, SMOOTH = 1e-6, 0.5

# Normals by which sliding is judged: those of contact, or of one side, along which bodies slide
# whatever the gap between both.
CONTACT, SLAVE, MASTER = "normal", "slave_normal", "facing"


def ActiveRows(contact: LACContact, holds: str = "now") -> SkinRows | csr_matrix:
    """The constraints at work, as a scipy matrix on all scalar dofs, scaled by the areas.

    `holds` selects what slipping contact prevents: "now" approach alone, "rubbing" all motion
    where there is friction, "closed" what all of contact would prevent if it were closed.
    """
    table, d = contact.Table(), contact.components
    stick, slip = _AtWork(contact, table, holds)
    if not len(slip) and not np.any(stick):
        return NoRows(contact.form)
    jump = AllJumps(contact)
    normals = scipy.sparse.csr_matrix(
        (
            table["normal"][slip].ravel(),
            (np.arange(len(slip)).repeat(d), (d * slip[:, None] + np.arange(d)).ravel()),
        ),
        shape=(len(slip), jump.shape[0]),
    )
    rows = Stacked([jump[np.repeat(stick, d)], normals @ jump])
    return rows / table["fullarea"].mean()


def AllJumps(contact: LACContact) -> SkinRows | csr_matrix:
    """Jumps of u and of tools on macro-elements: a row for each component, on all scalar dofs."""
    rows = JumpRowsEverywhere(contact.form, Side.both)
    return rows + ToolRows(contact) if len(contact.form.ToolDofs()) else rows


class Sight:
    """How the macro-elements of a contact see motions; kept as long as neither of them changes."""

    def __init__(self, contact: LACContact):
        self.contact, self._place, self._motions, self._curved = contact, None, None, None

    def Look(self) -> tuple:
        """Look at the contact as it is now; returns a key that changes with what it prevents."""
        contact = self.contact
        self._table = table = contact.Table()
        place = contact.form.JumpNumber(), contact.form.ToolRows().tobytes()
        if place != self._place:
            self._place, self._motions, self._curved = place, None, None
        tells = (*(table[name].tobytes() for name in ("status", "area", "normal")),)
        return *place, *tells, contact.holds_tangentially

    def Resistances(
        self, motions: csr_matrix, holds: str, normals: str = CONTACT
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Resistance to the columns of a sparse matrix (n, k), as of the last `Look`.

        Arrays: (r, k) the parts that contact prevents; (r,) how much of a motion along the surface
        the mesh makes one across it; (s, k) all relative motion of the macro-elements at work.
        """
        table, none = self._table, np.zeros((0, motions.shape[1]))
        stick, slip = _AtWork(self.contact, table, holds)
        if not len(slip) and not np.any(stick):
            return none, np.zeros(0), none
        seen, mesh = self._Seen(motions), self._Coarse()
        across = np.einsum("md,mdk->mk", _Normals(self.contact, table, normals)[slip], seen[slip])
        held, sliding = (np.concatenate([none, *seen[own]]) for own in (stick, slip))
        coarse = np.concatenate([np.full(len(held), TIGHT), mesh[slip]])
        return np.concatenate([held, across]), coarse, np.concatenate([held, sliding])

    def _Seen(self, motions: csr_matrix) -> np.ndarray:
        """The relative motions (m, d, k) of macro-elements, of their mean size."""
        if self._motions is not motions:
            shape = len(self._table["area"]), self.contact.components, motions.shape[1]
            seen = (AllJumps(self.contact) @ motions).toarray() / self._table["fullarea"].mean()
            self._motions, self._seen = motions, seen.reshape(shape)
        return self._seen

    def _Coarse(self) -> np.ndarray:
        turned = self._table["normal"].tobytes()
        if self._curved != turned:
            self._curved, self._coarse = turned, _Coarseness(self.contact, self._table)
        return self._coarse


def _Normals(contact: LACContact, table: dict[str, np.ndarray], kind: str) -> np.ndarray:
    """Of all macro-elements (m, d); those of contact where a side has none."""
    if kind == CONTACT:
        return table["normal"]
    normals = contact.form.Table()[kind]
    there = np.any(normals, axis=1)[:, None]
    return np.where(there, normals, table["normal"])


def _Coarseness(contact: LACContact, table: dict[str, np.ndarray]) -> np.ndarray:
    """Approach over motion along the surface that the mesh may make, of each macro-element."""
    normal, paired = table["normal"], np.flatnonzero(table["area"] > 0)
    bend = 24 * np.maximum(1 - contact.form.Table()["flatness"], 0)
    curved = bend > SAME_NORMAL**2
    count = min(len(paired), 3 if contact.mesh.dim == 2 else 7)
    if count > 1:
        _, near = scipy.spatial.KDTree(table["x"][paired]).query(table["x"][paired], k=count)
        angles = np.linalg.norm(normal[paired][near] - normal[paired][:, None], axis=2)
        smooth = (angles > SAME_NORMAL) & (angles < 2 * (1 - SMOOTH))
        curved[paired] |= np.any(smooth, axis=1)
    coarse = np.clip(PER_BEND * bend, COARSE, MOST_COARSE)
    return np.where(curved, coarse, TIGHT)


def _AtWork(
    contact: LACContact, table: dict[str, np.ndarray], holds: str
) -> tuple[np.ndarray, np.ndarray]:
    """Macro-elements held in all directions (as mask), and along the normal only (numbers)."""
    closed = table["area"] > 0 if holds == "closed" else table["status"] > 0
    stick = closed & ((table["status"] == 1) | ((holds != "now") & contact.holds_tangentially))
    return stick, np.flatnonzero(closed & ~stick)


def ActiveRates(contact: LACContact, rates: np.ndarray) -> np.ndarray:
    """The product of `ActiveRows` and the velocity, if bodies go with the obstacle."""
    table = contact.Table()
    stick, slip = _AtWork(contact, table, "now")
    rates = rates * (table["area"] / table["fullarea"].mean())[:, None]
    return np.concatenate([rates[stick].ravel(), np.sum(rates * table["normal"], axis=1)[slip]])


def ToolDofs(contacts: Sequence[LACContact]) -> np.ndarray:
    """Scalar dofs of the unknown motions of tools, each once."""
    return np.unique(np.concatenate([contact.form.ToolDofs() for contact in contacts]))


def ToolsSlipFar(contacts: Sequence[LACContact], correction: np.ndarray) -> bool:
    """Does a correction (n,) move a tool along the slave as far as no iterate should?"""
    return any(_ToolWay(contact, correction) > FAR_SLIP for contact in contacts)


def _ToolWay(contact: LACContact, values: np.ndarray) -> float:
    """How far an unknown of a tool moves it along the slave, relative to the size of that."""
    dofs, table = contact.form.ToolDofs(), contact.Table()
    normal, area = table["normal"], table["area"].sum()
    if not len(dofs) or not area:
        return 0.0
    rows = contact.form.ToolRows().reshape(*normal.shape, len(dofs))
    rows = rows - normal[:, :, None] * np.einsum("md,mdt->mt", normal, rows)[:, None, :]
    lengths = np.linalg.norm(rows, axis=1).sum(axis=0)
    d = contact.mesh.dim
    size = np.sum(contact._Sizes() ** (d - 1)) ** (1 / (d - 1))
    return np.max(np.abs(values[dofs]) * lengths) / (area * size)


def ToolRows(contact: LACContact) -> csr_matrix:
    """How the unknown motion of a tool moves it relative to macro-elements, like `JumpRows`.

    On all scalar dofs.
    """
    dofs, rows = contact.form.ToolDofs(), contact.form.ToolRows()
    count = len(rows) // len(dofs)
    starts = len(dofs) * np.arange(count + 1)
    return scipy.sparse.csr_matrix(
        (rows, np.tile(dofs, count), starts), shape=(count, contact.nscalars)
    )
