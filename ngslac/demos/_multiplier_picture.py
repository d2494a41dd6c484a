"""Picture of the deformed interface and of the multipliers, numpy arrays per macro-element."""

from __future__ import annotations

import numpy as np

from ._pictures import INK, STYLE, Matplotlib, SampleMesh, Save, Window

__all__ = ["MultiplierPicture"]

# Colours that colour-blind readers tell apart (Okabe and Ito), by status number.
_STATUS = (("open", "#8C8C8C"), ("stick", "#0072B2"), ("slip", "#D55E00"))
_BODIES = ("#CFE3F1", "#F6E6C6")


def MultiplierPicture(
    mesh,
    displacement,
    macros,
    file,
    *,
    exact=None,
    friction=None,
    window,
    limit=None,
    factor=1.0,
    title=None,
    unit="MPa",
    length="mm",
):
    """Draw the deformed interface and the multipliers along it.

    Parameters
    ----------
    mesh, displacement, file, window, factor, title, unit, length
        As for `StressPicture`; `window` belongs to the interface on the left.
    macros : dict of numpy.ndarray
        Per macro-element, ordered along the interface: "start", "end" (positions x), "pressure",
        "traction" (tangential), "status" (0 open, 1 stick, 2 slip).
    exact : callable, optional
        Exact pressure at an array of positions.
    friction : float, optional
        Coefficient of friction, to draw the bound of the tangential traction.
    limit : float, optional
        Largest position x in the diagrams of the multipliers.
    """
    mpl = Matplotlib()
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(9.2, 4.3), layout="constrained")
        grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.1), height_ratios=(1.7, 1))
        left = figure.add_subplot(grid[:, 0])
        upper = figure.add_subplot(grid[0, 1])
        lower = figure.add_subplot(grid[1, 1], sharex=upper)
        _Interface(mpl, left, SampleMesh(mesh, displacement, factor=factor))
        Window(mpl, left, window, length)
        left.set_title("deformed interface")
        _Pressure(upper, macros, exact)
        _Traction(lower, macros, friction)
        upper.set_title("multipliers, constant on each macro-element")
        upper.set_ylabel(f"pressure [{unit}]")
        upper.tick_params(labelbottom=False)
        lower.set_ylabel(f"tangential [{unit}]")
        lower.set_xlabel(f"x [{length}]")
        lower.set_xlim(macros["start"].min(), limit or macros["end"].max())
        figure.align_ylabels([upper, lower])
        if title:
            figure.suptitle(title, fontsize=11)
        Save(figure, file)


def _Interface(mpl, ax, sample):
    """Both bodies with their element edges, deformed."""
    for number in np.unique(sample.body):
        grid = mpl.tri.Triangulation(*sample.points.T, sample.triangles[sample.body == number])
        colour = mpl.colors.ListedColormap([_BODIES[number % len(_BODIES)]])
        ax.tripcolor(grid, np.zeros(len(sample.points)), cmap=colour, rasterized=True)
    lines = mpl.collections.LineCollection
    ax.add_collection(lines(sample.edges, colors=INK, linewidths=0.3, zorder=2))
    ax.add_collection(lines(sample.outline, colors=INK, linewidths=1.0, zorder=3))


def _Steps(ax, macros, values):
    """One bar per macro-element, coloured by status."""
    ax.axhline(0, color=INK, lw=0.5, zorder=0)
    for number, (name, colour) in enumerate(_STATUS):
        mine = macros["status"] == number
        if mine.any():
            start, end = macros["start"][mine], macros["end"][mine]
            ax.hlines(values[mine], start, end, color=colour, lw=2.4, label=name, zorder=3)


def _Pressure(ax, macros, exact):
    _Steps(ax, macros, macros["pressure"])
    if exact is not None:
        at = np.linspace(macros["start"].min(), macros["end"].max(), 2001)
        ax.plot(at, exact(at), color=INK, lw=0.9, label="Hertz, no friction", zorder=4)
    ax.set_ylim(bottom=-0.04 * macros["pressure"].max())
    ax.legend(loc="upper right")


def _Traction(ax, macros, friction):
    traction = macros["traction"]
    _Steps(ax, macros, traction)
    if friction:
        bound = friction * macros["pressure"] * (-1 if traction.sum() < 0 else 1)
        edges = np.append(macros["start"], macros["end"][-1])
        label = f"bound {friction:g} p"
        ax.stairs(bound, edges, baseline=None, color=INK, lw=0.9, ls=(0, (4, 2)), label=label)
        handles = [h for h in ax.get_legend_handles_labels()[0] if h.get_label() == label]
        ax.legend(handles=handles, loc="center right")
