# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checked solution of the merged and scaled linear systems."""

import numpy as np
from ngsolve import BitArray

from ngslac.arrays import AddToDiagonal, AsNumPy
from ngslac.linear.attempts import FirstGood, SolveShifted
from ngslac.linear.direct import DirectCondensed
from ngslac.linear.factor import LU, Cholesky, Factor, LinearSolveError, OneBLASThread
from ngslac.linear.interface import Interface
from ngslac.linear.iterative import IterativeCondensed
from ngslac.linear.merged import Merged

__all__ = ["LinearSolveError", "LinearSolver"]

SAFE = "umfpack"


class LinearSolver:
    """Solves Newton systems and looks at the residual of what it returns.

    Some factorisations return NaN on saddle point matrices, others lose ten digits, without saying
    so. Whatever the method, the residual of the whole system must be small, or the next method
    takes over: interface, iterative, condensed and direct, LU of the saddle point matrix, the same
    with the safe solver.

    Parameters
    ----------
    freedofs : BitArray
    inverse : str or None
        Name of an NGSolve solver; None: the fastest of those installed.
    method : {"saddle", "direct", "iterative"}
    dim : int
        Of the mesh.
    multigrid : Multigrid
        For "iterative".
    reason : str
        Why this method, for people.
    preconditioner : callable, optional
        For "iterative", see ContactSolver.
    motions : callable, optional
        Gives the rigid motions (n, m) of the scalar dofs, for "interface": None, if that is no way.
    first : bool
        Does "interface" come before `method`, or just before "direct"?
    inner : InnerDofs, optional
        Free dofs that are eliminated beforehand.

    Attributes
    ----------
    method : str
        What solves now.
    factorisations, krylov : int
        Of matrices of full size, and Krylov iterations, so far.
    """

    tolerance = 1e-9
    refinements = 3
    most_failures = 2  # of an iteration in a row where another method serves: it is given up

    def __init__(
        self,
        freedofs,
        inverse=None,
        method="saddle",
        dim=3,
        multigrid=None,
        reason="",
        preconditioner=None,
        motions=None,
        first=True,
        inner=None,
    ):
        self.freedofs, self.free, self.inner = BitArray(freedofs), AsNumPy(freedofs), inner
        self.inverse = LU(inverse)
        self.shifts = self._factorisations = self._iterations = self._failures = 0
        self.nearly_singular, self._merged = False, Merged()
        self._given = method, dim, inverse, multigrid, preconditioner, motions, first
        self._MakeMethods()
        self.NewBulk()
        self.wanted, self._reason, self._preconditioner = inverse, reason, preconditioner

    def _MakeMethods(self):
        """Those for the free dofs that are not eliminated."""
        method, dim, inverse, multigrid, preconditioner, motions, first = self._given
        self.bits = self.freedofs & ~self.inner.dofs if self.inner else self.freedofs
        solved = AsNumPy(self.bits)
        direct = DirectCondensed(solved, self.bits, dim, inverse)
        self._methods = [("direct", direct)] if method != "saddle" else []
        if method == "iterative":
            given = solved, self.bits, dim, inverse, multigrid, preconditioner
            self._methods.insert(0, ("iterative", IterativeCondensed(*given)))
        if motions:
            place = 0 if first else len(self._methods) - 1
            self._methods.insert(place, ("interface", Interface(solved, dim, motions)))
        self._used = list(self._methods)

    @property
    def method(self):
        """What solves now: "interface", "iterative", "direct" or "saddle"."""
        return self._methods[0][0] if self._methods else "saddle"

    def __str__(self):
        factor = f"{Cholesky(self.wanted)}, or {LU(self.wanted)} where unsymmetric"
        ways = {
            "iterative": "iterative, " + ("as given" if self._preconditioner else "multigrid"),
            "interface": "on the interface, the bulk with sparsecholesky, once",
            "direct": f"condensed, with {factor}",
            "saddle": f"saddle point, with {self.inverse}",
        }
        return f"linear systems: {ways[self.method]} ({self._reason})"

    @property
    def factorisations(self):
        """Of matrices of full size, so far."""
        return self._factorisations + sum(m.factorisations for _, m in self._used)

    @property
    def krylov(self):
        """Krylov iterations so far."""
        return self._iterations + sum(m.krylov for _, m in self._used)

    def State(self):
        """What has been learnt about the methods, as a dict."""
        names = [name for name, _ in self._methods]
        state = {"inverse": self.inverse, "methods": names, "failures": self._failures}
        return state | {"once": any(method.once for method in self._Interfaces())}

    def SetState(self, state):
        """Go on with the methods of a `State`."""
        self.inverse, self._failures = state["inverse"], state["failures"]
        self._methods = [method for method in self._used if method[0] in state["methods"]]
        for method in self._Interfaces():
            method.once = state["once"]

    def _Interfaces(self):
        return [method for name, method in self._used if name == "interface"]

    def Forget(self):
        """Keep nothing for the next system."""
        for _, method in self._methods:
            method.Forget()

    @OneBLASThread()
    def Solve(self, bulk, forms, scale, rhs, shift=None, accuracy=0.0):
        """x with (bulk + forms) x = rhs on the free dofs, 0 elsewhere; numpy arrays.

        `shift` (n,) is added to the diagonal of the scaled matrix, in which the bulk's is 1. An
        iterative method stops at the relative residual `accuracy`.
        """
        elimination = self._Elimination(bulk)
        if elimination is None:
            return self._Solve(bulk, forms, scale, rhs, shift, accuracy)
        reduced = elimination.Reduce(rhs)
        solution = self._Solve(elimination.mat, forms, scale, reduced, shift, accuracy)
        return elimination.Expand(rhs, solution)

    def _Elimination(self, bulk):
        """That of inner dofs; None, and no more of it, where the matrix of some is singular."""
        try:
            return self.inner and self.inner.Eliminate(bulk)
        except LinearSolveError:
            state, self.inner = self.State(), None
            self._factorisations, self._iterations = self.factorisations, self.krylov
            self._MakeMethods()
            self.SetState(state)
            self.NewBulk()

    def _Solve(self, bulk, forms, scale, rhs, shift, accuracy):
        self.nearly_singular = True
        b = scale * rhs * self.free
        attempts = self._Attempts((bulk, forms, scale, shift), b, accuracy)
        x, name = FirstGood(attempts, self.tolerance, accuracy)
        if name is not None:
            self.nearly_singular = False
            if name == SAFE:
                self.inverse = SAFE
            self._LearnFrom(name)
        return scale * x

    def _LearnFrom(self, name):
        """A method has served: an iteration that comes before it has not."""
        names = [other for other, _ in self._methods]
        if "iterative" in names:
            after = name not in names or names.index(name) > names.index("iterative")
            self._failures = self._failures + 1 if after else 0
            if self._failures == self.most_failures:
                del self._methods[names.index("iterative")]

    def NewBulk(self):
        """The bulk matrix that was used last has got other values."""
        self._merged.Forget()
        if self.inner:
            self.inner.Forget()
        for _, method in self._used:
            method.NewBulk()

    def _Merge(self, bulk, forms, scale, shift):
        """The scaled matrix; that of the last call, changed, where the bulk is the same."""
        merged = self._merged
        new, mat = merged.Update(bulk, self._Matrices(forms), scale), merged.mat
        if new or shift is not None:
            for _, method in self._used:
                method.NewMatrix()
        if shift is not None:
            merged.Forget()
            AddToDiagonal(mat, shift)
        return mat

    def _Matrices(self, forms):
        return [form.mat for form in forms]

    def _Attempts(self, system, b, accuracy):
        """Names and functions that return a solution and its relative residual."""
        mat = None
        for name, method in list(self._methods):
            if name == "interface":
                if method.Begin():
                    yield name, lambda method=method: method.Solve(*system, b)
                continue
            mat = mat or self._Merge(*system)
            dofs = np.concatenate([form.MultiplierDofs() for form in system[1]])
            args = mat, dofs, b, accuracy
            method.scale = system[2]
            yield name, lambda method=method, args=args: method.Solve(*args)
        mat = mat or self._Merge(*system)
        for inverse in dict.fromkeys((self.inverse, SAFE)):
            yield inverse, lambda inverse=inverse: self._Refined(mat, b, inverse)

    def SolveShifted(self, bulk, forms, scale, rhs, rows, accuracy=0.0, pins=None):
        """The same; a singular matrix gets a small diagonal on `rows` (n,) bool."""
        return SolveShifted(self, (bulk, forms, scale, rhs), rows, accuracy, pins)

    def _Factor(self, mat, inverse):
        self._factorisations += 1
        return Factor(mat, self.bits, inverse)

    def _Refined(self, mat, right, inverse):
        """Solution by a factorisation of the whole matrix, and its relative residual."""
        size = np.linalg.norm(right)
        x, r, step = mat.CreateRowVector(), mat.CreateColVector(), mat.CreateRowVector()
        b = mat.CreateColVector()
        b.FV().NumPy()[:] = right
        x[:] = 0
        if size == 0:
            return right, 0.0
        inv = self._Factor(mat, inverse)
        error = np.inf
        for _ in range(self.refinements):
            r.data = b - mat * x
            step.data = inv * r  # not in place: Pardiso would return zero
            x.data += step
            r.data = b - mat * x
            before, error = error, np.linalg.norm(r.FV().NumPy() * self.free) / size
            if not np.isfinite(error):
                return right, np.inf
            if error > before:  # no better: keep the solution before
                x.data -= step
                error = before
                break
            if error < 1e-14 or error > 0.5 * before:
                break
        return x.FV().NumPy(), error
