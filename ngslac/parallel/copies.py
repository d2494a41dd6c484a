# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scripts that mpiexec starts many times without a distributed mesh."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ngsolve import Mesh

__all__ = ["WarnOfCopies"]

# By which Open MPI, and MPICH and its kin, tell how many processes there are, and which this is.
STARTED = (("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"), ("PMI_SIZE", "PMI_RANK"))


def WarnOfCopies(mesh: Mesh) -> None:
    """Warn where mpiexec has started many processes, but each has the whole mesh."""
    for size, rank in STARTED:
        count = int(os.environ.get(size, 1))
        if count > 1 and mesh.comm.size == 1 and os.environ.get(rank) == "0":
            warnings.warn(
                f"each of {count} processes solves the whole problem: to share the work distribute "
                "the mesh, Mesh(geometry.GenerateMesh(comm=MPI.COMM_WORLD))",
                stacklevel=6,
            )
