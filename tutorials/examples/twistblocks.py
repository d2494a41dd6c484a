"""Twisting blocks: a soft block is pressed on a wider one and turned by 180 degrees.

Large deformation and finite sliding with friction in three dimensions. The top of the upper block
(10 MPa, neo-Hookean) goes down by a tenth of its height and then turns about the vertical axis: the
block twists until its lower face slides, with friction 0.3, and turns as a whole from then on.
Start it with::

    python tutorials/examples/twistblocks.py --out results

The steady torque is compared with that of a flat square punch under uniform pressure, 0.3826 times
friction, force and width: 0.950 and 0.993 of it for 3 and 4 faces (steps of 15 degrees).
"""

from typing import Literal

import numpy as np
from command import Main, NotNegative
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import *
from pictures import Curves, Show

from ngslac import *
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


def Problem(n=3, order=2, friction=0.3, angle=180.0, rigid=False):
    """The stepper, whose load presses until 1 and turns until 2, and the contact."""
    mesh = TwistMesh(n)
    V = VectorH1(mesh, order=order, dirichlet="upper_top|lower_bottom")
    X = V * LACSpace(V, slave="upper_bottom")
    u, lam = X.TrialFunction()
    a, t = BilinearForm(X), Parameter(0.0)
    energy = NeoHooke(Id(3) + Grad(u), mesh.MaterialCF(YOUNG), POISSON)
    a += Variation(energy.Compile() * dx("upper" if rigid else ".*"))
    contact = LACContact(u, lam, master="lower_top", friction=friction or None, finite=True)
    free = X.FreeDofs()
    if rigid:  # a plane: the slip becomes exactly steady
        free = free & ~X.GetDofs(mesh.Materials("lower"))
    down, turned = IfPos(t - 1, 1, t), np.radians(angle) * IfPos(t - 1, t - 1, 0)
    c, s = cos(turned), sin(turned)
    motion = CF((c * x - s * y - x, s * x + c * y - y, -DEPTH * down))
    solver = ContactSolver(a, GridFunction(X), contact, freedofs=free)
    return LoadStepper(solver, t, prescribe={"upper_top": motion}), contact


def Turn(stepper, contact, steps, friction, angle, callback=print):
    """Press in two steps and turn; numbers of each step, of which `callback` sees a text."""
    rows = []

    def Note(step):
        status, force = contact.Table()["status"], step.forces[0][2]
        torque, punch = -contact.Moment((0, 0, 0))[2], friction * force * WIDTH * MEAN_DISTANCE
        row = {"angle": angle * max(step.time - 1.0, 0.0)}  # of the top, in degrees
        row |= {"force": force, "torque": torque}  # of the contact on the upper block
        row |= {"punch_ratio": torque / punch if punch else None}
        row["status"] = [int((status == k).sum()) for k in range(3)]  # open, stick, slip
        line = "{angle:6.1f} degrees   force {force:8.5f} N   torque {torque:8.5f} N mm   {status}"
        rows.append(row | {"iterations": step.iterations, "cuts": step.cuts})
        callback(line.format(**row))

    for end, count in ((1.0, 2), (2.0, steps)):
        stepper.Integrate(end, steps=count, callback=Note, printing=False)
    return {name: [row[name] for row in rows] for name in rows[0]}


def Torque(figures, friction):
    """A panel: the torque over the angle, beside that of a flat punch under the same force."""
    punch = friction * WIDTH * MEAN_DISTANCE * np.array(figures["force"])
    curves = {"computed": (figures["angle"], figures["torque"], "o-")}
    curves[r"$0.3826 \mu F a$"] = figures["angle"], punch, "k--"
    return Curves("angle [degrees]", "torque [N mm]", **curves)


def Run(n=3, order: Literal[2, 3] = 2, friction: NotNegative = 0.3, angle=180.0, steps=12,
        rigid=False, out=None):  # fmt: skip
    """Press and turn.

    n : faces of the upper block in each direction
    order : order of the displacement
    friction : coefficient of friction
    angle : angle of the turn in degrees
    steps : load steps of the turn
    rigid : the lower block is rigid
    """
    stepper, contact = Problem(n, order, friction, angle, rigid)
    figures = Turn(stepper, contact, steps, friction, angle)
    assert abs(figures["angle"][-1] - angle) < 1e-9 * angle
    # A punch of few faces has less than that of a square; more is more than friction can carry.
    assert max(ratio or 0 for ratio in figures["punch_ratio"]) < 1.05, figures["punch_ratio"]
    Show(
        out, "twistblocks", stepper.solver.gf.components[0], Torque(figures, friction), face=contact
    )
    return figures


main = Main(Run)
