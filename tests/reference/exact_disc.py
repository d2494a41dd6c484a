"""An exact solution of the frictionless contact problem in 3D, with a circular contact."""

from dataclasses import dataclass
from math import pi

import numpy as np
from exact_signorini import ElasticPair, coordinates, sign_of

from ngslac.reference._checks import points, positive
from ngslac.reference._means import semi_ellipse, semi_ellipsoid_gap
from ngslac.reference._polygons import semi_ellipsoid_mean


def _times(first, second):
    """Product of complex numbers given as pairs, which coefficient functions may be too."""
    (a, b), (c, d) = first, second
    return a * c - b * d, a * d + b * c


@dataclass(frozen=True, kw_only=True)
class ElasticSignoriniDisc(ElasticPair):
    """Two elastic bodies in 3D that touch without friction in a disc and part around it.

    Body 1 (slave) lies in z > 0, body 2 in z < 0; they touch for r < a, r^2 = x^2 + y^2. This is
    the Hertz contact of two half-spaces, with both bodies bent so that their loaded surfaces are
    flat in contact, and no initial gap is needed. With a harmonic potential f::

        2 G (u_x, u_y) = (1 - 2 nu) grad f + z grad f_z,     2 G u_z = -2 (1 - nu) f_z + z f_zz,
        f_zz = k (Im(R - z L) + pi z/2),  R^2 = r^2 + (z + i a)^2,  L = log(R + z + i a),

    mirrored for body 2. On z = 0 there is no shear stress; in contact f_z vanishes and the
    pressure is k sqrt(a^2 - r^2), beyond it the pressure vanishes and the gap grows like
    (r - a)^(3/2). As u_z = 0 in contact for either body, they may be of different materials. Use
    the displacement as Dirichlet data on the rest of the boundary (with ``functions=ngsolve`` it is
    a coefficient function); there is no body force.

    *Derivation.* Im(1/R) for all radii t < a, integrated against -t dt, is harmonic, and on z = 0
    it is sqrt(a^2 - r^2) in the disc and zero outside; further integrals over z are elementary.
    Source of the representation by f: Green and Zerna, Theoretical Elasticity (Oxford, 1954), for
    problems without shear stress on z = 0.

    Parameters
    ----------
    young1, nu1, young2, nu2 : float
        Young's moduli and Poisson ratios of both bodies.
    radius : float
        Radius a > 0 of the contact.
    strength : float
        Factor k > 0 of the pressure (stress over length).

    Raises
    ------
    ValueError
        If a number is out of range.

    Examples
    --------
    >>> exact = ElasticSignoriniDisc(young1=1, nu1=0.3, young2=2, nu2=0.2, radius=0.5, strength=1)
    >>> print(f"{exact.Pressure(0.3):.3f} {exact.Gap(1.0):.3f}")
    0.400 0.665
    """

    radius: float = 0.6

    def __post_init__(self):
        super().__post_init__()
        positive("radius", self.radius)

    def _Potential(self, square, z, functions):
        """Derivatives f_x/x, f_z, f_xz/x and f_zz for k = 1, at r^2 = `square` and z >= 0."""
        a, sqrt, log = self.radius, functions.sqrt, functions.log
        arctan = functions.arctan if functions is np else functions.atan
        distance = square + z * z - a * a
        modulus = sqrt(distance * distance + 4.0 * a * a * z * z)
        Z, R = (z, a), (sqrt(0.5 * (modulus + distance)), sqrt(0.5 * (modulus - distance)))
        real, imag = R[0] + z, R[1] + a
        size = real * real + imag * imag  # at least a^2
        L = 0.5 * log(size), 0.5 * pi - arctan(real / imag)
        q = real / size, -imag / size  # 1/(R + Z) = (R - Z)/r^2
        ZZ, ZR, Zq = _times(Z, Z), _times(Z, R), _times(Z, q)
        squares = distance + ZZ[0] + ZR[0], 2.0 * ZZ[1] + ZR[1]  # R^2 + Z^2 + Z R
        factor = 0.5 * ZZ[0] + 0.25 * square - z * z, 0.5 * ZZ[1] - z * a
        f_x = 0.5 * z * (Zq[1] + L[1]) - _times(q, squares)[1] / 3.0
        f_z = _times(L, factor)[1] + z * R[1] - 0.25 * ZR[1]
        f_xz = 0.5 * L[1] + z * q[1] - 0.5 * Zq[1]
        f_zz = R[1] - z * L[1]
        bent = 0.125 * pi * (2.0 * a * a - square + 2.0 * z * z)
        return f_x - 0.25 * pi * z, f_z + bent, f_xz - 0.25 * pi, f_zz + 0.5 * pi * z

    def Displacement(self, x, y, z, *, body=1, functions=np) -> tuple:
        """Displacements along x, y and z of one of the bodies, as a tuple (lengths).

        Position and body are as in `ScalarSignorini.Value`.

        Parameters
        ----------
        z : float, array or CoefficientFunction
            Height (length), z >= 0 for body 1 and z <= 0 for body 2.
        functions : module
            With ``sqrt``, ``log`` and the arc tangent for these numbers: numpy or ngsolve.
        """
        sign, k = sign_of(body), self.strength
        shear2, nu = self._Material(body)
        x, y, z = coordinates(functions, np, x=x, y=y, z=z)
        height = sign * z
        f_x, f_z, f_xz, f_zz = self._Potential(x * x + y * y, height, functions)
        along = k / shear2 * ((1.0 - 2.0 * nu) * f_x + height * f_xz)
        up = k / shear2 * (height * f_zz - 2.0 * (1.0 - nu) * f_z)
        return along * x, along * y, sign * up

    def Gap(self, r) -> float | np.ndarray:
        """Distance of the surfaces (length), zero in contact, as in `HertzPoint.Pressure`."""
        return 0.5 * self.strength / self._modulus * semi_ellipsoid_gap(r, self.radius)

    def Pressure(self, r) -> float | np.ndarray:
        """Contact pressure, positive in compression, as in `HertzPoint.Pressure`."""
        return self.strength * self.radius * semi_ellipse(points("r", r), self.radius)

    def MeanPressure(self, vertices) -> float | np.ndarray:
        """Exact average of the pressure over polygons, see `HertzPoint.MeanPressure`."""
        return self.strength * self.radius * semi_ellipsoid_mean(vertices, self.radius)
