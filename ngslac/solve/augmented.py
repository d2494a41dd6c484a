# SPDX-License-Identifier: LGPL-2.1-or-later
"""Augmented Lagrangian method: the multipliers move on after each Newton step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ngslac.arguments import CheckPositive
from ngslac.parallel.form import Compiled, TraceOf
from ngslac.solve.solver import ContactSolver

if TYPE_CHECKING:
    from ngsolve import BilinearForm, GridFunction

    from ngslac._ngslac import ContactForm
    from ngslac.contact.contact import LACContact
    from ngslac.solve.iteration import Iteration
    from ngslac.solve.newton import Newton
    from ngslac.solve.residual import Measurement
    from ngslac.solve.system import System

__all__ = ["Augmented", "AugmentedLagrangianSolver"]

# Augmentation where none is asked for: the first one, and by how much it grows, up to what, where
# the constraints come closer by less than a factor while the status stays.
START, GROWTH, LARGEST, PROGRESS = 30.0, 10.0, 1e9, 0.25
# Relative residual of linear systems, times the augmentation: the multipliers do no better.
EXACT = 0.1


class AugmentedLagrangianSolver(ContactSolver):
    """Solve bulk plus contact by the augmented Lagrangian method, with one Newton step per update.

    With the multipliers lambda fixed in the contact law, a Newton step for the displacement has the
    matrix ``K + c/A B^T P' B``, without multipliers: where that of the bulk is symmetric positive
    definite and there is no friction, so is this one (small sliding; also where contact sticks or
    is tied). Then the multipliers move on, by c times what is left of the constraints (Uzawa;
    Hestenes 1969, Powell 1969; for contact Simo and Laursen 1992). Step and update are one linear
    system, which `ContactSolver` has with c = infinity; linear solvers, line search and residuals
    are the same, and the constraints hold to `tol`, whatever c is.

    When to take which: `ContactSolver` is the first choice, since here each step brings the
    constraints closer by about c only. This one damps multipliers where they are not unique, or
    nearly so, as where everything is held twice.

    Parameters
    ----------
    a, gf, contacts, **options :
        As in `ContactSolver`.
    augmentation : float, optional
        c in multiples of the stiffness of the surface, that of each macro-element, which is taken
        from the bulk's matrix (``stiffness`` of `LACContact` does not matter): in the end each step
        brings the constraints closer by about this factor. From about 100 on iterative solvers take
        more iterations, up to where these rows count as constraints (1e6). Default: starts at 30,
        and grows where the constraints come closer by less than 4.

    Attributes
    ----------
    history : list[Iteration]
        Of the last `Solve`: one line for each linear solve.

    Raises
    ------
    ValueError, TypeError
        An augmentation that is no positive number, and what `ContactSolver` raises. Where one
        that was given is too small to lead to the solution, the error says so.

    Examples
    --------
    >>> solver = AugmentedLagrangianSolver(a, gf, contact, augmentation=50)
    >>> solver.Solve(printing=False).constraint < 1e-10
    True
    """

    def __init__(
        self,
        a: BilinearForm,
        gf: GridFunction,
        contacts: LACContact | Sequence[LACContact],
        *,
        augmentation: float | None = None,
        **options,
    ):
        if augmentation is not None:
            CheckPositive("augmentation", augmentation, "a positive factor, or None")
        super().__init__(a, gf, contacts, **options)
        self.system.scheme = Augmented(augmentation)

    @property
    def augmentation(self) -> float | None:
        """As asked for; None: the solver's own choice."""
        return self.system.scheme.wanted

    @property
    def factor(self) -> float:
        """The augmentation at the end of the last `Solve`, a float."""
        return self.system.scheme.factor

    @property
    def outer(self) -> int:
        """How often the last `Solve` moved the multipliers on, an int."""
        return self.system.scheme.outer


class Augmented:
    """A penalty in each linear system, with the verbs of `Saddle`."""

    most, searches = np.inf, False

    def __init__(self, wanted: float | None):
        self.wanted, self.factor, self.outer = wanted, wanted or START, 0

    @property
    def advice(self) -> str:
        """What else to try where there is no convergence."""
        if self.wanted is None:
            return ""
        return f", or an augmentation larger than {self.wanted:g}"

    @property
    def accuracy(self) -> float:
        """Relative residual of a linear system that is enough in each step."""
        return EXACT / max(self.factor, 1.0)

    def Prepare(self, newton: Newton, state: Measurement) -> None:
        """Adapt the augmentation to what the last update reached."""
        count = len(newton.history)
        if count == 1:
            self.factor, self.outer = self.wanted or START, 0
        elif count > 2 and self.wanted is None and self._IsSlow(newton, *newton.history[-2:]):
            self.factor = min(GROWTH * self.factor, LARGEST)
        self.outer += 1

    def _IsSlow(self, newton: Newton, before: Iteration, last: Iteration) -> bool:
        """Do the constraints hardly come closer while the status stays?"""
        slow = last.constraint > max(PROGRESS * before.constraint, newton.tol)
        return slow and last.damping == 1 and not last.changed

    def Change(self, system: System) -> None:
        """Give the multipliers the compliance of the penalty, which makes their update."""
        for contact in system.contacts:
            # No weaker than the scale of the contact, or else the status goes round.
            factor = max(self.factor / contact.stiffness, min(self.factor, 1.0))
            scale = TraceOf(contact.form).Gather(system.scale)
            Soften(Compiled(contact.form), factor, scale)


def Soften(form: ContactForm, factor: float, scale: np.ndarray) -> None:
    """Let the projection see less of a change of the multipliers: 1 - 1/factor of it.

    The derivative of the rows ``(P(lambda - c j) - lambda) A/c`` by the multipliers is
    ``(P' - 1) A/c``, where the factors of the rows tell A/c. What closes has 0 there, and gets
    ``-A/(factor c)``.
    """
    values, columns, starts = map(np.asarray, form.mat.CSR())
    dofs = np.asarray(form.MultiplierDofs())
    own = np.zeros(form.mat.height, dtype=bool)
    own[dofs] = True
    rows = np.repeat(np.arange(form.mat.height), np.diff(starts.astype(int)))
    block = np.flatnonzero(own[rows] & own[columns])
    diagonal = block[rows[block] == columns[block]]
    values[block] *= 1 - 1 / factor
    values[diagonal] -= scale[rows[diagonal]] ** -2 / factor
