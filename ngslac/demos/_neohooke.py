"""The neo-Hookean solid of the demos with large deformation."""

from __future__ import annotations

from ngsolve import Det, Id, Trace, log
from ngsolve import Grad as Gradient

__all__ = ["Energy"]


def Energy(u, young, nu):
    """Density of the strain energy of a neo-Hookean body, in 3D or in plane strain.

    ``mu/2 (J^(-2/3) tr C - 3) + K/4 (J^2 - 1 - 2 log J)`` with C = F^T F (all of its three
    stretches), J = det F, the shear modulus mu and the bulk modulus K (J. C. Simo, C. Miehe,
    Comput. Methods Appl. Mech. Engrg. 98 (1992) 41-104, without plasticity).

    Parameters
    ----------
    u : ngsolve proxy or GridFunction
        Displacement.
    young, nu : float or CoefficientFunction
        Young's modulus (stress) and Poisson's ratio at small strains.

    Returns
    -------
    ngsolve.CoefficientFunction
        Energy per volume of the reference configuration; NaN where J <= 0.

    Examples
    --------
    >>> from netgen.occ import unit_square
    >>> from ngsolve import CF, GridFunction, Integrate, Mesh, VectorH1, x
    >>> mesh = Mesh(unit_square.GenerateMesh(maxh=1))
    >>> u = GridFunction(VectorH1(mesh, order=2))
    >>> u.Set(CF((1e-4 * x, 0)))
    >>> E, nu = 1000.0, 0.3
    >>> modulus = E * (1 - nu) / (1 + nu) / (1 - 2 * nu)
    >>> abs(Integrate(Energy(u, E, nu), mesh) / (0.5e-8 * modulus) - 1) < 1e-3
    True
    """
    shear, bulk = young / (2 * (1 + nu)), young / (3 * (1 - 2 * nu))
    F = Id(u.dim) + Gradient(u)
    J = Det(F)
    # In plane strain the third stretch is 1.
    distortion = J ** (-2 / 3) * (Trace(F.trans * F) + 3 - u.dim) - 3
    return shear / 2 * distortion + bulk / 4 * (J * J - 1 - 2 * log(J))
