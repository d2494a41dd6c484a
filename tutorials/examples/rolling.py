"""A plate is rolled in two passes, from 1 to 0.75 and to 0.5: large plastic strains.

The upper half of the plate, in plane strain. The roll is a tool on a path: it goes down, along the
plate while it turns, down again, and back. Two rolls of radius 2, plate of length 4, as in the
problem of two passes of MOOSE's examples of rigid contact, here with friction. Start it with::

    python tutorials/examples/rolling.py --out results

What comes out has the thickness of the gap between the rolls, and the volume of the plate.
"""

import numpy as np
from command import Columns, Count, Main, NotNegative, Picture, Positive
from deformed import Deformed
from ngsolve import *
from ngsolve.meshes import MakeStructured2DMesh
from plasticity import J2Plasticity, LogStrain

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.tools import Sphere

LENGTH, RADIUS, GAPS = 4.0, 2.0, (0.75, 0.5)
YOUNG, POISSON, YIELD, HARDENING = 70e3, 0.3, 200.0, 200.0
FROM, TO, BACK = 1.2, 2.4, 1.4  # where the roll goes down, turns back, and stops


class Mill:
    """The plate, its left end and its middle plane held, and the roll.

    Parameters
    ----------
    h : float
        Edge length.
    friction : float
    """

    def __init__(self, h, friction):
        nx, ny = round(LENGTH / h), max(2, round(0.5 / h))
        self.mesh = MakeStructured2DMesh(
            quads=False, nx=nx, ny=ny, mapping=lambda s, t: (LENGTH * s, 0.5 * t)
        )
        V = VectorH1(self.mesh, order=2, dirichletx="left", dirichlety="bottom")
        X = V * LACSpace(V, slave="top")
        u, lam = X.TrialFunction()
        self.material = J2Plasticity(
            self.mesh, young=YOUNG, poisson=POISSON, yield_stress=YIELD, hardening=HARDENING
        )
        self.a = BilinearForm(X)
        energy = self.material.Energy(LogStrain(Grad(u)))
        self.a += Variation(energy * dx(intrules=self.material.rules))
        self.gf = GridFunction(X)
        self.displacement = self.gf.components[0]
        self.down, self.way = Parameter(0.0), Parameter(0.0)
        above = FROM, 0.5 + RADIUS
        self.roll = Sphere(above, RADIUS).Moved(
            shift=(self.way, -self.down), angle=-self.way / RADIUS, center=above
        )
        self.contact = LACContact(u, lam, obstacle=self.roll, finite=True, friction=friction)
        self.solver = ContactSolver(self.a, self.gf, self.contact)
        self.steps = []

    def Go(self, parameter, end, steps, printing):
        """Move the roll; its way, depth and the force on it are noted."""

        def Note(step):
            self.material.Commit(LogStrain(Grad(self.displacement)))
            force = -self.contact.Force()
            row = {"way": self.way.Get(), "down": self.down.Get()}
            self.steps.append(row | {"along": float(force[0]), "lift": float(force[1])})

        stepper = LoadStepper(self.solver, parameter)
        stepper.Integrate(end, steps=steps, printing=printing, callback=Note)

    def Passes(self, steps, printing):
        """Both passes; returns the half thickness after each, in the middle of the way."""
        found = []
        for gap, end in zip(GAPS, (TO, BACK), strict=True):
            self.Go(self.down, (1 - gap) / 2, max(2, steps // 4), printing)
            self.Go(self.way, end - FROM, steps, printing)
            found.append(self.HalfThickness((TO + BACK) / 2))
        return found

    def HalfThickness(self, at):
        """Height of the deformed top at a place."""
        start = np.linspace(0, LENGTH, 400)
        move = np.array([self.displacement(self.mesh(s, 0.5)) for s in start])
        return float(np.interp(at, start + move[:, 0], 0.5 + move[:, 1]))

    def Volume(self):
        """Over that before."""
        F = Id(2) + Grad(self.displacement)
        return Integrate(Det(F), self.mesh, order=4) / Integrate(1, self.mesh)


def Write(mill, folder):
    rows = Columns(mill.steps)
    with Picture(folder, "rolling", 2, 1, size=(7, 5)) as (above, below):
        points, faces = Deformed(mill.displacement, mill.mesh.GetMaterials())
        above.triplot(*points.T, faces, lw=0.4, color="k")
        above.set(aspect="equal", xlabel="x", ylabel="y")
        below.plot(rows["lift"], ".-", label="upwards")
        below.plot(rows["along"], ".-", label="along")
        below.set(xlabel="step", ylabel="force on the roll")
        below.legend()
    mill.contact.WriteVTU(folder / "rolling_top", displacement=mill.displacement)


def Run(h=0.167, steps=16, friction=0.1, out=None, quiet=True):
    """Both passes; returns thicknesses, forces and the volume."""
    mill = Mill(h, friction)
    halves = mill.Passes(steps, not quiet)
    lifts = [row["lift"] for row in mill.steps]
    figures = {
        "thickness": [2 * half for half in halves],
        "volume": float(mill.Volume()),
        "peak_lift": max(lifts),
        "length": LENGTH + float(mill.displacement(mill.mesh(LENGTH, 0.0))[0]),
        "steps": len(lifts),
    }
    assert np.allclose(figures["thickness"], GAPS, atol=0.02), figures
    assert abs(figures["volume"] - 1) < 0.01, figures
    if out:
        Write(mill, out)
    if not quiet:
        print("thickness after both passes {:.4f} {:.4f}".format(*figures["thickness"]))
        print(f"volume over that before {figures['volume']:.5f}")
    return figures


main = Main(
    Run,
    __doc__,
    h=(Positive, "edge length"),
    steps=(Count, "steps along the plate, per pass"),
    friction=(NotNegative, "coefficient"),
)

if __name__ == "__main__":
    main()
