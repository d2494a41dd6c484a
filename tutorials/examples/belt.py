"""A belt on a drum that turns under it: the tension grows along the arc like exp(friction angle).

The belt is held at its left end and stretched at the right one. The drum is a tool: no mesh but a
signed distance, turned by a Parameter; friction counts the slip against its points. A thin belt
that slips everywhere obeys Euler's and Eytelwein's formula T2/T1 = exp(friction angle). Start it
with::

    python tutorials/examples/belt.py --out results
"""

import math

import numpy as np
from command import Main, NotNegative
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import *
from pictures import Curves, Show

from ngslac import *
from ngslac.materials import Stress
from ngslac.tools import Sphere

RADIUS, TAIL, STRAIN = 1.0, 0.2, 1e-3


def Tangent(angle):
    """Clockwise, at an angle in degrees."""
    return math.sin(math.radians(angle)), -math.cos(math.radians(angle))


def BeltMesh(wrap, thickness, h):
    """A belt over the top of the drum with straight ends; "drum", "held", "pulled" and "free"."""
    x, y = Tangent(90 + wrap / 2)
    plane = WorkPlane().MoveTo(-RADIUS * y - TAIL * x, RADIUS * x - TAIL * y).Direction(x, y)
    plane.Line(TAIL, "drum").Arc(RADIUS, -wrap, "drum").Line(TAIL, "drum").Rotate(90)
    plane.Line(thickness, "pulled").Rotate(90).Line(TAIL, "free")
    plane.Arc(RADIUS + thickness, wrap, "free").Line(TAIL, "free").Rotate(90)
    belt = plane.Line(thickness, "held").Face()
    return Mesh(OCCGeometry(belt, dim=2).GenerateMesh(maxh=h)).Curve(3)


def Run(wrap=180.0, friction: NotNegative = 0.3, thickness=0.01, h=0.03, out=None):
    """Turn the drum until everything slips, and stretch the belt.

    wrap : angle of the arc, in degrees
    friction : coefficient
    thickness : of the belt, over the radius of the drum
    h : longest edge along the belt
    """
    mesh = BeltMesh(wrap, thickness, h)
    V = VectorH1(mesh, order=2, dirichlet="held|pulled")
    X = V * LACSpace(V, slave="drum")
    (u, lam), (v, _) = X.TnT()
    a, gf, load = BilinearForm(X), GridFunction(X), Parameter(0)
    a += InnerProduct(Stress(Sym(Grad(u)), 1e3, 0.3), Sym(Grad(v))) * dx
    drum = Sphere((0, 0), RADIUS).Moved(angle=-0.1 * load)
    contact = LACContact(u, lam, obstacle=drum, finite=True, friction=friction)
    ends = {"pulled": CF(Tangent(90 - wrap / 2)), "held": CF(Tangent(90 + wrap / 2))}
    length = RADIUS * math.radians(wrap) + 2 * TAIL
    pull = {"pulled": STRAIN * length * load * ends["pulled"]}
    stepper = LoadStepper(ContactSolver(a, gf, contact), load, prescribe=pull)
    stepper.Integrate(steps=2, printing=False)

    forces, tension = gf.vec.CreateVector(), {}
    a.Apply(gf.vec, forces)
    contact.AddApply(gf.vec, forces)
    for end, along in ends.items():  # the work of all forces on a motion of this end
        motion = GridFunction(X)
        motion.components[0].Set(along, definedon=mesh.Boundaries(end))
        tension[end] = abs(InnerProduct(forces, motion.vec))
    ratio, exact = tension["held"] / tension["pulled"], math.exp(friction * math.radians(wrap))
    print(f"T2/T1 {ratio:.5f}, exp(friction angle) {exact:.5f}")
    assert abs(ratio / exact - 1) < thickness / RADIUS, (ratio, exact)

    table = contact.Table()
    angle = np.degrees(np.arctan2(*table["x"].T[::-1])) - 90 + wrap / 2
    along = np.linspace(0, wrap)
    pressure = tension["pulled"] / RADIUS * np.exp(friction * np.radians(along))
    curves = {"computed": (angle, table["pressure"], "."), "T/R": (along, pressure, "k--")}
    profile = Curves("angle from the pulled end [degrees]", "pressure [MPa]", **curves)
    Show(out, "belt", gf.components[0], profile, drum=contact)
    return {"ratio": ratio, "ratio_exact": exact}


main = Main(Run)
