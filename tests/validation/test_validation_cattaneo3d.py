"""Cattaneo and Mindlin in 3D: a shear force at constant normal force, and back.

The example's half model with four element edges along the contact radius. The displacement of the
finite bodies is taken off as computed without contact. A stick radius is told by the area of the
macro-elements that stick, to a part of an element, and more precisely by a fit of the tractions.
"""

import cattaneo3d
import numpy as np
import pytest
from movedsphere import SLIP, STICK
from stickzone import Misfit, TractionMeans

STEPS = 2


@pytest.fixture(scope="module")
def results():
    return cattaneo3d.Solve(elements=4, steps=STEPS, reverse=2, press=1)


@pytest.fixture(scope="module")
def rows(results):
    return results.figures["steps"]


@pytest.mark.slow
def test_force_over_displacement(results, rows):
    assert results.figures["force_error"] <= 0.01
    shears = [row["shear_exact"] for row in rows[:STEPS]]
    assert shears == pytest.approx([0.572, 0.95], abs=2e-3)


def test_stiffness_without_slip(results):
    """4 G a / (2 - nu), of two half-spaces that stick together on the contact area."""
    assert results.figures["stiffness_ratio"] == pytest.approx(1, abs=0.03)


def test_hysteresis(results, rows):
    """Displacements of all steps, relative to the one at which the sphere slides."""
    assert results.figures["shift_error"] <= 0.006
    top, back = rows[STEPS - 1], rows[STEPS]
    alone = results.problem.Partial(results.states[STEPS].force[2], results.states[STEPS].force[0])
    assert back["shift_half_spaces"] - abs(alone.shift) > 0.15 * top["shift_half_spaces"]


def test_finite_bodies_matter_and_are_accounted_for(results, rows):
    top = rows[STEPS - 1]
    share = results.figures["compliance"] * -results.states[STEPS - 1].force[0] / top["shift"]
    assert 0.01 < share < 0.1


def test_stick_radius(results, rows):
    assert results.figures["stick_fit_error"] <= 0.02
    for row in rows:
        assert row["stick_ratio"] == pytest.approx(row["stick_ratio_exact"], abs=0.07)
    ratios = [row["stick_ratio"] for row in rows[:STEPS]]
    assert np.all(np.diff(ratios) < -0.1)
    assert rows[-1]["contact_ratio"] == pytest.approx(1, abs=0.05)


def test_resultants(results):
    normal = [state.force[2] for state in results.states]
    assert np.ptp(normal) <= 1e-3 * normal[0]
    # The half model carries a force across the plane of symmetry, which the other half balances.
    assert all(abs(state.force[0]) < 0.3 * state.force[2] for state in results.states)


def test_coulomb(results):
    """Tractions lie on the cone where there is slip, and against the slip of the step."""
    for state in results.states:
        size, bound = np.linalg.norm(state.traction, axis=1), 0.3 * state.pressure
        slips = state.status == SLIP
        scale = bound.max()
        # Tractions are in the plane of the macro-element, not quite in that of the picture.
        assert np.abs(size - bound)[slips].max() <= 0.02 * scale
        assert np.all(size[state.status == STICK] <= 1.02 * scale)
        along = -(state.traction * state.slip).sum(axis=1)[slips]
        full = (size * np.linalg.norm(state.slip, axis=1))[slips]
        assert np.all(along >= 0.999 * full)


def test_traction_profile(results):
    """At the largest load; the error is that of the macro-elements at the edge of the contact."""
    k = STEPS - 1
    state, means = results.states[k], TractionMeans(results.faces, results.exact[k])
    assert Misfit(results.faces, state, results.exact[k]) <= 0.15
    hertz = results.problem.Hertz(state.force[2])
    inside = np.linalg.norm(results.faces.middle, axis=1) < 0.75 * hertz.contact_radius
    errors = (state.traction - means)[inside] / (0.3 * hertz.peak)
    assert np.sqrt((errors**2).mean()) <= 0.06
    assert np.abs(errors[:, 1]).max() <= 0.12


def test_newton(results):
    assert results.figures["newton_max"] <= 10


@pytest.mark.slow
def test_where_the_solution_is_exact():
    """For nu = 0 slip has no component across the load. No friction while pressing: no history."""
    options = dict(elements=4, steps=1, shear=0.8, reverse=0, press=1, nu=0.0, rough=False)
    figures = cattaneo3d.Solve(**options).figures
    assert figures["force_error"] <= 0.004
    assert figures["shift_error"] <= 0.004
    assert figures["stick_fit_error"] <= 0.015
    assert figures["steps"][-1]["lateral"] <= 0.04
