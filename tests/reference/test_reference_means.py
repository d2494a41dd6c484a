"""Averages over intervals and faces, and what the line solutions give back."""

from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from exact_disc import ElasticSignoriniDisc
from exact_signorini import ElasticSignorini, ScalarSignorini
from exact_spence import SpenceLine
from lubkin import TwistPoint

from ngslac.reference import (
    CattaneoMindlin,
    CattaneoMindlinPoint,
    HertzLine,
    HertzPoint,
)

PAIR = dict(force=120, radius1=30, radius2=60, young1=2e4, nu1=0.25, young2=2e4, nu2=0.25)
LINE, POINT = HertzLine(**PAIR), HertzPoint(**PAIR)
A = LINE.halfwidth
SLIP = CattaneoMindlin(hertz=LINE, shear=20.0, friction=0.3)
BACK = SLIP.Reverse(-5.0)
SPENCE = SpenceLine(hertz=replace(LINE, young2=6e4), friction=0.2)
ELASTIC = ElasticSignorini(young1=3.0, nu1=0.3, young2=0.8, nu2=0.1, tip=A / 3, strength=2.0)
PUSHED = CattaneoMindlinPoint(hertz=POINT, shear=20.0, friction=0.3)
TWIST = TwistPoint(hertz=HertzPoint(**PAIR | dict(young2=5e4, nu2=0.4)), moment=0.0, friction=0.3)
TWIST = replace(TWIST, moment=0.7 * TWIST.limit)
DISC = ElasticSignoriniDisc(**{"young1": 3.0, "nu1": 0.3, "young2": 0.8, "nu2": 0.1}, radius=0.6)
# States on faces, and their radii.
ROUND = {
    "hertz": (POINT, POINT.contact_radius),
    "mindlin": (PUSHED, POINT.contact_radius),
    "reversal": (PUSHED.Reverse(-5.0), POINT.contact_radius),
    "twist": (TWIST, TWIST.hertz.contact_radius),
    "disc": (DISC, DISC.radius),
}
FACES = [  # over the radius
    [[0.1, 0.2], [0.4, 0.3], [0.2, 0.6]],  # inside
    [[-0.3, -0.2], [0.5, -0.1], [0.1, 0.4]],  # around the middle
    [[0.5, 0.5], [1.2, 0.4], [0.6, 1.3]],  # over the edge, corners outside
    [[-2.0, 0.9], [2.0, 0.95], [0.0, 3.0]],  # an edge is a chord, no corner inside
    [[-1.5, -1.2], [1.6, -1.3], [1.4, 1.2], [-1.3, 1.7]],  # holds the contact
    [[0.0, 0.0], [0.7, 0.0], [0.9, 0.8], [0.0, 0.7]],  # the middle is a corner
    [[-0.4, 0.0], [0.6, 0.0], [0.1, 0.9]],  # the middle is on an edge
    [[0.6999, 0.7], [0.7201, 0.69], [0.71, 0.73]],  # small, at the edge of the contact
]
# State, where it has kinks for x > 0
CASES = {
    "hertz": (LINE, [A]),
    "mindlin": (SLIP, [A, SLIP.stick]),
    "reversal": (BACK, [A, SLIP.stick, BACK.stick]),
    "spence": (SPENCE, [SPENCE.hertz.halfwidth, SPENCE.stick, 0.0]),
    "scalar": (ScalarSignorini(tip=A / 3), [A / 3]),
    "elastic": (ELASTIC, [A / 3]),
}


def of(state):
    kind = "Pressure" if hasattr(state, "Pressure") else "Traction"
    return getattr(state, kind), getattr(state, f"Mean{kind}")


@pytest.mark.parametrize("name", CASES)
def test_mean_is_the_average(name, integral):
    """Over intervals inside, around kinks and the middle, outside, and backwards."""
    state, kinks = CASES[name]
    function, mean = of(state)
    x0 = np.array([-1.3, -1.0, -0.02, 0.0, 0.3, 0.5, 0.9, 1.1, 0.8]) * A
    x1 = np.array([-0.9, -0.7, 0.05, 0.2, 0.6, 0.9, 1.2, 1.2, 0.1]) * A
    scale = np.abs(function(np.linspace(-A, A, 33))).max()
    for left, right, value in zip(x0, x1, mean(x0, x1), strict=True):
        low, high = min(left, right), max(left, right)
        exact = integral(function, low, high, [s * k for s in (-1, 1) for k in kinks])
        assert value == pytest.approx(exact / (high - low), rel=1e-8, abs=1e-10 * scale)


@pytest.mark.parametrize("name", CASES)
def test_numbers_in_numbers_out(name):
    state, _ = CASES[name]
    function, mean = of(state)
    for call in (function, getattr(state, "Slip", function), lambda x: mean(x, 2.0)):
        assert np.ndim(call(0.1)) == 0
        assert not isinstance(call(0.1), np.ndarray)
        assert call([[0.1, 0.2, 0.3]]).shape == (1, 3)
    with pytest.raises(ValueError, match=r"x1 = .*nonzero length"):
        mean([0.0, 1.0], [1.0, 1.0])
    with pytest.raises(FrozenInstanceError):
        state.tip = 1.0
    for bad in (np.nan, [0.0, np.inf]):
        with pytest.raises(ValueError, match=r"x = .* is not valid: give finite"):
            function(bad)
        with pytest.raises(ValueError, match=r"x1 = .* is not valid: give finite"):
            mean(0.0, bad)


def rotation(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


@pytest.mark.parametrize("name", ROUND)
@pytest.mark.parametrize("corners", FACES)
def test_means_over_parts_of_a_face_add_up(name, corners):
    """In each direction, and in either sense of rotation."""
    state, radius = ROUND[name]
    function, mean = of(state)
    whole, scale = radius * np.array(corners), abs(function(0.5 * radius))
    nexts, middle = np.roll(whole, -1, axis=0), np.broadcast_to(whole.mean(axis=0), whole.shape)
    fan = np.stack([whole, nexts, middle], axis=1)
    areas = 0.5 * np.abs(np.linalg.det(fan[:, 1:] - fan[:, :1]))
    expected = areas @ mean(fan) / areas.sum()
    for angle in np.linspace(0, 2 * np.pi, 8, endpoint=False):
        turn = rotation(angle)
        turned = expected @ turn if np.ndim(expected) else expected
        for face in (whole @ turn, (whole @ turn)[::-1]):
            np.testing.assert_allclose(mean(face), turned, rtol=1e-9, atol=1e-12 * scale)


@pytest.mark.parametrize("name", ROUND)
@pytest.mark.parametrize("part", [0.2, 0.5, 0.9])
def test_mean_over_a_small_face_is_the_value_there(name, part):
    state, radius = ROUND[name]
    function, mean = of(state)
    x = part * radius * np.array([0.6, 0.8])
    face = x + 1e-4 * radius * np.array([[-1, -1], [2, -1], [-1, 2]])
    around = np.array([-0.8, 0.6]) if name == "twist" else 1.0
    np.testing.assert_allclose(mean(face), function(part * radius) * around, rtol=1e-5)


def test_mean_over_all_is_the_force_and_outside_exactly_zero():
    square, forces = np.array([[-1, -1], [1.5, -1], [1.5, 1], [-1, 1]]), {"hertz": POINT.force}
    forces["disc"] = 2 / 3 * np.pi * DISC.strength * DISC.radius**3
    outside = [[[1.0, 0.3], [1.4, 0.2], [1.1, 0.6]], [[1.1, 0.0], [0.0, 9.0], [9.0, 9.0]]]
    for name, force in forces.items():
        state, radius = ROUND[name]
        total = state.MeanPressure(3 * radius * square) * 45 * radius**2
        assert total == pytest.approx(force, rel=1e-13)
        assert (state.MeanPressure(radius * np.array(outside)) == 0).all()
