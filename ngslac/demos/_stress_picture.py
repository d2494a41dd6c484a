"""Picture of stress components on the deformed bodies."""

from __future__ import annotations

import numpy as np
from ngsolve import H1, BilinearForm, GridFunction, LinearForm, dx

from ._pictures import INK, STYLE, Matplotlib, SampleMesh, Save, Window

__all__ = ["StressPicture"]


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
    sample = SampleMesh(mesh, displacement, smooth, factor=factor)
    with mpl.rc_context(STYLE):
        width, height = 3.4, 3.4 * (window[3] - window[2]) / (window[1] - window[0])
        figure = mpl.figure.Figure(figsize=((width + 1.3) * len(smooth), height + 0.6))
        axes = figure.subplots(1, len(smooth), squeeze=False, gridspec_kw={"wspace": 0.42})[0]
        for ax, label, values in zip(axes, stresses, sample.values, strict=True):
            low, high = (limits or {}).get(label) or _Extremes(sample.points, values, window)
            areas, ticks = _Contours(mpl, ax, sample, values, low, high)
            bar = figure.colorbar(areas, cax=ax.inset_axes([1.03, 0, 0.045, 1]), ticks=ticks)
            bar.outline.set_linewidth(0.5)
            ax.set_title(f"{label}  [{unit}]")
            Window(mpl, ax, window, length)
        if title:
            figure.suptitle(title, fontsize=11, y=0.97)
        Save(figure, file)


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
    ax.tricontour(grid, values, levels=levels, colors=INK, linewidths=0.2, linestyles="solid")
    outline = mpl.collections.LineCollection(sample.outline, colors=INK, linewidths=1.0, zorder=3)
    ax.add_collection(outline)
    return areas, ticks[(ticks >= levels[0]) & (ticks <= levels[-1])]


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
