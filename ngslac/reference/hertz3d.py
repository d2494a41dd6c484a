"""Point contact of two elastic spheres without friction (Hertz)."""

from dataclasses import dataclass
from math import inf, pi, sqrt

import numpy as np

from ._checks import choice, nonnegative, points, positive
from ._means import semi_ellipse
from ._pair import HertzPair
from ._polygons import semi_ellipsoid_mean
from .dundurs import ContactModulus

__all__ = ["HertzPoint"]


@dataclass(frozen=True, kw_only=True)
class HertzPoint(HertzPair):
    """Two spheres, or a sphere and a flat surface, pressed together by a force.

    Both bodies are half-spaces to the pressure, so the contact must stay small against the radii
    and all other sizes (published computations of two spheres with radii of 5 a give a peak
    pressure that is 2.5 to 5 % larger). The
    pressure is p0 sqrt(1 - r^2/a^2) for r < a, zero elsewhere, and positive in compression.
    Source: Johnson, Contact Mechanics (Cambridge, 1985), sections 3.4 and 4.2.

    Parameters
    ----------
    force : float
        Normal force P > 0 of the whole contact (four times that of a quarter model).
    radius1, radius2 : float
        Radii of the spheres; `inf` (the default of `radius2`) is a flat surface.
    young1, nu1, young2, nu2 : float
        Young's moduli and Poisson ratios; `inf` makes one of the bodies rigid. Body 1 is the
        slave (this fixes the sign of `beta`).

    Raises
    ------
    ValueError
        If a number is out of range, or both bodies are flat or both rigid.

    Notes
    -----
    Any consistent system of units: with N and mm, pressures are in MPa.

    Examples
    --------
    >>> hertz = HertzPoint(force=1e3, radius1=50, young1=210e3, nu1=0.3, young2=70e3, nu2=0.3)
    >>> print(f"{hertz.contact_radius:.4f} {hertz.peak:.1f} {hertz.approach:.5f}")
    0.8662 636.3 0.01501
    >>> print(f"{hertz.MeanPressure([[0, 0], [0.5, 0], [0, 0.5]]):.1f}")
    599.5
    """

    @classmethod
    def FromApproach(cls, *, approach, radius1, radius2=inf, young1, nu1, young2, nu2):
        """Contact of two bodies whose distant points have come closer.

        P = (4/3) E* sqrt(R) approach^(3/2) (Johnson, section 4.2); the rest as in `HertzPoint`.

        Parameters
        ----------
        approach : float
            By which they have come closer (length), > 0.

        Returns
        -------
        HertzPoint

        Examples
        --------
        >>> spheres = dict(radius1=50, radius2=50, young1=20e3, nu1=0.3, young2=20e3, nu2=0.3)
        >>> hertz = HertzPoint.FromApproach(approach=4, **spheres)
        >>> print(f"{hertz.contact_radius:.3f} {hertz.peak:.2f} {hertz.force:.0f}")
        10.000 2798.33 586081
        """
        positive("approach", approach)
        elastic = dict(young1=young1, nu1=nu1, young2=young2, nu2=nu2)
        unit = cls(force=1.0, radius1=radius1, radius2=radius2, **elastic)  # checks the input
        force = (
            4.0 / 3.0 * ContactModulus(**elastic) * sqrt(unit.radius) * approach * sqrt(approach)
        )
        return cls(force=force, radius1=radius1, radius2=radius2, **elastic)

    @property
    def contact_radius(self):
        """Radius a of the contact (length), a^3 = 3 P R / (4 E*)."""
        return (0.75 * self.force * self.radius / self.modulus) ** (1.0 / 3.0)

    @property
    def peak(self):
        """Largest pressure p0 = 3 P / (2 pi a^2) (stress)."""
        return 1.5 * self.force / (pi * self.contact_radius**2)

    @property
    def approach(self):
        """Approach a^2 / R (length) of points of the two bodies far from the contact."""
        return self.contact_radius**2 / self.radius

    def Pressure(self, r):
        """Pressure over the distance from the middle.

        Parameters
        ----------
        r : float or array
            Distance (length).

        Returns
        -------
        float or array
            Stress, of the shape of `r`.
        """
        return self.peak * semi_ellipse(points("r", r), self.contact_radius)

    def MeanPressure(self, vertices):
        """Exact average of the pressure over polygons in the plane of contact.

        This is what a piecewise constant multiplier on a face with these corners is compared with;
        faces may reach over the edge of the contact, or hold its middle.

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

    def Gap(self, r):
        """Distance of the loaded surfaces: zero in contact, positive around it.

        The parabola r^2/(2R), less the approach, plus the displacements of both surfaces outside
        the contact (Johnson, section 3.4).

        Parameters
        ----------
        r : float or array
            Distance from the middle (length).

        Returns
        -------
        float or array
            Length, of the shape of `r`.
        """
        distance, a = np.abs(points("r", r)), self.contact_radius
        outside = np.maximum(distance, a)
        sag = (2.0 * a**2 - outside**2) * np.arcsin(a / outside)
        sag = sag + a * np.sqrt(outside**2 - a**2)
        gap = (0.5 * outside**2 - a**2 + sag / pi) / self.radius
        return np.where(distance > a, np.maximum(gap, 0.0), 0.0)[()]

    def AxisStress(self, depth, *, body=1):
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
            If `body` is another number, or a depth negative.
        """
        choice("body", body, (1, 2), "give 1 (slave) or 2 (master)")
        depth = points("depth", depth)
        nonnegative("depth", float(depth.min(initial=0.0)))
        z = depth / self.contact_radius
        nu = self.nu1 if body == 1 else self.nu2
        decay = 1.0 / (1.0 + z**2)
        radial = 0.5 * decay - (1.0 + nu) * (1.0 - z * np.arctan2(1.0, z))
        return (self.peak * radial)[()], (-self.peak * decay)[()]
