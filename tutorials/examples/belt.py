"""A belt on a drum that turns under it: the tension grows along the arc like exp(friction angle).

The belt is held at its left end and stretched at the right one. The drum is a tool: no mesh but a
signed distance, turned by a Parameter; friction counts the slip against its points. A thin belt
that slips everywhere obeys Euler's and Eytelwein's formula T2/T1 = exp(friction angle). Start it
with::

    python tutorials/examples/belt.py --out results
"""

import math

from command import Columns, Main, NotNegative, Picture, Positive
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import *

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import Stress
from ngslac.tools import Sphere

RADIUS, TAIL = 1.0, 0.2
YOUNG, NU, STRAIN = 1e3, 0.3, 1e-3


def Tangent(angle):
    """Clockwise, at an angle in degrees."""
    a = math.radians(angle)
    return math.sin(a), -math.cos(a)


def BeltMesh(wrap, thickness, h):
    """A belt over the top of the drum with straight ends; "drum", "held", "pulled" and "free"."""
    left = 90 + wrap / 2
    x, y = Tangent(left)
    start = RADIUS * -y - TAIL * x, RADIUS * x - TAIL * y
    plane = WorkPlane().MoveTo(*start).Direction(x, y)
    plane.Line(TAIL, "drum").Arc(RADIUS, -wrap).Line(TAIL, "drum")
    plane.Rotate(90).Line(thickness, "pulled").Rotate(90)
    plane.Line(TAIL, "free").Arc(RADIUS + thickness, wrap).Line(TAIL, "free")
    belt = plane.Rotate(90).Line(thickness, "held").Face()
    for edge in belt.edges:
        if edge.name is None:
            start, end = edge.parameter_interval
            middle = edge.Value((start + end) / 2)  # the center of an arc lies off it
            inner = math.hypot(middle.x, middle.y) < RADIUS + thickness / 2
            edge.name = "drum" if inner else "free"
    return Mesh(OCCGeometry(belt, dim=2).GenerateMesh(maxh=h)).Curve(3)


class Belt:
    """The belt in contact; `Turn` turns the drum clockwise while the belt is stretched."""

    def __init__(self, wrap, friction, thickness, h):
        self.wrap, self.out = wrap, Tangent(90 - wrap / 2)
        self.mesh = mesh = BeltMesh(wrap, thickness, h)
        V = VectorH1(mesh, order=2, dirichlet="held|pulled")
        X = V * LACSpace(V, slave="drum")
        (u, lam), (v, _) = X.TnT()
        self.load = Parameter(0)
        self.a = BilinearForm(X)
        self.a += InnerProduct(Stress(Sym(Grad(u)), YOUNG, NU), Sym(Grad(v))) * dx
        length = RADIUS * math.radians(wrap) + 2 * TAIL
        self.pull = {"pulled": STRAIN * length * self.load * CF(self.out)}
        drum = Sphere((0, 0), RADIUS).Moved(angle=-0.1 * self.load)
        self.contact = LACContact(u, lam, obstacle=drum, finite=True, friction=friction)
        self.gf = GridFunction(X)
        self.solver = ContactSolver(self.a, self.gf, self.contact)

    def Turn(self, steps, printing):
        stepper = LoadStepper(self.solver, self.load, prescribe=self.pull)
        stepper.Integrate(steps=steps, printing=printing)

    def Tensions(self):
        """At the pulled end and at the held one: the work of all forces on a motion of each end."""
        forces, motion = self.gf.vec.CreateVector(), GridFunction(self.gf.space)
        self.a.Apply(self.gf.vec, forces)
        self.contact.AddApply(self.gf.vec, forces)
        tensions = []
        for end, along in ("pulled", self.out), ("held", Tangent(90 + self.wrap / 2)):
            motion.vec[:] = 0
            motion.components[0].Set(CF(along), definedon=self.mesh.Boundaries(end))
            tensions.append(abs(InnerProduct(forces, motion.vec)))
        return tensions

    def Profile(self):
        """Pressure by the angle from the pulled end, in degrees."""
        table = self.contact.Table()
        rows = [
            {"angle": math.degrees(math.atan2(y, x)) - 90 + self.wrap / 2, "pressure": float(p)}
            for (x, y), p in zip(table["x"], table["pressure"], strict=True)
        ]
        return Columns(sorted(rows, key=lambda row: row["angle"]))


def Write(belt, friction, folder):
    found = belt.Profile()
    with Picture(folder, "belt", size=(6, 3.5)) as axes:
        axes.plot(found["angle"], found["pressure"], ".", label="computed")
        tension, _ = belt.Tensions()
        exact = [tension / RADIUS * math.exp(friction * math.radians(a)) for a in found["angle"]]
        axes.plot(found["angle"], exact, "k--", lw=0.9, label="T/R")
        axes.set(xlabel="angle from the pulled end [degrees]", ylabel="pressure [MPa]")
        axes.set(xlim=(0, belt.wrap), ylim=(0, 1.5 * max(exact)))
        axes.legend()
    belt.contact.WriteVTU(folder / "belt_drum", displacement=belt.gf.components[0])


def Run(wrap=180.0, friction=0.3, thickness=0.01, h=0.03, out=None, quiet=True):
    """Turn the drum until everything slips; returns the ratio of the tensions."""
    belt = Belt(wrap, friction, thickness, h)
    belt.Turn(2, not quiet)
    pulled, held = belt.Tensions()
    exact = math.exp(friction * math.radians(wrap))
    ratio = held / pulled
    assert abs(ratio / exact - 1) < thickness / RADIUS, (ratio, exact)
    if out:
        Write(belt, friction, out)
    if not quiet:
        print(f"T2/T1 {ratio:.5f}, exp(friction angle) {exact:.5f}")
    return {"ratio": ratio, "ratio_exact": exact}


main = Main(
    Run,
    __doc__,
    wrap=(Positive, "angle of the arc, in degrees"),
    friction=(NotNegative, "coefficient"),
    thickness=(Positive, "of the belt, over the radius of the drum"),
    h=(Positive, "longest edge along the belt"),
)

if __name__ == "__main__":
    main()
