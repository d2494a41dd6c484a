# SPDX-License-Identifier: LGPL-2.1-or-later
"""Newton systems on the interface: the bulk is factored once for all of them."""

import numpy as np

from ngslac.linear.blocks import Blocks
from ngslac.linear.factor import LinearSolveError
from ngslac.linear.grounded import GroundedBulk
from ngslac.linear.interfacesystem import InterfaceSystem

__all__ = ["Interface"]


class Interface:
    """Solves for multipliers first, by the Schur complement of the bulk, then for displacements.

    The bulk K, with springs alpha P P^T on some dofs (`GroundedBulk`), is factored once. With the
    columns C = [G, P] and C^T K^-1 C, which are computed once, too, a system

        u = K^-1 (f - C x),  E u + F lam = g,  x = (lam, -alpha P^T u)

    takes a dense matrix of the closed macro-elements, and a forward and a backward substitution.

    Parameters
    ----------
    free : (n,) bool
        Scalar dofs of the whole system.
    dim : int
        Of the mesh.
    motions : callable
        Gives the rigid motions (n, m), see `Grounded`.

    Attributes
    ----------
    factorisations : int
        Of matrices of full size since this was made.
    once : bool
        Did the last matrix of the bulk serve for one system only?
    """

    rounds = 4
    exact = 1e-13  # relative residual that is enough
    most = 3000  # multipliers: the dense matrix of more costs as much as factors of the bulk
    krylov = 0

    def __init__(self, free, dim, motions):
        self.free, self.dim, self.motions = free, dim, motions
        self.factorisations = self._systems = 0
        self.once = False
        self.Forget()

    def Forget(self):
        """Keep no factorisation for the next system."""
        self.once = self._systems == 1 or (self.once and not self._systems)
        self._systems, self._fails, self._kept = 0, False, {}

    def NewBulk(self):
        """The bulk matrix has got other values."""
        self.Forget()

    def NewMatrix(self):
        """The merged matrix has got other values."""

    def Begin(self):
        """Another system; says whether this is the way to solve it.

        Not so for the first one of a matrix if that before served once only: a nonlinear bulk has
        another one each time.
        """
        self._systems += 1
        return not self._fails and not (self.once and self._systems == 1)

    def Solve(self, bulk, forms, scale, shift, b):
        """x with (bulk + forms) x = b on the free dofs, scaled, and its relative residual.

        Raises
        ------
        LinearSolveError
            The matrix is singular, or not of the kind that this is made for.
        """
        blocks = Blocks(forms, scale, self.free)
        try:
            kept = self._Kept(bulk, scale, shift, blocks)
            system = InterfaceSystem(kept, blocks, self.dim)
        except np.linalg.LinAlgError as error:
            raise LinearSolveError(str(error)) from error
        return self._Refined(kept, blocks, system, b)

    def _Kept(self, bulk, scale, shift, blocks):
        """The GroundedBulk; where bodies slip, systems with and without a shift take turns."""
        displacements = self.free.copy()
        displacements[blocks.multipliers] = False
        given, key = (bulk, scale, shift, displacements), shift is not None
        if key not in self._kept or not self._kept[key].Fits(*given):
            self._kept.pop(key, None)  # two of them would need twice the memory
            self._fails = True
            if len(blocks.multipliers) > self.most:
                raise LinearSolveError("the interface is large")
            self.factorisations += 1
            kept = GroundedBulk(*given, self.motions())
            kept.Schur(blocks.forces)
            self._kept[key], self._fails = kept, False
        return self._kept[key]

    def _Refined(self, kept, blocks, system, b):
        x, size, error = np.zeros_like(b), np.linalg.norm(b), 1.0
        best, left = (x, error), b
        for _ in range(self.rounds if size else 0):
            x = x + system.Solve(left)
            left = b - blocks.Times(x) - kept.Times(x)
            before, error = error, float(np.linalg.norm(left)) / size
            if error < best[1]:  # not so where it is NaN
                best = x, error
            if not self.exact < error < 0.5 * before:
                break
        return best if size else (x, 0.0)
