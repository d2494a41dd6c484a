# SPDX-License-Identifier: LGPL-2.1-or-later
"""Closed-form solutions and benchmark data, used by tests and tutorials.

Pressure is positive in compression; tractions act on the slave, which is body 1. Any consistent
system of units: with N and mm, pressures are in MPa. Needs NumPy and SciPy only.
"""

from .dundurs import ContactModulus, DundursBeta
from .hertz import HertzLine, HertzPoint
from .mindlin import (
    CattaneoMindlin,
    CattaneoMindlinPoint,
    MindlinPointReversal,
    MindlinReversal,
)
from .spence import SpenceLine, StickZone
from .twist import TwistPoint, TwistReversal

__all__ = [
    "CattaneoMindlin",
    "CattaneoMindlinPoint",
    "ContactModulus",
    "DundursBeta",
    "HertzLine",
    "HertzPoint",
    "MindlinPointReversal",
    "MindlinReversal",
    "SpenceLine",
    "StickZone",
    "TwistPoint",
    "TwistReversal",
]

# Names of version 0.1.0 that served tests alone, and the file in tests/reference that has them now.
MOVED = {
    "ElasticSignorini": "exact_signorini.py",
    "ElasticSignoriniDisc": "exact_disc.py",
    "FrictionSlab": "exact_slab.py",
    "GRECO_SLAB": "exact_slab.py",
    "ScalarSignorini": "exact_signorini.py",
}


def __getattr__(name):
    if name in MOVED:  # `from ngslac.reference import` would hide the words of an AttributeError
        raise ImportError(
            f"ngslac.reference.{name} left the package after version 0.1.0: copy the file "
            f"tests/reference/{MOVED[name]} of the sources, and import {name} from there"
        )
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
