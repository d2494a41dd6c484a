"""What the pictures of the validation report share."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import numpy as np
from ngsolve import BND, CF, ET, VOL, IntegrationRule, x, y

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

# Colours that colour-blind readers tell apart (Okabe and Ito).
BLUE, ORANGE, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#8C8C8C"
STATUS = (("open", GREY), ("stick", BLUE), ("slip", ORANGE))
SHADES = ("#CFE3F1", "#F6E6C6", "#DDEBD3")


def Matplotlib():
    """Import matplotlib, or say how to get it."""
    try:
        import matplotlib.collections
        import matplotlib.figure
    except ImportError as error:
        raise ImportError("the pictures need matplotlib: pip install matplotlib") from error
    return matplotlib


def Save(figure, file):
    # A bare Figure draws with the Agg canvas: no display, no global state.
    figure.savefig(file, bbox_inches="tight", facecolor="white")


def Figure(draw, *, columns=1, size=(9.0, 3.6), **options):
    """A picture: ``draw(*axes)`` is called when it is written to a file."""

    def Write(file):
        mpl = Matplotlib()
        with mpl.rc_context(STYLE | {"savefig.dpi": 120}):
            figure = mpl.figure.Figure(figsize=size, layout="constrained")
            axes = figure.subplots(1, columns, squeeze=False, **options)[0]
            draw(*axes)
            Save(figure, file)

    return Write


def FromFolder(write, name):
    """The picture `name` of all that ``write(folder)`` writes."""

    def Write(file):
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder))
            shutil.copy(Path(folder) / name, file)

    return Write


def Strip(ax, groups, *, tolerance, label="largest relative error"):
    """Errors of many cases on a logarithmic axis, a line of points for each group."""
    rng = np.random.default_rng(0)
    for k, errors in enumerate(groups.values()):
        at = k + rng.uniform(-0.25, 0.25, len(errors))
        ax.plot(np.maximum(errors, 1e-17), at, "o", ms=3, mew=0, alpha=0.6, color=BLUE)
    ax.axvline(tolerance, color=ORANGE, lw=1, ls="--", label="accepted")
    ax.set_xscale("log")
    ax.set_yticks(range(len(groups)), groups)
    ax.invert_yaxis()
    ax.set_xlabel(label)
    ax.legend(loc="lower left")


def Bodies(ax, mesh, displacement, *, factor=1.0, n=2, window=None):
    """The deformed mesh of a 2D problem, each side of an element in `n` pieces."""
    position = CF((x, y)) + factor * CF(displacement)
    corners = {ET.TRIG: [(0, 0), (1, 0), (0, 1)], ET.QUAD: [(0, 0), (1, 0), (1, 1), (0, 1)]}
    along = np.arange(n)[:, None] / n
    chains = {}
    for kind, ends in corners.items():
        sides = zip(ends, ends[1:] + ends[:1], strict=True)
        chains[kind] = [tuple(p) for a, b in sides for p in a + along * np.subtract(b, a)]
    points = position(mesh.MapToAllElements({k: Rule(chain) for k, chain in chains.items()}, VOL))
    elements = list(mesh.Elements(VOL))
    cells = np.split(points, np.cumsum([len(chains[el.type]) for el in elements])[:-1])
    names = list(dict.fromkeys(mesh.GetMaterials()))
    shades = [SHADES[names.index(el.mat) % len(SHADES)] for el in elements]
    collections = Matplotlib().collections
    polygons = collections.PolyCollection
    ax.add_collection(polygons(cells, facecolors=shades, edgecolors=INK, linewidths=0.3))
    sides = {ET.SEGM: Rule([(s / n, 0) for s in range(n + 1)])}
    outline = position(mesh.MapToAllElements(sides, BND)).reshape(-1, n + 1, 2)
    ax.add_collection(collections.LineCollection(outline, colors=INK, linewidths=0.9))
    ax.autoscale_view()
    ax.set_aspect("equal")
    ax.set_axis_off()
    if window:
        ax.set_xlim(*window[:2])
        ax.set_ylim(*window[2:])


def Rule(points):
    return IntegrationRule(points=points, weights=[0.0] * len(points))


def Profile(ax, start, end, values, status=None, *, label="computed"):
    """A step for each macro-element, coloured by its status if that is given."""
    if status is None:
        ax.hlines(values, start, end, color=BLUE, lw=2, label=label)
        return
    for number, (name, colour) in enumerate(STATUS):
        mine = status == number
        if np.any(mine):
            ax.hlines(values[mine], start[mine], end[mine], color=colour, lw=2, label=name)
