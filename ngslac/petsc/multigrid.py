# SPDX-License-Identifier: LGPL-2.1-or-later
"""Preconditioner: all dofs, contact at once, and GAMG on the dofs of the vertices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ngslac.petsc.library import Checked, LoadPETSc, Options

if TYPE_CHECKING:
    from petsc4py import PETSc

    from ngslac.petsc.numbering import Numbering

__all__ = ["PetscMultigrid"]

# Blocks of nodes, and all dofs that contact touches as one more block: slip couples the dofs of a
# macro-element in an unsymmetric way, which smaller blocks do not see.
FINE = {
    "mg_levels_ksp_type": "chebyshev",
    "mg_levels_ksp_max_it": 4,
    "mg_levels_ksp_chebyshev_esteig": "0,0.05,0,1.1",
    "mg_levels_pc_type": "fieldsplit",
    "mg_levels_pc_fieldsplit_type": "additive",
    "mg_levels_fieldsplit_nodes_ksp_type": "preonly",
    "mg_levels_fieldsplit_nodes_pc_type": "pbjacobi",
    "mg_levels_fieldsplit_contact_ksp_type": "preonly",
    "mg_levels_fieldsplit_contact_pc_type": "lu",
    "mg_levels_fieldsplit_contact_pc_factor_mat_solver_type": "mumps",
}
# All of it treats a dof in the same way on any number of ranks.
COARSE = {
    "mg_coarse_ksp_type": "gmres",
    "mg_coarse_ksp_max_it": 5,
    "mg_coarse_ksp_rtol": 1e-2,
    "mg_coarse_pc_type": "gamg",
    "mg_coarse_pc_gamg_threshold": 0.01,
    "mg_coarse_pc_gamg_agg_nsmooths": 1,
    "mg_coarse_mg_levels_ksp_type": "chebyshev",
    "mg_coarse_mg_levels_ksp_max_it": 2,
    "mg_coarse_mg_levels_pc_type": "jacobi",
}


class PetscMultigrid:
    """Two levels of PCMG, GAMG below; collective.

    In NGSolve's hierarchical bases the functions of the vertices are those of first order: the
    coarse matrix is a part of the fine one.
    """

    def __init__(self, numbering: Numbering, vertices: np.ndarray):
        PETSc = LoadPETSc()
        self.numbering = numbering
        self._rows = Set(numbering, vertices)
        count = np.count_nonzero(vertices)
        layout = PETSc.Vec().createMPI((count, None), comm=numbering.comm)
        first, last = layout.getOwnershipRange()
        starts = np.concatenate([[0], np.cumsum(vertices)])
        csr = starts, np.arange(first, last), np.ones(count)
        sizes = numbering.sizes[0], (count, layout.size)
        indices = [part.astype(PETSc.IntType) for part in csr[:2]]
        self._injection = PETSc.Mat().createAIJ(sizes, csr=(*indices, csr[2]), comm=numbering.comm)

    def Preconditioner(
        self, mat: PETSc.Mat, contact: np.ndarray, motions: Sequence[PETSc.Vec], **changes
    ) -> PETSc.PC:
        """PETSc.PC for a matrix."""
        PETSc = LoadPETSc()
        options = Options("contact", **(FINE | COARSE | changes))
        pc = PETSc.PC().create(mat.comm)
        pc.setOptionsPrefix(options.prefix)
        pc.setType("mg")
        pc.setMGLevels(2)
        pc.setMGInterpolation(1, self._injection)
        pc.setOperators(mat)
        pc.setFromOptions()
        smoother = pc.getMGSmoother(1)
        smoother.setOperators(mat)
        smoother.setFromOptions()
        parts = Set(self.numbering, ~contact), Set(self.numbering, contact)
        smoother.getPC().setFieldSplitIS(("nodes", parts[0]), ("contact", parts[1]))
        pc.getMGCoarseSolve().setOperators(self._Coarse(mat, motions))
        try:
            with Checked():
                pc.setUp()
                pc.setUpOnBlocks()
        finally:
            options.Clear()
        return pc

    def _Coarse(self, mat: PETSc.Mat, motions: Sequence[PETSc.Vec]) -> PETSc.Mat:
        """The part of the vertices, with the motions that it takes to nearly nothing."""
        coarse = mat.createSubMatrix(self._rows, self._rows)
        coarse.setBlockSize(self.numbering.width)
        modes = []
        for motion in motions:
            modes.append(coarse.createVecRight())
            self._injection.multTranspose(motion, modes[-1])
        space = LoadPETSc().NullSpace().create(vectors=modes, comm=coarse.comm)
        coarse.setNearNullSpace(space)
        return coarse


def Set(numbering: Numbering, which: np.ndarray) -> PETSc.IS:
    """Rows of this rank as index set."""
    PETSc = LoadPETSc()
    rows = numbering.start + np.flatnonzero(which)
    found = PETSc.IS().createGeneral(rows.astype(PETSc.IntType), comm=numbering.comm)
    found.setBlockSize(numbering.width)
    return found
