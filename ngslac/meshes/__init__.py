"""Meshes of two bodies whose surfaces do not match: for tests, tutorials and first trials.

Every builder makes sure that no node of one surface lies on the other, as those of bodies that are
meshed on their own do not.
"""

from ngslac.meshes.blocks import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D
from ngslac.meshes.boxes import AddBody, Cells, StructuredBox
from ngslac.meshes.cords import CordMesh, DiscInRing
from ngslac.meshes.cylinders import CylinderOnBlock
from ngslac.meshes.geometry import CheckNonMatching
from ngslac.meshes.geometry3d import CheckNonMatching3D, RotationMatrix
from ngslac.meshes.hertz import HertzMesh, PointForce
from ngslac.meshes.indentation import IndentationMesh
from ngslac.meshes.spheres import SphereOnBlock, TwoSpheres

__all__ = [
    "AddBody",
    "Cells",
    "CheckNonMatching",
    "CheckNonMatching3D",
    "CordMesh",
    "CylinderOnBlock",
    "DiscInRing",
    "HertzMesh",
    "IndentationMesh",
    "PointForce",
    "RotationMatrix",
    "SphereOnBlock",
    "StructuredBox",
    "TwoBlocks",
    "TwoBlocks3D",
    "TwoSpheres",
]
