"""Cattaneo and Mindlin: a shear force at constant normal force, and its reversal.

Equal materials; the mesh has 41 macro-elements in the half width of the contact, which is 1/800 of
the radius. The shear force is applied without moment, so that both resultants are given exactly.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from problems_cylinder import SLIP, STICK, Cylinder, Model, Profile

from ngslac.reference import CattaneoMindlin

PROBLEM = Cylinder(force=3.5, friction=0.2, h=0.0015, zone=0.08, young=(105e3, 105e3), half=False)
HERTZ = PROBLEM.hertz
LIMIT = PROBLEM.friction * PROBLEM.force
LOADED = CattaneoMindlin(hertz=HERTZ, shear=0.6 * LIMIT, friction=PROBLEM.friction)
# First half of the load is taken away, then it is reversed.
REVERSALS = [LOADED.Reverse(0.3 * LIMIT), LOADED.Reverse(-0.4 * LIMIT)]


@dataclass(frozen=True)
class State:
    exact: object
    profile: Profile
    force: np.ndarray
    moment: float
    slip: np.ndarray


@pytest.fixture(scope="module")
def history():
    """The states after pressing, after loading, and after the reversals."""
    model = Model(PROBLEM)
    states = []

    def Record(exact, profile):
        contact = model.contact
        table = contact.Table()
        slip = table["slip"][np.argsort(table["x"][:, 0]), 0]
        force, moment = np.asarray(contact.Force()), contact.Moment((0, 0))
        states.append(State(exact, profile, force, moment, slip))

    Record(None, model.Press(3))
    for exact in (LOADED, *REVERSALS):
        Record(exact, model.Shear(exact.shear))
    return states


def Macro(profile):
    return np.max(profile.end - profile.start)


def Errors(profile, exact):
    """Differences of the tangential tractions from the exact means, over F p0.

    Their largest value but for the macro-elements at the edge of the contact, and the root of
    their mean square over all macro-elements.
    """
    difference = profile.traction - exact.MeanTraction(profile.start, profile.end)
    errors = difference / (PROBLEM.friction * HERTZ.peak)
    inner = np.abs(profile.middle) < HERTZ.halfwidth - 2 * Macro(profile)
    return np.abs(errors[inner]).max(), np.sqrt(np.mean(errors**2))


def test_equal_materials_stick_under_pressure(history):
    pressed = history[0].profile
    slips = pressed.status == SLIP  # at the very edge, where there is no pressure
    assert np.all(np.abs(pressed.middle[slips]) > HERTZ.halfwidth - Macro(pressed))
    assert np.abs(pressed.traction).max() <= 2e-3 * HERTZ.peak
    inner = np.abs(pressed.middle) < HERTZ.halfwidth - 2 * Macro(pressed)
    exact = HERTZ.MeanPressure(pressed.start, pressed.end)
    assert np.abs(pressed.pressure - exact)[inner].max() <= 5e-3 * HERTZ.peak


@pytest.mark.parametrize("number", [1, 2, 3])
def test_resultants_are_the_loads_and_the_pressure_does_not_change(history, number):
    state = history[number]
    load = [state.exact.shear, PROBLEM.force]
    np.testing.assert_allclose(state.force, load, rtol=0, atol=1e-10 * PROBLEM.force)
    assert abs(state.moment) <= 1e-6 * PROBLEM.force * HERTZ.halfwidth
    difference = state.profile.pressure - history[0].profile.pressure
    assert np.abs(difference).max() <= 2e-3 * HERTZ.peak


@pytest.mark.parametrize("number", [1, 2, 3])
def test_stick_zone_ends_within_one_macro_element_and_two_percent(history, number):
    state = history[number]
    zone = np.array(state.profile.Zone(STICK))
    exact = np.array([-1, 1]) * state.exact.stick
    np.testing.assert_allclose(zone, exact, rtol=0, atol=Macro(state.profile))
    np.testing.assert_allclose(zone, exact, rtol=0.02)
    edge = np.array(state.profile.Zone(STICK, SLIP))
    np.testing.assert_allclose(np.abs(edge), HERTZ.halfwidth, rtol=0, atol=Macro(state.profile))


def test_traction_profile_of_the_first_loading(history):
    largest, mean = Errors(history[1].profile, LOADED)
    assert largest <= 0.03
    assert mean <= 0.004


@pytest.mark.parametrize("number", [2, 3])
def test_traction_profile_after_the_reversal_shows_hysteresis(history, number):
    # The profile has kinks with vertical tangents at the ends of both stick zones.
    state = history[number]
    largest, mean = Errors(state.profile, state.exact)
    assert largest <= 0.045
    assert mean <= 0.008
    # Without memory the contact would show the tractions of this load alone.
    alone = CattaneoMindlin(hertz=HERTZ, shear=state.exact.shear, friction=PROBLEM.friction)
    assert Errors(state.profile, alone)[1] >= 8 * mean


def test_slip_of_the_first_loading(history):
    profile = history[1].profile
    inside = np.abs(profile.middle) < 0.9 * HERTZ.halfwidth
    exact = LOADED.Slip(profile.middle[inside])
    error = history[1].slip[inside] - exact
    assert np.abs(error).max() <= 0.015 * np.abs(exact).max()
    sticks = profile.status == STICK
    assert np.abs(history[1].slip[sticks]).max() <= 1e-9 * np.abs(exact).max()
