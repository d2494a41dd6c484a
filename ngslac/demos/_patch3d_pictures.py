"""Pictures of the patch tests in 3D: interfaces with segments, errors, a scene; a VTU file."""

from __future__ import annotations

import numpy as np
from ngsolve.webgui import Draw

from ngslac.output.vtkfile import WriteVTK

from ._patch3d_case import BELOW
from ._pictures import INK, STYLE, Matplotlib, Save

__all__ = ["Write"]

# Colours that colour-blind readers tell apart (Okabe and Ito).
_SLAVE, _MASTER = "#D55E00", "#0072B2"
_SHADES = ("#FFFFFF", "#E8F1E4", "#F6ECD9", "#E3ECF6", "#F3E3EA")


def Write(solutions, rows, directory):
    """Write all pictures and the VTU file of the last solution.

    Parameters
    ----------
    solutions : list of Solution
        One for each panel of the picture of the interfaces.
    rows : list of dict
        The figures of all cases.
    directory : path
        Made if it does not exist. It gets patch3d_interfaces.png, patch3d_errors.png,
        patch3d.html (turn it in a browser) and patch3d.vtu.
    """
    directory.mkdir(parents=True, exist_ok=True)
    mpl = Matplotlib()
    with mpl.rc_context(STYLE):
        _Interfaces(mpl, solutions, directory / "patch3d_interfaces.png")
        _ErrorPicture(mpl, rows, directory / "patch3d_errors.png")
    last = solutions[-1]
    options = {"objects": [last.contact], "show": False, "clipping": False}
    scene = Draw(last.stress[2, 2], last.mesh, "stress_zz", **options)
    scene.GenerateHTML(str(directory / "patch3d.html"))
    shown = {f"stress_{c}{c}": last.stress[k, k] for k, c in enumerate("xyz")}
    WriteVTK(directory / "patch3d", last.mesh, {"displacement": last.displacement} | shown)


def _Interfaces(mpl, solutions, file):
    """Slave faces, master faces and segments of each solution, seen along the normal."""
    figure = mpl.figure.Figure(figsize=(2.5 * len(solutions), 2.9), layout="constrained")
    axes = figure.subplots(1, len(solutions), squeeze=False)[0]
    for ax, solution in zip(axes, solutions, strict=True):
        plane = solution.case.axes[:, :2]
        segments = solution.contact.Segments()
        corners = segments.slave_points @ plane
        parts = [corners[a:b] for a, b in zip(segments.first[:-1], segments.first[1:], strict=True)]
        shades = [_SHADES[k % len(_SHADES)] for k in range(len(parts))]
        Polygons = mpl.collections.PolyCollection
        ax.add_collection(Polygons(parts, facecolors=shades, edgecolors=INK, linewidths=0.3))
        for name, colour, width in (("master", _MASTER, 1.1), ("slave", _SLAVE, 1.1)):
            faces = _Faces(solution.mesh, name, plane)
            ax.add_collection(
                Polygons(faces, facecolors="none", edgecolors=colour, linewidths=width)
            )
        ax.autoscale_view()
        ax.set_aspect("equal")
        ax.set_axis_off()
        ax.set_title(
            f"{solution.case.element} on {BELOW[solution.case.element]}, {len(parts)} segments"
        )
    handles = [mpl.lines.Line2D([], [], color=c) for c in (_SLAVE, _MASTER)]
    labels = ["slave faces", "master faces (the segments are shaded)"]
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    Save(figure, file)


def _Faces(mesh, name, plane):
    """The corners of the faces of a boundary in the plane."""
    return [
        np.array([mesh.vertices[v.nr].point for v in el.vertices]) @ plane
        for el in mesh.Boundaries(name).Elements()
    ]


def _ErrorPicture(mpl, rows, file):
    """The errors of all cases on a logarithmic axis."""
    figure = mpl.figure.Figure(figsize=(5.2, 0.5 + 0.13 * len(rows)), layout="constrained")
    ax = figure.subplots()
    at = np.arange(len(rows))
    for key, marker, colour in (
        ("stress_error", "o", _MASTER),
        ("multiplier_error", "s", _SLAVE),
    ):
        errors = np.maximum([row[key] for row in rows], 1e-17)
        ax.plot(errors, at, marker, color=colour, ms=3.5, mew=0, label=key.replace("_error", ""))
    ax.axvline(1e-11, color=INK, lw=0.8, ls="--")
    ax.set_xscale("log")
    ax.set_yticks(at, [row["name"] for row in rows], fontsize=6)
    ax.set_ylim(len(rows), -1)
    ax.set_xlabel("largest error relative to the stress")
    ax.legend(loc="lower left")
    Save(figure, file)
