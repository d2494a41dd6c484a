"""Hertz in 3D: a sphere or a cylinder pressed on a block.

Small strains. A body of radius 50 mm (E = 210 GPa) is pressed on a block (E = 70 GPa), nu = 0.3,
without friction. The forces are so low (contact radius 2.5 mm) that Hertz' half-spaces are a good
model of both bodies. Start it with::

    python -m ngslac.demos.hertz3d --out results

The sphere has Hertz' point contact. The cylinder is a slice of a long one (plane strain), meshed
with prisms, and has Hertz' line contact.
"""

from __future__ import annotations

import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from ngsolve import BilinearForm, GridFunction, Parameter, Sym, TaskManager
from ngsolve import Grad as Gradient

from ngslac import ContactSolver, LACContact, LACSpace, LoadStepper

from ._command import CommandParser, RunCommand
from ._hertz3d_figures import Figures, Report
from ._hertz3d_macros import Macros
from ._hertz3d_pictures import Write
from ._hertz3d_problem import Displacements, Form, Problem, Stress
from ._pictures import Matplotlib

__all__ = ["Problem", "Results", "Run", "State", "main"]


@dataclass(frozen=True)
class State:
    """A converged load step; macro-elements in the order of the space, in mm and MPa."""

    time: float
    iterations: int
    pressure: np.ndarray
    status: np.ndarray
    force: float  # contact force over the load of this step


@dataclass
class Results:
    """Outcome of `Run`: `figures` (as in the JSON file), the states, and the NGSolve objects."""

    problem: Problem
    mesh: object
    displacement: GridFunction
    solution: GridFunction
    contact: object
    stress: object
    macros: Macros
    states: list = field(default_factory=list)
    figures: dict = field(default_factory=dict)
    seconds: dict = field(default_factory=dict)  # per phase

    @contextmanager
    def Phase(self, name):
        """Add the time of what is done in it."""
        start = time.perf_counter()
        yield
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start


def _Model(problem):
    """Everything up to the stepper, and the pairing."""
    results = Results(problem, *[None] * 6)
    with results.Phase("mesh"):
        V = Displacements(problem, problem.Mesh())
    with results.Phase("spaces"):
        mesh, Q = V.mesh, LACSpace(V, slave="slave")
        X = V * Q
        (u, lam), (v, _) = X.TnT()
        load = Parameter(0.0)
        a = BilinearForm(X)
        a += Form(problem, mesh, u, v, load)
        gf = GridFunction(X)
        displacement = gf.components[0]
        results.mesh, results.solution, results.displacement = mesh, gf, displacement
        results.stress = Stress(problem, mesh, Sym(Gradient(displacement)))
        line = problem.shape == "cylinder"
        results.macros = Macros(mesh, Q.macros, line, problem.frame, problem.length)
    with results.Phase("pairing"), TaskManager():
        results.contact = LACContact(u, lam, master="master", friction=problem.friction or None)
        results.contact.Update()
    solver = ContactSolver(a, gf, results.contact, inverse=problem.inverse)
    return LoadStepper(solver, load), results


def Run(*, out=None, quiet=True, **options):
    """Compute the problem.

    Parameters
    ----------
    out : str or path, optional
        Directory for pictures, scenes and VTU files.
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
    if out is not None and (problem.length, problem.stress) != (1.0, 1.0):
        raise ValueError("pictures are drawn in mm and MPa: leave out the units")
    if out is not None:
        Matplotlib()  # complain before the work, not after it

    def Record(step):
        results.states.append(_State(results, step))
        if not quiet:
            print(f"  t = {step.time:.3f}   {step.iterations} Newton iterations", flush=True)

    stepper, results = _Model(problem)
    if not quiet:
        size = len(results.solution.vec)
        print(f"{results.mesh.ne} elements, {size} unknowns", flush=True)
    with results.Phase("solution"), TaskManager():
        stepper.Integrate(steps=problem.steps, callback=Record, printing=False)
    results.figures = Figures(results)
    if not quiet:
        print(Report(results))
    if out is not None:
        Write(results, Path(out))
    return results


def _State(results, step):
    """Copy what is needed of a converged step."""
    problem, table = results.problem, results.contact.Table()
    force = problem.frame[2] @ np.asarray(results.contact.Force()) / (problem.load * step.time)
    pressure = table["pressure"] / problem.stress
    return State(step.time, step.iterations, pressure, table["status"], float(force))


# ---------------------------------------------------------------- command line


def _Parser():
    parser = CommandParser("hertz3d", __doc__)
    add = parser.add_argument
    add("--shape", choices=("sphere", "cylinder"), default="sphere")
    add("--model", choices=("quarter", "full"), default="quarter")
    add("--order", type=int, choices=(1, 2, 3), default=2, help="order of the displacement")
    add("--h", type=float, default=0.3125, help="size of the slave faces, in mm")
    add("--friction", type=float, default=0.0, help="coefficient of friction")
    add("--steps", type=int, default=1, help="number of load steps")
    add("--stabilize", choices=("split", "bubble", "none"), default="none")
    add("--inverse", help="sparse direct solver, such as umfpack or pardiso")
    add("--out", metavar="DIR", help="write pictures, scenes and VTU files to this directory")
    return parser


def main(argv=None):
    """Run the demo from the command line."""
    RunCommand(Run, vars(_Parser().parse_args(argv)))


if __name__ == "__main__":
    main()
