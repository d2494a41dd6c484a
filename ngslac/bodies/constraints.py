# SPDX-License-Identifier: LGPL-2.1-or-later
"""What contact prevents, as rows of a sparse matrix on the displacements."""

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix, vstack

from ngslac._ngslac import Side

__all__ = ["ActiveRates", "ActiveRows", "JumpRows", "ToCSR", "ToolDofs", "ToolRows", "ToolsSlipFar"]

# Of the size of the slave: a tool that nothing but friction holds goes no farther at once.
FAR_SLIP = 0.1


def ToCSR(mat):
    """A sparse NGSolve matrix with scalar or square block entries as scipy matrix."""
    block = mat.entrysizes[0]
    # CSR() shows memory of the matrix: copy, the matrix may be a temporary.
    values, columns, starts = (np.array(a) for a in mat.CSR())
    if block == 1:
        return csr_matrix((values, columns, starts), shape=mat.shape)
    shape = block * mat.height, block * mat.width
    return bsr_matrix((values.reshape(-1, block, block), columns, starts), shape=shape).tocsr()


def ActiveRows(contact, holds="now"):
    """The constraints at work, as a scipy matrix on all scalar dofs, scaled by the areas.

    Parameters
    ----------
    contact : LACContact
    holds : {"now", "rubbing", "closed"}
        What contact prevents: nothing but approach where it slips; all motion where it rubs; or as
        if all of it were closed.
    """
    table, form = contact.Table(), contact.form
    d = contact.mesh.dim
    stick, slip = _AtWork(contact, table, holds)
    if not len(slip) and not np.any(stick):
        return csr_matrix((0, contact.nscalars))
    jump = JumpRows(contact)
    normals = csr_matrix(
        (
            table["normal"][slip].ravel(),
            (np.arange(len(slip)).repeat(d), (d * slip[:, None] + np.arange(d)).ravel()),
        ),
        shape=(len(slip), jump.shape[0]),
    )

    def AtWork(jump):
        return vstack([jump[np.repeat(stick, d)], normals @ jump]).tocsr()

    rows = AtWork(jump)
    columns = rows.indices + form.offset * form.fes.dim
    shape = rows.shape[0], contact.nscalars
    rows = csr_matrix((rows.data, columns, rows.indptr), shape=shape)
    if len(form.ToolDofs()):
        rows = rows + AtWork(ToolRows(contact))
    return rows / table["fullarea"].mean()


def _AtWork(contact, table, holds):
    """Macro-elements held in all directions (as mask), and along the normal only (numbers)."""
    closed = table["area"] > 0 if holds == "closed" else table["status"] > 0
    stick = closed & ((table["status"] == 1) | ((holds != "now") & contact.holds_tangentially))
    return stick, np.flatnonzero(closed & ~stick)


def ActiveRates(contact, rates):
    """What `ActiveRows` times the velocity is, if bodies go with the obstacle.

    Parameters
    ----------
    contact : LACContact
    rates : (m, d) array
        Mean velocity of the obstacle at each macro-element.

    Returns
    -------
    (n,) array
        One for each row.
    """
    table = contact.Table()
    stick, slip = _AtWork(contact, table, "now")
    rates = rates * (table["area"] / table["fullarea"].mean())[:, None]
    return np.concatenate([rates[stick].ravel(), np.sum(rates * table["normal"], axis=1)[slip]])


def ToolDofs(contacts):
    """Scalar dofs of the unknown motions of tools, each once."""
    return np.unique(np.concatenate([contact.form.ToolDofs() for contact in contacts]))


def ToolsSlipFar(contacts, correction):
    """Does a correction (n,) move a tool along the slave as far as no iterate should?"""
    return any(_ToolWay(contact, correction) > FAR_SLIP for contact in contacts)


def _ToolWay(contact, values):
    """How far an unknown of a tool moves it along the slave, relative to the size of that."""
    dofs, table = contact.form.ToolDofs(), contact.Table()
    normal, area = table["normal"], table["area"].sum()
    if not len(dofs) or not area:
        return 0.0
    rows = contact.form.ToolRows().reshape(*normal.shape, len(dofs))
    rows = rows - normal[:, :, None] * np.einsum("md,mdt->mt", normal, rows)[:, None, :]
    lengths = np.linalg.norm(rows, axis=1).sum(axis=0)
    size = table["fullarea"].sum() ** (1 / (contact.mesh.dim - 1))
    return np.max(np.abs(values[dofs]) * lengths) / (area * size)


def ToolRows(contact):
    """What each macro-element sees of the unknown motion of a tool, like `JumpRows`.

    On all scalar dofs.
    """
    dofs, rows = contact.form.ToolDofs(), contact.form.ToolRows()
    count = len(rows) // len(dofs)
    starts = len(dofs) * np.arange(count + 1)
    return csr_matrix((rows, np.tile(dofs, count), starts), shape=(count, contact.nscalars))


def JumpRows(contact):
    """What each macro-element sees of a displacement, times its area: d rows of each, sparse."""
    return ToCSR(contact.form.JumpMatrix(Side.both))
