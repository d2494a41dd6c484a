# SPDX-License-Identifier: LGPL-2.1-or-later
"""Rigid motions, as tables and at points."""

import numpy as np

__all__ = ["MotionsAt", "Tables"]


def Tables(d: int) -> tuple[np.ndarray, list[str]]:
    """Each motion as a (d, 1 + d) array: component = row . (1, r), r from the middle; names."""
    planes = [(0, 1)] if d == 2 else [(1, 2), (2, 0), (0, 1)]
    tables = np.zeros((d + len(planes), d, 1 + d))
    for k in range(d):
        tables[k, k, 0] = 1
    for k, (i, j) in enumerate(planes, d):
        tables[k, i, 1 + j], tables[k, j, 1 + i] = -1, 1
    names = [f"translation in {c}" for c in "xyz"[:d]]
    names += ["rotation"] if d == 2 else [f"rotation about {c}" for c in "xyz"]
    return tables, names


def MotionsAt(points: np.ndarray) -> np.ndarray:
    """At points (n, d), rotations about their middle and divided by their size: (n, d, m)."""
    d = points.shape[1]
    arms = points - points.mean(axis=0) if len(points) else points
    arms = arms / max(np.abs(arms).max(initial=0.0), np.finfo(float).tiny)
    basis = np.column_stack([np.ones(len(points)), arms])
    return np.einsum("nb,mcb->ncm", basis, Tables(d)[0])
