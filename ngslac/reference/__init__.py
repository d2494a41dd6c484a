# SPDX-License-Identifier: LGPL-2.1-or-later
"""Closed-form solutions of Hertz, Cattaneo and Mindlin, and the constants of Dundurs.

Pressure is positive in compression; tractions act on the slave, which is body 1. Any consistent
system of units: with N and mm, pressures are in MPa. Needs NumPy and SciPy only.
"""

from typing import NoReturn

from .dundurs import ContactModulus, DundursBeta
from .hertz import HertzLine, HertzPoint
from .mindlin import (
    CattaneoMindlin,
    CattaneoMindlinPoint,
    MindlinPointReversal,
    MindlinReversal,
)

__all__ = [
    "CattaneoMindlin",
    "CattaneoMindlinPoint",
    "ContactModulus",
    "DundursBeta",
    "HertzLine",
    "HertzPoint",
    "MindlinPointReversal",
    "MindlinReversal",
]

# Names of version 0.1.0 that are no longer part of the package, and the file that has them now.
MOVED = {
    "ElasticSignorini": "tests/reference/exact_signorini.py",
    "ElasticSignoriniDisc": "tests/reference/exact_disc.py",
    "FrictionSlab": "tests/reference/exact_slab.py",
    "GRECO_SLAB": "tests/reference/exact_slab.py",
    "ScalarSignorini": "tests/reference/exact_signorini.py",
    "SpenceLine": "tests/reference/exact_spence.py",
    "StickZone": "tests/reference/exact_spence.py",
    "TwistPoint": "tutorials/examples/lubkin.py",
    "TwistReversal": "tutorials/examples/lubkin.py",
}


def __getattr__(name: str) -> NoReturn:
    """Say where a name is that has left the package."""
    if name in MOVED:  # `from ngslac.reference import` would hide the words of an AttributeError
        raise ImportError(
            f"ngslac.reference.{name} left the package after version 0.1.0: copy the file "
            f"{MOVED[name]} of the sources, with those that it imports, and import {name} from it"
        )
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
