# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which rows of a sparse matrix are connected."""

from functools import singledispatch

import numpy as np
import scipy

__all__ = ["AreApart", "ConnectedParts", "Forces", "PartsOf"]


def Forces(mat, first, count):
    """A function that multiplies with the rows and columns of the displacement, in threads."""
    factor, product = mat.CreateRowVector(), mat.CreateColVector()
    factor[:] = 0
    own = slice(first, first + count)

    def Times(values):
        factor.FV().NumPy()[own] = values
        product.data = mat * factor
        return product.FV().NumPy()[own].copy()

    return Times


@singledispatch
def PartsOf(mat, form, are_apart):
    """A number (n,) for each dof of the displacement of a contact form: the same in each body.

    `are_apart` checks numbers that may be right. The parallel room has an answer of its own.
    """
    block, space = form.fes.dim, form.component
    part = LikelyParts(mat, form.offset, space.ndof).repeat(block)
    if are_apart(part):
        return part
    return ConnectedParts(mat, form.offset, space.ndof).repeat(block)


def ConnectedParts(mat, first, count):
    """A number (count,) for each of some rows of a sparse matrix: the same where they connect."""
    columns, starts = Graph(mat, first, count)
    # Other rows are left empty, which makes each a strongly connected part of its own.
    starts = np.pad(starts, (first, mat.height - first - count), mode="edge")
    graph = scipy.sparse.csr_matrix((np.ones(len(columns)), columns, starts), shape=mat.shape)
    return scipy.sparse.csgraph.connected_components(graph, connection="strong")[1][
        first : first + count
    ]


def LikelyParts(mat, first, count):
    """The same or too many parts, from two entries of each row."""
    columns, starts = Graph(mat, first, count)
    ends = np.arange(count)[:, None].repeat(2, axis=1)
    filled = np.flatnonzero(np.diff(starts))
    found = columns[np.stack([starts[:-1], starts[1:] - 1], axis=1)[filled]] - first
    ends[filled] = np.where((found >= 0) & (found < count), found, ends[filled])
    starts = np.arange(0, 2 * count + 1, 2)
    graph = scipy.sparse.csr_matrix(
        (np.ones(2 * count), ends.ravel(), starts), shape=(count, count)
    )
    return scipy.sparse.csgraph.connected_components(graph, directed=False)[1]


def Graph(mat, first, count):
    """Columns of some rows of a sparse matrix, which are not copied, and where each row starts."""
    _, columns, starts = (np.asarray(a) for a in mat.CSR())
    starts = starts[first : first + count + 1].astype(np.int64)
    return columns[starts[0] : starts[-1]], starts - starts[0]


def AreApart(part, forces, values, pushed):
    """Do the parts not act on each other? The test is forces(values) = pushed."""
    weights = np.random.default_rng(1).standard_normal(1 + part.max(initial=0))[part]
    sizes = np.zeros(1 + part.max(initial=0))
    np.maximum.at(sizes, part, np.abs(pushed))
    return bool(np.all(np.abs(forces(weights * values) - weights * pushed) <= 1e-12 * sizes[part]))
