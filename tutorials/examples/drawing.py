"""Deep drawing of a channel: a punch draws a sheet over a die, and a holder presses on its rim.

Plane strain, one half, large plastic strains. Punch, die and holder are tools: polygons with round
corners. The punch goes down on a path; the holder is moved by a force, so that its travel is an
unknown of the problem. Start it with::

    python tutorials/examples/drawing.py --out results

All forces balance: the die carries what punch and holder press, and the holder presses with the
force that is given, to the tolerance of the solver.
"""

from command import Columns, Count, Main, NotNegative, Picture, Positive
from deformed import Deformed
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import *
from plasticity import J2Plasticity, LogStrain

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.tools import Polygon

WIDTH, THICKNESS = 1.0, 0.06  # of the half of the sheet
PUNCH, DIE, CORNER = 0.4, 0.48, 0.12  # where the punch ends and the die begins; radius of corners
MATERIAL = {"young": 70e3, "poisson": 0.3, "yield_stress": 200.0, "hardening": 200.0}
FAR = 3.0  # where tools end


def Round(left, right, low, high):
    """A rectangle whose corners are round."""
    r = CORNER
    corners = [(left + r, low + r), (right - r, low + r), (right - r, high - r)]
    return Polygon([*corners, (left + r, high - r)]).Grown(r)


def Sheet(h):
    """Its lower side is "die", the upper one "punch" and "holder"."""
    split = (PUNCH + DIE) / 2 + CORNER / 2
    plane = WorkPlane().Line(WIDTH, "die").Rotate(90).Line(THICKNESS, "rim").Rotate(90)
    plane.Line(WIDTH - split, "holder").Line(split, "punch").Rotate(90).Line(THICKNESS, "middle")
    return Mesh(OCCGeometry(plane.Face(), dim=2).GenerateMesh(maxh=h))


class Press:
    """The sheet and its tools.

    Parameters
    ----------
    h : float
        Edge length.
    friction, force : float
        On all tools; of the holder.
    """

    def __init__(self, h, friction, force):
        self.mesh = mesh = Sheet(h)
        V = VectorH1(mesh, order=2, dirichletx="middle")
        X = V
        for side in ("die", "punch", "holder"):
            X = X * LACSpace(V, slave=side)
        X = X * NumberSpace(mesh)
        u, *lams, travel = X.TrialFunction()
        self.material = J2Plasticity(mesh, **MATERIAL)
        a = BilinearForm(X)
        energy = self.material.Energy(LogStrain(Grad(u)))
        a += Variation(energy * dx(intrules=self.material.rules))
        self.down = Parameter(0.0)
        above = THICKNESS + FAR
        tools = {
            "die": Round(DIE, FAR, -FAR, 0),
            "punch": Round(-FAR, PUNCH, THICKNESS, above).Moved(shift=(0, -self.down)),
            "holder": Round(DIE, FAR, THICKNESS, above).Driven(
                travel=(None, travel), force=(0, -force)
            ),
        }
        self.contacts = {
            name: LACContact(u, lam, obstacle=tool, finite=True, friction=friction)
            for lam, (name, tool) in zip(lams, tools.items(), strict=True)
        }
        self.gf = GridFunction(X)
        self.displacement = self.gf.components[0]
        solver = ContactSolver(a, self.gf, [*self.contacts.values()])
        self.stepper, self.steps = LoadStepper(solver, self.down), []

    def Draw(self, depth, steps, printing):
        """Move the punch down; the forces on the sheet and the draw-in are noted."""

        def Note(step):
            self.material.Commit(LogStrain(Grad(self.displacement)))
            forces = {name: float(c.Force()[1]) for name, c in self.contacts.items()}
            rim = self.displacement(self.mesh(WIDTH, THICKNESS / 2))
            self.steps.append({"depth": step.time, "draw_in": -float(rim[0])} | forces)

        self.stepper.Integrate(depth, steps=steps, printing=printing, callback=Note)


def Write(press, folder):
    rows = Columns(press.steps)
    with Picture(folder, "drawing", 1, 2, size=(9, 3.5)) as (left, right):
        points, faces = Deformed(press.displacement, press.mesh.GetMaterials())
        left.triplot(*points.T, faces, lw=0.4, color="k")
        left.set(aspect="equal", xlabel="x", ylabel="y")
        for name in press.contacts:
            right.plot(rows["depth"], rows[name], ".-", label=name)
        right.set(xlabel="depth", ylabel="force on the sheet, upwards")
        right.legend()
    press.contacts["die"].WriteVTU(folder / "drawing_die", displacement=press.displacement)


def Run(h=0.04, depth=0.15, steps=30, friction=0.1, force=10.0, out=None, quiet=True):
    """Draw the sheet; returns forces and draw-in of the steps."""
    press = Press(h, friction, force)
    press.Draw(depth, steps, not quiet)
    last = press.steps[-1]
    balance = abs(sum(last[name] for name in press.contacts)) / last["die"]
    assert balance < 1e-6, balance
    assert abs(last["holder"] / force + 1) < 1e-6, last
    if out:
        Write(press, out)
    if not quiet:
        print(f"draw-in {last['draw_in']:.4f}, force of the punch {-last['punch']:.4f}")
    return {
        "balance": balance,
        "draw_in": last["draw_in"],
        "punch_force": -last["punch"],
        "holder_force": -last["holder"],
        "steps": len(press.steps),
    }


main = Main(
    Run,
    __doc__,
    h=(Positive, "edge length"),
    depth=(Positive, "way of the punch"),
    steps=(Count, "steps"),
    friction=(NotNegative, "coefficient"),
    force=(Positive, "of the holder"),
)

if __name__ == "__main__":
    main()
