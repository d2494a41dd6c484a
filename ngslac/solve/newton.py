"""One step of the Newton method: assembly, linear solution, line search."""

import numpy as np

from ngslac._ngslac import EquilibrationScale, VertexDofs
from ngslac.arguments import CheckChoice, CheckFunction
from ngslac.arrays import Multiply, ScalarDofs
from ngslac.errors import ContactConvergenceError
from ngslac.linear.solver import LinearSolver
from ngslac.solve.problem import CheckMatrix, MultiplierRows
from ngslac.solve.residual import State

__all__ = ["ChooseSolver", "NewtonStep"]

# Shorter parts of a step may lead macro-elements off the master.
LEAST_SIGHT = 1 / 8
# Relative residual of an iterative solution while the contact status still changes: without and
# with tangential forces, whose direction has to be found, too.
LOOSE, FIRM = 0.1, 1e-2
# Of the diagonal of the scaled matrix: it keeps bodies where they are that nothing pushes.
IDLE_SHIFT = 1e-6
# What turns round sticks a little behind that point; how many of those that turn are looked at.
TURN, MOST_TURNS = 1e-6, 3
# From this many free displacements on an iterative solution is the faster one: 2D and 3D.
LARGE = {2: 25_000, 3: 5_000}


class NewtonStep:
    """The steps of a ContactSolver, which derives from it.

    Uses its ``bulk``, ``gf``, ``contacts``, ``linear``, ``residual`` and ``globalization``.
    """

    def _Assemble(self):
        bulk = self.bulk
        if bulk.Assemble():
            self.linear.NewBulk()
        for contact in self.contacts:
            contact.Prepare(bulk.mat)
        if not self._apart:
            CheckMatrix(bulk.mat, MultiplierRows(self.contacts))
            self._apart = True
        forms = [contact.form for contact in self.contacts]
        self.scale = EquilibrationScale(bulk.mat, forms)
        if self.a.condense:  # the Schur complement does not tell the stiffness of inner dofs
            self.scale[bulk.inner] = np.median(self.scale[self.linear.free])

    def _Linearize(self, state):
        """The residual of the next linear system, whose matrices are assembled."""
        residual = self.gf.vec.CreateVector()
        residual.FV().NumPy()[:] = state.bulk
        for contact in self.contacts:
            contact.form.AssembleStep(self.gf.vec, residual)
        return residual

    def _Measure(self):
        return self.residual.Measure(self.scale, honest=self._motion is not None)

    def _Step(self, state):
        correction = self._Correction(self._Linearize(state), self._Accuracy(state))
        start = self.gf.vec.CreateVector()
        start.data = self.gf.vec

        def move(damping):
            self.gf.vec.data = start
            self.gf.vec.FV().NumPy()[:] -= damping * correction
            return self._Trial(state, damping)

        found = None
        if self._closings and len(self.history) == 1:
            found = self.globalization.SearchStart(move)
        elif self._loose and self._motion is None:
            found = self._Stick(state, move)
        trial, damping = found or self.globalization.Search(move, self._motion is not None)
        if not trial.finite:
            raise ContactConvergenceError(trial.reason + " however short the Newton step")
        self._Moved(state, trial, -correction, damping)
        if self._CloseWhatFloats():
            return self._Measure(), damping
        return trial, damping

    def _Stick(self, state, move):
        """The step up to where another macro-element sticks; None if none comes to rest.

        Where all that holds a body slips nothing tells how far it moves: until a slip turns round.
        If that has been tried, the body moves the other way: its equilibrium may be unstable.
        """
        before = self._Slips()
        if not move(1.0).finite:
            return None
        change = self._Slips() - before
        length = np.sum(change**2, axis=1)
        turns = (state.status == 2) & (length > 0)
        parts = -np.sum(before * change, axis=1)[turns] / length[turns]
        if np.any(parts > 0):
            for part in sorted(parts, key=lambda part: (part < 0, abs(part)))[:MOST_TURNS]:
                trial = move(part * (1 + TURN))
                sticks = trial.finite and np.any(trial.status == 1)
                if sticks and not self.globalization.Knows(trial):
                    return trial, part
        return None

    def _Slips(self):
        """Of the macro-elements of all contacts (n, d)."""
        return np.concatenate([contact.Table()["slip"] for contact in self.contacts])

    def _Trial(self, state, damping):
        """The State after a part of a step from another State."""
        trial = self._Measure()
        if trial.finite and damping > LEAST_SIGHT and trial.LostSight(state):
            return State.Nothing("surfaces pass through each other")
        return trial

    def _Moved(self, before, after, motion, damping):
        """Learn from a part of a motion between two States, which was taken."""
        self.bulk.Learn(before, after, -damping * motion, self.scale, self.residual)
        if self._motion is not None:
            self._motion = (1 - damping) * self._motion
            if np.max(np.abs(self._motion)) <= self._rest:
                self._motion = None

    def _Accuracy(self, state):
        """Relative residual that an iterative solution needs for the next step to be a Newton step.

        Loose while the contact status changes, then such that convergence stays quadratic, or
        enough where nothing but the status was nonlinear.
        """
        rubs = any(contact.holds_tangentially for contact in self.contacts)
        most = FIRM if rubs else LOOSE
        if self.history[-1].changed or not self.history[-1].number:
            return most
        size = max(state.equilibrium, state.constraint)
        enough = 0.03 * self.tol / size
        last = self.bulk.islinear and not self.history[-1].slip
        return min(most, enough if last else max(enough, 0.1 * size))

    def _Correction(self, residual, accuracy=0.0):
        forms = [contact.form for contact in self.contacts]
        given = self.bulk.mat, forms, self.scale

        def solve(residual):
            rows = ~self.residual.rows
            self._loose = False
            if not self._idle:
                found = self.linear.SolveShifted(*given, residual, rows, accuracy)
                singular = self.linear.nearly_singular or self.linear.shifts
                if not (singular and self._AreIdle("now")):
                    self._loose = bool(singular)
                    return found
            return self.linear.Solve(*given, residual, IDLE_SHIFT * rows, accuracy)

        return self._Displace(residual, solve, self._ContactMatrices())

    def _Displace(self, residual, solve, mats):
        """The correction (n,) that belongs to a residual, which is changed.

        Parameters
        ----------
        residual : BaseVector
        solve : callable
            Gives the solution (n,) for a right hand side (n,), without what is condensed.
        mats : list[BaseMatrix]
            What the contacts add to the bulk's matrix.
        """
        bulk = self.bulk
        bulk.Condense(residual)
        if self._motion is not None:
            residual.FV().NumPy()[:] -= Multiply((bulk.mat, *mats), -self._motion)
        correction = self.gf.vec.CreateVector()
        correction.FV().NumPy()[:] = solve(residual.FV().NumPy())
        if self._motion is not None:
            correction.FV().NumPy()[:] -= self._motion
        bulk.Extend(correction, residual)
        return correction.FV().NumPy().copy()

    def _ContactMatrices(self):
        return [contact.form.mat for contact in self.contacts]


def ChooseSolver(a, contacts, freedofs, inverse, wanted, preconditioner=None):
    """The LinearSolver for these forms and free scalar dofs: the one wanted, or the fastest."""
    if preconditioner is not None:
        CheckFunction("preconditioner", preconditioner, "a function (mat, freedofs), or None")
        if wanted not in (None, "iterative"):
            raise ValueError(f"preconditioner= goes with solver='iterative', not {wanted!r}")
        wanted = "iterative"
    if wanted is not None:
        CheckChoice("solver", wanted, ("direct", "iterative", "saddle"))
    space = a.space
    coarse = ScalarDofs(VertexDofs(space), space) & freedofs
    free, vertices = freedofs.NumSet(), coarse.NumSet()
    suits = 0 < vertices < free / 3  # else the coarse problem is nearly the whole one
    if wanted == "iterative" and not suits and not preconditioner:
        raise ValueError(
            f"solver='iterative' corrects on the {vertices} dofs of the vertices, which must be "
            f"less than a third of the {free} free ones: take a displacement of order 2 or higher"
        )
    reason = "as asked for"
    if wanted is None:
        large = free >= LARGE[space.mesh.dim]
        small_sliding = not any(contact.finite for contact in contacts)
        reason = f"{free} free dofs in {space.mesh.dim}D"
        iterates = suits and large and not inverse
        wanted = "iterative" if iterates and small_sliding and not a.condense else "direct"
    given = freedofs, inverse, wanted, space.mesh.dim, coarse, reason, preconditioner
    return LinearSolver(*given)
