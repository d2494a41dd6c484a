# SPDX-License-Identifier: LGPL-2.1-or-later
"""Meshes that are refined where an estimate of the error is large."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import H1, L2, FESpace, GridFunction, Mesh, VectorH1

from ngslac.analysis.balance import CheckSimplices, FaceElements
from ngslac.analysis.estimate import ErrorEstimate
from ngslac.analysis.goal import GoalError
from ngslac.analysis.tangent import Static
from ngslac.arguments import (
    CheckCount,
    CheckFlag,
    CheckFunction,
    CheckInstance,
    CheckNumber,
    CheckPositive,
    Wrong,
)
from ngslac.errors import RefuseCopy, Warn
from ngslac.solve.solver import ContactSolver, Equilibrium

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ngslac.contact.contact import LACContact

__all__ = ["Adapt", "AdaptStep", "Doerfler"]

REMEMBERED = "law: "  # prefix of the names under which a history holds the memory of laws


@dataclass(frozen=True)
class AdaptStep:
    """One mesh of an adaptive solution.

    Attributes
    ----------
    number, dofs, elements : int
        Number of the mesh, dofs of the product space, volume elements.
    total, relative : float
        The estimate, and relative to the norm of the solution or to the goal.
    iterations : int
        Of the solver.
    """

    number: int
    dofs: int
    elements: int
    total: float
    relative: float
    iterations: int

    def __str__(self) -> str:
        return (
            f"mesh {self.number}  {self.dofs} dofs, {self.elements} elements  "
            f"error {100 * self.relative:.3g} %  {self.iterations} iterations"
        )


def Doerfler(squares: np.ndarray, theta: float) -> np.ndarray:
    """The fewest elements (ne,) bool that have the part `theta` of a sum of squares (ne,)."""
    order = np.argsort(-squares, kind="stable")
    sums = np.cumsum(squares[order])
    marked = np.zeros(len(squares), bool)
    if len(sums) and sums[-1] > 0:
        marked[order[: np.searchsorted(sums, theta * sums[-1] * (1 - 1e-12)) + 1]] = True
    return marked


class Adapt:
    """Solve, estimate, mark, refine: until the error is small enough.

    It works on a copy of the mesh. Each mesh gets a problem of its own by `problem`, and starts
    from the solution on the last mesh. Contact is paired anew, and its committed state is carried
    over: slip counts from the same displacement, and the memory of laws is averaged over the old
    macro-elements by the overlap of areas. New points lie on the geometry of the mesh.

    Parameters
    ----------
    problem : callable
        ``problem(mesh)`` makes spaces, forms and contacts on a mesh and returns the solver.
    mesh : ngsolve.Mesh
        The first mesh, of triangles or tetrahedra. It is not changed.
    estimate : callable
        ``estimate(solver)`` returns an `ErrorEstimate`, such as
        ``lambda solver: ResidualEstimate(solver, stress)``.
    tol : float
        Relative estimate that is small enough.
    maxdofs : int
        No mesh is refined that has as many dofs.
    maxmeshes : int
        Most meshes of a `Solve`.
    marking : float
        Part of the squared estimate that the marked elements have together (Dörfler), above 0 and
        up to 1; with 1 all elements that have any.

    Attributes
    ----------
    solver : ContactSolver
        Of the present mesh.
    mesh : ngsolve.Mesh
        The present mesh.
    estimate : ErrorEstimate or None
        The last one.
    steps : list of AdaptStep

    Raises
    ------
    TypeError, ValueError
        An argument that does not fit; `problem` returns no solver, or one of another mesh; a mesh
        of other elements.

    Examples
    --------
    >>> from ngslac.analysis import Adapt, ResidualEstimate
    >>> down = CF((0, -0.01 * x))
    >>> def Problem(mesh):
    ...     V = VectorH1(mesh, order=2, dirichlet="bottom", dirichletx="top")
    ...     fes = V * LACSpace(V, slave="slave")
    ...     (u, lam), (v, _) = fes.TnT()
    ...     a = BilinearForm(InnerProduct(Sym(Grad(u)), Grad(v)) * dx - down * v * ds("top"))
    ...     return ContactSolver(a, GridFunction(fes), LACContact(u, lam, master="master"))
    >>> def Estimate(solver):
    ...     return ResidualEstimate(solver, lambda H: Sym(H), tractions={"top": down})
    >>> adapt = Adapt(Problem, mesh, Estimate, tol=0.05)
    >>> adapt.Solve(printing=False)[-1].relative < 0.05
    True
    >>> adapt.mesh.ne > mesh.ne
    True
    """

    __deepcopy__ = __reduce_ex__ = RefuseCopy

    def __init__(
        self,
        problem: Callable[[Mesh], ContactSolver],
        mesh: Mesh,
        estimate: Callable[[ContactSolver], ErrorEstimate | GoalError],
        *,
        tol: float,
        maxdofs: int = 100_000,
        maxmeshes: int = 30,
        marking: float = 0.5,
    ):
        for name, function in {"problem": problem, "estimate": estimate}.items():
            wanted = "a function"
            if function is None:
                raise Wrong(TypeError, name, function, wanted)
            CheckFunction(name, function, wanted)
        CheckInstance("mesh", mesh, Mesh, "an ngsolve.Mesh")
        self.tol = CheckPositive("tol", tol)
        self.maxdofs = CheckCount("maxdofs", maxdofs)
        self.maxmeshes = CheckCount("maxmeshes", maxmeshes)
        inside = "a number above 0, up to 1"
        self.marking = CheckNumber("marking", marking, inside, lambda part: 0 < part <= 1)
        CheckSimplices(mesh)
        self._problem, self._estimate = problem, estimate
        self._order = mesh.GetCurveOrder()
        self.mesh = Mesh(mesh.ngmesh.Copy())
        if self._order > 1:
            self.mesh.Curve(self._order)
        self.solver, self.steps = self._Made(), []
        self.estimate: Any = None  # before the first mesh is solved
        self._carried = {}

    def __repr__(self) -> str:
        return f"<Adapt: {self.mesh.ne} elements, {len(self.steps)} solved; {self.solver!r}>"

    def _Made(self) -> ContactSolver:
        solver = self._problem(self.mesh)
        CheckInstance("problem(mesh)", solver, Equilibrium, "a solver, such as ContactSolver")
        if solver.gf.space.mesh != self.mesh:
            raise ValueError("problem(mesh) returned a solver on another mesh: use its argument")
        return solver

    def Solve(
        self,
        *,
        printing: bool = True,
        callback: Callable[[AdaptStep], object] | None = None,
        **options,
    ) -> list[AdaptStep]:
        """Solve and refine until the estimate is below `tol`; call it again after a change of load.

        Each further call makes the problem anew, with the values that it prescribes then.

        Parameters
        ----------
        printing : bool
            A line for each mesh.
        callback : callable, optional
            Called with each `AdaptStep`.
        **options
            Of `ContactSolver.Solve`.

        Returns
        -------
        list of AdaptStep
            Those of this call. A warning says where `tol` was not reached.

        Raises
        ------
        TypeError, ValueError, ContactConvergenceError
            As of `ContactSolver.Solve`; the mesh is the one that could not be solved on.
        """
        CheckFlag("printing", printing)
        CheckFunction("callback", callback)
        begin = len(self.steps)
        self._CheckMade()
        if begin:  # the prescribed values may have changed
            self._MakeAnew()
        while True:
            last = self.solver.Solve(printing=False, **options)
            found = self._estimate(self.solver)
            kinds = ErrorEstimate, GoalError
            CheckInstance("estimate(solver)", found, kinds, "an ErrorEstimate or GoalError")
            self.estimate = found
            dofs, count = self.solver.gf.space.ndof, len(self.steps) + 1
            numbers = found.total, found.relative, last.number
            self.steps.append(AdaptStep(count, dofs, self.mesh.ne, *numbers))
            if printing:
                print(self.steps[-1])
            if callback is not None:
                callback(self.steps[-1])
            done = self.steps[begin:]
            if found.relative <= self.tol:
                return done
            if dofs >= self.maxdofs or len(done) >= self.maxmeshes:
                Warn(
                    f"the estimate is {found.relative:.3g}, above tol = {self.tol:g}, with {dofs} "
                    f"dofs on {len(done)} meshes: raise maxdofs or maxmeshes to go on"
                )
                return done
            self.Refine(Doerfler(found.squares, self.marking))

    def _CheckMade(self) -> None:
        """Raise where the last refinement has left no solver."""
        if self.solver is None:
            raise ValueError(
                "problem(mesh) failed on the present mesh, and what was solved before is lost: "
                "make another Adapt"
            )

    def _MakeAnew(self, marked: np.ndarray | None = None) -> None:
        """Make the problem anew; before that refine the marked elements (ne,) bool."""
        carried = Carried(self.solver, self._carried)
        if marked is not None:
            self.solver = None  # it loses its mesh
            self.mesh.SetRefinementFlags(marked.tolist())
            self.mesh.Refine()
            if self._order > 1:
                self.mesh.Curve(self._order)
        self.solver = self._Made()
        carried.Put(self.solver)

    def Commit(self) -> None:
        """Accept the solution as the end of a load step: slip and laws go on from there."""
        self._CheckMade()
        for contact in self.solver.contacts:
            contact.Commit(self.solver.gf)

    def Refine(self, marked: np.ndarray) -> None:
        """Refine elements, and those that have to follow, and make the problem anew.

        Parameters
        ----------
        marked : (ne,) array of bool

        Raises
        ------
        ValueError
            It has another shape, no bool, or is all False. After an error of `problem` on the
            refined mesh make another Adapt: the last solver has lost its mesh.
        """
        self._CheckMade()
        marked = np.asarray(marked)
        if marked.dtype != bool or marked.shape != (self.mesh.ne,):
            raise ValueError(f"marked must be an array of bool with {self.mesh.ne} entries")
        if not marked.any():
            raise ValueError("marked has no element: there is nothing to refine")
        self._MakeAnew(marked)


class Carried:
    """A solution and the history of its contacts, on a mesh that is about to be refined.

    `functions` are kept from mesh to mesh: NGSolve prolongates those made before its refinement.
    """

    def __init__(self, solver: ContactSolver, functions: dict[str, GridFunction]):
        static = Static(solver)
        self.mesh, self.functions, self.contacts = static.gf.space.mesh, functions, static.contacts
        self.now = self._Noted("now", static.gf.vec.FV().NumPy(), static.gf.space)
        self.past = [
            None if c._accepted is None else self._Noted(f"past {k}", c._accepted, static.gf.space)
            for k, c in enumerate(self.contacts)
        ]
        self.macros = [self._Macros(f"macros {k}", c) for k, c in enumerate(self.contacts)]
        self.kept = [Kept(contact) for contact in self.contacts]

    def _Noted(
        self, name: str, entries: np.ndarray, space: FESpace
    ) -> tuple[dict[int, GridFunction], list[np.ndarray]]:
        """Functions for all components but multipliers, and the multipliers (n, d) of contacts."""
        whole, functions = GridFunction(space), {}
        whole.vec.FV().NumPy()[:] = entries
        for k, part in enumerate(whole.components):
            if part.space.type != "lacspace":
                functions[k] = self._Function(f"{name}, {k}", part)
                functions[k].Set(part)
        dofs = [c.form.MultiplierDofs().reshape(c.space.nmacros, -1) for c in self.contacts]
        return functions, [entries[numbers] for numbers in dofs]

    def _Function(self, name: str, part: GridFunction) -> GridFunction:
        """The function of a name that follows the mesh, made when first asked for."""
        if name not in self.functions:
            space, order = part.space, max(1, part.space.globalorder)
            kind, flags = H1, {"dim": space.TrialFunction().dim}
            if flags["dim"] == self.mesh.dim:
                kind, flags = VectorH1, {}
            space = kind(self.mesh, order=order, autoupdate=True, hoprolongation=True, **flags)
            self.functions[name] = GridFunction(space, autoupdate=True, nested=True)
        return self.functions[name]

    def _Macros(self, name: str, contact: LACContact) -> GridFunction:
        """The macro-element of the slave face of each element, which its parts inherit."""
        if name not in self.functions:
            space = L2(self.mesh, order=0, autoupdate=True)
            self.functions[name] = GridFunction(space, autoupdate=True, nested=True)
        numbers, element, _ = SlaveElements(contact)
        values = self.functions[name].vec.FV().NumPy()
        values[:] = -1
        values[element] = numbers
        return self.functions[name]

    def Put(self, solver: ContactSolver) -> None:
        """Set all in the solver of the refined mesh."""
        static = Static(solver)
        gf, held, contacts = static.gf, static.constrained, static.contacts
        if len(contacts) != len(self.contacts):
            raise ValueError("problem(mesh) returned a solver with another number of contacts")
        static.system.PairOnce()
        shares = [
            Shares(contact, macros, len(lam))
            for contact, macros, lam in zip(contacts, self.macros, self.now[1], strict=True)
        ]
        for k, contact in enumerate(contacts):
            if self.past[k] is not None:
                past = GridFunction(gf.space)
                Fill(past, self.past[k], contacts, shares)
                contact.Commit(past)
            if self.kept[k]:
                history = contact.form.History()
                contact.form.SetHistory(history | Averaged(self.kept[k], shares[k]))
        values = gf.vec.FV().NumPy()
        prescribed = values[held]
        Fill(gf, self.now, contacts, shares)
        values[held] = prescribed


def Fill(
    gf: GridFunction,
    noted: tuple[dict[int, GridFunction], list[np.ndarray]],
    contacts: Sequence[LACContact],
    shares: list[csr_matrix],
) -> None:
    """Set the components of a solution, and its multipliers by areas."""
    functions, multipliers = noted
    for k, function in functions.items():
        gf.components[k].Set(function)
    values = gf.vec.FV().NumPy()
    for contact, share, lam in zip(contacts, shares, multipliers, strict=True):
        values[contact.form.MultiplierDofs()] = (share @ lam).ravel()


def Kept(contact: LACContact) -> dict[str, np.ndarray]:
    """The memory of laws after the last committed step, (n, k) by name."""
    history = contact.form.History() if contact.form.paired else {}
    kept = {name: values for name, values in history.items() if name.startswith(REMEMBERED)}
    return {name: np.reshape(v, (contact.space.nmacros, -1)) for name, v in kept.items()}


def Averaged(kept: dict[str, np.ndarray], share: csr_matrix) -> dict[str, np.ndarray]:
    """The same for the new macro-elements, averaged by their areas in the former ones."""
    return {name: (share @ values).ravel() for name, values in kept.items()}


def Shares(contact: LACContact, macros: GridFunction, count: int) -> csr_matrix:
    """Part (n, count) of the area of each macro-element that each of the mesh before had."""
    numbers, element, area = SlaveElements(contact)
    old = np.rint(macros.vec.FV().NumPy()[element]).astype(int)
    known = old >= 0
    shape = contact.space.nmacros, count
    entries = area[known], (numbers[known], old[known])
    whole = np.bincount(numbers[known], area[known], contact.space.nmacros)
    part = 1 / np.where(whole > 0, whole, 1)
    return scipy.sparse.diags(part) @ scipy.sparse.csr_matrix(entries, shape=shape)


def SlaveElements(contact: LACContact) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Macro-element, volume element and area of each slave face."""
    faces, elements, area = FaceElements(contact.space.slave)
    return np.array(contact.space.macros)[faces], elements, area
