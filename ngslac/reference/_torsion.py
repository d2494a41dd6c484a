"""Integrals over the rigid discs that make up a twisted contact, see `TwistPoint`."""

from math import exp, expm1, pi

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, elliprd

__all__ = ["DEEPEST", "SLIDES", "depth_of", "e_prime", "scaled_angle", "scaled_moment"]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)
DEEPEST, SLIDES = 14.0, 1.0 - 1e-14  # log(a/c) and moment/limit of complete slip, to rounding


def e_prime(s):
    """Complete elliptic integral E of modulus sqrt(1 - s^2)."""
    return ellipe(1.0 - s * s)


def scaled_angle(depth):
    """K - E of modulus sqrt(1 - k^2) at k = exp(-depth), accurate for small depths as well."""
    return -expm1(-2.0 * depth) / 3.0 * float(elliprd(0.0, exp(-2.0 * depth), 1.0))


def scaled_moment(depth):
    """Integral of s^2 E'(s) from exp(-depth) to 1, over that from 0."""
    half = -0.5 * expm1(-depth)
    s = 1.0 - half * (1.0 - _NODES)
    return float(half * (_WEIGHTS * s * s * e_prime(s)).sum() / (3.0 * pi**2 / 64.0))


def depth_of(function, slope, value, most):
    """The depth, at most `most`, where a function of it has a value; `slope` is that at 0."""
    least = value / slope
    if value < 1e-17:  # nothing else is left
        return least
    return brentq(lambda depth: function(depth) - value, 0.5 * least, most, xtol=1e-15 * least)
