# SPDX-License-Identifier: LGPL-2.1-or-later
"""Laws of elastic materials, as coefficient functions of a strain or of a deformation gradient.

Numbers are checked. The values of coefficient functions are not: a law has no mesh.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ngsolve import CoefficientFunction, Det, Grad, Id, IfPos, Trace, log, x

from ngslac.arguments import (
    CheckChoice,
    CheckInstance,
    CheckNumber,
    CheckPositive,
    Coefficient,
    Wrong,
)

__all__ = ["AxisymmetricGrad", "NeoHooke", "Stress"]


def Stress(
    strain: CoefficientFunction,
    young: CoefficientFunction | float,
    nu: CoefficientFunction | float,
    *,
    plane: str = "strain",
) -> CoefficientFunction:
    """Stress of linear elasticity, in 3D, in plane strain or in plane stress.

    ``E/(1+nu) (strain + c tr(strain) I)`` with ``c = nu/(1-2 nu)`` in 3D and in plane strain, where
    the strain across the plane is 0, and ``c = nu/(1-nu)`` in plane stress, where the stress across
    the plane is 0.

    Parameters
    ----------
    strain : ngsolve.CoefficientFunction, shape (2, 2) or (3, 3)
        Small strain, such as ``Sym(Grad(u))``; tension is positive.
    young : float or ngsolve.CoefficientFunction
        Young's modulus E > 0, force per area. A coefficient function gives each body its own,
        ``mesh.MaterialCF({"upper": 210e3, "lower": 70e3})``.
    nu : float or ngsolve.CoefficientFunction
        Poisson's ratio, between -1 and 1/2, both excluded.
    plane : {"strain", "stress"}
        What vanishes across the plane of a (2, 2) strain.

    Returns
    -------
    ngsolve.CoefficientFunction
        Stress of the shape of `strain`, force per area; tension is positive.

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If `strain` has another shape, or a number is outside its range; if plane stress is asked of
        a (3, 3) strain.

    Examples
    --------
    Half a percent of tension across, held in the other direction:

    >>> from netgen.occ import unit_square
    >>> from ngsolve import CF, Mesh
    >>> from ngslac.materials import Stress
    >>> mesh = Mesh(unit_square.GenerateMesh(maxh=1))
    >>> point = mesh(0.5, 0.5)
    >>> strain = CF((0, 0, 0, 0.005), dims=(2, 2))
    >>> [round(s, 6) for s in Stress(strain, 200.0, 0.25)(point)]
    [0.4, 0.0, 0.0, 1.2]
    >>> [round(s, 6) for s in Stress(strain, 150.0, 0.25, plane="stress")(point)]
    [0.2, 0.0, 0.0, 0.8]
    """
    dim = _Order("strain", strain)
    if CheckChoice("plane", plane, ("strain", "stress")) == "stress" and dim == 3:
        raise ValueError("plane = 'stress' needs a strain of shape (2, 2), got (3, 3)")
    young, nu = _Moduli(young, nu)
    share = nu / (1 - nu) if plane == "stress" else nu / (1 - 2 * nu)
    return young / (1 + nu) * (strain + share * Trace(strain) * Id(dim))


def NeoHooke(
    F: CoefficientFunction,
    young: CoefficientFunction | float,
    nu: CoefficientFunction | float,
    *,
    pressure: CoefficientFunction | None = None,
) -> CoefficientFunction:
    """Strain energy of a neo-Hookean body, in 3D or in plane strain.

    ``mu/2 (J^(-2/3) tr C - 3) + K/4 (J^2 - 1 - 2 log J)`` with C = F^T F (all of its three
    stretches), J = det F, the shear modulus mu = E/(2 (1+nu)) and the bulk modulus
    K = E/(3 (1-2 nu)) (J. C. Simo, C. Miehe, Comput. Methods Appl. Mech. Engrg. 98 (1992) 41-104,
    without plasticity).

    Rubber hardly changes its volume: from nu = 0.49 on Newton's method takes many small steps, and
    elements lock. With a pressure p as unknown the second part is ``-p (J - 1) - p^2 / (2 K)``,
    which is stationary at p = -K (J - 1), for nu = 1/2 at J = 1.

    Parameters
    ----------
    F : ngsolve.CoefficientFunction, shape (2, 2) or (3, 3)
        Deformation gradient, ``Id(mesh.dim) + Grad(u)``. In 2D the third stretch is 1.
    young : float or ngsolve.CoefficientFunction
        Young's modulus E > 0 at small strains, force per area.
    nu : float or ngsolve.CoefficientFunction
        Poisson's ratio at small strains, between -1 and 1/2, both excluded; with a pressure 1/2,
        too.
    pressure : ngsolve.CoefficientFunction, optional
        Trial function of a scalar space, one order below that of the displacement if both are
        continuous (H1); force per area, > 0 compression.

    Returns
    -------
    ngsolve.CoefficientFunction
        Energy per volume of the reference configuration; NaN where J <= 0. For a bilinear form:
        ``Variation(NeoHooke(F, young, nu) * dx)``.

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If `F` has another shape, or a number is outside its range.

    Examples
    --------
    >>> from netgen.occ import unit_square
    >>> from ngsolve import Grad, GridFunction, Id, Integrate, Mesh, VectorH1, x
    >>> from ngslac.materials import NeoHooke
    >>> mesh = Mesh(unit_square.GenerateMesh(maxh=1))
    >>> u = GridFunction(VectorH1(mesh, order=2))
    >>> u.Set((1e-4 * x, 0))
    >>> E, nu = 1000.0, 0.3
    >>> modulus = E * (1 - nu) / (1 + nu) / (1 - 2 * nu)
    >>> energy = Integrate(NeoHooke(Id(2) + Grad(u), E, nu), mesh)
    >>> abs(energy / (0.5e-8 * modulus) - 1) < 1e-3
    True
    """
    dim = _Order("F", F)
    young, nu = _Moduli(young, nu, incompressible=pressure is not None)
    shear, J = young / (2 * (1 + nu)), Det(F)
    # In plane strain the third stretch is 1.
    distortion = shear / 2 * (J ** (-2 / 3) * (Trace(F.trans * F) + 3 - dim) - 3)
    if pressure is None:
        return distortion + young / (12 * (1 - 2 * nu)) * (J * J - 1 - 2 * log(J))
    CheckInstance("pressure", pressure, CoefficientFunction, "a scalar trial function")
    if pressure.dim != 1:
        raise ValueError(f"pressure must be a scalar, got {pressure.dim} components")
    return distortion - pressure * (J - 1) - 3 * (1 - 2 * nu) / (2 * young) * pressure**2


def AxisymmetricGrad(
    u: CoefficientFunction, *, twist: CoefficientFunction | None = None
) -> CoefficientFunction:
    """Gradient of a displacement of a body of revolution, in components r, z and circumferential.

    The mesh in 2D is half of a section with ``x = r >= 0``, and forms have the factor ``2*pi*x``.
    On the axis ``u_r/r`` is the derivative of ``u_r``.

    Parameters
    ----------
    u : ngsolve.CoefficientFunction, shape (2,)
        A trial or test function or a GridFunction of a displacement space on a mesh in 2D.
    twist : ngsolve.CoefficientFunction, optional
        The displacement around the axis, of a scalar space: r times the angle, where that is small.
        It is zero on the axis, which its space has to know (``dirichlet="axis"``).

    Returns
    -------
    ngsolve.CoefficientFunction, shape (3, 3)

    Raises
    ------
    TypeError, ValueError
        `u` is no coefficient function, or has no two components; `twist` is no scalar.

    Examples
    --------
    A tube under internal pressure, for `LACSpace` with ``axisymmetric=True``:

    >>> from netgen.occ import unit_square
    >>> from ngsolve import BilinearForm, InnerProduct, Mesh, Sym, VectorH1, dx, pi, x
    >>> from ngslac.materials import AxisymmetricGrad, Stress
    >>> V = VectorH1(Mesh(unit_square.GenerateMesh(maxh=0.5)), order=2)
    >>> u, v = V.TnT()
    >>> strain, virtual = Sym(AxisymmetricGrad(u)), Sym(AxisymmetricGrad(v))
    >>> a = BilinearForm(V)
    >>> a += 2 * pi * x * InnerProduct(Stress(strain, 200e3, 0.3), virtual) * dx
    """
    CheckInstance("u", u, CoefficientFunction, "a displacement with 2 components")
    if tuple(u.dims) != (2,):
        raise ValueError(f"u must have 2 components, on a mesh in 2D; it has the shape {u.dims}")
    grad = Grad(u)
    hoop = _OverRadius(u[0], grad[0, 0])
    rows = [grad[0, 0], grad[0, 1], 0, grad[1, 0], grad[1, 1], 0, 0, 0, hoop]
    if twist is not None:
        CheckInstance("twist", twist, CoefficientFunction, "a scalar displacement around the axis")
        if tuple(twist.dims) not in ((), (1,)):
            raise ValueError(f"twist must be a scalar; it has the shape {tuple(twist.dims)}")
        around = Grad(twist)
        rows[2], rows[6], rows[7] = -_OverRadius(twist, around[0]), around[0], around[1]
    return CoefficientFunction(tuple(rows), dims=(3, 3))


def _OverRadius(value: CoefficientFunction, slope: CoefficientFunction) -> CoefficientFunction:
    """Something over the distance x from the axis, and on the axis its derivative."""
    return IfPos(x, value / IfPos(x, x, 1), slope)


def _Order(name: str, tensor: CoefficientFunction) -> int:
    """The number of rows of a tensor of second order."""
    wanted = "a coefficient function of shape (2, 2) or (3, 3)"
    if not isinstance(tensor, CoefficientFunction):
        raise Wrong(TypeError, name, tensor, wanted)
    if tuple(tensor.dims) not in ((2, 2), (3, 3)):
        raise ValueError(f"{name} must be {wanted}, got shape {tuple(tensor.dims)}")
    return tensor.dims[0]


def _Moduli(
    young: CoefficientFunction | float,
    nu: CoefficientFunction | float,
    *,
    incompressible: bool = False,
) -> tuple[CoefficientFunction | float, CoefficientFunction | float]:
    """Both constants, checked: a number for its range, a function for its values' kind."""
    check = partial(_CheckPoisson, incompressible=incompressible)
    return _Constant("young", young, CheckPositive), _Constant("nu", nu, check)


def _CheckPoisson(name: str, value: float, *, incompressible: bool) -> float:
    wanted = "a number between -1 and 1/2" + ", 1/2 too" * incompressible
    fits = (lambda nu: -1 < nu <= 0.5) if incompressible else (lambda nu: -1 < nu < 0.5)
    return CheckNumber(name, value, wanted, fits)


def _Constant(
    name: str, value: CoefficientFunction | float, check: Callable
) -> CoefficientFunction | float:
    varies = isinstance(value, CoefficientFunction)
    return Coefficient(name, value) if varies else check(name, value)
