"""Fixtures that the tests of the closed-form solutions share."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from ngslac.reference import HertzLine


@pytest.fixture
def seed():
    """Steel-like cylinder on a softer flat block: the Hertz case of the LAC paper."""
    return HertzLine(force=35e3, radius1=50, young1=210e3, nu1=0.3, young2=70e3, nu2=0.3)


@pytest.fixture
def integral():
    """Integral of a function over (x0, x1), cut at `breaks`, by adaptive quadrature."""

    def integrate(function, x0, x1, breaks=()):
        cuts = [x0, *sorted(b for b in breaks if x0 < b < x1), x1]
        return sum(
            quad(function, low, high, limit=200, epsabs=0, epsrel=1e-11)[0]
            for low, high in pairwise(cuts)
        )

    return integrate


@pytest.fixture
def hilbert():
    """(1/pi) pv int function(s)/(x - s) ds over the range of `breaks`, which include all kinks."""

    def transform(function, x, breaks):
        reach = 0.5 * min(abs(x - b) for b in breaks)
        value = -quad(function, x - reach, x + reach, weight="cauchy", wvar=x)[0]
        below = [*sorted(b for b in breaks if b < x), x - reach]
        above = [x + reach, *sorted(b for b in breaks if b > x)]
        for cuts in (below, above):
            for low, high in pairwise(cuts):
                value += quad(lambda s: function(s) / (x - s), low, high, limit=200)[0]
        return value / np.pi

    return transform
