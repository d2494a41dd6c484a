"""Pictures of the examples: panels side by side in one file, and surfaces for ParaView."""

import numpy as np
from command import Speaks
from ngsolve import CF, VOL, IntegrationRule, x, y


def Show(folder, name, displacement, *panels, **contacts):
    """Write name.png, with a panel each of these functions of axes, and a VTU file of each contact.

    Without a folder nothing happens.
    """
    if not folder:
        return
    from matplotlib.figure import Figure

    folder.mkdir(parents=True, exist_ok=True)
    figure = Figure(figsize=(4.5 * len(panels), 3.6), layout="constrained")
    for axes, draw in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        draw(axes)
    if Speaks():
        figure.savefig(folder / f"{name}.png", dpi=150)
    for side, contact in contacts.items():
        contact.WriteVTU(folder / f"{name}_{side}", displacement=displacement)


def Curves(xlabel, ylabel, xscale="linear", yscale="linear", **curves):
    """A panel: of each curve its points, x and y, and its style; names are the legend."""

    def Draw(axes):
        for label, (*points, style) in curves.items():
            axes.plot(*points, style, ms=4, lw=1, label=label[0] + label[1:].replace("_", " "))
        axes.set(xlabel=xlabel, ylabel=ylabel, xscale=xscale, yscale=yscale)
        axes.legend(fontsize="small")

    return Draw


def Map(points, values, label, **options):
    """A panel: values at points of a plane."""

    def Draw(axes):
        drawn = axes.tricontourf(*np.transpose(points), values, 12)
        axes.figure.colorbar(drawn, ax=axes, label=label)
        axes.set(aspect="equal", **options)

    return Draw


def Smooth(mesh, functions, parts=3):
    """Points (n, 2), triangles (m, 3) and values of functions, each element of a mesh divided."""
    lattice = [(i / parts, j / parts) for i in range(parts + 1) for j in range(parts + 1 - i)]
    number = {(round(x * parts), round(y * parts)): k for k, (x, y) in enumerate(lattice)}
    upright = [[(i, j), (i + 1, j), (i, j + 1)] for i, j in number if i + j < parts]
    turned = [[(i + 1, j + 1), (i, j + 1), (i + 1, j)] for i, j in number if i + j < parts - 1]
    local = np.array([[number[corner] for corner in face] for face in upright + turned])
    places = mesh.MapToAllElements(IntegrationRule(lattice, [1] * len(lattice)), VOL)
    first = len(lattice) * np.arange(mesh.ne)
    faces = (first[:, None, None] + local).reshape(-1, 3)
    return CF((x, y))(places), faces, [np.asarray(f(places)) for f in functions]


def Bodies(displacement, field=None, label="", *, factor=1, window=None, mirrored=False):
    """A panel: deformed triangles, or a field on them, in a window (left, right, low, high)."""

    def Draw(axes):
        fields = (displacement,) if field is None else (displacement, field)
        parts = 1 if field is None else 3
        points, faces, (moved, *values) = Smooth(displacement.space.mesh, fields, parts)
        left, low = place = (points + factor * moved).T
        axes.set(aspect="equal", title=f"displacement x {factor}" if factor != 1 else None)
        if window:
            axes.set(xlim=window[:2], ylim=window[2:])
            ends = np.reshape(window, (2, 2))
            far = np.abs(place.T - ends.mean(axis=1)) > 0.75 * np.ptp(ends, axis=1)
            faces = faces[~far[faces].any(axis=(1, 2))]
        for sign in (-1, 1) if mirrored else (1,):
            if field is None:
                axes.triplot(sign * left, low, faces, lw=0.3, color="k")
                continue
            found = values[0].ravel()
            drawn = axes.tripcolor(sign * left, low, faces, found, shading="gouraud", cmap="turbo")
            drawn.set_clim(found[faces].min(), found[faces].max())
        if field is not None:
            axes.figure.colorbar(drawn, ax=axes, label=label, shrink=0.8)

    return Draw
