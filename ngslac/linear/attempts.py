# SPDX-License-Identifier: LGPL-2.1-or-later
"""What to do with linear systems that one method does not solve, whatever the methods are."""

import numpy as np
from netgen.meshing import NgException

from ngslac.linear.factor import LinearSolveError

__all__ = ["FirstGood", "SolveShifted"]

ACCEPTABLE = 1e-5  # nearly singular: the next Newton step makes up for it
# Of the diagonal of the scaled matrix where that is singular, and how often in a row.
SHIFT, MOST_SHIFTS = 1e-4, 5


def FirstGood(attempts, tolerance, accuracy):
    """The first good solution of several attempts, or the best one if that is acceptable.

    Parameters
    ----------
    attempts : iterable of (str, callable)
        Names and functions that return a solution and its relative residual.
    tolerance : float
        The largest residual of a good solution.
    accuracy : float
        That which is asked for of an "iterative" one, of which three times that is good, too.

    Returns
    -------
    x : array
    name : str or None
        None: the system is nearly singular.

    Raises
    ------
    LinearSolveError
        No solution is acceptable.
    """
    errors, best = [], (None, np.inf)
    for name, solve in attempts:
        try:
            x, error = solve()
        except (LinearSolveError, NgException) as failure:
            errors.append(f"{name}: {failure}")
            continue
        if error <= max(tolerance, 3 * accuracy * (name == "iterative")):
            return x, name
        errors.append(f"{name}: relative residual {error:.1e}")
        if error < best[1]:
            best = x, error
    if best[1] <= ACCEPTABLE:
        return best[0], None
    raise LinearSolveError("the linear system could not be solved (" + ", ".join(errors) + ")")


def SolveShifted(linear, given, rows, accuracy, pins=None):
    """Solve a system; a singular matrix gets a small diagonal on `rows` (n,) bool.

    Where all that holds a body slips, nothing tells how far it moves. It moves as if it had mass,
    less each time, until something sticks.

    Parameters
    ----------
    linear : LinearSolver or PetscSolver
        Counts the shifts in a row as `shifts`.
    given : tuple
        Bulk, forms, scale and right hand side, for its `Solve`.
    pins : (n,) array, optional
        A diagonal that the matrix has in any case.
    """
    try:
        solution = linear.Solve(*given, pins, accuracy)
        linear.shifts = 0
    except LinearSolveError:
        linear.shifts += 1
        if linear.shifts > MOST_SHIFTS:
            raise
        shift = SHIFT * 0.1 ** (linear.shifts - 1) * rows
        solution = linear.Solve(*given, shift if pins is None else shift + pins)
    return solution
