# SPDX-License-Identifier: LGPL-2.1-or-later
"""Classes and functions that also work on a mesh that NGSolve distributes."""

import inspect
import os
import warnings
from functools import wraps

from ngsolve import FESpace, Mesh

__all__ = [
    "Distributable",
    "DistributedMesh",
    "OnDistributedMeshes",
    "OnManyProcesses",
    "WarnOfCopies",
]

# Environment variables with the number of processes and the rank, of Open MPI, MPICH and its kin.
STARTED = (("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"), ("PMI_SIZE", "PMI_RANK"))


class OnManyProcesses:
    """Functions that run calls on a distributed mesh; set as soon as there is one.

    Attributes
    ----------
    Make, Call : callable
        ``Make(mesh, kind, args, options)`` gives what stands for an object,
        ``Call(mesh, function, args, options)`` the result of a function, on all processes.
    """

    Make = Call = None


class Distributable(type):
    """Class of classes whose objects on a distributed mesh live on its first process."""

    @property
    def __signature__(cls):
        """That of the constructor, which `__call__` would hide."""
        _, *others = inspect.signature(cls.__init__).parameters.values()
        return inspect.Signature(others)

    def __call__(cls, *args, **options):
        """An object, or its stand-in."""
        mesh = DistributedMesh([*args, *options.values()])
        if mesh is not None:
            return OnManyProcesses.Make(mesh, cls, args, options)
        return super().__call__(*args, **options)


def OnDistributedMeshes(function):
    """A function of objects that may live on a distributed mesh."""

    @wraps(function)
    def Everywhere(*args, **options):
        mesh = DistributedMesh([*args, *options.values()])
        if mesh is not None:
            return OnManyProcesses.Call(mesh, function, args, options)
        return function(*args, **options)

    return Everywhere


def DistributedMesh(things):
    """The distributed mesh that some of these things live on; None if there is no such."""
    for thing in things:
        mesh = MeshOf(thing)
        if mesh is None and isinstance(thing, (list, tuple)):
            mesh = DistributedMesh(thing)
        if mesh is not None and mesh.comm.size > 1:
            return mesh
    return None


def MeshOf(thing):
    """The mesh of a space, of an object on a space, or of a stand-in."""
    space = thing if isinstance(thing, FESpace) else getattr(thing, "space", None)
    mesh = getattr(space if isinstance(space, FESpace) else thing, "mesh", None)
    return mesh if isinstance(mesh, Mesh) else None


def WarnOfCopies(mesh):
    """Warn where mpiexec has started many processes, but each has the whole mesh."""
    for size, rank in STARTED:
        count = int(os.environ.get(size, 1))
        if count > 1 and mesh.comm.size == 1 and os.environ.get(rank) == "0":
            warnings.warn(
                f"each of {count} processes solves the whole problem: to share the work distribute "
                "the mesh, Mesh(geometry.GenerateMesh(comm=MPI.COMM_WORLD))",
                stacklevel=6,
            )
