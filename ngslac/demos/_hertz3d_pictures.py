"""Pictures, scenes and VTU files of the Hertz problems in 3D."""

from __future__ import annotations

import numpy as np
from ngsolve import BND, BitArray, BoundaryFromVolumeCF, InnerProduct, sqrt
from ngsolve.webgui import Draw

from ngslac.output.vtkfile import WriteVTK

from ._hertz3d_figures import Radius
from ._pictures import INK, STYLE, Matplotlib, Save

__all__ = ["PressurePicture", "SectionPicture", "Write"]

_COLOURS = "viridis"


def Write(results, directory):
    """Write pictures, scenes for the browser, and VTU files of the final state.

    ``hertz3d_pressure.png``, ``hertz3d_stress.png``; ``hertz3d_pressure.html`` and
    ``hertz3d_stress.html``; ``hertz3d.vtu`` (volume), ``hertz3d_contact.vtu`` (slave faces) and
    ``hertz3d_segments.vtu`` (pairing).
    """
    directory.mkdir(parents=True, exist_ok=True)
    PressurePicture(results, directory / "hertz3d_pressure.png")
    SectionPicture(results, directory / "hertz3d_stress.png")
    _Scenes(results, directory)
    _VTU(results, directory)


# ---------------------------------------------------------------- pictures


def PressurePicture(results, file):
    """The pressures over the distance from the middle, and on the macro-elements from below."""
    mpl = Matplotlib()
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(9.4, 4.1), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
        _Profile(left, results)
        faces = _Faces(mpl, right, results)
        bar = figure.colorbar(faces, ax=right, shrink=0.85, label="pressure [MPa]")
        bar.outline.set_linewidth(0.5)
        Save(figure, file)


def _Profile(ax, results):
    problem, macros, pressure = results.problem, results.macros, results.states[-1].pressure
    hertz = problem.Hertz(results.states[-1].time)
    low, high = macros.extent.T
    closed = results.states[-1].status > 0
    exact = hertz.peak * macros.Shape(Radius(hertz))
    for mine, colour, label in ((closed, "#0072B2", "in contact"), (~closed, "#8C8C8C", "open")):
        middle = 0.5 * (low + high)[mine]
        ax.hlines(pressure[mine], low[mine], high[mine], color=colour, lw=0.8, alpha=0.5)
        ax.plot(middle, pressure[mine], "o", color=colour, ms=3, label=f"macro-element, {label}")
    ax.plot(0.5 * (low + high), exact, "x", color="#D55E00", ms=3, mew=0.7, label="mean of Hertz'")
    r = np.linspace(0, high.max(), 1001)
    ax.plot(r, hertz.Pressure(r), color=INK, lw=0.9, label="Hertz' pressure")
    sphere = problem.shape == "sphere"
    ax.set_xlabel("distance from the middle [mm]" if sphere else "distance x [mm]")
    ax.set_ylabel("pressure [MPa]")
    ax.set_xlim(0, high.max())
    ax.set_ylim(bottom=-0.03 * hertz.peak)
    ax.legend(loc="lower left")
    ax.set_title("multipliers, constant on each macro-element")


def _Faces(mpl, ax, results):
    problem, macros = results.problem, results.macros
    radius = Radius(problem.Hertz(results.states[-1].time))
    pressure = results.states[-1].pressure[macros.owner]
    faces = mpl.collections.PolyCollection(macros.corners, cmap=_COLOURS, edgecolors="face")
    faces.set_array(pressure)
    ax.add_collection(faces)
    lines = mpl.collections.LineCollection(macros.Outlines(), colors="white", linewidths=0.5)
    ax.add_collection(lines)
    angle = np.linspace(0, 2 * np.pi, 361)
    if problem.shape == "sphere":
        ax.plot(radius * np.cos(angle), radius * np.sin(angle), color="#D55E00", lw=1.0)
    else:
        for x in (-radius, radius):
            ax.axvline(x, color="#D55E00", lw=1.0)
    corners = macros.corners.reshape(-1, 2)
    (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
    ax.set_xlim(x0, x1)
    ax.set_ylim(y1, y0)  # the y axis points down when looking up
    ax.set_aspect("equal")
    ax.set_xlabel("x [mm]")
    ax.set_ylabel("y [mm]")
    width = "contact radius" if problem.shape == "sphere" else "half width"
    ax.set_title(f"seen from below, and Hertz' {width}", pad=10)
    return faces


def SectionPicture(results, file):
    """Stresses in the plane of symmetry, and along the axis."""
    mpl = Matplotlib()
    hertz = results.problem.Hertz(results.states[-1].time)
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(9.4, 4.1), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
        areas = _Section(mpl, left, results, hertz)
        ticks = mpl.ticker.MaxNLocator(8, steps=[1, 2, 5, 10])
        bar = figure.colorbar(
            areas, ax=left, shrink=0.85, ticks=ticks, label=r"$\sigma_{zz}$ [MPa]"
        )
        bar.outline.set_linewidth(0.5)
        _Axis(right, results, hertz)
        Save(figure, file)


def _Evaluate(results, points):
    """Stresses (..., 3, 3) in the frame of the problem at points (..., 3) of it."""
    problem = results.problem
    x, y, z = (points @ problem.frame).reshape(-1, 3).T
    values = results.stress(results.mesh(x, y, z)).reshape(*points.shape[:-1], 3, 3)
    return problem.frame @ values @ problem.frame.T


def _Depth(results):
    """The y coordinate of the section."""
    return 0.5 * results.problem.Thickness() if results.problem.shape == "cylinder" else 0.0


def _Section(mpl, ax, results, hertz):
    """Contours of the stress sigma_zz in both bodies."""
    size = 1.8 * Radius(hertz)
    x, depth = np.meshgrid(size * np.linspace(0, 1, 61), size * np.linspace(1e-3, 1, 61))
    levels = np.linspace(-1.05 * hertz.peak, 0.05 * hertz.peak, 23)
    for up in (1, -1):
        sag = 50.0 - np.sqrt(50.0**2 - x**2) if up > 0 else 0.0
        points = np.stack([x, np.full_like(x, _Depth(results)), sag + up * depth], axis=-1)
        values = _Evaluate(results, points)[..., 2, 2].clip(levels[0], levels[-1])
        areas = ax.contourf(x, points[..., 2], values, levels=levels, cmap=_COLOURS)
        ax.contour(x, points[..., 2], values, levels=levels, colors=INK, linewidths=0.2)
        ax.plot(x[0], points[0, :, 2], color=INK, lw=1.0)
    ax.set_aspect("equal")
    ax.set_xlabel("x [mm]")
    ax.set_ylabel("z [mm]")
    ax.set_title(r"stress $\sigma_{zz}$")
    areas.set_clim(levels[0], levels[-1])
    return areas


def _Axis(ax, results, hertz):
    """The stress along the axis in both bodies against Hertz' solution."""
    depth = 3 * Radius(hertz) * np.linspace(1e-3, 1, 121)
    for body, up, colour in ((1, 1, "#0072B2"), (2, -1, "#D55E00")):
        points = np.zeros((len(depth), 3))
        points[:, 1], points[:, 2] = _Depth(results), up * depth
        values = _Evaluate(results, points)
        name = results.problem.shape if body == 1 else "block"
        for i, line, label in ((2, "-", "zz"), (0, "--", "xx")):
            text = rf"$\sigma_{{{label}}}$, {name}"
            ax.plot(depth, values[:, i, i], line, color=colour, lw=1.1, label=text)
        for exact in _Exact(hertz, depth, body):
            ax.plot(depth[::6], exact[::6], ".", color=INK, ms=3)
    ax.plot([], [], ".", color=INK, ms=3, label="Hertz")
    ax.set_xlabel("depth below the surface [mm]")
    ax.set_ylabel("stress [MPa]")
    ax.set_xlim(0, depth[-1])
    ax.legend(loc="lower right")
    ax.set_title("along the axis")


def _Exact(hertz, depth, body):
    """Hertz' stresses (xx, zz) on the axis; of a cylinder by Johnson, eq. 4.46."""
    if hasattr(hertz, "AxisStress"):
        return hertz.AxisStress(depth, body=body)
    z = depth / hertz.halfwidth
    root = np.sqrt(1 + z**2)
    return -hertz.peak * ((1 + 2 * z**2) / root - 2 * z), -hertz.peak / root


# ---------------------------------------------------------------- scenes and VTU files


def _Mises(stress):
    trace = (stress[0, 0] + stress[1, 1] + stress[2, 2]) / 3
    return sqrt(1.5 * (InnerProduct(stress, stress) - 3 * trace * trace))


def _Scenes(results, directory):
    """Scenes for the browser, as self-contained as NGSolve makes them."""
    mesh, contact = results.mesh, results.contact
    # From below: the slave faces look down.
    below = {"camera": {"transformations": [{"type": "rotateX", "angle": 110}]}}
    Draw(
        contact.pressure,
        mesh.Boundaries("slave"),
        deformation=results.displacement,
        objects=[contact.Segments()],
        settings=below,
        show=False,
    ).GenerateHTML(filename=str(directory / "hertz3d_pressure.html"))
    side = {"camera": {"transformations": [{"type": "rotateX", "angle": -75}]}}
    Draw(
        BoundaryFromVolumeCF(_Mises(results.stress)),
        mesh,
        deformation=results.displacement,
        order=2,
        draw_vol=False,
        settings=side,
        show=False,
    ).GenerateHTML(filename=str(directory / "hertz3d_stress.html"))


def _VTU(results, directory):
    mesh, contact, stress = results.mesh, results.contact, results.stress
    WriteVTK(
        directory / "hertz3d",
        mesh,
        {"displacement": results.displacement, "stress": stress, "mises": _Mises(stress)},
        subdivision=max(0, results.problem.order - 1),
    )
    names = ("pressure", "gap", "status", "traction", "slip", "normal")
    macros = results.contact.space.macros
    slave = BitArray([m >= 0 for m in macros])
    WriteVTK(
        directory / "hertz3d_contact",
        mesh,
        {"displacement": results.displacement} | {name: getattr(contact, name) for name in names},
        vb=BND,
        drawelems=slave,
    )
    contact.Segments().WriteVTU(directory / "hertz3d_segments.vtu")
