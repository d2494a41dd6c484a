# SPDX-License-Identifier: LGPL-2.1-or-later
"""Meshes that are made in one process and distributed to all of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from netgen.meshing import Mesh as NetgenMesh
from netgen.meshing import NetgenGeometry
from ngsolve import Integrate, Mesh

from ngslac.arguments import Wrong
from ngslac.parallel.together import Portable

__all__ = ["Distributed"]

SAME = 1e-9  # relative difference of the volume before and after


def Distributed(make: Callable[[], Mesh], comm: Any = None) -> Mesh:
    """The mesh that a function makes, distributed to the processes of a communicator.

    Any mesh that is made in a single process will do: of the builders here, refined before, from a
    file, with split slave faces. Meshes of a geometry can be had without it by
    ``Mesh(geometry.GenerateMesh(comm=comm))``. The first process holds no elements then.

    Parameters
    ----------
    make : callable
        Returns an `ngsolve.Mesh`; called in the first process only.
    comm : mpi4py.MPI.Comm, optional
        Such as ``MPI.COMM_WORLD``. None, or a communicator of one process: the mesh as it is made.

    Returns
    -------
    ngsolve.Mesh
        With the same names, and curved to the same order.

    Raises
    ------
    Exception
        What `make` raises, in all processes.
    ValueError
        If the mesh has a deformation, or curved elements that do not follow from its geometry:
        neither goes along.
    TypeError
        If `make` returns no mesh, or `comm` is no communicator.

    Examples
    --------
    >>> from ngslac.meshes import Distributed, SphereOnBlock
    >>> mesh = Distributed(lambda: SphereOnBlock(4.0))

    In a script for several processes ``from mpi4py import MPI`` and ``comm=MPI.COMM_WORLD``.
    """
    if comm is not None and not (hasattr(comm, "size") and hasattr(comm, "rank")):
        raise Wrong(TypeError, "comm", comm, "a communicator of mpi4py, or None")
    if comm is None or comm.size == 1:
        return make()
    if comm.rank == 0:
        ngmesh, (geometry, order, volume) = _Made(make, comm)
        ngmesh.Distribute(comm)
    else:
        error, geometry, order, volume = comm.bcast(None)
        if error is not None:
            raise error
        ngmesh = NetgenMesh.Receive(comm)
        if geometry is not None:
            ngmesh.SetGeometry(geometry)
    mesh = Mesh(ngmesh)
    if order > 1:
        mesh.Curve(order)
    if abs(Integrate(1, mesh) - volume) > SAME * volume:
        raise ValueError("the curved elements of the mesh do not follow from its geometry")
    return mesh


def _Made(make: Callable[[], Mesh], comm: Any) -> tuple[NetgenMesh, tuple]:
    """The netgen mesh. All processes get geometry, order and volume, or the error."""
    try:
        mesh = make()
        ngmesh, order = _Copied(mesh)
        geometry = ngmesh.GetGeometry()
        if type(geometry) is NetgenGeometry:  # of a mesh that was made by hand
            geometry = None
        known = geometry, order, Integrate(1, mesh)
        comm.bcast((None, *known))  # raises, too, if the geometry cannot be sent
    except BaseException as error:
        comm.bcast((Portable(error), None, 1, 0.0))
        raise
    return ngmesh, known


def _Copied(mesh: Mesh) -> tuple[NetgenMesh, int]:
    """A copy of the netgen mesh: the NGSolve mesh and its spaces stay as they are."""
    if not isinstance(mesh, Mesh):
        raise TypeError(f"make() must return an ngsolve.Mesh, not {type(mesh).__name__}")
    if mesh.deformation is not None:
        raise ValueError("a mesh with a deformation cannot be distributed: call UnsetDeformation()")
    return mesh.ngmesh.Copy(), mesh.GetCurveOrder()
