"""Picture of the interfaces of patch tests in 3D."""

from __future__ import annotations

import numpy as np
from patch3d import BELOW, Solve
from report_pictures import BLUE, INK, ORANGE, STYLE, Matplotlib, Save

__all__ = ["InterfacePicture"]

_SHADES = ("#FFFFFF", "#E8F1E4", "#F6ECD9", "#E3ECF6", "#F3E3EA")


def InterfacePicture(cases, file):
    """Slave faces, master faces and segments of each case, seen along the normal."""
    mpl = Matplotlib()
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(2.5 * len(cases), 2.9), layout="constrained")
        axes = figure.subplots(1, len(cases), squeeze=False)[0]
        for ax, case in zip(axes, cases, strict=True):
            _Interface(mpl.collections.PolyCollection, ax, case)
        handles = [mpl.lines.Line2D([], [], color=c) for c in (ORANGE, BLUE)]
        labels = ["slave faces", "master faces (the segments are shaded)"]
        figure.legend(handles, labels, loc="outside lower center", ncols=2)
        Save(figure, file)


def _Interface(Polygons, ax, case):
    _, contact, _ = Solve(case)
    plane, segments = case.axes[:, :2], contact.Segments()
    corners = segments.slave_points @ plane
    parts = [corners[a:b] for a, b in zip(segments.first[:-1], segments.first[1:], strict=True)]
    shades = [_SHADES[k % len(_SHADES)] for k in range(len(parts))]
    ax.add_collection(Polygons(parts, facecolors=shades, edgecolors=INK, linewidths=0.3))
    for name, colour in (("master", BLUE), ("slave", ORANGE)):
        faces = _Faces(contact.mesh, name, plane)
        ax.add_collection(Polygons(faces, facecolors="none", edgecolors=colour, linewidths=1.1))
    ax.autoscale_view()
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_title(f"{case.element} on {BELOW[case.element]}, {len(parts)} segments")


def _Faces(mesh, name, plane):
    """The corners of the faces of a boundary in the plane."""
    return [
        np.array([mesh.vertices[v.nr].point for v in el.vertices]) @ plane
        for el in mesh.Boundaries(name).Elements()
    ]
