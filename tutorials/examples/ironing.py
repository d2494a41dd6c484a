"""Shallow ironing: a die is pressed into a slab and drawn over it with friction.

Plane strain, neo-Hookean bodies (die 6896 MPa, slab 689.6 MPa, nu = 0.32), friction 0.3. The top of
the die goes down by 1 mm (time 0 to 1), of which 0.2 mm are clearance, and then 10 mm to the right
(time 1 to 2): the surfaces slide over dozens of faces. After K. A. Fischer, P. Wriggers, Comput.
Methods Appl. Mech. Engrg. 195 (2006), and code_aster's test SSNP153. Start it with::

    python tutorials/examples/ironing.py --out results

The published forces differ from each other by up to 25 % (vertical) and 90 % (horizontal). Those
computed here are 333 and 423 N/mm down after the indentation and in the middle of the stroke, with
131 N/mm to the right, and change by less than 1 % on finer meshes. Each step should move the die by
half an edge of the slab at most: larger ones can end in another equilibrium, of crumpled elements.
"""

from itertools import pairwise

import numpy as np
from command import Columns, Communicator, Count, Main, NotNegative, Picture, Positive
from driven import RigidMotion
from ngsolve import *
from published import PUBLISHED, TIMES

from ngslac import ContactConvergenceError, ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import NeoHooke
from ngslac.meshes import Distributed, geometry

YOUNG, POISSON = {"die": 6896.0, "slab": 689.6}, 0.32  # MPa
LENGTH, HEIGHT, CLEARANCE = 12.0, 4.0, 0.2  # of the slab, and of the die above it, in mm
DEPTH, STROKE = 1.0, 10.0  # of the top of the die from the time 0 to 1 and 1 to 2, in mm


def IroningMesh(h=0.2, order=2):
    """A die, 1.2 wide on an arc of radius 0.75, above the left end of the slab.

    Boundaries "foot" (the arc), "flank", "top" of the die, "master" (the top of the slab, with the
    edge length h), "bottom", "side". No node of the foot is above a node of the slab.
    """
    left, right, low, high, radius = 0.2, 1.4, 0.5, 1.4, 0.75
    angle, middle = np.arcsin((right - left) / 2 / radius), (left + right) / 2
    foot = max(4, geometry.Divisions(2 * angle * radius, 0.6 * h))
    flank = max(2, foot // 3)
    nodes = middle + radius * np.sin(np.linspace(-angle, angle, foot + 1))
    count = geometry.NonMatchingDivisions(nodes, 0.0, LENGTH, h)
    circle = geometry.Touching(radius)
    sides = [
        geometry.Arc(lambda t: np.add(circle(t), (middle, CLEARANCE)), -angle, angle, "foot", foot),
        geometry.Line((right, low), (right, high), "flank", flank),
        geometry.Line((right, high), (left, high), "top", flank),
        geometry.Line((left, high), (left, low), "flank", flank),
    ]
    die = geometry.Body(sides, "die")
    points = [(0, -HEIGHT), (LENGTH, -HEIGHT), (LENGTH, 0), (0, 0)]
    slab = geometry.Polygon(points, ("bottom", "side", "master", "side"), "slab", master=count)
    return geometry.GenerateMesh([die, slab], order=order, maxh=HEIGHT / 4, grading=0.3)


def Quadratic(residuals):
    """Do the last residuals of a step fall as those of a quadratic method?

    A fall is a quadratic one if r_n <= 1000 r_(n-1)^2 and r_n <= 1e-2 r_(n-1); the residuals are
    relative to the forces at work. One of the last two falls must be, and the last one must be by
    100 at least or end in rounding (1e-12). Linear convergence by a factor above 1e-2 fails.
    """
    falls = [(a, b) for a, b in pairwise(residuals) if a > 1e-12][-2:]  # rounding falls nowhere
    quadratic = any(b <= min(1000 * a**2, 1e-2 * a) for a, b in falls)
    return not falls or (quadratic and falls[-1][1] <= max(1e-2 * falls[-1][0], 1e-12))


class Ironing:
    """Die, slab and solver; `rows` has an entry for each step."""

    def __init__(self, h=0.3, order=2, friction=0.3):
        self.mesh, self.rows = Distributed(lambda: IroningMesh(h, order), Communicator()), []
        V = VectorH1(self.mesh, order=order, dirichlet="bottom|top")
        X = V * LACSpace(V, slave="foot|flank")
        u, lam = X.TrialFunction()
        a, gf, time = BilinearForm(X), GridFunction(X), Parameter(0.0)
        energy = NeoHooke(Id(2) + Grad(u), self.mesh.MaterialCF(YOUNG), POISSON)
        a += Variation(energy.Compile() * dx)
        self.displacement = gf.components[0]
        # Steps begin with the die moved into the slab: see the slab through all of the die's foot.
        self.contact = LACContact(
            u, lam, master="master", friction=friction or None, finite=True, penetration=DEPTH
        )

        def Target():
            return STROKE * max(time.Get() - 1, 0), -DEPTH * min(time.Get(), 1)

        motion = RigidMotion(V, body="die", driven="top", target=Target)
        self.stepper = LoadStepper(ContactSolver(a, gf, self.contact), time, prescribe=motion)

    def Iron(self, steps=80, stroke=STROKE, quiet=True):
        """Press the die in, by as many steps as 2.5 mm of the stroke take, and draw it along."""
        down = min(max(1, round(steps * 2.5 / (2.5 + stroke))), steps - 1)
        turn = np.linspace(1, 1 + stroke / STROKE, steps - down + 1)
        self.wanted = np.concatenate([np.linspace(0, 1, down + 1)[1:], turn[1:]])
        self.quiet = quiet
        for end, count in ((1.0, down), (turn[-1], steps - down)):
            self.stepper.Integrate(end, steps=count, callback=self._Record, printing=False)

    def _Record(self, step):
        history, (right, up) = self.stepper.solver.history, self.contact.Force()  # on the die
        self.rows.append(
            {
                "time": step.time,
                "vertical_force": up,  # of the die on the slab, downwards, in N/mm
                "horizontal_force": -right,  # of the die on the slab, to the right
                "iterations": step.iterations,
                "cuts": step.cuts,
                "residuals": [max(entry.equilibrium, entry.constraint) for entry in history],
            }
        )
        if not self.quiet:
            print(f"t = {step.time:.3f}: down {up:.1f}, right {-right:.1f} N/mm", flush=True)

    def Figures(self):
        """Each number of the steps as a list, and what the steps did."""
        figures = Columns(self.rows)
        reached = np.abs(np.subtract.outer(self.wanted, figures["time"])) < 1e-9
        quadratic = all(map(Quadratic, figures["residuals"]))
        return figures | {"converged_steps": int(reached.any(1).sum()), "quadratic": quadratic}


def DrawForces(axes, figures):
    """The forces (lines) beside the published ones: circles vertical, squares horizontal."""
    for k, name in enumerate(("vertical_force", "horizontal_force")):
        axes.plot(figures["time"], figures[name], ("k-", "k--")[k], label=name.replace("_", " "))
        axes.set_prop_cycle(None)
        for who, curves in PUBLISHED.items():
            axes.plot(TIMES, curves[k], "os"[k], ms=4, mfc="none", label=None if k else who)
    axes.set(xlabel="time (1: indented by 1 mm, 2: moved by 10 mm)", ylabel="force [N/mm]")
    axes.legend(fontsize=8)


def Write(ironing, figures, folder):
    """The forces and the pressures as a picture, the foot for ParaView."""
    with Picture(folder, "ironing", columns=2, size=(11, 5)) as (left, right):
        DrawForces(left, figures)
        ironing.contact.Plot("pressure", deformation=ironing.displacement, axes=right)
    ironing.contact.WriteVTU(folder / "ironing", displacement=ironing.displacement)


def Run(steps=80, stroke=STROKE, out=None, quiet=True, **options):
    """Iron; the options are those of `Ironing`. Returns the numbers of the steps."""
    if steps < 2 or stroke > STROKE:
        raise ValueError(f"steps = {steps} must be at least 2, stroke = {stroke} at most {STROKE}")
    ironing, failure = Ironing(**options), None
    try:
        ironing.Iron(steps, stroke, quiet)
    except ContactConvergenceError as error:
        if not ironing.rows:
            raise
        failure = str(error)
    figures = ironing.Figures() | {"steps": steps, "failure": failure}
    if out:
        Write(ironing, figures, out)
    return figures


main = Main(
    Run,
    __doc__,
    Ironing,
    h=(Positive, "edge length on the top of the slab, in mm"),
    order=((2, 3), "order of the displacement"),
    friction=(NotNegative, "coefficient of friction"),
    steps=(Count, "load steps, at least 2"),
    stroke=(Positive, "way of the die to the right, in mm"),
)


if __name__ == "__main__":
    main()
