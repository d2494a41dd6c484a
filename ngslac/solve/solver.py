# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bulk plus contact in equilibrium: the solver that users call."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence

import numpy as np
from ngsolve import (
    CF,
    BaseMatrix,
    BaseVector,
    BilinearForm,
    BitArray,
    CoefficientFunction,
    GridFunction,
    LinearForm,
    Mesh,
    Region,
)

from ngslac._ngslac import RegionWithFaces
from ngslac.arguments import (
    CheckChoice,
    CheckCount,
    CheckDisplacement,
    CheckFlag,
    CheckFunction,
    CheckParts,
    CheckState,
)
from ngslac.arrays import AsNumPy, ScalarDofs
from ngslac.contact.contact import LACContact
from ngslac.dirichlet import Blame
from ngslac.errors import ContactConvergenceError, LinearSolveError, RefuseCopy
from ngslac.linear.chain import CheckSolver
from ngslac.linear.solver import LinearSolver
from ngslac.linear.system import Options
from ngslac.parallel.layout import LayoutOf
from ngslac.parallel.together import OnAll
from ngslac.petsc.solver import LinearSolverFor
from ngslac.progress import Progress, Say
from ngslac.solve.bulk import Bulk
from ngslac.solve.iteration import Iteration, Log
from ngslac.solve.newton import Newton
from ngslac.solve.problem import (
    CheckBulk,
    CheckContacts,
    CheckFreeDofs,
    CheckInverse,
    CheckMotion,
    CheckSlaves,
    CheckStart,
    CheckTolerance,
)
from ngslac.solve.snapshot import Snapshot
from ngslac.solve.system import System

__all__ = ["ContactSolver", "Equilibrium", "MeshOfSolver"]


def MeshOf(solver: Equilibrium, *_, **__) -> Mesh:
    """The mesh of a solver."""
    return solver.gf.space.mesh


def MeshOfSolver(_: object, solver: object = None, *__, **___) -> Mesh | None:
    """The mesh of the solver that a stepper is made with; None where that is no solver."""
    return solver.gf.space.mesh if isinstance(solver, ContactSolver) else None


def MeshOfSolution(_: object, a: object = None, gf: object = None, *__, **___) -> Mesh | None:
    """The mesh of a solution; None where that is no GridFunction."""
    return gf.space.mesh if isinstance(gf, GridFunction) else None


class Equilibrium:
    """Solves a System; `constrained` (n,) bool are the dofs that its space holds."""

    def __init__(self, system: System, constrained: np.ndarray, initial: str):
        self.system, self.constrained, self.initial = system, constrained, initial
        self.history: list[Iteration] = []
        self.stuck: np.ndarray | None = None
        self._running, self._silent = lambda: None, True

    def __repr__(self) -> str:
        contacts = ", ".join(map(repr, self.contacts))
        return f"<{type(self).__name__}: {contacts}; {self.linear}>"

    @property
    def a(self) -> BilinearForm:
        """The bulk form."""
        return self.system.bulk.a

    @property
    def gf(self) -> GridFunction:
        """The solution, a GridFunction."""
        return self.system.gf

    @property
    def contacts(self) -> list[LACContact]:
        """A list of LACContact."""
        return self.system.contacts

    @property
    def linear(self) -> LinearSolver:
        """How linear systems are solved; ``print(solver.linear)`` says it.

        ``linear.factorisations`` and ``linear.krylov`` count factorisations and iterations.
        """
        return self.system.linear

    @OnAll(MeshOf)
    def Solve(
        self,
        *,
        maxit: int = 100,
        tol: float = 1e-10,
        printing: bool = True,
        callback: Callable[[Iteration], object] | None = None,
        motion: np.ndarray | None = None,
        path: bool = True,
    ) -> Iteration:
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
        if self._running():
            raise ValueError(
                "Solve was called in the middle of Solve, by its callback or in another thread: "
                "call it after that ends"
            )
        self.system.CheckSpace()
        CheckSlaves(self.contacts)
        self.system.PairOnce()
        before = Snapshot(self)
        self.system.Begin(motion, self.constrained)
        if printing and self._silent:
            Say(f"  {self.linear}")
            self._silent = False
        with Progress("contact: Newton's method") as progress:
            log = Log(self.gf, tol, printing, callback, progress)
            newton = Newton(self.system, log, initial=self.initial, path=path)
            return self._Run(newton, maxit, before)

    def _Run(self, newton: Newton, maxit: int, before: Snapshot) -> Iteration:
        """The last line; after any error all is as before, but for what tells of the failure."""
        try:
            # No flag: an interrupt of the last line below would leave it set.
            self._running, self.history = weakref.ref(newton), newton.history
            last = newton.Run(maxit)
            self.system.Tell()
            return last
        except BaseException as error:
            unsolved = isinstance(error, LinearSolveError)
            explained = unsolved or isinstance(error, ContactConvergenceError)
            try:
                floating = self.system.WhatFloats() if unsolved else []
                unheld = self.system.UnheldFields() if explained else ""
            finally:
                before.Restore()
                self.history = newton.history
            if not explained:
                raise
            known = newton.failure.Error(error, floating, self.history)
            if unheld:
                known = ContactConvergenceError(unheld)
            Blame(known, self.contacts[0]._unheld)
            if known is error:
                raise  # with what it came from, such as the error of the other method
            raise known from error
        finally:
            self._running, self.stuck = lambda: None, newton.stuck

    @OnAll(MeshOf)
    def Reaction(
        self, region: Region | str, *, motion: CoefficientFunction | None = None
    ) -> np.ndarray | float:
        """Force of a support on the bodies: the work of the bulk's residual in a motion of it.

        It balances loads and contact forces up to `tol`. The boundary should have no neighbour that
        is held, too: a corner counts for both.

        Parameters
        ----------
        region : str or Region
            Boundary, such as one with Dirichlet conditions.
        motion : (d,) CoefficientFunction, optional
            The part of the force in this motion alone, such as the moment by ``CF((-y, x))``.

        Returns
        -------
        (d,) array, of a scalar field (1,), or float with a motion

        Raises
        ------
        ValueError, TypeError
            `region` has no faces, or `motion` is no displacement.

        Examples
        --------
        >>> solver = ContactSolver(a, gf, contact)
        >>> last = solver.Solve(printing=False)
        >>> abs(solver.Reaction("bottom") - contact.Force()).max().round(9).item()
        0.0
        """
        mesh = self.gf.space.mesh
        region = RegionWithFaces(mesh, "region", region)
        if motion is not None:
            CheckDisplacement("motion", motion, mesh)
        form = self.contacts[0].form
        forces, unit = self.gf.vec.CreateVector(), GridFunction(form.component)
        layout, first = self.system.layout, form.offset * form.fes.dim
        layout.Apply(self.a, self.gf.vec, forces)
        own = slice(first, first + len(unit.vec.FV().NumPy()))
        forces = (layout.Values(forces) - self.system.bulk.load)[own]

        def Work(motion: CoefficientFunction) -> float:
            unit.Set(motion, definedon=region)
            return float(forces @ LayoutOf(unit.space).Values(unit.vec))

        if motion is not None:
            return Work(motion)
        directions = np.eye(self.contacts[0].components)
        return np.array([Work(CF(tuple(direction))) for direction in directions])

    @OnAll(MeshOf)
    def Merit(self, *, same_load: bool = False) -> float | None:
        """Size of the residual at `gf`, infinite without one; None before the first solve.

        Parameters
        ----------
        same_load : bool
            The load is that of the last call: the bulk's part may be a product with its matrix.

        Returns
        -------
        float or None
            Norm of the scaled residual, not divided by the forces: to compare states of one load.
        """
        CheckFlag("same_load", same_load)
        if not self.history:
            return None
        system = self.system
        return system.residual.Measure(system.scale, exact=not same_load).merit

    def State(self) -> dict:
        """What the next solve depends on: solution, contacts, forces at work.

        Returns
        -------
        dict
        """
        return self.system.State() | {"history": self.history}

    @OnAll(MeshOf)
    def SetState(self, state: dict) -> None:
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
        self.system.SetState(state)
        self.history = state["history"]


class ContactSolver(Equilibrium):
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
        NGSolve sparse direct solver. Default, where MKL is installed: Pardiso; else "umfpack". A
        result with a bad residual is recomputed by "umfpack".
    solver : {"interface", "direct", "iterative", "petsc"}, optional
        How linear systems are solved. "interface": the bulk, held by a few springs whose forces are
        unknowns, is factored once by "sparsecholesky" for all systems of the same matrix; each of
        them takes a dense matrix of the closed macro-elements. "direct": LU of the whole system.
        "iterative": GMRES on the displacements that keep the constraints, preconditioned by sweeps
        over vertices with their edges and algebraic multigrid on the vertices: least memory.
        "petsc": by PETSc, which is installed apart (Debian: python3-petsc4py), in one process:
        MUMPS, and from 30,000 free dofs in 3D and 100,000 in 2D on FGMRES with GAMG. Default:
        "interface" in 2D and up to 25,000 free dofs in 3D. Other problems, and systems that it does
        not suit, as those of a nonlinear bulk, whose matrix is another one each time: "iterative"
        from 5,000 free dofs in 3D and 25,000 in 2D on, else "direct"; where the iteration fails,
        the next of the two others. With `inverse` always "direct". ("saddle", an older name of
        "direct", is deprecated.)
    preconditioner : callable, optional
        For "iterative", in place of its own: ``preconditioner(mat, freedofs)`` returns an operator
        of the same size, which approximates the inverse of a sparse matrix on the free dofs. Called
        for each new matrix; the numbers of the scalar dofs are those of the product space, and the
        rows of the multipliers are empty.
    initial : {"gap", "none"}
        Which macro-elements start closed when a body is held by contact alone: those nearest to the
        master, or none (then such a body is an error).

    Attributes
    ----------
    history : list[Iteration]
        Of the last `Solve`.

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

    @OnAll(MeshOfSolution)
    def __init__(
        self,
        a: BilinearForm,
        gf: GridFunction,
        contacts: LACContact | Sequence[LACContact],
        *,
        rhs: LinearForm | BaseVector | Callable[[], LinearForm | BaseVector] | None = None,
        freedofs: BitArray | None = None,
        inverse: str | None = None,
        solver: str | None = None,
        preconditioner: Callable[[BaseMatrix, BitArray], BaseMatrix] | None = None,
        initial: str = "gap",
    ):
        space = CheckBulk(a).space
        contacts = CheckContacts(contacts, space, gf)
        CheckSlaves(contacts)
        CheckStart(gf, space)
        CheckChoice("initial", initial, ("gap", "none"))
        CheckFreeDofs(freedofs, space, contacts)
        CheckInverse(inverse)
        scalars = ScalarDofs(space.FreeDofs(a.condense) if freedofs is None else freedofs, space)
        options = Options(CheckSolver(solver), inverse, preconditioner)
        linear = LinearSolverFor(a, contacts, scalars, options)
        bulk = Bulk(a, gf, rhs)
        free = linear.free | bulk.inner
        constrained = ~(free | AsNumPy(ScalarDofs(space.FreeDofs(), space)))
        super().__init__(System(bulk, contacts, linear, free), constrained, initial)
