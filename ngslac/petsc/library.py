# SPDX-License-Identifier: LGPL-2.1-or-later
"""PETSc, found where Debian hides it, and loaded when it is first needed."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from glob import glob
from types import ModuleType

from ngslac.errors import LinearSolveError
from ngslac.parallel.farewell import Farewell

__all__ = ["Checked", "LoadPETSc", "Options"]

HIDDEN = "/usr/lib/petscdir/*/*/lib/python3/dist-packages"
# PETSc's own handlers would print pages where Python raises errors.
ARGUMENTS = ["ngslac", "-no_signal_handler"]


@cache
def LoadPETSc() -> ModuleType:
    """The module petsc4py.PETSc."""
    try:
        petsc4py = Found()
        petsc4py.init(ARGUMENTS)
        from petsc4py import PETSc

        Farewell.Again()
    except (ImportError, ValueError) as error:
        raise ImportError(
            "PETSc, for distributed meshes and solver='petsc', needs petsc4py, on Debian the "
            "packages python3-petsc4py and python3-mpi4py, with a NumPy of the version they were "
            f"built for (Debian 12: numpy<2): {error}"
        ) from error
    return PETSc


def Found() -> ModuleType:
    """The package petsc4py, also where it is not on the path."""
    try:
        import petsc4py
    except ImportError:
        places = sorted(glob(HIDDEN))
        if not places:
            raise
        sys.path.append(places[-1])  # behind all others: it brings nothing else
        try:
            import petsc4py
        finally:
            sys.path.remove(places[-1])
    return petsc4py


@contextmanager
def Checked() -> Iterator[None]:
    """Errors of PETSc that have come up on all ranks are those of a linear solver."""
    try:
        yield
    except LoadPETSc().Error as error:
        raise LinearSolveError(f"PETSc ended with error {error.ierr}") from error


class Options:
    """Options of PETSc for the objects of one prefix."""

    count = 0

    def __init__(self, name: str, **values):
        Options.count += 1
        self.prefix = f"ngslac{Options.count}_{name}_"
        self._names, options = list(values), LoadPETSc().Options(self.prefix)
        for key, value in values.items():
            options.setValue(key, value)

    def Clear(self) -> None:
        """Take the options back, once they are used."""
        options = LoadPETSc().Options(self.prefix)
        for key in self._names:
            options.delValue(key)
