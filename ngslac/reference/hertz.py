"""Line contact of two elastic cylinders without friction (Hertz, plane strain)."""

from dataclasses import dataclass
from math import pi, sqrt

from ._means import semi_ellipse, semi_ellipse_mean
from ._pair import HertzPair

__all__ = ["HertzLine"]


@dataclass(frozen=True, kw_only=True)
class HertzLine(HertzPair):
    """Two cylinders with parallel axes, pressed together by a force per length.

    Both bodies are half-planes to the pressure, so the contact must stay narrow against the radii
    and all other sizes. The pressure is p0 sqrt(1 - x^2/a^2) over |x| < a, zero elsewhere, and
    positive in compression. In plane strain the approach of two distant points grows like the
    logarithm of their distance, so there is none here. Source: Johnson, Contact Mechanics
    (Cambridge, 1985), section 4.2(c).

    Parameters
    ----------
    force : float
        Normal force per length P > 0 of the whole contact (twice that of a half model).
    radius1, radius2 : float
        Radii of the cylinders; `inf` (the default of `radius2`) is a flat surface.
    young1, nu1, young2, nu2 : float
        Young's moduli and Poisson ratios; `inf` makes one of the bodies rigid. Body 1 is the
        slave (this fixes the sign of `beta`).

    Raises
    ------
    ValueError
        If a number is out of range, or both bodies are flat or both rigid.

    Notes
    -----
    Any consistent system of units: with N and mm, `force` is in N/mm and pressures are in MPa.

    Examples
    --------
    >>> hertz = HertzLine(force=35e3, radius1=50, young1=210e3, nu1=0.3, young2=70e3, nu2=0.3)
    >>> print(f"{hertz.halfwidth:.4f} {hertz.peak:.2f} {hertz.MeanPressure(0, 1):.2f}")
    6.2146 3585.36 3569.83
    """

    @property
    def halfwidth(self):
        """Half width a of the contact (length), a^2 = 4 P R / (pi E*)."""
        return sqrt(4.0 * self.force * self.radius / (pi * self.modulus))

    @property
    def peak(self):
        """Largest pressure p0 = 2 P / (pi a) (stress)."""
        return 2.0 * self.force / (pi * self.halfwidth)

    def Pressure(self, x):
        """Pressure along the contact.

        Parameters
        ----------
        x : float or array
            Distance from the middle (length).

        Returns
        -------
        float or array
            Stress, of the shape of `x`.
        """
        return self.peak * semi_ellipse(x, self.halfwidth)

    def MeanPressure(self, x0, x1):
        """Exact average of the pressure over each interval from `x0` to `x1`.

        This is what a piecewise constant multiplier on a face with these ends is compared with;
        faces may reach over the edge of the contact, and either end may come first.

        Parameters
        ----------
        x0, x1 : float or array
            Ends (length), x0 != x1.

        Returns
        -------
        float or array
            Stress, of the common shape of both.
        """
        return self.peak * semi_ellipse_mean(x0, x1, self.halfwidth)
