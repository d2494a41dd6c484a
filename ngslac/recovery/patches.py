# SPDX-License-Identifier: LGPL-2.1-or-later
"""Parts of the slave side whose macro-elements hang together."""

import numpy as np
from scipy.sparse.csgraph import connected_components

__all__ = ["Patches"]


class Patches:
    """Macro-elements that transmit forces, by the parts that share no vertex."""

    def __init__(self, surface, closed):
        self._neighbours, touches = surface.neighbours, surface.touches
        self.touched = touches.T @ closed > 0  # vertices of those that transmit forces
        mine = touches[closed]
        _, labels = connected_components(mine @ mine.T, directed=False)
        self.count = int(labels.max()) + 1 if len(labels) else 0
        # The patch of each macro-element, open ones included where they touch one; -1 for none.
        self.macro = np.full(len(closed), -1)
        self.macro[closed] = labels
        self.vertex = self._Largest(touches.T, self.macro)
        around = self._Largest(touches, self.vertex)
        self.macro = np.where(closed, self.macro, around)

    def Around(self, labels):
        """Labels of vertices with those of their neighbours where they have none."""
        return np.where(labels < 0, self._Largest(self._neighbours, labels), labels)

    @staticmethod
    def _Largest(graph, labels):
        """The largest label on the other side of a graph, -1 where there is none."""
        graph = graph.tocsr().copy()
        graph.data = labels[graph.indices] + 1.0
        return graph.max(axis=1).toarray().ravel().astype(int) - 1

    def Sums(self, of, values):
        """Sums (count, ...) of `values` (n, ...) of things that belong to the patches `of` (n,)."""
        mine = of >= 0
        flat = values[mine].reshape(mine.sum(), -1)
        sums = [np.bincount(of[mine], column, self.count) for column in flat.T]
        return np.stack(sums, axis=1).reshape(self.count, *values.shape[1:])
