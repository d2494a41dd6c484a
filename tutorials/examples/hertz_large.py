"""Hertz' problem with large deformation: a rubber cylinder is flattened between rigid plates.

Plane strain, neo-Hookean (1 MPa, nu = 0.49), radius 1 mm, without friction; a quarter is computed.
The plates come together until the middle is nearer to each by 30 % of the radius. Small loads are
those of Hertz (K. L. Johnson, Contact Mechanics, 1985, section 5.6). Start it with::

    python tutorials/examples/hertz_large.py --out results

The force at the end is 0.6282 N/mm on fine meshes, of which Hertz' theory has 0.4940. Rubber that
hardly changes its volume needs its pressure as another unknown: ``--mixed --nu 0.4999``.
"""

from types import SimpleNamespace
from typing import Literal

import numpy as np
from command import Main, NotNegative
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import *
from pictures import Bodies, Curves, Show
from scipy.optimize import brentq

from ngslac import *
from ngslac.materials import NeoHooke
from ngslac.tools import Plane

RADIUS, YOUNG, REACH = 1.0, 1.0, 70  # mm, MPa; degrees of the arc that may touch


def CylinderMesh(h, order=3):
    """A quarter, x >= 0, 0 <= y <= 1: "slave" (an arc), "free", "sym" (x = 0), "middle" (y = 1)."""
    plane = WorkPlane().Arc(RADIUS, REACH, "slave", h).Arc(RADIUS, 90 - REACH, "free").Rotate(90)
    quarter = plane.Line(RADIUS, "middle").Rotate(90).Line(RADIUS, "sym").Face()
    return Mesh(OCCGeometry(quarter, dim=2).GenerateMesh(maxh=0.2, grading=0.3)).Curve(order)


def Approach(force, nu):
    """Hertz' approach (mm) of the middle to a plate under a force (N/mm) of the whole cylinder."""
    compliance = force * (1 - nu**2) / (np.pi * YOUNG)
    return compliance * (2 * np.log(4 * RADIUS / np.sqrt(4 * compliance * RADIUS)) - 1)


def HertzForce(approach, nu):
    """The inverse of `Approach`."""
    return brentq(lambda p: Approach(p, nu) - approach, 1e-15, YOUNG * RADIUS, xtol=1e-15)


def Run(h=0.05, order: Literal[1, 2, 3] = 2, nu: NotNegative = 0.49, mixed=False,
        friction: NotNegative = 0.0, depth=0.3, steps=30, out=None):  # fmt: skip
    """Flatten the cylinder: for each step its force (N/mm), that of Hertz, and its energy.

    h : edge length on the arc, in mm
    order : order of the displacement
    nu : Poisson's ratio
    mixed : the hydrostatic pressure is an unknown, too
    friction : coefficient of friction
    depth : approach of the middle to a plate, in mm
    steps : load steps
    """
    if not depth < 0.7:
        raise ValueError(f"depth = {depth} must be less than 0.7 radii")
    mesh = CylinderMesh(h, max(order, 2))
    V = VectorH1(mesh, order=order, dirichletx="sym", dirichlety="middle")
    Q = LACSpace(V, slave="slave")
    X = V * H1(mesh, order=order - 1) * Q if mixed else V * Q
    u, *pressure, lam = X.TrialFunction()
    a, gf, load, stored = BilinearForm(X), GridFunction(X), Parameter(0.0), []
    energy = NeoHooke(Id(2) + Grad(u), YOUNG, nu, pressure=pressure[0] if mixed else None)
    a += Variation(energy.Compile() * dx)
    moved, plate = gf.components[0], Plane((0, 0), (0, 1))
    contact = LACContact(u, lam, obstacle=plate, friction=friction or None, finite=True)
    solver, down = ContactSolver(a, gf, contact), {"middle": CF((0, -depth * load))}
    stepper = LoadStepper(solver, load, prescribe=down)
    whole = 2 * NeoHooke(Id(2) + Grad(moved), YOUNG, nu) * dx  # of the half that a plate sees
    flags = {"printing": False, "callback": lambda _: stored.append(Integrate(whole, mesh))}
    stepper.Integrate(steps=steps, **flags)

    approach, force = depth * stepper.Table()["load"], 2 * stepper.Table()["force"][:, 0, 1]
    hertz = np.array([HertzForce(each, nu) for each in approach])
    print(f"force {force[-1]:.5f} N/mm, by Hertz {hertz[-1]:.5f}")
    # Large strains make it stiffer; the edge of the contact lies between macro-elements.
    assert 0.9 < force[-1] / hertz[-1] < 1.2 + depth, (force, hertz)

    table = contact.Table()
    curves = {"computed": (approach, force, ".-"), "Hertz": (approach, hertz, "k--")}
    place, closed = table["x"][:, 0], table["status"] > 0
    ends = place[closed].max(initial=0.0), place[~closed].min(initial=RADIUS)
    Show(out, "hertz_large", moved, Bodies(moved),
         Curves("approach of the middle to a plate [mm]", "force [N/mm]", **curves),
         lambda axes: contact.Plot(axes=axes), arc=contact)  # fmt: skip
    figures = {"approach": approach, "force": force, "hertz": hertz, "energy": np.array(stored)}
    figures |= {"halfwidth": sum(ends) / 2, "cuts": stepper.Table()["cuts"]}
    return figures | {"solution": SimpleNamespace(gf=gf, contact=contact, solver=solver)}


main = Main(Run)
