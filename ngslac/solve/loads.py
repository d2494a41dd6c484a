# SPDX-License-Identifier: LGPL-2.1-or-later
"""Check loads that are not part of the bulk form, and make them numbers."""

from collections.abc import Callable

import numpy as np
from ngsolve import BaseVector, FESpace, GridFunction, LinearForm
from ngsolve.la import DynamicVectorExpression

from ngslac._ngslac import IsAssembled
from ngslac.arguments import CheckVector, IsFunction, Shown
from ngslac.parallel.layout import LayoutOf

__all__ = ["CheckNoMultiplierLoad", "CheckRhs", "LoadVector"]


def CheckRhs(
    rhs: LinearForm | BaseVector | Callable[[], LinearForm | BaseVector] | None, space: FESpace
) -> LinearForm | BaseVector | Callable[[], LinearForm | BaseVector] | None:
    """Check loads: a LinearForm or a vector on the space, or a function that returns one."""
    if isinstance(rhs, GridFunction):
        raise TypeError("rhs is a GridFunction: give its gf.vec if that holds forces")
    if IsFunction(rhs):
        return rhs
    if isinstance(rhs, LinearForm) and rhs.space != space:
        raise ValueError(
            f"rhs is a LinearForm on another space with {rhs.space.ndof} dofs than the product "
            f"space with {space.ndof}: take LinearForm(X) of that X"
        )
    if rhs is not None:
        Values(rhs, space)
    return rhs


def LoadVector(
    rhs: LinearForm | BaseVector | Callable[[], LinearForm | BaseVector] | None, gf: GridFunction
) -> np.ndarray:
    """Return the load on the space of a GridFunction, from None, a vector, a form or a callable."""
    if IsFunction(rhs):  # the function may fail on one of many processes
        return LayoutOf(gf.space).together.ByUser(_LoadOf, rhs, gf)
    return _LoadOf(rhs, gf)


def _LoadOf(
    rhs: LinearForm | BaseVector | Callable[[], LinearForm | BaseVector] | None, gf: GridFunction
) -> np.ndarray:
    """Return the load on this process."""
    name, load = ("rhs()", rhs()) if IsFunction(rhs) else ("rhs", rhs)
    values = Values(load, gf.space, name)
    if isinstance(load, LinearForm) and not IsAssembled(load) and not values.any():
        raise ValueError(
            f"{name} is a LinearForm that was never assembled, which would be no load at all: call "
            "its Assemble() before Solve"
        )
    return values


def Values(load: LinearForm | BaseVector | None, space: FESpace, name: str = "rhs") -> np.ndarray:
    """Return a load that is not a function, as an array of the rows of a space."""
    layout, size = LayoutOf(space), space.ndof * space.dim
    if load is None and name == "rhs":
        return layout.Of(np.zeros(size))
    if isinstance(load, DynamicVectorExpression):  # such as 2 * vector
        load = load.Evaluate()
    if not isinstance(load, (LinearForm, BaseVector)):
        raise TypeError(
            f"{name} = {Shown(load)} must be a LinearForm or a vector on the product space, or a "
            "function that returns one"
        )
    load = load.vec if isinstance(load, LinearForm) else load
    copy = CheckVector(name, load, size).CreateVector()
    copy.data = load
    return layout.Values(copy).copy()


def CheckNoMultiplierLoad(name: str, size: float, allowed: float) -> None:
    """Refuse forces of the bulk form or of loads in rows of multipliers: they shift the gap.

    A `size` up to `allowed` counts as zero: reactions of an earlier solve contain as much.
    """
    if size > allowed:
        raise ValueError(
            f"{name} holds terms with the test function of lam, which would shift the gap: leave "
            "them out; an obstacle= or the geometry sets the gap"
        )
