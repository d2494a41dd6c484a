# SPDX-License-Identifier: LGPL-2.1-or-later
"""Partial slip under a load along the surface, first and reversed: of lines, points and twists."""

from dataclasses import dataclass, fields, replace
from functools import cached_property, wraps
from typing import Any, ClassVar

import numpy as np

from ._checks import finite, instance, nonnegative

__all__ = ["PartialSlip", "Reversal", "superposed"]


def _FieldType(state, name):
    """The class that the annotation of a field asks for."""
    return {field.name: field.type for field in fields(state)}[name]


class PartialSlip:
    """A Hertz contact, loaded further when the normal load is complete; checked.

    Children have the fields `hertz`, `friction`, and the load.
    """

    _LOAD, _MOVE, _LIMIT = "shear", "slide", "friction * hertz.force"

    def __post_init__(self):
        instance("hertz", self.hertz, _FieldType(self, "hertz"))
        name, load = self._LOAD, self._load
        finite(name, load)
        nonnegative("friction", self.friction)
        if abs(load) > self.limit * (1.0 + 1e-12):
            raise ValueError(
                f"{name} = {load!r} is not valid: the bodies would {self._MOVE}, "
                f"keep |{name}| <= {self._LIMIT} = {self.limit!r}"
            )

    @property
    def _load(self):
        return getattr(self, self._LOAD)

    @property
    def _scale(self):
        return np.sign(self._load) * self.friction * self.hertz.peak

    @property
    def limit(self) -> float:
        """Load F P at which all slips."""
        return self.friction * self.hertz.force

    @property
    def stick(self) -> float:
        """Half width or radius c of the stick zone (length)."""
        return self.ratio * self.hertz._size


@dataclass(frozen=True, kw_only=True)
class Reversal:
    """A load brought back from `start`: that state less twice the one of half the change."""

    start: Any
    _LOAD: ClassVar[str] = "shear"  # the field that holds the load, of `start` too

    def __post_init__(self):
        instance("start", self.start, _FieldType(self, "start"))
        name, now, before = self._LOAD, *self._Loads()
        finite(name, now)
        if abs(now) > abs(before):
            raise ValueError(
                f"{name} = {now!r} is not valid: keep |{name}| <= |start.{name}| = "
                f"{abs(before)!r}, beyond it use a {type(self.start).__name__} with this {name}"
            )

    def _Loads(self):
        return getattr(self, self._LOAD), getattr(self.start, self._LOAD)

    @cached_property
    def _change(self):
        now, before = self._Loads()
        return replace(self.start, **{self._LOAD: 0.5 * (before - now)})

    @property
    def ratio(self) -> float:
        """Part b/a of the contact that has not slipped since the reversal."""
        return self._change.ratio

    @property
    def stick(self) -> float:
        """Half width or radius b of that part (length)."""
        return self._change.stick


def superposed(method):
    """A method of `Reversal` from that of its states, for anything linear in the tractions."""

    @wraps(method)
    def of(self, *where, **named):
        before, change = (method(state, *where, **named) for state in (self.start, self._change))
        if isinstance(before, tuple):
            return tuple(b - 2.0 * c for b, c in zip(before, change, strict=True))
        return before - 2.0 * change

    return of
