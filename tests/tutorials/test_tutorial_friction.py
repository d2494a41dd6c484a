"""Tutorial 05, friction, runs, and what it computes is right."""

from base64 import b64decode
from io import BytesIO

import numpy as np
import pytest
from notebooks import Errors, Execute, Pictures
from PIL import Image

from ngslac.reference import CattaneoMindlin, HertzLine

pytestmark = pytest.mark.slow

NAME = "05_friction"
VALUES = """
VALUES = dict(
    states=history, pressed=pressed, stuck=stuck, ends=ends, limit=limit, a=a, p0=hertz.peak,
    compliance=compliance, losses=list(losses.items()), enclosed=enclosed, dissipated=dissipated,
    theory=[Loss(r * limit) for r in losses], frames=[len(sigma.vecs), len(motion.vecs)],
    slipshift=[SlipShift(Q[4]), *back[[0, 100, -1]]], difference=difference, tresca=State(tresca),
    data=[P, R, E, nu],
)
"""
FRICTION = 0.2
TURN, BACK, AGAIN = 4, 12, 20  # numbers of the states at the points of reversal
OPEN, STICK, SLIP = 0, 1, 2


@pytest.fixture(scope="module")
def friction():
    return Execute(NAME, VALUES)


@pytest.fixture(scope="module")
def values(friction):
    return friction[0]


@pytest.fixture(scope="module")
def hertz(values):
    P, R, E, nu = values["data"]
    return HertzLine(force=P, radius1=R, young1=E, nu1=nu, young2=E, nu2=nu)


def Loaded(hertz, Q):
    return CattaneoMindlin(hertz=hertz, shear=Q, friction=FRICTION)


def Theory(values, hertz, number):
    """The exact state that belongs to a state of the cycle."""
    Q = values["states"][number]["Q"]
    if number <= TURN:
        return Loaded(hertz, Q)
    turn = values["states"][TURN if number <= BACK else BACK]
    return Loaded(hertz, turn["Q"]).Reverse(Q)


def test_no_errors_and_pictures(friction):
    values, outputs = friction
    assert not Errors(outputs)
    assert Pictures(outputs) == 6
    (film,) = (o.data["image/gif"] for o in outputs if "image/gif" in o.get("data", {}))
    assert Image.open(BytesIO(b64decode(film))).n_frames == AGAIN / 2 + 1
    assert values["frames"][0] == values["frames"][1] > AGAIN / 2


def test_pressure_is_that_of_hertz(values, hertz):
    state, ends = values["pressed"], values["ends"]
    exact = hertz.MeanPressure(ends[:-1], ends[1:])
    inner = abs(ends[:-1] + ends[1:]) / 2 < 0.9 * hertz.halfwidth
    np.testing.assert_allclose(state["p"][inner], exact[inner], rtol=0, atol=0.01 * hertz.peak)
    assert np.sqrt(np.mean((state["p"] - exact) ** 2)) < 0.02 * hertz.peak
    assert abs(state["q"]).max() < 0.01 * hertz.peak  # equal materials


def test_traction_without_slip(values, hertz):
    a, ends = hertz.halfwidth, values["ends"]
    x0, x1 = ends[:-1].clip(-a, a), ends[1:].clip(-a, a)
    Q = values["states"][TURN]["Q"]
    exact = Q / np.pi * (np.arcsin(x1 / a) - np.arcsin(x0 / a)) / np.diff(ends)
    state = values["stuck"]
    inner = abs(ends[:-1] + ends[1:]) / 2 < 0.7 * a
    change = state["q"] - values["pressed"]["q"]
    np.testing.assert_allclose(change[inner], exact[inner], rtol=0.03)
    assert state["area"] @ state["q"] == pytest.approx(Q, rel=1e-4)
    assert SLIP not in state["status"]
    assert np.any(state["q"] > FRICTION * state["p"])


@pytest.mark.parametrize("number", range(1, AGAIN + 1))
def test_forces_and_pressure(values, number):
    state = values["states"][number]
    np.testing.assert_allclose(state["force"], [state["Q"], 7], rtol=0, atol=1e-9)
    assert abs(state["p"] - values["pressed"]["p"]).max() < 0.005 * values["p0"]


def test_the_cycle(values):
    Q = np.array([state["Q"] for state in values["states"][: AGAIN + 1]]) / values["limit"]
    levels = np.concatenate([np.arange(0, 4), np.arange(4, -4, -1), np.arange(-4, 5)]) * 0.1875
    np.testing.assert_allclose(Q, levels, atol=1e-12)


@pytest.mark.parametrize("number", range(1, AGAIN + 1))
def test_traction(values, hertz, number):
    """Cattaneo and Mindlin on the way up, Mindlin and Deresiewicz after the reversals."""
    state, ends = values["states"][number], values["ends"]
    exact = Theory(values, hertz, number)
    errors = state["q"] - exact.MeanTraction(ends[:-1], ends[1:])
    assert np.sqrt(np.mean(errors**2)) < 0.05 * FRICTION * hertz.peak
    middle = abs(ends[:-1] + ends[1:]) / 2
    smooth = (middle < 0.9 * hertz.halfwidth) & (abs(middle - exact.stick) > 0.1 * hertz.halfwidth)
    assert abs(errors[smooth]).max() < 0.055 * FRICTION * hertz.peak


@pytest.mark.parametrize("number", [*range(1, TURN + 1), *range(TURN + 2, BACK + 1)])
def test_stick_zone(values, hertz, number):
    state, ends = values["states"][number], values["ends"]
    sticks = np.flatnonzero(state["status"] == STICK)
    assert np.all(np.diff(sticks) == 1)
    exact = Theory(values, hertz, number).stick
    assert ends[sticks[-1] + 1] == pytest.approx(exact, abs=1.01 * np.diff(ends).max())
    assert ends[sticks[0]] == pytest.approx(-exact, abs=1.01 * np.diff(ends).max())


def test_memory(values):
    """A cycle ends where it began; halfway all is mirrored; unloaded, tractions remain."""
    states, size = values["states"], FRICTION * values["p0"]
    np.testing.assert_allclose(states[AGAIN]["q"], states[TURN]["q"], atol=1e-7 * size)
    assert states[AGAIN]["shift"] == pytest.approx(states[TURN]["shift"], rel=1e-8)
    # What always sticks keeps the little friction that pressing has left.
    left = np.where(states[TURN]["status"] == STICK, values["pressed"]["q"], 0)
    difference = states[BACK]["q"] - 2 * left + states[TURN]["q"]
    edge = np.append(np.diff(states[TURN]["status"]) != 0, False)
    edge[1:] |= edge[:-1]  # the macro-elements beside the ends of the stick zone
    assert abs(difference).max() < 0.04 * size
    assert abs(difference[~edge]).max() < 0.01 * size
    assert states[8]["Q"] == pytest.approx(0, abs=1e-12)
    assert states[8]["q"].min() < -0.4 * size
    assert states[8]["q"].max() > 0.25 * size


def test_cone(values):
    for state in values["states"]:
        bound, size = FRICTION * state["p"], FRICTION * values["p0"]
        assert np.all(abs(state["q"]) <= bound + 1e-9 * size)
        slips = state["status"] == SLIP
        np.testing.assert_allclose(abs(state["q"][slips]), bound[slips], atol=1e-9 * size)
        assert np.all(state["q"] * state["s"] <= 1e-9 * size * abs(state["s"]).max())


def test_loop(values):
    """The displacement beyond that of the elastic bodies, on the way up and on the way back."""
    states, largest = values["states"], values["slipshift"][0]
    beyond = [state["shift"] - values["compliance"] * state["Q"] for state in states[: AGAIN + 1]]
    t = np.array([state["Q"] for state in states[: AGAIN + 1]]) / values["limit"]

    def Slip(t):
        return largest * ((1 - t) * np.log(1 - t) + t) / (0.25 * np.log(0.25) + 0.75)

    exact = Slip(t[: TURN + 1])
    back = Slip(t[TURN]) - 2 * Slip((t[TURN] - t[TURN + 1 : BACK + 1]) / 2)
    exact = np.concatenate([exact, back, -back])
    np.testing.assert_allclose(beyond, exact, rtol=0, atol=0.05 * largest)
    np.testing.assert_allclose(values["slipshift"][1::2], [-largest, largest], rtol=1e-9)


def test_energy(values, hertz):
    A, W = np.array(values["losses"]).T
    exact = values["theory"]
    assert A.tolist() == [0.3, 0.5, 0.75, 0.9]
    np.testing.assert_allclose(W / exact, 1, atol=0.06)
    np.testing.assert_allclose((W / exact)[A >= 0.5], 1, atol=0.025)
    assert values["dissipated"] == W[A == 0.75]
    assert 0.97 < values["enclosed"] / values["dissipated"] < 1


def test_energy_formula(values, hertz):
    """The closed form of the text is the integral of friction times slip of the theory."""
    x = hertz.halfwidth * np.sin(np.linspace(-np.pi / 2, np.pi / 2, 20001))
    for (ratio, _), exact in zip(values["losses"], values["theory"], strict=True):
        slip = Loaded(hertz, ratio * values["limit"]).Slip(x)
        integral = np.trapezoid(FRICTION * hertz.Pressure(x) * abs(slip), x)
        assert exact == pytest.approx(4 * integral, rel=1e-6)


def test_tresca_with_the_bound_of_coulomb(values):
    assert values["difference"] < 0.005
    np.testing.assert_array_equal(
        values["tresca"]["status"] == STICK, values["states"][TURN]["status"] == STICK
    )
