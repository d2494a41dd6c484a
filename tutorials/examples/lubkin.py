"""Partial slip of spheres that are twisted about their common normal (Lubkin)."""

from dataclasses import dataclass
from functools import cached_property
from math import exp, expm1, inf, pi
from typing import ClassVar

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipkinc, ellipkm1, elliprd

from ngslac.reference import HertzPoint
from ngslac.reference._checks import finite, instance, interval, nonnegative, points
from ngslac.reference._means import semi_ellipse
from ngslac.reference._polygons import PolygonEdges
from ngslac.reference.mindlin import PartialSlip, Reversal, superposed

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)
_DEEPEST, _SLIDES = 14.0, 1.0 - 1e-14  # log(a/c) and moment/limit of complete slip, to rounding


def _e_prime(s):
    """Complete elliptic integral E of modulus sqrt(1 - s^2)."""
    return ellipe(1.0 - s * s)


def _scaled_angle(depth):
    """K - E of modulus sqrt(1 - k^2) at k = exp(-depth), accurate for small depths as well."""
    return -expm1(-2.0 * depth) / 3.0 * float(elliprd(0.0, exp(-2.0 * depth), 1.0))


def _scaled_moment(depth):
    """Integral of s^2 E'(s) from exp(-depth) to 1, over that from 0."""
    half = -0.5 * expm1(-depth)
    s = 1.0 - half * (1.0 - _NODES)
    return float(half * (_WEIGHTS * s * s * _e_prime(s)).sum() / (3.0 * pi**2 / 64.0))


def tanh_sinh(count=26, step=0.12):
    """Nodes and weights on (-1, 1) of the double exponential rule (Takahasi and Mori, 1974)."""
    t = step * np.arange(-count, count + 1)
    nodes = np.tanh(0.5 * np.pi * np.sinh(t))
    weights = np.cosh(t) / np.cosh(0.5 * np.pi * np.sinh(t)) ** 2
    return nodes, 2.0 * weights / weights.sum()


def integral_mean(function, x0, x1, breaks):
    """Average `function` over the intervals from `x0` to `x1` by quadrature.

    The intervals are cut at `breaks`, where the function may have kinks or weak singularities;
    the double exponential rule does not lose accuracy at such ends (relative error about 1e-12).
    """
    x0, x1 = interval(x0, x1)
    low, high = np.minimum(x0, x1)[..., None], np.maximum(x0, x1)[..., None]
    inner = np.clip(np.sort(np.asarray(breaks, dtype=float)), low, high)
    ends = np.concatenate([low, inner, high], axis=-1)
    middle = 0.5 * (ends[..., 1:] + ends[..., :-1])[..., None]
    half = 0.5 * np.diff(ends, axis=-1)[..., None]
    nodes, weights = tanh_sinh()
    total = (function(middle + half * nodes) * half * weights).sum(axis=(-2, -1))
    return total / (high - low)[..., 0]


def _root_integral(edges, radius):
    """Integral of sqrt(radius^2 - x^2 - y^2) over the part of each edge in the disc."""
    half, *ends = edges.Chord(radius)

    def primitive(s):
        root = np.sqrt(np.maximum(half**2 - s**2, 0.0))
        return 0.5 * (s * root + half**2 * np.arctan2(s, root))

    return primitive(ends[1]) - primitive(ends[0])


def _depth_of(function, slope, value, most):
    """The depth, at most `most`, where a function of it has a value; `slope` is that at 0."""
    least = value / slope
    if value < 1e-17:  # nothing else is left
        return least
    return brentq(lambda depth: function(depth) - value, 0.5 * least, most, xtol=1e-15 * least)


@dataclass(frozen=True, kw_only=True)
class TwistPoint(PartialSlip):
    """A Hertz point contact, twisted about its normal after the normal load is complete.

    The contact sticks for r < c and slips for c < r < a, where the traction, around the normal,
    is F p. Twist and pressure do not interact, so the bodies may be of any materials, and one may
    be rigid. With k = c/a, k'^2 = 1 - k^2, 1/G* = 1/G1 + 1/G2, E'(s) = E(sqrt(1 - s^2)) and
    elliptic integrals of the modulus named::

        angle  = F p0 (K(k') - E(k')) / (2 G*),      moment = (8/3) F p0 a^3 int_k^1 s^2 E'(s) ds,
        tau(r) = F p0 sqrt(1 - r^2/a^2) (1 - L) for r < c,  tan(psi) = sqrt(c^2 - r^2)/(k' r),
        L      = (2/pi) (K(k') E(psi, k) - (K(k') - E(k')) F(psi, k)),   Heuman's function.

    For small moments, moment = (16/3) G* a^3 angle; the limit (3 pi/16) F P a belongs to an
    infinite angle.

    *Derivation.* A rigid disc of radius t twisted by phi has the traction
    (4 G* phi/pi) r/sqrt(t^2 - r^2) and the moment (16/3) G* t^3 phi (Reissner and Sagoci, 1944),
    and all points r < t turn by phi. The sum of discs c < t < a with
    tau(r) = r int w(t)/sqrt(t^2 - r^2) dt turns r < c as one body. That tau = F p for r > c is an
    Abel equation with the solution w(t) = (2/pi) F p0 E'(t/a)/t; the angle and the moment are
    sums over the discs. The derivative of L with respect to k confirms the traction.

    Sources: Lubkin, J. Appl. Mech. 18 (1951) 183; Hetenyi and McDonald, J. Appl. Mech. 25 (1958)
    396; Jager, Arch. Appl. Mech. 65 (1995) 478 for the sum over discs; Johnson, Contact Mechanics
    (Cambridge, 1985), chapter 7.

    Parameters
    ----------
    hertz : HertzPoint
        The normal contact; gives P, a, p0 and the elastic constants.
    moment : float
        Moment M about the normal of the tangential tractions on the slave, |M| <= 3 pi F P a/16;
        M > 0 where tractions go around the normal from x to y. Beyond, bodies would turn freely.
    friction : float
        Coefficient of friction F >= 0.

    Examples
    --------
    >>> hertz = HertzPoint(force=100, radius1=50, young1=1e5, nu1=0.3, young2=1e5, nu2=0.3)
    >>> twist = TwistPoint.FromAngle(hertz=hertz, angle=1.5e-3, friction=0.2)
    >>> print(f"{twist.ratio:.4f} {twist.moment / twist.limit:.4f}")
    0.4743 0.9132
    """

    hertz: HertzPoint
    moment: float
    friction: float
    _LOAD, _MOVE = "moment", "turn freely"
    _LIMIT = "3 pi/16 friction * hertz.force * a"

    @classmethod
    def FromAngle(cls, *, hertz, angle, friction) -> "TwistPoint":
        """State after the master has been turned by an angle, in radians, against the slave.

        Every finite angle has its state, in partial slip, but beyond about 5 F p0/G* the moment is
        the limit to rounding.
        """
        instance("hertz", hertz, HertzPoint)
        finite("angle", angle)
        nonnegative("friction", friction)
        unit = 0.5 * friction * hertz.peak * hertz._ShearSum()
        if angle == 0 or unit == 0:
            return cls(hertz=hertz, moment=0.0, friction=friction)
        value, part = abs(angle) / unit, 1.0
        if value < 2.0 * _DEEPEST:  # K - E lies between depth and pi/2 depth
            part = _scaled_moment(_depth_of(_scaled_angle, pi / 2, value, value))
        limit = cls(hertz=hertz, moment=0.0, friction=friction).limit
        return cls(hertz=hertz, moment=float(np.copysign(part * limit, angle)), friction=friction)

    @property
    def limit(self) -> float:
        """Moment (3 pi/16) F P a of complete slip (force times length)."""
        return 3.0 * pi / 16.0 * super().limit * self.hertz.contact_radius

    @property
    def stiffness(self) -> float:
        """Moment over angle for small moments, (16/3) G* a^3 (force times length)."""
        return 16.0 / 3.0 * self.hertz.contact_radius**3 / self.hertz._ShearSum()

    @cached_property
    def _depth(self):
        """log(a/c), from 0 (no moment) to inf (complete slip)."""
        if self.moment == 0:
            return 0.0
        part = abs(self.moment) / self.limit
        if part >= _SLIDES:
            return inf
        return _depth_of(_scaled_moment, 32.0 / (3.0 * pi), part, _DEEPEST)  # a concave function

    @property
    def ratio(self) -> float:
        """Stick ratio k = c/a, from 1 (no moment) to 0 (complete slip)."""
        return exp(-self._depth)

    @property
    def angle(self) -> float:
        """How far the master has turned against the slave, far from the contact, in radians.

        Of the sign of the moment; infinite for the limit moment.
        """
        if self.moment == 0:
            return 0.0
        value = _scaled_angle(self._depth) if self._depth < inf else inf
        return float(0.5 * self._scale * self.hertz._ShearSum() * value)

    def Traction(self, r) -> float | np.ndarray:
        """Traction on the slave around the normal, from x to y, see `HertzPoint.Pressure`."""
        r, a, k = np.abs(points("r", r)), self.hertz.contact_radius, self.ratio
        limit = self._scale * semi_ellipse(r, a)
        if self.moment == 0 or k == 0:
            return limit if k == 0 else np.zeros_like(r)[()]
        difference = _scaled_angle(self._depth)
        other = np.sqrt(-expm1(-2.0 * self._depth))
        psi = np.arctan2(np.sqrt(np.maximum((k * a) ** 2 - r**2, 0.0)), other * r)
        lag = ellipkm1(k * k) * ellipeinc(psi, k * k) - difference * ellipkinc(psi, k * k)
        return limit * np.where(r < k * a, np.maximum(1.0 - 2.0 / pi * lag, 0.0), 1.0)[()]

    def MeanTraction(self, vertices) -> float | np.ndarray:
        """Average of the traction over polygons, to about 1e-12, see `HertzPoint.MeanPressure`.

        Components (..., 2) along x and y. By Stokes' theorem the sum over discs becomes one
        integral for each edge.
        """
        edges = PolygonEdges.FromVertices(vertices)
        if self.moment == 0:
            return np.zeros((*edges.area.shape, 2))
        a, c = self.hertz.contact_radius, self.stick

        def density(t):
            t = np.maximum(t, 1e-200 * a)
            return _e_prime(t / a) / t * _root_integral(edges, t)

        radii = (np.hypot(s, edges.distance) for s in (edges.start, edges.end))
        breaks = np.stack([np.abs(edges.distance), *radii], axis=-1)
        shape = edges.start.shape
        mean = integral_mean(density, np.full(shape, c), np.full(shape, a), breaks)
        flow = (edges.tangent * mean[..., None]).sum(axis=-2) / edges.area[..., None]
        return -2.0 / pi * self._scale * (a - c) * flow

    def Slip(self, r) -> float | np.ndarray:
        """Slip (length) of the slave against the master, with `r` as in `TwistPoint.Traction`.

        Around the normal from x to y: zero in stick, against the traction in slip, NaN for r > a,
        where the surfaces do not touch; infinite for the limit moment. From the rotation of the
        discs t < r as seen at r.
        """
        r, a = np.abs(points("r", r)), self.hertz.contact_radius
        c = self.stick
        if c == 0:
            return np.where(r <= a, -self._scale * np.where(r > 0, inf, 0.0), np.nan)[()]
        top = np.arccos(c / np.maximum(r, c))[..., None]
        nodes, weights = tanh_sinh()
        chi = 0.5 * top * (1.0 + nodes)
        shape = np.tan(chi) * (chi + 0.5 * np.sin(2.0 * chi))
        lag = (0.5 * top * weights * shape * _e_prime(r[..., None] / a * np.cos(chi))).sum(axis=-1)
        slip = -self._scale * self.hertz._ShearSum() / pi * r * lag
        return np.where(r <= a, slip, np.nan)[()]

    def Reverse(self, moment) -> "TwistReversal":
        """State after the moment has gone back to `moment`."""
        return TwistReversal(start=self, moment=moment)


@dataclass(frozen=True, kw_only=True)
class TwistReversal(Reversal):
    """A twisted point contact whose moment is brought back, once and steadily.

    The state is found as in `MindlinReversal`. Sources: Deresiewicz, J. Appl. Mech. 21 (1954) 52;
    Jager, Arch. Appl. Mech. 65 (1995) 478.

    Examples
    --------
    >>> hertz = HertzPoint(force=100, radius1=50, young1=1e5, nu1=0.3, young2=1e5, nu2=0.3)
    >>> twist = TwistPoint.FromAngle(hertz=hertz, angle=1.5e-3, friction=0.2)
    >>> print(f"{twist.Reverse(0).angle / twist.angle:.4f}")
    0.4592
    """

    start: TwistPoint
    moment: float
    _LOAD: ClassVar[str] = "moment"

    angle = property(superposed(TwistPoint.angle.fget))
    Traction = superposed(TwistPoint.Traction)
    MeanTraction = superposed(TwistPoint.MeanTraction)
    Slip = superposed(TwistPoint.Slip)
