"""Hertz' problem with large deformation: a rubber cylinder is flattened between rigid plates.

Plane strain, neo-Hookean (1 MPa, nu = 0.49), radius 1 mm, without friction; a quarter is computed.
The plates come together until the middle is nearer to each by 30 % of the radius. Small loads are
those of Hertz (K. L. Johnson, Contact Mechanics, 1985, section 5.6). Start it with::

    python tutorials/examples/hertz_large.py --out results

The force at the end is 0.6282 N/mm on fine meshes, of which Hertz' theory has 0.4940.
"""

import numpy as np
from command import Columns, Count, Main, NotNegative, Picture, Positive
from ngsolve import *
from scipy.optimize import brentq

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import NeoHooke
from ngslac.meshes import geometry

RADIUS = 1.0  # mm
YOUNG = 1.0  # MPa
REACH = np.radians(70)  # of the arc that may touch
LENGTH, THICKNESS = 1.25, 0.15  # of the plate


def CylinderMesh(h=0.05, order=3):
    """A quarter of the cylinder (x >= 0, 0 <= y <= 1) on the plate, with the edge length h.

    Boundaries: "slave" (the arc that may touch), "free", "sym" (x = 0), "middle" (y = 1), "master"
    (the top of the plate), "back". No node of the slave is above one of the master but at x = 0.
    """
    arc, point = geometry.Divisions(REACH * RADIUS, h), geometry.Touching(RADIUS)
    nodes = RADIUS * np.sin(np.linspace(0, REACH, arc + 1))
    count = geometry.NonMatchingDivisions(nodes, 0.0, LENGTH, 1.3 * h)
    sides = [
        geometry.Arc(point, 0, REACH, "slave", arc),
        geometry.Arc(point, REACH, np.pi / 2, "free"),
        geometry.Line(point(np.pi / 2), (0, RADIUS), "middle"),
        geometry.Line((0, RADIUS), point(0), "sym"),
    ]
    corners = [(0, -THICKNESS), (LENGTH, -THICKNESS), (LENGTH, 0), (0, 0)]
    plate = geometry.Polygon(corners, ("back", "back", "master", "back"), "plate", master=count)
    bodies = [geometry.Body(sides, "cylinder"), plate]
    return geometry.GenerateMesh(bodies, order=order, maxh=0.25, grading=0.25)


def Approach(force, nu, young=YOUNG):
    """Hertz' approach (mm) of the middle to a plate under a force (N/mm) of the whole cylinder."""
    compliance = force * (1 - nu**2) / (np.pi * young)
    halfwidth = np.sqrt(4 * compliance * RADIUS)
    return compliance * (2 * np.log(4 * RADIUS / halfwidth) - 1)


def HertzForce(approach, nu, young=YOUNG):
    """Hertz' force for an approach."""
    return brentq(lambda p: Approach(p, nu, young) - approach, 1e-15, young * RADIUS, xtol=1e-15)


class Cylinder:
    """Cylinder, plate and solver; `rows` has an entry for each step."""

    def __init__(self, h=0.05, order=2, nu=0.49, friction=0.0, depth=0.3):
        if not depth < 0.7:
            raise ValueError(f"depth = {depth} must be less than 0.7 radii")
        self.mesh, self.nu, self.depth, self.rows = CylinderMesh(h, order), nu, depth, []
        held = {"dirichletx": "sym|back|master", "dirichlety": "middle|back|master"}
        V = VectorH1(self.mesh, order=order, **held)
        X = V * LACSpace(V, slave="slave")
        u, lam = X.TrialFunction()
        a, gf = BilinearForm(X), GridFunction(X)
        a += Variation(NeoHooke(Id(2) + Grad(u), YOUNG, nu).Compile() * dx("cylinder"))
        self.displacement = gf.components[0]
        self.contact = LACContact(u, lam, master="master", friction=friction or None, finite=True)
        load = Parameter(0.0)
        free = X.FreeDofs() & ~X.GetDofs(self.mesh.Materials("plate"))
        solver = ContactSolver(a, gf, self.contact, freedofs=free)
        self.stepper = LoadStepper(solver, load, prescribe={"middle": CF((0, -depth * load))})

    def Press(self, steps, printing=False):
        """Bring the middle down by the depth in equal steps."""
        self.stepper.Integrate(1.0, steps=steps, callback=self._Record, printing=printing)

    def _Record(self, step):
        table, (sideways, up) = self.contact.Table(), self.contact.Force()
        stored = NeoHooke(Id(2) + Grad(self.displacement), YOUNG, self.nu)
        approach = self.depth * step.time  # of the middle to a plate, in mm
        self.rows.append(
            {
                "approach": approach,
                "force": 2 * up,  # N/mm, of the whole cylinder
                "hertz": HertzForce(approach, self.nu),
                "sideways": abs(sideways),
                # Of the half that a plate sees, N mm/mm.
                "energy": 2 * Integrate(stored * dx("cylinder"), self.mesh),
                "halfwidth": _HalfWidth(table["x"][:, 0], table["status"] > 0),
                "iterations": step.iterations,
                "cuts": step.cuts,
            }
        )

    def Figures(self):
        """Each number of the steps as a list."""
        return Columns(self.rows)


def _HalfWidth(x, closed):
    """Where the contact ends: between the last closed and the first open macro-element."""
    last = x[closed].max(initial=0.0)
    beyond = x[~closed & (x > last)]
    return float(0.5 * (last + beyond.min())) if closed.any() and len(beyond) else float(last)


def Write(cylinder, folder):
    """The forces beside those of Hertz and the pressures as a picture; the arc for ParaView."""
    figures = cylinder.Figures()
    with Picture(folder, "hertz_large", columns=2, size=(10, 4)) as (left, right):
        for name, style in (("force", "-"), ("hertz", "k--")):
            left.plot([0, *figures["approach"]], [0, *figures[name]], style, label=name)
        left.set(xlabel="approach of the middle to a plate [mm]", ylabel="force [N/mm]")
        left.legend()
        cylinder.contact.Plot("pressure", deformation=cylinder.displacement, axes=right)
    cylinder.contact.WriteVTU(folder / "hertz_large", displacement=cylinder.displacement)


def Run(steps=30, out=None, quiet=True, **options):
    """Flatten the cylinder; the options are those of `Cylinder`. Returns the numbers."""
    cylinder = Cylinder(**options)
    cylinder.Press(steps, printing=not quiet)
    figures = cylinder.Figures() | {"steps": steps, "converged_steps": len(cylinder.rows)}
    if out:
        Write(cylinder, out)
    if not quiet:
        print(f"force {figures['force'][-1]:.5f} N/mm, by Hertz {figures['hertz'][-1]:.5f}")
    return figures


main = Main(
    Run,
    __doc__,
    Cylinder,
    h=(Positive, "edge length on the arc, in mm"),
    order=((2, 3), "order of the displacement"),
    nu=(NotNegative, "Poisson's ratio"),
    friction=(NotNegative, "coefficient of friction"),
    depth=(Positive, "approach of the middle to a plate, in mm"),
    steps=(Count, "load steps"),
)


if __name__ == "__main__":
    main()
