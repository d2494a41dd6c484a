# SPDX-License-Identifier: LGPL-2.1-or-later
"""PETSc as solver of the linear systems of a ContactSolver."""

import numpy as np
from ngsolve import BitArray

from ngslac.arrays import AsNumPy, SameEntries
from ngslac.linear.attempts import FirstGood, SolveShifted
from ngslac.petsc.nodes import Nodes
from ngslac.petsc.system import PetscSystem

__all__ = ["Alone", "PetscSolver"]

# From this many unknowns on an iteration needs less time and memory: 2D and 3D.
LARGE = {2: 100_000, 3: 30_000}
# Up to this many factors may take over where the iteration fails: in 3D they need 20 GB by then.
MOST_DIRECT = 1_000_000


class Alone:
    """The team of one process."""

    def __init__(self, system):
        self._system = system

    def Call(self, name, *args):
        """Call a method of the PetscSystem."""
        return getattr(self._system, name)(*args)

    def Get(self, name):
        """An attribute of the PetscSystem on rank 0."""
        return getattr(self._system, name)


class PetscSolver:
    """Solves Newton systems with PETSc, with the interface of a LinearSolver.

    Parameters
    ----------
    team : Alone or what has its methods
        ``Call(name, *args)`` calls a method of the PetscSystem on all ranks, here with these
        arguments, elsewhere with what is to be had there.
    freedofs : BitArray
        Scalar dofs.
    method : {"iterative", "direct"}

    Attributes
    ----------
    method : str
        What solves now.
    shifts : int
        Systems in a row that were singular.
    nearly_singular : bool
        Was the last one?
    """

    tolerance = 1e-9
    most_failures = 2  # of an iteration in a row: it is given up
    wanted = None  # no solver of NGSolve
    shown = "method", "factorisations", "krylov"  # on all processes

    def __init__(self, team, freedofs, method):
        self.team, self.freedofs, self.free = team, BitArray(freedofs), AsNumPy(freedofs)
        self.method, self._failures = method, 0
        self.shifts, self.nearly_singular = 0, False
        self.NewBulk()

    @classmethod
    def Serial(cls, contact, freedofs, inverse=None, preconditioner=None):
        """For this process alone.

        Parameters
        ----------
        contact : LACContact
            The first of those on the space.
        inverse, preconditioner : None
            There is no choice.

        Raises
        ------
        ImportError
            There is no petsc4py.
        """
        if inverse is not None or preconditioner is not None:
            name = "inverse" if inverse is not None else "preconditioner"
            raise ValueError(f"{name}= does not go with solver='petsc': leave it out")
        free, nodes = AsNumPy(freedofs), Nodes.Of(contact, freedofs)
        system = PetscSystem(None, len(free), np.arange(len(free)), free, nodes)
        return cls(Alone(system), freedofs, Method(nodes, free))

    def __str__(self):
        ways = {"iterative": "FGMRES with multigrid", "direct": "factors of MUMPS"}
        return f"linear systems: PETSc, {ways[self.method]}"

    @property
    def factorisations(self):
        """Of matrices of full size, so far."""
        return self.team.Get("factorisations")

    @property
    def krylov(self):
        """Krylov iterations so far."""
        return self.team.Get("krylov")

    def State(self):
        """What has been learnt about the methods, as a dict."""
        return {
            "inverse": None,
            "methods": [self.method],
            "failures": self._failures,
            "once": False,
        }

    def SetState(self, state):
        """Go on with the methods of a `State`, also that of a LinearSolver."""
        if self.method in state["methods"]:
            self._failures = state["failures"]
        elif state["methods"] == ["direct"]:
            self.method = "direct"

    def Forget(self):
        """Keep nothing for the next system."""
        self.team.Call("Forget")
        self.NewBulk()

    def NewBulk(self):
        """The bulk matrix has got other values."""
        self._bulk = self._given = None

    @property
    def used(self):
        """Has it solved anything since then?"""
        return self._bulk is not None

    def Solve(self, bulk, forms, scale, rhs, shift=None, accuracy=0.0):
        """See LinearSolver."""
        self._Take(bulk, forms, scale, shift)
        self.nearly_singular = True
        b = scale * rhs * self.free
        attempts = self._Attempts(b, accuracy)
        x, name = FirstGood(attempts, self.tolerance, accuracy)
        if name is not None:
            self.nearly_singular = False
            self._LearnFrom(name)
        return scale * x

    def SolveShifted(self, bulk, forms, scale, rhs, rows, accuracy=0.0, pins=None):
        """See LinearSolver."""
        return SolveShifted(self, (bulk, forms, scale, rhs), rows, accuracy, pins)

    def _Take(self, bulk, forms, scale, shift):
        """Set what is not the same as for the last system."""
        if self._bulk is not bulk:
            self.team.Call("SetBulk", bulk)
            self._bulk, self._given = bulk, None
        mats = [form.mat for form in forms]
        given = [[np.array(part) for part in mat.CSR()] for mat in mats]
        given.append([np.array(scale), np.zeros(0) if shift is None else np.array(shift)])
        if self._given is None or not SameEntries(given, self._given):
            self._given = None
            multipliers = np.concatenate([form.MultiplierDofs() for form in forms])
            self.team.Call("SetContacts", mats, multipliers, scale, shift)
            self._given = given

    def _Attempts(self, b, accuracy):
        names = ["iterative"] if self.method == "iterative" else []
        if not names or self.free.sum() <= MOST_DIRECT:
            names.append("direct")
        for name in names:
            yield name, lambda name=name: self.team.Call("Solve", b, accuracy, name)

    def _LearnFrom(self, name):
        if self.method == "iterative":
            self._failures = self._failures + 1 if name == "direct" else 0
            if self._failures == self.most_failures:
                self.method = "direct"


def Method(nodes, free):
    """The way to solve systems of these Nodes and free dofs."""
    suits = np.any(nodes.vertices)
    return "iterative" if suits and free.sum() >= LARGE[nodes.blocks.shape[1]] else "direct"
