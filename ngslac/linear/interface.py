# SPDX-License-Identifier: LGPL-2.1-or-later
"""Newton systems on the interface: the bulk is factored once for all of them."""

import numpy as np

from ngslac.linear.blocks import Blocks
from ngslac.linear.factor import LinearSolveError
from ngslac.linear.grounded import GroundedBulk
from ngslac.linear.interfacesystem import InterfaceSystem
from ngslac.linear.refine import Refine

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

    most = 3000  # multipliers: the dense matrix of more costs as much as factors of the bulk
    krylov = 0

    def __init__(self, free, dim, motions):
        self.free, self.dim, self.motions = free, dim, motions
        self.factorisations = self._systems = 0
        self.once = False
        self.NewBulk()

    def __str__(self):
        return "on the interface, the bulk with sparsecholesky, once"

    def NewBulk(self):
        """The bulk matrix has got other values."""
        self.once = self._systems == 1 or (self.once and not self._systems)
        self._systems, self._fails, self._kept = 0, False, {}

    def State(self):
        """What has been learnt about the bulk."""
        return {"once": self.once}

    def SetState(self, state):
        """Go on with a `State`."""
        self.once = state["once"]

    def Solve(self, system, b):
        """See Method.

        Not for the first system of a matrix if that before served once only: a nonlinear bulk has
        another one each time.

        Raises
        ------
        LinearSolveError
            The matrix is singular, or not of the kind that this is made for.
        """
        self._systems += 1
        if self._fails or (self.once and self._systems == 1):
            raise LinearSolveError("the bulk is not factored")
        blocks = Blocks(system, self.free)
        try:
            kept = self._Kept(system, blocks)
            interface = InterfaceSystem(kept, blocks, self.dim)
        except np.linalg.LinAlgError as error:
            raise LinearSolveError(str(error)) from error
        return Refine(interface.Solve, lambda x: b - blocks.Times(x) - kept.Times(x), b)

    def _Kept(self, system, blocks):
        """The GroundedBulk; where bodies slip, systems with and without a shift take turns."""
        displacements = self.free.copy()
        displacements[blocks.multipliers] = False
        key = system.shift is not None
        if key not in self._kept or not self._kept[key].Fits(system, displacements):
            self._kept.pop(key, None)  # two of them would need twice the memory
            self._fails = True
            if len(blocks.multipliers) > self.most:
                raise LinearSolveError("the interface is large")
            self.factorisations += 1
            kept = GroundedBulk(system, displacements, self.motions())
            kept.Schur(blocks.forces)
            self._kept[key], self._fails = kept, False
        return self._kept[key]
