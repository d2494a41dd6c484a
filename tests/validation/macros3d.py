"""Multipliers of a round or straight contact in 3D against Hertz' means, and their smoothness."""

import numpy as np
from hertzmeans import Compare, Means, Radius

__all__ = ["Bends", "Comparison", "Neighbours", "Outlines"]

INNER = 0.8  # times the contact radius: macro-elements whose pressures are smooth


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


def Comparison(faces, hertz, pressure, status):
    """The figures of `Compare`, and more.

    ``contact_edge_interval``: where the first open macro-element begins and the last closed one
    ends, over the radius; ``second_difference``, ``second_difference_exact``, ``oscillation``: the
    largest differences to the mean of the neighbours of the pressures, of the exact means, and of
    the errors, over the peak, inside of 80 % of the radius (None if there is no macro-element).
    """
    radius, closed = Radius(hertz), status > 0
    low, high = faces.extent.T
    edge = [low[~closed].min(initial=np.inf), high[closed].max(initial=0.0)]
    names = ("second_difference", "second_difference_exact", "oscillation")
    figures = Compare(faces, hertz, pressure) | dict.fromkeys(names)
    figures["contact_edge_interval"] = [float(r / radius) for r in edge]
    inner = high < INNER * radius
    if inner.any():
        exact = Means(faces, hertz)
        fields = (v / hertz.peak for v in (pressure, exact, pressure - exact))
        bends = (float(np.abs(bend[inner]).max()) for bend in Bends(faces, *fields))
        figures |= dict(zip(names, bends, strict=True))
    return figures
