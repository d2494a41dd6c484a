"""A sphere pressed on a block and twisted: Lubkin's moments and stick radii.

The example's quarter model with six element edges along the contact radius. A stick radius is told
by the area of the macro-elements that stick, to a part of an element, and more precisely by a fit
of the tractions. The quarter model is checked against a full one.
"""

import numpy as np
import pytest
import twist
from movedsphere import STICK, Model
from stickzone import TractionMeans


@pytest.fixture(scope="module")
def run():
    """The example, and the state after turning far beyond."""
    results = twist.Solve(elements=6, steps=3, angle=1.5, press=1)
    angles = results.problem.Angles(results.states[-1].force[2])
    rows, states = results.figures["steps"], list(results.states)
    (last,) = results.model.Turn(4 * angles[-1])
    return results, rows, states, last


@pytest.mark.slow
def test_moment_over_angle(run):
    results, rows, *_ = run
    assert results.figures["moment_error"] <= 0.015
    assert [row["moment_exact"] for row in rows] == pytest.approx([0.683, 0.911, 0.977], abs=2e-3)


def test_stiffness_without_slip(run):
    """16/3 G* a^3, which is sensitive to the edge of the contact."""
    assert run[0].figures["stiffness_ratio"] == pytest.approx(1, abs=0.03)


def test_limit(run):
    """3 pi/16 F P a; at the middle, slip is too small to tell."""
    results, _, _, last = run
    exact = results.problem.Twisted(last.force[2], 0.0)
    assert -last.moment == pytest.approx(exact.limit, rel=0.02)
    assert last.Radius(STICK) <= 0.2 * exact.hertz.contact_radius


def test_stick_radius(run):
    results, rows, *_ = run
    assert results.figures["stick_fit_error"] <= 0.03
    for row in rows:
        assert row["stick_ratio"] == pytest.approx(row["stick_ratio_exact"], abs=0.06)
    assert rows[-1]["contact_ratio"] == pytest.approx(1, abs=0.03)


def test_tractions_go_round(run):
    """Where most of the contact slips they are friction times pressure around the axis."""
    results, _, states, _ = run
    means = TractionMeans(results.faces, results.exact[-1])
    hertz = results.problem.Hertz(states[-1].force[2])
    distance = np.linalg.norm(results.faces.middle, axis=1)
    inside = distance < 0.8 * hertz.contact_radius
    errors = (states[-1].traction - means)[inside] / (0.3 * hertz.peak)
    assert np.sqrt((errors**2).sum(axis=1).mean()) <= 0.06


def test_normal_force_does_not_change(run):
    _, _, states, last = run
    normal = [state.force[2] for state in [*states, last]]
    assert np.ptp(normal) <= 1e-3 * normal[0]


def test_newton(run):
    assert run[0].figures["newton_max"] <= 10


@pytest.mark.slow
def test_quarter_and_full_model():
    """Equally coarse, but not the same meshes."""
    options = dict(elements=3.0, radius=15.0, grading=0.7, press=1, steps=1, angle=0.7)
    ratios, sticks = [], []
    for model in ("quarter", "full"):
        problem = twist.Problem(model=model, **options)
        discrete = Model(problem)
        force = discrete.Press().force[2]
        state = discrete.Turn(*problem.Angles(force))[-1]
        exact = problem.Twisted(state.force[2], 0.0)
        ratios.append(-state.moment / exact.limit)
        sticks.append(state.Radius(STICK) / exact.hertz.contact_radius)
    # The meshes have no symmetry, hence a small resultant, relative to friction times pressure.
    assert np.linalg.norm(state.force[:2]) <= 0.05 * problem.friction * force
    assert ratios[0] == pytest.approx(ratios[1], rel=0.04)
    assert sticks[0] == pytest.approx(sticks[1], abs=0.05)
