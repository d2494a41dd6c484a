# SPDX-License-Identifier: LGPL-2.1-or-later
"""Coefficients of a contact that depend on its own fields."""

import math

import numpy as np
from ngsolve import CF, GridFunction

from ngslac.arguments import CheckFunction, CheckNumber, Coefficient, Wrong

__all__ = ["COEFFICIENTS", "CheckedStarts", "Dependent", "Fields"]

# Names of places, of columns of a table, and of answers, which nothing is kept under.
TAKEN = {"gap", "slip", "normal", "jump", "x", "area", "c", "trial", "traction", "status"}
TAKEN |= {"pressure", "friction", "fullarea"}
# What may depend on the fields, with the least value.
COEFFICIENTS = {"friction": 0, "tresca": 0, "offset": -math.inf}


class Fields:
    """What a coefficient of `LACContact` that is a function gets: fields of the contact as symbols.

    Numbers of the macro-elements, with which expressions are made and differentiated.

    Attributes
    ----------
    slip : CoefficientFunction
        Vector (d,) along the surface, of the present step, slave minus master; a length.
    rate : CoefficientFunction
        The slip over the length of the step: of time, or of the load of `LoadStepper`.
    gap : CoefficientFunction
        > 0 open; a length.
    pressure : CoefficientFunction
        >= 0 compression; stress units.

    Examples
    --------
    Friction that falls with the speed of slip:

    >>> from ngsolve import Norm, exp
    >>> def Falling(z):
    ...     return 0.2 + 0.2 * exp(-Norm(z.rate) / 3)
    >>> (u, lam), _ = fes.TnT()
    >>> contact = LACContact(u, lam, master="master", friction=Falling)
    """

    def __init__(self, space, dt):
        self._numbers, d = space.WithComponents(1), space.mesh.dim
        self.values = [GridFunction(self._numbers) for _ in range(d + 2)]
        self.kept, self.memory = {}, {}
        self.slip, self.rate = CF(tuple(self.values[:d])), CF(tuple(self.values[:d])) / dt
        self.gap, self.pressure = self.values[d:]

    def History(self, name, update, *, start=0.0):
        """What is remembered, such as a way, a wear or a damage, as it is now.

        Parameters
        ----------
        name : str
            Under which it is in `LACContact.Table` and in saved states.
        update : callable
            Gets what it was when the step began, a CoefficientFunction, and returns what it is now.
        start : float
            Before the first step.

        Returns
        -------
        CoefficientFunction
            Of the present step: what `update` returned.

        Raises
        ------
        ValueError, TypeError
            A name that means something else, or is taken already; no function; no number.
        """
        CheckFunction("update", update, "a function of what it was before")
        if name in self.kept:
            raise ValueError(f"History: {name!r} is kept already: take another name")
        self.kept |= CheckedStarts("History", {name: CheckNumber("start", start)})
        before = GridFunction(self._numbers)
        now = _Expression(f"History of {name}", update(before))
        self.memory[name] = before, now
        return now

    def Slopes(self, expression):
        """Its derivatives by the numbers of the fields."""
        return [expression.Diff(value) for value in self.values]


def Dependent(space, dt, functions):
    """Arguments of a ContactForm for coefficients that are Python's functions of the fields."""
    fields = Fields(space, dt)
    found = {
        name: _Expression(f"{name}(z)", function(fields), COEFFICIENTS[name])
        for name, function in functions.items()
    }
    slopes = {name: fields.Slopes(expression) for name, expression in found.items()}
    memory = {"kept": fields.kept, "memory": fields.memory}
    return found | {"fields": fields.values, "slopes": slopes} | memory


def _Expression(name, value, least=-math.inf):
    """What a function of the fields has returned."""
    if value is None:
        raise Wrong(TypeError, name, value, "an expression of the fields: return it")
    return Coefficient(name, value, least)


def CheckedStarts(whose, starts):
    """What is remembered of a macro-element before the first step: arrays by name."""
    for name, start in starts.items():
        if not isinstance(name, str) or name in TAKEN or name.startswith("by_"):
            raise ValueError(f"{whose} has {name!r}, which means something else: rename it")
        values = np.asarray(start)
        if values.ndim > 1 or not values.size or values.dtype.kind not in "fiu":
            raise Wrong(ValueError, f"{whose}[{name!r}]", start, "a number, or a vector (k)")
        if not np.all(np.isfinite(values)):
            raise Wrong(ValueError, f"{whose}[{name!r}]", start, "finite")
    return {name: np.atleast_1d(np.asarray(start, dtype=float)) for name, start in starts.items()}
