"""Pictures, scenes and VTU files of the friction problems in 3D."""

from __future__ import annotations

import numpy as np
from ngsolve import BND, BitArray
from ngsolve.webgui import Draw

from ngslac.output.vtkfile import WriteVTK

from ._pictures import INK, STYLE, Matplotlib, Save

__all__ = ["CurvePicture", "TractionPicture", "Write"]

# Colours that colour-blind readers tell apart (Okabe and Ito), by status number.
_STATUS = (("open", "#D9D9D9"), ("stick", "#0072B2"), ("slip", "#E69F00"))


def Write(results, directory, name, curve):
    """Write the results.

    ``NAME_curve.png`` (drawn by ``curve(ax, results)``), ``NAME_traction.png`` (some states),
    ``NAME_status.html`` and ``NAME_traction.html`` (the last one, for the browser), ``NAME.vtu``
    (volume) and ``NAME_contact.vtu`` (slave faces).
    """
    directory.mkdir(parents=True, exist_ok=True)
    CurvePicture(results, directory / f"{name}_curve.png", curve)
    TractionPicture(results, directory / f"{name}_traction.png")
    _Scenes(results.model, directory, name)
    _VTU(results.model, directory, name)


def CurvePicture(results, file, curve):
    """The curve of the load, and the stick radius."""
    mpl = Matplotlib()
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(9.2, 3.6), layout="constrained")
        left, right = figure.subplots(1, 2)
        curve(left, results)
        _StickRadius(right, results)
        Save(figure, file)


def _StickRadius(ax, results):
    rows = results.figures["steps"]
    number = np.arange(1, len(rows) + 1)
    for key, label, style in (
        ("stick_ratio_exact", "exact", {"color": INK, "marker": "_", "ms": 14, "mew": 1.2}),
        ("stick_ratio", "area that sticks", {"color": "#0072B2", "marker": "o", "ms": 4}),
        ("stick_ratio_fit", "fit of the tractions", {"color": "#D55E00", "marker": "x", "ms": 5}),
    ):
        values = [np.nan if row[key] is None else row[key] for row in rows]
        ax.plot(number, values, ls="none", label=label, **style)
    ax.set_xlabel("step")
    ax.set_xticks(number)
    ax.set_ylabel("radius of the stick zone / contact radius")
    ax.set_ylim(0, 1.05)
    ax.legend(loc="lower left")


def TractionPicture(results, file, *, shown=4):
    """Stick and slip with the tractions on the slave, seen from below, at some of the states."""
    mpl = Matplotlib()
    states, exact = results.states, results.exact
    chosen = np.unique(np.linspace(0, len(states) - 1, shown).round().astype(int))
    with mpl.rc_context(STYLE):
        height = 2.1 if results.problem.model == "half" else 3.2
        figure = mpl.figure.Figure(figsize=(2.6 * len(chosen), height), layout="constrained")
        axes = figure.subplots(1, len(chosen), squeeze=False)[0]
        for ax, k in zip(axes, chosen, strict=True):
            _Macros(mpl, ax, results, states[k], exact[k])
            ax.set_title(f"step {k + 1}")
        handles = [mpl.patches.Patch(color=colour, label=name) for name, colour in _STATUS]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
        Save(figure, file)


def _Macros(mpl, ax, results, state, exact):
    macros, hertz = results.faces.macros, results.problem.Hertz(state.force[2])
    colours = np.array([colour for _, colour in _STATUS])[state.status[macros.owner]]
    add = ax.add_collection
    add(mpl.collections.PolyCollection(macros.corners, facecolors=colours, edgecolors=colours))
    add(mpl.collections.LineCollection(macros.Outlines(), colors="white", linewidths=0.4))
    closed, middle = state.status > 0, results.faces.middle
    arrows = state.traction[closed] / (results.problem.friction * hertz.peak)
    ax.quiver(
        *middle[closed].T,
        *arrows.T,
        scale=0.6 * results.problem.elements / hertz.contact_radius,
        scale_units="xy",
        angles="xy",
        width=0.006,
        color=INK,
    )
    angle = np.linspace(0, 2 * np.pi, 361)
    for radius, style in ((hertz.contact_radius, "-"), (exact.stick, "--")):
        ax.plot(radius * np.cos(angle), radius * np.sin(angle), style, color=INK, lw=0.8)
    corners = macros.corners.reshape(-1, 2)
    (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
    ax.set_xlim(x0, x1)
    ax.set_ylim(y1, y0)  # the y axis points down when looking up
    ax.set_aspect("equal")
    ax.set_xlabel("x [mm]")
    ax.set_ylabel("y [mm]")


def _Scenes(model, directory, name):
    """Scenes for the browser, as self-contained as NGSolve makes them."""
    # From below: the slave faces look down.
    below = {"camera": {"transformations": [{"type": "rotateX", "angle": 110}]}}
    contact, slave = model.contact, model.mesh.Boundaries("slave")
    for label, field, options in (
        ("status", contact.status, {"min": 0, "max": 2}),
        ("traction", contact.traction, {}),
    ):
        scene = Draw(field, slave, settings=below, show=False, **options)
        scene.GenerateHTML(filename=str(directory / f"{name}_{label}.html"))


def _VTU(model, directory, name):
    displacement, contact = model.displacement, model.contact
    stress = model.problem.Stress(displacement)
    WriteVTK(
        directory / name,
        model.mesh,
        {"displacement": displacement, "stress": stress},
        subdivision=max(0, model.problem.order - 1),
    )
    names = ("pressure", "gap", "status", "traction", "slip", "normal")
    WriteVTK(
        directory / f"{name}_contact",
        model.mesh,
        {"displacement": displacement} | {field: getattr(contact, field) for field in names},
        vb=BND,
        drawelems=BitArray([m >= 0 for m in contact.space.macros]),
    )
