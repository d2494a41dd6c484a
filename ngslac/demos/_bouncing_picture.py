"""Picture of the bouncing ring: instants of its flight, and where the energy goes."""

from __future__ import annotations

import numpy as np
from ngsolve import Grad, GridFunction, Id, InnerProduct

from ._pictures import INK, STYLE, Matplotlib, SampleMesh, Save

__all__ = ["Picture"]

COLOURS = {
    "kinetic": "#0072B2",
    "internal": "#E69F00",
    "friction": "#D55E00",
    "impact": "#999999",
    "algorithmic": "#DDDDDD",
}


def Picture(results, file):
    """Draw the instants of `results` above the energies over the time.

    Parameters
    ----------
    results : Results
        Of `ngslac.demos.bouncing.Run`.
    file : str or path
        Name of the picture.
    """
    mpl = Matplotlib()
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(8.0, 6.4))
        above, below = figure.subplots(2, 1, gridspec_kw={"hspace": 0.3, "height_ratios": (1.2, 1)})
        _Instants(mpl, figure, above, results)
        _Energies(below, results)
        Save(figure, file)


def _Instants(mpl, figure, ax, results):
    """The ring at several times, coloured by its strain; a dot moves with the material."""
    model, problem = results.model, results.problem
    samples = [_Sample(model, values) for _, values in results.instants]
    highest = max(np.quantile(sample.values[0], 0.995) for sample in samples)
    ax.axhspan(-0.2 * problem.radius, 0, color="#BBBBBB", lw=0)
    ax.axhline(0, color=INK, lw=0.8)
    path = np.array([state.center for state in model.states])
    ax.plot(*path.T, "--", color=INK, lw=0.6)
    corners = []
    for (time, _), sample in zip(results.instants, samples, strict=True):
        ring = sample.triangles[sample.body == 0]
        points = sample.points[np.unique(ring)]
        corners += [points.min(axis=0), points.max(axis=0)]
        grid = mpl.tri.Triangulation(*sample.points.T, ring)
        drawn = ax.tripcolor(
            grid, sample.values[0], shading="gouraud", cmap="viridis_r", vmin=0, vmax=highest
        )
        center = points.mean(axis=0)
        ax.text(center[0], -0.11 * problem.radius, f"{time:.2f}", ha="center", va="center")
        ax.plot(*_Mark(sample, ring), "o", color="#D55E00", ms=5, mec="white", zorder=4)
    margin = 0.1 * problem.radius
    ax.set_xlim(np.min(corners, axis=0)[0] - margin, np.max(corners, axis=0)[0] + margin)
    ax.set_ylim(-0.2 * problem.radius, np.max(corners, axis=0)[1] + margin)
    ax.set_aspect("equal")
    ax.set_title("instants; the number is the time, the dot moves with the material")
    bar = figure.colorbar(drawn, cax=ax.inset_axes([1.02, 0.1, 0.015, 0.8]))
    bar.outline.set_linewidth(0.5)
    bar.set_label("norm of the strain")


def _Sample(model, values):
    """Points of the deformed mesh, its strain and its material coordinates."""
    u = GridFunction(model.displacement.space)
    u.vec.FV().NumPy()[:] = values
    F = Id(2) + Grad(u)
    strain = 0.5 * (F.trans * F - Id(2))
    return SampleMesh(model.mesh, u, [InnerProduct(strain, strain) ** 0.5, u[0], u[1]])


def _Mark(sample, ring):
    """Where the point is that was on top."""
    start = sample.points - np.stack(sample.values[1:], axis=1)
    points = np.unique(ring)
    return sample.points[points[np.argmax(start[points, 1])]]


def _Energies(ax, results):
    """Energies and losses on each other; together they make the energy that was put in."""
    begin = [results.figures["energy_start"], 0, 0, 0, 0]
    table = results.model.stepper.Table()
    parts = [[b, *np.maximum(table[name], 0)] for b, name in zip(begin, COLOURS, strict=True)]
    time = [0, *table["time"]]
    ax.stackplot(time, *parts, colors=COLOURS.values(), labels=COLOURS, lw=0)
    given = results.figures["energy_start"] + np.array([0, *table["external"]])
    ax.plot(time, given, color=INK, lw=0.8, label="put in")
    ax.set_xlim(0, time[-1])
    ax.set_ylim(0, 1.25 * given.max())
    ax.set_xlabel("time")
    ax.set_ylabel("energy")
    ax.legend(loc="upper center", ncols=6)
