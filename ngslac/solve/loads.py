# SPDX-License-Identifier: LGPL-2.1-or-later
"""Loads besides those of the bulk form: checked, and as numbers."""

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
    """Loads that are a LinearForm or a vector on the space, or a function that returns one."""
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
    """The load on the space of a GridFunction: from nothing, a vector, a form or a callable."""
    if IsFunction(rhs):  # which may fail on one of many processes
        return LayoutOf(gf.space).together.ByUser(_LoadOf, rhs, gf)
    return _LoadOf(rhs, gf)


def _LoadOf(
    rhs: LinearForm | BaseVector | Callable[[], LinearForm | BaseVector] | None, gf: GridFunction
) -> np.ndarray:
    """The same, of this process."""
    name, load = ("rhs()", rhs()) if IsFunction(rhs) else ("rhs", rhs)
    values = Values(load, gf.space, name)
    if isinstance(load, LinearForm) and not IsAssembled(load) and not values.any():
        raise ValueError(
            f"{name} is a LinearForm that was never assembled, which would be no load at all: call "
            "its Assemble() before Solve"
        )
    return values


def Values(load: LinearForm | BaseVector | None, space: FESpace, name: str = "rhs") -> np.ndarray:
    """A load that is no function as array of the rows of a space."""
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
    """Refuse forces of bulk or loads in the rows of the multipliers: they would shift the gap.

    Their `size` may be what the solver takes for zero: reactions of an earlier solve hold as much.
    """
    if size > allowed:
        raise ValueError(
            f"{name} holds terms with the test function of lam, which would shift the gap: leave "
            "them out; an obstacle= or the geometry sets the gap"
        )
