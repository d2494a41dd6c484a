"""Exact solutions of plane contact problems between two bodies without friction (Signorini)."""

from dataclasses import dataclass

import numpy as np

from ngslac.reference import ContactModulus
from ngslac.reference._checks import choice, finite, interval, points, poisson, positive


def coordinates(given, usual, **values):
    """Positions as float arrays, or as they are for functions other than the usual ones.

    Such functions, as those of NGSolve, take what numpy does not know.
    """
    if given is usual:
        return tuple(points(name, value) for name, value in values.items())
    return tuple(values.values())


def sign_of(body):
    """Side of a body: 1 above the line of contact, -1 below."""
    choice("body", body, (1, 2), "give 1 (slave, y >= 0) or 2 (y <= 0)")
    return 1.0 if body == 1 else -1.0


def _Root(x, y, sqrt):
    """Real and imaginary part of (x + i |y|)^(1/2), and the size of its square."""
    r = sqrt(x * x + y * y)
    return sqrt(0.5 * (r + x)), sqrt(0.5 * (r - x)), r


@dataclass(frozen=True, kw_only=True)
class ScalarSignorini:
    """Two membranes that touch along part of a line, with the typical singularity at its end.

    Body 1 (slave) lies in y > 0 and body 2 in y < 0, both with -Laplace(u) = 0 and with u1 >= u2
    on the line y = 0. With polar coordinates around (X0, 0),

        u1 = r^(3/2) cos(3 theta/2),   u2(x, y) = -u1(x, -y),

    there is contact for x < X0, with pressure 1.5 sqrt(X0 - x), and a gap beyond. Take u as
    Dirichlet data on the rest of the boundary of, say, (-1, 1) x (0, 1) and its mirror image.
    The regularity (below H^(5/2)) is that of Signorini problems in general, and limits the
    rates. With ``sqrt=ngsolve.sqrt`` `Value` and `Gradient` take and give coefficient functions.
    Checked by hand: u1 is the real part of z^(3/2), with derivative 1.5 z^(1/2).

    Parameters
    ----------
    tip : float
        End X0 of the contact; best inside an element.

    Raises
    ------
    ValueError
        If a number is not finite.

    Examples
    --------
    >>> exact = ScalarSignorini(tip=1 / 3)
    >>> print(f"{exact.Value(0.5, 0.2):.6f} {exact.MeanPressure(-1, 0):.6f}")
    0.033727 1.347151
    """

    tip: float = 1.0 / 3.0

    def __post_init__(self):
        finite("tip", self.tip)

    def Value(self, x, y, *, body=1, sqrt=np.sqrt) -> float | np.ndarray:
        """Solution of one of the bodies.

        Parameters
        ----------
        x, y : float, array or CoefficientFunction
            Position, y >= 0 for body 1 and y <= 0 for body 2.
        body : {1, 2}
            Slave or master.
        sqrt : callable
            The square root for these numbers.

        Returns
        -------
        float, array or CoefficientFunction
        """
        x, y = coordinates(sqrt, np.sqrt, x=x, y=y)
        real, imag, _ = _Root(x - self.tip, y, sqrt)
        return sign_of(body) * real * (real * real - 3.0 * imag * imag)

    def Gradient(self, x, y, *, body=1, sqrt=np.sqrt) -> tuple:
        """Both derivatives of the solution, as a tuple; arguments as in `ScalarSignorini.Value`."""
        x, y = coordinates(sqrt, np.sqrt, x=x, y=y)
        real, imag, _ = _Root(x - self.tip, y, sqrt)
        return sign_of(body) * 1.5 * real, -1.5 * imag

    def Gap(self, x) -> float | np.ndarray:
        """Gap u1 - u2 at `x` on the line, zero in contact, as in `HertzLine.Pressure`."""
        return 2.0 * np.maximum(points("x", x) - self.tip, 0.0) ** 1.5

    def Pressure(self, x) -> float | np.ndarray:
        """Pressure du1/dn >= 0 on the line (n out of body 1), as in `HertzLine.Pressure`."""
        return 1.5 * np.sqrt(np.maximum(self.tip - points("x", x), 0.0))

    def MeanPressure(self, x0, x1) -> float | np.ndarray:
        """Exact average of the pressure over intervals, as in `HertzLine.MeanPressure`."""
        x0, x1 = interval(x0, x1)
        left, right = np.maximum(self.tip - x0, 0.0), np.maximum(self.tip - x1, 0.0)
        return (left**1.5 - right**1.5) / (x1 - x0)


@dataclass(frozen=True, kw_only=True)
class ElasticPair:
    """Two elastic bodies, mirrored at their plane of contact, and the strength of the pressure."""

    young1: float
    nu1: float
    young2: float
    nu2: float
    strength: float = 1.0

    def __post_init__(self):
        positive("young1", self.young1)
        positive("young2", self.young2)
        poisson("nu1", self.nu1)
        poisson("nu2", self.nu2)
        positive("strength", self.strength)

    def _Material(self, body):
        """Twice the shear modulus, and Poisson ratio."""
        young, nu = (self.young1, self.nu1) if body == 1 else (self.young2, self.nu2)
        return young / (1.0 + nu), nu

    @property
    def _modulus(self):
        young1, young2 = self.young1, self.young2
        return ContactModulus(young1=young1, nu1=self.nu1, young2=young2, nu2=self.nu2)


@dataclass(frozen=True, kw_only=True)
class ElasticSignorini(ElasticPair):
    """Two elastic bodies in plane strain that touch without friction along part of a line.

    Body 1 (slave) lies in y > 0, body 2 in y < 0; they touch for x < X0 and part beyond. It is
    Westergaard's solution for a symmetric crack, with Z = -k sqrt(X0 - z)::

        sigma_xx = Re Z - y Im Z',  sigma_yy = Re Z + y Im Z',  sigma_xy = -y Re Z',
        2 G u = (1 - 2 nu) Re I - y Im Z,  2 G v = 2 (1 - nu) Im I - y Re Z,   I' = Z,

    mirrored for body 2. On the line there is no shear stress; v vanishes and the pressure is
    k sqrt(X0 - x) in contact, and the pressure vanishes and the gap grows like (x - X0)^(3/2)
    beyond. As v = 0 in contact for either body, they may be of different materials. Use the
    displacement as Dirichlet data, or the stress as load, on the rest of the boundary; with
    ``sqrt=ngsolve.sqrt`` both are coefficient functions. There is no body force. Source of the
    representation: Westergaard, J. Appl. Mech. 6 (1939) A49.

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

    Examples
    --------
    >>> exact = ElasticSignorini(young1=1, nu1=0.3, young2=2, nu2=0.2, tip=0.3, strength=1)
    >>> print(f"{exact.Pressure(-0.7):.3f} {exact.Gap(1.3):.3f}")
    1.000 1.853
    """

    tip: float = 1.0 / 3.0

    def __post_init__(self):
        super().__post_init__()
        finite("tip", self.tip)

    def Displacement(self, x, y, *, body=1, sqrt=np.sqrt) -> tuple:
        """Displacements along x and y of one of the bodies, as a tuple (lengths).

        The arguments are as in `ScalarSignorini.Value`.
        """
        sign, k = sign_of(body), self.strength
        shear2, nu = self._Material(body)
        x, y = coordinates(sqrt, np.sqrt, x=x, y=y)
        imag, real, _ = _Root(x - self.tip, y, sqrt)  # of (X0 - z)^(1/2), with imag < 0 above
        integral_real = 2.0 / 3.0 * k * real * (real * real - 3.0 * imag * imag)
        integral_imag = 2.0 / 3.0 * k * imag * (imag * imag - 3.0 * real * real)
        height = sign * y
        u = ((1.0 - 2.0 * nu) * integral_real - height * k * imag) / shear2
        v = (2.0 * (1.0 - nu) * integral_imag + height * k * real) / shear2
        return u, sign * v

    def Stress(self, x, y, *, body=1, sqrt=np.sqrt) -> tuple:
        """Stresses (xx, yy, xy) as a tuple, tension positive; the zz stress is nu (xx + yy).

        The arguments are as in `ElasticSignorini.Displacement`.
        """
        sign, k = sign_of(body), self.strength
        x, y = coordinates(sqrt, np.sqrt, x=x, y=y)
        imag, real, r = _Root(x - self.tip, y, sqrt)
        slope = 0.5 * k * (sign * y) / (r + 1e-300)  # the offset gives zero at the tip
        mean = -k * real
        return mean - slope * imag, mean + slope * imag, -sign * slope * real

    @property
    def _scalar(self):
        return ScalarSignorini(tip=self.tip)

    def Gap(self, x) -> float | np.ndarray:
        """Distance of the surfaces along the line, zero in contact, as in `HertzLine.Pressure`."""
        return 2.0 / 3.0 * self.strength / self._modulus * self._scalar.Gap(x)

    def Pressure(self, x) -> float | np.ndarray:
        """Contact pressure (stress), positive in compression, as in `HertzLine.Pressure`."""
        return self.strength / 1.5 * self._scalar.Pressure(x)

    def MeanPressure(self, x0, x1) -> float | np.ndarray:
        """Exact average of the pressure over intervals, as in `HertzLine.MeanPressure`."""
        return self.strength / 1.5 * self._scalar.MeanPressure(x0, x1)
