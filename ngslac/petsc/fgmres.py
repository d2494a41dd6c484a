# SPDX-License-Identifier: LGPL-2.1-or-later
"""Flexible GMRES on vectors of which each rank has a part."""

from dataclasses import dataclass

import numpy as np

__all__ = ["FGMRES", "Iteration"]


@dataclass(frozen=True)
class Iteration:
    """What an iteration came to.

    Attributes
    ----------
    number : int
        Of products.
    residual : float
        Norm, relative to the first.
    """

    number: int
    residual: float


def FGMRES(product, precondition, b, x, total, *, tol, most, patience):
    """Solve with GMRES preconditioned from the right, from 0 and without restart; collective.

    PETSc's own would call back for the product, and crash where it outlives Python.

    Parameters
    ----------
    product, precondition : callable
        (vector, image)
    b, x : PETSc.Vec
        Right hand side, and where the solution goes.
    total : callable
        Sums up arrays of numbers over all ranks.
    tol : float
        Relative residual.
    most, patience : int
        Products; those that have to halve the residual.

    Returns
    -------
    Iteration
    """
    size, (image, given, move) = b.norm(), (b.duplicate() for _ in range(3))
    x.set(0)
    if size == 0:
        return Iteration(0, 0.0)
    basis, moves, residuals = [b.array / size], [], [1.0]
    matrix = np.zeros((most + 1, most))
    while residuals[-1] > tol and len(moves) < most:
        k = len(moves)
        given.array[:] = basis[k]
        precondition(given, move)
        product(move, image)
        moves.append(move.array.copy())
        w = image.array.copy()
        matrix[: k + 1, k] = Orthogonalize(w, basis, total)
        matrix[k + 1, k] = np.sqrt(total(np.array([w @ w]))[0])
        y, residual = Least(matrix[: k + 2, : k + 1])
        if not np.isfinite(residual):
            return Iteration(k + 1, np.inf)
        residuals.append(residual)
        if matrix[k + 1, k] == 0 or Stalls(residuals, patience):
            break
        basis.append(w / matrix[k + 1, k])
    x.array[:] = size * sum(factor * move for factor, move in zip(y, moves, strict=True))
    return Iteration(len(moves), residuals[-1])


def Orthogonalize(w, basis, total):
    """Take from w its parts along the basis, twice, which leaves rounding errors alone."""
    parts = 0.0
    for _ in range(2):
        found = total(np.array([v @ w for v in basis]))
        for factor, v in zip(found, basis, strict=True):
            w -= factor * v
        parts = parts + found
    return parts


def Least(matrix):
    """The solution of least residual for the first unit vector, and this."""
    if not np.all(np.isfinite(matrix)):
        return None, np.inf
    right = np.eye(len(matrix), 1)[:, 0]
    y = np.linalg.lstsq(matrix, right, rcond=None)[0]
    return y, float(np.linalg.norm(matrix @ y - right))


def Stalls(residuals, patience):
    """Did the last products not halve the residual?"""
    return len(residuals) > patience and residuals[-1] > 0.5 * residuals[-1 - patience]
