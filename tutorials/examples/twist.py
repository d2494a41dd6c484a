"""Twist: a sphere on a block, pressed and then turned about its axis.

Small strains, the same material in both bodies (E = 70 GPa, nu = 0.3), friction 0.3. The upper
side of the half sphere goes down, then turns about the axis through the contact. Slip comes in from
the edge. Computed are the curve of moment and angle, the stick zone and the tractions, to be
compared with the solution of J. L. Lubkin, J. Appl. Mech. 18 (1951). Start it with::

    python tutorials/examples/twist.py --out results

By default a quarter is computed, with conditions of antisymmetry for the twist; ``--model full``
needs no such argument, and four times as many unknowns.
"""

from dataclasses import dataclass

import numpy as np
from command import Positive
from lubkin import TwistPoint
from movedsphere import Sphere
from stickzone import FIRST, Example, Results, Row, Summary

COLUMNS = ["angle", "moment_ratio", "moment_exact", "stick_ratio", "stick_ratio_fit"]
COLUMNS += ["stick_ratio_exact", "traction_misfit"]


@dataclass(frozen=True, kw_only=True)
class Problem(Sphere):
    """What to compute: the fields of `Sphere`, and the path of the load."""

    model: str = "quarter"
    elements: float = 6.0
    angle: float = 1.5  # the largest, in units of F p0 / (2 G*), where G* = G/2

    def Twisted(self, force, moment):
        """Lubkin's solution for a normal force and a moment."""
        return TwistPoint(hertz=self.Hertz(force), moment=moment, friction=self.friction)

    def Angles(self, force):
        """The angles of the steps, at a normal force."""
        unit = self.friction * self.Hertz(force).peak / self.shear_modulus
        parts = np.arange(1, self.steps + 1) / self.steps
        return unit * np.array([FIRST, *self.angle * parts])


def Solve(callback=None, **options):
    """Press and turn; the results."""
    results = Results(Problem(**options))
    force = results.model.Press(callback).force[2]
    results.model.Turn(*results.problem.Angles(force), callback=callback)
    results.figures = _Figures(results)
    return results


def _Row(results, step):
    """Figures of a step."""
    problem, state, exact = results.problem, results.states[step], results.exact[step]
    angle = state.motion["angle"]
    at = TwistPoint.FromAngle(hertz=exact.hertz, angle=angle, friction=problem.friction)
    return {
        "angle": angle,
        "moment": -state.moment,
        "moment_ratio": -state.moment / at.limit,
        "moment_exact": at.moment / at.limit,
    } | Row(results, step, lambda part: problem.Twisted(state.force[2], -part * at.limit))


def _Figures(results):
    problem = results.problem
    for state in results.states:
        limit = problem.Twisted(state.force[2], 0.0).limit
        moment = np.clip(state.moment, -limit, limit)
        results.exact.append(problem.Twisted(state.force[2], float(moment)))
    rows = [_Row(results, step) for step in range(len(results.states))]
    pressed, first = results.model.states[problem.press - 1 : problem.press + 1]
    slope = (pressed.moment - first.moment) / first.motion["angle"]
    return {
        "stiffness_ratio": slope / problem.Twisted(first.force[2], 0.0).stiffness,
        "moment_error": max(abs(r["moment_ratio"] / r["moment_exact"] - 1) for r in rows),
        **Summary(results.model, rows),
    }


main = Example(
    "twist",
    Solve,
    __doc__,
    Problem,
    ("quarter", "full"),
    load=lambda state: f"M = {-state.moment:9.3f} Nmm",
    columns=COLUMNS,
    told=("moment_error",),
    curves=(("angle", "moment_ratio"), ("angle", "moment_exact")),
    angle=(Positive, "largest angle"),
)


if __name__ == "__main__":
    main()
