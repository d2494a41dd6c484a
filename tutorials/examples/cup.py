"""Deep drawing of a round cup in 3D: punch on a path, die at rest, holder moved by a force.

A quarter of the blank, solid elements of second order, one through the thickness; large plastic
strains with hardening, friction on all tools. The travel of the holder is an unknown of the
problem. Start it with::

    python tutorials/examples/cup.py --out results

All forces balance, and plastic flow keeps the volume. The blank is isotropic, so that its rim stays
a circle: what the radius of the rim varies by is an error of the mesh.
"""

import numpy as np
from command import Columns, Count, Main, NotNegative, Picture, Positive
from netgen.meshing import Mesh as NetgenMesh
from netgen.occ import Circle, Glue, OCCGeometry, Rectangle
from ngsolve import *
from plasticity import J2Plasticity, LogStrain

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes.boxes import Cells
from ngslac.tools import Polygon, Revolved

BLANK, THICKNESS = 0.85, 0.04  # radius
PUNCH, DIE, CORNER = 0.5, 0.56, 0.12  # where the punch ends and the die begins; radius of corners
SPLIT = (PUNCH + DIE) / 2 + CORNER / 2  # between the parts of the top that punch and holder touch
MATERIAL = {"young": 70e3, "poisson": 0.3, "yield_stress": 200.0, "hardening": 500.0, "order": 2}
FAR = 3.0  # where tools end


def Round(left, right, low, high):
    """A body of revolution with round corners, between two radii and two heights."""
    r = CORNER
    corners = [(left + r, low + r), (right - r, low + r), (right - r, high - r)]
    profile = Polygon([*corners, (left + r, high - r)]).Grown(r)
    return Revolved(profile, (0, 0, 0), (0, 0, 1))


def Plan(h):
    """The quarter of the blank from above, as plane mesh, mostly of quadrilaterals."""
    quarter = Rectangle(BLANK, BLANK).Face()
    inner = Circle((0, 0), SPLIT).Face() * quarter
    blank = Glue([inner, Circle((0, 0), BLANK).Face() * quarter - inner])
    return Mesh(OCCGeometry(blank, dim=2).GenerateMesh(maxh=h, quad_dominated=True))


def Sheet(plan):
    """One layer of hexahedra and prisms on a plane mesh.

    The lower side is "die", the upper one "punch" and "holder"; "x" and "y" are the planes of
    symmetry, where the other coordinate is 0, and "rim".
    """
    flat = np.array([vertex.point for vertex in plan.vertices])
    points = np.vstack([np.column_stack([flat, np.full(len(flat), z)]) for z in (0, THICKNESS)])
    cells, faces = [], []

    def Up(numbers):
        return tuple(number + len(flat) for number in numbers)

    for element in plan.Elements():
        below = Counterclockwise(flat, [v.nr for v in element.vertices])
        inside = np.linalg.norm(flat[list(below)].mean(axis=0)) < SPLIT
        cells.append(below + Up(below))
        faces += [("die", below[::-1]), ("punch" if inside else "holder", Up(below))]
    for element in plan.Elements(BND):
        ends = [v.nr for v in element.vertices]
        name = Side(flat[ends])
        if name:
            start, end = ends if Left(*flat[ends], flat.mean(axis=0)) else ends[::-1]
            faces.append((name, (start, end, end + len(flat), start + len(flat))))
    return Cells(points, cells, faces)


def Left(start, end, point):
    """Is a point on the left of the line between two others?"""
    (a, b), (c, d) = end - start, point - start
    return a * d > b * c


def Counterclockwise(flat, numbers):
    first, second, *_, last = numbers
    return tuple(numbers if Left(*flat[[first, second]], flat[last]) else numbers[::-1])


def Side(ends):
    """Name of an outer edge with these ends; the circle inside of the blank has none."""
    if np.allclose(np.linalg.norm(ends, axis=1), SPLIT):
        return None
    at_zero = np.all(np.abs(ends) < 1e-9, axis=0)
    return "x" if at_zero[0] else "y" if at_zero[1] else "rim"


def Blank(h):
    ngmesh = NetgenMesh(dim=3)
    Sheet(Plan(h)).AddTo(ngmesh, "blank")
    ngmesh.Compress()
    return Mesh(ngmesh)


class Press:
    """The blank and its tools.

    Parameters
    ----------
    h : float
        Edge length.
    friction, force : float
        On all tools; of the holder, on all of the blank.
    """

    def __init__(self, h, friction, force):
        self.mesh, self.steps = Blank(h), []
        self.hold, self.down = Parameter(0.0), Parameter(0.0)
        V = X = VectorH1(self.mesh, order=2, dirichletx="x", dirichlety="y")
        for side in ("die", "punch", "holder"):
            X = X * LACSpace(V, slave=side)
        X = X * NumberSpace(self.mesh)
        u, *lams, travel = X.TrialFunction()
        self.material = J2Plasticity(self.mesh, **MATERIAL)
        a = BilinearForm(X)
        energy = self.material.Energy(LogStrain(Grad(u)))
        a += Variation(energy * dx(intrules=self.material.rules))
        tools = self.Tools(travel, self.hold * force / 4)
        self.contacts = {
            name: LACContact(u, lam, obstacle=tools[name], finite=True, friction=friction)
            for lam, name in zip(lams, ("die", "punch", "holder"), strict=True)
        }
        self.gf = GridFunction(X)
        self.displacement = self.gf.components[0]
        self.solver = ContactSolver(a, self.gf, [*self.contacts.values()])

    def Tools(self, travel, force):
        above = THICKNESS + FAR
        push = {"travel": (None, None, travel), "force": (0, 0, -force)}
        return {
            "die": Round(DIE, FAR, -FAR, 0),
            "punch": Round(-PUNCH, PUNCH, THICKNESS, above).Moved(shift=(0, 0, -self.down)),
            "holder": Round(DIE, FAR, THICKNESS, above).Driven(**push),
        }

    def Draw(self, depth, steps, printing):
        """Hold the blank, then move the punch down; forces and the radius of the rim are noted."""

        def Note(step):
            self.material.Commit(LogStrain(Grad(self.displacement)))
            forces = {name: 4 * float(c.Force()[2]) for name, c in self.contacts.items()}
            rim = self.Rim()
            row = {"depth": step.time, "draw_in": BLANK - float(rim.mean())}
            row |= {"rim_spread": float(np.ptp(rim)), "iterations": step.iterations}
            self.steps.append(row | forces | {"cuts": step.cuts})

        LoadStepper(self.solver, self.hold).Integrate(steps=1, printing=printing)
        stepper = LoadStepper(self.solver, self.down)
        stepper.Integrate(depth, steps=steps, printing=printing, callback=Note)

    def Vertices(self):
        """Places (n, 3) of the deformed vertices, those below before those above."""
        values = self.displacement.vec.FV().NumPy().reshape(3, -1)[:, : self.mesh.nv]
        return np.array([vertex.point for vertex in self.mesh.vertices]) + values.T

    def Rim(self):
        """Radii of the vertices of the deformed rim."""
        rim = self.mesh.Boundaries("rim").Elements()
        numbers = sorted({v.nr for element in rim for v in element.vertices})
        return np.linalg.norm(self.Vertices()[numbers, :2], axis=1)

    def Thickness(self):
        """Radius before, and thickness over that before, of the vertices of the plan."""
        below, above = np.split(self.Vertices(), 2)
        radius = [np.hypot(*vertex.point[:2]) for vertex in self.mesh.vertices][: len(below)]
        return np.array(radius), np.linalg.norm(above - below, axis=1) / THICKNESS

    def Volume(self):
        """Over that before."""
        F = Id(3) + Grad(self.displacement)
        return Integrate(Det(F), self.mesh, order=6) / Integrate(1, self.mesh)


def DrawBlank(axes, press):
    """The deformed upper side, coloured by the thickness."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    points, (_, thickness) = press.Vertices(), press.Thickness()
    faces = [
        [v.nr for v in element.vertices]
        for name in ("punch", "holder")
        for element in press.mesh.Boundaries(name).Elements()
    ]
    values = [thickness[np.array(face) - len(thickness)].mean() for face in faces]
    drawn = Poly3DCollection([points[face] for face in faces], edgecolor="k", lw=0.3)
    drawn.set_array(np.array(values))
    axes.add_collection3d(drawn)
    axes.figure.colorbar(drawn, ax=axes, label="thickness over that before", shrink=0.6)
    lowest = points[:, 2].min()
    axes.set(xlim=(0, BLANK), ylim=(0, BLANK), zlim=(lowest, THICKNESS))
    axes.set_box_aspect((BLANK, BLANK, THICKNESS - lowest))
    axes.view_init(35, 215)


def Write(press, folder):
    rows = Columns(press.steps)
    with Picture(folder, "cup_blank", subplot_kw={"projection": "3d"}) as axes:
        DrawBlank(axes, press)
    with Picture(folder, "cup", 1, 2, size=(9, 3.5)) as (left, right):
        left.plot(*press.Thickness(), ".")
        left.set(xlabel="radius before", ylabel="thickness over that before")
        for name in press.contacts:
            right.plot(rows["depth"], rows[name], ".-", label=name)
        right.set(xlabel="depth", ylabel="force on the blank, upwards")
        right.legend()
    press.contacts["die"].WriteVTU(folder / "cup_die", displacement=press.displacement)


def Run(h=0.1, depth=0.25, steps=38, friction=0.1, force=3.0, out=None, quiet=True):
    """Draw the cup; returns forces, draw-in and thickness at the end."""
    press = Press(h, friction, force)
    press.Draw(depth, steps, not quiet)
    last, (_, thickness) = press.steps[-1], press.Thickness()
    figures = {
        "balance": abs(sum(last[name] for name in press.contacts)) / last["die"],
        "holder_force": -last["holder"],
        "punch_force": -last["punch"],
        "draw_in": last["draw_in"],
        "rim_spread": last["rim_spread"],
        "volume": float(press.Volume()),
        "thickness": [float(thickness.min()), float(thickness.max())],
        "steps": len(press.steps),
        "iterations": [row["iterations"] for row in press.steps],
    }
    assert figures["balance"] < 1e-6, figures
    assert abs(figures["holder_force"] / force - 1) < 1e-6, figures
    assert abs(figures["volume"] - 1) < 1e-3, figures
    if out:
        Write(press, out)
    if not quiet:
        print("draw-in {draw_in:.4f}, force of the punch {punch_force:.4f}".format(**figures))
        print("thickness from {:.3f} to {:.3f} of that before".format(*figures["thickness"]))
    return figures


main = Main(
    Run,
    __doc__,
    h=(Positive, "edge length"),
    depth=(Positive, "way of the punch"),
    steps=(Count, "steps"),
    friction=(NotNegative, "coefficient"),
    force=(Positive, "of the holder"),
)

if __name__ == "__main__":
    main()
