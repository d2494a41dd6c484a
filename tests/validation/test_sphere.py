"""A sphere that is pushed (Cattaneo and Mindlin) or twisted (Lubkin): what rows leave out.

The examples' half and quarter models with four and six element edges along the contact radius. The
displacement of the finite bodies is taken off as computed without contact. A stick radius is told
by the area of the macro-elements that stick, to a part of an element, and more precisely by a fit
of the tractions.
"""

import numpy as np
import pytest
import twist
from case_sphere import PushedSphere
from cattaneo3d import Partial
from movedsphere import SLIP, STICK, Sphere

STEPS = 2


@pytest.fixture(scope="module")
def pushed():
    return PushedSphere(elements=4, steps=STEPS, reverse=2, press=1)


@pytest.fixture(scope="module")
def twisted():
    """The example, its states, and that after turning far beyond."""
    figures = twist.Run(elements=6, steps=3, angle=1.5, press=1)
    sphere, _ = figures["solution"]
    states = list(sphere.moved)
    (last,) = sphere.Move("angle", 4 * states[-1].motion["angle"])
    return figures, states, last


def test_loads(pushed, twisted):
    shears = [row["shear_exact"] for row in pushed["steps"][:STEPS]]
    assert shears == pytest.approx([0.572, 0.95], abs=2e-3)
    assert pushed["force_error"] <= 0.01
    moments = [row["moment_exact"] for row in twisted[0]["steps"]]
    assert moments == pytest.approx([0.683, 0.911, 0.977], abs=2e-3)
    assert twisted[0]["moment_error"] <= 0.015


def stick(figures, fit, area, rim):
    """Radii, iterations, and the stiffness, which is sensitive to the edge of the contact."""
    assert figures["stiffness_ratio"] == pytest.approx(1, abs=0.03)
    assert figures["stick_fit_error"] <= fit
    for row in figures["steps"]:
        assert row["stick_ratio"] == pytest.approx(row["stick_ratio_exact"], abs=area)
    assert figures["steps"][-1]["contact_ratio"] == pytest.approx(1, abs=rim)
    assert figures["newton_max"] <= 10


def traction_errors(sphere, state, exact, part):
    """Over friction times the largest pressure, inside of a part of the radius."""
    hertz = sphere.Hertz(state.force[2])
    inside = np.linalg.norm(sphere.faces.middle, axis=1) < part * hertz.contact_radius
    means = sphere.Means(exact)
    return (state.traction - means)[inside] / (0.3 * hertz.peak)


def test_stick_radius_and_hysteresis(pushed):
    figures, sphere = pushed, pushed["solution"][0]
    states = sphere.moved
    stick(figures, fit=0.02, area=0.07, rim=0.05)
    rows = figures["steps"]
    assert np.all(np.diff([row["stick_ratio"] for row in rows[:STEPS]]) < -0.1)
    # Displacements of all steps, relative to the one at which the sphere slides.
    assert figures["shift_error"] <= 0.006
    top, back = rows[STEPS - 1], rows[STEPS]
    alone = Partial(sphere, states[STEPS].force[2], states[STEPS].force[0])
    assert back["shift_half_spaces"] - abs(alone.shift) > 0.15 * top["shift_half_spaces"]
    # Finite bodies matter and are accounted for.
    share = figures["compliance"] * -states[STEPS - 1].force[0] / top["shift"]
    assert 0.01 < share < 0.1


def test_coulomb(pushed):
    """Tractions lie on the cone where there is slip, and against the slip of the step."""
    states = pushed["solution"][0].moved
    normal = [state.force[2] for state in states]
    assert np.ptp(normal) <= 1e-3 * normal[0]
    for state in states:
        # The half model carries a force across the plane of symmetry, which the other balances.
        assert abs(state.force[0]) < 0.3 * state.force[2]
        size, bound = np.linalg.norm(state.traction, axis=1), 0.3 * state.pressure
        slips, scale = state.status == SLIP, bound.max()
        # Tractions are in the plane of the macro-element, not quite in that of the picture.
        assert np.abs(size - bound)[slips].max() <= 0.02 * scale
        assert np.all(size[state.status == STICK] <= 1.02 * scale)
        along = -(state.traction * state.slip).sum(axis=1)[slips]
        assert np.all(along >= 0.999 * (size * np.linalg.norm(state.slip, axis=1))[slips])


def test_traction_profile_at_the_largest_load(pushed):
    """The error is that of the macro-elements at the edge of the contact."""
    sphere, exacts = pushed["solution"]
    state, exact = sphere.moved[STEPS - 1], exacts[STEPS - 1]
    assert sphere.Misfit(state, exact) <= 0.15
    errors = traction_errors(sphere, state, exact, 0.75)
    assert np.sqrt((errors**2).mean()) <= 0.06
    assert np.abs(errors[:, 1]).max() <= 0.12


def test_where_the_solution_is_exact():
    """For nu = 0 slip has no component across the load. No friction while pressing: no history."""
    options = dict(elements=4, steps=1, shear=0.8, reverse=0, press=1, nu=0.0, smooth=True)
    figures = PushedSphere(**options)
    assert figures["force_error"] <= 0.004
    assert figures["shift_error"] <= 0.004
    assert figures["stick_fit_error"] <= 0.015
    assert figures["steps"][-1]["lateral"] <= 0.04


def test_twist(twisted):
    figures, states, last = twisted
    sphere, exacts = figures["solution"]
    stick(figures, fit=0.03, area=0.06, rim=0.03)
    # The limit 3 pi/16 F P a; at the middle, slip is too small to tell.
    exact = twist.Twisted(sphere, last.force[2], 0.0)
    assert -last.moment == pytest.approx(exact.limit, rel=0.02)
    assert sphere.Radius(last, STICK) <= 0.2 * exact.hertz.contact_radius
    # Where most of the contact slips tractions are friction times pressure around the axis.
    errors = traction_errors(sphere, states[-1], exacts[-1], 0.8)
    assert np.sqrt((errors**2).sum(axis=1).mean()) <= 0.06
    normal = [state.force[2] for state in [*states, last]]
    assert np.ptp(normal) <= 1e-3 * normal[0]


@pytest.mark.full
def test_quarter_and_full_model():
    """Equally coarse, but not the same meshes."""
    options = dict(elements=3.0, radius=15.0, grading=0.7, press=1)
    ratios, sticks = [], []
    for model in ("quarter", "full"):
        sphere = Sphere(model=model, **options)
        force = sphere.Press().force[2]
        state = sphere.Move("angle", *twist.Angles(sphere, force, 1, 0.7))[-1]
        exact = twist.Twisted(sphere, state.force[2], 0.0)
        ratios.append(-state.moment / exact.limit)
        sticks.append(sphere.Radius(state, STICK) / exact.hertz.contact_radius)
    # The meshes have no symmetry, hence a small resultant, relative to friction times pressure.
    assert np.linalg.norm(state.force[:2]) <= 0.05 * sphere.friction * force
    assert ratios[0] == pytest.approx(ratios[1], rel=0.04)
    assert sticks[0] == pytest.approx(sticks[1], abs=0.05)
