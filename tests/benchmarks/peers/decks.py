"""What the input files of other programs share: lines of numbers, bodies; NumPy only."""

from __future__ import annotations

import numpy as np
from meshes import BODIES

__all__ = ["Bodies", "Rows"]


def Rows(numbers, values, *, join=" ", digits=None, most=99):
    """Lines of a number (from 0, written from 1) and its values, at most so many on a line."""
    for number, row in zip(np.asarray(numbers).tolist(), np.asarray(values).tolist(), strict=True):
        texts = (f"{v:.{digits}g}" if digits and isinstance(v, float) else repr(v) for v in row)
        words = [str(number + 1), *texts]
        yield join.join(words[:most]) + (join if words[most:] else "")
        if words[most:]:
            yield join.join(words[most:])


def Bodies(mesh, order):
    """Of each body its name, numbers of its elements (from 0), and nodes of these (from 1)."""
    for name in BODIES[mesh.problem]:
        elements = np.flatnonzero(mesh.materials == name)
        yield name, elements, mesh.Elements(order, name) + 1
