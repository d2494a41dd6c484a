"""The twisted contact against ring loads on a half-space, with and without its closed form."""

from math import pi

import numpy as np
import pytest
from scipy.special import ellipe, ellipkm1

from ngslac.reference import HertzPoint, TwistPoint

FRICTION = 0.3


@pytest.fixture
def hertz():
    """Different materials: twist and pressure do not interact."""
    return HertzPoint(
        force=120.0, radius1=30, radius2=60, young1=2e4, nu1=0.25, young2=5e4, nu2=0.4
    )


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


def surface_motion(twist, r, integral):
    """Motion around the axis of the slave's surface against the master's at r."""
    a = twist.hertz.contact_radius
    total = integral(lambda s: s * twist.Traction(s) * ring_kernel(r, s), 0, a, [r, twist.stick])
    return compliance(twist.hertz) * total / (2 * pi)


def test_ring_kernel_is_independent_of_poissons_ratio(integral):
    """Cerruti's displacement (1 - nu) f/d + nu (f.e) e/d of tangential forces around a ring."""
    r, s = 0.7, 1.3
    for nu in (0.0, 0.3, 0.5):

        def motion(t, nu=nu):
            d = np.array([r - s * np.cos(t), -s * np.sin(t)])
            far = np.hypot(*d)
            force = np.array([-np.sin(t), np.cos(t)])
            return (1 - nu) * force[1] / far + nu * (force @ d) * d[1] / far**3

        assert integral(motion, 0, 2 * pi) == pytest.approx(ring_kernel(r, s), rel=1e-8)


@pytest.mark.parametrize("part", [0.05, 0.5, 0.95])
def test_stick_turns_as_one_body_and_slip_is_the_rest(hertz, integral, part):
    limit = TwistPoint(hertz=hertz, moment=0.0, friction=FRICTION).limit
    state = TwistPoint(hertz=hertz, moment=part * limit, friction=FRICTION)
    a, c = hertz.contact_radius, state.stick
    for r in (0.1 * c, 0.6 * c, 0.98 * c):
        assert surface_motion(state, r, integral) == pytest.approx(state.angle * r, rel=1e-7)
        assert state.Slip(r) == 0
    for r in (c + 0.1 * (a - c), 0.5 * (a + c), 0.999 * a):
        slip = surface_motion(state, r, integral) - state.angle * r
        assert slip < 0
        assert state.Slip(r) == pytest.approx(slip, rel=1e-6, abs=1e-9 * state.angle * a)


def collocation(hertz, angle, rings):
    """Ring tractions on a half-space with Coulomb friction, by active sets; no theory of stick."""
    a = hertz.contact_radius
    edge = a * np.sin(0.5 * pi * np.linspace(0, 1, rings + 1))
    middle = 0.5 * (edge[1:] + edge[:-1])
    nodes, weights = np.polynomial.legendre.leggauss(16)
    # Cut each ring at its middle, where the kernel is logarithmic: v^3 grading to both sides.
    v, factor = 0.5 * (1 + nodes), 0.5 * weights
    matrix = np.zeros((rings, rings))
    for end in (edge[:-1], edge[1:]):
        s = middle + (end - middle) * v[:, None] ** 3
        jacobian = np.abs(end - middle) * 3 * (v**2 * factor)[:, None]
        kernel = ring_kernel(middle[:, None, None], s.T[None])
        matrix += (kernel * (s * jacobian).T[None]).sum(axis=-1)
    matrix *= compliance(hertz) / (2 * pi)
    limit = FRICTION * hertz.Pressure(middle)
    stick = np.ones(rings, dtype=bool)
    for _ in range(rings):
        traction = limit.copy()
        rest = angle * middle - matrix[:, ~stick] @ limit[~stick]
        traction[stick] = np.linalg.solve(matrix[np.ix_(stick, stick)], rest[stick])
        slip = angle * middle - matrix @ traction
        if (traction <= limit).all():
            break
        stick &= traction <= limit
    assert (slip[~stick] > 0).all()
    moment = 2 * pi / 3 * ((edge[1:] ** 3 - edge[:-1] ** 3) * traction).sum()
    return moment, edge[1:][stick].max(), middle, traction


@pytest.mark.parametrize("value", [0.1, 0.5, 1.5])
def test_against_a_numerical_solution_with_coulomb_friction(hertz, value):
    angle = value * FRICTION * hertz.peak * compliance(hertz) / 2
    exact = TwistPoint.FromAngle(hertz=hertz, angle=angle, friction=FRICTION)
    moment, stick, r, traction = collocation(hertz, angle, 100)
    a = hertz.contact_radius
    assert moment == pytest.approx(exact.moment, rel=3e-4)
    assert abs(stick - exact.stick) < 0.01 * a
    away = np.abs(r - exact.stick) > 0.05 * a
    np.testing.assert_allclose(
        traction[away], exact.Traction(r[away]), atol=2e-3 * FRICTION * hertz.peak
    )
