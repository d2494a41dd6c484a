"""Generalised Newton method with active set for bulk plus contact."""

import numpy as np
from ngsolve import BitArray, LinearForm

from ngslac._ngslac import EquilibrationScale
from ngslac.bodies import Bodies, FloatingMessage, NearestMacros
from ngslac.errors import ContactConvergenceError, FloatingBodyError
from ngslac.iteration import Iteration, State
from ngslac.linear import LinearSolveError, LinearSolver

__all__ = ["ContactSolver"]


class ContactSolver:
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
        NGSolve sparse direct solver for unsymmetric matrices. Default: "pardiso" where MKL is
        installed, else "umfpack". A result with a bad residual is recomputed by "umfpack".
    initial : {"gap", "none"}
        Which macro-elements start closed when a body is held by contact alone: those nearest to the
        master, or none (then such a body is an error).

    Attributes
    ----------
    history : list[Iteration]
        Of the last `Solve`.

    Examples
    --------
    >>> solver = ContactSolver(a, gf, contact)       # doctest: +SKIP
    >>> solver.Solve(tol=1e-10)                      # doctest: +SKIP
    """

    def __init__(self, a, gf, contacts, *, rhs=None, freedofs=None, inverse=None, initial="gap"):
        self.contacts = [*contacts] if isinstance(contacts, (list, tuple)) else [contacts]
        if not self.contacts:
            raise ValueError("ContactSolver needs at least one LACContact")
        if initial not in ("gap", "none"):
            raise ValueError(f"initial={initial!r} must be 'gap' or 'none'")
        for contact in self.contacts:
            if contact.form.fes != a.space or gf.space != a.space:
                raise ValueError("a, gf and the contacts must live on the same product space")
        if any(map(np.isnan, gf.vec.FV().NumPy())):
            raise ValueError("the start value gf holds NaN")
        self.a, self.gf, self.rhs, self.initial = a, gf, rhs, initial
        self.linear = LinearSolver(self._FreeDofs(freedofs), inverse)
        self.history = []
        self._bodies = None
        self._reference = self._converged = 0.0  # forces: of this solve, of converged states
        self._islinear = False  # the bulk, as far as seen: its matrix is kept

    def _FreeDofs(self, freedofs):
        space = self.a.space
        free = freedofs or space.FreeDofs(self.a.condense)
        if space.dim == 1:
            return free
        scalars = BitArray(len(free) * space.dim)
        for i in range(len(scalars)):
            scalars[i] = free[i // space.dim]
        return scalars

    # --- the loop ------------------------------------------------------------------------------

    def Solve(self, *, maxit=30, tol=1e-10, printing=True, callback=None):
        """Iterate until both relative residuals are below `tol`; returns the last `Iteration`.

        Parameters
        ----------
        maxit : int
            Largest number of linear solves.
        tol : float
            For the equilibrium and the constraint residual, relative and free of units.
        printing : bool
            One line per iteration.
        callback : callable, optional
            Called with each `Iteration`.

        Raises
        ------
        ContactConvergenceError
            Not converged; `gf` is as before the call. FloatingBodyError: a body is held by nothing.
        """
        if maxit < 1 or not tol > 0:
            raise ValueError(f"maxit = {maxit} must be at least 1 and tol = {tol} positive")
        self._tol = tol
        start = self.gf.vec.CreateVector()
        start.data = self.gf.vec
        try:
            return self._Iterate(maxit, tol, printing, callback)
        except (ContactConvergenceError, LinearSolveError) as error:
            self.gf.vec.data = start
            for contact in self.contacts:
                contact.Evaluate(self.gf)
            if isinstance(error, LinearSolveError):
                raise ContactConvergenceError(self._Diagnose(error), self.history) from error
            raise

    def _Iterate(self, maxit, tol, printing, callback):
        self.history = []
        self._Assemble()
        self._CloseWhatFloats()
        for contact in self.contacts:
            contact.form.BeginSolve()
        # A body that moves without touching feels nothing but the jump of its Dirichlet values.
        state = self._State()
        self._reference = max(self._converged, 1e-3 * self._forces)
        seen, merits, damped, damping = {}, [], False, 1.0
        for number in range(maxit + 1):
            self._Record(number, state, damping, printing, callback)
            if state.equilibrium < tol and state.constraint < tol:
                self._converged = max(self._forces, self._converged)
                return self.history[-1]
            if number == maxit:
                break
            # The same status came back, or nothing gets better: the iteration cycles.
            merits.append(state.merit)
            returned = number - seen.setdefault(state.status.tobytes(), number) > 1
            stuck = number > 5 and min(merits[-4:]) > 0.5 * min(merits[:-4])
            damped = damped or stuck or (returned and state.merit > 0.1 * min(merits))
            if number:
                self._Assemble()
            state, damping = self._Step(state, damped)
        raise ContactConvergenceError(
            f"no convergence in {maxit} iterations: equilibrium {state.equilibrium:.2e}, "
            f"constraint {state.constraint:.2e}"
            + (", the contact status cycles" if damped else "")
            + "; take smaller steps",
            self.history,
        )

    def _Record(self, number, state, damping, printing, callback):
        counts = np.bincount(state.status, minlength=3)
        before = self._status if number else state.status
        self._status = state.status
        entry = Iteration(
            number,
            state.equilibrium,
            state.constraint,
            *map(int, counts),
            int(np.sum(before != state.status)),
            damping,
        )
        self.history.append(entry)
        if printing:
            print(entry)
        if callback:
            callback(entry)

    # --- one iteration -------------------------------------------------------------------------

    def _Assemble(self):
        if not self._islinear:
            self.a.AssembleLinearization(self.gf.vec)
        for contact in self.contacts:
            contact.Prepare(self.a.mat)
        forms = [contact.form for contact in self.contacts]
        self.scale = EquilibrationScale(self.a.mat, forms)

    def _State(self):
        residual = self.gf.vec.CreateVector()
        contact_residual = self.gf.vec.CreateVector()
        self.a.Apply(self.gf.vec, residual)
        bulk = residual.FV().NumPy()
        load = self._Load()
        contact_residual[:] = 0
        for contact in self.contacts:
            contact.AddApply(self.gf.vec, contact_residual)
            contact.Evaluate(self.gf)
        # Forces at work: reactions, contact forces and loads all count.
        rows = self._ConstraintRows()
        forces = [bulk, contact_residual.FV().NumPy()]
        if load is not None:
            forces.append(load.FV().NumPy())
        self._forces = max(float(np.linalg.norm((self.scale * f)[~rows])) for f in forces)
        bulk = bulk if load is None else bulk - load.FV().NumPy()
        scaled = self.scale * (bulk + contact_residual.FV().NumPy()) * self.linear.free
        if not np.all(np.isfinite(scaled)):
            raise ContactConvergenceError("the residual holds NaN or infinite values", self.history)
        # No residual gets below the rounding errors of the stiffness times the displacement.
        rounding = 1e-14 * np.linalg.norm((self.gf.vec.FV().NumPy() / self.scale)[~rows])
        reference = max(self._forces, self._reference, rounding / self._tol) or 1.0
        return State(
            bulk=bulk.copy(),
            equilibrium=float(np.linalg.norm(scaled[~rows])) / reference,
            constraint=float(np.linalg.norm(scaled[rows])) / reference,
            status=np.concatenate([c.Table()["status"] for c in self.contacts]),
        )

    def _ConstraintRows(self):
        rows = np.zeros(len(self.scale), dtype=bool)
        for contact in self.contacts:
            rows[contact.form.MultiplierDofs()] = True
        return rows

    def _Load(self):
        if self.rhs is None:
            return None
        isform = isinstance(self.rhs, LinearForm)  # which is callable, too
        load = self.rhs() if callable(self.rhs) and not isform else self.rhs
        if hasattr(load, "Evaluate"):  # an expression such as 2 * vector
            load = load.Evaluate()
        load = getattr(load, "vec", load)
        if load.size != self.gf.vec.size:
            raise ValueError(f"rhs has {load.size} entries, the product space {self.gf.vec.size}")
        return load

    def _Step(self, state, damped):
        residual = self.gf.vec.CreateVector()
        residual.FV().NumPy()[:] = state.bulk
        for contact in self.contacts:
            contact.form.AssembleStep(self.gf.vec, residual)
        correction = self._Correction(residual)
        start = self.gf.vec.CreateVector()
        start.data = self.gf.vec
        best = None
        for damping in (1.0, 0.5, 0.25, 0.125) if damped else (1.0,):
            self.gf.vec.data = start
            self.gf.vec.FV().NumPy()[:] -= damping * correction
            trial = self._State()
            if best is None or trial.merit < best[0].merit:
                best = trial, damping
        self.gf.vec.data = start
        self.gf.vec.FV().NumPy()[:] -= best[1] * correction
        self._islinear = self._MovedLinearly(state, best[0], best[1] * correction)
        if self._CloseWhatFloats():
            return self._State(), best[1]
        return best

    def _MovedLinearly(self, before, after, correction):
        """Did the bulk's residual change as its matrix says, to rounding?"""
        if self.a.condense:
            return False  # the matrix holds the Schur complement only
        step, moved = self.gf.vec.CreateVector(), self.gf.vec.CreateVector()
        step.FV().NumPy()[:] = correction
        moved.data = self.a.mat * step
        expected = moved.FV().NumPy()
        deviation = np.linalg.norm(self.scale * (before.bulk - after.bulk - expected))
        return bool(deviation <= 1e-10 * np.linalg.norm(self.scale * expected))

    def _Correction(self, residual):
        a = self.a
        if a.condense:
            residual.data += a.harmonic_extension_trans * residual
        forms = [contact.form for contact in self.contacts]
        correction = self.gf.vec.CreateVector()
        correction.FV().NumPy()[:] = self.linear.Solve(
            a.mat, forms, self.scale, residual.FV().NumPy()
        )
        if a.condense:
            correction.data += a.harmonic_extension * correction
            correction.data += a.inner_solve * residual
        return correction.FV().NumPy().copy()

    # --- bodies that nothing holds -------------------------------------------------------------

    def _CloseWhatFloats(self):
        """Close the nearest macro-elements where a body is held by open contact; True if so."""
        for contact in self.contacts:
            contact.Evaluate(self.gf)
        if all(np.any(contact.Table()["status"]) for contact in self.contacts):
            return False
        if self._bodies is None:
            self._bodies = Bodies(self.a.mat, self.contacts[0], self.linear.free)
        if not self._bodies.Floating(self.contacts):
            return False
        if self.initial == "gap":
            for contact in self.contacts:
                contact.form.Close(NearestMacros(contact), self.gf.vec)
                contact.Evaluate(self.gf)
        if floating := self._bodies.Floating(self.contacts):
            raise FloatingBodyError(FloatingMessage(floating), self.history)
        return True

    def _Diagnose(self, error):
        bodies = self._bodies or Bodies(self.a.mat, self.contacts[0], self.linear.free)
        floating = bodies.Floating(self.contacts)
        return FloatingMessage(floating) if floating else str(error)
