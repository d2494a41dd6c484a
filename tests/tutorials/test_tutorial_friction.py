"""Tutorial 05, friction, runs, and what it computes is right."""

from base64 import b64decode
from io import BytesIO

import numpy as np
import pytest
from notebooks import Tutorial
from PIL import Image

from ngslac.reference import CattaneoMindlin, HertzLine

friction = Tutorial("05_friction", """
VALUES = dict(
    states=history, pressed=pressed, stuck=stuck, ends=ends, limit=limit, a=a, p0=hertz.peak,
    compliance=compliance, losses=list(losses.items()), enclosed=enclosed, dissipated=dissipated,
    theory=[Loss(r * limit) for r in losses], frames=[len(sigma.vecs), len(motion.vecs)],
    slipshift=[SlipShift(Q[4]), *back[[0, 100, -1]]], difference=difference, tresca=State(tresca),
    data=[P, R, E, nu],
)
""", pictures=6)  # fmt: skip
FRICTION = 0.2
TURN, BACK, AGAIN = 4, 12, 20  # numbers of the states at the points of reversal
OPEN, STICK, SLIP = 0, 1, 2


@pytest.fixture(scope="module")
def hertz(friction):
    P, R, E, nu = friction.data
    return HertzLine(force=P, radius1=R, young1=E, nu1=nu, young2=E, nu2=nu)


def Loaded(hertz, Q):
    return CattaneoMindlin(hertz=hertz, shear=Q, friction=FRICTION)


def Theory(friction, hertz, number):
    """The exact state that belongs to a state of the cycle."""
    Q = friction.states[number]["Q"]
    if number <= TURN:
        return Loaded(hertz, Q)
    return Loaded(hertz, friction.states[TURN if number <= BACK else BACK]["Q"]).Reverse(Q)


def test_film(friction):
    (film,) = (o.data["image/gif"] for o in friction.outputs if "image/gif" in o.get("data", {}))
    assert Image.open(BytesIO(b64decode(film))).n_frames == AGAIN / 2 + 1
    assert friction.frames[0] == friction.frames[1] > AGAIN / 2


def test_pressure_is_that_of_hertz(friction, hertz):
    state, ends = friction.pressed, friction.ends
    error = (state["p"] - hertz.MeanPressure(ends[:-1], ends[1:])) / hertz.peak
    inner = abs(ends[:-1] + ends[1:]) / 2 < 0.9 * hertz.halfwidth
    assert abs(error[inner]).max() < 0.01
    assert np.sqrt(np.mean(error**2)) < 0.02
    assert abs(state["q"]).max() < 0.01 * hertz.peak  # equal materials


def test_traction_without_slip(friction, hertz):
    a, ends, state = hertz.halfwidth, friction.ends, friction.stuck
    x0, x1 = ends[:-1].clip(-a, a), ends[1:].clip(-a, a)
    Q = friction.states[TURN]["Q"]
    exact = Q / np.pi * (np.arcsin(x1 / a) - np.arcsin(x0 / a)) / np.diff(ends)
    inner = abs(ends[:-1] + ends[1:]) / 2 < 0.7 * a
    change = state["q"] - friction.pressed["q"]
    np.testing.assert_allclose(change[inner], exact[inner], rtol=0.03)
    assert state["area"] @ state["q"] == pytest.approx(Q, rel=1e-4)
    assert SLIP not in state["status"]
    assert np.any(state["q"] > FRICTION * state["p"])


@pytest.mark.parametrize("number", range(1, AGAIN + 1))
def test_state_of_the_cycle(friction, hertz, number):
    """Cattaneo and Mindlin on the way up, Mindlin and Deresiewicz after the reversals."""
    state, ends, a = friction.states[number], friction.ends, hertz.halfwidth
    np.testing.assert_allclose(state["force"], [state["Q"], 7], rtol=0, atol=1e-9)
    assert abs(state["p"] - friction.pressed["p"]).max() < 0.005 * friction.p0
    exact = Theory(friction, hertz, number)
    errors = (state["q"] - exact.MeanTraction(ends[:-1], ends[1:])) / (FRICTION * hertz.peak)
    assert np.sqrt(np.mean(errors**2)) < 0.05
    middle = abs(ends[:-1] + ends[1:]) / 2
    smooth = (middle < 0.9 * a) & (abs(middle - exact.stick) > 0.1 * a)
    assert abs(errors[smooth]).max() < 0.055
    if number <= TURN or TURN + 2 <= number <= BACK:
        sticks = np.flatnonzero(state["status"] == STICK)
        assert np.all(np.diff(sticks) == 1)
        edges = [-ends[sticks[0]], ends[sticks[-1] + 1]]
        assert edges == pytest.approx([exact.stick] * 2, abs=1.01 * np.diff(ends).max())


def test_memory(friction):
    """A cycle ends where it began; halfway all is mirrored."""
    states, size = friction.states, FRICTION * friction.p0
    Q = np.array([state["Q"] for state in states[: AGAIN + 1]]) / friction.limit
    levels = np.concatenate([np.arange(0, 4), np.arange(4, -4, -1), np.arange(-4, 5)]) * 0.1875
    np.testing.assert_allclose(Q, levels, atol=1e-12)
    np.testing.assert_allclose(states[AGAIN]["q"], states[TURN]["q"], atol=1e-7 * size)
    assert states[AGAIN]["shift"] == pytest.approx(states[TURN]["shift"], rel=1e-8)
    # What always sticks keeps the little friction that pressing has left.
    left = np.where(states[TURN]["status"] == STICK, friction.pressed["q"], 0)
    difference = states[BACK]["q"] - 2 * left + states[TURN]["q"]
    edge = np.append(np.diff(states[TURN]["status"]) != 0, False)
    edge[1:] |= edge[:-1]  # the macro-elements beside the ends of the stick zone
    assert abs(difference).max() < 0.05 * size
    assert abs(difference[~edge]).max() < 0.01 * size


def test_loop(friction):
    """The displacement beyond that of the elastic bodies, on the way up and on the way back."""
    states, largest = friction.states[: AGAIN + 1], friction.slipshift[0]
    beyond = [state["shift"] - friction.compliance * state["Q"] for state in states]
    t = np.array([state["Q"] for state in states]) / friction.limit

    def Slip(t):
        return largest * ((1 - t) * np.log(1 - t) + t) / (0.25 * np.log(0.25) + 0.75)

    back = Slip(t[TURN]) - 2 * Slip((t[TURN] - t[TURN + 1 : BACK + 1]) / 2)
    exact = np.concatenate([Slip(t[: TURN + 1]), back, -back])
    np.testing.assert_allclose(beyond, exact, rtol=0, atol=0.05 * largest)
    np.testing.assert_allclose(friction.slipshift[1::2], [-largest, largest], rtol=1e-9)


def test_energy(friction, hertz):
    (A, W), exact = np.array(friction.losses).T, friction.theory
    assert A.tolist() == [0.3, 0.5, 0.75, 0.9]
    np.testing.assert_allclose(W / exact, 1, atol=0.06)
    np.testing.assert_allclose((W / exact)[A >= 0.5], 1, atol=0.025)
    assert friction.dissipated == W[A == 0.75]
    assert 0.97 < friction.enclosed / friction.dissipated < 1
    # The closed form of the text is the integral of friction times slip of the theory.
    x = hertz.halfwidth * np.sin(np.linspace(-np.pi / 2, np.pi / 2, 20001))
    for ratio, loss in zip(A, exact, strict=True):
        slip = Loaded(hertz, ratio * friction.limit).Slip(x)
        integral = np.trapezoid(FRICTION * hertz.Pressure(x) * abs(slip), x)
        assert loss == pytest.approx(4 * integral, rel=1e-6)


def test_tresca_with_the_bound_of_coulomb(friction):
    assert friction.difference < 0.005
    sticks, coulomb = (s["status"] == STICK for s in (friction.tresca, friction.states[TURN]))
    np.testing.assert_array_equal(sticks, coulomb)
