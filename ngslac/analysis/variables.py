# SPDX-License-Identifier: LGPL-2.1-or-later
"""Design variables, as directions in which a problem is varied."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import GridFunction, Parameter

from ngslac.analysis.shape import Shape
from ngslac.arguments import CheckNumber, Wrong

if TYPE_CHECKING:
    from ngslac.solve.solver import ContactSolver

__all__ = ["DirectionsOf", "Entries"]

# Largest step of the entries of a field, relative to the field.
MOST = 1e3
WANTED = (
    "an ngsolve.Parameter, a GridFunction that is a coefficient, a Shape, or a thing with Get() "
    "and Set(value)"
)


@dataclass
class Scalar:
    """The value of a Parameter, or of what has Get and Set as one."""

    parameter: Any
    start: float
    moves, most = False, np.inf

    @property
    def size(self) -> float:
        """Of usual changes."""
        return abs(self.start)

    def Set(self, way: float) -> None:
        """Vary by so much; 0 brings back what was there."""
        self.parameter.Set(self.start + way)


@dataclass
class Entries:
    """Some coefficients of a field."""

    values: np.ndarray  # to be written to
    start: np.ndarray
    chosen: Any
    factors: Any = 1.0
    moves = False

    @property
    def size(self) -> float:
        """Of usual changes."""
        return float(np.max(np.abs(self.start), initial=0))

    @property
    def most(self) -> float:
        """The largest step, a multiple of its size; none is known of a field that is zero."""
        return MOST * self.size or np.inf

    def Set(self, way: float) -> None:
        """Vary by so much; 0 brings back what was there."""
        self.values[:] = self.start
        self.values[self.chosen] += way * self.factors


@dataclass
class Motion:
    """The points of a mesh, along the velocity of a Shape."""

    shape: Shape
    start: np.ndarray
    moves, most = True, np.inf

    @property
    def size(self) -> float:
        """Of usual changes: what moves points as far as the mesh is large."""
        return np.ptp(self.start, axis=0).max() / np.max(np.abs(self.shape.velocity))

    def Set(self, way: float) -> None:
        """Vary by so much; 0 brings back what was there."""
        self.shape.Points()[:] = self.start + way * self.shape.velocity if way else self.start


def DirectionsOf(
    variable: Any, solver: ContactSolver, load: Parameter | None = None
) -> tuple[list[Motion] | list[Scalar] | list[Entries], Motion | Scalar | Entries]:
    """The directions of a variable, and one by which their steps are chosen."""
    if variable is load and load is not None:
        raise ValueError(
            "variable is the load of the stepper, which each step sets: multiply what it drives by "
            "another Parameter, and take that"
        )
    if isinstance(variable, Shape):
        if variable.mesh.ngmesh is not solver.gf.space.mesh.ngmesh:
            raise ValueError("the Shape is that of another mesh than that of the solution")
        motion = Motion(variable, variable.Points().copy())
        return [motion], motion
    if isinstance(variable, GridFunction):
        return FieldDirections(variable, solver)
    if callable(getattr(variable, "Get", None)) and callable(getattr(variable, "Set", None)):
        scalar = Scalar(variable, CheckNumber("Get() of the variable", variable.Get()))
        return [scalar], scalar
    raise Wrong(TypeError, "variable", variable, WANTED)


def FieldDirections(field: GridFunction, solver: ContactSolver) -> tuple[list[Entries], Entries]:
    """One for each coefficient of a GridFunction, and all of them at once."""
    names = [(c, n) for c in solver.contacts for n in c._names.scalars + c._names.vectors]
    results = [solver.gf, *(getattr(contact, name) for contact, name in names)]
    if field.space == solver.gf.space or any(Overlap(field, gf) for gf in results):
        raise ValueError("variable is a result, not a coefficient: differentiate the functional")
    if field.space.is_complex:
        raise ValueError("variable is a complex GridFunction: give a real one")
    values = field.vec.FV().NumPy()
    start = values.copy()
    each = [Entries(values, start, number) for number in range(len(start))]
    # Other signs, as adding a constant changes no gradient.
    signs = np.random.default_rng(0).choice([-1.0, 1.0], len(start))
    return each, Entries(values, start, slice(None), signs)


def Overlap(one: GridFunction, other: GridFunction) -> bool:
    """Have two GridFunctions entries in common, as one that is a component of the other?"""
    if one.space.is_complex or other.space.is_complex:
        return one is other
    return np.may_share_memory(one.vec.FV().NumPy(), other.vec.FV().NumPy())
