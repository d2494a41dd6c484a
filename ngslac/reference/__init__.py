"""Closed-form solutions and benchmark data, used by tests, demos and tutorials.

Pressure is positive in compression; tractions act on the slave, which is body 1. Any consistent
system of units. Needs NumPy and SciPy only.
"""

from .dundurs import ContactModulus, DundursBeta
from .hertz import HertzLine
from .mindlin import CattaneoMindlin, MindlinReversal
from .signorini import ScalarSignorini
from .signorini_elastic import ElasticSignorini
from .slab import GRECO_SLAB, FrictionSlab
from .spence import SpenceLine
from .stickzone import StickZone

__all__ = [
    "GRECO_SLAB",
    "CattaneoMindlin",
    "ContactModulus",
    "DundursBeta",
    "ElasticSignorini",
    "FrictionSlab",
    "HertzLine",
    "MindlinReversal",
    "ScalarSignorini",
    "SpenceLine",
    "StickZone",
]
