"""Augmented Lagrangian method: multipliers outside, displacements inside."""

from dataclasses import replace

import numpy as np
from netgen.meshing import NgException

from ngslac.arguments import CheckPositive
from ngslac.linear.primal import PrimalSolver
from ngslac.solve.interior import EvenPressures
from ngslac.solve.iteration import Iteration
from ngslac.solve.problem import CheckInverse
from ngslac.solve.solver import ContactSolver

__all__ = ["Augmented", "AugmentedLagrangianSolver"]

# Augmentation where none is given: the first one, and between what it may change.
# Where surfaces rub and turn, many small outer iterations are easier than few large ones.
START, RUBBING, GROWTH, LARGEST, LEAST = 100.0, 10.0, 10.0, 1e5, 1e-3
# The multipliers move on when equilibrium is so much closer than the constraints; then these have
# to come so much closer each time, or the augmentation grows.
FORCING, PROGRESS = 0.1, 0.25
# Inner iterations after which the augmentation is too large, and the shortest part of a step that
# is none too short: the status goes round, or what it multiplies are rounding errors.
PATIENCE, SHORT = 10, 1 / 16


class AugmentedLagrangianSolver(ContactSolver):
    """Solve bulk plus contact by the augmented Lagrangian method (Uzawa): displacements only.

    For fixed multipliers lambda the contact traction is the projection P(lambda - c j) of the
    contact law with a large c, a function of the displacement. A generalised Newton method solves
    for the displacement. Its matrix ``K + c/A B^T P' B`` has no multipliers: where that of the bulk
    is symmetric positive definite and there is no friction, so is this one (small sliding; also
    where contact sticks or is tied). Then the multipliers become the projections, and so on
    (Hestenes 1969, Powell 1969; for contact Alart and Curnier 1991, Simo and Laursen 1992). The
    residuals are those of `ContactSolver`, and the constraints hold to `tol`, whatever c is.

    When to take which: `ContactSolver` needs fewer linear solves, most of all with friction, and is
    the first choice. This one is for solvers that want positive definite matrices, and for problems
    where a saddle point matrix is what fails. Measured on two blocks of hexahedra of order 2 with
    19,563 free dofs: 4 factorisations with both (here 8 linear solves, as the last matrix is
    kept), each 2.3 s by "sparsecholesky" here and 2.6 s by "umfpack" there, 1.7 s and 2.2 s by
    "pardiso". With friction, a 3D example takes 6 linear solves there and 10 here.

    Parameters
    ----------
    a, gf, contacts, rhs, freedofs, initial :
        As in `ContactSolver`.
    inverse : str, optional
        NGSolve sparse direct solver for symmetric matrices. Default: "pardiso" where MKL is
        installed, else "sparsecholesky". Matrices that friction, finite sliding or the bulk make
        unsymmetric go to the default of `ContactSolver`.
    augmentation : float, optional
        c in multiples of the stiffness of the surface, that of each macro-element, which is taken
        from the bulk's matrix (``stiffness`` of `LACContact` does not matter): each outer iteration
        brings the constraints closer by about this factor. Default: starts at 100 (with friction
        and ``finite=True`` at 10), grows where they come closer by less than 4, and falls where the
        inner iterations get nowhere.

    Attributes
    ----------
    history : list[Iteration]
        Of the last `Solve`: one line for each linear solve.

    Raises
    ------
    ValueError, TypeError
        An augmentation that is no positive number, and what `ContactSolver` raises. Where one
        that was given does not lead to the solution, the error says whether it is too large or
        too small.

    Examples
    --------
    >>> solver = AugmentedLagrangianSolver(a, gf, contact, augmentation=50)
    >>> solver.Solve(printing=False).constraint < 1e-10
    True
    """

    def __init__(
        self,
        a,
        gf,
        contacts,
        *,
        rhs=None,
        freedofs=None,
        inverse=None,
        initial="gap",
        augmentation=None,
    ):
        if augmentation is not None:
            CheckPositive("augmentation", augmentation, "a positive factor, or None")
        CheckInverse(inverse)
        super().__init__(a, gf, contacts, rhs=rhs, freedofs=freedofs, initial=initial)
        self.system.linear = PrimalSolver(self.linear, inverse)
        self.augmentation = augmentation
        self._scheme = Augmented(augmentation)

    @property
    def factor(self) -> float:
        """The augmentation at the end of the last `Solve`, a float."""
        return self._scheme.factor

    @property
    def outer(self) -> int:
        """How often the last `Solve` moved the multipliers on, an int."""
        return self._scheme.outer

    def Solve(
        self, *, maxit=50, tol=1e-10, printing=True, callback=None, motion=None, path=True
    ) -> Iteration:
        """As `ContactSolver.Solve`; `maxit` bounds the linear solves of all outer iterations.

        There is no other method for the contact status: `path` has no effect.
        """
        self._scheme = self.system.scheme = Augmented(self.augmentation)
        self.linear.Forget()
        return super().Solve(
            maxit=maxit, tol=tol, printing=printing, callback=callback, motion=motion, path=path
        )


class Augmented:
    """Multipliers that are fixed in each linear system, with the verbs of `Saddle`.

    Parameters
    ----------
    augmentation : float or None
        As in AugmentedLagrangianSolver.

    Attributes
    ----------
    factor : float
        The present one.
    outer : int
        How often the multipliers moved on.
    """

    most, searches = np.inf, False

    def __init__(self, augmentation):
        self.augmentation, self.factor, self.outer = augmentation, augmentation or START, 0
        self._fixed = self._pull = None
        self._tries, self._ceiling, self._slow = 0, LARGEST, False

    @property
    def advice(self):
        """What else to try where there is no convergence."""
        if self.augmentation is None:
            return ""
        return (
            f", or an augmentation {'larger' if self._slow else 'smaller'} than "
            f"{self.augmentation:g}; without one it is chosen on the way"
        )

    # --- outer iteration -----------------------------------------------------------------------

    def Prepare(self, newton, state):
        """Take the multipliers of the next step: those before, or the projections, now in gf."""
        system = newton.system
        values, rows = system.values, system.residual.multipliers
        if self._fixed is None:
            self._fixed, self._constraint = values[rows], np.inf
            rubs = any(c.finite and np.any(c.Table()["friction"] > 0) for c in system.contacts)
            self.factor = self.augmentation or (RUBBING if rubs else START)
        elif state.equilibrium <= max(FORCING * state.constraint, newton.tol):
            self._slow = state.constraint > PROGRESS * self._constraint
            if self._slow and self.augmentation is None:
                self.factor = min(GROWTH * self.factor, self._ceiling)
            self._fixed, self._constraint = values[rows], state.constraint
            self.outer += 1
            self._BeginInner(newton, state)
        elif self._Struggles(newton.history):
            self._ceiling = self.factor / np.sqrt(GROWTH)
            self.factor = max(self.factor / GROWTH, LEAST)
            self._BeginInner(newton, state)
        self._tries += 1
        values[rows] = self._fixed

    def _Struggles(self, history):
        """Is the augmentation too large for the inner iteration to get anywhere?"""
        if self.augmentation is not None or self.factor <= LEAST:
            return False
        short = len(history) > 2 and max(e.damping for e in history[-2:]) <= SHORT
        return self._tries > PATIENCE or (self._tries > PATIENCE // 2 and short)

    def _BeginInner(self, newton, state):
        self._tries = 0
        newton.globalization.Begin()
        newton.globalization.Watch(state, 0)

    # --- inner iteration -----------------------------------------------------------------------

    def Close(self, system, close):
        """As `Saddle.Close`, by multipliers which only tell what is closed."""
        before = system.values.copy()
        closed = close()
        if closed:
            self._pull = system.values - before
            system.values[:] = before
        return closed

    def Linearize(self, system, state):
        """Residual and matrices of the displacements, with the multipliers of this iteration."""
        rows = system.residual.multipliers
        system.linear.Leave(rows)
        residual = system.gf.vec.CreateVector()
        residual.FV().NumPy()[:] = state.bulk
        if self._pull is None:
            self._Assemble(system, residual)
        else:
            with EvenPressures(system.contacts):  # whose forces are linear
                self._AssemblePull(system, residual, self.factor * self._pull[rows])
            self._pull = None
        residual.FV().NumPy()[rows] = 0
        return residual

    def _Assemble(self, system, residual):
        system.linear.contacts = [
            contact.form.AssembleAugmented(system.gf.vec, residual, self._FactorOf(contact))
            for contact in system.contacts
        ]

    def _AssemblePull(self, system, residual, pull):
        """With the matrix of what is pulled together, whose force is that of its penalty."""
        vec, values, rows = system.gf.vec, system.values, system.residual.multipliers
        values[rows] = self._fixed + pull
        self._Assemble(system, residual)
        values[rows] = -pull
        for contact in system.contacts:
            contact.AddApply(vec, residual)
        values[rows] = self._fixed

    def Matrices(self, system):
        """What the contacts add to the bulk's matrix."""
        return system.linear.contacts

    def Measure(self, system, honest):
        """The Measurement with those multipliers of which the forces of the inner problem are made.

        Its equilibrium is what the inner iteration reduces, its constraint what the outer one does.
        """
        try:
            system.residual.Follow()
            for contact in system.contacts:
                contact.form.UpdateMultipliers(system.gf.vec, self._FactorOf(contact))
        except NgException:
            pass  # Measure meets and reports it
        state = system.residual.Measure(system.scale, honest)
        return replace(state, merit=state.unbalance)

    def _FactorOf(self, contact):
        """Of the form's scale, in which `stiffness` is."""
        return self.factor / contact.stiffness
