# SPDX-License-Identifier: LGPL-2.1-or-later
"""Elastic constants of a pair of bodies in plane strain."""

from math import inf, isinf

from ._checks import poisson, positive

__all__ = ["ContactModulus", "DundursBeta", "shear_sum"]


def _check_pair(young1: float, nu1: float, young2: float, nu2: float) -> None:
    """Check the constants of two bodies."""
    positive("young1", young1, infinite=True)
    positive("young2", young2, infinite=True)
    poisson("nu1", nu1)
    poisson("nu2", nu2)
    if isinf(young1) and isinf(young2):
        raise ValueError(
            f"young2 = {young2!r} is not valid: body 1 is rigid already, give body 2 a finite value"
        )


def shear_sum(
    factor1: float, factor2: float, *, young1: float, nu1: float, young2: float, nu2: float
) -> float:
    """Sum factor1/G1 + factor2/G2 over both bodies; a rigid one adds nothing."""
    return factor1 * 2.0 * (1.0 + nu1) / young1 + factor2 * 2.0 * (1.0 + nu2) / young2


def ContactModulus(*, young1: float, nu1: float, young2: float = inf, nu2: float = 0.0) -> float:
    """Modulus E* of two bodies in contact, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.

    Source: Johnson, Contact Mechanics (Cambridge, 1985), section 4.2.

    Parameters
    ----------
    young1, young2 : float
        Young's moduli, in any consistent unit of stress; `inf` makes one body rigid.
    nu1, nu2 : float
        Poisson ratios, in (-1, 0.5).

    Returns
    -------
    float
        E*, in the unit of the moduli.

    Examples
    --------
    >>> print(f"{ContactModulus(young1=210e3, nu1=0.3, young2=70e3, nu2=0.3):.1f}")
    57692.3
    """
    _check_pair(young1, nu1, young2, nu2)
    return 1.0 / ((1.0 - nu1**2) / young1 + (1.0 - nu2**2) / young2)


def DundursBeta(*, young1: float, nu1: float, young2: float = inf, nu2: float = 0.0) -> float:
    """Second Dundurs constant in plane strain: how far pressure alone makes the surfaces slip.

    With the shear moduli G1 and G2, and arguments as in `ContactModulus`::

        beta = ((1 - 2 nu1)/G1 - (1 - 2 nu2)/G2) / (2 (1 - nu1)/G1 + 2 (1 - nu2)/G2)

    Body 1 is the slave. beta > 0 means that, under pressure without friction, the surface of the
    slave moves further towards the middle of the contact than that of the master. Exchanging the
    bodies changes the sign. Source: Dundurs, J. Appl. Mech. 36 (1969) 650; Johnson, Contact
    Mechanics (Cambridge, 1985), section 5.1.

    Returns
    -------
    float
        beta, without unit, between -1/2 and 1/2 for Poisson ratios from 0 on.

    Examples
    --------
    >>> print(f"{DundursBeta(young1=210e3, nu1=0.3, young2=70e3, nu2=0.3):.6f}")
    -0.142857
    """
    _check_pair(young1, nu1, young2, nu2)
    bodies = dict(young1=young1, nu1=nu1, young2=young2, nu2=nu2)
    difference = shear_sum(1.0 - 2.0 * nu1, 2.0 * nu2 - 1.0, **bodies)
    return difference / (2.0 * shear_sum(1.0 - nu1, 1.0 - nu2, **bodies))
