"""Demonstration problems: meshes, runs and pictures.

Every demo is a module with a function ``Run``, started from the command line by::

    python -m ngslac.demos.hertz --h 0.5 --out results

The mesh builders are used by the demos, the tests and the tutorials.
"""

from ._blocks import TwoBlocks
from ._geometry import CheckNonMatching
from ._meshes import HertzMesh, PointForce

__all__ = ["CheckNonMatching", "HertzMesh", "PointForce", "TwoBlocks"]
