"""One patch test in 3D: exact stress, meshes and displacement space."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from ngsolve import VectorH1

from ngslac import BubbleVectorH1, SplitSlaveFaces
from ngslac.meshes.blocks3d import TwoBlocks3D
from ngslac.meshes.geometry3d import RotationMatrix

__all__ = ["BELOW", "HELD", "PARTITIONS", "Case"]

PRESSURE = 25.0
PARTITIONS = ("agglomerated", "bubble", "split")
BELOW = {"tet": "hex", "hex": "prism", "prism": "pyramid", "pyramid": "tet", "prism_side": "tet"}
HELD = "bottom|left_upper"
TURN = ((1.0, 2.0, -0.5), 67.0)  # axis and angle of the rotation
SLOPE, AZIMUTH = 20.0, 30.0


@dataclass(frozen=True)
class Case:
    """One patch test.

    Parameters
    ----------
    element : {"tet", "hex", "prism", "prism_side", "pyramid"}
        Shape of the elements of the slave body; "prism_side" has quadrilaterals on the interface.
    order : int
        Order of the displacement.
    partition : {"agglomerated", "bubble", "split"}
        Macro-elements from the space as it is, from one bubble per slave face, from split faces.
    oblique : bool
        Inclined interface, irregular meshes, another element shape below, all rotated.
    friction : float
        Coefficient of friction; with it the interface carries half the shear at which it slides.
    """

    element: str = "tet"
    order: int = 1
    partition: str = "bubble"
    oblique: bool = False
    friction: float = 0.0

    def __post_init__(self):
        if self.partition not in PARTITIONS:
            raise ValueError(
                f"partition must be one of {', '.join(PARTITIONS)}, but is {self.partition!r}"
            )

    @property
    def name(self):
        where = "oblique" if self.oblique else "flat"
        family = "Q" if self.element == "hex" else "P"
        return f"{family}{self.order} {self.element} {self.partition} {where}"

    @property
    def axes(self):
        """Two tangents of the interface, and the normal out of the slave, as columns."""
        rise, a = math.tan(math.radians(SLOPE)) * self.oblique, math.radians(AZIMUTH)
        normal = np.array([rise * math.cos(a), rise * math.sin(a), -1.0])
        normal /= np.linalg.norm(normal)
        tangent = np.cross(normal, [0.3, 0.8, 0.1])
        tangent /= np.linalg.norm(tangent)
        axes = np.column_stack([tangent, np.cross(normal, tangent), normal])
        return RotationMatrix(TURN if self.oblique else None) @ axes

    @property
    def stress(self):
        """The exact stress (3, 3)."""
        shear = 0.5 * self.friction * PRESSURE
        local = np.array([[-7, 2, shear], [2, 5, 0], [shear, 0, -PRESSURE]])
        return self.axes @ local @ self.axes.T

    def Mesh(self):
        """The two blocks; order 1 without bubbles needs finer ones for two macro-elements."""
        n = (4, 3) if (self.order, self.partition) == (1, "agglomerated") else (3, 2)
        if not self.oblique:
            return TwoBlocks3D(self.element, None, n, n[::-1])
        options = {"shape": "oblique", "slope": SLOPE, "azimuth": AZIMUTH}
        options |= {"perturb": 0.2, "rotation": TURN}
        return TwoBlocks3D(self.element, BELOW[self.element], n, n[::-1], **options)

    def Space(self):
        """Displacement space, on a new mesh if that is split."""
        mesh = self.Mesh()
        if self.partition == "split":
            mesh = SplitSlaveFaces(mesh, "slave")
        if self.partition == "bubble":
            return BubbleVectorH1(mesh, order=self.order, slave="slave", dirichlet=HELD)
        return VectorH1(mesh, order=self.order, dirichlet=HELD)
