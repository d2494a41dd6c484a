"""Partial slip under a tangential load at constant normal load (Cattaneo, Mindlin)."""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from ._checks import points
from ._means import semi_ellipse, semi_ellipse_mean
from ._partial import PartialSlip, Reversal
from .hertz import HertzLine

__all__ = ["CattaneoMindlin", "MindlinReversal"]


@dataclass(frozen=True, kw_only=True)
class CattaneoMindlin(PartialSlip):
    """A Hertz line contact, loaded tangentially after the normal load is complete.

    The contact sticks for |x| < c and slips for c < |x| < a, with c = a sqrt(1 - |Q|/(F P)) and

        tau(x) = sign(Q) F p0 (sqrt(1 - x^2/a^2) - (c/a) sqrt(1 - x^2/c^2)),

    where each root counts as zero where its argument is negative. Valid where tangential tractions
    leave the pressure alone, that is for `hertz.beta == 0`, as with equal materials. Sources:
    Cattaneo (1938); Mindlin, J. Appl. Mech. 16 (1949) 259; Johnson, Contact Mechanics (Cambridge,
    1985), section 7.2.

    Parameters
    ----------
    hertz : HertzLine
        The normal contact; gives P, a, p0 and E*.
    shear : float
        Resultant Q, per length, of the tangential tractions on the slave; |Q| <= F P. It balances
        the tangential load that is put on the slave body.
    friction : float
        Coefficient of friction F >= 0.

    Raises
    ------
    ValueError
        If the bodies would slide, or are of different materials.

    Examples
    --------
    >>> hertz = HertzLine(force=100, radius1=50, young1=1e5, nu1=0.3, young2=1e5, nu2=0.3)
    >>> partial = CattaneoMindlin(hertz=hertz, shear=15, friction=0.2)
    >>> print(f"{partial.ratio:.3f} {partial.Traction(0) / (0.2 * hertz.peak):.3f}")
    0.500 0.500
    """

    hertz: HertzLine

    @property
    def ratio(self):
        """Stick ratio c/a, from 1 (no tangential load) to 0 (sliding)."""
        if self.shear == 0:
            return 1.0
        return sqrt(max(0.0, 1.0 - abs(self.shear) / (self.friction * self.hertz.force)))

    @property
    def stick(self):
        """Half width c of the stick zone (length)."""
        return self.ratio * self.hertz.halfwidth

    def Traction(self, x):
        """Tangential traction on the slave.

        Parameters
        ----------
        x : float or array
            Distance from the middle (length).

        Returns
        -------
        float or array
            Stress, of the shape of `x`, of the sign of Q.
        """
        outer, inner = semi_ellipse(x, self.hertz.halfwidth), semi_ellipse(x, self.stick)
        return self._scale * (outer - self.ratio * inner)

    def MeanTraction(self, x0, x1):
        """Exact average of the traction over each interval from `x0` to `x1`.

        Parameters
        ----------
        x0, x1 : float or array
            Ends (length), x0 != x1.

        Returns
        -------
        float or array
            Stress, of the common shape of both.
        """
        outer = semi_ellipse_mean(x0, x1, self.hertz.halfwidth)
        return self._scale * (outer - self.ratio * semi_ellipse_mean(x0, x1, self.stick))

    def Slip(self, x):
        """Tangential slip of the slave against the master.

        The integral of the slip gradient sqrt(x^2 - c^2) 2 F p0 / (E* a) over the slip zone
        (Johnson, section 7.2), against the traction. For |Q| = F P the rigid sliding is left out.

        Parameters
        ----------
        x : float or array
            Distance from the middle (length).

        Returns
        -------
        float or array
            Length, of the shape of `x`; NaN for |x| > a, where the surfaces do not touch.
        """
        x, c, a = points("x", x), self.stick, self.hertz.halfwidth
        distance = np.maximum(np.abs(x), c)
        area = distance * np.sqrt(distance**2 - c**2)
        if c > 0:
            area = area - c**2 * np.arccosh(distance / c)
        slip = -self._scale / (self.hertz.modulus * a) * area
        return np.where(np.abs(x) <= a, slip, np.nan)[()]

    def Reverse(self, shear):
        """State after the tangential load has gone back from here.

        Parameters
        ----------
        shear : float
            The load to which it has gone, |shear| <= |Q|.

        Returns
        -------
        MindlinReversal
        """
        return MindlinReversal(start=self, shear=shear)


@dataclass(frozen=True, kw_only=True)
class MindlinReversal(Reversal):
    """A Cattaneo-Mindlin contact whose tangential load is brought back, once and steadily.

    From Q* = `start.shear` to Q = `shear`, with |Q| <= |Q*|, slip comes back from the edges of the
    contact. The change is a Cattaneo-Mindlin state with twice the friction, so the state is that
    of Q* less twice that of (Q* - Q)/2. At Q = 0 tractions remain, at Q = -Q* all is mirrored, and
    the way back up closes a loop. Sources: Mindlin and Deresiewicz, J. Appl. Mech. 20 (1953) 327;
    Johnson, Contact Mechanics (Cambridge, 1985), section 7.4, here in plane strain.

    Parameters
    ----------
    start : CattaneoMindlin
        The state at the point of reversal.
    shear : float
        Present resultant Q of the tangential tractions on the slave, -|Q*| <= Q <= |Q*|.

    Raises
    ------
    ValueError
        If the load is larger than the one at the point of reversal.

    Examples
    --------
    >>> hertz = HertzLine(force=100, radius1=50, young1=1e5, nu1=0.3, young2=1e5, nu2=0.3)
    >>> unloaded = CattaneoMindlin(hertz=hertz, shear=15, friction=0.2).Reverse(0)
    >>> print(f"{unloaded.Traction(0) > 0} {unloaded.Traction(0.95 * hertz.halfwidth) < 0}")
    True True
    """

    start: CattaneoMindlin
    shear: float

    def Traction(self, x):
        """Tangential traction on the slave, see `CattaneoMindlin.Traction`."""
        return self._Superposed(lambda state: state.Traction(x))

    def MeanTraction(self, x0, x1):
        """Exact average of the traction, see `CattaneoMindlin.MeanTraction`."""
        return self._Superposed(lambda state: state.MeanTraction(x0, x1))

    def Slip(self, x):
        """Slip since the first loading, see `CattaneoMindlin.Slip`."""
        return self._Superposed(lambda state: state.Slip(x))
