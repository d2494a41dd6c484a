"""A cylinder is upset between dies, smooth or rough: large plastic strains in 3D.

An eighth of a billet of radius 10 mm and length 30 mm (E = 200 GPa, nu = 0.3, yield stress 700 MPa,
hardening 300 MPa). The die is a plane on a path. Start it with::

    python tutorials/examples/upsetting.py --out results

Between smooth dies the billet stays a cylinder, and its force follows from the law alone. Friction
needs a larger one, and the billet bulges. (Dies that come nearer by a third or more fold the side
over the rim; for that the mesh is too coarse there.)
"""

import math
from dataclasses import replace

import numpy as np
from command import Columns, Count, Main, NotNegative, Picture, Positive
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import *
from plasticity import J2Plasticity, LogStrain

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes import StructuredBox
from ngslac.tools import Plane

RADIUS, HALF = 10.0, 15.0  # of the billet, half of its length
YOUNG, POISSON, YIELD, HARDENING = 200e3, 0.3, 700.0, 300.0


def Round(points):
    """A square of side 1 becomes a quarter of a disc."""
    s, t, z = points.T
    x, y = s * np.sqrt(1 - t**2 / 2), t * np.sqrt(1 - s**2 / 2)
    return np.column_stack([RADIUS * x, RADIUS * y, HALF * z])


def Billet(n):
    """With n by n by n hexahedra; "top" and "side", and "x", "y" and "z", where these are 0."""
    names = {"left": "x", "front": "y", "bottom": "z", "right": "side", "back": "side"}
    grid = np.linspace(0, 1, n + 1)
    box = StructuredBox(grid, grid, grid, names=lambda side, centre: names.get(side, side))
    ngmesh = NetgenMesh(dim=3)
    replace(box, points=Round(box.points)).AddTo(ngmesh, "billet")
    ngmesh.Compress()
    return Mesh(ngmesh)


def SmoothForce(depth, area):
    """Of a billet that stays a cylinder, of this cross section before.

    Kirchhoff's stress E (e - a) = Y + H a with the logarithmic strain e and its plastic part a is
    the force on the cross section of before, times the stretch.
    """
    stretch = 1 - depth / HALF
    strain = -math.log(stretch)
    plastic = max(0.0, (YOUNG * strain - YIELD) / (YOUNG + HARDENING))
    return YOUNG * (strain - plastic) * area / stretch


class Press:
    """The billet under the die, of which `Upset` notes way and force (of the whole billet)."""

    def __init__(self, n, friction):
        self.mesh, self.steps = Billet(n), []
        V = VectorH1(self.mesh, order=2, dirichletx="x", dirichlety="y", dirichletz="z")
        X = V * LACSpace(V, slave="top|side")
        u, lam = X.TrialFunction()
        law = {"young": YOUNG, "poisson": POISSON, "yield_stress": YIELD, "hardening": HARDENING}
        self.material = J2Plasticity(self.mesh, **law, order=2)
        a = BilinearForm(X)
        energy = self.material.Energy(LogStrain(Grad(u)))
        a += Variation(energy * dx(intrules=self.material.rules))
        self.gf, self.down = GridFunction(X), Parameter(0)
        self.displacement = self.gf.components[0]
        die = Plane((0, 0, HALF), (0, 0, -1)).Moved(shift=(0, 0, -self.down))
        self.contact = LACContact(u, lam, obstacle=die, finite=True, friction=friction or None)
        self.solver = ContactSolver(a, self.gf, self.contact)

    def Upset(self, depth, steps, printing):
        area = Integrate(1, self.mesh.Boundaries("top"))

        def Note(step):
            self.material.Commit(LogStrain(Grad(self.displacement)))
            force, smooth = -float(self.contact.Force()[2]), SmoothForce(step.time, area)
            self.steps.append({"depth": step.time, "force": 4 * force, "smooth": 4 * smooth})

        stepper = LoadStepper(self.solver, self.down)
        stepper.Integrate(depth, steps=steps, printing=printing, callback=Note)

    def Bulge(self):
        """Radii in the middle of the length and at the die."""
        places = (RADIUS, 0, 0), (RADIUS, 0, HALF)
        return [RADIUS + self.displacement(self.mesh(*place))[0] for place in places]

    def Volume(self):
        """Over that before."""
        F = Id(3) + Grad(self.displacement)
        return Integrate(Det(F), self.mesh, order=6) / Integrate(1, self.mesh)


def Write(press, folder):
    rows = Columns(press.steps)
    with Picture(folder, "upsetting", 1, 2, size=(9, 3.5)) as (left, right):
        left.plot(rows["depth"], rows["force"], ".-", label="computed")
        left.plot(rows["depth"], rows["smooth"], "k--", lw=0.9, label="smooth, exact")
        left.set(xlabel="way of each die [mm]", ylabel="force [N]", ylim=(0, None))
        left.legend()
        height = np.linspace(0, HALF, 60)
        side = np.array([press.displacement(press.mesh(RADIUS, 0, z)) for z in height])
        right.plot(RADIUS + side[:, 0], height + side[:, 2])
        right.axhline(HALF - rows["depth"][-1], color="k", lw=0.9)
        right.set(xlabel="radius [mm]", ylabel="height [mm]", title="side of the billet")
    press.contact.WriteVTU(folder / "upsetting", displacement=press.displacement)


def Run(n=4, friction=0.2, depth=3.0, steps=10, out=None, quiet=True):
    """Upset the billet; returns forces over those without friction, bulge and volume."""
    if depth >= 6:
        raise ValueError(f"depth = {depth} must be less than 6: the side would fold over the rim")
    press = Press(n, friction)
    press.Upset(depth, steps, not quiet)
    middle, end = press.Bulge()
    ratios = [row["force"] / row["smooth"] for row in press.steps]
    assert all(ratio > 1 if friction else abs(ratio - 1) < 1e-4 for ratio in ratios), ratios
    if out:
        Write(press, out)
    if not quiet:
        print(f"force over that without friction {ratios[-1]:.6f}")
        print(f"radius in the middle {middle:.4f} mm, at the die {end:.4f} mm")
    return {
        "force": press.steps[-1]["force"],
        "force_ratio": ratios,
        "bulge": middle - end,
        "volume": float(press.Volume()),
    }


main = Main(
    Run,
    __doc__,
    n=(Count, "elements along the radius and along half of the length"),
    friction=(NotNegative, "coefficient"),
    depth=(Positive, "way of each die, in mm, less than 6"),
    steps=(Count, "steps"),
)

if __name__ == "__main__":
    main()
