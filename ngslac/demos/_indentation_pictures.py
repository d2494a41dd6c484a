"""Picture of the indentation: load over depth, mean pressure, plastic strain and imprint."""

from __future__ import annotations

import math

import numpy as np
from ngsolve import H1, VOL, BilinearForm, GridFunction, LinearForm, dx

from ._indentation_figures import PRANDTL
from ._pictures import INK, STYLE, Matplotlib, SampleMesh, Save, Window

__all__ = ["IndentationPicture"]

_LOAD, _UNLOAD, _AGAIN = "#0072B2", "#D55E00", "#009E73"


def IndentationPicture(results, file, *, factor=15.0):
    """Draw the curves and the plastic strain on the block after the cylinder has left.

    Parameters
    ----------
    results : Results
        Of `Run`.
    file : str or path
        Name of the picture.
    factor : float
        Magnification of the displacement.
    """
    mpl = Matplotlib()
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(11.5, 3.6), layout="constrained")
        force, mean, strain = figure.subplots(1, 3, width_ratios=(1, 1, 1.5))
        _Force(force, results)
        _MeanPressure(mean, results)
        areas = _Strain(mpl, strain, results, factor)
        figure.colorbar(areas, ax=strain, shrink=0.75, label="accumulated plastic strain [%]")
        Save(figure, file)


def _Force(ax, results):
    start = {"depth": 0.0, "force": 0.0}
    phases = [
        ("loading", [start, *results.loading], _LOAD, "-"),
        ("unloading", [results.loading[-1], *results.unloading], _UNLOAD, "-"),
        ("loading again", [results.unloading[-1], *results.reloading], _AGAIN, "--"),
    ]
    for label, rows, colour, style in phases:
        depth, value = ([row[name] for row in rows] for name in ("depth", "force"))
        ax.plot(depth, value, style, color=colour, marker=".", ms=4, lw=1.2, label=label)
    ax.set_xlabel("depth of the cylinder [mm]")
    ax.set_ylabel("force [N/mm]")
    ax.set_xlim(left=0)
    ax.set_ylim(bottom=0)
    ax.legend(loc="upper left")


def _MeanPressure(ax, results):
    """Mean pressure over the non-dimensional contact width, as in Johnson's figure 6.15."""
    rows = [row for row in results.loading if row["closed"] > 3]
    width = np.array([row["scaled_width"] for row in rows])
    pressure = np.array([row["mean_pressure"] for row in rows]) / results.problem.yield_stress
    elastic = np.linspace(0.1, 2.4 * 8 / math.pi)
    ax.semilogx(elastic, math.pi / 8 * elastic, color=INK, lw=0.9, label="Hertz")
    ax.axhline(PRANDTL, color=INK, lw=0.9, ls=(0, (4, 2)), label="rigid plastic")
    onset = math.pi / 4 * results.figures["onset_pressure_hertz"]
    ax.plot(8 / math.pi * onset, onset, "o", color=INK, ms=5, mfc="none", label="first yield")
    ax.plot(width, pressure, color=_LOAD, marker=".", ms=5, lw=1.2, label="computed")
    ax.set_xlabel("E* a / (Y R)")
    ax.set_ylabel("mean pressure / Y")
    ax.set_xlim(1, 1.2 * width.max())
    ax.set_ylim(0, 1.1 * PRANDTL)
    ax.legend(loc="lower right")


def _Strain(mpl, ax, results, factor):
    """Accumulated plastic strain on the block with the imprint."""
    shift = results.imprint
    window = (0, 2.2 * results.figures["halfwidth"], -2.0 * results.figures["halfwidth"], 1.0)
    strain = _Smooth(results)
    sample = SampleMesh(results.mesh, shift, [strain], factor=factor, n=3)
    block = list(dict.fromkeys(results.mesh.GetMaterials())).index("block")
    triangles = sample.triangles[sample.body == block]
    grid = mpl.tri.Triangulation(*sample.points.T, triangles)
    values = 100 * np.clip(sample.values[0], 0, None)
    top = 100 * float(np.quantile(results.material.accumulated.vec.FV().NumPy(), 0.998))
    levels = np.linspace(0, top, 13)
    areas = ax.tricontourf(grid, np.clip(values, 0, top), levels=levels, cmap="YlOrRd")
    lines = mpl.collections.LineCollection
    inside = [el.mat == "block" for el in results.mesh.Elements(VOL)]
    edges = sample.edges[np.repeat(inside, 3)]  # of triangles
    ax.add_collection(lines(edges, colors=INK, linewidths=0.15, zorder=2))
    Window(mpl, ax, window, "mm")
    ax.set_title(f"after the cylinder has left, displacement x {factor:g}")
    return areas


def _Smooth(results):
    """The accumulated plastic strain as a continuous field."""
    material = results.material
    space = H1(results.mesh, order=1, definedon="block")
    u, v = space.TnT()
    rule = dx("block", intrules=material.rules)
    mass = BilinearForm(u * v * rule).Assemble()
    load = LinearForm(material.accumulated * v * rule).Assemble()
    field = GridFunction(space)
    field.vec.data = mass.mat.Inverse(space.FreeDofs(), inverse="sparsecholesky") * load.vec
    return field
