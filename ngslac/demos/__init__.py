"""Demonstration problems: meshes, runs and pictures.

Every demo is a module with a function ``Run``, started from the command line by::

    python -m ngslac.demos.hertz --h 0.5 --out results

The mesh builders are used by the demos, the tests and the tutorials.
"""

from ._blocks import TwoBlocks
from ._blocks3d import TwoBlocks3D
from ._geometry import CheckNonMatching
from ._geometry3d import CheckNonMatching3D, RotationMatrix
from ._meshes import HertzMesh, PointForce
from ._spheres import SphereOnBlock, TwoSpheres

__all__ = [
    "CheckNonMatching",
    "CheckNonMatching3D",
    "HertzMesh",
    "PointForce",
    "RotationMatrix",
    "SphereOnBlock",
    "TwoBlocks",
    "TwoBlocks3D",
    "TwoSpheres",
]
