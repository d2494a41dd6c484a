"""Picture of the materials demo: force of the cord, the squeezed cord, the disc in its ring."""

from __future__ import annotations

import numpy as np
from ngsolve import VOL

from ._materials_rubber import SqueezeForce
from ._pictures import INK, STYLE, Matplotlib, SampleMesh, Save, Window

__all__ = ["MaterialsPicture"]


def MaterialsPicture(results, file):
    """Draw both cases.

    Parameters
    ----------
    results : dict
        Of `Run`.
    file : str or path
        Name of the picture.
    """
    mpl = Matplotlib()
    rubber, thermal = results["rubber"], results["thermal"]
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(11.5, 3.6), layout="constrained")
        force, cord, disc = figure.subplots(1, 3, width_ratios=(1, 1.2, 1.2))
        _Force(force, rubber)
        _Field(mpl, figure, cord, rubber, ("rubber",), 1.0, "pressure in the rubber / G")
        cord.set_title("rubber cord, true scale")
        _Field(mpl, figure, disc, thermal, ("disc", "ring"), 200.0, "hoop stress / E")
        disc.set_title("heated disc in a ring, displacement x 200")
        Window(mpl, cord, (0, 80, 0, 60), "mm")
        Window(mpl, disc, (0, 110, 0, 110), "mm")
        Save(figure, file)


def _Force(ax, rubber):
    squeeze, force = np.transpose(rubber.curve)
    small = np.linspace(1e-4, squeeze[-1])
    ax.plot(small, [SqueezeForce(s) for s in small], color=INK, lw=0.9, label="small strains")
    ax.plot(squeeze, force, color="#0072B2", marker=".", ms=6, lw=1.2, label="computed")
    ax.set_xlabel("approach of the plates / diameter")
    ax.set_ylabel("force / (diameter G)")
    ax.set_xlim(left=0)
    ax.set_ylim(bottom=0)
    ax.legend(loc="upper left")


def _Field(mpl, figure, ax, result, bodies, factor, label):
    """A field on the deformed bodies; the others in grey."""
    mesh = result.mesh
    sample = SampleMesh(mesh, result.displacement, [result.field], factor=factor)
    names = list(dict.fromkeys(mesh.GetMaterials()))
    shown = np.isin(sample.body, [names.index(body) for body in bodies])
    if not shown.all():
        grid = mpl.tri.Triangulation(*sample.points.T, sample.triangles[~shown])
        grey = mpl.colors.ListedColormap(["#DDDDDD"])
        ax.tripcolor(grid, np.zeros(len(sample.points)), cmap=grey)
    grid = mpl.tri.Triangulation(*sample.points.T, sample.triangles[shown])
    values = sample.values[0][np.unique(sample.triangles[shown])]
    levels = np.linspace(*np.quantile(values, [0.002, 0.998]), 13)
    inside = np.clip(sample.values[0], levels[0], levels[-1])
    areas = ax.tricontourf(grid, inside, levels=levels, cmap="viridis")
    elements = np.repeat([el.mat in bodies for el in mesh.Elements(VOL)], 3)
    lines = mpl.collections.LineCollection
    ax.add_collection(lines(sample.edges[elements], colors=INK, linewidths=0.15, zorder=2))
    ax.add_collection(lines(sample.outline, colors=INK, linewidths=0.8, zorder=3))
    figure.colorbar(areas, ax=ax, shrink=0.75, label=label, format="%.2g")
