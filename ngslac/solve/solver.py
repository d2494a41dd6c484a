"""Generalised Newton method with active set for bulk plus contact."""

import numpy as np

from ngslac.arguments import (
    CheckChoice,
    CheckCount,
    CheckFlag,
    CheckFunction,
    CheckParts,
    CheckState,
    FillVector,
)
from ngslac.arrays import AsNumPy, ScalarDofs
from ngslac.bodies.bodies import Bodies, CloseNearest, FewMessage, FloatingMessage, SlidingMessage
from ngslac.bodies.rigidbalance import CarriedOff, IsLinear
from ngslac.callback import TellIterate
from ngslac.errors import ContactConvergenceError, FloatingBodyError, RefuseCopy
from ngslac.linear.solver import LinearSolveError
from ngslac.progress import Progress
from ngslac.solve.bulk import Bulk
from ngslac.solve.globalization import Globalization
from ngslac.solve.inverted import InvertedError, InvertedMessage, TurningMaterials
from ngslac.solve.iteration import Iteration, MostlySlips
from ngslac.solve.newton import ChooseSolver, NewtonStep
from ngslac.solve.problem import (
    CheckBulk,
    CheckContacts,
    CheckFreeDofs,
    CheckInverse,
    CheckMotion,
    CheckStart,
    CheckTolerance,
)
from ngslac.solve.residual import Residual
from ngslac.solve.search import FAILURES, StatusSearch
from ngslac.solve.snapshot import Snapshot

__all__ = ["ContactSolver", "OnBulk"]

# Newton steps before another method is tried, and what that has to have left to be tried.
NEWTON, LEAST = 30, 10
# Slip of a step, relative to the size of macro-elements, that small sliding is not made for.
STRAYED = 0.5
# Forces that push nothing, relative to those at work.
IDLE = 1e-9
# Iterations of another method where Newton's has found that loads carry a body off, or where it
# found nearly all slipping for some time.
SEARCH, RUBBED = 30, 10
# Iterations without a change of status in which a residual that falls no more is at a minimum.
STILL = 4
# Forces without balance, relative to those at work, that are more than the search for a balance.
PUSHED = 1e-4


class ContactSolver(NewtonStep):
    """Solve bulk plus contact by a generalised Newton method.

    The contact status of each macro-element follows from the projection in the contact form, so
    that active set, friction and the bulk's nonlinearity converge in one loop, quadratically in the
    end. What is solved is scaled to be independent of units, and each linear solve is checked.

    Parameters
    ----------
    a : BilinearForm
        The bulk, on the product space. May contain the loads, may be nonlinear, may condense.
    gf : GridFunction
        Solution, on the same space; start value, with Dirichlet values set.
    contacts : LACContact or list of LACContact
    rhs : LinearForm, BaseVector or callable returning a BaseVector, optional
        Further loads (force units): the solution makes ``a.Apply(gf) - rhs`` + contact vanish.
    freedofs : BitArray, optional
        Default: the free dofs of the space.
    inverse : str, optional
        NGSolve sparse direct solver. Default, where MKL is installed: Pardiso; else
        "sparsecholesky" for symmetric matrices and "umfpack" for others. A result with a bad
        residual is recomputed by "umfpack".
    solver : {"direct", "iterative", "saddle"}, optional
        How linear systems are solved. "direct": each macro-element's multiplier and one inner node
        of its displacement are eliminated, the rest is factored (with slip, the frictionless system
        is, for GMRES); the factorisation serves again while few macro-elements change. "iterative":
        GMRES on the same system, preconditioned by Gauss-Seidel sweeps and a direct solution on the
        vertices: least memory, for order 2 and higher. "saddle": LU of the whole system.
        Default: "iterative" from 5,000 free displacements in 3D and 25,000 in 2D on, for small
        sliding, else "direct".
    preconditioner : callable, optional
        For "iterative", of any order: ``preconditioner(mat, freedofs)`` returns an operator of the
        same size, which approximates the inverse of a sparse matrix on the free dofs, as an
        algebraic multigrid method does. Called for each new matrix; the numbers of the scalar dofs
        are those of the product space, and the rows of the multipliers are empty.
    initial : {"gap", "none"}
        Which macro-elements start closed when a body is held by contact alone: those nearest to the
        master, or none (then such a body is an error).

    Attributes
    ----------
    history : list[Iteration]
        Of the last `Solve`.
    linear :
        How linear systems are solved; ``print(solver.linear)`` says it. ``linear.factorisations``
        and ``linear.krylov`` count factorisations and iterations.

    Raises
    ------
    ValueError, TypeError
        If there is no contact, spaces differ, the start holds NaN, an option is unknown, or the
        bulk form was made with a flag that leaves no matrix to solve with.

    Examples
    --------
    >>> solver = ContactSolver(a, gf, contact)
    >>> solver.Solve(printing=False).equilibrium < 1e-10
    True
    """

    __deepcopy__ = __reduce_ex__ = RefuseCopy

    def __init__(
        self,
        a,
        gf,
        contacts,
        *,
        rhs=None,
        freedofs=None,
        inverse=None,
        solver=None,
        preconditioner=None,
        initial="gap",
    ):
        space = CheckBulk(a).space
        self.gf, self.contacts = CheckStart(gf, space), CheckContacts(contacts, space)
        self.initial = CheckChoice("initial", initial, ("gap", "none"))
        CheckFreeDofs(freedofs, space, self.contacts)
        CheckInverse(inverse)
        scalars = ScalarDofs(space.FreeDofs(a.condense) if freedofs is None else freedofs, space)
        self.linear = ChooseSolver(a, self.contacts, scalars, inverse, solver, preconditioner)
        self.bulk = Bulk(a, gf, rhs)
        free = self.linear.free | self.bulk.inner
        self.constrained = ~(free | AsNumPy(ScalarDofs(space.FreeDofs(), space)))
        self.residual = Residual(self.bulk, self.contacts, free)
        self.globalization = Globalization()
        self.history, self._closings, self._motion, self._onpath = [], 0, None, False
        self._running = False
        self._idle = False  # do bodies float that nothing pushes?
        self.scale = None  # of the rows, once there is a matrix
        self._bodies, self._silent = None, True
        self._apart = False  # is the bulk known to leave the multipliers alone?
        self.stuck = None  # where the last solve did, if it did
        self._turning = None  # materials of which it knows finite rotations, once that matters

    def __repr__(self):
        contacts = ", ".join(map(repr, self.contacts))
        return f"<{type(self).__name__}: {contacts}; {self.linear}>"

    # --- the loop ------------------------------------------------------------------------------

    def Solve(self, *, maxit=100, tol=1e-10, printing=True, callback=None, motion=None, path=True):
        """Iterate until both relative residuals are below `tol`.

        Parameters
        ----------
        maxit : int
            Largest number of linear solves.
        tol : float
            For the equilibrium and the constraint residual, relative to the forces at work (the
            largest of this and of earlier converged states), free of units.
        printing : bool
            One line per iteration; the first time also how linear systems are solved.
        callback : callable, optional
            Called with each `Iteration`.
        motion : (n,) array, optional
            How far constrained dofs still have to move. The Newton steps carry it: Dirichlet values
            that jump turn the elements beside them inside out.
        path : bool
            Where Newton's method fails, an interior point method looks for the contact status.
            False: only if nothing but contact is nonlinear; else a smaller step mostly is the
            better way.

        Returns
        -------
        Iteration
            The last one.

        Raises
        ------
        ValueError, TypeError
            If `maxit` is no count, `tol` not between 0 and 1, the space was refined, or `a` or
            `rhs` holds terms with the multiplier.
        ContactConvergenceError
            Not converged. FloatingBodyError: a body is held by nothing. After any error `gf` is as
            before the call.
        """
        CheckCount("maxit", maxit)
        CheckTolerance(tol)
        CheckFlag("printing", printing)
        CheckFunction("callback", callback)
        CheckMotion(motion, self.constrained)
        CheckFlag("path", path)
        if self._running:
            raise ValueError(
                "Solve was called in the middle of Solve, by its callback or in another thread: "
                "call it after that ends"
            )
        self.CheckSpace()
        self.PairOnce()
        before = Snapshot(self)
        self.history, self._closings, self._status, self._onpath = [], 0, None, False
        self.tol, self._motion, self.linear.shifts = tol, None, 0
        self._printing, self._callback = printing, callback
        self._path, self._exhausted = path, False
        self._unbalanced, self._certain, self.stuck = "", False, None
        self._slides, self._rubs = "", False
        if motion is not None and np.any(motion[self.constrained]):
            self._motion = np.where(self.constrained, motion, 0.0)
            self._rest = np.finfo(float).eps * np.max(np.abs(self._motion))  # which is none
        if printing and self._silent:
            print(f"  {self.linear}")
            self._silent = False
        try:
            self._running = True
            with Progress("contact: Newton's method") as self._progress:
                return self._Iterate(maxit)
        except BaseException as error:
            history = self.history
            try:
                floating = self._WhatFloats() if isinstance(error, LinearSolveError) else []
            finally:
                before.Restore()
                self.history = history
            if isinstance(error, LinearSolveError):
                kind = FloatingBodyError if floating else ContactConvergenceError
                message = FloatingMessage(floating) if floating else str(error)
                raise self._Known(kind(message)) from error
            if isinstance(error, ContactConvergenceError):
                known = self._Known(error)
                raise known from (None if known is error else error)
            raise
        finally:
            self._running = False

    @property
    def a(self):
        """The bulk form."""
        return self.bulk.a

    def _Known(self, error):
        """The error with all that is known of it: which body is carried off, first of all."""
        if self._unbalanced or self._slides:
            error = FloatingBodyError(self._unbalanced or self._slides)
        error.history, error.certain = self.history, self._certain
        error.rubs = self._rubs
        error.slides = bool(self._slides) or (self._rubs and self._IsLinear())
        error.exhausted = self._exhausted or bool(self._unbalanced)
        return error

    def Merit(self, *, same_load=False):
        """Size of the residual at `gf`, infinite without one; None before the first solve.

        Parameters
        ----------
        same_load : bool
            The load is that of the last call: the bulk's part may be a product with its matrix.

        Returns
        -------
        float or None
            Relative to the forces at work, without unit.
        """
        CheckFlag("same_load", same_load)
        if not self.history:
            return None
        return self.residual.Measure(self.scale, honest=not same_load).merit

    def State(self):
        """What the next solve depends on: solution, contacts, forces at work.

        Returns
        -------
        dict
        """
        return {
            "gf": self.gf.vec.FV().NumPy().copy(),
            "contacts": [contact.State() for contact in self.contacts],
            "history": self.history,
            "scale": self.scale,
            "residual": self.residual.State(),
        }

    def SetState(self, state):
        """Go back to a state.

        Parameters
        ----------
        state : dict
            Of `State`.

        Raises
        ------
        TypeError, ValueError
            It is none, or that of another problem.
        """
        CheckState(state, "gf", "contacts", "residual", "history", "scale")
        factors = (np.ndarray, type(None))
        CheckParts(state, contacts=list, residual=dict, history=list, scale=factors)
        if len(state["contacts"]) != len(self.contacts):
            raise ValueError(
                f"state is that of {len(state['contacts'])} contacts, the solver has "
                f"{len(self.contacts)}"
            )
        before = self.gf.vec.FV().NumPy().copy(), [contact.State() for contact in self.contacts]
        try:
            self._Put(state["gf"], state["contacts"])
        except BaseException:
            self._Put(*before)
            raise
        self.residual.SetState(state["residual"])
        self.history, self.scale = state["history"], state["scale"]

    def _Put(self, values, parts):
        FillVector("gf", self.gf.vec, values)
        for contact, part in zip(self.contacts, parts, strict=True):
            contact.SetState(part, self.gf)

    def CheckSpace(self):
        """What was made for a space goes on with this one.

        Raises
        ------
        ValueError
            The space was refined since.
        """
        if len(self.linear.free) != self.gf.vec.FV().NumPy().size:
            raise ValueError(
                "the space was refined: make a new ContactSolver, and then new steppers"
            )

    def PairOnce(self):
        """Pair what is not paired yet, in the reference configuration."""
        for contact in self.contacts:
            if not contact.form.paired:
                contact.Update()

    def StartAfresh(self):
        """Keep no matrix and no factorisation: the next solve makes its own."""
        self.bulk.StartAfresh()
        self.linear.Forget()

    def _Iterate(self, maxit):
        self._Assemble()
        self.residual.Follow()
        state = self.residual.Begin(self.scale, self.tol)
        if not state.finite:
            raise ContactConvergenceError(f"{state.reason} at the start")
        start, motion = self.gf.vec.FV().NumPy().copy(), self._motion
        found = None
        try:
            if self._CloseWhatFloats(start=True):
                state = self.residual.Measure(self.scale, honest=True)
            self._Record(state)
            last = self._Newton(state, min(maxit, NEWTON), maxit)
            if not (self.residual.drowned and (self._Strays() or self._IsPushedFrom(start))):
                return last
            found = self.gf.vec.FV().NumPy().copy()
            raise ContactConvergenceError("bodies move until their forces are rounding errors")
        except InvertedError as error:
            self._CheckBalance(error, start, motion)
            raise
        except FAILURES as error:
            return self._Otherwise(error, maxit, start, motion, found)

    def _Strays(self):
        """Did a body that contact holds slip as far as macro-elements are large?"""
        tables = [(c.Table(), c.mesh.dim - 1) for c in self.contacts]
        slips = [np.linalg.norm(t["slip"], axis=1) / t["fullarea"] ** (1 / d) for t, d in tables]
        return bool(self._Bodies().floating) and np.max(np.concatenate(slips)) > STRAYED

    def _IsPushedFrom(self, start):
        """Do loads carry a body off from that solution? Contacts are as they are afterwards."""
        values = self.gf.vec.FV().NumPy()
        now = values.copy()
        values[:] = start
        carried = CarriedOff(self)
        values[:] = now
        self._Measure()
        return bool(carried)

    def _Otherwise(self, error, maxit, start, motion, found):
        """The last line of another method, from the start again; else what Newton's found."""
        values = self.gf.vec.FV().NumPy()
        self._slides = "" if found is not None else self._WhatSlides()
        held = bool(self._Bodies().floating)  # by contact alone
        self._rubs = held and len(self.history) > RUBBED and MostlySlips(self.history)
        if self._slides or self._rubs:
            maxit = min(maxit, len(self.history) + SEARCH)
        left = maxit - len(self.history)
        self._CheckBalance(error, start, motion, found is None)
        try:
            loose = found is not None or isinstance(error, FloatingBodyError)
            suits = loose or self._path or self._IsLinear()
            if self._exhausted or self._unbalanced or left < LEAST or not suits:
                raise error
            values[:], self._motion = start, motion
            self._exhausted = True
            return StatusSearch(self, maxit).Run(error)
        except FAILURES:
            if found is None or self._Bodies().Lost(found):
                raise
            values[:], self._motion = found, None
            self._Record(self._Measure())
            return self._Accepted()

    def _CheckBalance(self, error, start, motion, lost=False):
        """From the start again: raise the error if the loads have no equilibrium for certain.

        `lost`: has nothing been found? Then bodies may be held by nothing.
        """
        now, left = self.gf.vec.FV().NumPy().copy(), self._motion
        self.gf.vec.FV().NumPy()[:], self._motion = start, motion
        self.residual.Follow()
        for contact in self.contacts:
            contact.Evaluate(self.gf)
        self._exhausted = lost and not self._MayHold()
        self._unbalanced = "" if self._exhausted else CarriedOff(self)
        self._slides = "" if self._exhausted else self._slides
        self._certain = bool(self._unbalanced) and IsLinear(self)
        if self._certain:
            raise error
        self.gf.vec.FV().NumPy()[:], self._motion = now, left

    def _Newton(self, state, maxit, most=0):
        """Newton's method from the State recorded last: the last line.

        At most `maxit` steps, or up to `most` as long as the residual falls.
        """
        for contact in self.contacts:
            contact.form.BeginSolve()
        self.globalization.Begin()
        for number in range(max(maxit, most) + 1):
            if self._Converged(state):
                return self._Accepted()
            slow = number >= maxit and not (number < most and self.globalization.falls)
            if slow or self.globalization.stagnates:
                break
            self.globalization.Watch(state, self.history[-1].changed)
            if len(self.history) > 1:
                self._Assemble()
            state, damping = self._Step(state)
            state = self._Confirmed(state)
            self._Record(state, damping)
        still = not any(entry.changed for entry in self.history[-STILL:])
        if self.globalization.stagnates and still and not self._onpath:
            self.stuck = self.gf.vec.FV().NumPy().copy()
        raise self._NotConverged(state)

    def _NotConverged(self, state):
        return ContactConvergenceError(
            f"no convergence in {len(self.history) - 1} iterations: equilibrium "
            f"{state.equilibrium:.2e}, constraint {state.constraint:.2e}"
            + (", the contact status cycles" if self.globalization.cycles else "")
            + "; take smaller steps"
        )

    def _Accepted(self):
        """The last line, if the state that it tells of is possible."""
        if message := self._Inverted():
            raise InvertedError(message + "; take smaller steps, or a finer mesh there")
        self.residual.Accept()
        return self.history[-1]

    def _Inverted(self):
        """Which elements are inside out, where the determinant of the deformation has a meaning."""
        form, a = self.contacts[0].form, self.a
        if any(contact.finite for contact in self.contacts):
            return InvertedMessage(form, self.gf)
        if self._IsLinear():
            return ""
        if self._turning is None:
            self._turning = TurningMaterials(getattr(a, "bulk", a), form, self.gf)
        return InvertedMessage(form, self.gf, self._turning) if np.any(self._turning) else ""

    def _Converged(self, state):
        done = state.equilibrium < self.tol and state.constraint < self.tol
        return done and self._motion is None

    def _IsLinear(self):
        """Is nothing but the contact law nonlinear?"""
        return bool(self.bulk.islinear) and not any(contact.finite for contact in self.contacts)

    def _Settles(self):
        """Does a whole step lead to equilibrium? Then all of the motion is in it."""
        if self._IsLinear():
            self._motion = None
        return self._IsLinear()

    def _Confirmed(self, state):
        """The state, by the bulk's own residual where it looks converged or hopeless."""
        if self._Converged(state) or self.globalization.stagnates:
            linear = self.bulk.islinear
            state = self.residual.Confirm(state, self.scale)
            if not state.finite:
                raise ContactConvergenceError(state.reason)
            if linear and not self.bulk.islinear:  # assemble anew, and iterate on
                self.globalization.Begin()
        return state

    def _Record(self, state, damping=1.0):
        for contact in self.contacts:
            contact.Evaluate(self.gf)
        number = len(self.history)
        entry = Iteration.Of(number, state, self._status if number else state.status, damping)
        self._status = state.status
        self.history.append(entry)
        sizes = [max(e.equilibrium, e.constraint) for e in (self.history[0], entry)]
        if min(sizes) > self.tol:
            self._progress.At(np.log(sizes[1] / sizes[0]) / np.log(self.tol / sizes[0]))
        if self._printing:
            print(entry)
        if self._callback:
            TellIterate(self._callback, entry, self.gf)

    # --- bodies that nothing holds -------------------------------------------------------------

    def _CloseWhatFloats(self, start=False):
        """Close the nearest macro-elements where a body is held by open contact; True if so.

        At the start the status is no guide: rounding closes some of the macro-elements that touch.
        """
        for contact in self.contacts:
            contact.Evaluate(self.gf)
        touching = all(np.any(contact.Table()["status"]) for contact in self.contacts)
        self._idle = False
        if self._onpath or (touching and not start):
            return False
        floating = self._WhatFloats("rubbing")
        wanted = self.initial == "gap" and bool(floating)
        self._idle = wanted and self._AreIdle("rubbing")
        if self._idle or not floating:
            return False
        self._closings += 1
        if self._closings > 5:  # each time the iteration opened what was closed
            raise FloatingBodyError(
                FloatingMessage(floating)
                + ". The loads pull it away from the contact, or too little touches at first"
            )
        if self.initial == "gap" and CloseNearest(self.contacts, self.gf, self._WhatFloats):
            return True
        few = FewMessage(self.contacts)
        raise FloatingBodyError(FloatingMessage(self._WhatFloats()) + few)

    def _AreIdle(self, holds):
        """Does nothing push the bodies that float? Then nothing has to hold them."""
        residual = self.residual
        least = max(IDLE * residual.reference, 10 * residual.rounding)
        forces = residual.scaled, 1 / self.scale
        return self._Bodies().AreIdle(self.contacts, holds, forces, least)

    def _MayHold(self):
        """Would contact hold all bodies, if all of it were closed?"""
        return self.initial == "gap" and not self._WhatFloats("closed")

    def _WhatSlides(self):
        """What loads carry off where the status has settled, with friction at its limit."""
        settled = len(self.history) > STILL and not any(e.changed for e in self.history[-STILL:])
        # Where both ends of a body slip apart next to nothing is left: there one of them sticks.
        pushed = self.history and self.history[-1].equilibrium > PUSHED
        if not (settled and pushed and self._IsLinear()) or not any(
            contact.holds_tangentially for contact in self.contacts
        ):
            return ""
        floats = self._WhatFloats()
        return SlidingMessage(floats) if floats and not self._AreIdle("now") else ""

    def _WhatFloats(self, holds="now"):
        return self._Bodies().Floating(self.contacts, holds)

    def _Bodies(self):
        if self._bodies is None:
            self._bodies = Bodies(self.bulk.mat, self.contacts[0], self.linear.free)
        return self._bodies


def OnBulk(solver, bulk, bodies):
    """The same solver for another bulk on its space, and what stands for the bodies.

    Parameters
    ----------
    solver : ContactSolver
        Shares contacts and linear solver with the new one.
    bulk : Bulk
    bodies : Bodies or None
        None: they are found in the matrix of the bulk.

    Returns
    -------
    ContactSolver
    """
    other = object.__new__(type(solver))
    vars(other).update(vars(solver))
    other.bulk, other._bodies = bulk, bodies
    other.residual = Residual(bulk, solver.contacts, solver.residual.free)
    return other
