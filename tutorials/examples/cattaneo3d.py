"""Cattaneo and Mindlin in 3D: a sphere on a block, pressed and then pushed sideways.

Small strains, the same material in both bodies (E = 70 GPa, nu = 0.3), friction 0.3; the half y >=
0 is computed. The upper side of the half sphere goes down, then along x until most of the contact
slips, then partly back. Computed are the curve of force and displacement with its hysteresis, the
stick zone and the tractions. Source: Mindlin (1949), Mindlin and Deresiewicz (1953); K. L.
Johnson, Contact Mechanics (1985), sections 7.2 and 7.4. Start it with::

    python tutorials/examples/cattaneo3d.py --out results

Mindlin's solution assumes tractions along the load, although slip also has a component across it
unless nu = 0. Computed tractions turn to the slip: at nu = 0.3 they have a component across of
about a twentieth of friction times the peak pressure (figure "lateral", best seen with ``--smooth
--elements 6``), and hardly a different resultant.
"""

from dataclasses import dataclass

import numpy as np
from command import Positive
from movedsphere import BulkCompliance, Sphere
from stickzone import FIRST, Example, Results, Row, Summary

from ngslac.reference import CattaneoMindlinPoint

COLUMNS = ["shift_half_spaces", "shift_exact", "shear", "shear_exact", "stick_ratio"]
COLUMNS += ["stick_ratio_fit", "stick_ratio_exact", "lateral"]


@dataclass(frozen=True, kw_only=True)
class Problem(Sphere):
    """What to compute: the fields of `Sphere`, and the path of the load."""

    model: str = "half"
    elements: float = 4.0
    shear: float = 0.95  # largest tangential force over friction times normal force
    reverse: int = 2  # steps back from there, to half the opposite force

    def __post_init__(self):
        if self.shear >= 1:
            raise ValueError(f"shear = {self.shear} must be less than 1: the sphere would slide")
        if self.reverse < 0:
            raise ValueError(f"reverse = {self.reverse} must not be less than 0")

    def Partial(self, force, shear):
        """Mindlin's solution for a normal and a tangential force."""
        return CattaneoMindlinPoint(hertz=self.Hertz(force), shear=shear, friction=self.friction)

    def Shifted(self, force, shift):
        """Mindlin's solution for a normal force and a displacement."""
        start = {"hertz": self.Hertz(force), "friction": self.friction}
        return CattaneoMindlinPoint.FromShift(shift=shift, **start)

    def Path(self, force):
        """Solutions to aim at, at a normal force: up to the largest shear, and back."""
        limit = self.friction * force
        top = self.Partial(force, -self.shear * limit)
        parts = np.arange(1, self.steps + 1) / self.steps
        up = [self.Shifted(force, part * top.shift) for part in parts]
        back = np.arange(1, self.reverse + 1) / max(1, self.reverse)
        first = self.Partial(force, -FIRST * limit)
        return [first] + up + [top.Reverse(top.shear * (1 - 1.5 * part)) for part in back]


def Solve(callback=None, **options):
    """Press and push; the results."""
    results = Results(Problem(**options))
    problem, model = results.problem, results.model
    force = model.Press(callback).force[2]
    compliance = BulkCompliance(model)
    ends = [-exact.shift - compliance * exact.shear for exact in problem.Path(force)]
    model.Shift(*ends, callback=callback)
    results.exact = _Exact(problem, results.states)
    results.figures = _Figures(results, compliance)
    return results


def _Exact(problem, states):
    """Mindlin's solutions for the computed forces."""
    exact = [problem.Partial(s.force[2], s.force[0]) for s in states[: problem.steps]]
    return exact + [exact[-1].Reverse(s.force[0]) for s in states[problem.steps :]]


def _Row(results, step, compliance):
    """Figures of a step."""
    problem, state, loading = results.problem, results.states[step], step < results.problem.steps
    hertz, shift = problem.Hertz(state.force[2]), state.motion["shift"]
    limit, half_spaces = problem.friction * hertz.force, shift + compliance * state.force[0]
    exact = problem.Shifted(hertz.force, -half_spaces).shear if loading else None

    def Partial(part):
        return problem.Partial(hertz.force, -part * limit)

    return {
        "shift": shift,
        "shift_half_spaces": half_spaces,
        "shift_exact": -results.exact[step].shift,
        "shear": -state.force[0] / limit,
        "shear_exact": -exact / limit if loading else None,
        "lateral": np.abs(state.traction[:, 1]).max() / (problem.friction * hertz.peak),
    } | Row(results, step, Partial if loading else None)


def _Stiffness(results, compliance):
    """Force over displacement before slip, relative to that of half-spaces that stick."""
    problem = results.problem
    pressed, first = results.model.states[problem.press - 1 : problem.press + 1]
    force = pressed.force[0] - first.force[0]
    a = problem.Hertz(first.force[2]).contact_radius
    exact = 4 * problem.shear_modulus * a / (2 - problem.nu)
    return force / (first.motion["shift"] - compliance * force) / exact


def _Figures(results, compliance):
    problem = results.problem
    rows = [_Row(results, step, compliance) for step in range(len(results.states))]
    force = results.states[0].force[2]
    slides = abs(problem.Partial(force, problem.friction * force).shift)
    return {
        "stiffness_ratio": _Stiffness(results, compliance),
        "force_error": max(abs(r["shear"] / r["shear_exact"] - 1) for r in rows[: problem.steps]),
        "shift_error": max(abs(r["shift_half_spaces"] - r["shift_exact"]) for r in rows) / slides,
        "compliance": compliance,
        **Summary(results.model, rows),
    }


main = Example(
    "cattaneo3d",
    Solve,
    __doc__,
    Problem,
    ("half", "full"),
    load=lambda state: f"P = {state.force[2]:9.3f} N",
    columns=COLUMNS,
    told=("force_error", "shift_error"),
    curves=(("shift_half_spaces", "shear"), ("shift_exact", "shear")),
    shear=(Positive, "largest Q/(F P)"),
    reverse=(int, "steps back"),
)


if __name__ == "__main__":
    main()
