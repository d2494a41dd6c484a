"""A cylinder on a block with friction: what the rows of both cases leave out."""

import numpy as np
import pytest
from case_cylinder import (
    FLAT,
    GUESS,
    HERTZ,
    HISTORY,
    LOADED,
    LOW,
    SHEARED,
    SLIP,
    STICK,
    Model,
    Run,
    TractionErrors,
)
from exact_spence import StickZone
from problems_punch import CoupledPunch, StickRatio

from ngslac.reference import CattaneoMindlin


@pytest.fixture(scope="module")
def history():
    """Macro-elements, force and moment: pressed, then in each of the exact states."""
    model = Model(SHEARED)
    pressed = model.Press(3)
    states = []
    for exact in HISTORY:
        macros = model.Shear(exact.shear)
        states.append((exact, macros, model.contact.Force(), model.contact.Moment((0, 0))))
    return pressed, states


def inside(macros):
    """All but the macro-elements at the edge of the contact."""
    return np.abs(macros.middle) < HERTZ.halfwidth - 2 * macros.size


def test_equal_materials_stick_under_pressure(history):
    pressed, _ = history
    slips = pressed.status == SLIP  # at the very edge, where there is no pressure
    assert np.all(np.abs(pressed.middle[slips]) > HERTZ.halfwidth - pressed.size)
    assert np.abs(pressed.traction).max() <= 2e-3 * HERTZ.peak
    exact = HERTZ.MeanPressure(pressed.start, pressed.end)
    assert np.abs(pressed.pressure - exact)[inside(pressed)].max() <= 5e-3 * HERTZ.peak


@pytest.mark.parametrize(
    ("number", "largest", "mean"), [(0, 0.03, 0.004), (1, 0.045, 0.008), (2, 0.045, 0.008)]
)
def test_cattaneo_and_mindlin(history, number, largest, mean):
    """Loads, pressure, stick zone and tractions; reversed, these have kinks at both its ends."""
    pressed, states = history
    exact, macros, force, moment = states[number]
    assert force[1] == pytest.approx(SHEARED.force, rel=1e-10)
    assert abs(moment) <= 1e-6 * SHEARED.force * HERTZ.halfwidth
    assert np.abs(macros.pressure - pressed.pressure).max() <= 2e-3 * HERTZ.peak
    ends = np.array([-1, 1]) * exact.stick
    np.testing.assert_allclose(macros.Zone(STICK), ends, rtol=0.02)
    edge = np.abs(macros.Zone(STICK, SLIP))
    np.testing.assert_allclose(edge, HERTZ.halfwidth, rtol=0, atol=macros.size)
    errors = TractionErrors(macros, exact)
    assert np.abs(errors[inside(macros)]).max() <= largest
    assert np.sqrt(np.mean(errors**2)) <= mean
    if number:  # without memory the contact would show the tractions of this load alone
        alone = CattaneoMindlin(hertz=HERTZ, shear=exact.shear, friction=SHEARED.friction)
        assert np.linalg.norm(TractionErrors(macros, alone)) >= 8 * np.linalg.norm(errors)


def test_slip_of_the_first_loading(history):
    _, macros, *_ = history[1][0]
    inner = np.abs(macros.middle) < 0.9 * HERTZ.halfwidth
    exact = LOADED.Slip(macros.middle[inner])
    assert np.abs(macros.slip[inner] - exact).max() <= 0.015 * np.abs(exact).max()
    assert np.abs(macros.slip[macros.status == STICK]).max() <= 1e-9 * np.abs(exact).max()


# ---------------------------------------------------------------- Spence


def test_low_load_agrees_with_spence():
    """The shear traction on the flat master is that on the slave plus p x/R.

    In the compatibility of both, each counts with the compliance of its body: 1/4 steel, 3/4 of it
    the block's. Tractions are split along a direction that is by 3/4 that of the steel.
    """
    low = Run(LOW)
    # The zone ends at a node; on this mesh one lies near enough for this bound.
    assert low.stick == pytest.approx(low.spence.ratio, rel=0.02)
    x, ratio = low.Ratio()
    error = ratio - np.abs(low.spence.zone.HertzFriction(x)) / LOW.friction
    assert np.abs(error).max() <= 0.06
    slope, stick = x * low.halfwidth / LOW.hertz.radius, x < low.stick
    before = np.sqrt(np.mean(error[stick] ** 2))
    after = np.sqrt(np.mean((error + (0.75 - 0.25) * slope / LOW.friction)[stick] ** 2))
    assert after <= min(0.015, 0.6 * before)
    # A stick zone inside of a slip zone carries the load.
    macros = low.macros
    assert macros.Zone(STICK)[0] == pytest.approx(0.0, abs=1e-12)
    assert macros.Zone(STICK)[1] == pytest.approx(macros.Zone(SLIP)[0], abs=1e-12)
    assert macros.Zone(STICK, SLIP)[1] == pytest.approx(low.halfwidth, abs=macros.size)
    assert low.force[1] == pytest.approx(LOW.force / 2, rel=1e-10)
    slips = macros.status == SLIP
    bound = -LOW.friction * macros.pressure[slips]
    np.testing.assert_allclose(macros.traction[slips], bound, rtol=1e-10)


@pytest.mark.parametrize("friction", GUESS)
def test_coupled_punch_agrees_with_the_closed_form_where_that_is_exact(friction):
    exact, guess = StickZone(beta=1 / 7, friction=friction), GUESS[friction]
    assert StickRatio(1 / 7, friction, guess, coupled=False) == pytest.approx(exact.ratio, rel=2e-4)
    x = np.array([0.1, 0.3, 0.5, 0.7, 0.85])
    punch = CoupledPunch(beta=1 / 7, friction=friction, coupled=False)
    expected = exact.HertzFriction(x) / friction
    np.testing.assert_allclose(punch.HertzFriction(x, guess), expected, atol=5e-4)


@pytest.mark.parametrize("friction", [pytest.param(0.1, marks=pytest.mark.full), 0.2])
def test_flat_contact_agrees_with_the_coupled_solution(friction):
    flat, guess = Run(FLAT[friction]), GUESS[friction]
    punch = CoupledPunch(beta=abs(flat.problem.hertz.beta), friction=friction)
    exact = StickRatio(punch.beta, friction, guess)
    assert flat.stick == pytest.approx(exact, abs=flat.macro)
    # What Goodman's approximation changes is less than that.
    assert exact == pytest.approx(flat.spence.ratio, rel=0.03)
    x, ratio = flat.Ratio()
    error = ratio - punch.HertzFriction(x, guess)
    assert np.abs(error).max() <= 0.015
    assert np.sqrt(np.mean(error**2)) <= 0.006
    # Coupled is better than Goodman's approximation: the difference is seen.
    goodman = ratio - np.abs(flat.spence.zone.HertzFriction(x)) / friction
    assert np.linalg.norm(error) < 0.8 * np.linalg.norm(goodman)
