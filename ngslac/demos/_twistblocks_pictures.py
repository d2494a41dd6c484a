"""Pictures of the twisting blocks: deformed states, tractions at the contact, the torque."""

from __future__ import annotations

import numpy as np
from ngsolve import BND, CF, ET, BitArray, IntegrationRule, x, y, z
from ngsolve.webgui import Draw

from ngslac.output.vtkfile import WriteVTK

from ._pictures import INK, STYLE, Matplotlib, Save
from ._twistblocks_figures import MEAN_DISTANCE
from ._twistblocks_model import WIDTH

__all__ = ["OverviewPicture", "Write"]

_BODIES = {"lower": "#C9D6E2", "upper": "#E9B872"}
_STATUS = (("open", "#D9D9D9"), ("stick", "#0072B2"), ("slip", "#E69F00"))
_PARTS = 4  # of an element edge


def Write(results, directory):
    """Write ``twistblocks.png``, ``.html`` and ``.vtu``, and ``twistblocks_contact.vtu``."""
    directory.mkdir(parents=True, exist_ok=True)
    if not results.states:
        return
    model = results.model
    OverviewPicture(results, directory / "twistblocks.png")
    side = {"camera": {"transformations": [{"type": "rotateX", "angle": -70}]}}
    Draw(
        model.contact.pressure,
        model.mesh.Boundaries("slave"),
        deformation=model.displacement,
        objects=[model.contact.Segments()],
        settings=side,
        show=False,
    ).GenerateHTML(filename=str(directory / "twistblocks.html"))
    moved = {"displacement": model.displacement}
    WriteVTK(directory / "twistblocks", model.mesh, moved, subdivision=1)
    slave = BitArray([m >= 0 for m in model.contact.space.macros])
    names = ("pressure", "traction", "slip", "status")
    WriteVTK(
        directory / "twistblocks_contact",
        model.mesh,
        moved | {name: getattr(model.contact, name) for name in names},
        vb=BND,
        drawelems=slave,
    )


def OverviewPicture(results, file):
    """Three deformed states, the tractions in two of them, and the torque over the angle."""
    mpl = Matplotlib()
    states = results.states
    shown = [states[min(1, len(states) - 1)], states[(len(states) + 2) // 2 - 1], states[-1]]
    with mpl.rc_context(STYLE):
        figure = mpl.figure.Figure(figsize=(9.4, 6.2))
        grid = figure.add_gridspec(2, 3, height_ratios=(1.35, 1), wspace=0.65, hspace=0.15)
        solution = results.model.solution.vec
        last = solution.CreateVector(copy=True)
        for k, state in enumerate(shown):
            solution.data = state.vector
            ax = figure.add_subplot(grid[0, k], projection="3d", computed_zorder=False)
            _Blocks(ax, results.model)
            ax.set_title(f"{state.angle:g} degrees")
        solution.data = last
        early = next((s for s in states if s.angle > 0), states[-1])
        for k, state in enumerate((early, states[-1])):
            _Tractions(mpl, figure, figure.add_subplot(grid[1, k]), state, results)
        _Torque(figure.add_subplot(grid[1, 2]), results)
        Save(figure, file)


def _Surface(model, boundary):
    """Deformed points (faces, _PARTS + 1, _PARTS + 1, 3) of quadrilateral boundary faces."""
    steps = np.linspace(0, 1, _PARTS + 1)
    grid = [(s, t) for s in steps for t in steps]
    rule = IntegrationRule(points=grid, weights=[0.0] * len(grid))
    region = model.mesh.Boundaries(boundary)
    points = model.mesh.MapToAllElements({ET.QUAD: rule}, region)
    place = (CF((x, y, z)) + model.displacement)(points)
    return place.reshape(-1, _PARTS + 1, _PARTS + 1, 3)


def _Blocks(ax, model):
    """Both blocks with the edges of their elements, lit from one side."""
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    light = np.array([0.35, -0.75, 0.55])
    for order, (body, names) in enumerate(
        (("lower", "master|side_lower"), ("upper", "side|top")), start=1
    ):
        surface = _Surface(model, names)
        corners = [
            surface[:, :-1, :-1],
            surface[:, 1:, :-1],
            surface[:, 1:, 1:],
            surface[:, :-1, 1:],
        ]
        tiles = np.stack(corners, axis=-2).reshape(-1, 4, 3)
        normal = np.cross(tiles[:, 2] - tiles[:, 0], tiles[:, 3] - tiles[:, 1])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        shade = 0.62 + 0.38 * np.abs(normal @ light)
        colour = np.array([int(_BODIES[body][i : i + 2], 16) / 255 for i in (1, 3, 5)])
        facing = _Facing(tiles, normal, surface)
        ax.add_collection3d(
            Poly3DCollection(
                tiles[facing],
                facecolors=(shade[:, None] * colour)[facing],
                edgecolors=(shade[:, None] * colour)[facing],
                linewidths=0.2,
                zorder=2 * order,
            )
        )
        lines = _Edges(surface, facing.reshape(len(surface), _PARTS, _PARTS))
        ax.add_collection3d(
            Line3DCollection(lines, colors=INK, linewidths=0.35, zorder=2 * order + 1)
        )
    ax.set_xlim(-0.8, 0.8)
    ax.set_ylim(-0.8, 0.8)
    ax.set_zlim(-0.5, 1.35)
    ax.set_box_aspect((1.6, 1.6, 1.85), zoom=1.15)
    ax.view_init(elev=22, azim=-60)
    ax.set_axis_off()


def _Edges(surface, facing):
    """The edges of the elements, in pieces, where a tile beside them is seen."""
    pieces = []
    for line, seen in (
        (surface[:, 0], facing[:, 0]),
        (surface[:, -1], facing[:, -1]),
        (surface[:, :, 0], facing[:, :, 0]),
        (surface[:, :, -1], facing[:, :, -1]),
    ):
        both = np.stack([line[:, :-1], line[:, 1:]], axis=2)
        pieces.append(both[seen])
    return np.concatenate(pieces)


def _Facing(tiles, normal, surface):
    """Which tiles look to the viewer (elevation 22, azimuth -60 degrees)."""
    a, e = np.radians(-60), np.radians(22)
    eye = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    middle = surface.reshape(-1, 3)
    middle = 0.5 * (middle.min(axis=0) + middle.max(axis=0))
    centre = tiles.mean(axis=1)
    outward = normal * np.sign(np.sum(normal * (centre - middle), axis=1))[:, None]
    return outward @ eye > 0


def _Tractions(mpl, figure, ax, state, results):
    """Pressures on the deformed macro-elements, tractions as arrows, seen from above."""
    table, model = state.table, results.model
    solution = model.solution.vec
    last = solution.CreateVector(copy=True)
    solution.data = state.vector
    surface = _Surface(model, "slave")
    solution.data = last
    rims = [
        np.concatenate([s[0, :], s[1:, -1], s[-1, -2::-1], s[-2:0:-1, 0]])[:, :2] for s in surface
    ]
    # In the order of the boundary elements, as the macro-elements of the faces.
    macros = [model.contact.space.macros[el.nr] for el in model.mesh.Boundaries("slave").Elements()]
    faces = mpl.collections.PolyCollection(rims, cmap="viridis", edgecolors="white", linewidths=0.5)
    faces.set_array(table["pressure"][macros])
    faces.set_clim(0, table["pressure"].max())
    ax.add_collection(faces)
    arrows = table["traction"][:, :2]
    bound = max(results.problem.friction * table["pressure"].max(), 1e-30)
    ax.quiver(
        *table["x"][:, :2].T,
        *arrows.T,
        angles="xy",
        scale_units="xy",
        scale=bound / (0.8 * WIDTH / results.problem.n),
        color="#D55E00",
        width=0.008,
    )
    ax.set_xlim(-0.85, 0.85)
    ax.set_ylim(-0.85, 0.85)
    ax.set_aspect("equal")
    ax.set_xlabel("x [mm]")
    ax.set_ylabel("y [mm]")
    slips = int((table["status"] == 2).sum())
    ax.set_title(f"{state.angle:g} degrees, {slips} of {len(macros)} slip")
    figure.colorbar(faces, ax=ax, shrink=0.8, label="pressure [MPa]")


def _Torque(ax, results):
    f = results.figures
    ax.plot([0.0, *f["angle"]], [0.0, *f["torque"]], "o-", color="#0072B2", ms=3, label="computed")
    punch = [f["friction"] * force * WIDTH * MEAN_DISTANCE for force in f["force"]]
    ax.plot(f["angle"], punch, "--", color=INK, lw=0.9, label=r"0.3826 $\mu F a$")
    ax.set_xlabel("angle [degrees]")
    ax.set_ylabel("torque [N mm]")
    ax.set_ylim(bottom=0)
    ax.legend(loc="lower right")
