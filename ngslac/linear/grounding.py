# SPDX-License-Identifier: LGPL-2.1-or-later
"""Springs that hold each body by itself, on as few dofs as it has rigid motions."""

import numpy as np
import scipy

__all__ = ["Grounded"]

# Of a motion that is none, relative to the largest.
NO_MOTION = 1e-6


def Grounded(mat, free, motions):
    """Dofs (k,) that springs on them hold all bodies by, whatever else holds these.

    Parameters
    ----------
    mat : SparseMatrix
        Scalar.
    free : (n,) bool
        Its dofs that count.
    motions : (n, m) array
        Rigid motions of the whole mesh, zero where dofs are no displacements.
    """
    dofs = np.flatnonzero(free & np.any(motions, axis=1))
    part = FreeParts(mat, free)[dofs]
    dofs = dofs[np.argsort(part, kind="stable")]
    ends = np.flatnonzero(np.diff(np.sort(part))) + 1
    chosen = [Spread(own, motions[own]) for own in np.split(dofs, ends)]
    return np.sort(np.concatenate(chosen))


def FreeParts(mat, free):
    """A number (n,) for each free dof: the same where the matrix connects them without others."""
    values, columns, starts = (np.asarray(a) for a in mat.CSR())
    starts = starts.astype(columns.dtype)
    rows = np.repeat(free, np.diff(starts))
    links = rows & free[columns] & (values != 0)
    count = np.concatenate([[0], np.cumsum(links, dtype=columns.dtype)])
    columns, starts = columns[links], count[starts]
    graph = scipy.sparse.csr_matrix(
        (np.ones(len(columns), np.int8), columns, starts), shape=mat.shape
    )
    return scipy.sparse.csgraph.connected_components(graph, directed=False)[1]


def Spread(dofs, motions):
    """Those of some dofs that tell their motions apart best: a pivoted elimination."""
    if not len(dofs):
        return dofs
    triangle, order = scipy.linalg.qr(motions.T, mode="r", pivoting=True)
    pivots = np.abs(np.diag(triangle))
    return dofs[order[: len(pivots)][pivots > NO_MOTION * pivots[0]]]
