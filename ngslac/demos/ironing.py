"""Shallow ironing: a die is pressed into a slab and drawn over it with friction.

Plane strain, neo-Hookean bodies (die 6896 MPa, slab 689.6 MPa, nu = 0.32), friction 0.3. The top of
the die goes down by 1 mm, of which 0.2 mm are clearance, and then 10 mm to the right: the surfaces
slide over dozens of faces. After Fischer and Wriggers (2006); start it with::

    python -m ngslac.demos.ironing --out results

The published forces differ from each other by up to 25 % (vertical) and 90 % (horizontal). Those
computed here are 333 and 423 N/mm down after the indentation and in the middle of the stroke, with
131 N/mm to the right, and change by less than 1 % on finer meshes.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from ngsolve import (
    BilinearForm,
    Grad,
    GridFunction,
    Id,
    Parameter,
    Variation,
    VectorH1,
    dx,
)

from ngslac import ContactConvergenceError, ContactSolver, LACContact, LACSpace, LoadStepper
from ngslac.materials import NeoHooke

from ._command import CommandParser, RunCommand
from ._ironing_figures import Figures, Report
from ._ironing_mesh import IroningMesh
from ._ironing_motion import RigidMotion
from ._ironing_pictures import OverviewPicture, Write
from ._pictures import Matplotlib

__all__ = ["Problem", "Results", "Run", "State", "Target", "main"]

YOUNG = {"die": 6896.0, "slab": 689.6}  # MPa
POISSON = 0.32
DEPTH, STROKE = 1.0, 10.0  # of the top of the die from the time 0 to 1 and 1 to 2, in mm


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What to compute.

    Parameters
    ----------
    h : float
        Edge length on the top of the slab, in mm.
    order : int
        Order of the displacement, at least 2.
    friction : float
        Coefficient of friction.
    steps : int
        Number of load steps; the indentation takes as many as 2.5 mm of the stroke, a fifth of all.
        Each should move the die by about half an edge of the slab at most: larger ones can end in
        another equilibrium, with crumpled elements.
    stroke : float
        Way of the die to the right, in mm: the full one, or less.
    """

    h: float = 0.3
    order: int = 2
    friction: float = 0.3
    steps: int = 80
    stroke: float = STROKE

    def __post_init__(self):
        if self.steps < 2:
            raise ValueError(f"steps = {self.steps} must be at least 2")
        if not 0 < self.stroke <= STROKE:
            raise ValueError(f"stroke = {self.stroke} must be in (0, {STROKE:g}]")
        if self.order < 2:
            raise ValueError(f"order = {self.order} must be at least 2")

    @property
    def parts(self):
        """Numbers of steps of the indentation and of the stroke."""
        down = min(max(1, round(self.steps * 2.5 / (2.5 + self.stroke))), self.steps - 1)
        return down, self.steps - down

    @property
    def times(self):
        """Ends of both parts."""
        return 1.0, 1.0 + self.stroke / STROKE


@dataclass(frozen=True)
class State:
    """A converged step."""

    time: float  # 0 to 1: down, 1 to 2: right
    iterations: int
    cuts: int
    force: np.ndarray  # of the die on the slab, in N/mm: (to the right, downwards)
    residuals: tuple  # of the iterations: the larger one of equilibrium and constraint
    counts: tuple  # macro-elements open, stick, slip
    vector: object = field(repr=False)  # of the solution


@dataclass
class Results:
    """Outcome of `Run`: `figures` (as in the JSON file), the states, and the NGSolve objects."""

    problem: Problem
    mesh: object
    displacement: GridFunction
    solution: GridFunction
    contact: object
    stepper: LoadStepper
    states: list = field(default_factory=list)
    failure: str | None = None
    figures: dict = field(default_factory=dict)


# ---------------------------------------------------------------- the problem


def Target(t):
    """Displacement of the top of the die at the time t."""
    return STROKE * max(t - 1.0, 0.0), -DEPTH * min(t, 1.0)


def _Model(problem):
    """Everything up to the stepper."""
    mesh = IroningMesh(problem.h, order=problem.order)
    V = VectorH1(mesh, order=problem.order, dirichlet="bottom|top")
    X = V * LACSpace(V, slave="foot|flank")
    u, lam = X.TrialFunction()
    young = mesh.MaterialCF(YOUNG)
    a = BilinearForm(X)
    a += Variation(NeoHooke(Id(2) + Grad(u), young, POISSON).Compile() * dx)
    load = Parameter(0.0)
    # Steps begin with the die moved into the slab: see the slab through all of the die's foot.
    contact = LACContact(
        u,
        lam,
        master="master",
        friction=problem.friction or None,
        finite=True,
        penetration=DEPTH,
    )
    gf = GridFunction(X)
    motion = RigidMotion(V, body="die", driven="top", target=lambda: Target(load.Get()))
    stepper = LoadStepper(ContactSolver(a, gf, contact), load, prescribe=motion)
    return Results(problem, mesh, gf.components[0], gf, contact, stepper)


def Run(*, out=None, picture=None, quiet=True, printing=False, **options):
    """Compute the problem.

    Parameters
    ----------
    out : str or path, optional
        Directory for pictures and the VTU file.
    picture : str or path, optional
        File for one picture with deformed states and forces.
    quiet, printing : bool
        Print nothing; print each Newton iteration.
    **options
        The fields of `Problem`.

    Returns
    -------
    Results
        With ``results.figures``, the dict that is written to the JSON file. A run that stops on the
        way has the reason in ``results.failure`` and the states up to there.
    """
    problem = Problem(**options)
    if out is not None or picture is not None:
        Matplotlib()  # complain before the work, not after it
    start = time.perf_counter()
    results = _Model(problem)

    def Record(step):
        results.states.append(_State(results, step))
        if not quiet:
            _Print(results.states[-1])

    try:
        # Without a TaskManager: a thousand unknowns are too few to share the work.
        for end, steps in zip(problem.times, problem.parts, strict=True):
            results.stepper.Integrate(end=end, steps=steps, callback=Record, printing=printing)
    except ContactConvergenceError as error:
        results.failure = str(error)
    results.figures = Figures(results, time.perf_counter() - start)
    if not quiet:
        print(Report(results))
    if out is not None:
        Write(results, Path(out))
    if picture is not None and results.states:
        OverviewPicture(results, picture)
    return results


def _State(results, step):
    """Copy what is needed of a converged step."""
    history = results.stepper.solver.history
    right, up = results.contact.Force()  # on the die, which is the slave
    return State(
        step.time,
        step.iterations,
        step.cuts,
        np.array([-right, up]),
        tuple(max(entry.equilibrium, entry.constraint) for entry in history),
        (history[-1].open, history[-1].stick, history[-1].slip),
        results.solution.vec.CreateVector(copy=True),
    )


def _Print(state):
    right, down = state.force
    print(
        f"  t = {state.time:.3f}   vertical {down:7.2f}   horizontal {right:7.2f}   "
        f"open {state.counts[0]:2d}  stick {state.counts[1]:2d}  slip {state.counts[2]:2d}   "
        f"{state.iterations} iterations" + (f", {state.cuts} cuts" if state.cuts else ""),
        flush=True,
    )


def _Parser():
    parser = CommandParser("ironing", __doc__)
    add = parser.add_argument
    add("--h", type=float, default=0.3, help="edge length on the top of the slab, in mm")
    add("--order", type=int, choices=(2, 3), default=2, help="order of the displacement")
    add("--friction", type=float, default=0.3, help="coefficient of friction")
    add("--steps", type=int, default=80, help="number of load steps")
    add("--picture", metavar="PNG", help="draw deformed states and forces into this file")
    add("--stroke", type=float, default=STROKE, help="way of the die to the right, in mm")
    add("--out", metavar="DIR", help="write pictures and a VTU file to this directory")
    add("--printing", action="store_true", help="print every Newton iteration")
    return parser


def main(argv=None):
    """Run the demo from the command line."""
    RunCommand(Run, vars(_Parser().parse_args(argv)))


if __name__ == "__main__":
    main()
