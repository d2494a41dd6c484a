"""Contact without friction in 3D: Hertz' spheres and cylinder, benchmark 1 as a slice."""

from __future__ import annotations

import numpy as np
import test_validation_hertz_slice3d as slice3d
from elasticity3d import Solid
from hertz3d_pictures import PressurePicture
from hertzmeans import Means as HertzMeans
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, Integrate, Sym, VectorH1, dx
from problems_hertz3d import Problem, Run
from problems_sphere import RADIUS, SPHERES, PressBlock, PressSpheres
from report_bounds import Element, Means, Meshes, Neglected, Spread, Tolerance
from report_case import Case, Outcome, Row
from report_pictures import INK, Figure, Profile
from sector3d import SliceMesh

from ngslac import ContactSolver, LACContact, LACSpace
from ngslac.meshes import HertzMesh
from ngslac.reference import HertzPoint

STRESS = (2868.9, 2929.4)  # code_aster with LAC, modellings k to n
SIZES = {"P2": (3, 2), "P1bubble": (8, 6)}  # faces in a row, fine and coarse
AXISYMMETRIC = 1.125  # force over Hertz' for two half spheres


def Sphere(quick):
    sizes = (4,) if quick else (6, 8)
    exact = Problem().Hertz()
    rows, coarser, radius = [], None, exact.contact_radius
    for n in sizes:
        results = Run(h=radius / n)
        figures, text = results.figures, f"{n} faces along the radius"
        peak, wide = figures["p0_ratio"] * exact.peak, figures["contact_radius_ratio"] * radius
        meshes = Meshes(peak, coarser[1], n / coarser[0]) if coarser else None
        error, coarser = figures["profile_error"], (n, peak)
        rows += [
            Row(f"{text}: peak pressure", peak, exact.peak, meshes, "MPa"),
            Row(f"{text}: contact radius", wide, radius, Element(1 / n, kind="relative"), "mm"),
            Row(f"{text}: error of the pressure in L2", error, 0, Means(MeansError(results))),
            Row(f"{text}: force over load", figures["force_ratio"], 1, Tolerance()),
        ]
    caption = "Pressures of the macro-elements over the distance from the middle, and from below."
    return Outcome(rows, lambda file: PressurePicture(results, file), caption)


def MeansError(results):
    """Of Hertz' pressure against its means over the macro-elements, relative in L2 of these."""
    exact, area = results.problem.Hertz(), results.faces.area
    shape = HertzMeans(results.faces, exact) / exact.peak
    # Integral of the square over that of the pressure, for the peak 1.
    ratio = 8 / (3 * np.pi) if hasattr(exact, "halfwidth") else 3 / 4
    return np.sqrt(ratio * (area @ shape) / (area @ shape**2) - 1)


def Cylinder(quick):
    h = 0.8 if quick else 0.4
    results, coarser = (Run(shape="cylinder", h=k * h) for k in (1, 2))
    exact, figures = results.problem.Hertz(), results.figures
    peaks = [each.figures["p0_ratio"] * exact.peak for each in (results, coarser)]
    rows = [
        Row("cylinder of prisms: p(0)", peaks[0], exact.peak, Meshes(*peaks, 2), "MPa"),
        Row(
            "cylinder of prisms: error of the pressure in L2",
            figures["profile_error"],
            0,
            Means(MeansError(results)),
        ),
    ]
    block, force, table = Slice(slice3d.SIZE)
    hertz, load = slice3d.HERTZ, slice3d.FORCE * slice3d.THICKNESS
    half_planes = Neglected((hertz.halfwidth / 50) ** 2, "(a/R)^2")
    meshes, at = Meshes(block, Slice(2 * slice3d.SIZE)[0], 2), "benchmark 1"
    rows += [
        Row(f"{at}: displacement of the block", block, slice3d.DISPLACEMENT, meshes, "mm"),
        Row(f"{at}: p(0)", table["pressure"][0], hertz.peak, half_planes, "MPa"),
        Row(f"{at}: contact force", force[2], load, Tolerance(kind="relative"), "N"),
    ]
    ends = 50 * np.sin(slice3d.SIZE / 50 * np.arange(len(table["pressure"]) + 1))

    def Draw(ax):
        Profile(ax, ends[:-1], ends[1:], table["pressure"], table["status"])
        x = np.linspace(0, 8, 400)
        ax.plot(x, slice3d.HERTZ.Pressure(x), color=INK, lw=0.9, label="Hertz")
        ax.set_xlim(0, 8)
        ax.set_xlabel("x [mm]")
        ax.set_ylabel("pressure [MPa]")
        ax.legend()

    return Outcome(rows, Figure(Draw, size=(6, 3.4)), "The pressure of benchmark 1 in the slice.")


def Slice(size):
    """Benchmark 1 between two planes of symmetry: displacement, force, macro-elements along x."""
    mesh = SliceMesh(HertzMesh(size, order=1, zone=8.0, grading=0.5), slice3d.THICKNESS)
    flags = {"dirichletx": "sym|bottom", "dirichlety": "front|back", "dirichletz": "bottom"}
    V = VectorH1(mesh, order=2, **flags)
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    strain = Sym(Grad(u))
    solids = {"cylinder": Solid(210e3, 0.3), "block": Solid(70e3, 0.3)}
    stress = mesh.MaterialCF({name: solid.Stress(strain) for name, solid in solids.items()})
    weight = slice3d.FORCE * slice3d.THICKNESS / Integrate(1, mesh.Materials("cylinder"))
    a, gf = BilinearForm(X), GridFunction(X)
    a += InnerProduct(stress, Sym(Grad(v))) * dx + weight * v[2] * dx("cylinder")
    contact = LACContact(u, lam, master="master")
    ContactSolver(a, gf, contact).Solve(printing=False)
    table = contact.Table()
    along = np.argsort(table["x"][:, 0])
    table = {name: values[along] for name, values in table.items()}
    return gf.components[0](mesh(1e-9, 0.5, -1e-9))[2], contact.Force(), table


def Spheres(quick):
    n = 3 if quick else 4
    wide, coarser = (PressSpheres(4.0, m, updates=3) for m in (n, n - 1))
    exact = HertzPoint.FromApproach(approach=4.0, **SPHERES)
    stress = -wide.pair.stress(wide.pair.mesh(1e-6, 1e-6, 1e-3))[8]
    middle = sum(STRESS) / 2
    figures = wide.figures
    text = "two half spheres, contact radius a fifth of theirs"
    forces = [solution.hertz.force / exact.force for solution in (wide, coarser)]
    half_spaces = Neglected((wide.hertz.contact_radius / RADIUS) ** 2, "(a/R)^2")
    radius = figures["contact_radius_ratio"]
    rows = [
        Row(
            f"{text}: stress at the first point of contact",
            stress,
            middle,
            Spread(middle, STRESS, f"{STRESS[0]} to {STRESS[1]}"),
            "MPa",
        ),
        Row(
            f"{text}: force over that of half-spaces",
            forces[0],
            AXISYMMETRIC,
            Meshes(*forces, n / (n - 1)),
        ),
        Row(
            f"{text}: peak pressure over Hertz' for this force",
            figures["p0_ratio"],
            1,
            half_spaces,
        ),
        Row(f"{text}: contact radius over Hertz' for this force", radius, 1, half_spaces),
    ]
    for space, sizes in {"P2": (3, 2)}.items() if quick else SIZES.items():
        last, before = (PressBlock(m, space) for m in sizes)
        peaks = [solution.figures["p0_ratio"] for solution in (last, before)]
        text = f"rigid sphere on hexahedra of order {space[1]}: peak pressure over Hertz'"
        rows.append(Row(text, peaks[0], 1, Meshes(*peaks, sizes[0] / sizes[1])))

    def Draw(*axes):
        for ax, solution in zip(axes, (wide, last), strict=True):
            low, high = solution.faces.extent.T
            ax.plot(0.5 * (low + high), solution.pressure, "o", ms=3, label="macro-elements")
            r = np.linspace(0, high.max(), 300)
            ax.plot(r, solution.hertz.Pressure(r), color=INK, lw=0.9, label="Hertz for this force")
            ax.set_xlabel("distance from the middle [mm]")
            ax.legend(loc="lower left")
        axes[0].set_ylabel("pressure [MPa]")
        axes[0].set_title("two half spheres")
        axes[1].set_title("rigid sphere on hexahedra")

    caption = "Pressures over the distance from the middle of the contact."
    return Outcome(rows, Figure(Draw, columns=2), caption)


CASES = [
    Case(
        "hertz3d",
        "Hertz' point contact",
        "A steel sphere of radius 50 mm on an aluminium block, a quarter of both, in tetrahedra "
        "of order 2. The contact radius (2.5 mm) is a twentieth of the sphere's. The edge of "
        "the contact crosses macro-elements, which are open or closed as a whole.",
        "Johnson, Contact Mechanics (1985), sections 3.4 and 4.2, as `HertzPoint`.",
        "python tutorials/examples/hertz3d.py --h 0.3125 --out results",
        Sphere,
    ),
    Case(
        "hertz3d-line",
        "Hertz' line contact as a slice in 3D",
        "A cylinder of prisms between two planes of symmetry has the line contact of 2D; and so "
        "has NAFEMS benchmark 1 in small strain, here with slave faces of 1 mm.",
        "`HertzLine`; the displacement: a program of others with the same multipliers in 2D.",
        "pytest tests/validation/test_validation_hertz_slice3d.py "
        "tests/validation/test_validation_hertz3d.py -k cylinder",
        Cylinder,
    ),
    Case(
        "spheres",
        "Two half spheres, and a rigid sphere on hexahedra",
        "Two half spheres come closer by 4 mm: the contact radius is a fifth of theirs, so that "
        "the bodies are stiffer than the half-spaces of Hertz, and their normals turn. The "
        "surfaces are paired in the deformed configuration. Second, a block of hexahedra as slave "
        "under a rigid sphere.",
        "Code_aster with Local Average Contact, test SSNV104, modellings k to n (2868.9 to 2929.4 "
        "MPa); an axisymmetric computation of third order without multipliers for the force; "
        "`HertzPoint`.",
        "pytest tests/validation/test_validation_hertz3d.py -k 'spheres or hexahedra'",
        Spheres,
    ),
]
