# SPDX-License-Identifier: LGPL-2.1-or-later
"""Installed versions and solvers."""

import importlib.util
import platform
from importlib.metadata import PackageNotFoundError, version

from ngslac.petsc.library import LoadPETSc
from ngslac.solve.problem import CheckInverse

__all__ = ["Inventory"]

PACKAGES = ("ngslac", "ngsolve", "numpy", "scipy", "pyamg")
SOLVERS = ("sparsecholesky", "umfpack", "pardiso", "mumps")  # those that NGSolve may have


def Version(package: str) -> str:
    """The version of an installed package, or words for none."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not found"


def DirectSolvers() -> list[str]:
    """Names of NGSolve's sparse direct solvers that solve one equation."""
    return [name for name in SOLVERS if Serves(name)]


def Serves(name: str) -> bool:
    """Does NGSolve have this direct solver?"""
    try:
        CheckInverse(name)
    except ValueError:
        return False
    return True


def PETScVersion() -> str:
    """The version of the PETSc that petsc4py brings, or words for none."""
    try:
        return ".".join(map(str, LoadPETSc().Sys.getVersion()))
    except ImportError:
        return "not found (needs petsc4py)"


def MPI() -> str:
    """The version of mpi4py, which is not imported: that would start MPI."""
    found = importlib.util.find_spec("mpi4py")
    return f"mpi4py {Version('mpi4py')}" if found else "not found (needs mpi4py)"


def Inventory() -> dict[str, str]:
    """Names and versions of the software that ngslac uses, in the order of a report.

    Returns
    -------
    dict[str, str]
    """
    return {
        "Python": f"{platform.python_version()} on {platform.platform()}",
        **{package: Version(package) for package in PACKAGES},
        "direct solvers": ", ".join(DirectSolvers()),
        "PETSc": PETScVersion(),
        "MPI": MPI(),
    }
