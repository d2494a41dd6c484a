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
