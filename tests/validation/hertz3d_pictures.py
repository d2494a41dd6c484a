"""Picture of the pressures of a Hertz problem in 3D."""

from __future__ import annotations

import numpy as np
from hertzmeans import Means
from macros3d import Outlines
from report_pictures import BLUE, GREY, INK, ORANGE, STYLE, Matplotlib, Save

__all__ = ["PressurePicture"]


def PressurePicture(results, file):
    """The pressures over the distance from the middle, and on the macro-elements from below."""
    mpl = Matplotlib()
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(9.4, 4.1), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
        hertz, state = results.problem.Hertz(), results.states[-1]
        _Profile(left, results.faces, hertz, state)
        faces = _Faces(mpl, right, results.faces, hertz.contact_radius, state.pressure)
        bar = figure.colorbar(faces, ax=right, shrink=0.85, label="pressure [MPa]")
        bar.outline.set_linewidth(0.5)
        Save(figure, file)


def _Profile(ax, faces, hertz, state):
    low, high = faces.extent.T
    closed, middle = state.status > 0, 0.5 * (low + high)
    for mine, colour, label in ((closed, BLUE, "in contact"), (~closed, GREY, "open")):
        pressure = state.pressure[mine]
        ax.hlines(pressure, low[mine], high[mine], color=colour, lw=0.8, alpha=0.5)
        ax.plot(middle[mine], pressure, "o", color=colour, ms=3, label=f"macro-element, {label}")
    ax.plot(middle, Means(faces, hertz), "x", color=ORANGE, ms=3, mew=0.7, label="mean of Hertz'")
    r = np.linspace(0, high.max(), 1001)
    ax.plot(r, hertz.Pressure(r), color=INK, lw=0.9, label="Hertz' pressure")
    ax.set(xlabel="distance from the middle [mm]", ylabel="pressure [MPa]", xlim=(0, high.max()))
    ax.set_ylim(bottom=-0.03 * hertz.peak)
    ax.legend(loc="lower left")
    ax.set_title("multipliers, constant on each macro-element")


def _Faces(mpl, ax, faces, radius, pressure):
    shown = mpl.collections.PolyCollection(faces.corners, cmap="viridis", edgecolors="face")
    shown.set_array(pressure[faces.owner])
    ax.add_collection(shown)
    lines = mpl.collections.LineCollection(Outlines(faces), colors="white", linewidths=0.5)
    ax.add_collection(lines)
    angle = np.linspace(0, 2 * np.pi, 361)
    ax.plot(radius * np.cos(angle), radius * np.sin(angle), color=ORANGE, lw=1.0)
    corners = faces.corners.reshape(-1, 2)
    (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
    # The y axis points down when looking up.
    ax.set(xlim=(x0, x1), ylim=(y1, y0), aspect="equal", xlabel="x [mm]", ylabel="y [mm]")
    ax.set_title("seen from below, and Hertz' contact radius", pad=10)
    return shown
