"""Partial slip: what the contacts of lines and of points under a tangential load have in common."""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from ._checks import finite, instance, nonnegative
from ._pair import HertzPair

__all__ = ["PartialSlip", "Reversal"]


def FieldType(state, name):
    """The class that the annotation of a field asks for."""
    return {field.name: field.type for field in fields(state)}[name]


@dataclass(frozen=True, kw_only=True)
class PartialSlip:
    """A Hertz contact with a tangential force below F P, uncoupled from the pressure; checked."""

    hertz: HertzPair
    shear: float
    friction: float

    def __post_init__(self):
        instance("hertz", self.hertz, FieldType(self, "hertz"))
        finite("shear", self.shear)
        nonnegative("friction", self.friction)
        limit = self.friction * self.hertz.force
        if abs(self.shear) > limit * (1.0 + 1e-12):
            raise ValueError(
                f"shear = {self.shear!r} is not valid: the bodies would slide, "
                f"keep |shear| <= friction * hertz.force = {limit!r}"
            )
        if abs(self.hertz.beta) > 1e-12:
            raise ValueError(
                f"hertz = {self.hertz!r} is not valid: its pressure and friction are coupled "
                f"(beta = {self.hertz.beta:.3g}), give both bodies the same material"
            )

    @property
    def _scale(self):
        return np.sign(self.shear) * self.friction * self.hertz.peak


@dataclass(frozen=True, kw_only=True)
class Reversal:
    """A load brought back from `start`: that state less twice the one of half the change."""

    start: Any
    _load: ClassVar[str] = "shear"  # the field that holds the load, of `start` too

    def __post_init__(self):
        instance("start", self.start, FieldType(self, "start"))
        name, now, before = self._load, *self._Loads()
        finite(name, now)
        if abs(now) > abs(before):
            raise ValueError(
                f"{name} = {now!r} is not valid: keep |{name}| <= |start.{name}| = "
                f"{abs(before)!r}, beyond it use a {type(self.start).__name__} with this {name}"
            )

    def _Loads(self):
        return getattr(self, self._load), getattr(self.start, self._load)

    @cached_property
    def _change(self):
        now, before = self._Loads()
        return replace(self.start, **{self._load: 0.5 * (before - now)})

    def _Superposed(self, of):
        """What ``of(state)`` is in the present state, for anything linear in the tractions."""
        return of(self.start) - 2.0 * of(self._change)

    @property
    def ratio(self):
        """Part b/a of the contact that has not slipped since the reversal."""
        return self._change.ratio

    @property
    def stick(self):
        """Half width or radius b of that part (length)."""
        return self._change.stick
