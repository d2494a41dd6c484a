"""An exact solution of the frictionless contact problem between two elastic bodies."""

from dataclasses import dataclass

import numpy as np

from ._checks import coordinates, finite, poisson, positive
from .signorini import ScalarSignorini, _sign

__all__ = ["ElasticSignorini"]


@dataclass(frozen=True, kw_only=True)
class ElasticSignorini:
    """Two elastic bodies in plane strain that touch without friction along part of a line.

    Body 1 (slave) lies in y > 0, body 2 in y < 0; they touch for x < X0 and part beyond. It is
    Westergaard's solution for a symmetric crack, with Z = -k sqrt(X0 - z)::

        sigma_xx = Re Z - y Im Z',  sigma_yy = Re Z + y Im Z',  sigma_xy = -y Re Z',
        2 G u = (1 - 2 nu) Re I - y Im Z,  2 G v = 2 (1 - nu) Im I - y Re Z,   I' = Z,

    mirrored for body 2. On the line there is no shear stress; v vanishes and the pressure is
    k sqrt(X0 - x) in contact, and the pressure vanishes and the gap grows like (x - X0)^(3/2)
    beyond. As v = 0 in contact for either body, they may be of different materials. Use the
    displacement as Dirichlet data, or the stress as load, on the rest of the boundary. There is no
    body force. Source of the representation: Westergaard, J. Appl. Mech. 6 (1939) A49.

    Parameters
    ----------
    young1, nu1, young2, nu2 : float
        Young's moduli and Poisson ratios of both bodies.
    tip : float
        End X0 of the contact; best inside an element.
    strength : float
        Factor k > 0 of the pressure (stress over the root of a length).

    Raises
    ------
    ValueError
        If a number is out of range.

    Notes
    -----
    Coordinates may be numbers or arrays; with ``sqrt=ngsolve.sqrt`` the methods `Displacement` and
    `Stress` take and give coefficient functions. Any consistent system of units.

    Examples
    --------
    >>> exact = ElasticSignorini(young1=1, nu1=0.3, young2=2, nu2=0.2, tip=0.3, strength=1)
    >>> print(f"{exact.Pressure(-0.7):.3f} {exact.Gap(1.3):.3f}")
    1.000 1.853
    """

    young1: float
    nu1: float
    young2: float
    nu2: float
    tip: float = 1.0 / 3.0
    strength: float = 1.0

    def __post_init__(self):
        positive("young1", self.young1)
        positive("young2", self.young2)
        poisson("nu1", self.nu1)
        poisson("nu2", self.nu2)
        finite("tip", self.tip)
        positive("strength", self.strength)

    def _Material(self, body):
        """Twice the shear modulus, and Poisson ratio."""
        young, nu = (self.young1, self.nu1) if body == 1 else (self.young2, self.nu2)
        return young / (1.0 + nu), nu

    def _Root(self, x, y, sqrt):
        """Real part and negative imaginary part of (X0 - x - i y)^(1/2) for y >= 0."""
        x = x - self.tip
        r = sqrt(x * x + y * y)
        return sqrt(0.5 * (r - x)), sqrt(0.5 * (r + x)), r

    def Displacement(self, x, y, *, body=1, sqrt=np.sqrt):
        """Displacements of one of the bodies.

        Parameters
        ----------
        x, y : float, array or CoefficientFunction
            Position (length), y >= 0 for body 1 and y <= 0 for body 2.
        body : {1, 2}
            Slave or master.
        sqrt : callable
            The square root for these numbers.

        Returns
        -------
        tuple of float, array or CoefficientFunction
            Along x and y (length).
        """
        sign, k = _sign(body), self.strength
        shear2, nu = self._Material(body)
        x, y = coordinates(sqrt, np.sqrt, x=x, y=y)
        real, imag, _ = self._Root(x, y, sqrt)
        integral_real = 2.0 / 3.0 * k * real * (real * real - 3.0 * imag * imag)
        integral_imag = 2.0 / 3.0 * k * imag * (imag * imag - 3.0 * real * real)
        height = sign * y
        u = ((1.0 - 2.0 * nu) * integral_real - height * k * imag) / shear2
        v = (2.0 * (1.0 - nu) * integral_imag + height * k * real) / shear2
        return u, sign * v

    def Stress(self, x, y, *, body=1, sqrt=np.sqrt):
        """Stresses (xx, yy, xy) as a tuple, tension positive; the zz stress is nu (xx + yy).

        The arguments are as in `ElasticSignorini.Displacement`.
        """
        sign, k = _sign(body), self.strength
        x, y = coordinates(sqrt, np.sqrt, x=x, y=y)
        real, imag, r = self._Root(x, y, sqrt)
        slope = 0.5 * k * (sign * y) / (r + 1e-300)  # the offset gives zero at the tip
        mean = -k * real
        return mean - slope * imag, mean + slope * imag, -sign * slope * real

    def Gap(self, x):
        """Distance of the surfaces along the line, zero in contact.

        Parameters
        ----------
        x : float or array
            Position (length).

        Returns
        -------
        float or array
            Length, of the shape of `x`.
        """
        (shear1, nu1), (shear2, nu2) = self._Material(1), self._Material(2)
        factor = 2.0 / 3.0 * self.strength * ((1.0 - nu1) / shear1 + (1.0 - nu2) / shear2)
        return factor * self._scalar.Gap(x)

    @property
    def _scalar(self):
        return ScalarSignorini(tip=self.tip)

    def Pressure(self, x):
        """Contact pressure, positive in compression.

        Parameters
        ----------
        x : float or array
            Position (length).

        Returns
        -------
        float or array
            Stress, of the shape of `x`.
        """
        return self.strength / 1.5 * self._scalar.Pressure(x)

    def MeanPressure(self, x0, x1):
        """Exact average of the pressure over each interval from `x0` to `x1`.

        Parameters
        ----------
        x0, x1 : float or array
            Ends (length), x0 != x1.

        Returns
        -------
        float or array
            Stress, of the common shape of both.
        """
        return self.strength / 1.5 * self._scalar.MeanPressure(x0, x1)
