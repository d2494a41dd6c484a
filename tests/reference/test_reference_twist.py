"""Spheres pressed together and twisted: partial slip around the normal."""

from dataclasses import replace
from math import inf, nan, pi, sqrt

import numpy as np
import pytest
from scipy.special import ellipe, ellipk

from ngslac.reference import HertzPoint, TwistPoint

FRICTION = 0.3


@pytest.fixture
def hertz():
    """Different materials: twist and pressure do not interact."""
    return HertzPoint(
        force=120.0, radius1=30, radius2=60, young1=2e4, nu1=0.25, young2=5e4, nu2=0.4
    )


@pytest.fixture
def twist(hertz):
    limit = 3 * pi / 16 * FRICTION * hertz.force * hertz.contact_radius
    return TwistPoint(hertz=hertz, moment=0.7 * limit, friction=FRICTION)


def compliance(hertz):
    """1/G* = 1/G1 + 1/G2."""
    return 2 * (1 + hertz.nu1) / hertz.young1 + 2 * (1 + hertz.nu2) / hertz.young2


def test_limit_moment_is_that_of_friction_everywhere(hertz, integral):
    a = hertz.contact_radius
    total = integral(lambda r: 2 * pi * r**2 * FRICTION * hertz.Pressure(r), 0, a)
    sliding = TwistPoint(hertz=hertz, moment=total, friction=FRICTION)
    assert sliding.limit == pytest.approx(3 * pi / 16 * FRICTION * 120 * a, rel=1e-14)
    assert sliding.limit == pytest.approx(total, rel=1e-9)
    exact = replace(sliding, moment=-sliding.limit)
    assert (exact.ratio, exact.angle) == (0, -inf)
    r = np.linspace(0.01, 1.2, 13) * a
    np.testing.assert_allclose(exact.Traction(r), -FRICTION * hertz.Pressure(r), rtol=1e-14)


def test_small_moments_have_the_solution_of_reissner_and_sagoci(hertz):
    a = hertz.contact_radius
    small = TwistPoint(hertz=hertz, moment=1e-4, friction=FRICTION)
    stiffness = 16 / 3 * a**3 / compliance(hertz)
    assert small.stiffness == pytest.approx(stiffness, rel=1e-14)
    assert small.moment / small.angle == pytest.approx(stiffness, rel=1e-4)
    r = np.linspace(0, 0.8 * a, 9)
    adhesive = 3e-4 / (4 * pi * a**3) * r / np.sqrt(a**2 - r**2)
    np.testing.assert_allclose(small.Traction(r), adhesive, rtol=1e-4, atol=1e-12)
    none = replace(small, moment=0.0)
    assert (none.ratio, none.angle, none.stick) == (1, 0, a)
    assert (none.Traction(r) == 0).all()
    assert (none.MeanTraction([[0, 0], [1, 0], [0, 1]]) == 0).all()


@pytest.mark.parametrize("part", [-0.999999, -0.5, 1e-5, 1e-3, 0.3, 0.9, 0.9999])
def test_traction_carries_the_moment(hertz, integral, part):
    a = hertz.contact_radius
    limit = TwistPoint(hertz=hertz, moment=0.0, friction=FRICTION).limit
    state = TwistPoint(hertz=hertz, moment=part * limit, friction=FRICTION)
    c = state.stick
    stuck = integral(lambda v: 2 * pi * v * (c**2 - v**2) ** 0.5 * around(state, v), 0, c)
    slipping = integral(
        lambda v: 2 * pi * v * (a**2 - v**2) ** 0.5 * rim(state, v), 0, sqrt(a**2 - c**2)
    )
    assert stuck + slipping == pytest.approx(part * limit, rel=1e-8)


def around(state, v):
    """Traction at r = sqrt(c^2 - v^2): smooth in v at the border of stick."""
    return state.Traction(sqrt(max(state.stick**2 - v**2, 0.0)) * (1 - 1e-16))


def rim(state, v):
    """Traction at r = sqrt(a^2 - v^2): smooth in v at the edge."""
    return state.Traction(sqrt(state.hertz.contact_radius**2 - v**2))


def test_traction_sums_up_rigid_discs(twist, integral):
    """The sum of Reissner-Sagoci tractions behind the closed form, by quadrature."""
    a, c = twist.hertz.contact_radius, twist.stick
    scale = 2 / pi * FRICTION * twist.hertz.peak
    for r in (1e-3 * c, 0.3 * c, 0.9 * c, c, 0.5 * (a + c), 0.99 * a):
        low, high = np.arcsin(r / a), np.arcsin(min(r / c, 1.0))
        total = integral(lambda t, r=r: ellipe(1 - (r / (a * np.sin(t))) ** 2), low, high)
        assert twist.Traction(r) == pytest.approx(scale * total, rel=1e-9)


def test_angle_and_stick_radius_in_elliptic_integrals(twist):
    m = 1 - twist.ratio**2
    unit = FRICTION * twist.hertz.peak * compliance(twist.hertz) / 2
    assert twist.angle == pytest.approx(unit * (ellipk(m) - ellipe(m)), rel=1e-12)


def test_angle_and_moment_belong_together(hertz, twist):
    unit = FRICTION * hertz.peak * compliance(hertz) / 2
    ratios = []
    for value in (1e-9, 1e-3, 0.1, 0.5, 1.0, 2.0, 5.0):
        for sign in (-1, 1):
            angle = sign * value * unit
            state = TwistPoint.FromAngle(hertz=hertz, angle=angle, friction=FRICTION)
            assert state.angle == pytest.approx(angle, rel=1e-8)
        ratios.append(state.ratio)
        step = 1e-4 * value * unit
        more, less = (
            TwistPoint.FromAngle(hertz=hertz, angle=angle + s * step, friction=FRICTION)
            for s in (1, -1)
        )
        slope = (more.moment - less.moment) / (2 * step)  # discs t < c turn as one
        rigid = twist.stiffness * state.ratio**3
        assert slope == pytest.approx(rigid, rel=2e-4 if value < 5 else 1e-2)
    assert (np.diff(ratios) < 0).all()
    far = TwistPoint.FromAngle(hertz=hertz, angle=100 * unit, friction=FRICTION)
    assert far.moment == pytest.approx(far.limit, rel=1e-14)
    endless = TwistPoint.FromAngle(hertz=hertz, angle=-1e6, friction=FRICTION)
    assert (endless.moment, endless.ratio) == (-endless.limit, 0)
    assert TwistPoint.FromAngle(hertz=hertz, angle=0.0, friction=FRICTION).moment == 0
    assert TwistPoint.FromAngle(hertz=hertz, angle=1.0, friction=0.0).moment == 0


def test_coulomb_law(twist):
    a, c = twist.hertz.contact_radius, twist.stick
    r = np.linspace(0, 1.2 * a, 241)
    traction, limit = twist.Traction(r), FRICTION * twist.hertz.Pressure(r)
    assert (traction <= limit * (1 + 1e-13)).all()
    assert (traction[r < 0.99 * c] < limit[r < 0.99 * c]).all()
    slips = (r > c) & (r < a)
    np.testing.assert_allclose(traction[slips], limit[slips], rtol=1e-14)
    assert (twist.Slip(r[slips]) < 0).all()
    assert np.isnan(twist.Slip(1.01 * a))
    assert twist.Traction(0.0) == pytest.approx(0, abs=1e-14 * limit[0])
    assert twist.Traction(c * (1 - 1e-12)) == pytest.approx(twist.Traction(c), rel=1e-5)


@pytest.mark.parametrize(
    "corners",
    [
        [[0.1, 0.2], [0.4, 0.3], [0.2, 0.6]],
        [[-0.3, -0.2], [0.5, -0.1], [0.1, 0.4]],
        [[0.5, 0.5], [1.2, 0.4], [0.6, 1.3]],
        [[0.0, 0.0], [0.7, 0.0], [0.9, 0.8], [0.0, 0.7]],
    ],
)
def test_mean_traction_is_the_average(twist, corners):
    """Against the average over many small triangles of the values in their middles."""
    a = twist.hertz.contact_radius
    corners = a * np.array(corners)
    fan = [corners[[0, k, k + 1]] for k in range(1, len(corners) - 1)]
    total, area = np.zeros(2), 0.0
    n = 400
    i, j = (k.ravel() for k in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    up, down = i + j < n, i + j < n - 1
    for origin, first, second in fan:
        s = np.concatenate([(i[up] + 1 / 3), (i[down] + 2 / 3)]) / n
        t = np.concatenate([(j[up] + 1 / 3), (j[down] + 2 / 3)]) / n
        x, y = origin[:, None] + np.outer(first - origin, s) + np.outer(second - origin, t)
        r = np.hypot(x, y)
        size = 0.5 * np.linalg.det([first - origin, second - origin])
        total += size * np.array(
            [(-y / r * twist.Traction(r)).mean(), (x / r * twist.Traction(r)).mean()]
        )
        area += size
    mean = twist.MeanTraction(corners)
    np.testing.assert_allclose(mean, total / area, atol=2e-5 * FRICTION * twist.hertz.peak)
    np.testing.assert_allclose(twist.MeanTraction(corners[::-1]), mean, rtol=1e-11)


def test_mean_traction_of_many_faces_carries_the_moment(twist):
    a = twist.hertz.contact_radius
    moments = []
    for n in (10, 20):
        x = np.linspace(-1.1 * a, 1.1 * a, n + 1)
        grid = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1)
        faces = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=-2)
        means = twist.MeanTraction(faces)
        middle, area = faces.mean(axis=-2), (x[1] - x[0]) ** 2
        force = (means * area).sum(axis=(0, 1))
        np.testing.assert_allclose(force, 0, atol=1e-12 * FRICTION * twist.hertz.force)
        moments.append(
            area * (middle[..., 0] * means[..., 1] - middle[..., 1] * means[..., 0]).sum()
        )
    errors = np.abs(np.array(moments) / twist.moment - 1)
    assert errors[0] < 0.02  # the moment of each traction about the middle of its face
    assert errors[1] < 0.002


def test_mean_tractions_of_parts_add_up(twist):
    a = twist.hertz.contact_radius
    whole = a * np.array([[0.2, -0.1], [1.3, 0.2], [0.1, 0.9]])
    middle = whole.mean(axis=0)
    parts = np.stack([[whole[k], whole[(k + 1) % 3], middle] for k in range(3)])
    np.testing.assert_allclose(
        twist.MeanTraction(parts).mean(axis=0), twist.MeanTraction(whole), rtol=1e-11
    )


def test_reversal(twist, integral):
    a = twist.hertz.contact_radius
    back = twist.Reverse(0.1 * twist.moment)
    cuts = [twist.stick, back.stick]
    total = integral(
        lambda v: 2 * pi * v * np.sqrt(a**2 - v**2) * back.Traction(np.sqrt(a**2 - v**2)),
        0,
        a,
        [sqrt(a**2 - c**2) for c in cuts],
    )
    assert total == pytest.approx(back.moment, rel=1e-7)
    r = np.linspace(1.001 * back.stick, a, 7)
    np.testing.assert_allclose(back.Traction(r), -FRICTION * twist.hertz.Pressure(r), atol=1e-11)
    frozen = 0.5 * (twist.stick + back.stick)
    assert back.Slip(frozen) == twist.Slip(frozen)
    mirrored = twist.Reverse(-twist.moment)
    assert mirrored.angle == pytest.approx(-twist.angle, rel=1e-12)
    assert mirrored.stick == pytest.approx(twist.stick, rel=1e-12)
    assert twist.Reverse(twist.moment).angle == twist.angle


def test_work_of_the_moment_is_that_of_friction(twist, integral):
    """A cycle +-M: area of the loop and work of slip."""
    top, end = twist.moment, twist.Reverse(-twist.moment)
    area = 2 * integral(lambda m: twist.Reverse(m).angle, -top, top)

    def power(r):
        slip = end.Slip(r) - twist.Slip(r)
        return 2 * 2 * pi * r * FRICTION * twist.hertz.Pressure(r) * abs(slip)

    work = integral(power, twist.stick, twist.hertz.contact_radius)
    assert work == pytest.approx(area, rel=1e-7)


def test_one_body_may_be_rigid(hertz):
    equal = replace(hertz, young2=hertz.young1, nu2=hertz.nu1)
    rigid = replace(hertz, young2=inf, nu2=0.0)
    states = [TwistPoint.FromAngle(hertz=h, angle=1e-3, friction=FRICTION) for h in (equal, rigid)]
    for state in states:
        assert state.angle == pytest.approx(1e-3, rel=1e-9)
    assert states[1].stiffness / states[1].hertz.contact_radius ** 3 == pytest.approx(
        2 * states[0].stiffness / states[0].hertz.contact_radius ** 3, rel=1e-13
    )


def test_twist_refuses(hertz, twist):
    for sign in (-1, 1):
        with pytest.raises(ValueError, match=r"moment = .* would turn freely, keep"):
            replace(twist, moment=sign * 1.001 * twist.limit)
    for name, bad in (("moment", nan), ("friction", -0.1), ("friction", inf)):
        with pytest.raises(ValueError, match=rf"{name} = {bad} is not valid"):
            replace(twist, **{name: bad})
    with pytest.raises(ValueError, match=r"angle = nan is not valid"):
        TwistPoint.FromAngle(hertz=hertz, angle=nan, friction=FRICTION)
    with pytest.raises(ValueError, match=r"moment = .* \|start\.moment\|"):
        twist.Reverse(1.01 * twist.moment)
    with pytest.raises(ValueError, match=r"r = .* is not valid: give finite"):
        twist.Traction([0.0, nan])
    with pytest.raises(ValueError, match=r"(?s)vertices = .*nonzero area"):
        twist.MeanTraction([[0, 0], [1, 1], [2, 2]])


@pytest.mark.parametrize("angle", [1e-18, 1e-160, 1e-300])
def test_tiny_angles(angle):
    hertz = HertzPoint(force=100, radius1=50, young1=1e5, nu1=0.3, young2=1e5, nu2=0.3)
    twist = TwistPoint.FromAngle(hertz=hertz, angle=angle, friction=0.2)
    assert twist.moment == pytest.approx(twist.stiffness * angle, rel=1e-12)
    assert twist.angle == pytest.approx(angle, rel=1e-12)
