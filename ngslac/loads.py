"""Loads besides those of the bulk form, as users hand them over: checked, and as numbers."""

import numpy as np
from ngsolve import BaseVector, GridFunction, LinearForm
from ngsolve.la import DynamicVectorExpression

from ngslac.arguments import CheckVector, IsFunction, Shown

__all__ = ["CheckNoMultiplierLoad", "CheckRhs", "LoadVector"]


def CheckRhs(rhs, space):
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
        Values(rhs, space.ndof * space.dim)
    return rhs


def LoadVector(rhs, vec):
    """The load as numpy array: from nothing, a vector, a LinearForm or a callable."""
    return Values(rhs, vec.FV().NumPy().size)


def Values(rhs, size):
    """The same, for vectors of this size."""
    if rhs is None:
        return np.zeros(size)
    name, load = ("rhs()", rhs()) if IsFunction(rhs) else ("rhs", rhs)
    if isinstance(load, DynamicVectorExpression):  # such as 2 * vector
        load = load.Evaluate()
    if not isinstance(load, (LinearForm, BaseVector)):
        raise TypeError(
            f"{name} = {Shown(load)} must be a LinearForm or a vector on the product space, or a "
            "function that returns one"
        )
    load = load.vec if isinstance(load, LinearForm) else load
    return CheckVector(name, load, size).FV().NumPy().copy()


def CheckNoMultiplierLoad(name, forces, rows):
    """Refuse forces of bulk or loads in the rows of the multipliers: they would shift the gap."""
    if np.any(forces[rows]):
        raise ValueError(
            f"{name} holds terms with the test function of lam, which would shift the gap: leave "
            "them out; an obstacle= or the geometry sets the gap"
        )
