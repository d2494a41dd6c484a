# SPDX-License-Identifier: LGPL-2.1-or-later
"""Residual estimator of the discretization error of bodies in contact."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import L2, CoefficientFunction, GridFunction, InnerProduct, Mesh, Region, dx

from ngslac.analysis.balance import Balance, ContactPoints

if TYPE_CHECKING:
    from ngslac.solve.solver import ContactSolver

__all__ = ["ErrorEstimate", "ResidualEstimate"]


@dataclass(frozen=True)
class ErrorEstimate:
    """An estimate of the error in the energy norm, by elements and by parts.

    Norms are roots of energies: of the integral of stress times strain, twice the elastic energy.

    Attributes
    ----------
    kind : str
        "residual" or "equilibrated".
    bulk, contact, consistency : (ne,) array
        Squares of the parts of each element: equilibrium within the bodies and on their other
        boundaries; balance with the contact tractions; contact conditions at points, which
        multipliers impose in the mean only.
    energy : float
        Norm of the solution.
    """

    kind: str
    bulk: np.ndarray
    contact: np.ndarray
    consistency: np.ndarray
    energy: float

    @property
    def squares(self) -> np.ndarray:
        """Squares of the indicators (ne,): the sum of the parts."""
        return self.bulk + self.contact + self.consistency

    @property
    def indicators(self) -> np.ndarray:
        """The part of each element (ne,), root of an energy."""
        return np.sqrt(self.squares)

    @property
    def total(self) -> float:
        """The estimate, root of an energy."""
        return float(np.sqrt(np.sum(self.squares)))

    @property
    def relative(self) -> float:
        """The estimate over the norm of the solution, 0 where both vanish."""
        return self.total / self.energy if self.energy > 0 else float(self.total > 0)

    def Field(self, mesh: Mesh) -> GridFunction:
        """The indicators as a function that is constant on elements, for pictures.

        Parameters
        ----------
        mesh : ngsolve.Mesh

        Returns
        -------
        ngsolve.GridFunction

        Raises
        ------
        ValueError
            The mesh has another number of elements.
        """
        if mesh.ne != len(self.bulk):
            raise ValueError(
                f"mesh has {mesh.ne} elements, the estimate is that of one with {len(self.bulk)}"
            )
        field = GridFunction(L2(mesh, order=0), name="indicators")
        field.vec.FV().NumPy()[:] = self.indicators
        return field

    def __str__(self) -> str:
        parts = {"bulk": self.bulk, "contact": self.contact, "consistency": self.consistency}
        words = ", ".join(f"{name} {np.sqrt(part.sum()):.3g}" for name, part in parts.items())
        return (
            f"{self.kind} estimate {self.total:.4g}, {100 * self.relative:.3g} % of the norm of "
            f"the solution ({words})"
        )


def ResidualEstimate(
    solver: ContactSolver,
    stress: Callable[[CoefficientFunction], CoefficientFunction],
    *,
    force: CoefficientFunction | None = None,
    tractions: dict[str | Region, CoefficientFunction] | None = None,
) -> ErrorEstimate:
    """Estimate the error by what the solution leaves unbalanced.

    Elements do not balance ``div stress + force``, faces the jump of the traction, and contact
    surfaces its difference from the contact traction, which acts opposite on the master. They are
    weighted by h/(2 G)^(1/2) and (h/(2 G))^(1/2), with the size h of the element and its shear
    modulus G. At points, gaps of closed and overlaps of open macro-elements, and slip where they
    stick, count by (4 G/h)^(1/2), with both bodies in series, and friction that does not oppose its
    slip by its work. Of a ``law`` of your own only its tractions are known.

    Parameters
    ----------
    solver : ContactSolver
        With a converged solution, or a stepper. It is not changed.
    stress : callable
        Gets the displacement gradient (d, d) and returns the (first Piola-Kirchhoff) stress (d, d)
        of the bulk, such as ``lambda H: Stress(Sym(H), E, nu)``. Around an axis ``H`` is that of
        `AxisymmetricGrad`, (3, 3).
    force : (d,) CoefficientFunction, optional
        Body force, per volume.
    tractions : dict, optional
        Surface loads (d,) by boundary name, stress units; those of springs as functions of the
        solution.

    Returns
    -------
    ErrorEstimate

    Raises
    ------
    ValueError, TypeError
        Nothing is solved; stress and loads do not balance in the displacement space, so that they
        are not those of the bulk; a distributed problem, ``finite=True`` or
        ``edges=True``.

    Notes
    -----
    It is equivalent to the error up to a constant that is not known, usually 3 to 10. Verfürth, *A
    posteriori error estimation techniques for finite element methods* (2013); for contact with
    friction Hild and Lleras, SIAM J. Numer. Anal. 47 (2009).

    Examples
    --------
    >>> from ngslac.analysis import ResidualEstimate
    >>> last = solver.Solve(printing=False)
    >>> down = {"top": CF((0, -0.01 * load))}
    >>> found = ResidualEstimate(solver, lambda H: Sym(H), tractions=down)
    >>> found.relative < 1e-9  # an even pressure, which the space has
    True
    """
    balance = Balance(solver, stress, force, tractions)
    return Residuals(balance)


def Residuals(balance: Balance, besides: Sequence[Region] = ()) -> ErrorEstimate:
    """The estimate; boundary regions of `besides` do not count."""
    h, modulus = balance.size, 2 * balance.modulus
    jumps, differences = balance.FacetResidual(besides)
    edge = dx(element_boundary=True)
    left = balance.Divergence()
    bulk = balance.Elementwise(h * h / modulus * InnerProduct(left, left))
    bulk += balance.Elementwise(0.5 * h / modulus * InnerProduct(jumps, jumps), edge)
    square = InnerProduct(differences, differences)
    contact = balance.Elementwise(0.5 * h / modulus * square, edge)
    return ErrorEstimate("residual", bulk, contact, Consistency(balance), balance.energy)


def Consistency(balance: Balance) -> np.ndarray:
    """Squares (ne,) of what contact conditions are violated by at points."""
    total, count = np.zeros(balance.mesh.ne), balance.mesh.ne
    for contact in balance.contacts:
        points = ContactPoints(contact, balance)
        squares = points.stiffness * np.sum(points.violation**2, axis=1)
        total += points.Sum(squares + 2 * points.work, count)
    return total
