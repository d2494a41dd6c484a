"""Two cylinders of different materials, pressed together with friction (Spence)."""

from dataclasses import dataclass

from ._checks import instance, nonnegative, points
from ._means import integral_mean
from .hertz import HertzLine
from .stickzone import StickZone

__all__ = ["SpenceLine"]


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
    def zone(self):
        """The self-similar solution behind, a `StickZone`."""
        return StickZone(beta=self.hertz.beta, friction=self.friction)

    @property
    def ratio(self):
        """Stick ratio k = c/a."""
        return self.zone.ratio

    @property
    def stick(self):
        """Half width c of the stick zone (length)."""
        return self.ratio * self.hertz.halfwidth

    def Traction(self, x):
        """Tangential traction on the slave.

        Odd in `x`, and away from the middle where `hertz.beta` > 0, towards it otherwise.

        Parameters
        ----------
        x : float or array
            Distance from the middle (length).

        Returns
        -------
        float or array
            Stress, of the shape of `x`.
        """
        x = points("x", x)
        return self.hertz.Pressure(x) * self.zone.HertzFriction(x / self.hertz.halfwidth)

    def MeanTraction(self, x0, x1):
        """Average of the traction over each interval from `x0` to `x1`, to about 1e-12.

        Parameters
        ----------
        x0, x1 : float or array
            Ends (length), x0 != x1.

        Returns
        -------
        float or array
            Stress, of the common shape of both.
        """
        a, c = self.hertz.halfwidth, self.stick
        return integral_mean(self.Traction, x0, x1, [-a, -c, 0.0, c, a])
