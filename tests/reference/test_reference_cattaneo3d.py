"""Cattaneo-Mindlin partial slip of spheres, first loading and reversal."""

from dataclasses import replace
from math import nan, pi

import numpy as np
import pytest

from ngslac.reference import CattaneoMindlinPoint, HertzPoint

FRICTION, FORCE = 0.3, 120.0


@pytest.fixture
def hertz():
    """Two equal bodies, so that pressure and friction do not interact."""
    return HertzPoint(
        force=FORCE, radius1=30, radius2=60, young1=2e4, nu1=0.25, young2=2e4, nu2=0.25
    )


@pytest.fixture
def similar():
    """Different materials with one and the same (1 - 2 nu)/G: the contact is uncoupled too."""
    nu1, nu2 = 0.2, 0.35
    shear = [(1 - 2 * nu) / 1e-4 for nu in (nu1, nu2)]
    young1, young2 = (2 * g * (1 + nu) for g, nu in zip(shear, (nu1, nu2), strict=True))
    return HertzPoint(
        force=FORCE, radius1=30, radius2=60, young1=young1, nu1=nu1, young2=young2, nu2=nu2
    )


@pytest.fixture
def partial(hertz):
    return CattaneoMindlinPoint(hertz=hertz, shear=20.0, friction=FRICTION)


def surface_motion(state, x, y):
    """Motion of the slave's surface against the master's under the tractions of `state`.

    Cerruti's point forces, ((1 - nu) I + nu e e^T)/(2 pi G distance), with polar coordinates at
    (x, y): along a whole line at distance d, sqrt(c^2 - r^2) adds up to pi (c^2 - d^2)/2.
    """
    hertz, c = state.hertz, state.stick
    a, r, towards = hertz.contact_radius, np.hypot(x, y), np.arctan2(y, x)
    touch = np.arcsin(c / r) if r > c else 0.5 * pi  # lines beyond this angle miss the stick zone
    nodes, weights = np.polynomial.legendre.leggauss(60)
    total = np.zeros(2)
    for low, high in ((-touch, touch), (touch, pi - touch)):
        theta = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        d = r * np.sin(theta)
        line = np.maximum(a**2 - d**2, 0) - np.maximum(c**2 - d**2, 0)
        line *= (
            0.25 * pi * (high - low) * weights * np.sign(state.shear) * FRICTION * hertz.peak / a
        )
        u, v = np.cos(theta + towards), np.sin(theta + towards)
        for young, nu in ((hertz.young1, hertz.nu1), (hertz.young2, hertz.nu2)):
            kernel = np.stack([1 - nu + nu * u * u, nu * u * v])
            total += kernel @ line * (1 + nu) / (pi * young)
    return total


def test_published_formula(hertz, partial):
    """T17 of the reference cases, with its own symbols."""
    a, p0 = hertz.contact_radius, hertz.peak
    c = a * (1 - 20 / (FRICTION * FORCE)) ** (1 / 3)
    assert partial.stick == pytest.approx(c, rel=1e-14)
    r = np.linspace(0, 0.99 * c, 7)
    expected = FRICTION * p0 * (np.sqrt(1 - r**2 / a**2) - c / a * np.sqrt(1 - r**2 / c**2))
    np.testing.assert_allclose(partial.Traction(r), expected, rtol=1e-12)


@pytest.mark.parametrize("shear", [-36.0, -7.0, 0.0, 0.1, 20.0, 36.0])
def test_traction_carries_the_load(hertz, integral, shear):
    state = CattaneoMindlinPoint(hertz=hertz, shear=shear, friction=FRICTION)
    a = hertz.contact_radius
    total = integral(lambda r: 2 * pi * r * state.Traction(r), 0, a, [state.stick])
    assert total == pytest.approx(shear, rel=1e-9, abs=1e-12)
    square = 2 * a * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    assert state.MeanTraction(square) * 16 * a**2 == pytest.approx(shear, rel=1e-12)


@pytest.mark.parametrize("bodies", ["hertz", "similar"])
def test_slip_is_that_of_cerruti_point_forces(bodies, request):
    state = CattaneoMindlinPoint(
        hertz=request.getfixturevalue(bodies), shear=20.0, friction=FRICTION
    )
    a, c = state.hertz.contact_radius, state.stick
    rim = [(c + part * (a - c)) for part in (0.05, 0.5, 1.0)]
    for r in (0.0, 0.5 * c, 0.99 * c, *rim):
        for angle in (0.0, 0.7, 2.0):
            x, y = r * np.cos(angle), r * np.sin(angle)
            motion = surface_motion(state, x, y) - np.array([state.shift, 0.0])
            np.testing.assert_allclose(
                state.Slip(x * (1 - 1e-15), y * (1 - 1e-15)), motion, atol=1e-9 * state.shift
            )


def test_shift_is_the_motion_of_the_middle(hertz, partial, integral):
    """For two bodies of shear modulus G; small loads have the stiffness of full adhesion."""
    a, shear_modulus = hertz.contact_radius, 2e4 / 2.5
    line = integral(partial.Traction, 0, a, [partial.stick])
    assert partial.shift == pytest.approx(2 * (2 - 0.25) / (2 * shear_modulus) * line, rel=1e-9)
    mindlin = 3 * FRICTION * FORCE * 1.75 / (8 * shear_modulus * a)
    published = mindlin * (1 - (1 - 20 / (FRICTION * FORCE)) ** (2 / 3))
    assert partial.shift == pytest.approx(published, rel=1e-12)
    small = replace(partial, shear=1e-6)
    assert small.shift == pytest.approx(1e-6 * 1.75 / (4 * shear_modulus * a), rel=1e-6)


@pytest.mark.parametrize("shear", [-36.0, -7.0, 0.0, 0.1, 20.0])
def test_state_of_a_shift(hertz, shear):
    state = CattaneoMindlinPoint(hertz=hertz, shear=shear, friction=FRICTION)
    back = CattaneoMindlinPoint.FromShift(hertz=hertz, shift=state.shift, friction=FRICTION)
    assert back.shear == pytest.approx(shear, rel=1e-12)


def test_coulomb_law(partial):
    a, c = partial.hertz.contact_radius, partial.stick
    r = np.linspace(0, 1.2 * a, 241)
    traction, limit = partial.Traction(r), FRICTION * partial.hertz.Pressure(r)
    assert (np.abs(traction) <= limit * (1 + 1e-13)).all()
    slips = (r > c) & (r < a)
    np.testing.assert_allclose(traction[slips], limit[slips], rtol=1e-14)
    for angle in (0.0, 0.5, 1.5):
        along, across = partial.Slip(r[slips] * np.cos(angle), r[slips] * np.sin(angle))
        assert (along < 0).all()
        # The stated flaw of the solution: slip is nearly, not quite, along the traction.
        assert (np.abs(across) < 0.25 / (4 - 0.5) * 2 * np.abs(along)).all()
        assert across[-1] == 0 if angle == 0 else abs(across[-1]) > 0
    assert partial.Slip(0.4 * c, 0.3 * c) == (0, 0)
    assert np.isnan(partial.Slip(a, 0.1 * a)).all()


def test_limits_of_the_load(hertz):
    r = np.linspace(0, hertz.contact_radius, 11)
    none = CattaneoMindlinPoint(hertz=hertz, shear=0.0, friction=FRICTION)
    assert (none.ratio, none.shift) == (1, 0)
    assert (none.Traction(r) == 0).all()
    sliding = CattaneoMindlinPoint(hertz=hertz, shear=-36.0, friction=FRICTION)
    assert sliding.ratio == 0
    np.testing.assert_allclose(sliding.Traction(r), -FRICTION * hertz.Pressure(r), rtol=1e-14)


def test_reversal_follows_mindlin_and_deresiewicz(hertz, partial, integral):
    back = partial.Reverse(4.0)
    a, limit = hertz.contact_radius, FRICTION * FORCE
    assert back.stick == pytest.approx(a * (1 - 16 / (2 * limit)) ** (1 / 3), rel=1e-14)
    scale = 3 * limit * 1.75 / (8 * 8e3 * a)
    curve = 2 * (1 - 16 / (2 * limit)) ** (2 / 3) - (1 - 20 / limit) ** (2 / 3) - 1
    assert back.shift == pytest.approx(scale * curve, rel=1e-12)
    cuts = [partial.stick, back.stick]
    total = integral(lambda r: 2 * pi * r * back.Traction(r), 0, a, cuts)
    assert total == pytest.approx(4.0, rel=1e-9)
    r = np.linspace(1.001 * back.stick, 0.999 * a, 7)
    np.testing.assert_allclose(back.Traction(r), -FRICTION * hertz.Pressure(r), rtol=1e-11)
    frozen = 0.5 * (partial.stick + back.stick)
    assert back.Slip(frozen, 0.0) == partial.Slip(frozen, 0.0)


def test_reversal_ends(partial):
    r = np.linspace(0, partial.hertz.contact_radius, 21)
    np.testing.assert_array_equal(partial.Reverse(20.0).Traction(r), partial.Traction(r))
    mirrored = partial.Reverse(-20.0)
    assert mirrored.shift == pytest.approx(-partial.shift, rel=1e-13)
    np.testing.assert_allclose(mirrored.Traction(r), -partial.Traction(r), atol=1e-13)
    face = np.array([[0.1, 0.2], [0.5, 0.3], [0.3, 0.9]])
    assert mirrored.MeanTraction(face) == pytest.approx(-partial.MeanTraction(face), rel=1e-12)


def test_work_of_the_load_is_that_of_friction(hertz, partial, integral):
    """A cycle +-Q: area of the loop, its published value (Johnson, 7.4), and work of slip."""
    end, a, c = partial.Reverse(-20.0), hertz.contact_radius, partial.stick
    area = 2 * integral(lambda q: partial.Reverse(q).shift, -20.0, 20.0)
    limit, q = FRICTION * FORCE, 20 / (FRICTION * FORCE)
    rest = 1 - (1 - q) ** (5 / 3) - 5 * q / 6 * (1 + (1 - q) ** (2 / 3))
    published = 9 * limit**2 / (10 * a) * 2 * 1.75 / 8e3 * rest
    assert area == pytest.approx(published, rel=1e-9)

    nodes, weights = np.polynomial.legendre.leggauss(40)
    nodes, weights = 0.5 * (1 + nodes), 0.5 * weights
    # Graded to both borders of the slip zone, where the pressure has a root.
    r = c + (a - c) * nodes**2 * (3 - 2 * nodes)
    x, y = (r * f(0.5 * pi * nodes[:, None]) for f in (np.cos, np.sin))
    change = np.abs(end.Slip(x, y)[0] - partial.Slip(x, y)[0])
    rings = FRICTION * hertz.Pressure(r) * r * (a - c) * 6 * nodes * (1 - nodes) * weights
    work = 2 * 2 * pi * weights @ change @ rings
    assert work == pytest.approx(area, rel=1e-6)


def test_mindlin_point_refuses(hertz):
    state = CattaneoMindlinPoint(hertz=hertz, shear=10.0, friction=FRICTION)
    for shear in (37.0, -37.0):
        with pytest.raises(ValueError, match=r"shear = .* would slide, keep .* 36\.0"):
            replace(state, shear=shear)
    for name, bad in (("shear", nan), ("friction", -0.1)):
        with pytest.raises(ValueError, match=rf"{name} = {bad} is not valid"):
            replace(state, **{name: bad})
    with pytest.raises(ValueError, match=r"hertz = .*give both bodies the same material"):
        replace(state, hertz=replace(hertz, young2=1e4))
    with pytest.raises(ValueError, match=r"shear = .* <= \|start\.shear\| = 10\.0"):
        state.Reverse(-10.1)
    with pytest.raises(ValueError, match=r"shift = 1\.0 is not valid: the bodies would slide"):
        CattaneoMindlinPoint.FromShift(hertz=hertz, shift=1.0, friction=FRICTION)
    with pytest.raises(ValueError, match=r"r = .* is not valid: give finite"):
        state.Traction([0.0, nan])
    with pytest.raises(ValueError, match=r"y = .* is not valid: give finite"):
        state.Slip(0.0, nan)
