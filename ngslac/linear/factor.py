# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sparse factorisations."""

from __future__ import annotations

import ctypes
import importlib.metadata
import importlib.util
from collections.abc import Callable
from contextlib import ContextDecorator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ngslac.arrays import Multiply
from ngslac.errors import LinearSolveError
from ngslac.linear.quiet import Quiet

if TYPE_CHECKING:
    from ngsolve import BaseMatrix, BitArray

__all__ = ["LU", "Cholesky", "Factor", "HasEqualWorks", "IsSymmetric"]

# Pardiso's own ordering is no match for nested dissection in three dimensions, and its own
# refinement, of every solution, costs more than ours.
FLAGS = {
    "pardiso": {"ordering": "metis", "refinement": 0},
    "pardisospd": {"ordering": "metis", "refinement": 0, "symmetric": True},
}
CHOLESKY = ("pardisospd", "sparsecholesky")
# Difference of works, relative to what they can be, that is rounding.
SYMMETRIC = 1e-13
LOUD = ("umfpack",)  # print a message about a singular matrix with each solution


def HasMKL() -> bool:
    """Is Intel's MKL installed, and Pardiso with it?"""
    try:
        importlib.metadata.version("mkl")
    except importlib.metadata.PackageNotFoundError:
        return False
    return True


def LU(inverse: str | None = None) -> str:
    """The solver for unsymmetric matrices: the one asked for, or the fastest installed."""
    if inverse and inverse not in CHOLESKY:
        return inverse
    return "pardiso" if HasMKL() else "umfpack"


def Cholesky(inverse: str | None = None) -> str:
    """The solver for symmetric positive definite matrices, or the one asked for."""
    return inverse or ("pardisospd" if HasMKL() else "sparsecholesky")


# OpenBLAS of NGSolve, SciPy and NumPy: package, where the library is from there, its functions.
BLAS = (
    ("ngsolve_openblas", "libopenblas*", "openblas_{}_num_threads"),
    ("scipy", "../scipy.libs/libscipy_openblas*", "scipy_openblas_{}_num_threads"),
    ("numpy", "../numpy.libs/libscipy_openblas64_*", "scipy_openblas_{}_num_threads64_"),
)


@cache
def BLASThreads() -> list[list[Callable | None]]:
    """For each OpenBLAS that is found: functions that get and set its number of threads."""
    found = []
    for package, pattern, name in BLAS:
        spec = importlib.util.find_spec(package)
        for path in sorted(Path(spec.origin).parent.glob(pattern))[:1] if spec else ():
            blas = ctypes.CDLL(str(path))
            found.append([getattr(blas, name.format(verb), None) for verb in ("get", "set")])
    return [pair for pair in found if all(pair)]


class OneBLASThread(ContextDecorator):
    """Let BLAS use one thread.

    The small dense blocks of a sparse factorisation gain nothing from more, and inside of a
    TaskManager, whose workers spin on all cores, they cost a factor of ten. After the solutions on
    the coarsest level of a multigrid method the others wait in loops.
    """

    def __init__(self):
        self.before = []  # for each block that is open

    def __enter__(self) -> None:
        self.before.append([tell() for tell, _ in BLASThreads()])
        for _, set_threads in BLASThreads():
            set_threads(1)

    def __exit__(self, *_) -> None:
        for (_, set_threads), threads in zip(BLASThreads(), self.before.pop(), strict=True):
            set_threads(threads)


def Factor(mat: BaseMatrix, freedofs: BitArray, inverse: str, **flags) -> BaseMatrix:
    """Sparse factorisation of a matrix, as operator."""
    quiet = Quiet()
    try:
        with quiet:
            factors = mat.Inverse(freedofs, inverse=inverse, flags=FLAGS.get(inverse, {}) | flags)
            fine = inverse not in LOUD or _Solves(factors)
    except Exception as error:
        if isinstance(error, ImportError) or "available" in str(error):
            raise ValueError(f"inverse={inverse!r} is not available: {error}") from error
        raise LinearSolveError(f"{inverse}: {error}") from error
    if not fine:
        raise LinearSolveError(f"{inverse}: the matrix is singular")
    if quiet.text:
        print(quiet.text, end="")  # such as output that NGSolve was asked for
    return factors


def _Solves(factors: BaseMatrix) -> bool:
    """Is a solution finite? If not, each further one would be a line on the screen."""
    x = factors.CreateRowVector()
    x.FV().NumPy()[:] = 1.0
    return bool(np.isfinite((factors * x).Evaluate().Norm()))


def IsSymmetric(mat: BaseMatrix) -> bool:
    """Is a matrix symmetric, to rounding, as far as two random vectors show it?"""
    x, y = np.random.default_rng(1).standard_normal((2, mat.height))
    return HasEqualWorks(lambda vec: Multiply([mat], vec), x, y)


def HasEqualWorks(
    product: Callable[[np.ndarray], np.ndarray],
    x: np.ndarray,
    y: np.ndarray,
    total: Callable[[float], float] = lambda part: part,
) -> bool:
    """Is x.Ay = y.Ax, to rounding?"""
    image = product(y)
    work, *squares = (float(total(a @ b)) for a, b in ((x, image), (x, x), (image, image)))
    return bool(abs(total(y @ product(x)) - work) <= SYMMETRIC * np.sqrt(np.prod(squares)))
