"""Pictures of contact problems in 2D with matplotlib.

The input is an NGSolve mesh with CoefficientFunctions, and numpy arrays per macro-element;
nothing here knows about contact objects.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from ngsolve import (
    BND,
    CF,
    ET,
    H1,
    VOL,
    BilinearForm,
    GridFunction,
    IntegrationRule,
    LinearForm,
    dx,
    x,
    y,
)

__all__ = ["MultiplierPicture", "StressPicture"]

# Colours that colour-blind readers tell apart (Okabe and Ito), by status number.
_STATUS = (("open", "#8C8C8C"), ("stick", "#0072B2"), ("slip", "#D55E00"))
_BODIES = ("#CFE3F1", "#F6E6C6")
_INK = "#222222"
_STYLE = {
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


def _Save(figure, file):
    # A bare Figure draws with the Agg canvas: no display, no global state.
    figure.savefig(file, bbox_inches="tight", facecolor="white")


# ---------------------------------------------------------------- sampling


@dataclass(frozen=True)
class _Sample:
    """A refinement of every element: deformed points, triangles, lines, values."""

    points: np.ndarray  # (n, 2)
    triangles: np.ndarray  # (m, 3)
    body: np.ndarray  # (m,) number of the body, by its material
    edges: np.ndarray  # (k, s, 2) element edges as polygons
    outline: np.ndarray  # (b, s, 2) boundary elements as polygons
    values: list  # (n,) for each function


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


def _SampleMesh(mesh, displacement, functions=(), *, factor=1.0, n=4):
    """Evaluate the deformed position and functions on a refinement of every element."""
    parts = {kind: _Reference(kind, n) for kind in (ET.TRIG, ET.QUAD)}
    rules = {kind: _Rule(grid) for kind, (grid, _, _) in parts.items()}
    position = CF((x, y)) + factor * CF(displacement)
    at = mesh.MapToAllElements(rules, VOL)
    points = position(at)
    elements = list(mesh.Elements(VOL))
    bodies = {name: i for i, name in enumerate(dict.fromkeys(mesh.GetMaterials()))}
    number = [bodies[el.mat] for el in elements]
    sizes = [len(parts[el.type][0]) for el in elements]
    first = np.cumsum([0, *sizes])
    triangles = [parts[el.type][1] + k for el, k in zip(elements, first, strict=False)]
    edges = [parts[el.type][2] + k for el, k in zip(elements, first, strict=False)]
    line = mesh.MapToAllElements({ET.SEGM: _Rule([(s / n, 0) for s in range(n + 1)])}, BND)
    return _Sample(
        points=points,
        triangles=np.concatenate(triangles),
        body=np.repeat(number, [len(t) for t in triangles]),
        edges=points[np.concatenate(edges)],
        outline=position(line).reshape(-1, n + 1, 2),
        values=[np.asarray(CF(f)(at)).ravel() for f in functions],
    )


def _Smooth(mesh, function, order):
    """The L2 projection of a discontinuous field to a continuous one.

    The bodies share no nodes, so nothing is mixed across the interface.
    """
    space = H1(mesh, order=order)
    u, v = space.TnT()
    mass = BilinearForm(u * v * dx).Assemble()
    load = LinearForm(function * v * dx).Assemble()
    field = GridFunction(space)
    field.vec.data = mass.mat.Inverse(inverse="sparsecholesky") * load.vec
    return field


# ---------------------------------------------------------------- stress


def StressPicture(
    mesh,
    displacement,
    stresses,
    file,
    *,
    window,
    factor=1.0,
    title=None,
    unit="MPa",
    length="mm",
    order=2,
    limits=None,
):
    """Draw stress components side by side on the deformed configuration.

    Parameters
    ----------
    mesh : ngsolve.Mesh
        Mesh of the bodies.
    displacement : ngsolve.CoefficientFunction
        Displacement field.
    stresses : dict
        Label (in matplotlib's mathematical text) -> scalar CoefficientFunction. A component that
        takes both signs is drawn with a diverging colour map centred at zero.
    file : str or path
        Name of the picture.
    window : tuple of float
        Part of the plane to show: x0, x1, y0, y1.
    factor : float
        Magnification of the displacement.
    title : str, optional
        Title of the picture.
    unit, length : str
        Units of stress and length, for the labels.
    order : int
        Order of the continuous field through which the contours are drawn.
    limits : dict, optional
        Label -> (low, high); by default the extremes inside the window, rounded.
    """
    mpl = Matplotlib()
    smooth = [_Smooth(mesh, s, order) for s in stresses.values()]
    sample = _SampleMesh(mesh, displacement, smooth, factor=factor)
    with mpl.rc_context(_STYLE):
        width, height = 3.4, 3.4 * (window[3] - window[2]) / (window[1] - window[0])
        figure = mpl.figure.Figure(figsize=((width + 1.3) * len(smooth), height + 0.6))
        axes = figure.subplots(1, len(smooth), squeeze=False, gridspec_kw={"wspace": 0.42})[0]
        for ax, label, values in zip(axes, stresses, sample.values, strict=True):
            low, high = (limits or {}).get(label) or _Extremes(sample.points, values, window)
            areas, ticks = _Contours(mpl, ax, sample, values, low, high)
            bar = figure.colorbar(areas, cax=ax.inset_axes([1.03, 0, 0.045, 1]), ticks=ticks)
            bar.outline.set_linewidth(0.5)
            ax.set_title(f"{label}  [{unit}]")
            _Window(mpl, ax, window, length)
        if title:
            figure.suptitle(title, fontsize=11, y=0.97)
        _Save(figure, file)


def _Extremes(points, values, window):
    """Range of the values inside the window, without the last outliers."""
    x0, x1, y0, y1 = window
    px, py = points.T
    inside = values[(px >= x0) & (px <= x1) & (py >= y0) & (py <= y1)]
    return np.quantile(inside, [0.001, 0.999])


def _Contours(mpl, ax, sample, values, low, high):
    """Filled contours and thin lines of one component; returns them and the ticks."""
    signed = min(-low, high) > 0.25 * max(-low, high)
    if signed:
        low, high = -max(-low, high), max(-low, high)
    ticks = mpl.ticker.MaxNLocator(8, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
    step = (ticks[1] - ticks[0]) / 4
    # Levels half-way between multiples of the step: none at zero, the value of free surfaces.
    levels = np.arange(np.floor(low / step - 0.5), np.ceil(high / step + 0.5) + 1) * step
    levels += step / 2
    levels = levels[(levels > low - step) & (levels < high + step)]
    colours = "RdBu_r" if signed else ("viridis" if -low > high else "viridis_r")
    grid = mpl.tri.Triangulation(*sample.points.T, sample.triangles)
    inside = np.clip(values, levels[0] + 1e-6 * step, levels[-1] - 1e-6 * step)
    areas = ax.tricontourf(grid, inside, levels=levels, cmap=colours)
    ax.tricontour(grid, values, levels=levels, colors=_INK, linewidths=0.2, linestyles="solid")
    outline = mpl.collections.LineCollection(sample.outline, colors=_INK, linewidths=1.0, zorder=3)
    ax.add_collection(outline)
    return areas, ticks[(ticks >= levels[0]) & (ticks <= levels[-1])]


def _Window(mpl, ax, window, length):
    ax.set_xlim(*window[:2])
    ax.set_ylim(*window[2:])
    ax.set_aspect("equal")
    for axis, name in ((ax.xaxis, "x"), (ax.yaxis, "y")):
        axis.set_major_locator(mpl.ticker.MaxNLocator(7, steps=[1, 2, 5, 10]))
        axis.set_label_text(f"{name} [{length}]")


# ---------------------------------------------------------------- multipliers


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
    with mpl.rc_context(_STYLE):
        figure = mpl.figure.Figure(figsize=(9.2, 4.3), layout="constrained")
        grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.1), height_ratios=(1.7, 1))
        left = figure.add_subplot(grid[:, 0])
        upper = figure.add_subplot(grid[0, 1])
        lower = figure.add_subplot(grid[1, 1], sharex=upper)
        _Interface(mpl, left, _SampleMesh(mesh, displacement, factor=factor))
        _Window(mpl, left, window, length)
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
        _Save(figure, file)


def _Interface(mpl, ax, sample):
    """Both bodies with their element edges, deformed."""
    for number in np.unique(sample.body):
        grid = mpl.tri.Triangulation(*sample.points.T, sample.triangles[sample.body == number])
        colour = mpl.colors.ListedColormap([_BODIES[number % len(_BODIES)]])
        ax.tripcolor(grid, np.zeros(len(sample.points)), cmap=colour, rasterized=True)
    lines = mpl.collections.LineCollection
    ax.add_collection(lines(sample.edges, colors=_INK, linewidths=0.3, zorder=2))
    ax.add_collection(lines(sample.outline, colors=_INK, linewidths=1.0, zorder=3))


def _Steps(ax, macros, values):
    """One bar per macro-element, coloured by status."""
    ax.axhline(0, color=_INK, lw=0.5, zorder=0)
    for number, (name, colour) in enumerate(_STATUS):
        mine = macros["status"] == number
        if mine.any():
            start, end = macros["start"][mine], macros["end"][mine]
            ax.hlines(values[mine], start, end, color=colour, lw=2.4, label=name, zorder=3)


def _Pressure(ax, macros, exact):
    _Steps(ax, macros, macros["pressure"])
    if exact is not None:
        at = np.linspace(macros["start"].min(), macros["end"].max(), 2001)
        ax.plot(at, exact(at), color=_INK, lw=0.9, label="Hertz, no friction", zorder=4)
    ax.set_ylim(bottom=-0.04 * macros["pressure"].max())
    ax.legend(loc="upper right")


def _Traction(ax, macros, friction):
    traction = macros["traction"]
    _Steps(ax, macros, traction)
    if friction:
        bound = friction * macros["pressure"] * (-1 if traction.sum() < 0 else 1)
        edges = np.append(macros["start"], macros["end"][-1])
        label = f"bound {friction:g} p"
        ax.stairs(bound, edges, baseline=None, color=_INK, lw=0.9, ls=(0, (4, 2)), label=label)
        handles = [h for h in ax.get_legend_handles_labels()[0] if h.get_label() == label]
        ax.legend(handles=handles, loc="center right")
