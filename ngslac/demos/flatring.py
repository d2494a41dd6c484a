"""Self-contact: a rubber ring is pressed flat between two rigid plates until its inside touches.

Plane strain, neo-Hookean, finite sliding with friction. The inside of the ring is slave and master
at once. The right half is computed; by symmetry the inside then touches like a quarter of the ring
on a rigid plane through the middle (``quarter=True``), which is contact of two bodies. Start it
with::

    python -m ngslac.demos.flatring --out results

Lengths in radii of the ring, stresses in shear moduli.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from netgen.occ import Circle, Compound, MoveTo, OCCGeometry, Y
from ngsolve import (
    CF,
    BilinearForm,
    Det,
    Grad,
    GridFunction,
    Id,
    InnerProduct,
    Mesh,
    Parameter,
    Variation,
    VectorH1,
    dx,
    log,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.meshes.geometry import CheckPositive

from ._command import CommandParser, RunCommand
from ._pictures import Matplotlib, Save

__all__ = ["Model", "Results", "Run", "main"]

PLATE = 0.2  # thickness
LAME = 3.0  # first Lame parameter over the shear modulus


def RingMesh(h, thickness, quarter):
    """The right half of the ring (or a quarter) between plates, not matching them."""
    lower = 0 if quarter else -2
    ring = Circle((0, 0), 1).Face() - Circle((0, 0), 1 - thickness).Face()
    ring = ring * MoveTo(0, lower).Rectangle(2, 2 - lower).Face()
    for edge in ring.edges:
        x, y, _ = edge.center
        ends = [np.hypot(p.x, p.y) for p in (edge.start, edge.end)]
        edge.name = "outer" if min(ends) > 1 - thickness / 2 else "inner"
        if abs(x) < 1e-9:
            edge.name = "axis"
        elif quarter and abs(y) < 1e-9:
            edge.name = "middle"
    plates = [MoveTo(0, 1).Rectangle(2.2, PLATE).Face()]
    # The normals of the inside meet in the middle: the floor goes on beyond it.
    plates.append(MoveTo(-0.3, (0 if quarter else -1) - PLATE).Rectangle(2.5, PLATE).Face())
    for face, name, side in zip(plates, ("top", "bottom"), (Y, -Y), strict=True):
        face.faces.name = name
        face.edges.name = "fixed"
        face.edges.Min(side).name = "floor" if quarter and name == "bottom" else "plate"
    ring.faces.name = "ring"
    geometry = OCCGeometry(Compound([ring, *plates]), dim=2)
    return Mesh(geometry.GenerateMesh(maxh=h)).Curve(2)


class Model:
    """Ring, plates and solver.

    Parameters
    ----------
    h : float
        Edge length.
    thickness : float
        Of the ring.
    friction : float
        Coefficient, of plates and inside.
    quarter : bool
        The inside touches a rigid plane through the middle in place of itself.
    """

    def __init__(self, *, h=0.12, thickness=0.15, friction=0.2, quarter=False):
        CheckPositive(h=h, thickness=thickness)
        self.mesh, self.quarter = RingMesh(h, thickness, quarter), quarter
        flags = {"dirichletx": "axis"} | ({"dirichlety": "middle"} if quarter else {})
        self.displacement = VectorH1(
            self.mesh, order=2, dirichlet="fixed|plate" + ("|floor" if quarter else ""), **flags
        )
        inside = LACSpace(self.displacement, slave="inner")
        outside = LACSpace(self.displacement, slave="outer")
        space = self.displacement * inside * outside
        u, lam_inside, lam_outside = space.TrialFunction()
        F = Id(2) + Grad(u)
        energy = (InnerProduct(F, F) - 2) / 2 - log(Det(F)) + LAME / 2 * log(Det(F)) ** 2
        a = BilinearForm(space)
        a += Variation(energy.Compile() * dx)
        self.gf = GridFunction(space)
        # By symmetry the two sides of the inside do not rub, but they would rub on a plane.
        self.inside = LACContact(
            u,
            lam_inside,
            master="floor" if quarter else "inner",
            friction=None if quarter else friction,
            penetration=thickness / 2,
            finite=True,
        )
        self.outside = LACContact(u, lam_outside, master="plate", friction=friction, finite=True)
        self.load, self.rows = Parameter(0), []
        self.top = np.fromiter(self.displacement.GetDofs(self.mesh.Materials("top")), dtype=bool)
        solver = ContactSolver(a, self.gf, [self.inside, self.outside])
        self.stepper = LoadStepper(solver, self.load, prescribe=self._MovePlate)

    def _MovePlate(self, gf):
        plate = GridFunction(self.displacement)
        way = self.load.Get() / (2 if self.quarter else 1)
        plate.Set(CF((0, -way)), definedon=self.mesh.Materials("top"))
        gf.components[0].vec.FV().NumPy()[self.top] = plate.vec.FV().NumPy()[self.top]

    def Integrate(self, travel, steps, printing=False):
        """Bring the plates together by `travel` in equal steps."""
        self.stepper.Integrate(travel, steps=steps, printing=printing, callback=self._Record)

    def _Record(self, step):
        forces = self.outside.form.Vectors("force").reshape(-1, 2)[:, 1]
        heights = self.outside.Table()["x"][:, 1]
        above = heights > (-np.inf if self.quarter else heights.mean())
        inner = self.inside.form.Vectors("force").reshape(-1, 2)[:, 1]
        self.rows.append(
            {
                "travel": step.time,
                "force": float(-forces[above].sum()),
                "force_below": float(forces[~above].sum()),
                "force_inside": float(np.abs(inner).sum()),
                "closed_inside": int(np.sum(self.inside.Table()["status"] > 0)),
                "iterations": step.iterations,
                "cuts": step.cuts,
            }
        )


@dataclass
class Results:
    """Outcome of `Run`: the model, and `figures` as in the JSON file (forces in G R)."""

    model: Model
    figures: dict = field(default_factory=dict)


def Run(*, travel=1.71, steps=38, out=None, quiet=True, **options):
    """Press the ring flat.

    Parameters
    ----------
    travel : float
        By which the plates approach each other; the inside touches at about 1.68.
    steps : int
        Number of equal load steps.
    out : str or path, optional
        Directory for the picture.
    quiet : bool
        Print nothing.
    **options
        Those of `Model`.

    Returns
    -------
    Results

    Raises
    ------
    ContactConvergenceError
        The plates came too near.
    """
    if out is not None:
        Matplotlib()  # complain before the work, not after it
    start = time.perf_counter()
    model = Model(**options)
    model.Integrate(travel, steps, printing=not quiet)
    figures = {name: [row[name] for row in model.rows] for name in model.rows[0]}
    figures |= {"steps": steps, "converged_steps": len(model.rows)}
    figures["seconds"] = time.perf_counter() - start
    if out is not None:
        Picture(model, figures, Path(out) / "flatring.png")
    if not quiet:
        force, inside = figures["force"][-1], figures["force_inside"][-1]
        print(f"force on the plate {force:.5g} G R, on the inside {inside:.5g} G R")
    return Results(model, figures)


def Picture(model, figures, file):
    """The deformed mesh, and the force over the travel."""
    mpl = Matplotlib()
    fig = mpl.figure.Figure(figsize=(11, 4.2))
    left, right = fig.subplots(1, 2)
    for element in model.mesh.Elements():
        corners = np.array([model.mesh[v].point for v in element.vertices])
        moved = [p + np.array(model.gf.components[0](model.mesh(*p))) for p in corners]
        left.fill(*zip(*moved, strict=True), fc="0.9", ec="k", lw=0.4)
    left.set_aspect("equal")
    left.set_title("deformed mesh")
    right.semilogy(figures["travel"], figures["force"], "o-", ms=3, label="plate")
    touching = np.array(figures["force_inside"])
    right.semilogy(figures["travel"], np.where(touching > 0, touching, np.nan), "s", label="inside")
    right.set_xlabel("travel / R")
    right.set_ylabel("force / (G R)")
    right.legend()
    file.parent.mkdir(parents=True, exist_ok=True)
    Save(fig, file)


def main(argv=None):
    """Run the demo from the command line."""
    parser = CommandParser("flatring", __doc__)
    add = parser.add_argument
    add("--h", type=float, default=0.12, help="edge length")
    add("--steps", type=int, default=38, help="load steps")
    add("--travel", type=float, default=1.71, help="of the plates")
    add("--friction", type=float, default=0.2, help="coefficient")
    add("--quarter", action="store_true", help="a rigid plane in the middle")
    add("--out", metavar="DIR", help="write the picture to this directory")
    RunCommand(Run, vars(parser.parse_args(argv)))


if __name__ == "__main__":
    main()
