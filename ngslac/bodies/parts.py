# SPDX-License-Identifier: LGPL-2.1-or-later
"""Which rows of a sparse matrix are connected."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ngslac._ngslac import ContactForm, PieceOf, VertexDofs
from ngslac.arrays import Multiply
from ngslac.parallel.layout import Layout, LayoutOf, Whole
from ngslac.parallel.spread import Spread

if TYPE_CHECKING:
    from ngsolve import BaseMatrix

__all__ = ["AreApart", "ConnectedParts", "Forces", "Groups", "PartsOf"]


def Forces(
    mat: BaseMatrix, layout: Layout | Whole, first: int, count: int
) -> Callable[[np.ndarray], np.ndarray]:
    """A function that multiplies with the rows and columns of the displacement, in threads."""
    every, own = layout.Zeros(), slice(first, first + count)

    def Times(values: np.ndarray) -> np.ndarray:
        every[own] = values
        return Multiply([mat], every)[own]

    return Times


def Groups(part: np.ndarray, used: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """Pairs of a part and those of its rows that are used, of this process."""
    rows = np.flatnonzero(used)
    numbers = np.asarray(part)[rows]
    order = np.argsort(numbers, kind="stable")
    rows, numbers = rows[order], numbers[order]
    if not isinstance(part, Spread):
        firsts = np.flatnonzero(np.diff(numbers, prepend=-1))
        return list(zip(numbers[firsts], np.split(rows, firsts[1:]), strict=False))
    count = 1 + part.max()  # those that are used have the first numbers
    ends = np.searchsorted(numbers, np.arange(count + 1))
    return [(k, rows[ends[k] : ends[k + 1]]) for k in range(count)]


def PartsOf(
    mat: BaseMatrix,
    form: ContactForm,
    are_apart: Callable[[np.ndarray], bool] | None,
    used: np.ndarray,
) -> np.ndarray:
    """A number (n,) for each dof of the displacement of a contact form: the same in each body.

    `are_apart` checks numbers that may be right; `used` are the rows (n,) of the bulk.
    """
    block, space = form.fes.dim, form.component
    if isinstance(used, Spread):
        local = LayoutOf(space).Local(mat)
        rows = ConnectedParts(local, form.offset, space.ndof).repeat(block)
        return JoinedParts(rows, used, LayoutOf(space))
    part = LikelyParts(mat, form.offset, space.ndof).repeat(block)
    if are_apart(part):
        return part
    return ConnectedParts(mat, form.offset, space.ndof).repeat(block)


def ConnectedParts(mat: BaseMatrix, first: int, count: int) -> np.ndarray:
    """A number (count,) for each of some rows of a sparse matrix: the same where they connect."""
    columns, starts = Graph(mat, first, count)
    # Other rows are left empty, which makes each a strongly connected part of its own.
    starts = np.pad(starts, (first, mat.height - first - count), mode="edge")
    graph = scipy.sparse.csr_matrix((np.ones(len(columns)), columns, starts), shape=mat.shape)
    return scipy.sparse.csgraph.connected_components(graph, connection="strong")[1][
        first : first + count
    ]


def LikelyParts(mat: BaseMatrix, first: int, count: int) -> np.ndarray:
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


def Graph(mat: BaseMatrix, first: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Columns of some rows of a sparse matrix, which are not copied, and where each row starts."""
    _, columns, starts = (np.asarray(a) for a in mat.CSR())
    starts = starts[first : first + count + 1].astype(np.int64)
    return columns[starts[0] : starts[-1]], starts - starts[0]


def AreApart(
    part: np.ndarray,
    forces: Callable[[np.ndarray], np.ndarray],
    values: np.ndarray,
    pushed: np.ndarray,
) -> bool:
    """Do the parts not act on each other? The test is forces(values) = pushed."""
    weights = np.random.default_rng(1).standard_normal(1 + part.max(initial=0))[part]
    sizes = np.zeros(1 + part.max(initial=0))
    np.maximum.at(sizes, part, np.abs(pushed))
    return bool(np.all(np.abs(forces(weights * values) - weights * pushed) <= 1e-12 * sizes[part]))


def JoinedParts(part: np.ndarray, used: np.ndarray, layout: Layout | Whole) -> np.ndarray:
    """Numbers (n,) of the parts of all processes, in the order of their vertices; unused: -1.

    `part` are numbers of connected rows here. Those of several processes are joined by their rows
    that these share.
    """
    together, used = layout.together, np.asarray(used)
    counts = np.array(together.Gather(1 + part.max(initial=-1)))
    own = part + np.sum(counts[: together.rank])
    owners = np.asarray(layout.Consistent(own.astype(float))).astype(int)
    links = np.unique(np.stack([own, owners], axis=1)[used], axis=0)
    links, size = together.Rows(links), int(np.sum(counts))
    graph = scipy.sparse.coo_matrix((np.ones(len(links)), links.T), shape=(size, size))
    joined = scipy.sparse.csgraph.connected_components(graph, directed=False)[1][own]
    return layout.Of(np.where(used, Ordered(joined, used, layout), -1))


def Ordered(part: np.ndarray, used: np.ndarray, layout: Layout | Whole) -> np.ndarray:
    """Numbers from 0 on in place of others, in the order of the first vertices of the parts."""
    together, space = layout.together, layout.space
    numbers = np.array(PieceOf(space.mesh)[0])[:, 0]
    dofs = VertexDofs(space)
    if space.dim > 1:
        dofs = dofs * space.dim
    size = 1 + together.Reduce(part.max(initial=-1), "MAX")
    first = np.full(size, np.iinfo(np.int64).max)
    for column in dofs.T:
        there = column >= 0
        there[there] = used[column[there]]
        np.minimum.at(first, part[column[there]], numbers[: len(column)][there])
    first = together.Reduce(first, "MIN")
    seen = np.zeros(size, dtype=bool)
    seen[part[used]] = True
    seen = together.Reduce(seen, "LOR")
    order = np.lexsort((np.arange(size), np.where(seen, first, np.iinfo(np.int64).max)))
    number = np.empty(size, dtype=int)
    number[order] = np.arange(size)
    return number[part]
