"""Cattaneo and Mindlin in 3D: a sphere on a block, pressed and then pushed sideways.

Small strains, the same material in both bodies (E = 70 GPa, nu = 0.3), friction 0.3; the half y >=
0 is computed. The upper side of the half sphere goes down, then along x until most of the contact
slips, then partly back. Computed are the curve of force and displacement with its hysteresis, the
stick zone and the tractions. Start it with::

    python -m ngslac.demos.cattaneo3d --out results

Mindlin's solution assumes tractions along the load, although slip also has a component across it
unless nu = 0. Computed tractions turn to the slip: at nu = 0.3 they have a component across of
about a twentieth of friction times the peak pressure (figure "lateral", best seen with ``--smooth
--elements 6``), and hardly a different resultant.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ngslac.meshes.geometry import CheckPositive
from ngslac.reference import CattaneoMindlinPoint

from ._command import RunCommand
from ._friction3d import Model, Sphere
from ._friction3d_figures import (
    BulkCompliance,
    Faces,
    Parser,
    Row,
    Summary,
    Table,
)
from ._friction3d_pictures import Write
from ._pictures import INK, Matplotlib

__all__ = ["Problem", "Results", "Run", "main"]


FIRST = 0.01  # tangential force of the first step over friction times normal force


@dataclass(frozen=True, kw_only=True)
class Problem(Sphere):
    """What to compute: the fields of `Sphere`, and the path of the load.

    Parameters
    ----------
    shear : float
        Largest tangential force over friction times normal force, less than 1.
    steps : int
        Steps of the loading, of equal displacement. A step to a hundredth of friction times normal
        force, which tells the stiffness before slip, comes first.
    reverse : int
        Steps back from there, to half the opposite force; 0: none.
    """

    model: str = "half"
    elements: float = 4.0
    stabilize: str = "bubble"
    steps: int = 5
    shear: float = 0.95
    reverse: int = 2

    def __post_init__(self):
        super().__post_init__()
        CheckPositive(steps=self.steps, shear=self.shear)
        if self.model == "quarter":
            raise ValueError('a shift has one plane of symmetry: use model="half" or "full"')
        if self.shear >= 1:
            raise ValueError(f"shear = {self.shear} must be less than 1: the sphere would slide")

    def Partial(self, force, shear):
        """Mindlin's solution for a normal and a tangential force."""
        return CattaneoMindlinPoint(hertz=self.Hertz(force), shear=shear, friction=self.friction)

    def Path(self, force):
        """Solutions to aim at, at a normal force: up to the largest shear, and back."""
        limit = self.friction * force
        top = self.Partial(force, -self.shear * limit)
        parts = np.arange(1, self.steps + 1) / self.steps
        up = [
            CattaneoMindlinPoint.FromShift(
                hertz=top.hertz, shift=part * top.shift, friction=self.friction
            )
            for part in parts
        ]
        back = np.arange(1, self.reverse + 1) / max(1, self.reverse)
        first = self.Partial(force, -FIRST * limit)
        return [first] + up + [top.Reverse(top.shear * (1 - 1.5 * part)) for part in back]


@dataclass
class Results:
    """Outcome of `Run`: `figures` (as in the JSON file), the model with its states, the path.

    `exact` has the exact solution of each step with the force that was computed.
    """

    problem: Problem
    model: Model
    faces: Faces
    exact: list = field(default_factory=list)
    figures: dict = field(default_factory=dict)

    @property
    def states(self):
        """The states of the tangential load, without the first small step."""
        return self.model.states[self.problem.press + 1 :]


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
    if out is not None:
        Matplotlib()  # complain before the work, not after it
    start = time.perf_counter()
    model = Model(problem)
    results = Results(problem, model, Faces.Of(model))
    if not quiet:
        print(f"{model.mesh.ne} elements, {len(model.solution.vec)} unknowns", flush=True)

    def Record(state):
        if not quiet:
            fx, _, fz = state.force
            print(
                f"  P = {fz:9.3f} N   Q/(F P) = {-fx / (problem.friction * fz):7.4f}   "
                f"{state.iterations} Newton iterations",
                flush=True,
            )

    force = model.Press(Record).force[2]
    compliance = BulkCompliance(model)
    ends = [-exact.shift - compliance * exact.shear for exact in problem.Path(force)]
    model.Shift(*ends, callback=Record)
    results.figures = _Figures(results, compliance, time.perf_counter() - start)
    if not quiet:
        print(Report(results))
    if out is not None:
        Write(results, Path(out), "cattaneo3d", Curve)
    return results


# ---------------------------------------------------------------- evaluation


def _Exact(problem, states):
    """Mindlin's solutions for the computed forces."""
    exact = [problem.Partial(s.force[2], s.force[0]) for s in states[: problem.steps]]
    return exact + [exact[-1].Reverse(s.force[0]) for s in states[problem.steps :]]


def _Rows(results, compliance):
    """Figures of all steps."""
    problem, rows = results.problem, []
    for k, (state, exact) in enumerate(zip(results.states, results.exact, strict=True)):
        hertz, friction = problem.Hertz(state.force[2]), problem.friction
        limit = friction * hertz.force
        shift = state.motion["shift"] + compliance * state.force[0]
        row = {
            "shift": state.motion["shift"],
            "shift_half_spaces": shift,
            "shift_exact": -exact.shift,
            "shear": -state.force[0] / limit,
            "shear_exact": None,
            "lateral": np.abs(state.traction[:, 1]).max() / (friction * hertz.peak),
        }
        Partial = None
        if k < problem.steps:
            at = CattaneoMindlinPoint.FromShift(hertz=hertz, shift=-shift, friction=friction)
            row["shear_exact"] = -at.shear / limit

            def Partial(part, force=hertz.force, limit=limit):
                return problem.Partial(force, -part * limit)

        rows.append(row | Row(results.faces, state, hertz, exact, Partial))
    return rows


def _Stiffness(results, compliance):
    """Force over displacement before slip, relative to that of half-spaces that stick."""
    problem = results.problem
    pressed, first = results.model.states[problem.press - 1 : problem.press + 1]
    force = pressed.force[0] - first.force[0]
    a = problem.Hertz(first.force[2]).contact_radius
    exact = 4 * problem.shear_modulus * a / (2 - problem.nu)
    return force / (first.motion["shift"] - compliance * force) / exact


def _Figures(results, compliance, seconds):
    problem = results.problem
    results.exact = _Exact(problem, results.states)
    rows = _Rows(results, compliance)
    force = results.states[0].force[2]
    slides = abs(problem.Partial(force, problem.friction * force).shift)
    return {
        "stiffness_ratio": _Stiffness(results, compliance),
        "force_error": max(abs(r["shear"] / r["shear_exact"] - 1) for r in rows[: problem.steps]),
        "shift_error": max(abs(r["shift_half_spaces"] - r["shift_exact"]) for r in rows) / slides,
        "compliance": compliance,
        **Summary(results.model, rows, seconds),
    }


def Report(results):
    """The figures as text."""
    figures = results.figures
    columns = {
        "shift_half_spaces": ("shift [mm]", ".6f"),
        "shift_exact": ("Mindlin", ".6f"),
        "shear": ("Q/(F P)", ".4f"),
        "shear_exact": ("Mindlin", ".4f"),
        "stick_ratio": ("c/a, area", ".4f"),
        "stick_ratio_fit": ("c/a, fit", ".4f"),
        "stick_ratio_exact": ("Mindlin", ".4f"),
        "lateral": ("lateral", ".3f"),
        "iterations": ("iterations", "d"),
    }
    return "\n".join(
        [
            "",
            Table(columns, figures["steps"]),
            "",
            f"stiffness without slip over 4 G a / (2 - nu)  {figures['stiffness_ratio']:.4f}",
            f"largest error of the force {figures['force_error']:.4f}, of the shift "
            f"{figures['shift_error']:.4f}, of the stick radius {figures['stick_error']:.4f} "
            f"(fit {figures['stick_fit_error']:.4f}) contact radii",
            f"{figures['seconds']:.1f} s without pictures",
        ]
    )


def Curve(ax, results):
    """Draw the force over the shift."""
    problem, rows = results.problem, results.figures["steps"]
    force = results.states[problem.steps - 1].force[2]
    top = results.exact[problem.steps - 1]
    shear = np.linspace(0, top.shear, 101)
    up = [problem.Partial(force, q) for q in shear]
    back = [top.Reverse(q) for q in np.linspace(top.shear, -0.6 * top.shear, 101)]
    limit = problem.friction * force
    for path, label in ((up, "Mindlin"), (back if problem.reverse else [], None)):
        ax.plot(
            [-1e3 * e.shift for e in path],
            [-(e.shear if hasattr(e, "shear") else 0) / limit for e in path],
            color=INK,
            lw=0.9,
            label=label,
        )
    x = [0.0, *(1e3 * row["shift_half_spaces"] for row in rows)]
    ax.plot(x, [0.0, *(row["shear"] for row in rows)], "o", color="#D55E00", ms=4, label="computed")
    ax.set_xlabel("displacement, without that of the finite bodies [\u00b5m]")
    ax.set_ylabel("tangential force / (F P)")
    ax.legend(loc="lower right")


# ---------------------------------------------------------------- command line


def main(argv=None):
    """Run the demo from the command line."""
    parser = Parser("cattaneo3d", __doc__, Problem)
    parser.add_argument("--shear", type=float, default=Problem.shear, help="largest Q/(F P)")
    parser.add_argument("--reverse", type=int, default=Problem.reverse, help="steps back")
    RunCommand(Run, vars(parser.parse_args(argv)))


if __name__ == "__main__":
    main()
