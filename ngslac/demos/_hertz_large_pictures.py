"""Pictures of the flattened cylinder: deformed states, force curve, pressures."""

from __future__ import annotations

import numpy as np
from ngsolve import Det, Id
from ngsolve import Grad as Gradient

from ngslac.output.vtkfile import WriteVTK

from ._pictures import INK, STYLE, Matplotlib, SampleMesh, Save, Window

__all__ = ["OverviewPicture", "Write"]


def Write(results, directory):
    """Write ``hertz_large.png`` and ``hertz_large.vtu``."""
    directory.mkdir(parents=True, exist_ok=True)
    if results.states:
        OverviewPicture(results, directory / "hertz_large.png")
    model = results.model
    shown = {"displacement": model.displacement, "stress_yy": Stress(results)}
    WriteVTK(directory / "hertz_large", model.mesh, shown, subdivision=1)


def Stress(results):
    """Vertical component of Cauchy's stress, in MPa."""
    problem = results.problem
    shear = problem.young / (2 * (1 + problem.nu))
    bulk = problem.young / (3 * (1 - 2 * problem.nu))
    F = Id(2) + Gradient(results.model.displacement)
    J, b = Det(F), F * F.trans
    mean = (b[0, 0] + b[1, 1] + 1) / 3
    return shear * J ** (-5 / 3) * (b[1, 1] - mean) + bulk / 2 * (J - 1 / J)


def OverviewPicture(results, file):
    """Half of the section at rest, on the way and at the end, with the curves of the force."""
    mpl = Matplotlib()
    states = results.states
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(9.4, 6.4), layout="constrained")
        upper, lower = figure.subfigures(2, 1, height_ratios=(1, 1.05))
        axes = upper.subplots(1, 3)
        solution = results.model.solution.vec
        last = solution.CreateVector(copy=True)
        shown = [states[0], states[(len(states) - 1) // 2], states[-1]]
        limit = None
        for ax, state in zip(axes[::-1], shown[::-1], strict=True):
            solution.data = state.vector
            limit, image = _Section(mpl, ax, results, limit)
            Window(mpl, ax, (0, 1.3, -0.15, 1.05), "mm")
            ax.set_title(f"approach {state.approach:.2f} mm")
        solution.data = last
        upper.colorbar(image, ax=list(axes), shrink=0.8, label=r"$\sigma_{yy}$ [MPa]")
        left, right = lower.subplots(1, 2)
        _Forces(left, results.figures)
        _Pressure(right, results)
        Save(figure, file)


def _Section(mpl, ax, results, limit):
    """Colours and element edges; the limit of the colours is that of the first call."""
    model = results.model
    sample = SampleMesh(model.mesh, model.displacement, [Stress(results)], n=4)
    cylinder = sample.triangles[sample.body == 0]
    values = sample.values[0]
    if limit is None:
        limit = -float(values[cylinder].min())
    grid = mpl.tri.Triangulation(*sample.points.T, cylinder)
    image = ax.tripcolor(
        grid, values, shading="gouraud", cmap="viridis", vmin=-limit, vmax=0, rasterized=True
    )
    plate = mpl.tri.Triangulation(*sample.points.T, sample.triangles[sample.body == 1])
    grey = mpl.colors.ListedColormap(["#C9C9C9"])
    ax.tripcolor(plate, np.zeros(len(values)), cmap=grey, rasterized=True)
    lines = mpl.collections.LineCollection
    ax.add_collection(lines(sample.edges, colors="white", linewidths=0.2, zorder=2))
    ax.add_collection(lines(sample.outline, colors=INK, linewidths=0.8, zorder=3))
    return limit, image


def _Forces(ax, figures):
    approach = [0.0, *figures["approach"]]
    for key, style, label in (
        ("force", {"color": "#0072B2", "lw": 1.6}, "computed"),
        ("hertz", {"color": INK, "lw": 0.9, "ls": "--"}, "Hertz, small strains"),
    ):
        ax.plot(approach, [0.0, *figures[key]], label=label, **style)
    ax.set_xlabel("approach of the middle to a plate [mm]")
    ax.set_ylabel("force [N/mm]")
    ax.set_xlim(0, approach[-1])
    ax.set_ylim(bottom=0)
    ax.legend(loc="upper left")


def _Pressure(ax, results):
    """Pressures of the last state, per area of the reference, on the deformed arc."""
    table = results.model.contact.Table()
    order = np.argsort(table["x"][:, 0])
    x, p = table["x"][order, 0], table["pressure"][order]
    closed = table["status"][order] > 0
    ax.plot(x[closed], p[closed], "o", color="#0072B2", ms=3.5, label="in contact")
    ax.plot(x[~closed], p[~closed], "o", color="#8C8C8C", ms=3.5, label="open")
    ax.set_xlabel("position of the macro-element, x [mm]")
    ax.set_ylabel("pressure per reference area [MPa]")
    ax.set_ylim(bottom=-0.02 * p.max())
    ax.set_xlim(left=0)
    ax.legend(loc="upper right")
