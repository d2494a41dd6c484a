"""Two bodies of different materials, pressed together ever harder with friction (Spence)."""

from dataclasses import dataclass
from math import exp, inf, pi, sqrt

import numpy as np
from lubkin import integral_mean
from scipy.special import ellipkinc, xlogy

from ngslac.reference import HertzLine
from ngslac.reference._checks import finite, instance, nonnegative, points


def _theta(nome):
    """Jacobi's constants theta2(q), theta3(q) to full precision for q <= exp(-pi)."""
    theta2 = 2.0 * nome**0.25 * (1.0 + nome**2 + nome**6 + nome**12)
    return theta2, 1.0 + 2.0 * (nome + nome**4 + nome**9)


@dataclass(frozen=True, kw_only=True)
class StickZone:
    """Friction of two dissimilar half-planes pressed together ever harder.

    Under pressure the two surfaces want to move inwards by different amounts; friction holds them
    together in a stick zone |x| < k a, which keeps its share k of the contact |x| < a as the load
    grows. Pressure is taken from the frictionless problem (Goodman's approximation).

    *Derivation.* Let t = x/a. An increment of the load of a Hertz contact has the pressure of a
    flat punch, dp ~ 1/sqrt(1 - t^2), and an odd friction increment dq with dq = F dp sign(beta t)
    for k < |t| < 1, where it slips, and ``beta dp + (1/pi) pv int dq(s)/(t - s) ds = 0`` for
    |t| < k, where it sticks. For H(z) = (1/pi) int dq(s)/(s - z) ds the function
    W = sqrt(z^2 - 1) H maps the upper half plane onto a rectangle of width 2F and height |beta|:
    Im W = 0 for |t| > 1, Re W = -F sign(t) in slip, Im W = beta in stick (all for beta > 0). So W
    is the elliptic integral of the Schwarz-Christoffel formula with corners at +-k and +-1, hence

    * K(k)/K(sqrt(1 - k^2)) = F/|beta|, where K takes the modulus;
    * dq/dp = F E(t), E(t) = F_ell(arcsin(t/k), k)/K(k), for the punch in stick.

    Adding up the increments at all half widths s from |x| to a, and integrating by parts,

    * q/p = F (E(t) + t artanh(sqrt(1 - t^2/k^2))/(k K(k) sqrt(1 - t^2))) for Hertz in stick.

    Sources: Spence, Proc. Camb. Phil. Soc. 73 (1973) 249 and J. Elasticity 5 (1975) 297 for the
    problem and its self-similarity; the closed forms are derived above.

    Parameters
    ----------
    beta : float
        Second Dundurs constant with body 1 as the slave, see `DundursBeta`.
    friction : float
        Coefficient of friction F >= 0.

    Raises
    ------
    ValueError
        If beta is not finite, or the friction negative or not finite.

    Examples
    --------
    >>> zone = StickZone(beta=1 / 7, friction=0.2)
    >>> print(f"{zone.ratio:.4f} {zone.HertzFriction(0.5) / 0.2:.3f}")
    0.9063 0.597
    """

    beta: float
    friction: float

    def __post_init__(self):
        finite("beta", self.beta)
        nonnegative("friction", self.friction)

    @property
    def _solution(self):
        """The stick ratio k, and F/K(k), both without cancellation at either end."""
        beta, friction = abs(self.beta), self.friction
        if beta == 0 or friction == 0:
            return (1.0 if beta == 0 else 0.0), 0.0
        low, high = sorted([beta, friction])
        theta2, theta3 = _theta(exp(-pi * high / low))
        small, integral = (theta2 / theta3) ** 2, 0.5 * pi * theta3**2
        if friction <= beta:  # small = k, integral = K(k)
            return small, friction / integral
        return sqrt(1.0 - small**2), beta / integral  # small = sqrt(1 - k^2)

    @property
    def ratio(self) -> float:
        """Stick ratio k = c/a; 1 for beta = 0 (nothing slips), 0 without friction.

        Found from the nome exp(-pi |beta|/F) by Jacobi's theta functions, k = (theta2/theta3)^2.
        """
        return self._solution[0]

    def PunchFriction(self, t) -> float | np.ndarray:
        """Tangential traction on the slave over pressure, for a flat punch.

        Parameters
        ----------
        t : float or array
            Distance from the middle over the half width, x/a.

        Returns
        -------
        float or array
            Of the shape of `t`, without unit.
        """
        return self._Friction(t, lambda sine, angle, k: ellipkinc(angle, k**2))

    def HertzFriction(self, t) -> float | np.ndarray:
        """Tangential traction on the slave over pressure, for two cylinders.

        Like the traction, it points away from the middle for beta > 0, and vanishes with the
        pressure outside the contact. Its argument is as in `StickZone.PunchFriction`.
        """

        def stick(sine, angle, k):
            history = sine * np.log1p(np.cos(angle)) - xlogy(sine, sine)
            return ellipkinc(angle, k**2) + history / np.sqrt(1.0 - (k * sine) ** 2)

        return self._Friction(t, stick)

    def _Friction(self, t, stick):
        t = points("t", t)
        k, scale = self._solution
        distance, limit = np.abs(t), self.friction
        if self.beta == 0 or limit == 0:
            return np.zeros_like(t)[()]
        sticks = distance < k
        sine = np.where(sticks, distance, 0.0) / (k or inf)
        value = np.minimum(scale * stick(sine, np.arcsin(sine), k), limit)
        value = np.where(sticks, value, np.where(distance < 1.0, limit, 0.0))
        return (np.sign(self.beta * t) * value)[()]


@dataclass(frozen=True, kw_only=True)
class SpenceLine:
    """A Hertz line contact with Coulomb friction under a normal load that grows from zero.

    The stick zone |x| < c grows with the contact, c = k a; outside it |tau| = F p. The formulas
    and their derivation are in `StickZone`. They hold for a load that has never been taken back.
    A discrete load history must have several steps: in one single step the stick zone and the
    tractions are those of another problem. Source: Spence, Proc. Camb. Phil. Soc. 73 (1973) 249.

    Parameters
    ----------
    hertz : HertzLine
        The normal contact; body 1 is the slave.
    friction : float
        Coefficient of friction F >= 0.

    Raises
    ------
    ValueError
        If the friction is negative or not finite.

    Examples
    --------
    >>> hertz = HertzLine(force=350, radius1=50, young1=210e3, nu1=0.3, young2=70e3, nu2=0.3)
    >>> spence = SpenceLine(hertz=hertz, friction=0.2)
    >>> print(f"{spence.ratio:.4f} {spence.stick:.4f} {spence.Traction(0.3):.2f}")
    0.9063 0.5632 -36.54
    """

    hertz: HertzLine
    friction: float

    def __post_init__(self):
        instance("hertz", self.hertz, HertzLine)
        nonnegative("friction", self.friction)

    @property
    def zone(self) -> float:
        """The self-similar solution behind, a `StickZone`."""
        return StickZone(beta=self.hertz.beta, friction=self.friction)

    @property
    def ratio(self) -> float:
        """Stick ratio k = c/a."""
        return self.zone.ratio

    @property
    def stick(self) -> float:
        """Half width c of the stick zone (length)."""
        return self.ratio * self.hertz.halfwidth

    def Traction(self, x) -> float | np.ndarray:
        """Tangential traction (stress) on the slave, see `HertzLine.Pressure`.

        Odd in `x`, and away from the middle where `hertz.beta` > 0, towards it otherwise.
        """
        x = points("x", x)
        return self.hertz.Pressure(x) * self.zone.HertzFriction(x / self.hertz.halfwidth)

    def MeanTraction(self, x0, x1) -> float | np.ndarray:
        """Average of the traction over intervals, to about 1e-12, see `HertzLine.MeanPressure`."""
        a, c = self.hertz.halfwidth, self.stick
        return integral_mean(self.Traction, x0, x1, [-a, -c, 0.0, c, a])
