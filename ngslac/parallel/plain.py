# SPDX-License-Identifier: LGPL-2.1-or-later
"""Values that processes send to each other as they are."""

from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path

import numpy as np

__all__ = ["IsPlain", "Reference", "View"]

ATOMS = (type(None), bool, int, float, complex, str, bytes, np.ndarray, np.generic, Path)


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
