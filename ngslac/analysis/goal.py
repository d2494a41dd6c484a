# SPDX-License-Identifier: LGPL-2.1-or-later
"""Errors of a number that is asked for: residuals weighted by the adjoint solution."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import CF, CoefficientFunction, GridFunction, LinearForm, Region

from ngslac._ngslac import Side
from ngslac.analysis.balance import Balance
from ngslac.analysis.estimate import ErrorEstimate, Residuals
from ngslac.analysis.tangent import Tangent
from ngslac.arguments import CheckChoice, CheckInstance
from ngslac.arrays import ToCSR

if TYPE_CHECKING:
    from ngslac.contact.contact import LACContact
    from ngslac.solve.solver import ContactSolver

__all__ = ["GoalError", "GoalEstimate"]

GOALS = "force", "pressure", "area"
STEP = 1e-6  # of a displacement gradient, by which stresses are linearized


@dataclass(frozen=True)
class GoalError:
    """An estimate of the error of a number.

    Attributes
    ----------
    goal : str
    value : float
        Of the number now.
    primal, adjoint : ErrorEstimate
        Of the solution and of the adjoint one, in energy norms.
    """

    goal: str
    value: float
    primal: ErrorEstimate
    adjoint: ErrorEstimate

    @property
    def squares(self) -> np.ndarray:
        """Parts of the elements (ne,), in the unit of the number."""
        share = abs(self.value) / self.primal.energy**2 if self.primal.energy else 0.0
        return self.primal.indicators * self.adjoint.indicators + share * self.primal.squares

    @property
    def total(self) -> float:
        """The estimate, in the unit of the number: the sum of the parts."""
        return float(np.sum(self.squares))

    @property
    def relative(self) -> float:
        """The estimate over the size of the number."""
        return self.total / abs(self.value) if self.value else float(self.total > 0)

    def __str__(self) -> str:
        return (
            f"{self.goal} {self.value:.6g}, estimated error {self.total:.3g} "
            f"({100 * self.relative:.3g} %)"
        )


def GoalEstimate(
    solver: ContactSolver,
    stress: Callable[[CoefficientFunction], CoefficientFunction],
    goal: LinearForm | str,
    *,
    contact: LACContact | None = None,
    force: CoefficientFunction | None = None,
    tractions: dict[str | Region, CoefficientFunction] | None = None,
) -> GoalError:
    """Estimate the error of a force, of the peak pressure, or of the size of the contact.

    The adjoint solution says how much the number depends on what elements do not balance: it solves
    the transposed linearized system, with contact as it is. The estimate is the sum of the products
    of the indicators of both solutions, those of `ResidualEstimate`, and of a remainder: what is
    not linear, as the end of the contact, is of second order, and counts by the square of the
    relative error in energy.

    Parameters
    ----------
    solver : ContactSolver
    stress : callable
        As of `ResidualEstimate`.
    goal : {"force", "pressure", "area"} or LinearForm
        The integral of the pressure; the largest pressure of a macro-element; the area by which
        contact takes part, ``(integral of p)^2 / integral of p^2``: of Hertz' line contact
        ``3 pi^2/16 a`` per length, of his circle ``8/9 pi a^2``, for the half-width or radius a.
        Or a LinearForm on the product space, of which the number is the value at the solution.
    contact : LACContact, optional
        Of which contact; default: the first one.
    force : (d,) CoefficientFunction, optional
        Body force, per volume.
    tractions : dict, optional
        Surface loads (d,) by boundary name, stress units. These boundaries are not looked at in the
        adjoint solution, which springs there would load.

    Returns
    -------
    GoalError

    Raises
    ------
    ValueError, TypeError
        As of `ResidualEstimate`; an unknown goal or contact; nothing is in contact; the tangent is
        singular.

    Notes
    -----
    It is a bound up to constants, which make it too large, often ten times and more. Becker and
    Rannacher, Acta Numerica 10 (2001).

    Examples
    --------
    >>> from ngslac.analysis import GoalEstimate
    >>> last = solver.Solve(printing=False)
    >>> down = {"top": CF((0, -0.01 * load))}
    >>> found = GoalEstimate(solver, lambda H: Sym(H), "force", tractions=down)
    >>> bool(abs(found.value - contact.Force()[1]) < 1e-12)
    True
    """
    balance = Balance(solver, stress, force, tractions)
    if contact is None:
        contact = balance.contacts[0]
    if contact not in balance.contacts:
        raise ValueError("contact is none of the solver's: take one of solver.contacts")
    value, derivative = Derivative(goal, contact, balance)
    tangent = Tangent(solver)
    entries = tangent.Factors().Solve(derivative, transposed=True)
    adjoint = Adjoint(balance, tangent, entries)
    name = goal if isinstance(goal, str) else "goal"
    return GoalError(name, value, Residuals(balance), Residuals(adjoint, adjoint.besides))


def Derivative(
    goal: LinearForm | str, contact: LACContact, balance: Balance
) -> tuple[float, np.ndarray]:
    """The number, and its derivatives (n,) by the entries of the solution."""
    derivative = np.zeros(len(balance.entries))
    if isinstance(goal, LinearForm):
        if goal.space != balance.static.gf.space:
            raise ValueError("goal lives on another space than the solution: take that of u")
        derivative[:] = goal.Assemble().vec.FV().NumPy()
        return float(derivative @ balance.entries), derivative
    CheckInstance("goal", goal, str, f"one of {', '.join(GOALS)}, or a LinearForm")
    CheckChoice("goal", goal, GOALS)
    table = contact.Table()
    area, pressure = table["area"], table["pressure"]
    force, square = area @ pressure, area @ pressure**2
    if not square > 0:
        raise ValueError("goal: there is no pressure, so that nothing depends on it")
    value, slope = {
        "force": lambda: (force, area),
        "pressure": lambda: (pressure.max(), 1.0 * (np.arange(len(area)) == pressure.argmax())),
        "area": lambda: (
            force**2 / square,
            2 * force / square * area * (1 - force / square * pressure),
        ),
    }[goal]()
    slope = -slope[:, None] * table["normal"]
    derivative[contact.form.MultiplierDofs()] = slope.ravel()
    return float(value), derivative


def Adjoint(balance: Balance, tangent: Tangent, entries: np.ndarray) -> Balance:
    """Stress and contact tractions of the adjoint solution, which has no loads."""
    adjoint = copy(balance)
    adjoint.entries, adjoint.force, adjoint.tractions = entries, None, []
    adjoint.homogeneous = True
    adjoint.besides = [region for region, _ in balance.tractions]
    adjoint.u = GridFunction(balance.space)
    own = slice(balance.first, balance.first + len(balance.u.vec.FV()))
    values = adjoint.u.vec.FV().NumPy()
    values[:] = entries[own]
    size = np.abs(values).max() / balance.size.vec.FV().NumPy().min() or 1.0
    step, now = STEP / size, balance.kind.Gradient(balance.u)
    change = CF(step) * balance.kind.Gradient(adjoint.u)
    adjoint.stress = (balance.law(now + change) - balance.law(now - change)) / (2 * step)
    forces = -(tangent.contact.T @ entries)[own]
    jumps = [ToCSR(c.form.JumpMatrix(Side.both)) for c in balance.contacts]
    jump = scipy.sparse.vstack(jumps).tocsr()
    normal = (jump @ jump.T).tocsc()
    normal.setdiag(normal.diagonal() + 1e-14 * normal.diagonal().max())
    tractions = scipy.sparse.linalg.spsolve(normal, jump @ forces)
    ends = np.cumsum([j.shape[0] for j in jumps])[:-1]
    adjoint.multipliers = [
        part.reshape(c.space.nmacros, -1)
        for part, c in zip(np.split(tractions, ends), balance.contacts, strict=True)
    ]
    return adjoint
