# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact of two elastic cylinders (plane strain) or spheres without friction (Hertz)."""

from dataclasses import dataclass
from math import inf, pi, sqrt

import numpy as np

from ._checks import choice, nonnegative, points, positive
from ._means import semi_ellipse, semi_ellipse_mean, semi_ellipsoid_gap
from ._polygons import semi_ellipsoid_mean
from .dundurs import ContactModulus, DundursBeta, shear_sum

__all__ = ["HertzLine", "HertzPair", "HertzPoint"]


@dataclass(frozen=True, kw_only=True)
class HertzPair:
    """Normal force, radii and elastic constants of two bodies, checked."""

    force: float
    radius1: float
    radius2: float = inf
    young1: float
    nu1: float
    young2: float
    nu2: float

    def __post_init__(self) -> None:
        """Check all numbers."""
        positive("force", self.force)
        positive("radius1", self.radius1, infinite=True)
        positive("radius2", self.radius2, infinite=True)
        if self.radius1 == inf and self.radius2 == inf:
            raise ValueError(
                f"radius2 = {self.radius2!r} is not valid: surface 1 is flat already, "
                "give one of the radii a finite value"
            )
        _ = self.modulus  # checks the elastic constants

    @property
    def _elastic(self) -> dict[str, float]:
        return dict(young1=self.young1, nu1=self.nu1, young2=self.young2, nu2=self.nu2)

    @property
    def modulus(self) -> float:
        """Contact modulus E* (see `ContactModulus`)."""
        return ContactModulus(**self._elastic)

    @property
    def beta(self) -> float:
        """Second Dundurs constant, with body 1 as the slave (see `DundursBeta`)."""
        return DundursBeta(**self._elastic)

    @property
    def radius(self) -> float:
        """Relative radius R, 1/R = 1/R1 + 1/R2."""
        return 1.0 / (1.0 / self.radius1 + 1.0 / self.radius2)

    def _ShearSum(self, factor1: float = 1.0, factor2: float = 1.0) -> float:
        return shear_sum(factor1, factor2, **self._elastic)


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

    Examples
    --------
    >>> hertz = HertzLine(force=35e3, radius1=50, young1=210e3, nu1=0.3, young2=70e3, nu2=0.3)
    >>> print(f"{hertz.halfwidth:.4f} {hertz.peak:.2f} {hertz.MeanPressure(0, 1):.2f}")
    6.2146 3585.36 3569.83
    """

    @property
    def halfwidth(self) -> float:
        """Half width a of the contact (length), a^2 = 4 P R / (pi E*)."""
        return sqrt(4.0 * self.force * self.radius / (pi * self.modulus))

    _size = halfwidth

    @property
    def peak(self) -> float:
        """Largest pressure p0 = 2 P / (pi a) (stress)."""
        return 2.0 * self.force / (pi * self.halfwidth)

    def Pressure(self, x: float | np.ndarray) -> float | np.ndarray:
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

    def MeanPressure(self, x0: float | np.ndarray, x1: float | np.ndarray) -> float | np.ndarray:
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


@dataclass(frozen=True, kw_only=True)
class HertzPoint(HertzPair):
    """Two spheres, or a sphere and a flat surface, pressed together by a force.

    Both bodies are half-spaces to the pressure, so the contact must stay small against the radii
    and all other sizes (published computations of two spheres with radii of 5 a give a peak
    pressure that is 2.5 to 5 % larger). The pressure is p0 sqrt(1 - r^2/a^2) for r < a, zero
    elsewhere, and positive in compression. The other bodies and errors are as in `HertzLine`.
    Source: Johnson, Contact Mechanics (Cambridge, 1985), sections 3.4 and 4.2.

    Parameters
    ----------
    force : float
        Normal force P > 0 of the whole contact (four times that of a quarter model).
    radius1, radius2 : float
        Radii of the spheres; `inf` (the default of `radius2`) is a flat surface.

    Examples
    --------
    >>> hertz = HertzPoint(force=1e3, radius1=50, young1=210e3, nu1=0.3, young2=70e3, nu2=0.3)
    >>> print(f"{hertz.contact_radius:.4f} {hertz.peak:.1f} {hertz.approach:.5f}")
    0.8662 636.3 0.01501
    >>> print(f"{hertz.MeanPressure([[0, 0], [0.5, 0], [0, 0.5]]):.1f}")
    599.5
    >>> spheres = dict(radius1=50, radius2=50, young1=20e3, nu1=0.3, young2=20e3, nu2=0.3)
    >>> print(f"{HertzPoint.FromApproach(approach=4, **spheres).peak:.2f}")
    2798.33
    """

    @classmethod
    def FromApproach(
        cls,
        *,
        approach: float,
        radius1: float,
        radius2: float = inf,
        young1: float,
        nu1: float,
        young2: float,
        nu2: float,
    ) -> "HertzPoint":
        """Contact of two bodies whose distant points have come closer.

        P = (4/3) E* sqrt(R) approach^(3/2) (Johnson, section 4.2); the rest as in `HertzPoint`.

        Parameters
        ----------
        approach : float
            By which they have come closer (length), > 0.

        Returns
        -------
        HertzPoint
        """
        positive("approach", approach)
        bodies = dict(radius1=radius1, radius2=radius2)
        bodies |= dict(young1=young1, nu1=nu1, young2=young2, nu2=nu2)
        unit = cls(force=1.0, **bodies)  # checks the input
        stiffness = 4.0 / 3.0 * unit.modulus * sqrt(unit.radius)
        return cls(force=stiffness * approach * sqrt(approach), **bodies)

    @property
    def contact_radius(self) -> float:
        """Radius a of the contact (length), a^3 = 3 P R / (4 E*)."""
        return (0.75 * self.force * self.radius / self.modulus) ** (1.0 / 3.0)

    _size = contact_radius

    @property
    def peak(self) -> float:
        """Largest pressure p0 = 3 P / (2 pi a^2) (stress)."""
        return 1.5 * self.force / (pi * self.contact_radius**2)

    @property
    def approach(self) -> float:
        """Approach a^2 / R (length) of points of the two bodies far from the contact."""
        return self.contact_radius**2 / self.radius

    def Pressure(self, r: float | np.ndarray) -> float | np.ndarray:
        """Pressure over the distance from the middle, as in `HertzLine.Pressure`.

        Parameters
        ----------
        r : float or array
            Distance (length).
        """
        return self.peak * semi_ellipse(points("r", r), self.contact_radius)

    def MeanPressure(self, vertices: np.ndarray) -> float | np.ndarray:
        """Exact average over polygons in the plane of contact, as in `HertzLine.MeanPressure`.

        Faces may reach over the edge of the contact, or hold its middle.

        Parameters
        ----------
        vertices : array of shape (..., corners, 2)
            Corners relative to the middle of the contact (length), in either sense of rotation.

        Returns
        -------
        float or array of shape (...)
            Stress.
        """
        return self.peak * semi_ellipsoid_mean(vertices, self.contact_radius)

    def Gap(self, r: float | np.ndarray) -> float | np.ndarray:
        """Distance of the loaded surfaces at `r` (lengths): zero in contact, positive around it.

        The parabola r^2/(2R), less the approach, plus the displacements of both surfaces outside
        the contact (Johnson, section 3.4). The argument is as in `HertzPoint.Pressure`.
        """
        return semi_ellipsoid_gap(r, self.contact_radius) / (pi * self.radius)

    def AxisStress(self, depth: float | np.ndarray, *, body: int = 1) -> tuple:
        """Stresses on the axis below the surface.

        Tension positive; the hoop stress equals the radial one, and all shear stresses vanish.
        Source: Johnson, section 3.4.

        Parameters
        ----------
        depth : float or array
            Below the surface (length), >= 0.
        body : {1, 2}
            Slave or master.

        Returns
        -------
        tuple of float or array
            The stresses rr and zz, of the shape of `depth`.

        Raises
        ------
        ValueError
        """
        choice("body", body, (1, 2), "give 1 (slave) or 2 (master)")
        depth = points("depth", depth)
        nonnegative("depth", float(depth.min(initial=0.0)))
        z = depth / self.contact_radius
        nu = self.nu1 if body == 1 else self.nu2
        decay = 1.0 / (1.0 + z**2)
        radial = 0.5 * decay - (1.0 + nu) * (1.0 - z * np.arctan2(1.0, z))
        return (self.peak * radial)[()], (-self.peak * decay)[()]
