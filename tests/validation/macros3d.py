"""Multipliers of a round or straight contact in 3D against Hertz' means, and their smoothness."""

from dataclasses import dataclass

import numpy as np
from hertzmeans import Compare, Means, Radius
from slavefaces import SlaveFaces

__all__ = ["Bends", "Comparison", "Neighbours", "Outlines", "Solution"]

INNER = 0.8  # times the contact radius: macro-elements whose pressures are smooth


@dataclass(frozen=True)
class Solution:
    """A converged problem, with Hertz' solution of the same force.

    Macro-elements are in the order of the space; their pressures are forces per area of the
    undeformed slave side.
    """

    faces: SlaveFaces
    hertz: object
    pressure: np.ndarray
    status: np.ndarray
    share: float = 1.0  # contact force over load
    iterations: int = 0

    @property
    def radius(self):
        return Radius(self.hertz)

    @property
    def figures(self):
        return Comparison(self.faces, self.hertz, self.pressure)

    @property
    def misfit(self):
        """How far closed macro-elements lie outside of Hertz' contact, and open ones inside."""
        (low, high), closed = self.faces.extent.T, self.status > 0
        outside, inside = low[closed] - self.radius, self.radius - high[~closed]
        return max(outside.max(initial=0.0), inside.max(initial=0.0))


def Edges(faces):
    """The macro-elements of each edge and the edge's ends (2, 2)."""
    edges = {}
    for face, at, macro in zip(faces.vertices, faces.corners, faces.owner, strict=True):
        for i, (a, b) in enumerate(zip(np.roll(face, 1), face, strict=True)):
            owners, _ = edges.setdefault(frozenset((a, b)), (set(), at[[i - 1, i]]))
            owners.add(int(macro))
    return list(edges.values())


def Outlines(faces):
    """Ends (k, 2, 2) of the edges between different macro-elements."""
    return np.array([ends for owners, ends in Edges(faces) if len(owners) == 2])


def Neighbours(faces):
    """Pairs (k, 2) of macro-elements with a common edge, each in both orders."""
    pairs = {tuple(sorted(owners)) for owners, _ in Edges(faces) if len(owners) == 2}
    pairs = np.array(sorted(pairs)).reshape(-1, 2)
    return np.concatenate([pairs, pairs[:, ::-1]])


def Bends(faces, *fields):
    """Second differences: values of the macro-elements less the means of their neighbours."""
    one, other = Neighbours(faces).T
    count = np.maximum(np.bincount(one, minlength=len(faces.area)), 1)
    return [v - np.bincount(one, v[other], minlength=len(v)) / count for v in fields]


def Comparison(faces, hertz, pressure):
    """The figures of `Compare`, and three more.

    ``second_difference``, ``second_difference_exact``, ``oscillation``: the largest differences to
    the mean of the neighbours of the pressures, of the exact means, and of the errors, over the
    peak, inside of 80 % of the radius (None if there is no macro-element).
    """
    names = ("second_difference", "second_difference_exact", "oscillation")
    figures = Compare(faces, hertz, pressure) | dict.fromkeys(names)
    inner = faces.extent[:, 1] < INNER * Radius(hertz)
    if inner.any():
        exact = Means(faces, hertz)
        fields = (v / hertz.peak for v in (pressure, exact, pressure - exact))
        bends = (float(np.abs(bend[inner]).max()) for bend in Bends(faces, *fields))
        figures |= dict(zip(names, bends, strict=True))
    return figures
