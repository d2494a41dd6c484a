"""Augmented Lagrangian method: multipliers outside, displacements inside."""

from dataclasses import replace

import numpy as np
from netgen.meshing import NgException

from ngslac.arguments import CheckPositive
from ngslac.errors import ContactConvergenceError
from ngslac.linear.primal import PrimalSolver
from ngslac.solve.problem import CheckInverse, CheckTolerance
from ngslac.solve.solver import ContactSolver

__all__ = ["AugmentedLagrangianSolver"]

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
    outer : int
        How often the last `Solve` moved the multipliers on.
    factor : float
        The augmentation at the end of the last `Solve`.

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
        self.linear = PrimalSolver(self.linear, inverse)
        self.augmentation = augmentation
        self._Forget()

    def _Forget(self):
        """Begin with the first augmentation, and with the multipliers of the solution."""
        self.factor, self.outer = self.augmentation or START, 0
        self._fixed = self._pull = None
        self._tries, self._ceiling, self._slow = 0, LARGEST, False

    def Solve(self, *, maxit=50, tol=1e-10, printing=True, callback=None, motion=None, path=True):
        """As `ContactSolver.Solve`; `maxit` bounds the linear solves of all outer iterations.

        There is no other method for the contact status: `path` has no effect.
        """
        self._Forget()
        self._tol = CheckTolerance(tol)
        self.linear.Forget()
        return super().Solve(
            maxit=maxit, tol=tol, printing=printing, callback=callback, motion=motion, path=path
        )

    # --- outer iteration -----------------------------------------------------------------------

    def _ChooseMultipliers(self, state):
        """Those of the next step: the ones before, or the projections, which are in gf."""
        values, rows = self.gf.vec.FV().NumPy(), self.residual.rows
        if self._fixed is None:
            self.linear.Leave(rows)
            self._fixed, self._constraint = values[rows], np.inf
            rubs = any(c.finite and np.any(c.Table()["friction"] > 0) for c in self.contacts)
            self.factor = self.augmentation or (RUBBING if rubs else START)
        elif state.equilibrium <= max(FORCING * state.constraint, self._tol):
            self._slow = state.constraint > PROGRESS * self._constraint
            if self._slow and self.augmentation is None:
                self.factor = min(GROWTH * self.factor, self._ceiling)
            self._fixed, self._constraint = values[rows], state.constraint
            self.outer += 1
            self._BeginInner(state)
        elif self._Struggles():
            self._ceiling = self.factor / np.sqrt(GROWTH)
            self.factor = max(self.factor / GROWTH, LEAST)
            self._BeginInner(state)
        self._tries += 1
        values[rows] = self._fixed

    def _Struggles(self):
        """Is the augmentation too large for the inner iteration to get anywhere?"""
        if self.augmentation is not None or self.factor <= LEAST:
            return False
        short = len(self.history) > 2 and max(e.damping for e in self.history[-2:]) <= SHORT
        return self._tries > PATIENCE or (self._tries > PATIENCE // 2 and short)

    def _BeginInner(self, state):
        self._tries = 0
        self.globalization.Begin()
        self.globalization.Watch(state, 0)

    def _NotConverged(self, state):
        error = super()._NotConverged(state)
        if self.augmentation is None:
            return error
        other = "larger" if self._slow else "smaller"
        return ContactConvergenceError(
            f"{error}, or an augmentation {other} than {self.augmentation:g}; without one it is "
            "chosen on the way"
        )

    # --- inner iteration -----------------------------------------------------------------------

    def _Linearize(self, state):
        """Residual and matrices of the displacements, with the multipliers of this iteration."""
        self._ChooseMultipliers(state)
        vec, rows = self.gf.vec, self.residual.rows
        values = vec.FV().NumPy()
        residual = vec.CreateVector()
        residual.FV().NumPy()[:] = state.bulk
        pull = None if self._pull is None else self.factor * self._pull[rows]
        if pull is not None:
            values[rows] = self._fixed + pull
        self.linear.contacts = [
            contact.form.AssembleAugmented(vec, residual, self._FactorOf(contact))
            for contact in self.contacts
        ]
        if pull is not None:  # it only tells what is closed: the force is that of its penalty
            values[rows] = -pull
            for contact in self.contacts:
                contact.AddApply(vec, residual)
            values[rows] = self._fixed
            self._pull = None
        residual.FV().NumPy()[rows] = 0
        return residual

    def _Measure(self):
        """The State with those multipliers of which the forces of the inner problem are made.

        Its equilibrium is what the inner iteration reduces, its constraint what the outer one does.
        """
        try:
            self.residual.Follow()
            for contact in self.contacts:
                contact.form.UpdateMultipliers(self.gf.vec, self._FactorOf(contact))
        except NgException:
            pass  # Measure meets and reports it
        state = self.residual.Measure(self.scale, honest=self._motion is not None)
        return replace(state, merit=state.unbalance)

    def _FactorOf(self, contact):
        """Of the form's scale, in which `stiffness` is."""
        return self.factor / contact.stiffness

    def _Newton(self, state, maxit, most=0):
        return super()._Newton(state, max(maxit, most))

    def _Otherwise(self, error, maxit, start, motion, found):
        """There is no other method: what was found if it may be, else the error."""
        if found is not None and not self._Bodies().Lost(found):
            return self._Accepted()
        self._CheckBalance(error, start, motion, lost=True)
        raise error

    def _ContactMatrices(self):
        return self.linear.contacts

    def _CloseWhatFloats(self, start=False):
        values = self.gf.vec.FV().NumPy()
        before = values.copy()
        closed = super()._CloseWhatFloats(start)
        if closed:
            self._pull = values - before
            values[:] = before
        return closed
