"""The style of the pictures of the report, and the deformed meshes in them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from ngsolve import BND, CF, ET, VOL, IntegrationRule, x, y

__all__ = ["INK", "STYLE", "Matplotlib", "Sample", "SampleMesh", "Save"]

INK = "#222222"
STYLE = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.labelsize": 9,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "savefig.dpi": 220,
}


def Matplotlib():
    """Import matplotlib, or say how to get it."""
    try:
        import matplotlib.collections
        import matplotlib.colors
        import matplotlib.figure
        import matplotlib.ticker
        import matplotlib.tri
    except ImportError as error:
        raise ImportError("the pictures need matplotlib: pip install matplotlib") from error
    return matplotlib


def Save(figure, file):
    # A bare Figure draws with the Agg canvas: no display, no global state.
    figure.savefig(file, bbox_inches="tight", facecolor="white")


# ---------------------------------------------------------------- sampling


@dataclass(frozen=True)
class Sample:
    """A refinement of every element: deformed points, triangles, lines."""

    points: np.ndarray  # (n, 2)
    triangles: np.ndarray  # (m, 3)
    body: np.ndarray  # (m,) number of the body, by its material
    edges: np.ndarray  # (k, s, 2) element edges as polygons
    outline: np.ndarray  # (b, s, 2) boundary elements as polygons


def _Reference(kind, n):
    """Points, triangles and edges (as chains of points) of a refined reference element."""
    quad = kind == ET.QUAD
    grid = [(i, j) for i in range(n + 1) for j in range(n + 1) if quad or i + j <= n]
    number = {p: k for k, p in enumerate(grid)}
    cells = [[(i, j), (i + 1, j), (i, j + 1)] for i, j in grid]
    cells += [[(i + 1, j), (i + 1, j + 1), (i, j + 1)] for i, j in grid]
    steps = range(n + 1)
    chains = [[(s, 0) for s in steps], [(0, s) for s in steps]]
    chains += [[(s, n) for s in steps], [(n, s) for s in steps]] if quad else []
    chains += [] if quad else [[(s, n - s) for s in steps]]
    return (
        [(i / n, j / n) for i, j in grid],
        np.array([[number[p] for p in cell] for cell in cells if number.keys() >= set(cell)]),
        np.array([[number[p] for p in chain] for chain in chains]),
    )


def _Rule(points):
    return IntegrationRule(points=points, weights=[0.0] * len(points))


def SampleMesh(mesh, displacement, *, factor=1.0, n=4):
    """The deformed position on a refinement of every element."""
    parts = {kind: _Reference(kind, n) for kind in (ET.TRIG, ET.QUAD)}
    rules = {kind: _Rule(grid) for kind, (grid, _, _) in parts.items()}
    position = CF((x, y)) + factor * CF(displacement)
    points = position(mesh.MapToAllElements(rules, VOL))
    elements = list(mesh.Elements(VOL))
    bodies = {name: i for i, name in enumerate(dict.fromkeys(mesh.GetMaterials()))}
    number = [bodies[el.mat] for el in elements]
    sizes = [len(parts[el.type][0]) for el in elements]
    first = np.cumsum([0, *sizes])
    triangles = [parts[el.type][1] + k for el, k in zip(elements, first, strict=False)]
    edges = [parts[el.type][2] + k for el, k in zip(elements, first, strict=False)]
    line = mesh.MapToAllElements({ET.SEGM: _Rule([(s / n, 0) for s in range(n + 1)])}, BND)
    return Sample(
        points=points,
        triangles=np.concatenate(triangles),
        body=np.repeat(number, [len(t) for t in triangles]),
        edges=points[np.concatenate(edges)],
        outline=position(line).reshape(-1, n + 1, 2),
    )
