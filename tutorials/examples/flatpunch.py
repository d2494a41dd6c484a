"""The largest load of a flat punch on perfectly plastic ground: Prandtl's.

Plane strain, small strains, von Mises without hardening; one half is computed. The punch is a tool:
a polygon with sharp corners that goes down, smooth or rough. Start it with::

    python tutorials/examples/flatpunch.py --out results

The limit of the mean pressure is (2 + pi) k with the shear yield stress k = Y/sqrt(3), whatever
the friction (L. Prandtl 1920; R. Hill, The Mathematical Theory of Plasticity, 1950, section IX.5).
Displacements of second order come to it from above.
"""

import math

import numpy as np
from command import Columns, Count, Main, NotNegative, Picture, Positive
from deformed import Deformed
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import *
from plasticity import J2Plasticity, PlaneStrain

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.tools import Polygon

# The half width of the punch is 1.
WIDTH, DEPTH = 6.0, 4.0  # of the half of the ground
YOUNG, POISSON, YIELD = 1e5, 0.3, 1.0
DEEP = 60 * YIELD / YOUNG  # where the load does not grow any more
PRANDTL = (2 + math.pi) / math.sqrt(3)  # times the yield stress


def Ground(h):
    """Edges of the length h under the punch, whose corner is a point of the mesh, and of 4h."""
    plane = WorkPlane().MoveTo(0, 0).Direction(0, -1).Line(DEPTH, "sym").Rotate(90)
    plane.Line(WIDTH, "bottom").Rotate(90).Line(DEPTH, "side").Rotate(90)
    plane.Line(WIDTH - 1, "top").Line(1, "top")
    ground = plane.Face()
    for edge in ground.edges:
        if edge.name == "top" and edge.center.x < 1:
            edge.maxh = h
    return Mesh(OCCGeometry(ground, dim=2).GenerateMesh(maxh=4 * h, grading=0.15))


class Punch:
    """The ground and the tool."""

    def __init__(self, h, friction):
        self.mesh = Ground(h)
        V = VectorH1(self.mesh, order=2, dirichletx="sym|side", dirichlety="bottom")
        X = V * LACSpace(V, slave="top")
        u, lam = X.TrialFunction()
        self.material = J2Plasticity(self.mesh, young=YOUNG, poisson=POISSON, yield_stress=YIELD)
        a = BilinearForm(X)
        energy = self.material.Energy(PlaneStrain(Grad(u)))
        a += Variation(energy * dx(intrules=self.material.rules))
        self.gf, self.down = GridFunction(X), Parameter(0)
        tool = Polygon([(-9, 0), (1, 0), (1, 9), (-9, 9)]).Moved(shift=(0, -self.down))
        self.contact = LACContact(u, lam, obstacle=tool, finite=True, friction=friction or None)
        self.solver, self.steps = ContactSolver(a, self.gf, self.contact), []

    def Press(self, depth, steps, printing):
        def Note(step):
            self.material.Commit(PlaneStrain(Grad(self.gf.components[0])))
            pressure = -float(self.contact.Force()[1]) / YIELD
            self.steps.append({"depth": step.time, "pressure": pressure})

        stepper = LoadStepper(self.solver, self.down)
        stepper.Integrate(depth, steps=steps, printing=printing, callback=Note)

    def Profile(self):
        """Place and pressure of what touches, along the punch."""
        table = self.contact.Table()
        order = np.argsort(table["x"][:, 0])
        order = order[table["status"][order] > 0]
        return table["x"][order, 0], table["pressure"][order] / YIELD

    def PlasticStrain(self):
        """Mean accumulated plastic strain of each element."""
        constants = L2(self.mesh, order=0)
        v, rule = constants.TestFunction(), dx(intrules=self.material.rules)
        sums = [LinearForm(f * v * rule).Assemble().vec for f in (self.material.accumulated, 1)]
        return sums[0].FV().NumPy() / sums[1].FV().NumPy()


def Write(punch, folder):
    rows = Columns(punch.steps)
    with Picture(folder, "flatpunch", 1, 3, size=(12, 3.4)) as (left, middle, right):
        depth = np.array([0, *rows["depth"]]) * YOUNG / YIELD
        left.plot(depth, [0, *rows["pressure"]], ".-")
        left.axhline(PRANDTL, color="k", ls="--", lw=0.8)
        left.set(xlabel="depth over half width, times E/Y", ylabel="mean pressure / Y")
        middle.plot(*punch.Profile(), ".")
        middle.axhline(PRANDTL, color="k", ls="--", lw=0.8)
        middle.set(xlabel="place over half width", ylabel="pressure / Y", ylim=(0, None))
        displacement, strain = punch.gf.components[0], punch.PlasticStrain()
        points, faces = Deformed(displacement, punch.mesh.GetMaterials(), 100)
        drawn = right.tripcolor(*points.T, faces, facecolors=strain, vmax=0.15 * strain.max())
        right.figure.colorbar(drawn, ax=right, label="plastic strain", shrink=0.75)
        right.set(aspect="equal", xlim=(0, 4.5), ylim=(-3, 0.4), title="displacement x 100")
    punch.contact.WriteVTU(folder / "flatpunch_top", displacement=displacement)


def Run(h=0.0625, friction=0.0, depth=DEEP, steps=6, out=None, quiet=True):
    """Press until the load does not grow; returns the mean pressures over the yield stress."""
    punch = Punch(h, friction)
    punch.Press(depth, steps, not quiet)
    pressures = [row["pressure"] for row in punch.steps]
    assert 1 < pressures[-1] / PRANDTL < 1 + h, pressures
    if out:
        Write(punch, out)
    if not quiet:
        print(f"largest mean pressure over the yield stress {pressures[-1]:.4f}, ", end="")
        print(f"Prandtl {PRANDTL:.4f}")
    return {
        "pressure": pressures[-1],
        "prandtl": PRANDTL,
        "curve": pressures,
        "growth": pressures[-1] / pressures[-2] - 1,
    }


main = Main(
    Run,
    __doc__,
    h=(Positive, "edge length under the punch"),
    friction=(NotNegative, "coefficient"),
    depth=(Positive, "over the half width"),
    steps=(Count, "steps"),
)

if __name__ == "__main__":
    main()
