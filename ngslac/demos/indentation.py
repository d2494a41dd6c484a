"""Elastoplastic indentation: a rigid cylinder is pressed into a block and withdrawn.

Plane strain, small strains, no friction. The block (soft aluminium: E = 70 GPa, nu = 0.3, yield
stress 35 MPa) yields by von Mises with a little linear hardening; the cylinder has the radius
100 mm. Loaded until the flow is fully plastic, unloaded, loaded again. Start it with::

    python -m ngslac.demos.indentation --picture indentation.png

Compared with K. L. Johnson, Contact Mechanics (1985): onset of yield at the peak pressure 1.79 Y
(section 6.1; the number holds for nu = 0.3), mean pressure 2.97 Y (Prandtl's (2 + pi) k) of the
rigid plastic body (6.2), unloading and loading again without further yield (6.4).
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

from ngsolve import (
    CF,
    BilinearForm,
    Grad,
    GridFunction,
    InnerProduct,
    Parameter,
    Sym,
    Variation,
    VectorH1,
    dx,
)

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper

from ._command import CommandParser, RunCommand
from ._indentation_figures import Figures, Measure, Report
from ._indentation_mesh import IndentationMesh
from ._pictures import Matplotlib
from ._plasticity import J2Plasticity, PlaneStrain

__all__ = ["Problem", "Results", "Run", "main"]


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What to compute, in mm and MPa (or any other consistent units).

    Parameters
    ----------
    h : float
        Edge length in the contact zone.
    depth : float
        Largest depth of the indentation.
    steps : int
        Number of loading steps, equal in the width of the contact (depth ~ step^2). Steps that
        resolve how the contact's edge crosses the faces of the slave side change the force by up
        to 3 %.
    back : int
        Number of steps in which the cylinder is withdrawn to half the depth; it stops when it is
        free.
    radius : float
        Of the cylinder.
    young, poisson, yield_stress, hardening : float
        Of the block, see `J2Plasticity`.
    saturation, rate : float
        Voce's part of the hardening.
    zone, size : float
        Half width of the contact zone of the mesh; half width and height of the block.
    """

    h: float = 0.2
    depth: float = 0.08
    steps: int = 16
    back: int = 16
    radius: float = 100.0
    young: float = 70e3
    poisson: float = 0.3
    yield_stress: float = 35.0
    hardening: float = 70.0
    saturation: float = 0.0
    rate: float = 0.0
    zone: float = 5.0
    size: float = 40.0

    def __post_init__(self):
        for name in ("steps", "back"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} = {getattr(self, name)} must be at least 1")
        if not self.depth > 0:
            raise ValueError(f"depth = {self.depth} must be positive")

    @property
    def modulus(self):
        """Plane strain modulus of the contact; the cylinder is rigid."""
        return self.young / (1 - self.poisson**2)

    def Depths(self):
        """The depths of all steps: loading; a short way back, and on; loading again."""
        there = [self.depth * (k / self.steps) ** 2 for k in range(1, self.steps + 1)]
        back = [self.depth * (1 - 0.5 * k / self.back) for k in range(1, self.back + 1)]
        again = [self.depth * share for share in (0.85, 0.9, 0.95, 1.0)]
        return there, [0.998 * self.depth, *back], again


@dataclass
class Results:
    """Outcome of `Run`: `figures` (as in the JSON file), the steps, and the NGSolve objects.

    `curve` has one dict per converged step; `loading`, `unloading`, `reloading` are its parts.
    """

    problem: Problem
    mesh: object
    solver: object
    stepper: object
    contact: object
    material: object
    strain: object
    curve: list = field(default_factory=list)
    counts: list = field(default_factory=list)  # of the steps of each phase
    residuals: list = field(default_factory=list)  # of the last loading step
    profile: dict = field(default_factory=dict)  # at the peak: the macro-elements
    imprint: object = None  # displacement after the cylinder has left, a GridFunction
    onset: float | None = None  # peak pressure over yield stress when yield begins
    figures: dict = field(default_factory=dict)

    @property
    def loading(self):
        return self.curve[: self.counts[0]]

    @property
    def unloading(self):
        return self.curve[self.counts[0] : self.counts[0] + self.counts[1]]

    @property
    def reloading(self):
        return self.curve[self.counts[0] + self.counts[1] :]


def Model(problem):
    """Everything up to the stepper, as Results without steps; `Advance` goes on from there."""
    mesh = IndentationMesh(problem.h, radius=problem.radius, zone=problem.zone, size=problem.size)
    held = "master|back"  # the cylinder is rigid: all of its boundary is prescribed
    V = VectorH1(mesh, order=2, dirichletx=f"sym|bottom|{held}", dirichlety=f"bottom|{held}")
    X = V * LACSpace(V, slave="slave")
    (u, lam), (v, _) = X.TnT()
    material = J2Plasticity(
        mesh,
        young=problem.young,
        poisson=problem.poisson,
        yield_stress=problem.yield_stress,
        hardening=problem.hardening,
        saturation=problem.saturation,
        rate=problem.rate,
    )
    a = BilinearForm(X)
    a += Variation(material.Energy(PlaneStrain(Grad(u))) * dx("block", intrules=material.rules))
    a += problem.young * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx("cylinder")
    contact = LACContact(u, lam, master="master")
    gf = GridFunction(X)
    depth = Parameter(0.0)
    solver = ContactSolver(a, gf, contact)
    stepper = LoadStepper(solver, depth, prescribe={held: CF((0, -depth))})
    strain = PlaneStrain(Grad(gf.components[0]))
    return Results(problem, mesh, solver, stepper, contact, material, strain)


def Advance(results, depths, *, quiet=True, maxit=30):
    """Go through these depths until the cylinder is free.

    The state of the material is committed after every converged step, which is then measured.
    """

    def Accept(step):
        results.material.Commit(results.strain)
        row = Measure(results) | {"iterations": step.iterations, "cuts": step.cuts}
        results.curve.append(row)
        if not quiet:
            print(
                f"  depth {row['depth']:.5f}  force {row['force']:9.3f}  "
                f"mean pressure {row['mean_pressure']:8.3f}  "
                f"{step.iterations} Newton iterations",
                flush=True,
            )

    for depth in depths:
        results.stepper.Integrate(end=depth, steps=1, callback=Accept, printing=False, maxit=maxit)
        if depth < max(row["depth"] for row in results.curve) and not results.curve[-1]["closed"]:
            return


def Onset(problem):
    """Peak pressure over yield stress when yield begins.

    In the elastic state all stresses grow together: one step on a block that does not yield tells
    the ratio of the peak pressure to the largest von Mises stress. The contact is small against the
    block, and wide against the mesh.
    """
    zone = 0.3 * problem.zone
    elastic = replace(
        problem, h=0.5 * problem.h, zone=zone, size=2.5 * problem.size, yield_stress=problem.young
    )
    results = Model(elastic)
    Advance(results, [1.5 * zone**2 / problem.radius])
    return results.curve[0]["peak_pressure"] / results.curve[0]["mises"]


def Run(*, picture=None, quiet=True, **options):
    """Compute the problem.

    Parameters
    ----------
    picture : str or path, optional
        File for the picture.
    quiet : bool
        Print nothing.
    **options
        The fields of `Problem`.

    Returns
    -------
    Results
        With ``results.figures``, the dict that is written to the JSON file.
    """
    problem = Problem(**options)
    if picture is not None:
        Matplotlib()  # complain before the work, not after it
    start = time.perf_counter()
    # A problem this small gains nothing from threads.
    results = Model(problem)
    loading, unloading, reloading = problem.Depths()
    for depths in (loading, unloading, reloading):
        before = len(results.curve)
        Advance(results, depths, quiet=quiet)
        results.counts.append(len(results.curve) - before)
        displacement = results.solver.gf.components[0]
        if depths is loading:
            results.residuals = [entry.equilibrium for entry in results.solver.history]
            results.profile = results.contact.Table() | {"force": results.curve[-1]["force"]}
        elif depths is unloading:
            results.imprint = GridFunction(displacement.space)
            results.imprint.vec.data = displacement.vec
    results.onset = Onset(problem)
    results.figures = Figures(results, time.perf_counter() - start)
    if not quiet:
        print(Report(results))
    if picture is not None:
        from ._indentation_pictures import IndentationPicture

        IndentationPicture(results, picture)
    return results


def _Parser():
    parser = CommandParser("indentation", __doc__)
    add = parser.add_argument
    add("--h", type=float, default=0.2, help="edge length in the contact zone, in mm")
    add("--depth", type=float, default=0.08, help="largest depth, in mm")
    add("--steps", type=int, default=16, help="number of loading steps")
    add("--yield-stress", type=float, default=35.0, help="in MPa")
    add("--hardening", type=float, default=70.0, help="slope of the yield stress, in MPa")
    add("--picture", metavar="PNG", help="write a picture to this file")
    return parser


def main(argv=None):
    """Run the demo from the command line."""
    RunCommand(Run, vars(_Parser().parse_args(argv)))


if __name__ == "__main__":
    main()
