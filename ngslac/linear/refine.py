# SPDX-License-Identifier: LGPL-2.1-or-later
"""Acceptance of solutions, and iterative refinement."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from netgen.meshing import NgException

from ngslac.errors import LinearSolveError

__all__ = ["EXACT", "FirstGood", "Refine"]

ACCEPTABLE = 1e-5  # nearly singular: the next Newton step makes up for it
# Relative residual that is enough where nothing less is asked for, and rounds to reach it.
EXACT, ROUNDS = 1e-13, 4


def FirstGood(
    attempts: Iterable[tuple[str, Callable[[], tuple[Any, float]], Callable[[Any, float], bool]]],
) -> tuple[Any, float, str | None]:
    """The first good solution of several attempts, or the best one if that is acceptable.

    An attempt is a name, a function that returns a solution and its residual, and one that tells
    whether they are good.
    """
    errors, best = [], (None, np.inf)
    for name, solve, good in attempts:
        try:
            x, error = solve()
        except (RuntimeError, NgException, np.linalg.LinAlgError) as failure:  # or a library's
            errors.append(f"{name}: {failure}")
            continue
        if good(x, error):
            return x, error, name
        errors.append(f"{name}: relative residual {error:.1e}")
        if error < best[1]:
            best = x, error
    if best[1] <= ACCEPTABLE:
        return *best, None
    raise LinearSolveError(", ".join(errors))


def Refine(
    solve: Callable,
    residual: Callable,
    b: Any,
    *,
    exact: float = EXACT,
    rounds: int = ROUNDS,
    norm: Callable = np.linalg.norm,
) -> tuple[Any, float]:
    """The best solution of iterative refinement from zero on, and its relative residual."""
    x, left, size, error = 0 * b, b, norm(b), 1.0
    best = x, (1.0 if size else 0.0)
    for _ in range(rounds if size else 0):
        x = x + solve(left)
        left = residual(x)
        before, error = error, float(norm(left)) / size
        if error < best[1]:  # not so where it is NaN
            best = x, error
        if not exact < error < 0.5 * before:
            break
    return best
