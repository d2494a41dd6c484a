"""Deep drawing of a round cup in 3D: punch on a path, die at rest, holder moved by a force.

A quarter of the blank, solid elements of second order, one through the thickness; large plastic
strains with hardening, friction on all tools. The travel of the holder is an unknown of the
problem. Start it with::

    python tutorials/examples/cup.py --out results

All forces balance, and plastic flow keeps the volume. The blank is isotropic, so that its rim stays
a circle: what the radius of the rim varies by is an error of the mesh.
"""

import numpy as np
from command import Main, NotNegative
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import Circle, Glue, OCCGeometry, Rectangle
from ngsolve import *
from pictures import Curves, Map, Show
from plasticity import J2Plasticity, LogStrain

from ngslac import *
from ngslac.meshes.boxes import Cells
from ngslac.tools import Polygon, Revolved

BLANK, THICKNESS = 0.85, 0.04  # radius
PUNCH, DIE, CORNER = 0.5, 0.56, 0.12  # where the punch ends and the die begins; radius of corners
SPLIT = (PUNCH + DIE) / 2 + CORNER / 2  # between the parts of the top that punch and holder touch
MATERIAL = {"young": 70e3, "poisson": 0.3, "yield_stress": 200.0, "hardening": 500.0, "order": 2}
FAR = 3.0  # where tools end
SIDES = "die", "punch", "holder"


def Round(left, right, low, high):
    """A body of revolution with round corners, between two radii and two heights."""
    left, right, low, high = left + CORNER, right - CORNER, low + CORNER, high - CORNER
    profile = Polygon([(left, low), (right, low), (right, high), (left, high)]).Grown(CORNER)
    return Revolved(profile, (0, 0, 0), (0, 0, 1))


def Blank(h):
    """One layer of hexahedra and prisms on a plane mesh of the quarter.

    The lower side is "die", the upper one "punch" and "holder"; "x" and "y" are the planes of
    symmetry, where the other coordinate is 0, and "rim".
    """
    quarter = Rectangle(BLANK, BLANK).Face()
    inner = Circle((0, 0), SPLIT).Face() * quarter
    blank = Glue([inner, Circle((0, 0), BLANK).Face() * quarter - inner])
    plan = Mesh(OCCGeometry(blank, dim=2).GenerateMesh(maxh=h, quad_dominated=True))
    flat = np.array([vertex.point for vertex in plan.vertices])
    points = np.vstack([np.column_stack([flat, np.full(len(flat), z)]) for z in (0, THICKNESS)])
    cells, faces, edges = [], [], set()
    for element in plan.Elements():
        below = tuple(v.nr for v in element.vertices)  # counter-clockwise
        above = tuple(number + len(flat) for number in below)
        inside = np.linalg.norm(flat[list(below)].mean(axis=0)) < SPLIT
        cells.append(below + above)
        faces += [("die", below[::-1]), ("punch" if inside else "holder", above)]
        edges |= set(zip(below, below[1:] + below[:1], strict=True))
    for start, end in sorted(edges):
        if (end, start) not in edges:
            at_zero = np.all(np.abs(flat[[start, end]]) < 1e-9, axis=0)
            name = "x" if at_zero[0] else "y" if at_zero[1] else "rim"
            faces.append((name, (start, end, end + len(flat), start + len(flat))))
    ngmesh = NetgenMesh(dim=3)
    Cells(points, cells, faces).AddTo(ngmesh, "blank")
    ngmesh.Compress()
    return Mesh(ngmesh)


def Run(h=0.1, depth=0.25, steps=38, friction: NotNegative = 0.1, force=3.0, out=None):
    """Hold the blank, then draw the cup: forces on all of the blank, draw-in and thickness.

    h : edge length
    depth : way of the punch
    steps : steps
    friction : coefficient
    force : of the holder
    """
    mesh = Blank(h)
    V = X = VectorH1(mesh, order=2, dirichletx="x", dirichlety="y")
    for side in SIDES:
        X = X * LACSpace(V, slave=side)
    X = X * NumberSpace(mesh)
    u, *lams, travel = X.TrialFunction()
    material, hold, down = J2Plasticity(mesh, **MATERIAL), Parameter(0.0), Parameter(0.0)
    a, gf, top = BilinearForm(X), GridFunction(X), THICKNESS + FAR
    a += Variation(material.Energy(LogStrain(Grad(u))) * dx(intrules=material.rules))
    push = {"travel": (None, None, travel), "force": (0, 0, -hold * force / 4)}
    tools = (
        Round(DIE, FAR, -FAR, 0),
        Round(-PUNCH, PUNCH, THICKNESS, top).Moved(shift=(0, 0, -down)),
        Round(DIE, FAR, THICKNESS, top).Driven(**push),
    )
    contacts = [
        LACContact(u, lam, obstacle=tool, finite=True, friction=friction)
        for lam, tool in zip(lams, tools, strict=True)
    ]
    solver, moved = ContactSolver(a, gf, contacts), gf.components[0]
    strain = LogStrain(Grad(moved))
    LoadStepper(solver, hold).Integrate(steps=1, printing=False)
    stepper = LoadStepper(solver, down)
    flags = {"printing": False, "callback": lambda _: material.Commit(strain)}
    stepper.Integrate(depth, steps=steps, **flags)

    table = stepper.Table()
    forces = dict(zip(SIDES, 4 * table["force"][..., 2].T, strict=True))  # on the blank, upwards
    last = {side: values[-1] for side, values in forces.items()}
    before = np.array([vertex.point for vertex in mesh.vertices])
    after = before + moved.vec.FV().NumPy().reshape(3, -1)[:, : mesh.nv].T
    thickness = np.linalg.norm(np.subtract(*np.split(after, 2)), axis=1) / THICKNESS
    rim = sorted({v.nr for el in mesh.Boundaries("rim").Elements() for v in el.vertices})
    radii = np.linalg.norm(after[rim, :2], axis=1)
    figures = {
        "balance": abs(sum(last.values())) / last["die"],
        "holder_force": -last["holder"],
        "punch_force": -last["punch"],
        "draw_in": BLANK - radii.mean(),
        "rim_spread": np.ptp(radii),
        "volume": Integrate(Det(Id(3) + Grad(moved)), mesh, order=6) / Integrate(1, mesh),
        "thickness": [thickness.min(), thickness.max()],
    }
    print("draw-in {draw_in:.4f}, force of the punch {punch_force:.4f}".format(**figures))
    print("volume over that before {volume:.5f}, thickness {thickness[0]:.3f}".format(**figures))
    assert figures["balance"] < 1e-6, figures
    assert abs(figures["holder_force"] / force - 1) < 1e-6, figures
    assert abs(figures["volume"] - 1) < 1e-3, figures

    plan = Map(after[: len(thickness), :2], thickness, "thickness over that before")
    radius = np.linalg.norm(before[: len(thickness)], axis=1)
    curves = {side: (table["load"], values, ".-") for side, values in forces.items()}
    Show(out, "cup", moved, plan, Curves("depth", "force on the blank, upwards", **curves),
         Curves("radius before", "thickness over that before", vertices=(radius, thickness, ".")),
         die=contacts[0])  # fmt: skip
    return figures


main = Main(Run)
