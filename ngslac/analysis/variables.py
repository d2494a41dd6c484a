# SPDX-License-Identifier: LGPL-2.1-or-later
"""Design variables, as directions in which a problem is varied."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from ngsolve import GridFunction

from ngslac.analysis.shape import Shape
from ngslac.arguments import CheckNumber, Wrong

__all__ = ["DirectionsOf", "Entries"]

WANTED = (
    "an ngsolve.Parameter, a GridFunction that is a coefficient, a Shape, or a thing with Get() "
    "and Set(value)"
)


@dataclass
class Scalar:
    """The value of a Parameter, or of what has Get and Set as one."""

    parameter: Any
    start: float
    moves = False

    @property
    def size(self):
        """Of usual changes."""
        return abs(self.start)

    def Set(self, way):
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
    def size(self):
        """Of usual changes."""
        return float(np.max(np.abs(self.start)))

    def Set(self, way):
        """Vary by so much; 0 brings back what was there."""
        self.values[:] = self.start
        self.values[self.chosen] += way * self.factors


@dataclass
class Motion:
    """The points of a mesh, along the velocity of a Shape."""

    shape: Shape
    start: np.ndarray
    moves = True

    @property
    def size(self):
        """Of usual changes: what moves points as far as the mesh is large."""
        return np.ptp(self.start, axis=0).max() / np.max(np.abs(self.shape.velocity))

    def Set(self, way):
        """Vary by so much; 0 brings back what was there."""
        self.shape.Points()[:] = self.start + way * self.shape.velocity if way else self.start


def DirectionsOf(variable, solver, load=None):
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


def FieldDirections(field, solver):
    """One for each coefficient of a GridFunction, and all of them at once."""
    own = [solver.gf, *(getattr(c, name) for c in solver.contacts for name in c._names.scalars)]
    if field.space == solver.gf.space or any(field is gf for gf in own):
        raise ValueError("variable is a result, not a coefficient: differentiate the functional")
    if field.space.is_complex:
        raise ValueError("variable is a complex GridFunction: give a real one")
    values = field.vec.FV().NumPy()
    start = values.copy()
    each = [Entries(values, start, number) for number in range(len(start))]
    return each, Entries(values, start, slice(None))
