"""Names of `elasticity` for solids."""

from elasticity import Field, StressError
from elasticity import Material as Solid
from elasticity import Pair as Pair3D

__all__ = ["Field", "Pair3D", "Solid", "StressError"]
