"""The largest load of a flat punch on perfectly plastic ground: Prandtl's.

Plane strain, small strains, von Mises without hardening; one half is computed. The punch is a tool:
a polygon with sharp corners that goes down, smooth or rough. Start it with::

    python tutorials/examples/flatpunch.py --out results

The limit of the mean pressure is (2 + pi) k with the shear yield stress k = Y/sqrt(3), whatever
the friction (L. Prandtl 1920; R. Hill, The Mathematical Theory of Plasticity, 1950, section IX.5).
Displacements of second order come to it from above.
"""

import math

from command import Main, NotNegative
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import *
from pictures import Bodies, Curves, Show
from plasticity import J2Plasticity, PlaneStrain

from ngslac import *
from ngslac.tools import Polygon

# The half width of the punch and the yield stress are 1.
WIDTH, DEPTH, YOUNG = 6.0, 4.0, 1e5  # of the half of the ground
DEEP = 60 / YOUNG  # where the load does not grow any more
PRANDTL = (2 + math.pi) / math.sqrt(3)


def Ground(h):
    """Edges of the length h under the punch, whose corner is a point of the mesh, and of 4h."""
    plane = WorkPlane().Direction(0, -1).Line(DEPTH, "sym").Rotate(90).Line(WIDTH, "bottom")
    plane.Rotate(90).Line(DEPTH, "side").Rotate(90).Line(WIDTH - 1, "top").Line(1, "top")
    ground = plane.Face()
    ground.edges.Nearest((0.5, 0, 0)).maxh = h
    return Mesh(OCCGeometry(ground, dim=2).GenerateMesh(maxh=4 * h, grading=0.15))


def Run(h=0.0625, friction: NotNegative = 0.0, depth=DEEP, steps=6, out=None):
    """Press until the load does not grow; mean pressures over the yield stress.

    h : edge length under the punch
    friction : coefficient
    depth : over the half width
    steps : steps
    """
    mesh = Ground(h)
    V = VectorH1(mesh, order=2, dirichletx="sym|side", dirichlety="bottom")
    X = V * LACSpace(V, slave="top")
    u, lam = X.TrialFunction()
    material = J2Plasticity(mesh, young=YOUNG, poisson=0.3, yield_stress=1.0)
    a, gf, down = BilinearForm(X), GridFunction(X), Parameter(0)
    a += Variation(material.Energy(PlaneStrain(Grad(u))) * dx(intrules=material.rules))
    punch = Polygon([(-9, 0), (1, 0), (1, 9), (-9, 9)]).Moved(shift=(0, -down))
    contact = LACContact(u, lam, obstacle=punch, finite=True, friction=friction or None)
    stepper = LoadStepper(ContactSolver(a, gf, contact), down)
    moved = gf.components[0]
    flags = {"printing": False, "callback": lambda _: material.Commit(PlaneStrain(Grad(moved)))}
    stepper.Integrate(depth, steps=steps, **flags)

    mean = -stepper.Table()["force"][:, 0, 1]
    print(f"largest mean pressure over the yield stress {mean[-1]:.4f}, Prandtl {PRANDTL:.4f}")
    assert 1 < mean[-1] / PRANDTL < 1 + h, mean

    depths, table = stepper.Table()["load"], contact.Table()
    closed = table["status"] > 0
    places, pressures = table["x"][closed, 0], table["pressure"][closed]
    load = Curves("depth over half width, times E/Y", "mean pressure / Y",
                  computed=(depths * YOUNG, mean, ".-"),
                  Prandtl=(depths[[0, -1]] * YOUNG, [PRANDTL] * 2, "k--"))  # fmt: skip
    profile = Curves("place over half width", "pressure / Y", computed=(places, pressures, "."))
    flow = Bodies(moved, material.Smoothed(), "plastic strain", factor=100, window=(0, 4.5, -3, 1))
    Show(out, "flatpunch", moved, load, profile, flow, top=contact)
    figures = {"pressure": mean[-1], "prandtl": PRANDTL, "curve": mean.tolist()}
    return figures | {"growth": mean[-1] / mean[-2] - 1}


main = Main(Run)
