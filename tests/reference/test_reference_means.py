"""Averages over intervals, and what the line solutions give back."""

from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest

from ngslac.reference import (
    CattaneoMindlin,
    ElasticSignorini,
    HertzLine,
    ScalarSignorini,
    SpenceLine,
)

LINE = HertzLine(force=120, radius1=30, radius2=60, young1=2e4, nu1=0.25, young2=2e4, nu2=0.25)
A = LINE.halfwidth
SLIP = CattaneoMindlin(hertz=LINE, shear=20.0, friction=0.3)
BACK = SLIP.Reverse(-5.0)
SPENCE = SpenceLine(hertz=replace(LINE, young2=6e4), friction=0.2)
ELASTIC = ElasticSignorini(young1=3.0, nu1=0.3, young2=0.8, nu2=0.1, tip=A / 3, strength=2.0)
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
