# SPDX-License-Identifier: LGPL-2.1-or-later
"""Meshes of two bodies whose surfaces do not match: for tests, tutorials and first trials.

Every builder makes sure that no node of one surface lies on the other, as those of bodies that are
meshed on their own do not. It raises a ``ValueError`` for sizes that are not positive and for parts
that do not fit. Common arguments, all optional:

order : int
    Order of the curved geometry.
grading : float
    Growth of the element size away from the contact zone (netgen's ``grading``).
scale : float
    Factor for all coordinates, e.g. ``1e-3`` for metres in place of millimetres.
angle : float, rotation : (3, 3) array_like or (axis, float)
    Rotation about the origin: in 2D counter-clockwise in degrees, in 3D a rotation matrix, or an
    axis ("x", "y", "z" or three numbers) and the degrees by which to turn about it. The topology
    of the mesh depends neither on it nor on the scale.

For several processes see `Distributed`.
"""

from ngslac.meshes.blocks import TwoBlocks
from ngslac.meshes.blocks3d import TwoBlocks3D
from ngslac.meshes.boxes import StructuredBox
from ngslac.meshes.cylinders import CylinderOnBlock
from ngslac.meshes.distributed import Distributed
from ngslac.meshes.facetable import FaceTable
from ngslac.meshes.hertz import HertzMesh
from ngslac.meshes.spheres import SphereOnBlock, TwoSpheres

__all__ = [
    "CylinderOnBlock",
    "Distributed",
    "FaceTable",
    "HertzMesh",
    "SphereOnBlock",
    "StructuredBox",
    "TwoBlocks",
    "TwoBlocks3D",
    "TwoSpheres",
]
