"""A cylinder is upset between dies, smooth or rough: large plastic strains in 3D.

An eighth of a billet of radius 10 mm and length 30 mm (E = 200 GPa, nu = 0.3, yield stress 700 MPa,
hardening 300 MPa). The die is a plane on a path. Between smooth dies the billet stays a cylinder,
and its force follows from the law alone. Friction needs a larger one, and the billet bulges. (Dies
that come nearer by a third or more fold the side over the rim.) Start it with::

    python tutorials/examples/upsetting.py --out results
"""

from dataclasses import replace

import numpy as np
from command import Main, NotNegative
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import *
from pictures import Curves, Show
from plasticity import J2Plasticity, LogStrain

from ngslac import *
from ngslac.meshes import StructuredBox
from ngslac.tools import Plane

RADIUS, HALF = 10.0, 15.0  # of the billet, half of its length
YOUNG, YIELD, HARDENING = 200e3, 700.0, 300.0


def Billet(n):
    """With n by n by n hexahedra; "top" and "side", and "x", "y" and "z", where these are 0."""
    names = {"left": "x", "front": "y", "bottom": "z", "right": "side", "back": "side"}
    grid, ngmesh = np.linspace(0, 1, n + 1), NetgenMesh(dim=3)
    box = StructuredBox(grid, grid, grid, names=lambda side, centre: names.get(side, side))
    s, t, z = box.points.T  # the square of side 1 becomes a quarter of a disc
    disc = s * np.sqrt(1 - t**2 / 2), t * np.sqrt(1 - s**2 / 2)
    points = np.transpose([*np.multiply(RADIUS, disc), HALF * z])
    replace(box, points=points).AddTo(ngmesh, "billet")
    ngmesh.Compress()
    return Mesh(ngmesh)


def SmoothForce(depth, area):
    """Of a billet that stays a cylinder, of this cross section before.

    Kirchhoff's stress E (e - a) = Y + H a, of the logarithmic strain e and its plastic part a.
    """
    stretch = 1 - depth / HALF
    strain = -np.log(stretch)
    plastic = np.maximum(0.0, (YOUNG * strain - YIELD) / (YOUNG + HARDENING))
    return YOUNG * (strain - plastic) * area / stretch


def Run(n=4, friction: NotNegative = 0.2, depth=3.0, steps=10, out=None):
    """Upset the billet: force over that without friction, bulge, volume over that before.

    n : elements along the radius and along half of the length
    friction : coefficient
    depth : way of each die, in mm, less than 6
    steps : steps
    """
    if depth >= 6:
        raise ValueError(f"depth = {depth} must be less than 6: the side would fold over the rim")
    mesh = Billet(n)
    V = VectorH1(mesh, order=2, dirichletx="x", dirichlety="y", dirichletz="z")
    X = V * LACSpace(V, slave="top|side")
    u, lam = X.TrialFunction()
    law = {"poisson": 0.3, "yield_stress": YIELD, "hardening": HARDENING, "order": 2}
    material = J2Plasticity(mesh, young=YOUNG, **law)
    a, gf, down = BilinearForm(X), GridFunction(X), Parameter(0)
    a += Variation(material.Energy(LogStrain(Grad(u))) * dx(intrules=material.rules))
    die = Plane((0, 0, HALF), (0, 0, -1)).Moved(shift=(0, 0, -down))
    contact = LACContact(u, lam, obstacle=die, finite=True, friction=friction or None)
    stepper, moved = LoadStepper(ContactSolver(a, gf, contact), down), gf.components[0]
    flags = {"printing": False, "callback": lambda _: material.Commit(LogStrain(Grad(moved)))}
    stepper.Integrate(depth, steps=steps, **flags)

    way, force = stepper.Table()["load"], -4 * stepper.Table()["force"][:, 0, 2]
    smooth = 4 * SmoothForce(way, Integrate(1, mesh.Boundaries("top")))
    ratios, height = force / smooth, np.linspace(0, HALF, 61)
    side = np.array([moved(mesh(RADIUS, 0, z)) for z in height])
    bulge = side[0, 0] - side[-1, 0]
    volume = Integrate(Det(Id(3) + Grad(moved)), mesh, order=6) / Integrate(1, mesh)
    print(f"force over that without friction {ratios[-1]:.6f}, bulge {bulge:.4f} mm")
    assert (ratios > 1).all() if friction else np.allclose(ratios, 1, rtol=0, atol=1e-4), ratios

    forces = {"computed": (way, force, ".-"), "smooth,_exact": (way, smooth, "k--")}
    shape = {"side_of_the_billet": (RADIUS + side[:, 0], height + side[:, 2], "-")}
    Show(out, "upsetting", moved, Curves("way of each die [mm]", "force [N]", **forces),
         Curves("radius [mm]", "height [mm]", **shape), die=contact)  # fmt: skip
    return {"force_ratio": ratios.tolist(), "bulge": bulge, "volume": volume}


main = Main(Run)
