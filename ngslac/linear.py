"""Checked solution of the merged and scaled linear systems."""

import ctypes
import importlib.metadata
import importlib.util
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from ngsolve import BitArray

from ngslac._ngslac import MergeMatrices

__all__ = ["AsBits", "AsNumPy", "LinearSolveError", "LinearSolver", "Multiply", "ScalarDofs"]

SAFE = "umfpack"
# Pardiso's own ordering is no match for nested dissection in three dimensions.
FLAGS = {"pardiso": {"ordering": "metis"}}


@contextmanager
def OneBLASThread():
    """Let NGSolve's BLAS use one thread.

    The small dense blocks of a sparse factorisation gain nothing from more, and inside of a
    TaskManager, whose workers spin on all cores, they cost a factor of ten.
    """
    spec = importlib.util.find_spec("ngsolve_openblas")
    found = sorted(Path(spec.origin).parent.glob("libopenblas*")) if spec else []
    blas = ctypes.CDLL(str(found[0])) if found else None
    threads = blas.openblas_get_num_threads() if blas else 1
    try:
        if blas:
            blas.openblas_set_num_threads(1)
        yield
    finally:
        if blas:
            blas.openblas_set_num_threads(threads)


class LinearSolveError(RuntimeError):
    """No sparse direct solver found a solution with a small residual."""


class LinearSolver:
    """Direct solver that looks at the residual of what it returns.

    Some factorisations return NaN on saddle point matrices, others lose ten digits, without saying
    so. After iterative refinement the residual must be small, or the safe solver takes over.

    Parameters
    ----------
    freedofs : BitArray
    inverse : str or None
        Name of an NGSolve solver; None: "pardiso" where MKL is installed, else "umfpack".
    """

    tolerance = 1e-9
    acceptable = 1e-5  # nearly singular: the next Newton step makes up for it
    refinements = 3
    # Of the diagonal of the scaled matrix where that is singular, and how often in a row.
    shift, most_shifts = 1e-4, 5

    def __init__(self, freedofs, inverse=None):
        self.bits = BitArray(freedofs)
        self.free = AsNumPy(freedofs)
        self.inverse = inverse or DefaultInverse()
        self.shifts = 0

    def Solve(self, bulk, forms, scale, rhs, shift=None):
        """x with (bulk + forms) x = rhs on the free dofs, 0 elsewhere; numpy arrays.

        `shift` (n,) is added to the diagonal of the scaled matrix, in which the bulk's is 1.
        """
        mat = MergeMatrices(bulk, forms, scale)
        if shift is not None:
            AddToDiagonal(mat, shift)
        b = mat.CreateColVector()
        b.FV().NumPy()[:] = scale * rhs * self.free
        errors, best = [], None
        for inverse in dict.fromkeys((self.inverse, SAFE)):
            with OneBLASThread():
                x, error = self._Refined(mat, b, inverse)
            if error <= self.tolerance:
                self.inverse = inverse
                return scale * x.FV().NumPy()
            errors.append(f"{inverse}: relative residual {error:.1e}")
            if best is None or error < best[1]:
                best = x, error
        if best[1] <= self.acceptable:
            return scale * best[0].FV().NumPy()
        raise LinearSolveError("the linear system could not be solved (" + ", ".join(errors) + ")")

    def SolveShifted(self, bulk, forms, scale, rhs, rows):
        """The same; a singular matrix gets a small diagonal on `rows` (n,) bool.

        Where all that holds a body slips, nothing tells how far it moves. It moves as if it had
        mass, less each time, until something sticks.
        """
        try:
            solution = self.Solve(bulk, forms, scale, rhs)
            self.shifts = 0
        except LinearSolveError:
            self.shifts += 1
            if self.shifts > self.most_shifts:
                raise
            shift = self.shift * 0.1 ** (self.shifts - 1) * rows
            solution = self.Solve(bulk, forms, scale, rhs, shift)
        return solution

    def _Factor(self, mat, inverse):
        return mat.Inverse(self.bits, inverse=inverse, flags=FLAGS.get(inverse, {}))

    def _Refined(self, mat, b, inverse):
        size = np.linalg.norm(b.FV().NumPy())
        x, r, step = b.CreateVector(), b.CreateVector(), b.CreateVector()
        x[:] = 0
        if size == 0:
            return x, 0.0
        try:
            inv = self._Factor(mat, inverse)
        except Exception as error:
            if isinstance(error, ImportError) or "available" in str(error):
                raise ValueError(f"inverse={inverse!r} is not available: {error}") from error
            return x, np.inf  # reported as singular
        error = np.inf
        for _ in range(self.refinements):
            r.data = b - mat * x
            step.data = inv * r  # not in place: Pardiso would return zero
            x.data += step
            r.data = b - mat * x
            before, error = error, np.linalg.norm(r.FV().NumPy() * self.free) / size
            if not np.isfinite(error):
                return x, np.inf
            if error > before:  # no better: keep the solution before
                x.data -= step
                return x, before
            if error < 1e-14 or error > 0.5 * before:
                break
        return x, error


def Multiply(mats, values):
    """The sum of sparse matrices times a vector, as numpy arrays of scalar entries."""
    total = 0.0
    for mat in mats:
        factor, product = mat.CreateRowVector(), mat.CreateColVector()
        factor.FV().NumPy()[:] = values
        product.data = mat * factor
        total = total + product.FV().NumPy()
    return total


def AddToDiagonal(mat, values):
    """Add to the diagonal of a sparse matrix, which has to be in its graph."""
    entries, columns, starts = mat.CSR()
    rows = np.repeat(np.arange(mat.height), np.diff(np.asarray(starts).astype(int)))
    where = np.flatnonzero(rows == np.asarray(columns))
    np.asarray(entries)[where] += values[rows[where]]


def DefaultInverse():
    """NGSolve's fastest solver for unsymmetric matrices among those installed."""
    try:
        importlib.metadata.version("mkl")
    except importlib.metadata.PackageNotFoundError:
        return SAFE
    return "pardiso"


def AsNumPy(bits):
    """A BitArray as numpy array of bool."""
    return np.fromiter((bool(b) for b in bits), dtype=bool, count=len(bits))


def AsBits(values):
    """A numpy array of bool as BitArray."""
    bits = BitArray(len(values))
    for i, value in enumerate(values):
        bits[i] = bool(value)
    return bits


def ScalarDofs(dofs, space):
    """The scalar entries that belong to dofs of a space with blocks."""
    if space.dim == 1:
        return dofs
    return AsBits(AsNumPy(dofs).repeat(space.dim))
