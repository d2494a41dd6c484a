"""Twist: a sphere on a block, pressed and then turned about its axis.

Small strains, the same material in both bodies (E = 70 GPa, nu = 0.3), friction 0.3. The upper
side of the half sphere goes down, then turns about the axis through the contact. Slip comes in from
the edge. Computed are the curve of moment and angle, the stick zone and the tractions, to be
compared with Lubkin's solution. Start it with::

    python -m ngslac.demos.twist --out results

By default a quarter is computed, with conditions of antisymmetry for the twist; ``--model full``
needs no such argument, and four times as many unknowns.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ngslac.meshes.geometry import CheckPositive
from ngslac.reference import TwistPoint

from ._command import RunCommand
from ._friction3d import Model, Sphere
from ._friction3d_figures import Faces, Parser, Row, Summary, Table
from ._friction3d_pictures import Write
from ._pictures import INK, Matplotlib

__all__ = ["Problem", "Results", "Run", "main"]


FIRST = 0.01  # the angle of the first step, in units of F p0 / (2 G*)


@dataclass(frozen=True, kw_only=True)
class Problem(Sphere):
    """What to compute: the fields of `Sphere`, and the path of the load.

    Parameters
    ----------
    angle : float
        Largest angle, in units of F p0 / (2 G*), where G* = G/2.
    steps : int
        Steps to this angle, all equal. One of a hundredth of the unit, which tells the stiffness
        before slip, comes first.
    """

    model: str = "quarter"
    elements: float = 6.0
    stabilize: str = "bubble"
    steps: int = 5
    angle: float = 1.5

    def __post_init__(self):
        super().__post_init__()
        CheckPositive(steps=self.steps, angle=self.angle)
        if self.model == "half":
            raise ValueError('a twist has no plane of symmetry: use model="quarter" or "full"')

    def Twisted(self, force, moment):
        """Lubkin's solution for a normal force and a moment."""
        return TwistPoint(hertz=self.Hertz(force), moment=moment, friction=self.friction)

    def Angles(self, force):
        """The angles of the steps, at a normal force."""
        unit = self.friction * self.Hertz(force).peak / self.shear_modulus
        parts = np.arange(1, self.steps + 1) / self.steps
        return unit * np.array([FIRST, *self.angle * parts])


@dataclass
class Results:
    """Outcome of `Run`: `figures` (as in the JSON file), and the model with its states.

    `exact` has the exact solution of each step with the moment that was computed.
    """

    problem: Problem
    model: Model
    faces: Faces
    exact: list = field(default_factory=list)
    figures: dict = field(default_factory=dict)

    @property
    def states(self):
        """The states of the twist, without the first small step."""
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
            limit = problem.Twisted(state.force[2], 0.0).limit
            print(
                f"  P = {state.force[2]:9.3f} N   M/limit = {-state.moment / limit:7.4f}   "
                f"{state.iterations} Newton iterations",
                flush=True,
            )

    force = model.Press(Record).force[2]
    model.Turn(*problem.Angles(force), callback=Record)
    results.figures = _Figures(results, time.perf_counter() - start)
    if not quiet:
        print(Report(results))
    if out is not None:
        Write(results, Path(out), "twist", Curve)
    return results


# ---------------------------------------------------------------- evaluation


def _Rows(results):
    """Figures of all steps."""
    problem, rows = results.problem, []
    for state, exact in zip(results.states, results.exact, strict=True):
        force, angle = state.force[2], state.motion["angle"]
        at = TwistPoint.FromAngle(hertz=exact.hertz, angle=angle, friction=problem.friction)

        def Twisted(part, force=force, limit=exact.limit):
            return problem.Twisted(force, -part * limit)

        row = {
            "angle": angle,
            "moment": -state.moment,
            "moment_ratio": -state.moment / at.limit,
            "moment_exact": at.moment / at.limit,
        }
        rows.append(row | Row(results.faces, state, exact.hertz, exact, Twisted))
    return rows


def _Figures(results, seconds):
    problem = results.problem
    for state in results.states:
        limit = problem.Twisted(state.force[2], 0.0).limit
        moment = np.clip(state.moment, -limit, limit)
        results.exact.append(problem.Twisted(state.force[2], float(moment)))
    rows = _Rows(results)
    pressed, first = results.model.states[problem.press - 1 : problem.press + 1]
    slope = (pressed.moment - first.moment) / first.motion["angle"]
    return {
        "stiffness_ratio": slope / problem.Twisted(first.force[2], 0.0).stiffness,
        "moment_error": max(abs(r["moment_ratio"] / r["moment_exact"] - 1) for r in rows),
        **Summary(results.model, rows, seconds),
    }


def Report(results):
    """The figures as text."""
    figures = results.figures
    columns = {
        "angle": ("angle", ".3e"),
        "moment_ratio": ("M/limit", ".4f"),
        "moment_exact": ("Lubkin", ".4f"),
        "stick_ratio": ("c/a, area", ".4f"),
        "stick_ratio_fit": ("c/a, fit", ".4f"),
        "stick_ratio_exact": ("Lubkin", ".4f"),
        "traction_misfit": ("L2 error", ".3f"),
        "iterations": ("iterations", "d"),
    }
    return "\n".join(
        [
            "",
            Table(columns, figures["steps"]),
            "",
            f"stiffness without slip over 16/3 G* a^3  {figures['stiffness_ratio']:.4f}",
            f"largest error of the moment {figures['moment_error']:.4f}, of the stick radius "
            f"{figures['stick_error']:.4f} (fit {figures['stick_fit_error']:.4f}) contact radii",
            f"{figures['seconds']:.1f} s without pictures",
        ]
    )


def Curve(ax, results):
    """Draw the moment over the angle."""
    problem, rows = results.problem, results.figures["steps"]
    hertz = problem.Hertz(results.states[-1].force[2])
    angles = np.linspace(0, 1.05 * rows[-1]["angle"], 61)
    exact = [TwistPoint.FromAngle(hertz=hertz, angle=t, friction=problem.friction) for t in angles]
    ax.plot(1e3 * angles, [e.moment / e.limit for e in exact], color=INK, lw=0.9, label="Lubkin")
    slope = exact[0].stiffness / exact[0].limit
    ax.plot(1e3 * angles, slope * angles, "--", color=INK, lw=0.7, label="no slip")
    ax.axhline(1.0, ls=":", color=INK, lw=0.7)
    x = [0.0, *(1e3 * row["angle"] for row in rows)]
    y = [0.0, *(row["moment_ratio"] for row in rows)]
    ax.plot(x, y, "o", color="#D55E00", ms=4, label="computed")
    ax.set_xlabel("angle [mrad]")
    ax.set_ylabel("moment / (3 pi F P a / 16)")
    ax.set_ylim(0, 1.1)
    ax.legend(loc="lower right")


# ---------------------------------------------------------------- command line


def main(argv=None):
    """Run the demo from the command line."""
    parser = Parser("twist", __doc__, Problem)
    parser.add_argument("--angle", type=float, default=Problem.angle, help="largest angle")
    RunCommand(Run, vars(parser.parse_args(argv)))


if __name__ == "__main__":
    main()
