"""An exact solution of the scalar Signorini problem between two bodies."""

from dataclasses import dataclass

import numpy as np

from ._checks import choice, coordinates, finite, interval, points

__all__ = ["ScalarSignorini"]


@dataclass(frozen=True, kw_only=True)
class ScalarSignorini:
    """Two membranes that touch along part of a line, with the typical singularity at its end.

    Body 1 (slave) lies in y > 0 and body 2 in y < 0, both with -Laplace(u) = 0 and with u1 >= u2
    on the line y = 0. With polar coordinates around (X0, 0),

        u1 = r^(3/2) cos(3 theta/2),   u2(x, y) = -u1(x, -y),

    there is contact for x < X0, with pressure 1.5 sqrt(X0 - x), and a gap beyond. Take u as
    Dirichlet data on the rest of the boundary of, say, (-1, 1) x (0, 1) and its mirror image.
    The regularity (below H^(5/2)) is that of Signorini problems in general, and limits the
    rates. Checked by hand: u1 is the real part of z^(3/2), with derivative 1.5 z^(1/2).

    Parameters
    ----------
    tip : float
        End X0 of the contact; best inside an element.

    Raises
    ------
    ValueError
        If a number is not finite.

    Notes
    -----
    `Value`, `Gradient` use arithmetic and a square root only. With ``sqrt=ngsolve.sqrt`` they take
    and give coefficient functions.

    Examples
    --------
    >>> exact = ScalarSignorini(tip=1 / 3)
    >>> print(f"{exact.Value(0.5, 0.2):.6f} {exact.MeanPressure(-1, 0):.6f}")
    0.033727 1.347151
    """

    tip: float = 1.0 / 3.0

    def __post_init__(self):
        finite("tip", self.tip)

    def _Root(self, x, y, sqrt):
        """Real and imaginary part of (x - X0 + i |y|)^(1/2)."""
        x = x - self.tip
        r = sqrt(x * x + y * y)
        return sqrt(0.5 * (r + x)), sqrt(0.5 * (r - x))

    def Value(self, x, y, *, body=1, sqrt=np.sqrt):
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
        real, imag = self._Root(x, y, sqrt)
        return _sign(body) * real * (real * real - 3.0 * imag * imag)

    def Gradient(self, x, y, *, body=1, sqrt=np.sqrt):
        """Both derivatives of the solution, as a tuple; arguments as in `ScalarSignorini.Value`."""
        x, y = coordinates(sqrt, np.sqrt, x=x, y=y)
        real, imag = self._Root(x, y, sqrt)
        return _sign(body) * 1.5 * real, -1.5 * imag

    def Gap(self, x):
        """Gap u1 - u2 on the line, zero in contact.

        Parameters
        ----------
        x : float or array

        Returns
        -------
        float or array
            Of the shape of `x`.
        """
        return 2.0 * np.maximum(points("x", x) - self.tip, 0.0) ** 1.5

    def Pressure(self, x):
        """Pressure du1/dn >= 0 (n points out of body 1) on the line.

        Parameters
        ----------
        x : float or array

        Returns
        -------
        float or array
            Of the shape of `x`.
        """
        return 1.5 * np.sqrt(np.maximum(self.tip - points("x", x), 0.0))

    def MeanPressure(self, x0, x1):
        """Exact average of the pressure over each interval from `x0` to `x1`.

        Parameters
        ----------
        x0, x1 : float or array
            Ends, x0 != x1.

        Returns
        -------
        float or array
            Of the common shape of both.
        """
        x0, x1 = interval(x0, x1)
        left, right = np.maximum(self.tip - x0, 0.0), np.maximum(self.tip - x1, 0.0)
        return (left**1.5 - right**1.5) / (x1 - x0)


def _sign(body):
    choice("body", body, (1, 2), "give 1 (slave, y >= 0) or 2 (y <= 0)")
    return 1.0 if body == 1 else -1.0
