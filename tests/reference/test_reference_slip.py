"""Partial slip under a load along the surface: lines, points, and points twisted."""

from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest
from lubkin import TwistPoint
from scipy.special import ellipe, ellipk, ellipkm1

from ngslac.reference import (
    CattaneoMindlin,
    CattaneoMindlinPoint,
    HertzLine,
    HertzPoint,
)

FRICTION, FORCE = 0.3, 120.0
LIMIT = FRICTION * FORCE
PAIR = dict(force=FORCE, radius1=30, radius2=60, young1=2e4, nu1=0.25)
EQUAL, UNLIKE = PAIR | dict(young2=2e4, nu2=0.25), PAIR | dict(young2=5e4, nu2=0.4)
# With one and the same (1 - 2 nu)/G: uncoupled too.
SIMILAR = PAIR | dict(young1=0.6e4 * 2.4, nu1=0.2, young2=0.3e4 * 2.7, nu2=0.35)
KINDS = {  # class, load, normal contact, its size, weight of the traction in the load
    "line": (CattaneoMindlin, "shear", HertzLine(**EQUAL), lambda r: 2.0),
    "point": (CattaneoMindlinPoint, "shear", HertzPoint(**EQUAL), lambda r: 2 * pi * r),
    "twist": (TwistPoint, "moment", HertzPoint(**UNLIKE), lambda r: 2 * pi * r * r),
}
POINT = KINDS["point"][2]


def made(kind, part):
    """The state at a part of the load of complete slip."""
    cls, load, hertz, _ = KINDS[kind]
    none = cls(hertz=hertz, friction=FRICTION, **{load: 0.0})
    return replace(none, **{load: part * none.limit})


def size(state):
    return getattr(state.hertz, "halfwidth", None) or state.hertz.contact_radius


def loaded(state):
    return getattr(state, "moment", None) or getattr(state, "shear", 0.0)


def slip(state, r):
    """Along the load, at points on that line."""
    start = getattr(state, "start", state)
    return state.Slip(r, 0.0 * r)[0] if isinstance(start, CattaneoMindlinPoint) else state.Slip(r)


def resultant(kind, state, integral, kinks=()):
    """With r^2 = a^2 - v^2 or the like at every root of the traction: smooth."""
    a, weight = size(getattr(state, "start", state)), KINDS[kind][3]

    def part(v):
        r = 0.5 * a * (1 - np.cos(v))
        return 0.5 * a * np.sin(v) * weight(r) * state.Traction(r)

    return integral(part, 0, pi, [np.arccos(1 - 2 * k / a) for k in (state.stick, *kinks)])


@pytest.fixture(params=KINDS)
def kind(request):
    return request.param


@pytest.fixture
def state(kind):
    return made(kind, 0.6)


@pytest.mark.parametrize("part", [-1.0, -0.999, -0.2, 0.0, 1e-5, 0.003, 0.55, 0.95, 1.0])
def test_traction_carries_the_load(kind, part, integral):
    state = made(kind, part)
    limit = state.limit
    assert resultant(kind, state, integral) == pytest.approx(part * limit, rel=2e-8, abs=1e-12)
    box = 2 * size(state) * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    if kind == "line":
        assert state.MeanTraction(*box[:2, 0]) * np.ptp(box) == pytest.approx(part * limit)
    elif kind == "point":
        assert state.MeanTraction(box) * np.ptp(box) ** 2 == pytest.approx(part * limit, rel=1e-12)
    else:
        np.testing.assert_allclose(state.MeanTraction(box), 0, atol=1e-12 * LIMIT)


def test_coulomb_law(state):
    a, c = size(state), state.stick
    r = np.linspace(0, 1.2 * a, 241)
    traction, limit = state.Traction(r), FRICTION * state.hertz.Pressure(r)
    assert (np.abs(traction) <= limit * (1 + 1e-13)).all()
    slips, sticks = (r > c) & (r < a), r < 0.99 * c
    np.testing.assert_allclose(traction[slips], limit[slips], rtol=1e-14)
    assert (traction[sticks] < limit[sticks]).all()
    assert (slip(state, r[slips]) < 0).all()
    assert (slip(state, r[sticks]) == 0).all()
    assert np.isnan(slip(state, 1.01 * a))
    assert state.Traction(c * (1 - 1e-12)) == pytest.approx(state.Traction(c), rel=1e-5)


def test_no_load_and_all_of_it(kind):
    none, all_of_it = made(kind, 0.0), made(kind, -1.0)
    r = np.linspace(0.01, 1.2, 13) * size(none)
    assert (none.ratio, none.stick) == (1, size(none))
    assert (none.Traction(r) == 0).all()
    assert all_of_it.ratio == 0
    pressure = none.hertz.Pressure(r)
    np.testing.assert_allclose(all_of_it.Traction(r), -FRICTION * pressure, rtol=1e-14)
    triangle = ([0.0], [1.0]) if kind == "line" else ([[0, 0], [1, 0], [0, 1]],)
    assert (none.MeanTraction(*triangle) == 0).all()
    assert (slip(all_of_it, r[:9]) > 0).all()


def test_reversal(kind, state, integral):
    a, load = size(state), loaded(state)
    back = state.Reverse(0.2 * load)
    assert state.stick < back.stick == replace(state, **{KINDS[kind][1]: 0.4 * load}).stick
    total = resultant(kind, back, integral, [state.stick])
    assert total == pytest.approx(0.2 * load, rel=1e-7)
    r = np.linspace(1.001 * back.stick, 0.999 * a, 7)
    np.testing.assert_allclose(back.Traction(r), -FRICTION * state.hertz.Pressure(r), rtol=1e-11)
    frozen = 0.5 * (state.stick + back.stick)
    assert slip(back, frozen) == slip(state, frozen)
    assert (np.abs(slip(back, r)) < np.abs(slip(state, r))).all()


def test_reversal_ends(kind, state):
    load, a = loaded(state), size(state)
    r = np.linspace(0, a, 21)
    np.testing.assert_array_equal(state.Reverse(load).Traction(r), state.Traction(r))
    mirrored = state.Reverse(-load)
    where = ([0.1], [0.5]) if kind == "line" else ([[0.1, 0.2], [0.5, 0.3], [0.3, 0.9]],)
    for now, before in (
        (mirrored.Traction(r), state.Traction(r)),
        (mirrored.MeanTraction(*where), state.MeanTraction(*where)),
        (slip(mirrored, r), slip(state, r)),
        *((getattr(s, "angle", 0.0) for s in (mirrored, state)),),
        *((getattr(s, "shift", 0.0) for s in (mirrored, state)),),
    ):
        np.testing.assert_allclose(now, -before, rtol=1e-10, atol=1e-13)
    assert mirrored.stick == pytest.approx(state.stick, rel=1e-12)


# ---------------------------------------------------------------- lines


def test_published_formulas():
    """T17 of the reference cases, with its own symbols; the stick radius of points beside it."""
    for kind, power in (("line", 1 / 2), ("point", 1 / 3)):
        state = made(kind, 20 / LIMIT)
        a, p0 = size(state), state.hertz.peak
        c = a * (1 - 20 / LIMIT) ** power
        assert state.stick == pytest.approx(c, rel=1e-14)
        x = np.linspace(-0.99 * c, 0.99 * c, 7)
        roots = np.sqrt(1 - x**2 / a**2) - c / a * np.sqrt(1 - x**2 / c**2)
        np.testing.assert_allclose(state.Traction(x), FRICTION * p0 * roots, rtol=1e-12)


def test_slip_has_the_gradient_of_the_surface_strains(hilbert):
    """The gradient of slip is -(2/E*) H(tau): zero in stick, against friction in slip."""
    state = made("line", 0.55)
    a, c, modulus = size(state), state.stick, state.hertz.modulus
    step, edges = 1e-6 * a, [-a, -c, c, a]
    for x in (-0.8 * c, 0.05 * c, 0.9 * c, -0.5 * (a + c), c + 0.3 * (a - c), c + 0.9 * (a - c)):
        gradient = (state.Slip(x + step) - state.Slip(x - step)) / (2 * step)
        exact = -2 / modulus * hilbert(state.Traction, x, edges)
        assert gradient == pytest.approx(exact, rel=1e-6, abs=1e-8 * state.hertz.peak / modulus)


# ---------------------------------------------------------------- points


def cerruti_motion(state, x, y):
    """Motion of the slave's surface against the master's under the tractions of `state`.

    Cerruti's point forces, ((1 - nu) I + nu e e^T)/(2 pi G distance), with polar coordinates at
    (x, y): along a whole line at distance d, sqrt(c^2 - r^2) adds up to pi (c^2 - d^2)/2.
    """
    hertz, a, c = state.hertz, size(state), state.stick
    r, towards = np.hypot(x, y), np.arctan2(y, x)
    touch = np.arcsin(c / r) if r > c else 0.5 * pi  # lines beyond this angle miss the stick zone
    nodes, weights = np.polynomial.legendre.leggauss(60)
    total = np.zeros(2)
    for low, high in ((-touch, touch), (touch, pi - touch)):
        theta = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        d = r * np.sin(theta)
        line = np.maximum(a**2 - d**2, 0) - np.maximum(c**2 - d**2, 0)
        line *= 0.25 * pi * (high - low) * weights * FRICTION * hertz.peak / a
        u, v = np.cos(theta + towards), np.sin(theta + towards)
        for young, nu in ((hertz.young1, hertz.nu1), (hertz.young2, hertz.nu2)):
            kernel = np.stack([1 - nu + nu * u * u, nu * u * v])
            total += kernel @ line * (1 + nu) / (pi * young)
    return total


@pytest.mark.parametrize("bodies", [EQUAL, SIMILAR])
def test_slip_is_that_of_cerruti_point_forces(bodies):
    state = CattaneoMindlinPoint(hertz=HertzPoint(**bodies), shear=20.0, friction=FRICTION)
    a, c = size(state), state.stick
    rim = [(c + part * (a - c)) for part in (0.05, 0.5, 1.0)]
    for r in (0.0, 0.5 * c, 0.99 * c, *rim):
        for angle in (0.0, 0.7, 2.0):
            x, y = r * np.cos(angle) * (1 - 1e-15), r * np.sin(angle) * (1 - 1e-15)
            motion = cerruti_motion(state, x, y) - np.array([state.shift, 0.0])
            np.testing.assert_allclose(state.Slip(x, y), motion, atol=1e-9 * state.shift)


def test_published_shifts():
    """Mindlin's curve, the way back of Mindlin and Deresiewicz, and full adhesion at first."""
    state, a, shear_modulus = made("point", 20 / LIMIT), POINT.contact_radius, 2e4 / 2.5
    scale = 3 * LIMIT * 1.75 / (8 * shear_modulus * a)
    first = 1 - (1 - 20 / LIMIT) ** (2 / 3)
    assert state.shift == pytest.approx(scale * first, rel=1e-12)
    back = state.Reverse(4.0)
    assert back.stick == pytest.approx(a * (1 - 16 / (2 * LIMIT)) ** (1 / 3), rel=1e-14)
    curve = 2 * (1 - 16 / (2 * LIMIT)) ** (2 / 3) - 2 + first
    assert back.shift == pytest.approx(scale * curve, rel=1e-12)
    for part in (-1.0, -0.2, 0.0, 0.003, 0.6):
        shift, shear = made("point", part).shift, part * LIMIT
        found = CattaneoMindlinPoint.FromShift(hertz=POINT, shift=shift, friction=FRICTION)
        assert found.shear == pytest.approx(shear, rel=1e-12)
    small = replace(state, shear=1e-6)
    assert small.shift == pytest.approx(1e-6 * 1.75 / (4 * shear_modulus * a), rel=1e-6)


def test_work_of_a_cycle_as_published(integral):
    """Area of the loop (Johnson, 7.4)."""
    state, q = made("point", 20 / LIMIT), 20 / LIMIT
    area = 2 * integral(lambda q: state.Reverse(q).shift, -20.0, 20.0)
    rest = 1 - (1 - q) ** (5 / 3) - 5 * q / 6 * (1 + (1 - q) ** (2 / 3))
    published = 9 * LIMIT**2 / (10 * size(state)) * 2 * 1.75 / 8e3 * rest
    assert area == pytest.approx(published, rel=1e-9)


# ---------------------------------------------------------------- twists


def compliance(hertz):
    """1/G* = 1/G1 + 1/G2."""
    return 2 * (1 + hertz.nu1) / hertz.young1 + 2 * (1 + hertz.nu2) / hertz.young2


def ring_kernel(r, s):
    """2 pi G u/(s ds) at r of a ring of unit tractions around the axis at s, on a half-space.

    The sum of Cerruti's point forces, int cos(t)/sqrt(r^2 + s^2 - 2 r s cos(t)) dt over a turn;
    Poisson's ratio drops out.
    """
    rest = np.maximum(((r - s) / (r + s)) ** 2, 1e-300)
    m, first = 1 - rest, ellipkm1(rest)
    return 4 / (r + s) * ((2 - m) * first - 2 * ellipe(m)) / m


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_ring_kernel_is_independent_of_poissons_ratio(integral, nu):
    """Cerruti's displacement (1 - nu) f/d + nu (f.e) e/d of tangential forces around a ring."""
    r, s = 0.7, 1.3

    def motion(t):
        d = np.array([r - s * np.cos(t), -s * np.sin(t)])
        far, force = np.hypot(*d), np.array([-np.sin(t), np.cos(t)])
        return (1 - nu) * force[1] / far + nu * (force @ d) * d[1] / far**3

    assert integral(motion, 0, 2 * pi) == pytest.approx(ring_kernel(r, s), rel=1e-8)


@pytest.mark.parametrize("part", [0.05, 0.5, 0.95])
def test_stick_turns_as_one_body_and_slip_is_the_rest(integral, part):
    state = made("twist", part)
    a, c = size(state), state.stick

    def motion(r):
        """Around the axis of the slave's surface against the master's at r."""
        total = integral(lambda s: s * state.Traction(s) * ring_kernel(r, s), 0, a, [r, c])
        return compliance(state.hertz) * total / (2 * pi)

    for r in (0.1 * c, 0.6 * c, 0.98 * c):
        assert motion(r) == pytest.approx(state.angle * r, rel=1e-7)
    for r in (c + 0.1 * (a - c), 0.5 * (a + c), 0.999 * a):
        rest = motion(r) - state.angle * r
        assert state.Slip(r) == pytest.approx(rest, rel=1e-6, abs=1e-9 * state.angle * a)


def test_published_twists():
    """The limit moment, Lubkin's angle, and Reissner and Sagoci's adhesion at first."""
    state = made("twist", 0.7)
    hertz, a = state.hertz, size(state)
    assert state.limit == pytest.approx(3 * pi / 16 * LIMIT * a, rel=1e-14)
    m = 1 - state.ratio**2
    unit = FRICTION * hertz.peak * compliance(hertz) / 2
    assert state.angle == pytest.approx(unit * (ellipk(m) - ellipe(m)), rel=1e-12)
    small = replace(state, moment=1e-4)
    assert small.stiffness == pytest.approx(16 / 3 * a**3 / compliance(hertz), rel=1e-14)
    assert small.moment / small.angle == pytest.approx(small.stiffness, rel=1e-4)
    r = np.linspace(0, 0.8 * a, 9)
    adhesive = 3e-4 / (4 * pi * a**3) * r / np.sqrt(a**2 - r**2)
    np.testing.assert_allclose(small.Traction(r), adhesive, rtol=1e-4, atol=1e-12)


@pytest.mark.parametrize("value", [1e-300, 1e-160, 1e-18, 1e-9, 1e-3, 0.1, 0.5, 1.0, 2.0, 5.0])
def test_angle_and_moment_belong_together(value):
    hertz = KINDS["twist"][2]
    unit = FRICTION * hertz.peak * compliance(hertz) / 2
    states = [
        TwistPoint.FromAngle(hertz=hertz, angle=value * unit * part, friction=FRICTION)
        for part in (-1.0, 1.0, 1 - 1e-4, 1 + 1e-4)
    ]
    for state, sign in zip(states[:2], (-1, 1), strict=True):
        assert state.angle == pytest.approx(sign * value * unit, rel=1e-8)
    slope = (states[3].moment - states[2].moment) / (2e-4 * value * unit)
    rigid = states[1].stiffness * states[1].ratio ** 3  # discs t < c turn as one
    assert slope == pytest.approx(rigid, rel=2e-4 if value < 5 else 1e-2)
    assert states[2].ratio >= states[1].ratio >= states[3].ratio


def test_angles_without_end():
    hertz = KINDS["twist"][2]
    endless = TwistPoint.FromAngle(hertz=hertz, angle=-1e6, friction=FRICTION)
    assert (endless.moment, endless.ratio) == (-endless.limit, 0)
    assert made("twist", -1.0).angle == -inf
    for angle, friction in ((0.0, FRICTION), (1.0, 0.0)):
        state = TwistPoint.FromAngle(hertz=hertz, angle=angle, friction=friction)
        assert (state.moment, state.angle) == (0, 0)
