"""Pictures of the ironing problem: deformed states with the stress, and the force curves."""

from __future__ import annotations

import numpy as np
from ngsolve import Det, Id, InnerProduct, sqrt
from ngsolve import Grad as Gradient

from ngslac.output.vtkfile import WriteVTK

from ._ironing_reference import PUBLISHED, TIMES
from ._pictures import INK, STYLE, Matplotlib, SampleMesh, Save, Window

__all__ = ["OverviewPicture", "Write"]

_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00")
_WINDOW = (-0.6, 13.2, -4.15, 1.6)


def Write(results, directory):
    """Write the picture and a VTU file of the last state."""
    directory.mkdir(parents=True, exist_ok=True)
    if results.states:
        OverviewPicture(results, directory / "ironing.png")
    shown = {"displacement": results.displacement, "mises": Mises(results)}
    WriteVTK(directory / "ironing", results.mesh, shown, subdivision=1)


def Mises(results):
    """Von Mises' equivalent of the Kirchhoff stress over J, in MPa: Cauchy's stress."""
    from .ironing import POISSON, YOUNG  # the constants live with the problem

    shear = results.mesh.MaterialCF(YOUNG) / (2 * (1 + POISSON))
    F = Id(2) + Gradient(results.displacement)
    J, b = Det(F), F * F.trans
    # The deviator of b in three dimensions, where b_zz = 1.
    mean = (b[0, 0] + b[1, 1] + 1) / 3
    plane = b - mean * Id(2)
    norm = sqrt(1.5 * (InnerProduct(plane, plane) + (1 - mean) * (1 - mean)))
    return shear * J ** (-5 / 3) * norm


def OverviewPicture(results, file):
    """Two deformed states above the force curves, in one picture."""
    mpl = Matplotlib()
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(7.4, 9.6), layout="constrained")
        axes = figure.subplots(3, 1, gridspec_kw={"height_ratios": (1, 1, 1.2)})
        _States(mpl, figure, axes[:2], results, (1.0, 1.5))
        _Forces(axes[2], results.figures)
        Save(figure, file)


def _States(mpl, figure, axes, results, times, limit=300.0):
    solution = results.solution.vec
    last = solution.CreateVector(copy=True)
    for ax, time in zip(axes, times, strict=True):
        state = min(results.states, key=lambda s: abs(s.time - time))
        solution.data = state.vector
        sample = SampleMesh(results.mesh, results.displacement, [Mises(results)], n=4)
        image = _Bodies(mpl, ax, sample, limit)
        Window(mpl, ax, _WINDOW, "mm")
        ax.set_title(f"t = {state.time:.2f}")
    solution.data = last
    bar = figure.colorbar(image, ax=list(axes), shrink=0.6, extend="max")
    bar.set_label("von Mises stress [MPa]")


def _Bodies(mpl, ax, sample, limit):
    """Colours, element edges and outlines; returns the colours."""
    for number in np.unique(sample.body):
        grid = mpl.tri.Triangulation(*sample.points.T, sample.triangles[sample.body == number])
        image = ax.tripcolor(
            grid,
            sample.values[0],
            shading="gouraud",
            cmap="viridis",
            vmin=0,
            vmax=limit,
            rasterized=True,
        )
    lines = mpl.collections.LineCollection
    ax.add_collection(lines(sample.edges, colors="white", linewidths=0.15, zorder=2))
    ax.add_collection(lines(sample.outline, colors=INK, linewidths=0.8, zorder=3))
    return image


def _Forces(ax, figures):
    times = [0.0, *figures["time"]]
    for name, style in (("vertical", "-"), ("horizontal", "--")):
        curve = [0.0, *figures[f"{name}_force"]]
        ax.plot(times, curve, style, color=INK, lw=1.4, label=f"ngslac, {name}")
    for (name, curves), colour in zip(PUBLISHED.items(), _COLOURS, strict=True):
        for curve, marker in zip(curves, "os", strict=True):
            label = name if marker == "o" else None
            ax.plot(TIMES, curve, marker, color=colour, ms=4, mfc="none", label=label)
    ax.set_xlim(0, 2)
    ax.set_ylim(0, 1.5 * max(421, *figures["vertical_force"]))
    ax.set_xlabel("time (1: indented by 1 mm, 2: moved by 10 mm)")
    ax.set_ylabel("force of the die [N/mm]")
    title = f"friction {figures['friction']:g} (published: 0.3)"
    ax.legend(title=f"{title}; circles vertical, squares horizontal", ncols=2, loc="upper left")
