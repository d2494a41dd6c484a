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
from command import Main, NotNegative
from netgen.occ import Compound, MoveTo, OCCGeometry, WorkPlane, Y
from ngsolve import *
from pictures import Bodies, Curves, Show

from ngslac import *

PLATE, LAME = 0.2, 3.0  # thickness; first Lame parameter over the shear modulus


def RingMesh(h, thickness, quarter):
    """The right half of the ring (or a quarter) between plates, not matching them."""
    if not thickness < 1:
        raise ValueError(f"thickness = {thickness} must be less than the radius 1")
    start, along = ((1, 0), (0, 1)) if quarter else ((0, -1), (1, 0))
    plane, turn = WorkPlane().MoveTo(*start).Direction(*along), 90 if quarter else 180
    plane.Arc(1, turn, "outer").Rotate(90).Line(thickness, "axis").Rotate(90)
    plane.Arc(1 - thickness, -turn, "inner").Rotate(90)
    ring = plane.Line(thickness, "middle" if quarter else "axis").Face()
    plates = [MoveTo(0, 1).Rectangle(2.2, PLATE).Face()]
    # The normals of the inside meet in the middle: the floor goes on beyond it.
    plates.append(MoveTo(-0.3, (0 if quarter else -1) - PLATE).Rectangle(2.5, PLATE).Face())
    for face, name, side in zip(plates, ("top", "bottom"), (Y, -Y), strict=True):
        face.faces.name = name
        face.edges.name = "fixed"
        face.edges.Min(side).name = "floor" if quarter and name == "bottom" else "plate"
    ring.faces.name = "ring"
    return Mesh(OCCGeometry(Compound([ring, *plates]), dim=2).GenerateMesh(maxh=h)).Curve(2)


def Problem(h, thickness=0.15, friction=0.2, quarter=False):
    """The stepper of the travel, and the contacts inside and outside."""
    mesh = RingMesh(h, thickness, quarter)
    symmetry = {"dirichletx": "axis"} | ({"dirichlety": "middle"} if quarter else {})
    V = VectorH1(mesh, order=2, dirichlet=f"fixed|plate{'|floor' * quarter}", **symmetry)
    X = V * LACSpace(V, slave="inner") * LACSpace(V, slave="outer")
    u, inner, outer = X.TrialFunction()
    F = Id(2) + Grad(u)
    energy = (InnerProduct(F, F) - 2) / 2 - log(Det(F)) + LAME / 2 * log(Det(F)) ** 2
    a, gf, travel = BilinearForm(X), GridFunction(X), Parameter(0)
    a += Variation(energy.Compile() * dx)
    # By symmetry the two sides of the inside do not rub, but they would rub on a plane.
    options = {"friction": None, "master": "floor"} if quarter else {"friction": friction}
    options = {"master": "inner", "penetration": thickness / 2, "finite": True} | options
    inside = LACContact(u, inner, **options)
    outside = LACContact(u, outer, master="plate", friction=friction, finite=True)
    top, plate = mesh.Materials("top"), GridFunction(V)
    moved = np.fromiter(V.GetDofs(top), dtype=bool)

    def Move(gf):  # all of the upper plate, not its rim alone, which would crush its elements
        plate.Set(CF((0, -travel.Get() / (2 if quarter else 1))), definedon=top)
        gf.components[0].vec.FV().NumPy()[moved] = plate.vec.FV().NumPy()[moved]

    solver = ContactSolver(a, gf, [inside, outside])
    return LoadStepper(solver, travel, prescribe=Move), inside, outside


def Run(h=0.12, thickness=0.15, friction: NotNegative = 0.2, travel=1.71, steps=38, quarter=False,
        out=None):  # fmt: skip
    """Press the ring flat: forces per length, in G R.

    h : edge length
    thickness : of the ring
    friction : coefficient
    travel : by which the plates approach each other
    steps : load steps
    quarter : a rigid plane in the middle
    """
    stepper, inside, outside = Problem(h, thickness, friction, quarter)
    forces = {"force": [], "force_below": [], "force_inside": [], "closed_inside": []}

    def Note(step):
        up, heights = outside.form.Resultants()["force"][:, 1], outside.Table()["x"][:, 1]
        above = heights > (-np.inf if quarter else heights.mean())
        forces["force"].append(-up[above].sum())
        forces["force_below"].append(up[~above].sum())
        forces["force_inside"].append(np.abs(inside.form.Resultants()["force"][:, 1]).sum())
        forces["closed_inside"].append(int(np.sum(inside.Table()["status"] > 0)))

    stepper.Integrate(travel, steps=steps, printing=False, callback=Note)
    table, moved = stepper.Table(), stepper.solver.gf.components[0]
    force, within = forces["force"], forces["force_inside"][-1]
    print(f"force on the plate {force[-1]:.5g} G R, on the inside {within:.5g} G R")
    assert abs(table["load"][-1] - travel) < 1e-9
    assert quarter or np.allclose(force, forces["force_below"], rtol=1e-9)
    curves = {name: (table["load"], forces[name], ".-") for name in ("force", "force_inside")}
    Show(out, "flatring", moved, Bodies(moved),
         Curves("travel / R", "force / (G R)", yscale="log", **curves),
         inside=inside, outside=outside)  # fmt: skip
    columns = {name: table[name] for name in ("iterations", "cuts")}
    return forces | columns | {"travel": table["load"], "converged_steps": len(stepper.steps)}


main = Main(Run)
