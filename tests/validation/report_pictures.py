"""What the pictures of the validation report share."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import numpy as np
from report_sampling import INK, STYLE, Matplotlib, SampleMesh, Save

__all__ = [
    "BLUE",
    "GREEN",
    "GREY",
    "INK",
    "ORANGE",
    "Bodies",
    "Figure",
    "FromFolder",
    "Profile",
    "Strip",
]

# Colours that colour-blind readers tell apart (Okabe and Ito).
BLUE, ORANGE, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#8C8C8C"
STATUS = (("open", GREY), ("stick", BLUE), ("slip", ORANGE))
SHADES = ("#CFE3F1", "#F6E6C6", "#DDEBD3")


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
    """The deformed mesh of a 2D problem."""
    mpl = Matplotlib()
    sample = SampleMesh(mesh, displacement, factor=factor, n=n)
    for number in np.unique(sample.body):
        grid = mpl.tri.Triangulation(*sample.points.T, sample.triangles[sample.body == number])
        colour = mpl.colors.ListedColormap([SHADES[number % len(SHADES)]])
        ax.tripcolor(grid, np.zeros(len(sample.points)), cmap=colour, rasterized=True)
    lines = mpl.collections.LineCollection
    ax.add_collection(lines(sample.edges, colors=INK, linewidths=0.3))
    ax.add_collection(lines(sample.outline, colors=INK, linewidths=0.9))
    ax.set_aspect("equal")
    ax.set_axis_off()
    if window:
        ax.set_xlim(*window[:2])
        ax.set_ylim(*window[2:])


def Profile(ax, start, end, values, status=None, *, label="computed"):
    """A step for each macro-element, coloured by its status if that is given."""
    if status is None:
        ax.hlines(values, start, end, color=BLUE, lw=2, label=label)
        return
    for number, (name, colour) in enumerate(STATUS):
        mine = status == number
        if np.any(mine):
            ax.hlines(values[mine], start[mine], end[mine], color=colour, lw=2, label=name)
