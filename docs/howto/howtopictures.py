"""The pictures of the how-to pages, each from the names that the script of its page leaves."""

import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from ngsolve import *

sys.path.insert(0, str(Path(__file__).parents[2] / "tutorials" / "examples"))

from pictures import Smooth

from ngslac import ContactSolver, LACContact, LoadStepper
from ngslac.materials import AxisymmetricGrad, Stress

__all__ = ["Show"]

COLOURS, BAR = "turbo", "#c2185b"


def Mises(stress):
    """The equivalent stress; in 2D of the components in the plane."""
    deviator = stress - Trace(stress) / stress.dims[0] * Id(stress.dims[0])
    return sqrt(1.5 * InnerProduct(deviator, deviator))


def Strain(u):
    """Size of Green's strain, for materials of finite strains."""
    F = Id(2) + Grad(u)
    strain = 0.5 * (F.trans * F - Id(2))
    return Norm(strain)


def Outline(axes, u, factor):
    """The deformed boundary."""
    mesh, lines = u.space.mesh, np.linspace(0, 1, 5)
    places = mesh.MapToAllElements(IntegrationRule([(s,) for s in lines], [1] * 5), BND)
    points = CF((x, y))(places) + factor * np.asarray(u(places))
    axes.add_collection(LineCollection(points.reshape(-1, 5, 2), colors="k", lw=0.8))


def Bars(axes, contact, u, factor, size):
    """The pressure as bars that stand on the deformed slave."""
    mesh = u.space.mesh
    macros, table = np.array(contact.space.macros), contact.Table()
    places = mesh.MapToAllElements(IntegrationRule([(0.0,), (0.5,), (1.0,)], [1] * 3), BND)
    points = (CF((x, y))(places) + factor * np.asarray(u(places))).reshape(-1, 3, 2)
    shown = macros >= 0
    points, macro = points[shown], macros[shown]
    heights = table["pressure"][macro] * size
    normals = table["normal"][macro]
    for share in np.linspace(0, 1, 9):
        feet = (1 - share) * points[:, 0] + share * points[:, 2]
        tops = feet + heights[:, None] * normals
        axes.add_collection(LineCollection(np.stack([feet, tops], axis=1), colors=BAR, lw=1.2))
    axes.plot([], [], color=BAR, label="pressure")


def Body(axes, u, field, label, factor=1.0, contacts=(), size=0.2, top=None):
    """A field on deformed bodies in 2D; `size` is the longest bar over the width."""
    points, faces, (moved, values) = Smooth(u.space.mesh, (u, field))
    place, values = points + factor * moved, values.ravel()
    top = np.quantile(values, 0.998) if top is None else top
    levels = np.linspace(min(0, values.min()), top, 21)
    filled = axes.tricontourf(*place.T, faces, values, levels=levels, cmap=COLOURS, extend="max")
    axes.figure.colorbar(filled, ax=axes, label=label, shrink=0.8, format="%.3g")
    Outline(axes, u, factor)
    peak = max((contact.Table()["pressure"].max() for contact in contacts), default=1)
    for contact in contacts:
        Bars(axes, contact, u, factor, size * np.ptp(place[:, 0]) / peak)
    axes.set_aspect("equal")
    axes.axis("off")
    axes.autoscale_view()


def Solid(path, u, field, label, factor, camera):
    """A field on deformed bodies in 3D, seen from the direction `camera`."""
    import pyvista  # needs a while to import

    with tempfile.TemporaryDirectory() as folder:
        file = f"{folder}/bodies"
        VTKOutput(u.space.mesh, [u, field], ["u", "field"], file, order=2).Do()
        grid = pyvista.read(f"{file}.vtu")
    warped = grid.warp_by_vector("u", factor=factor)
    surface = warped.extract_surface(nonlinear_subdivision=2, algorithm="dataset_surface")
    plotter = pyvista.Plotter(off_screen=True, window_size=(1400, 900))
    bar = {"title": label, "title_font_size": 28, "label_font_size": 24, "fmt": "%.3g"}
    bar |= {
        "color": "black",
        "vertical": True,
        "height": 0.6,
        "position_x": 0.84,
        "position_y": 0.2,
    }
    values = surface["field"]
    plotter.add_mesh(
        surface,
        scalars="field",
        cmap=COLOURS,
        clim=(0, np.quantile(values, 0.995)),
        scalar_bar_args=bar,
        ambient=0.35,
        smooth_shading=True,
        split_sharp_edges=True,
    )
    edges = surface.extract_feature_edges(30, boundary_edges=False)
    plotter.add_mesh(edges, color="black", line_width=2)
    plotter.background_color = "white"
    plotter.view_vector(camera, (0, 0, 1))
    plotter.camera.zoom(1.1)
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(path)
    plotter.close()


def Displacement(names):
    gf = names["gf"]
    return gf.components[0]


def ShowPlane(field, label, **options):
    """A picture of the bodies of a page in 2D; `field` of names and displacement."""

    def Draw(names, path):
        u = Displacement(names)
        contacts = names.get("contacts") or [names["contact"]]
        figure = Figure(figsize=(7, 4.5), layout="constrained")
        axes = figure.subplots()
        Body(axes, u, field(names, u), label, contacts=contacts, **options)
        figure.savefig(path, dpi=110)

    return Draw


def ShowSolid(field, label, factor, camera=(2, -3, 1.5)):
    """A picture of the bodies of a page in 3D."""

    def Draw(names, path):
        u = Displacement(names)
        Solid(path, u, field(names, u), label, factor, camera)

    return Draw


def Elastic(young, nu=0.3):
    """Equivalent stress of a page's displacement; `young` is a number or a name."""
    return lambda names, u: Mises(Stress(Sym(Grad(u)), names.get(young, young), nu))


def Turning(names, u):
    """Equivalent stress of bodies of revolution."""
    return Mises(Stress(Sym(AxisymmetricGrad(u)), names["young"], 0.3))


def Curves(draw, size=(6, 3.6)):
    """A picture of curves, drawn by `draw(axes, names)`."""

    def Draw(names, path):
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots()
        draw(axes, names)
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
        figure.savefig(path, dpi=110)

    return Draw


def Convergence(axes, names):
    errors = 100 * np.abs(names["errors"])
    sizes = 0.2 / 2.0 ** np.arange(len(errors))
    axes.loglog(sizes, errors, "o-", color=BAR, label="computed")
    axes.loglog(sizes, errors[1] * (sizes / sizes[1]) ** 2, "k--", lw=1, label="order 2")
    axes.set(xlabel="size of the elements", ylabel="error of the force [%]")
    axes.legend(frameon=False)


def Sides(axes, names):
    styles = {"fine slave": "-", "coarse slave": "-", "both fine": "k-"}
    for name, style in styles.items():
        contact = names["results"][name][3]
        contact.Plot("pressure", axes=axes, ls=style[-1], label=name, lw=1.3)
    axes.set(xlim=(0, 0.35), xlabel="x", ylabel="pressure")
    axes.legend(frameon=False)


def Bounce(names, path):
    """Height over time, and the disc at the end."""
    figure = Figure(figsize=(8, 3.8), layout="constrained")
    curve, body = figure.subplots(1, 2, width_ratios=[1.5, 1])
    curve.plot(*np.transpose(names["heights"]), color=BAR)
    curve.axhline(1, color="k", lw=0.8, ls="--", label="resting disc")
    curve.set(xlabel="time", ylabel="height of the middle")
    curve.legend(frameon=False)
    curve.spines[["top", "right"]].set_visible(False)
    u = Displacement(names)
    Body(body, u, Strain(u), "strain")
    body.axhline(0, color="k", lw=2)
    body.set_ylim(-0.1)
    figure.savefig(path, dpi=110)


def Snap(names, path):
    """The arm below the ledge, and the push over the way."""
    figure = Figure(figsize=(7, 5), layout="constrained")
    body, curve = figure.subplots(2, 1, height_ratios=[1, 1.3])
    u, (ways, pushes) = Displacement(names), np.transpose(names["pushes"])
    names["gf"].vec[:], shown = 0, 1.2
    names["way"].Set(0)
    options = {"obstacle": names["ledge"], "finite": True, "friction": 0.2}
    contact = LACContact(names["u"], names["lam"], **options)
    solver = ContactSolver(names["a"], names["gf"], contact)
    LoadStepper(solver, names["way"]).Integrate(shown, steps=6, printing=False)
    Body(body, u, Strain(u), "strain")
    spot = 22.6 - shown, 1.2
    turn = np.linspace(0, 2 * pi, 200)
    body.fill(spot[0] + np.cos(turn), spot[1] + np.sin(turn), color="0.75", ec="k")
    curve.plot(ways, pushes, ".-", color=BAR)
    curve.axhline(0, color="k", lw=0.8)
    curve.set(xlabel="way of the ledge [mm]", ylabel="push [N/mm]")
    curve.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=110)


def Temperature(names, path):
    figure = Figure(figsize=(6, 4.5), layout="constrained")
    T = names["gf"].components[0]
    still = GridFunction(VectorH1(T.space.mesh))
    Body(figure.subplots(), still, T, "temperature [°C]")
    figure.savefig(path, dpi=110)


def Sliding(names, path):
    figure = Figure(figsize=(8, 2.8), layout="constrained")
    axes, u = figure.subplots(), Displacement(names)
    Body(axes, u, names["gf"].components[1], "temperature [K]", factor=1)
    axes.set_ylim(-7, 7)
    figure.savefig(path, dpi=110)


def Seal(names, path):
    figure = Figure(figsize=(7, 5), layout="constrained")
    axes, u = figure.subplots(), Displacement(names)
    axes.fill([-3, 3, 3, 1.6, 1.6, -1.6, -1.6, -3], [-0.5, -0.5, 2.1, 2.1, 0, 0, 2.1, 2.1], "0.8")
    axes.fill([-3, 3, 3, -3], [2.4, 2.4, 3, 3], "0.8")
    Body(axes, u, Strain(u), "strain", contacts=names["contacts"])
    figure.savefig(path, dpi=110)


def Punch(names, path):
    figure = Figure(figsize=(7, 4.2), layout="constrained")
    axes, u = figure.subplots(), Displacement(names)
    turn = np.linspace(0, 2 * pi, 300)
    Body(axes, u, Strain(u), "strain", contacts=[names["contact"]], size=0.12)
    axes.plot(np.cos(turn), 0.9 + np.sin(turn), "k", lw=1.2)
    axes.set_ylim(-2.1, 1.2)
    figure.savefig(path, dpi=110)


STRESS = "equivalent stress [MPa]"
PICTURES = {
    "axisymmetric": ShowPlane(Turning, STRESS, factor=1, size=0.15),
    "bolt_preload": ShowSolid(Elastic("E"), STRESS, 150, (-2, -3, 1.2)),
    "choosing_slave": Curves(Sides),
    "convergence_study": Curves(Convergence),
    "contact_without_names": ShowPlane(Elastic("young"), STRESS, factor=1, size=0.1),
    "drop_and_bounce": Bounce,
    "from_calculix": ShowSolid(Elastic(210e3), STRESS, 500),
    "from_contactboundary": ShowPlane(Elastic(210e3), STRESS, factor=100),
    "heat_across_interface": Temperature,
    "heat_through_contact": Sliding,
    "laws": ShowPlane(Elastic("young"), STRESS, factor=1, size=0.1),
    "many_bodies": ShowSolid(Elastic(210e3), STRESS, 3000),
    "on_many_cores": ShowSolid(Elastic(1.0), "equivalent stress", 5),
    "own_law": ShowPlane(Elastic(2e3), STRESS, factor=1, size=0.15),
    "preload_force": ShowSolid(Elastic("E"), STRESS, 150, (-2, -3, 1.2)),
    "press_fit": ShowPlane(Elastic("E"), STRESS, factor=0, size=0.15),
    "reaction_forces": ShowPlane(Elastic(210e3), STRESS, factor=100),
    "rigid_tool": Punch,
    "rubber": ShowPlane(lambda names, u: Strain(u), "strain", factor=1, size=0.12),
    "seal": Seal,
    "snap_fit": Snap,
    "stack": ShowPlane(Elastic(1e3), "equivalent stress", factor=20),
    "when_it_fails": ShowPlane(Elastic(210e3), STRESS, factor=200),
}


def Show(page, names, path):
    """Write the picture of a page."""
    path.parent.mkdir(exist_ok=True)
    PICTURES[page](names, path)
