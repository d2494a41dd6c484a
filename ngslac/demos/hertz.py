"""The frictional Hertz problem of the LAC paper: a cylinder pressed on a block.

Plane strain, small strains. Cylinder of diameter 100 mm (E = 210 GPa) on a block of side 200 mm
(E = 70 GPa), nu = 0.3, friction 0.2, loaded by a force of 35 kN/mm at its top in 10 equal steps.
Half of it is computed. Start it with::

    python -m ngslac.demos.hertz --out results

Hertz' solution has no friction. Friction raises the pressure at the origin by about 1.6 %.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from ngsolve import (
    CF,
    BilinearForm,
    GridFunction,
    Id,
    InnerProduct,
    Parameter,
    Sym,
    TaskManager,
    Trace,
    VectorH1,
    ds,
    dx,
)
from ngsolve import Grad as Gradient

from ngslac import BubbleVectorH1, ContactSolver, LACContact, LACSpace, LoadStepper, SplitSlaveFaces
from ngslac.meshes.hertz import HertzMesh
from ngslac.reference import HertzLine

from ._command import CommandParser, RunCommand
from ._hertz_figures import Figures, Macros, Report, Spans, Write
from ._pictures import Matplotlib

__all__ = ["Problem", "Results", "Run", "State", "main"]

YOUNG = {"cylinder": 210e3, "block": 70e3}  # MPa
POISSON = 0.3
RADIUS = 50.0  # mm
FORCE = 35e3  # N/mm


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What to compute.

    Parameters
    ----------
    order : int
        Order of the displacement.
    h : float
        Edge length in the contact zone, in mm.
    friction : float
        Coefficient of friction.
    steps : int
        Number of equal load steps.
    stabilize : {"none", "bubble", "split"}
        "bubble" adds a displacement bubble on every slave face, "split" divides the slave faces.
        Order 1 without them has macro-elements of two faces.
    half : bool
        Half model. The full one needs no symmetry condition and can therefore be rotated.
    length, stress : float
        Units of the computation: one millimetre and one MPa expressed in them, e.g. ``1e-3`` and
        ``1e6`` to compute in metres and pascals. Results are in mm and MPa.
    angle : float
        Rotation of the whole problem, in degrees.
    """

    order: int = 2
    h: float = 0.5
    friction: float = 0.2
    steps: int = 10
    stabilize: str = "none"
    half: bool = True
    length: float = 1.0
    stress: float = 1.0
    angle: float = 0.0

    def __post_init__(self):
        if self.stabilize not in ("none", "bubble", "split"):
            raise ValueError(f"stabilize must be none, bubble or split, not {self.stabilize!r}")
        if self.half and self.angle:
            raise ValueError("the half model cannot be rotated: use half=False")

    @property
    def frame(self):
        """Unit vectors of the x and the y direction of the problem, as rows."""
        c, s = math.cos(math.radians(self.angle)), math.sin(math.radians(self.angle))
        return np.array([[c, s], [-s, c]])

    @property
    def load(self):
        """Total force on the model."""
        return FORCE * self.length * self.stress * (0.5 if self.half else 1.0)

    def Hertz(self, t=1.0):
        """Hertz' solution at the load factor t, in mm and MPa."""
        cylinder, block = YOUNG["cylinder"], YOUNG["block"]
        return HertzLine(
            force=FORCE * t, radius1=RADIUS, young1=cylinder, nu1=POISSON, young2=block, nu2=POISSON
        )


@dataclass(frozen=True)
class State:
    """A converged load step; macro-elements are ordered by x, in mm and MPa."""

    time: float
    iterations: int
    macros: dict  # arrays: start, end, pressure, traction (tangential), status
    force: float  # contact force over the load of this step
    vector: object  # of the solution


@dataclass
class Results:
    """Outcome of `Run`: `figures` (as in the JSON file), the states, and the NGSolve objects."""

    problem: Problem
    mesh: object
    displacement: GridFunction
    solution: GridFunction
    contact: object
    stress: object
    spans: np.ndarray  # start and end x of each macro-element, in mm
    states: list = field(default_factory=list)
    figures: dict = field(default_factory=dict)

    def At(self, t):
        """The state at time t, or None."""
        return next((s for s in self.states if abs(s.time - t) < 1e-9), None)


# ---------------------------------------------------------------- the problem


def Stress(problem, mesh, strain):
    """Stress of plane strain."""
    young = mesh.MaterialCF({name: E * problem.stress for name, E in YOUNG.items()})
    mu = young / (2 * (1 + POISSON))
    return 2 * mu * (strain + POISSON / (1 - 2 * POISSON) * Trace(strain) * Id(2))


def _Displacements(problem):
    """Mesh and displacement space with the conditions at the bottom and on the symmetry line."""
    mesh = HertzMesh(
        problem.h,
        order=max(2, problem.order),
        half=problem.half,
        scale=problem.length,
        angle=problem.angle,
    )
    if problem.stabilize == "split":
        mesh = SplitSlaveFaces(mesh, "slave")
    fixed = {"dirichletx": "bottom|sym", "dirichlety": "bottom"}
    if problem.stabilize == "bubble":
        return mesh, BubbleVectorH1(mesh, order=problem.order, slave="slave", **fixed)
    return mesh, VectorH1(mesh, order=problem.order, **fixed)


def _Form(problem, mesh, u, v, load):
    """Elasticity and the nodal force at the top of the cylinder."""
    right, up = (CF(tuple(direction)) for direction in problem.frame)
    # The force points down. As a vector for ContactSolver(rhs=...) it is PointForce(X, ...).
    top = ds(definedon=mesh.BBoundaries("load"))
    form = InnerProduct(Stress(problem, mesh, Sym(Gradient(u))), Sym(Gradient(v))) * dx
    form += load * problem.load * InnerProduct(up, v) * top
    if not problem.half:  # springs against rolling, without force by symmetry
        axis = ds(definedon=mesh.BBoundaries("load|foot"))
        spring = YOUNG["cylinder"] * problem.stress
        form += spring * InnerProduct(right, u) * InnerProduct(right, v) * axis
    return form


def _Model(problem):
    """Everything up to the stepper."""
    mesh, V = _Displacements(problem)
    Q = LACSpace(V, slave="slave")
    X = V * Q
    (u, lam), (v, _) = X.TnT()
    load = Parameter(0.0)
    a = BilinearForm(X)
    a += _Form(problem, mesh, u, v, load)
    contact = LACContact(u, lam, master="master", friction=problem.friction or None)
    gf = GridFunction(X)
    stepper = LoadStepper(ContactSolver(a, gf, contact), load)
    displacement = gf.components[0]
    stress = Stress(problem, mesh, Sym(Gradient(displacement)))
    spans = Spans(problem, mesh, Q.macros)
    return stepper, Results(problem, mesh, displacement, gf, contact, stress, spans)


def Run(*, out=None, quiet=True, **options):
    """Compute the problem.

    Parameters
    ----------
    out : str or path, optional
        Directory for pictures and the VTU file.
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
    if out is not None and (problem.length, problem.stress, problem.angle) != (1.0, 1.0, 0.0):
        raise ValueError(
            "pictures are drawn in mm and MPa without rotation: leave out these options"
        )
    if out is not None:
        Matplotlib()  # complain before the work, not after it
    start = time.perf_counter()

    def Record(step):
        results.states.append(_State(results, step))
        if not quiet:
            print(f"  t = {step.time:.3f}   {step.iterations} Newton iterations", flush=True)

    with TaskManager():
        stepper, results = _Model(problem)
        stepper.Integrate(steps=problem.steps, callback=Record, printing=False)
    results.figures = Figures(results, time.perf_counter() - start)
    if not quiet:
        print(Report(results))
    if out is not None:
        Write(results, Path(out))
    return results


# ---------------------------------------------------------------- evaluation


def _State(results, step):
    """Copy what is needed of a converged step."""
    problem, contact = results.problem, results.contact
    force = problem.frame[1] @ np.asarray(contact.Force()) / (problem.load * step.time)
    macros = Macros(problem, contact.Table(), results.spans)
    vector = results.solution.vec.CreateVector(copy=True)
    return State(step.time, step.iterations, macros, float(force), vector)


def _Parser():
    parser = CommandParser("hertz", __doc__)
    add = parser.add_argument
    add("--order", type=int, choices=(1, 2, 3), default=2, help="order of the displacement")
    add("--h", type=float, default=0.5, help="edge length in the contact zone, in mm")
    add("--friction", type=float, default=0.2, help="coefficient of friction")
    add("--steps", type=int, default=10, help="number of load steps")
    add("--stabilize", choices=("split", "bubble", "none"), default="none")
    add("--full", action="store_true", help="full model in place of the half")
    add("--out", metavar="DIR", help="write pictures and a VTU file to this directory")
    return parser


def main(argv=None):
    """Run the demo from the command line."""
    options = vars(_Parser().parse_args(argv))
    options["half"] = not options.pop("full")
    RunCommand(Run, options)


if __name__ == "__main__":
    main()
