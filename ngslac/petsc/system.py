# SPDX-License-Identifier: LGPL-2.1-or-later
"""Newton systems of contact, distributed, as matrices of PETSc."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import BaseMatrix, CreateVVector

from ngslac._ngslac import GMRes, PreconditionedProduct
from ngslac.arrays import AsBits, ToCSR
from ngslac.errors import LinearSolveError
from ngslac.linear.refine import EXACT, Refine
from ngslac.petsc.condensation import CondensedSystem, Contacts, LocalContact
from ngslac.petsc.direct import PetscDirect
from ngslac.petsc.library import Checked, LoadPETSc
from ngslac.petsc.multigrid import PetscMultigrid
from ngslac.petsc.numbering import Numbering

if TYPE_CHECKING:
    from petsc4py import PETSc
    from scipy.sparse import csr_matrix

    from ngslac.parallel.form import WholeTrace
    from ngslac.parallel.layout import Layout, Whole
    from ngslac.parallel.skin import Trace
    from ngslac.petsc.nodes import Nodes

__all__ = ["PetscSystem"]


class PetscSystem:
    """Bulk matrices of all processes and the contacts of the first one as one system; collective.

    What contacts add is known on their surfaces, of which there is a Trace for each.
    """

    def __init__(
        self,
        layout: Layout | Whole,
        traces: Sequence[Trace | WholeTrace],
        free: np.ndarray,
        nodes: Nodes,
    ):
        self.numbering = Numbering(layout, traces, nodes, free)
        self.free, self._surfaces = self.numbering.free, self.numbering.surfaces
        self._nodes, self._bulk, self._scale, self._multigrid = nodes, None, None, None
        self._direct, self.krylov = PetscDirect(self.numbering), 0
        self.Forget()

    @property
    def factorisations(self) -> int:
        """Of matrices of full size, so far."""
        return self._direct.factorisations

    def SetBulk(self, mat: BaseMatrix) -> None:
        """Take this process's part of the bulk's matrix; entries of the same dofs are added."""
        self.Forget()
        self._bulk = self._scale = None
        part = ToCSR(self.numbering.layout.Local(mat))
        part.data *= np.repeat(self.free, np.diff(part.indptr))  # without another copy
        part.data *= self.free[part.indices]
        self._bulk = Assembled(self.numbering, part, self.numbering.rows)

    def SetContacts(
        self,
        mats: Sequence[BaseMatrix],
        multipliers: np.ndarray,
        scale: np.ndarray,
        shift: np.ndarray | None,
    ) -> None:
        """Take what contacts add to the bulk (k, k), and how the sum is scaled and shifted (n,)."""
        self.Forget()
        self._Scale(scale)
        gather, ismultiplier = self._surfaces.Gather, np.zeros(len(self.free))
        ismultiplier[multipliers] = 1
        values = [gather(part) for part in (self._scale, self.free.astype(float), ismultiplier)]
        self._shift = None if shift is None else np.where(self.free, shift, 0.0)
        if self.numbering.rank == 0:
            scale, free, ismultiplier = values
            total = self._surfaces.Sum(mats)
            self._contacts = Contacts(total, np.flatnonzero(ismultiplier), scale, free > 0)

    def _Scale(self, scale: np.ndarray) -> None:
        """Scale the bulk, once for each scale."""
        scale = np.where(self.free, scale, 1.0)
        before = 1.0 if self._scale is None else self._scale
        self._scale = scale
        factor = self.numbering.Put(scale / before, fill=1.0)
        self._bulk.diagonalScale(factor, factor)

    def Solve(self, b: np.ndarray, accuracy: float, method: str) -> tuple[np.ndarray, float]:
        """Solve with the matrices that were set: the solution (n,), and its relative residual."""
        solve = self._Direct if method == "direct" else self._Iterate
        right = self.numbering.Put(b)
        try:
            x, error = solve(right, accuracy)
            return self.numbering.Get(x), error
        finally:
            self.numbering.CleanUp()

    def Forget(self) -> None:
        """Keep nothing but the bulk."""
        self._contacts = self._iterative = self._shift = None
        self._direct.Forget()
        self.numbering.CleanUp()

    def _Direct(self, b: PETSc.Vec, _: float) -> tuple[PETSc.Vec, float]:
        if self._direct.mat is None:
            self._direct.Take(self._WithBulk(self._OnRankZero(Contacts.All)))
        return self._direct.Solve(b)

    def _Iterate(self, b: PETSc.Vec, accuracy: float) -> tuple[PETSc.Vec, float]:
        """Solve by the iteration, and count what it takes even where it fails."""
        if self._iterative is None:
            self._iterative = self._Iterative()
        before = self._iterative.krylov
        try:
            return self._iterative.Solve(b, accuracy)
        finally:
            self.krylov += self._iterative.krylov - before

    def _Iterative(self) -> PetscIterative:
        """The PetscIterative for the matrices that were set."""
        numbering, dim = self.numbering, self.numbering.width
        condensed = self._OnRankZero(lambda contacts: contacts.Condensed(dim))
        mat = self._WithBulk(self._OnRankZero(lambda contacts: contacts.Sparse(condensed)))
        if self._multigrid is None:
            self._multigrid = PetscMultigrid(numbering, numbering.Nodes(self._nodes.vertices))
        touched = numbering.Tell(self._OnRankZero(lambda contacts: contacts.touched))
        there = np.zeros(len(self.free), dtype=bool)
        self._surfaces.Rows(touched, there)
        rows = numbering.Nodes(self._nodes.With(there))
        pc = self._multigrid.Preconditioner(mat, rows, self._Motions())
        return PetscIterative(numbering, mat, condensed, pc)

    def _Motions(self) -> list[PETSc.Vec]:
        """The rigid motions in scaled variables."""
        factor = np.where(self.free, 1 / self._scale, 0.0)
        return [self.numbering.Put(factor * m) for m in np.asarray(self._nodes.motions).T]

    def _WithBulk(self, found: tuple[csr_matrix, np.ndarray] | None) -> PETSc.Mat:
        """The sum of the bulk and what rank 0 has found: a matrix and its dofs on surfaces."""
        part, dofs = found or (None, None)
        rows = None if part is None else self._surfaces.rows[dofs]
        diagonal = self.numbering.held.copy()
        if self._shift is not None:
            diagonal += self.numbering.Put(self._shift).array
        total = Assembled(self.numbering, part, rows, diagonal)
        total.axpy(1.0, self._bulk, structure=LoadPETSc().Mat.Structure.DIFFERENT_NONZERO_PATTERN)
        return total

    def _OnRankZero(self, function: Callable[[Contacts], Any]) -> Any:
        """What a function of the Contacts returns, None on other ranks; all raise its errors."""
        if self.numbering.rank != 0:
            return self.numbering.together.Agree(lambda: None, LinearSolveError)
        return self.numbering.together.Agree(lambda: function(self._contacts), LinearSolveError)


class PetscIterative:
    """Solves one system after the other; collective."""

    best = 1e-12  # relative residual that GMRES can reach
    most, patience = 150, 60

    def __init__(
        self,
        numbering: Numbering,
        mat: PETSc.Mat,
        contact: LocalContact | None,
        preconditioner: PETSc.PC,
    ):
        self.numbering, self.krylov = numbering, 0
        self._system = CondensedSystem(numbering, mat, contact)
        self._preconditioner = preconditioner

    def Solve(self, b: PETSc.Vec, accuracy: float) -> tuple[PETSc.Vec, float]:
        """The solution, a new vector, and its relative residual."""
        exact, size = max(accuracy, EXACT), b.norm()

        def Step(left: PETSc.Vec) -> PETSc.Vec:
            return self._Step(left, 0.9 * exact * size)

        def Residual(x: PETSc.Vec) -> PETSc.Vec:
            return self._system.Residual(b, x)

        return Refine(Step, Residual, b, exact=exact, norm=lambda vec: vec.norm())

    def _Step(self, b: PETSc.Vec, residual: float) -> PETSc.Vec:
        """A solution up to a residual, a new vector."""
        reduced = self._system.Reduce(b)
        size, w = reduced.norm(), b.duplicate()
        tol = min(max(residual / size, self.best), 0.1) if size else 1.0
        work = b.duplicate(), b.duplicate(), b.duplicate()
        product = PreconditionedProduct(
            b.local_size, partial(self._Apply, *work), self.numbering.Total
        )
        rhs, every = CreateVVector(b.local_size), AsBits(np.ones(b.local_size))
        rhs.FV().NumPy()[:] = reduced.array
        found, residuals, converged = GMRes(product, rhs, every, tol, self.most, self.patience)
        self.krylov += len(residuals) - 1
        if not converged:
            left = residuals[-1] / residuals[0]
            raise LinearSolveError(f"no convergence in {len(residuals) - 1} iterations: {left:.1e}")
        w.array[:] = found.FV().NumPy()
        return self._system.Expand(b, w)

    def _Apply(
        self,
        before: PETSc.Vec,
        moved: PETSc.Vec,
        product: PETSc.Vec,
        x: np.ndarray,
        z: np.ndarray,
        image: np.ndarray,
    ) -> None:
        """Fill arrays: z = M^-1 x and image = A z, with the work of three vectors."""
        before.array[:] = x
        with Checked():
            self._preconditioner.apply(before, moved)
        self._system.Mult(moved, product)
        z[:], image[:] = moved.array, product.array


def Assembled(
    numbering: Numbering,
    part: csr_matrix | None,
    rows: np.ndarray,
    diagonal: np.ndarray | None = None,
) -> PETSc.Mat:
    """The sum over all ranks of square parts; collective."""
    PETSc = LoadPETSc()
    if part is None:
        part, rows = scipy.sparse.csr_matrix((0, 0)), []
    rows = np.asarray(rows, dtype=np.int64)
    if diagonal is not None:
        part, rows = WithDiagonal(part, rows, numbering.start + np.arange(len(diagonal)), diagonal)
    local = PETSc.Mat().createAIJ(part.shape, csr=CSR(part), comm=PETSc.COMM_SELF)
    mapping = PETSc.LGMap().create(rows.astype(PETSc.IntType), comm=numbering.comm)
    mat = PETSc.Mat().createIS(numbering.sizes, lgmapr=mapping, lgmapc=mapping, comm=numbering.comm)
    mat.setISLocalMat(local)
    mat.assemble()
    mat.convert("aij")
    mat.setBlockSize(numbering.width)
    return mat


def CSR(part: csr_matrix) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Starts, columns and values as PETSc wants them."""
    PETSc = LoadPETSc()
    part.sort_indices()
    return (
        part.indptr.astype(PETSc.IntType),
        part.indices.astype(PETSc.IntType),
        part.data.astype(PETSc.ScalarType),
    )


def WithDiagonal(
    part: csr_matrix, rows: np.ndarray, own: np.ndarray, diagonal: np.ndarray
) -> tuple[csr_matrix, np.ndarray]:
    """A part and its rows, with a diagonal on rows `own`."""
    every = np.union1d(rows, own)
    at, on = np.searchsorted(every, rows), np.searchsorted(every, own)
    part = part.tocoo()
    row = np.concatenate([at[part.row], on])
    column = np.concatenate([at[part.col], on])
    values = np.concatenate([part.data, diagonal])
    return scipy.sparse.csr_matrix((values, (row, column)), shape=(len(every),) * 2), every
