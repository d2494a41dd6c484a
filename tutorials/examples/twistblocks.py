"""Twisting blocks: a soft block is pressed on a wider one and turned by 180 degrees.

Large deformation and finite sliding with friction in three dimensions. The top of the upper block
(10 MPa, neo-Hookean) goes down by a tenth of its height and then turns about the vertical axis: the
block twists until its lower face slides, with friction 0.3, and turns as a whole from then on.
Start it with::

    python tutorials/examples/twistblocks.py --out results

The steady torque is compared with that of a flat square punch under uniform pressure, 0.3826 times
friction, force and width: 0.950 and 0.993 of it for 3 and 4 faces (steps of 15 degrees).
"""

import numpy as np
from command import Columns, Count, Main, NotNegative, Picture, Positive
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import *

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import NeoHooke
from ngslac.meshes import StructuredBox

WIDTH, HEIGHT = 1.0, 1.5  # of the upper block, in mm
LOWER_WIDTH, LOWER_HEIGHT = 1.6, 0.4
DEPTH = 0.15  # by which the top goes down, in mm
YOUNG, POISSON = {"upper": 10.0, "lower": 200.0}, 0.3  # MPa
# Of the points of a square from its middle, over its width.
MEAN_DISTANCE = (2**0.5 + np.arcsinh(1)) / 6


def TwistMesh(n=3):
    """Hexahedra: the upper block, with n x n faces below, on the wider lower one.

    Both are centred at the z axis and touch at z = 0. Materials "upper" and "lower", boundaries
    "upper_bottom", "upper_top", "lower_top", ...
    """
    if n < 2:
        raise ValueError(f"n = {n} must be at least 2")
    mesh, heights = NetgenMesh(dim=3), np.linspace(0, HEIGHT, max(1, round(0.5 * n)) + 1)
    for name, width, faces, z in (
        ("upper", WIDTH, n, heights),
        ("lower", LOWER_WIDTH, n - 1, (-LOWER_HEIGHT, 0)),
    ):
        grid = width * np.linspace(-0.5, 0.5, faces + 1)
        box = StructuredBox(grid, grid, z, names=lambda side, _, name=name: f"{name}_{side}")
        box.AddTo(mesh, name)
    mesh.Compress()
    return Mesh(mesh)


class Blocks:
    """Both blocks and the solver; `rows` has an entry for each step."""

    def __init__(self, n=3, order=2, friction=0.3, angle=180.0, rigid=False):
        self.mesh, self.friction, self.angle, self.rows = TwistMesh(n), friction, angle, []
        self.bodies = self.mesh.Materials("upper" if rigid else ".*")
        V = VectorH1(self.mesh, order=order, dirichlet="upper_top|lower_bottom")
        X = V * LACSpace(V, slave="upper_bottom")
        u, lam = X.TrialFunction()
        a, gf, self.load = BilinearForm(X), GridFunction(X), Parameter(0.0)
        energy = NeoHooke(Id(3) + Grad(u), self.mesh.MaterialCF(YOUNG), POISSON)
        a += Variation(energy.Compile() * dx(definedon=self.bodies))
        self.displacement = gf.components[0]
        self.contact = LACContact(
            u, lam, master="lower_top", friction=friction or None, finite=True
        )
        free = X.FreeDofs()
        if rigid:  # a plane: the slip becomes exactly steady
            free = free & ~X.GetDofs(self.mesh.Materials("lower"))
        solver = ContactSolver(a, gf, self.contact, freedofs=free)
        self.stepper = LoadStepper(solver, self.load, prescribe={"upper_top": self._Motion()})

    def _Motion(self):
        """The top goes down until the time 1 and turns until the time 2."""
        t = self.load
        down, turned = IfPos(t - 1, 1, t), np.radians(self.angle) * IfPos(t - 1, t - 1, 0)
        c, s = cos(turned), sin(turned)
        return CF((c * x - s * y - x, s * x + c * y - y, -DEPTH * down))

    def Turn(self, steps, callback=None):
        """Press in two steps and turn in `steps`; ``callback(row)`` sees each of them."""

        def Record(step):
            self.rows.append(self._Row(step))
            if callback:
                callback(self.rows[-1])

        for end, count in ((1.0, 2), (2.0, steps)):
            self.stepper.Integrate(end, steps=count, callback=Record, printing=False)

    def _Row(self, step):
        status, force = self.contact.Table()["status"], self.contact.Force()[2]
        torque = -self.contact.Moment((0, 0, 0))[2]
        punch = self.friction * force * WIDTH * MEAN_DISTANCE
        return {
            "angle": self.angle * max(step.time - 1.0, 0.0),  # of the top, in degrees
            "force": force,  # of the contact on the upper block, N
            "torque": torque,  # that turns it, N mm
            "punch_ratio": torque / punch if punch else None,
            "status": [int((status == k).sum()) for k in range(3)],  # open, stick, slip
            "iterations": step.iterations,
            "cuts": step.cuts,
        }

    def Figures(self):
        """Each number of the steps as a list; the first two press, the others turn."""
        return Columns(self.rows)


def DrawTorque(axes, figures, friction):
    """The torque over the angle, beside that of a flat punch under the same force."""
    axes.plot(figures["angle"], figures["torque"], "o-", ms=3, label="computed")
    punch = friction * WIDTH * MEAN_DISTANCE * np.array(figures["force"])
    axes.plot(figures["angle"], punch, "k--", label=r"$0.3826 \mu F a$")
    axes.set(xlabel="angle [degrees]", ylabel="torque [N mm]")
    axes.legend()


def Write(blocks, folder):
    """The torque as a picture; scene for the browser, and the contact for ParaView."""
    with Picture(folder, "twistblocks") as axes:
        DrawTorque(axes, blocks.Figures(), blocks.friction)
    scene = blocks.contact.Draw("traction", deformation=blocks.displacement, show=False)
    scene.GenerateHTML(filename=str(folder / "twistblocks.html"))
    blocks.contact.WriteVTU(folder / "twistblocks", displacement=blocks.displacement)


def _Print(row):
    line = "{angle:6.1f} degrees   force {force:8.5f} N   torque {torque:8.5f} N mm   {status}"
    print(line.format(**row), flush=True)


def Run(steps=12, out=None, quiet=True, **options):
    """Press and turn; the options are those of `Blocks`. Returns the numbers of the steps."""
    blocks = Blocks(**options)
    blocks.Turn(steps, None if quiet else _Print)
    figures = blocks.Figures() | {"steps": steps, "converged_steps": len(blocks.rows) - 2}
    if out:
        Write(blocks, out)
    return figures


main = Main(
    Run,
    __doc__,
    Blocks,
    n=(Count, "faces of the upper block in each direction"),
    order=((2, 3), "order of the displacement"),
    friction=(NotNegative, "coefficient of friction"),
    angle=(Positive, "angle of the turn in degrees"),
    steps=(Count, "load steps of the turn"),
    rigid=(bool, "the lower block is rigid"),
)


if __name__ == "__main__":
    main()
