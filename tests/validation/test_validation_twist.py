"""A sphere pressed on a block and twisted: Lubkin's moments and stick radii.

The demo's quarter model, which is checked against a full model: coarse, so both are.
"""

import numpy as np
import pytest

from ngslac.demos import twist
from ngslac.demos._friction3d import OPEN, STICK, Model
from ngslac.demos._friction3d_figures import Faces, Row


@pytest.fixture(scope="module")
def results():
    return twist.Run(elements=5, steps=3, angle=1.5)


@pytest.mark.slow
def test_moment_over_angle(results):
    assert results.figures["moment_error"] <= 0.015
    ratios = [row["moment_exact"] for row in results.figures["steps"]]
    assert ratios == pytest.approx([0.683, 0.911, 0.977], abs=2e-3)


def test_stick_radius(results):
    assert results.figures["stick_fit_error"] <= 0.03
    for row in results.figures["steps"]:
        assert row["stick_ratio"] == pytest.approx(row["stick_ratio_exact"], abs=0.07)


def test_normal_force_does_not_change(results):
    normal = [state.force[2] for state in results.model.states[results.problem.press - 1 :]]
    assert np.ptp(normal) <= 1e-3 * normal[0]


def test_newton(results):
    assert results.figures["newton_max"] <= 10


def test_limits(results):
    """No slip for a small angle, all slip for a large one, of a contact at rest."""
    problem = results.problem
    model = Model(problem)
    force = model.Press().force[2]
    exact, unit = problem.Twisted(force, 0.0), problem.Angles(force)[-1] / problem.angle
    first, last = model.Turn(0.03 * unit, 5 * unit)
    slope = -first.moment / first.motion["angle"]
    assert slope == pytest.approx(exact.stiffness, rel=0.04)
    assert first.Radius(STICK) >= 0.95 * first.Radius(1, 2)
    assert -last.moment == pytest.approx(exact.limit, rel=0.02)
    assert last.Radius(STICK) <= 0.2 * exact.hertz.contact_radius


@pytest.mark.slow
def test_quarter_and_full_model():
    """The same mesh sizes, but not the same meshes."""
    ratios, sticks = [], []
    for model in ("quarter", "full"):
        problem = twist.Problem(model=model, elements=3, press=1, steps=1, angle=0.7)
        discrete = Model(problem)
        force = discrete.Press().force[2]
        (state,) = discrete.Turn(*problem.Angles(force))
        exact = problem.Twisted(state.force[2], state.moment)
        row = Row(Faces.Of(discrete), state, exact.hertz, exact)
        assert OPEN in state.status
        ratios.append(-state.moment / exact.limit)
        sticks.append(row["stick_ratio"])
        assert np.linalg.norm(state.force[:2]) <= 0.01 * force or model == "quarter"
    assert ratios[0] == pytest.approx(ratios[1], rel=0.03)
    assert sticks[0] == pytest.approx(sticks[1], abs=0.1)
