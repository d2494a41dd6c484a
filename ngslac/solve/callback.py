# SPDX-License-Identifier: LGPL-2.1-or-later
"""Calls back to the user, who may look at everything but not change what a solver works on."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ngslac.parallel.layout import LayoutOf

if TYPE_CHECKING:
    from ngsolve import GridFunction, Parameter

    from ngslac.solve.iteration import Iteration

__all__ = ["TellIterate", "TellStep"]


def TellIterate(
    callback: Callable[[Iteration], object], entry: Iteration, gf: GridFunction
) -> None:
    """Hand over a line of the iteration; the iterate stays as it is."""
    layout = LayoutOf(gf.space)
    kept = layout.Values(gf.vec).copy()
    layout.together.ByUser(callback, entry)
    if not np.array_equal(layout.Values(gf.vec), kept):
        raise ValueError(
            "callback has changed gf in the middle of Solve, or refined its space: do that between "
            "two calls of Solve"
        )


def TellStep(
    callback: Callable[[Any], object],
    step: Any,
    name: str,
    parameter: Parameter,
    **fields: GridFunction,
) -> None:
    """Hand over a step; load or time stay where it ended: stepping would never end.

    Its callback may change `fields`, as long as there are numbers in them.
    """
    value, gf = parameter.Get(), next(iter(fields.values()))
    LayoutOf(gf.space).together.ByUser(callback, step)
    if parameter.Get() != value:
        raise ValueError(
            f"callback has set the {name} from {value:g} to {parameter.Get():g} in the middle of "
            "the steps: change it between two calls of Integrate"
        )
    for field, gf in fields.items():
        if not np.all(np.isfinite(LayoutOf(gf.space).Values(gf.vec))):
            raise ValueError(f"callback has put NaN or infinite values into {field}")
