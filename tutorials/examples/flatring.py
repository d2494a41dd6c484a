"""Self-contact: a rubber ring is pressed flat between two rigid plates until its inside touches.

Plane strain, neo-Hookean, finite sliding with friction; lengths in radii of the ring, stresses in
shear moduli. The inside of the ring is slave and master at once. The right half is computed; by
symmetry the inside then touches like a quarter of the ring on a rigid plane through the middle
(--quarter), which is contact of two bodies: the forces of both agree until the inside touches, at
a travel of about 1.68. Start it with::

    python tutorials/examples/flatring.py --out results

At the default size the plates reach the travel 1.71 without a step that is cut, and the forces on
both plates agree to rounding.
"""

import numpy as np
from command import Columns, Count, Main, NotNegative, Picture, Positive
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry, Y
from ngsolve import *

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper

PLATE = 0.2  # thickness
LAME = 3.0  # first Lame parameter over the shear modulus


def RingMesh(h, thickness, quarter):
    """The right half of the ring (or a quarter) between plates, not matching them."""
    lower = 0 if quarter else -2
    ring = Circle((0, 0), 1).Face() - Circle((0, 0), 1 - thickness).Face()
    ring = ring * MoveTo(0, lower).Rectangle(2, 2 - lower).Face()
    for edge in ring.edges:
        x, y, _ = edge.center
        ends = [np.hypot(p.x, p.y) for p in (edge.start, edge.end)]
        edge.name = "outer" if min(ends) > 1 - thickness / 2 else "inner"
        if abs(x) < 1e-9:
            edge.name = "axis"
        elif quarter and abs(y) < 1e-9:
            edge.name = "middle"
    plates = [MoveTo(0, 1).Rectangle(2.2, PLATE).Face()]
    # The normals of the inside meet in the middle: the floor goes on beyond it.
    plates.append(MoveTo(-0.3, (0 if quarter else -1) - PLATE).Rectangle(2.5, PLATE).Face())
    for face, name, side in zip(plates, ("top", "bottom"), (Y, -Y), strict=True):
        face.faces.name = name
        face.edges.name = "fixed"
        face.edges.Min(side).name = "floor" if quarter and name == "bottom" else "plate"
    ring.faces.name = "ring"
    geometry = OCCGeometry(Compound([ring, *plates]), dim=2)
    return Mesh(geometry.GenerateMesh(maxh=h)).Curve(2)


class Ring:
    """Ring, plates and solver; `rows` has an entry for each step."""

    def __init__(self, h=0.12, thickness=0.15, friction=0.2, quarter=False):
        if not thickness < 1:
            raise ValueError(f"thickness = {thickness} must be less than the radius 1")
        self.mesh, self.quarter, self.rows = RingMesh(h, thickness, quarter), quarter, []
        symmetry = {"dirichletx": "axis"} | ({"dirichlety": "middle"} if quarter else {})
        held = "fixed|plate|floor" if quarter else "fixed|plate"
        V = VectorH1(self.mesh, order=2, dirichlet=held, **symmetry)
        space = V * LACSpace(V, slave="inner") * LACSpace(V, slave="outer")
        u, lam_inside, lam_outside = space.TrialFunction()
        F = Id(2) + Grad(u)
        energy = (InnerProduct(F, F) - 2) / 2 - log(Det(F)) + LAME / 2 * log(Det(F)) ** 2
        a = BilinearForm(space)
        a += Variation(energy.Compile() * dx)
        gf = GridFunction(space)
        self.displacement = gf.components[0]
        self.inside = LACContact(
            u,
            lam_inside,
            master="floor" if quarter else "inner",
            # By symmetry the two sides of the inside do not rub, but they would rub on a plane.
            friction=None if quarter else friction,
            penetration=thickness / 2,
            finite=True,
        )
        self.outside = LACContact(u, lam_outside, master="plate", friction=friction, finite=True)
        self.travel = Parameter(0)
        self.top = np.fromiter(V.GetDofs(self.mesh.Materials("top")), dtype=bool)
        solver = ContactSolver(a, gf, [self.inside, self.outside])
        self.stepper = LoadStepper(solver, self.travel, prescribe=self._MovePlate)

    def _MovePlate(self, gf):
        """All of the upper plate goes down, not its rim alone, which would crush its elements."""
        plate = GridFunction(self.displacement.space)
        way = self.travel.Get() / (2 if self.quarter else 1)
        plate.Set(CF((0, -way)), definedon=self.mesh.Materials("top"))
        gf.components[0].vec.FV().NumPy()[self.top] = plate.vec.FV().NumPy()[self.top]

    def Press(self, travel, steps, printing=False):
        """Bring the plates together by `travel` in equal steps."""
        self.stepper.Integrate(travel, steps=steps, printing=printing, callback=self._Record)

    def _Record(self, step):
        forces = self.outside.form.Resultants()["force"][:, 1]
        heights = self.outside.Table()["x"][:, 1]
        above = heights > (-np.inf if self.quarter else heights.mean())
        inner = self.inside.form.Resultants()["force"][:, 1]
        self.rows.append(
            {
                "travel": step.time,
                "force": float(-forces[above].sum()),  # per length, in G R
                "force_below": float(forces[~above].sum()),
                "force_inside": float(np.abs(inner).sum()),
                "closed_inside": int(np.sum(self.inside.Table()["status"] > 0)),
                "iterations": step.iterations,
                "cuts": step.cuts,
            }
        )

    def Figures(self):
        """Each number of the steps as a list."""
        return Columns(self.rows)


def Write(ring, folder):
    """Curves of the forces and the pressures as a picture; the surfaces for ParaView."""
    figures = ring.Figures()
    with Picture(folder, "flatring", columns=2, size=(10, 4)) as (left, right):
        for name in ("force", "force_inside"):
            left.plot(figures["travel"], figures[name], "o-", ms=3, label=name.replace("_", " "))
        left.set(xlabel="travel / R", ylabel="force / (G R)")
        left.set_yscale("symlog", linthresh=1e-3)
        left.legend()
        ring.outside.Plot("pressure", deformation=ring.displacement, axes=right)
    ring.inside.WriteVTU(folder / "flatring_inside", displacement=ring.displacement)
    ring.outside.WriteVTU(folder / "flatring_outside", displacement=ring.displacement)


def Run(travel=1.71, steps=38, out=None, quiet=True, **options):
    """Press the ring flat; the options are those of `Ring`. Returns the numbers of the steps."""
    ring = Ring(**options)
    ring.Press(travel, steps, printing=not quiet)
    figures = ring.Figures() | {"steps": steps, "converged_steps": len(ring.rows)}
    if out:
        Write(ring, out)
    if not quiet:
        force, inside = figures["force"][-1], figures["force_inside"][-1]
        print(f"force on the plate {force:.5g} G R, on the inside {inside:.5g} G R")
    return figures


main = Main(
    Run,
    __doc__,
    Ring,
    h=(Positive, "edge length"),
    thickness=(Positive, "of the ring"),
    friction=(NotNegative, "coefficient"),
    travel=(Positive, "by which the plates approach each other"),
    steps=(Count, "load steps"),
    quarter=(bool, "a rigid plane in the middle"),
)


if __name__ == "__main__":
    main()
