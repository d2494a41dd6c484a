# SPDX-License-Identifier: LGPL-2.1-or-later
"""Columns of a matrix that have no row in common, for what is done with many at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

__all__ = ["Colours"]


def Colours(rows: csr_matrix) -> np.ndarray:
    """A number (n,) for each column of a sparse matrix, such that no row has two of one."""
    graph = (rows.T @ rows).tocsr()
    graph.setdiag(0)
    graph.eliminate_zeros()
    count, rng = graph.shape[0], np.random.default_rng(0)
    colour, chance = np.full(count, -1), rng.permutation(count) + 1.0
    number = 0
    while np.any(colour < 0):
        allowed = colour < 0
        while np.any(allowed):
            mine = np.where(allowed, chance, 0)
            rival = graph.copy()
            rival.data = mine[graph.indices]
            most = rival.max(axis=1).toarray().ravel()
            taken = allowed & (mine > most)
            colour[taken] = number
            allowed &= ~taken & (graph @ taken.astype(float) == 0)
        number += 1
    return colour
