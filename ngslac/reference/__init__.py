"""Closed-form solutions and benchmark data, used by tests and tutorials.

Pressure is positive in compression; tractions act on the slave, which is body 1. Any consistent
system of units. Needs NumPy and SciPy only.
"""

from .cattaneo3d import CattaneoMindlinPoint, MindlinPointReversal
from .dundurs import ContactModulus, DundursBeta
from .hertz import HertzLine
from .hertz3d import HertzPoint
from .mindlin import CattaneoMindlin, MindlinReversal
from .signorini import ScalarSignorini
from .signorini_disc import ElasticSignoriniDisc
from .signorini_elastic import ElasticSignorini
from .slab import GRECO_SLAB, FrictionSlab
from .spence import SpenceLine
from .stickzone import StickZone
from .twist import TwistPoint, TwistReversal

__all__ = [
    "GRECO_SLAB",
    "CattaneoMindlin",
    "CattaneoMindlinPoint",
    "ContactModulus",
    "DundursBeta",
    "ElasticSignorini",
    "ElasticSignoriniDisc",
    "FrictionSlab",
    "HertzLine",
    "HertzPoint",
    "MindlinPointReversal",
    "MindlinReversal",
    "ScalarSignorini",
    "SpenceLine",
    "StickZone",
    "TwistPoint",
    "TwistReversal",
]
