"""The paper's Hertz problem: figures, convergence under refinement, frame and units.

Friction raises the pressure at the origin. For half-planes of these materials it does so by 1.8 %
(the coupled equations of `problems_punch`), here, with a contact width of an eighth of the radius,
by 1.7 %: most of the 1.9 % by which the paper's result exceeds Hertz' is no error.
"""

from functools import cache

import numpy as np
import pytest
from hertz import Exact
from hertzline import Pressed, Values

FRICTION = 0.2
CASES = [0.0, FRICTION]
# Without friction the solution does not depend on the path.
STEPS = {0.0: 2, FRICTION: 10}

# Pressure at the origin over Hertz' for h -> 0, from h = 0.125 and finer.
LIMIT = {0.0: 0.999, FRICTION: 1.016}


@cache
def Half(h, friction, steps=None):
    return Pressed(h=h, friction=friction, steps=steps or STEPS[friction]).states


def Last(h, friction, steps=None):
    return Values(Half(h, friction, steps)[-1])


@pytest.mark.parametrize(("friction", "limit"), [(0.0, 3e-3), (FRICTION, 1.9e-2)])
def test_pressure_at_the_origin_at_h_half(friction, limit):
    figures = Last(0.5, friction)
    assert abs(figures["p0_ratio"] - 1) <= limit
    assert abs(figures["p0_ratio_raw"] - 1) <= limit


@pytest.mark.parametrize("friction", CASES)
def test_contact_edge(friction):
    figures = Last(0.25, friction)
    start, end = figures["contact_edge_interval"]
    assert 6.1 <= figures["contact_edge"] <= 6.4
    assert start <= Exact().halfwidth <= end
    assert figures["contact_edge_estimate"] == pytest.approx(Exact().halfwidth, rel=0.01)


@pytest.mark.parametrize("friction", CASES)
@pytest.mark.parametrize("h", [0.5, 0.25])
def test_resultant_is_the_load_in_each_step(h, friction):
    states = Half(h, friction)
    assert len(states) == STEPS[friction]
    np.testing.assert_allclose([state["force_ratio"] for state in states], 1, rtol=0, atol=1e-10)


@pytest.mark.parametrize("friction", CASES)
@pytest.mark.parametrize("h", [0.5, 0.25])
def test_newton_iterations(h, friction):
    iterations = [state["iterations"] for state in Half(h, friction)]
    assert len(iterations) == STEPS[friction]
    assert iterations[0] <= 8
    assert max(iterations[1:]) <= 5


@pytest.mark.parametrize("friction", CASES)
@pytest.mark.parametrize("h", [0.5, 0.25])
def test_pressure_agrees_with_hertz(h, friction):
    macros, hertz = Half(h, friction)[-1], Exact()
    exact = hertz.MeanPressure(macros["start"], macros["end"])
    size = macros["end"] - macros["start"]
    error = np.sqrt(np.sum(size * (macros["pressure"] - exact) ** 2) / np.sum(size * exact**2))
    assert error <= (0.02 if friction == 0 else 0.04) + 0.05 * h
    inner = macros["end"] < 0.8 * hertz.halfwidth
    ratio = macros["pressure"][inner] / exact[inner]
    # Towards the edge the width of the contact shows, which is an eighth of the radius.
    assert np.all(np.abs(ratio - 1) <= (1e-2 if friction == 0 else 2.5e-2))


@pytest.mark.parametrize("friction", CASES)
@pytest.mark.parametrize("h", [0.5, 0.25])
def test_pressure_at_the_origin_converges(h, friction):
    error = Last(h, friction)["p0_ratio"] - LIMIT[friction]
    assert abs(error) <= 3e-3 * h


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "steps"), [(0.0, 1), (FRICTION, 4)])
def test_pressure_at_the_origin_converges_on_the_finest_mesh(friction, steps):
    # With friction the path matters little: four steps in place of ten change 1e-4.
    h = 0.125
    error = Last(h, friction, steps)["p0_ratio"] - LIMIT[friction]
    assert abs(error) <= 3e-3 * h


def test_half_load_is_half_of_it():
    # Hertz' contact is self-similar: p0 grows like the root of the load.
    states = Half(0.25, FRICTION)
    half = states[4]
    assert half["time"] == pytest.approx(0.5)
    assert half["force_ratio"] == pytest.approx(1, abs=1e-10)
    assert Values(half)["p0_ratio"] == pytest.approx(Values(states[-1])["p0_ratio"], abs=4e-3)


# ---------------------------------------------------------------- frame and units

FRAME = {"h": 0.5, "friction": FRICTION, "steps": 3, "full": True}


@pytest.fixture(scope="module")
def upright():
    """The full model, which needs no condition on the line of symmetry."""
    return Pressed(**FRAME)


@pytest.fixture(
    scope="module",
    params=[{"angle": 37.0}, {"length": 1e-3, "stress": 1e6}],
    ids=["rotated", "metres"],
)
def changed(request):
    return Pressed(**FRAME, **request.param)


def test_frame_and_units_do_not_change_the_figures(upright, changed):
    for name in ("p0_ratio", "p0_ratio_raw", "contact_edge", "contact_edge_estimate"):
        before, after = (Values(problem.states[-1])[name] for problem in (upright, changed))
        assert after == pytest.approx(before, rel=1e-8)
    assert changed.states[-1]["force_ratio"] == pytest.approx(1, abs=1e-10)
    before, after = ([s["iterations"] for s in p.states] for p in (upright, changed))
    assert after == before


def test_frame_and_units_do_not_change_the_multipliers(upright, changed):
    for before, after in zip(upright.states, changed.states, strict=True):
        np.testing.assert_array_equal(after["status"], before["status"])
        for name in ("start", "end", "pressure", "traction"):
            size = np.abs(before[name]).max()
            np.testing.assert_allclose(after[name], before[name], rtol=0, atol=1e-8 * size)


def test_frame_and_units_do_not_change_the_displacement(upright, changed):
    block = np.array([[0.0, 100.0], [20.0, 50.0], [-10.0, 30.0], [0.0, -50.0], [-40.0, -120.0]])
    for point in block * [1.0, 0.999]:
        reference = np.array(upright.displacement(upright.mesh(*point)))
        turned = changed.length * point @ changed.frame
        there = np.array(changed.displacement(changed.mesh(*turned)))
        there = changed.frame @ there / changed.length
        np.testing.assert_allclose(there, reference, rtol=0, atol=1e-8 * np.abs(reference).max())


def test_springs_against_rolling_carry_no_force(upright):
    # The mesh is not symmetric: the force along the block is that of the discretisation alone.
    along = upright.frame[0] @ np.asarray(upright.contact.Force())
    assert abs(along) <= 1e-3 * upright.load
    assert Values(upright.states[-1])["p0_ratio"] == pytest.approx(LIMIT[FRICTION], abs=2e-3)
