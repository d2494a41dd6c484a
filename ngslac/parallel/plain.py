# SPDX-License-Identifier: LGPL-2.1-or-later
"""Values that processes send to each other as they are."""

import inspect
import math
from dataclasses import dataclass, fields, is_dataclass
from numbers import Real
from pathlib import Path

import numpy as np

__all__ = ["Arguments", "Difference", "IsPlain", "Reference", "View"]

ATOMS = (type(None), bool, int, float, complex, str, bytes, np.ndarray, np.generic, Path)

OWN = {"printing", "callback"}  # arguments that each process may choose
# Differences of numbers that were computed on each process: relative, and near zero.
SAME, NOTHING = 1e-9, 1e-14


def Arguments(function, args, options):
    """Numbers and words among the arguments of a call, by their names."""
    try:
        given = inspect.signature(function).bind_partial(*args, **options).arguments
    except TypeError:  # a wrong call, which is refused where it is made
        return {}
    return {name: value for name, value in given.items() if name not in OWN and _IsWord(value)}


def _IsWord(value):
    if isinstance(value, (list, tuple)):
        return all(map(_IsWord, value))
    return value is None or isinstance(value, (bool, Real, str))


def Difference(ours, others):
    """The name of an argument that is another one on another process; None: they are alike."""
    missing = object()
    for name in [*ours, *others]:
        if not _Alike(ours.get(name, missing), others.get(name, missing)):
            return name
    return None


def _Alike(one, other):
    if isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)):
        return len(one) == len(other) and all(map(_Alike, one, other))
    if isinstance(one, Real) and isinstance(other, Real):
        near = math.isclose(one, other, rel_tol=SAME, abs_tol=NOTHING)
        return near or (math.isnan(one) and math.isnan(other))
    return one == other


@dataclass(frozen=True)
class Reference:
    """Something that all processes have, by the key that all know it by."""

    kind: str  # "twin", "function", "original" or "boundary"
    key: object
    what: object = None  # to make where it is not there yet


def IsPlain(value):
    """Numbers, words, arrays, lists and dicts of these, and records that hold nothing else."""
    if isinstance(value, ATOMS):
        return getattr(value, "dtype", np.dtype(float)).kind != "O"
    if isinstance(value, dict):
        return all(IsPlain(part) for part in (*value, *value.values()))
    if isinstance(value, (list, tuple, set)):
        return all(map(IsPlain, value))
    if is_dataclass(value) and not isinstance(value, type):
        return all(IsPlain(getattr(value, field.name)) for field in fields(value))
    return False


class View:
    """Some attributes of an object, and its text."""

    def __init__(self, attributes, text):
        vars(self).update(attributes)
        self._text = text

    def __repr__(self):
        return self._text

    @classmethod
    def Of(cls, value):
        """Of an object whose class says by `shown` which attributes these are."""
        return cls({name: getattr(value, name) for name in value.shown}, str(value))
